//! What can be wrong with an input file, said so that a person can mend it.

use std::fmt;
use std::path::{Path, PathBuf};

/// An input file is missing, unreadable or wrong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SceneError {
    /// The file at fault.
    pub file: PathBuf,
    /// Where in it: `line 12, material.marble.sigma_a`, `/meshes/0/primitives/1`; empty: the whole file.
    pub place: String,
    /// What is wrong, and how to mend it where that is not plain.
    pub problem: String,
}

impl SceneError {
    /// An error about the whole of `file`.
    pub fn file(file: impl AsRef<Path>, problem: impl Into<String>) -> Self {
        Self::at(file, "", problem)
    }

    /// An error at `place` in `file`.
    pub fn at(file: impl AsRef<Path>, place: impl Into<String>, problem: impl Into<String>) -> Self {
        Self { file: file.as_ref().to_path_buf(), place: place.into(), problem: problem.into() }
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.file.display())?;
        if !self.place.is_empty() {
            write!(f, "{}: ", self.place)?;
        }
        f.write_str(&self.problem)
    }
}

impl std::error::Error for SceneError {}
