//! The program, run as a person runs it.

use std::path::{Path, PathBuf};
use std::time::Duration;

use assert_cmd::Command;
use serde_json::Value;
use tempfile::TempDir;

/// A sphere of marble in even light.
pub const SCENE: &str = r#"
[[object]]
shape = "sphere"
center = [0, 0, 0]
radius = 1.0
material = "marble"

[camera]
position = [0, 0, 4]
target = [0, 0, 0]
fov = 40.0

[environment]
radiance = [1, 0.8, 0.6]

[material.marble]
type = "translucent"
ior = 1.5
sigma_a = [2.1, 4.1, 7.1]
sigma_s = [2190, 2620, 3000]
"#;

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
        self.fails(2, part);
    }

    /// Asserts exit code `code`, one message that contains `part`, and no result.
    #[track_caller]
    pub fn fails(&self, code: i32, part: &str) {
        assert_eq!((self.code, self.errors(), self.stdout.as_str()), (code, 1, ""), "{self:?}");
        assert!(self.stderr.contains(part), "no {part:?} in {self:?}");
    }

    /// Standard output and standard error of a run that must have ended with `code`.
    #[track_caller]
    pub fn ends_with(self, code: i32) -> (String, String) {
        assert_eq!(self.code, code, "{self:?}");
        (self.stdout, self.stderr)
    }

    /// The JSON on standard output of a run that must have succeeded.
    #[track_caller]
    pub fn report(self) -> Value {
        serde_json::from_str(&self.ends_with(0).0).unwrap()
    }

    /// Lines on standard error that report an error.
    pub fn errors(&self) -> usize {
        self.stderr.lines().filter(|line| line.starts_with("error:")).count()
    }
}

/// A directory for a test, gone at its end.
pub struct Folder(TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// An empty name stands for the directory itself.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The names of what is in it.
    pub fn names(&self) -> Vec<String> {
        names(self.0.path())
    }

    /// Runs the program in it.
    #[track_caller]
    pub fn run(&self, arguments: &[&str]) -> Run {
        run(self.0.path(), arguments)
    }

    /// The run must fail with `code` and one message that contains `part`, and write nothing.
    #[track_caller]
    pub fn refuses(&self, arguments: &[&str], code: i32, part: &str) {
        let before = self.names();
        self.run(arguments).fails(code, part);
        assert_eq!(self.names(), before);
    }
}

/// The names of what is in `folder`, sorted.
pub fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Runs the program in `folder`. It must end by itself within ten seconds, without a panic.
#[track_caller]
pub fn run(folder: &Path, arguments: &[&str]) -> Run {
    run_within(Duration::from_secs(10), folder, arguments)
}

/// The same, with another limit on its time.
#[track_caller]
pub fn run_within(limit: Duration, folder: &Path, arguments: &[&str]) -> Run {
    end(Command::new(env!("CARGO_BIN_EXE_alabaster")).args(arguments), limit, folder)
}

/// Runs the program in `folder` with so many KiB of addresses.
#[cfg(unix)]
#[track_caller]
pub fn run_within_memory(limit: u64, folder: &Path, arguments: &[&str]) -> Run {
    let mut shell = Command::new("sh");
    shell.args(["-c", "ulimit -v $0 && exec \"$@\"", &limit.to_string(), env!("CARGO_BIN_EXE_alabaster")]);
    end(shell.args(arguments), Duration::from_secs(10), folder)
}

#[track_caller]
fn end(command: &mut Command, limit: Duration, folder: &Path) -> Run {
    let command = command.current_dir(folder).env_remove("RUST_LOG").env("RUST_BACKTRACE", "1");
    let output = command.timeout(limit).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let (stdout, stderr) = (text(output.stdout), text(output.stderr));
    let Some(code) = output.status.code() else { panic!("{command:?}: killed; {stderr}") };
    for sign in ["panicked", "internal error", "stack backtrace", "RUST_BACKTRACE"] {
        assert!(!stderr.contains(sign), "{command:?}: {stderr}");
    }
    Run { code, stdout, stderr }
}

/// Runs the program in `folder` and interrupts it (Ctrl-C), `pause` after it has said `ready`.
#[cfg(unix)]
pub fn run_interrupted(folder: &Path, arguments: &[&str], ready: &str, pause: Duration) -> Run {
    use std::io::{BufRead, BufReader};
    use std::process::{Command, Stdio};

    let mut child = Command::new(env!("CARGO_BIN_EXE_alabaster"))
        .current_dir(folder)
        .env_remove("RUST_LOG")
        .arg("-v")
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
    assert!(lines.any(|line| line.contains(ready)), "never said {ready:?}");
    std::thread::sleep(pause);
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let stderr: Vec<String> = lines.collect();
    let code = child.wait().unwrap().code().unwrap();
    Run { code, stdout: String::new(), stderr: stderr.join("\n") }
}

/// `render SCENE -o OUTPUT` at 16×16, one sample a pixel.
#[track_caller]
pub fn render_tiny(folder: &Path, scene: &str, output: &str) -> Run {
    run(folder, &["render", scene, "-o", output, "--width", "16", "--height", "16", "--spp", "1", "--quiet"])
}
