//! What a study keeps on the disk: its plan, and each run as soon as it is done.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::plan::Plan;
use crate::film::output::{OutputError, replace};
use crate::film::{Picture, exr};

/// A point of a run's curve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Samples per pixel.
    pub spp: u64,
    /// Seconds of rendering so far.
    pub seconds: f64,
    /// relMSE against the reference, by region; empty where it is not wanted.
    pub relmse: Vec<f64>,
}

/// What is known of a run beside its picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Seed.
    pub seed: u64,
    /// Seconds to make the renderer ready.
    pub setup_seconds: f64,
    /// As samples were added.
    pub points: Vec<Point>,
    /// Samples that were not finite and added nothing.
    pub nonfinite: u64,
    /// Paths cut by a limit on their length.
    pub capped: u64,
    /// Collisions inside scattering bodies.
    pub collisions: u64,
}

impl Record {
    /// Samples per pixel, and the seconds that they took.
    pub fn end(&self) -> (u64, f64) {
        self.points.last().map_or((0, 0.0), |point| (point.spp, point.seconds))
    }
}

/// A run that is done.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// What is known of it.
    pub record: Record,
    /// Its picture.
    pub picture: Picture,
}

/// The directory of a study.
#[derive(Clone, Debug)]
pub struct Store {
    directory: PathBuf,
}

impl Store {
    /// Makes the directory, if it is not there.
    ///
    /// # Errors
    /// If it cannot be made.
    pub fn open(directory: &Path) -> Result<Self, OutputError> {
        let runs = directory.join("runs");
        fs::create_dir_all(&runs).map_err(|problem| OutputError::Unwritable { path: runs, problem })?;
        Ok(Self { directory: directory.to_path_buf() })
    }

    /// Where a file of that name lies.
    pub fn path(&self, name: &str) -> PathBuf {
        self.directory.join(name)
    }

    fn plan_path(&self) -> PathBuf {
        self.path("runs/plan.json")
    }

    fn run_path(&self, series: &str, run: usize, ending: &str) -> PathBuf {
        self.path(&format!("runs/{series}-{run:02}.{ending}"))
    }

    /// The plan of an earlier call; `None` if there is none that can be read.
    pub fn plan(&self) -> Option<Plan> {
        read_json(&self.plan_path())
    }

    /// Keeps the plan.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn keep_plan(&self, plan: &Plan) -> Result<(), OutputError> {
        write_json(&self.plan_path(), plan)
    }

    /// A run that is done; one of which a file is missing or damaged is not.
    pub fn run(&self, series: &str, run: usize) -> Option<Run> {
        let record: Record = read_json(&self.run_path(series, run, "json"))?;
        let picture = exr::read_picture(&self.run_path(series, run, "exr")).ok()?;
        Some(Run { record, picture })
    }

    /// Keeps a run. The record is written last, so that a run which has one is whole.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn keep_run(&self, series: &str, run: usize, done: &Run) -> Result<(), OutputError> {
        replace(&self.run_path(series, run, "exr"), |file| exr::write(file, &done.picture, &[], &[]))?;
        write_json(&self.run_path(series, run, "json"), &done.record)
    }

    /// Writes a result.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, name: &str, content: &[u8]) -> Result<(), OutputError> {
        replace(&self.path(name), |file| file.write_all(content))
    }
}

fn read_json<T: for<'a> Deserialize<'a>>(path: &Path) -> Option<T> {
    serde_json::from_slice(&fs::read(path).ok()?).ok()
}

fn write_json(path: &Path, value: &impl Serialize) -> Result<(), OutputError> {
    replace(path, |file| serde_json::to_writer_pretty(file, value).map_err(io::Error::from))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::radiometry::Rgb;

    fn run() -> Run {
        let points = vec![Point { spp: 4, seconds: 0.1 + 0.2, relmse: vec![-1e-300, 0.1] }];
        Run {
            record: Record {
                seed: u64::MAX,
                setup_seconds: 0.5,
                points,
                nonfinite: 0,
                capped: 1,
                collisions: 7,
            },
            picture: Picture { width: 2, height: 1, pixels: vec![Rgb::new(0.1, 1e-20, 3e4), Rgb::ONE] },
        }
    }

    #[test]
    fn what_is_kept_comes_back() {
        let directory = tempfile::tempdir().unwrap();
        let store = Store::open(&directory.path().join("new/deep")).unwrap();
        assert_eq!((store.run("walk", 3), store.plan()), (None, None));
        store.keep_run("walk", 3, &run()).unwrap();
        assert_eq!(store.run("walk", 3), Some(run()));
        assert_eq!(store.run("walk", 2), None);
    }

    #[test]
    fn a_damaged_run_is_not_done() {
        let directory = tempfile::tempdir().unwrap();
        let store = Store::open(directory.path()).unwrap();
        store.keep_run("walk", 0, &run()).unwrap();
        store.write("runs/walk-00.exr", b"nonsense").unwrap();
        assert_eq!(store.run("walk", 0), None);
    }
}
