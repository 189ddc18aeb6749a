//! Lets the binaries find Embree at run time when it lies outside of the loader's own folders.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=DEP_EMBREE4_LIB_DIR");
    // Set by embree4-sys, hence only with the feature `embree`.
    if let Ok(dir) = std::env::var("DEP_EMBREE4_LIB_DIR") {
        println!("cargo::rustc-link-arg=-Wl,-rpath,{dir}");
    }
}
