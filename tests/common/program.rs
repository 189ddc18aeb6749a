//! The program, run as a person runs it.

use std::path::Path;
use std::time::Duration;

use assert_cmd::Command;

/// How a run ended.
#[derive(Debug)]
pub struct Run {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

impl Run {
    /// Asserts that the run was refused as an input with one message that contains `part`.
    #[track_caller]
    pub fn is_refused(&self, part: &str) {
        assert_eq!(self.code, 2, "{self:?}");
        assert_eq!(self.errors(), 1, "{self:?}");
        assert!(self.stderr.contains(part), "no {part:?} in {self:?}");
    }

    /// Lines on standard error that report an error.
    pub fn errors(&self) -> usize {
        self.stderr.lines().filter(|line| line.starts_with("error:")).count()
    }
}

/// Runs the program in `folder`. It must end by itself within ten seconds, without a panic.
#[track_caller]
pub fn run(folder: &Path, arguments: &[&str]) -> Run {
    let output = Command::new(env!("CARGO_BIN_EXE_alabaster"))
        .current_dir(folder)
        .env_remove("RUST_LOG")
        .env("RUST_BACKTRACE", "1")
        .args(arguments)
        .timeout(Duration::from_secs(10))
        .output()
        .unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let (stdout, stderr) = (text(output.stdout), text(output.stderr));
    let Some(code) = output.status.code() else { panic!("{arguments:?}: killed; {stderr}") };
    for sign in ["panicked", "internal error", "stack backtrace", "RUST_BACKTRACE"] {
        assert!(!stderr.contains(sign), "{arguments:?}: {stderr}");
    }
    Run { code, stdout, stderr }
}

/// `render SCENE -o OUTPUT` at 16×16, one sample a pixel.
#[track_caller]
pub fn render_tiny(folder: &Path, scene: &str, output: &str) -> Run {
    run(folder, &["render", scene, "-o", output, "--width", "16", "--height", "16", "--spp", "1", "--quiet"])
}
