//! Generates the bindings from the installed header and finds the library that belongs to it.

use std::env;
use std::path::{Path, PathBuf};

/// Appended to every failure: there are always these two ways to get a working build.
const WAYS_OUT: &str = "Either run scripts/setup.sh, which installs Embree 4 and libclang (or set EMBREE_INCLUDE_DIR, \
    EMBREE_LIB_DIR, LIBCLANG_PATH), or build without Embree: cargo build --release --no-default-features";

/// Folders in which linker and loader look without being told.
const STANDARD_LIB_DIRS: [&str; 5] = ["/usr/lib", "/usr/lib64", "/lib", "/lib64", "/usr/local/lib"];

fn main() {
    for variable in ["EMBREE_INCLUDE_DIR", "EMBREE_LIB_DIR", "LIBCLANG_PATH"] {
        println!("cargo::rerun-if-env-changed={variable}");
    }
    println!("cargo::rerun-if-changed=build.rs");
    if let Err(problem) = run() {
        println!("cargo::error={problem} {WAYS_OUT}");
    }
}

fn run() -> Result<(), String> {
    let include = find_include_dir()?;
    let version = header_version(&include)?;
    generate_bindings(&include)?;
    println!("cargo::metadata=include={}", include.display());
    println!("cargo::metadata=version={version}");
    if let Some(dir) = find_lib_dir(&include)? {
        println!("cargo::rustc-link-search=native={}", dir.display());
        println!("cargo::metadata=lib_dir={}", dir.display());
        println!("cargo::rustc-link-arg-tests=-Wl,-rpath,{}", dir.display());
    }
    println!("cargo::rustc-link-lib=dylib=embree4");
    Ok(())
}

fn find_include_dir() -> Result<PathBuf, String> {
    let has_header = |dir: &PathBuf| dir.join("embree4/rtcore.h").is_file();
    if let Some(dir) = env::var_os("EMBREE_INCLUDE_DIR").map(PathBuf::from) {
        return if has_header(&dir) {
            Ok(dir)
        } else {
            Err(format!("EMBREE_INCLUDE_DIR={} does not hold embree4/rtcore.h.", dir.display()))
        };
    }
    let usual = ["/usr/include", "/usr/local/include", "/opt/homebrew/include"].map(PathBuf::from);
    usual
        .into_iter()
        .find(has_header)
        .ok_or_else(|| "Embree 4 is not installed (no embree4/rtcore.h).".to_string())
}

fn header_version(include: &Path) -> Result<String, String> {
    let config = include.join("embree4/rtcore_config.h");
    println!("cargo::rerun-if-changed={}", config.display());
    let text = std::fs::read_to_string(&config).map_err(|error| format!("{}: {error}.", config.display()))?;
    text.lines()
        .find_map(|line| line.trim().strip_prefix("#define RTC_VERSION_STRING"))
        .map(|value| value.trim().trim_matches('"').to_string())
        .ok_or_else(|| format!("{}: no RTC_VERSION_STRING.", config.display()))
}

/// The folder of the library where it needs telling; `None` where linker and loader find it alone.
fn find_lib_dir(include: &Path) -> Result<Option<PathBuf>, String> {
    let has_library = |dir: &PathBuf| {
        ["libembree4.so", "libembree4.dylib", "embree4.lib"].iter().any(|name| dir.join(name).exists())
    };
    if let Some(dir) = env::var_os("EMBREE_LIB_DIR").map(PathBuf::from) {
        return if has_library(&dir) {
            Ok(Some(dir))
        } else {
            Err(format!("EMBREE_LIB_DIR={} does not hold libembree4.", dir.display()))
        };
    }
    let prefix = include.parent().unwrap_or(Path::new("/"));
    let found = ["lib", "lib64"].map(|name| prefix.join(name)).into_iter().find(has_library);
    Ok(found.filter(|dir| !STANDARD_LIB_DIRS.iter().any(|standard| dir == Path::new(standard))))
}

fn generate_bindings(include: &Path) -> Result<(), String> {
    clang_sys::load().map_err(|_| "libclang, with which bindgen reads Embree's header, is not installed.")?;
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or("OUT_DIR is not set.")?);
    bindgen::builder()
        .header(include.join("embree4/rtcore.h").display().to_string())
        .clang_arg(format!("-I{}", include.display()))
        .allowlist_item("(rtc|RTC).*")
        .default_enum_style(bindgen::EnumVariation::NewType { is_bitfield: false, is_global: true })
        .bitfield_enum("RTC.*Flags")
        .prepend_enum_name(false)
        .clang_macro_fallback()
        .clang_macro_fallback_build_dir(&out)
        .rust_edition(bindgen::RustEdition::Edition2024)
        .layout_tests(true)
        .generate_comments(false)
        .parse_callbacks(Box::new(bindgen::CargoCallbacks::new()))
        .generate()
        .map_err(|error| {
            format!("bindgen cannot read Embree's header: {}.", error.to_string().trim().replace('\n', " "))
        })?
        .write_to_file(out.join("bindings.rs"))
        .map_err(|error| format!("{}: {error}.", out.display()))
}
