//! Errors of commands and their exit codes.

use std::fmt::Display;
use std::process::ExitCode;

use thiserror::Error;

use super::console::say;
use crate::film::FilmError;
use crate::film::output::OutputError;
use crate::plan::ForceError;
use crate::scene::SceneError;
use crate::transport::RenderError;

/// How the program ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// The command did what it was asked for.
    Done = 0,
    /// A check that was asked for failed.
    Failed = 1,
    /// The command line or an input file is wrong.
    Input = 2,
    /// The machine failed.
    Machine = 3,
    /// Interrupted, after the work so far was saved.
    Interrupted = 130,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

/// Why a command did not do what it was asked for.
#[derive(Debug, Error)]
pub enum CliError {
    /// A check that was asked for failed; everything else was done.
    #[error("{0}")]
    Failed(String),
    /// The command line or an input file is wrong.
    #[error("{0}")]
    Input(String),
    /// The machine failed.
    #[error("{0}")]
    Machine(String),
    /// Interrupted; what became of the work.
    #[error("interrupted; {0}")]
    Interrupted(String),
}

impl CliError {
    /// The command line or an input file is wrong.
    pub fn input(problem: impl Display) -> Self {
        Self::Input(problem.to_string())
    }

    /// The machine failed.
    pub fn machine(problem: impl Display) -> Self {
        Self::Machine(problem.to_string())
    }

    /// The exit code.
    pub fn exit(&self) -> Exit {
        match self {
            Self::Failed(_) => Exit::Failed,
            Self::Input(_) => Exit::Input,
            Self::Machine(_) => Exit::Machine,
            Self::Interrupted(_) => Exit::Interrupted,
        }
    }

    /// The one message, on standard error.
    pub fn print(&self) {
        let label = match self {
            Self::Failed(_) => "failed: ",
            Self::Input(_) | Self::Machine(_) => "error: ",
            Self::Interrupted(_) => "",
        };
        say(&format!("{label}{self}"));
    }
}

impl From<SceneError> for CliError {
    fn from(error: SceneError) -> Self {
        Self::input(error)
    }
}

impl From<OutputError> for CliError {
    fn from(error: OutputError) -> Self {
        match error {
            OutputError::UnknownEnding(_) => Self::input(error),
            OutputError::Unwritable { .. } => Self::machine(error),
        }
    }
}

impl From<FilmError> for CliError {
    fn from(error: FilmError) -> Self {
        match error {
            FilmError::Size { .. } => Self::input(error),
            FilmError::Memory { .. } => Self::machine(error),
        }
    }
}

impl From<ForceError> for CliError {
    fn from(error: ForceError) -> Self {
        Self::input(format!("--force: {error}"))
    }
}

impl From<RenderError> for CliError {
    fn from(error: RenderError) -> Self {
        match error {
            RenderError::Scatterer(_) | RenderError::Spectra(_) | RenderError::LeftOut => Self::input(error),
            RenderError::Force(error) => error.into(),
            RenderError::Raycast(_) => Self::machine(error),
        }
    }
}
