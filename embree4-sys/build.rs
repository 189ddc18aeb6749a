fn main() {
    println!("cargo:rustc-link-lib=dylib=embree4");
}
