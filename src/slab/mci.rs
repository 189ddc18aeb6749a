//! Reads the input files of MCML, `.mci` (Wang, Jacques and Zheng 1995, "MCML: Monte Carlo modeling of light
//! transport in multi-layered tissues", Comput. Methods Programs Biomed. 47).
//!
//! Lines of values in a fixed order; `#` begins a comment, and blank lines do not count. Lengths are centimetres:
//!
//! ```text
//! 1.0                      # version of the format
//! 1                        # number of runs; then, for each of them:
//! skin.mco A               # output file, A for text
//! 1000000                  # number of photons
//! 0.002 0.01               # dz dr
//! 100 50 30                # nz nr na
//! 2                        # number of layers
//! 1.0                      # n of the medium above
//! 1.4 37 480 0.79 0.006    # n mua mus g d, a line for each layer
//! 1.4 2.2 210 0.82 1e8
//! 1.0                      # n of the medium below
//! ```

use std::fs::File;
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};

use thiserror::Error;

use super::layers::{Layer, LayerError, LayerStack, Place};
use super::lines::{Line, Lines};
use super::tally::Grid;

/// Largest file that is read, bytes.
const MAX_BYTES: u64 = 1 << 24;
/// Most photons of a run: days of work.
pub const MAX_PHOTONS: u64 = 1_000_000_000_000;
/// Most cells of the (r, z) and of the (r, α) grid. Every batch of a round holds them in a few arrays, which is
/// about a gigabyte in all.
const MAX_CELLS: u64 = 1 << 20;
/// dz and dr, cm: outside of this, areas and volumes leave the range of floating point numbers.
const STEPS: std::ops::RangeInclusive<f64> = 1e-12..=1e12;

/// One run of an input file.
#[derive(Clone, Debug, PartialEq)]
pub struct MciRun {
    /// Output file, relative to the folder of the input; it lies in that folder or below.
    pub output: PathBuf,
    /// Line on which the output file stands.
    pub line: usize,
    /// Number of photon packets.
    pub photons: u64,
    /// Bins, cm.
    pub grid: Grid,
    /// Layers, cm.
    pub stack: LayerStack,
}

