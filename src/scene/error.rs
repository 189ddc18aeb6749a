//! What can be wrong with an input file, said so that a person can mend it.

use std::borrow::Cow;
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
            write!(f, "{}: ", abridged(&printable(&self.place)))?;
        }
        f.write_str(&abridged(&printable(&self.problem)))
    }
}

impl std::error::Error for SceneError {}

/// `text`, or its beginning and its end, where the remedy is, if it quotes more than anyone would read.
fn abridged(text: &str) -> Cow<'_, str> {
    const BEGINNING: usize = 500;
    const END: usize = 250;
    let count = text.chars().count();
    if count <= BEGINNING + END {
        return Cow::Borrowed(text);
    }
    let beginning = text.chars().take(BEGINNING);
    Cow::Owned(beginning.chain([' ', '…', ' ']).chain(text.chars().skip(count - END)).collect())
}

/// `text` with control characters but line feeds written out: files that messages quote may hold what a terminal obeys.
pub fn printable(text: &str) -> Cow<'_, str> {
    let is_obeyed = |c: char| c.is_control() && c != '\n';
    if !text.contains(is_obeyed) {
        return Cow::Borrowed(text);
    }
    let mut printable = String::with_capacity(text.len());
    for c in text.chars() {
        match is_obeyed(c) {
            true => printable.extend(c.escape_default()),
            false => printable.push(c),
        }
    }
    Cow::Owned(printable)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_a_terminal_obeys_is_printed() {
        assert_eq!(printable("naïve\nmilk\u{1b}[2J\u{9b}m\u{7}"), "naïve\nmilk\\u{1b}[2J\\u{9b}m\\u{7}");
        let error = SceneError::at("scene.glb", "/materials/\u{7}", "\"\t\" is no name");
        assert_eq!(error.to_string(), "scene.glb: /materials/\\u{7}: \"\\t\" is no name");
    }

    #[test]
    fn long_quotations_are_cut_in_the_middle() {
        let problem = format!("\"{}\" is no name; choose another", "ä".repeat(5000));
        let message = SceneError::file("scene.glb", problem).to_string();
        assert_eq!(message.chars().count(), "scene.glb: ".len() + 500 + 3 + 250);
        assert!(message.starts_with("scene.glb: \"ää") && message.ends_with("is no name; choose another"));
    }
}
