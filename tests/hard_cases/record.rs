//! The figures that the suite measures, and the document made of them.
//!
//! With `ALABASTER_WRITE_STABILITY=1` in the environment each test writes its own figure into docs/stability.md, so that a run of the whole
//! suite writes it anew. Without, a test holds that the document lists every case as it is here.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::{env, fs};

use crate::cases::{CASES, Case};
use crate::common::backends::Setup;

/// Set to have the document written.
const WRITE: &str = "ALABASTER_WRITE_STABILITY";

/// One writer at a time.
static DOCUMENT: Mutex<()> = Mutex::new(());

/// What was measured last in each mode.
#[derive(Default)]
pub struct Figures(BTreeMap<&'static str, String>);

impl Figures {
    /// Keeps a figure of one rendering, if it is of the backend whose figures are kept.
    pub fn keep(&mut self, setup: Setup, figure: String) {
        if let Some(mode) = setup.recorded() {
            self.0.insert(mode, figure);
        }
    }

    /// Those of all modes.
    pub fn written(&self) -> String {
        let figures: Vec<_> = self.0.iter().map(|(mode, figure)| format!("{mode}: {figure}")).collect();
        figures.join("; ")
    }
}

/// The largest of numbers in each mode.
#[derive(Default)]
pub struct Largest(BTreeMap<&'static str, f64>);

impl Largest {
    /// Takes in a number of a rendering.
    pub fn add(&mut self, setup: Setup, number: f64) {
        let largest = self.0.entry(setup.mode_name()).or_default();
        *largest = largest.max(number);
    }

    /// Those of all modes.
    pub fn written(&self) -> String {
        let numbers: Vec<_> = self.0.iter().map(|(mode, number)| format!("{mode} {number:.0e}")).collect();
        numbers.join(", ")
    }
}

/// Keeps what was `measured` for the case `name`.
#[track_caller]
pub fn record(name: &str, measured: String) {
    println!("{name}: {measured}");
    let case = CASES.iter().find(|case| case.name == name).unwrap_or_else(|| panic!("no case {name}"));
    assert!(case.held_by.is_none() && !measured.contains('|'), "{measured}");
    if env::var_os(WRITE).is_some() {
        let _guard = DOCUMENT.lock().unwrap_or_else(PoisonError::into_inner);
        let mut figures = figures(&document());
        figures.insert(name.into(), measured);
        fs::write(path(), written(&figures)).unwrap();
    }
}

/// Asserts that what the usual formula gives does not hold the criterion that the test puts to the one in use.
#[track_caller]
pub fn assert_fails<T>(naive: &str, value: T, holds: impl Fn(T) -> bool) {
    assert!(!holds(value), "{naive}: the counter-example no longer is one");
}

fn path() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/stability.md")
}

fn document() -> String {
    fs::read_to_string(path()).unwrap_or_default()
}

/// What stands in the column of figures, by case.
fn figures(document: &str) -> BTreeMap<String, String> {
    let row = |line: &str| {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let name = cells.get(1)?.strip_prefix('`')?.strip_suffix('`')?;
        Some((name.to_owned(), (*cells.get(4)?).to_owned()))
    };
    document.lines().filter_map(row).collect()
}

/// The document with these figures.
fn written(figures: &BTreeMap<String, String>) -> String {
    let mut text = INTRODUCTION.to_owned();
    let mut group = "";
    for case in CASES {
        if case.group != group {
            group = case.group;
            write!(text, "\n## {}\n\n{HEADER}", title(group)).unwrap();
        }
        let measured = match case.held_by {
            Some(_) => "",
            None => figures.get(case.name).map_or("", String::as_str),
        };
        text += &row(case, measured);
    }
    text
}

fn row(case: &Case, measured: &str) -> String {
    let measured = case.held_by.map_or(measured.to_owned(), |test| format!("held by `{test}`"));
    format!(
        "| `{}` | {} | {} | {measured} | {} | {} |\n",
        case.name, case.why, case.criterion, case.used, case.fails
    )
}

const HEADER: &str = "| case | why it breaks | criterion | measured | in use | what fails instead |\n|---|---|---|---|---|---|\n";

fn title(group: &str) -> &str {
    match group {
        "fresnel" => "Boundaries",
        "media" => "Media",
        "sampling" => "Sampling",
        "probes" => "Probes",
        "geometry" => "Geometry",
        "scale" => "Scale and place",
        "walks" => "Walks",
        "lights" => "Lights and cameras",
        "wavelengths" => "Wavelengths",
        "all" => "All scenes",
        _ => group,
    }
}

const INTRODUCTION: &str = "# Hard cases

Where renderers of scattering bodies break: pixels that are not numbers, hangs, energy lost or made, bright dots. Each row is a test of the same name, \
`cargo test --release --test hard_cases NAME`, that fails if its criterion does not hold. Where the column *what fails instead* names a formula, that formula \
stands in the test as a counter-example and fails the same criterion there. Pictures are made with both ray casting backends, by colour (rgb) and by wavelength (spectral), \
where they are judged by their luminance over that of white at the same wavelengths. σ is the standard error of the \
estimate itself; seeds are fixed.

This page is written by the suite: `ALABASTER_WRITE_STABILITY=1 cargo test --release --test hard_cases -- --include-ignored`.
";

#[test]
fn the_document_lists_every_case() {
    if env::var_os(WRITE).is_some() {
        return;
    }
    let document = document();
    let figures = figures(&document);
    for case in CASES.iter().filter(|case| case.held_by.is_none()) {
        assert!(figures.get(case.name).is_some_and(|figure| !figure.is_empty()), "{}: no figure", case.name);
    }
    assert!(
        document == written(&figures),
        "docs/stability.md is not that of the suite: write it anew with {WRITE}=1"
    );
    let known: Vec<_> = CASES.iter().map(|case| case.name).collect();
    assert!(figures.keys().all(|name| known.contains(&name.as_str())));
}

#[test]
fn every_row_names_a_test() {
    for test in CASES.iter().filter_map(|case| case.held_by) {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(test.split("::").next().unwrap());
        let name = test.split("::").nth(1).unwrap();
        assert!(fs::read_to_string(file).unwrap().contains(&format!("fn {name}(")), "{test}");
    }
}
