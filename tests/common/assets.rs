//! Files of others, where they are at hand.

use std::path::{Path, PathBuf};

/// The folder of assets; `None`, with a printed reason, if there is none.
pub fn assets() -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/assets");
    let folder = std::env::var_os("ALABASTER_ASSETS").map_or_else(beside, PathBuf::from);
    let found = folder.is_dir();
    if !found {
        println!("skipped: no assets in {} (set ALABASTER_ASSETS)", folder.display());
    }
    found.then_some(folder)
}

/// Every file with one of `endings` in `folder` and below, in a fixed order; at least one.
pub fn files(folder: &Path, endings: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut pending = vec![folder.to_path_buf()];
    while let Some(folder) = pending.pop() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                pending.push(path);
            } else if path.extension().is_some_and(|ending| endings.iter().any(|known| ending == *known)) {
                found.push(path);
            }
        }
    }
    found.sort();
    assert!(!found.is_empty(), "no {endings:?} in {}", folder.display());
    found
}
