//! Files that `alabaster slab` writes.

use std::collections::HashSet;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use super::error::CliError;
use crate::film::output::{check_writable, replace};
use crate::slab::csv::write_csv;
use crate::slab::mco::{Header, write_mco};
use crate::slab::{MciRun, Scattered, Simulation};

/// A run that was simulated.
pub struct Finished {
    /// What was asked for.
    pub simulation: Simulation,
    /// What came of it.
    pub scattered: Scattered,
    /// Packets walked: fewer than asked for if it was interrupted.
    pub photons: u64,
    /// Seconds that it took.
    pub seconds: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    /// All tables of a run, as MCML writes them.
    Mco,
    /// All tables of a run, with their standard errors.
    Csv,
    /// The totals of all runs.
    Json,
}

impl Format {
    fn of(path: &Path) -> Result<Self, CliError> {
        match path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase().as_str() {
            "mco" => Ok(Self::Mco),
            "csv" => Ok(Self::Csv),
            "json" => Ok(Self::Json),
            _ => Err(CliError::input(format!(
                "{}: slabs are written as .mco, .csv or .json; choose one of these endings",
                path.display()
            ))),
        }
    }
}

/// Which file is to hold what.
pub struct Outputs {
    by_run: Vec<Vec<(Format, PathBuf)>>,
    summaries: Vec<PathBuf>,
}

impl Outputs {
    /// The files of the runs read from `input`: `wanted`, or if there are none those that the runs name. Makes sure
    /// that they differ and can be written.
    pub fn plan(input: &Path, wanted: &[PathBuf], runs: &[MciRun]) -> Result<Self, CliError> {
        let mut outputs = Self { by_run: vec![Vec::new(); runs.len()], summaries: Vec::new() };
        for path in wanted {
            match Format::of(path)? {
                Format::Json => outputs.summaries.push(path.clone()),
                format => {
                    for (i, files) in outputs.by_run.iter_mut().enumerate() {
                        files.push((
                            format,
                            if runs.len() > 1 { numbered(path, i + 1) } else { path.clone() },
                        ));
                    }
                }
            }
        }
        if wanted.is_empty() {
            let folder = input.parent().unwrap_or(Path::new(""));
            for (files, run) in outputs.by_run.iter_mut().zip(runs) {
                files.push((Format::Mco, folder.join(&run.output)));
            }
        }
        outputs.check(input)?;
        Ok(outputs)
    }

    fn check(&self, input: &Path) -> Result<(), CliError> {
        let input = fs::canonicalize(input).ok();
        let mut seen = HashSet::new();
        for path in self.by_run.iter().flatten().map(|(_, path)| path).chain(&self.summaries) {
            if input.is_some() && fs::canonicalize(path).ok() == input {
                return Err(CliError::input(format!(
                    "{}: is the input; write to another file",
                    path.display()
                )));
            }
            if !seen.insert(path) {
                return Err(CliError::input(format!("{}: would be written twice", path.display())));
            }
            check_writable(path)?;
        }
        Ok(())
    }

    /// Files of run `i` alone.
    pub fn of_run(&self, i: usize) -> impl Iterator<Item = &Path> {
        self.by_run[i].iter().map(|(_, path)| path.as_path())
    }

    /// Writes the files of run `i`.
    pub fn write_run(&self, i: usize, run: &MciRun, finished: &Finished) -> Result<(), CliError> {
        let Finished { simulation, scattered, photons, seconds } = finished;
        for (format, path) in &self.by_run[i] {
            replace(path, |file| match format {
                Format::Csv => write_csv(file, scattered),
                _ => {
                    let header = Header {
                        output: &run.output,
                        photons: *photons,
                        seconds: *seconds,
                        seed: simulation.seed,
                        source: simulation.source,
                    };
                    write_mco(file, &header, &simulation.stack, scattered)
                }
            })?;
        }
        Ok(())
    }

    /// Writes the files that hold the totals of all runs.
    pub fn write_summaries(&self, json: &str) -> Result<(), CliError> {
        for path in &self.summaries {
            replace(path, |file| writeln!(file, "{json}"))?;
        }
        Ok(())
    }
}

/// `out.mco` → `out-2.mco`.
fn numbered(path: &Path, number: usize) -> PathBuf {
    let mut name = path.file_stem().unwrap_or_default().to_owned();
    name.push(format!("-{number}."));
    name.push(path.extension().unwrap_or_default());
    path.with_file_name(name)
}