/// What is wrong with an input file.
#[derive(Debug, Error)]
pub enum MciError {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Unreadable(#[from] io::Error),
    /// The file is far larger than any input of this format.
    #[error("is larger than {MAX_BYTES} bytes; is it an .mci file?")]
    TooLarge,
    /// A line is wrong.
    #[error("line {line}: {field}: {problem}")]
    Line {
        /// Number of the line, from 1.
        line: usize,
        /// What should stand there.
        field: &'static str,
        /// What is wrong, and how to mend it.
        problem: String,
    },
}

/// Reads the runs of the file at `path`.
///
/// # Errors
/// If it cannot be read, is not of this format, or of a variant of it that is not supported.
pub fn read_mci(path: &Path) -> Result<Vec<MciRun>, MciError> {
    let mut bytes = Vec::new();
    File::open(path)?.take(MAX_BYTES + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(MciError::TooLarge);
    }
    // Comments may be in any encoding; values are ASCII.
    parse_mci(&String::from_utf8_lossy(&bytes))
}

/// Reads the runs of a file whose content is `text`.
///
/// # Errors
/// If it is not of this format, or of a variant of it that is not supported.
pub fn parse_mci(text: &str) -> Result<Vec<MciRun>, MciError> {
    let mut lines = Lines::new(text);
    check_version(&lines.next("file version")?)?;
    let line = lines.next("number of runs")?;
    let runs_line = line.number;
    let runs = line.count_from_1(u64::MAX, "a file holds one run at least")?;
    // The number is believed only as far as there are lines for it.
    let mut read: Vec<MciRun> = Vec::new();
    for _ in 0..runs {
        read.push(read_run(&mut lines, &read)?);
    }
    match lines.rest() {
        None => Ok(read),
        Some(rest) => Err(rest.error(format!(
            "there is more after the last run; delete it, or mend the number of runs on line {runs_line}, which is {runs}"
        ))),
    }
}

fn check_version(line: &Line) -> Result<(), MciError> {
    let hint = "files of MCML 1 (version 1.0) are read";
    let [version] = line.values(["version"])?;
    if version.to_ascii_lowercase().starts_with("mcml") {
        return Err(line.error(format!(
            "{version} is the format with named media of MCML 2, which is not supported; {hint}"
        )));
    }
    if version == "A1" {
        return Err(line.error(format!("A1 begins an output file, .mco; {hint}")));
    }
    let mut parts = version.split('.').map(str::parse::<u32>);
    let known = match (parts.next(), parts.next()) {
        (Some(Ok(1)), None | Some(Ok(0..=2))) => parts.all(|part| part.is_ok()),
        (Some(Ok(2)), None | Some(Ok(0))) => parts.next().is_none(),
        _ => false,
    };
    if known { Ok(()) } else { Err(line.error(format!("version {version:?} is not supported; {hint}"))) }
}

/// Reads a run; `before` are those above it in the file.
fn read_run(lines: &mut Lines, before: &[MciRun]) -> Result<MciRun, MciError> {
    let line = lines.next("output file")?;
    let output = read_output(&line)?;
    if let Some(same) = before.iter().find(|run| run.output == output) {
        let problem = format!(
            "{} is the output of the run on line {} too; give each its own",
            output.display(),
            same.line
        );
        return Err(line.error(problem));
    }
    let photons = read_photons(&lines.next("number of photons")?)?;
    let (grid, grid_line) = read_grid(lines)?;
    let (stack, layers_line) = read_stack(lines)?;
    let (radial, depth) = (grid.radial as u64, grid.depth as u64 + stack.layers().len() as u64);
    if radial * depth > MAX_CELLS || radial * grid.angular as u64 > MAX_CELLS {
        return Err(grid_line.error(format!(
            "a grid of nz = {}, nr = {}, na = {} for {} layers (line {layers_line}) is too large: nr (nz + layers) and \
             nr na may be {MAX_CELLS} at most; take fewer bins of larger dz and dr",
            grid.depth, grid.radial, grid.angular, stack.layers().len(),
        )));
    }
    Ok(MciRun { output, line: line.number, photons, grid, stack })
}

fn read_output(line: &Line) -> Result<PathBuf, MciError> {
    let [name, format] = line.values(["file name", "A"])?;
    match format {
        "A" | "a" => {}
        "B" | "b" => {
            return Err(line.error("format B, binary output, is not supported; write A for text".into()));
        }
        _ => return Err(line.error(format!("format {format:?} is not known; write A for text"))),
    }
    let inside =
        |component| matches!(component, Component::Normal(part) if part.to_str().is_some_and(is_plain_name));
    let path = Path::new(name);
    if path.components().all(inside) && !name.ends_with('/') {
        return Ok(path.components().collect());
    }
    Err(line.error(format!(
        "{name:?} is refused: outputs stay in the folder of the input file and are not hidden; write a plain name such as skin.mco"
    )))
}

/// Whether a name means the same file everywhere: no drive, no other separator, not hidden.
fn is_plain_name(name: &str) -> bool {
    !name.starts_with('.')
        && !name.contains(['\\', ':', char::REPLACEMENT_CHARACTER])
        && !name.contains(char::is_control)
}

fn read_photons(line: &Line) -> Result<u64, MciError> {
    if line.words.len() != 1 || line.words[0].contains(':') {
        return Err(line.error(format!(
            "{:?} is not a whole number by itself; limits of time are not supported: write the number of photons alone",
            line.words.join(" ")
        )));
    }
    line.count_from_1(MAX_PHOTONS, "at least one photon is needed")
}

fn read_grid<'a>(lines: &mut Lines<'a>) -> Result<(Grid, Line<'a>), MciError> {
    let line = lines.next("grid steps dz dr")?;
    let steps = line.values(["dz", "dr"])?;
    let mut lengths = [0.0; 2];
    for ((length, word), name) in lengths.iter_mut().zip(steps).zip(["dz", "dr"]) {
        *length = line.number(name, word)?;
        if !STEPS.contains(length) {
            return Err(line.error(format!(
                "{name} is {word} cm; it must be from {:e} to {:e} cm",
                STEPS.start(),
                STEPS.end()
            )));
        }
    }
    let line = lines.next("numbers of bins nz nr na")?;
    let words = line.values(["nz", "nr", "na"])?;
    let mut counts = [0; 3];
    for ((count, word), name) in counts.iter_mut().zip(words).zip(["nz", "nr", "na"]) {
        *count = line.count(name, word, MAX_CELLS, "at least one bin is needed")? as usize;
    }
    let ([depth_step, radial_step], [depth, radial, angular]) = (lengths, counts);
    Ok((Grid { radial_step, radial, depth_step, depth, angular }, line))
}

/// Reads the layers; the second value is the line that says how many there are.
fn read_stack(lines: &mut Lines) -> Result<(LayerStack, usize), MciError> {
    let count_line = lines.next("number of layers")?;
    let count = count_line.count_from_1(u64::MAX, "at least one layer is needed")?;
    let hint = format!("; or is the number of layers on line {}, {count}, wrong?", count_line.number);
    let above = lines.next("n of the medium above")?;
    let ior_above = above.lone_number(&hint)?;
    let mut layers = Vec::new();
    let mut layer_lines = Vec::new();
    for _ in 0..count {
        let line = lines.next("layer, n mua mus g d")?;
        layers.push(read_layer(&line, &hint)?);
        layer_lines.push(line);
    }
    let below = lines.next("n of the medium below")?;
    let ior_below = below.lone_number(&hint)?;
    let stack = LayerStack::new(ior_above, layers, ior_below).map_err(|error| {
        let line = match &error {
            LayerError::Empty => &count_line,
            LayerError::OutOfRange { place: Place::Above, .. } => &above,
            LayerError::OutOfRange { place: Place::Below, .. } => &below,
            LayerError::OutOfRange { place: Place::Layer(number), .. } => &layer_lines[number - 1],
        };
        line.error(error.to_string())
    })?;
    Ok((stack, count_line.number))
}

fn read_layer(line: &Line, hint: &str) -> Result<Layer, MciError> {
    let names = ["n", "mua", "mus", "g", "d"];
    let words = line.values_or(names, || match line.words.len() {
        6.. => "; variants of the format with further columns are not supported".into(),
        _ => hint.into(),
    })?;
    let mut values = [0.0; 5];
    for ((value, word), name) in values.iter_mut().zip(words).zip(names) {
        *value = line.number(name, word)?;
    }
    let [ior, sigma_a, sigma_s, g, thickness] = values;
    Ok(Layer { ior, sigma_a, sigma_s, g, thickness })
}
