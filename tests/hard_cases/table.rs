//! Tables in tests/data.

use std::fs;
use std::path::Path;

use crate::csv::fields;

/// The rows of a table in tests/data, without comments and the header, as fields.
pub fn rows(name: &str) -> Vec<Vec<String>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name);
    let text = fs::read_to_string(path).unwrap();
    text.lines().filter(|line| !line.starts_with('#')).skip(1).map(fields).collect()
}

/// The number in a field.
pub fn number(field: &str) -> f64 {
    field.parse().expect("a number in tests/data")
}
