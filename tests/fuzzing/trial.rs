//! One input after another, each watched: how it ends, how long it takes, how much memory it touches.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use std::{fs, thread};

use super::{Law, seeds};

/// An input of some kilobytes that takes longer, on whatever machine, is one that hangs.
const PATIENCE: Duration = Duration::from_secs(20);

/// Most memory that one input may touch, bytes: the largest environment map takes 1.6 GB once its pixels are there, which an input of this
/// size cannot bring.
pub const MOST_MEMORY: u64 = 1 << 29;

/// As the thread of the program has.
const STACK: usize = 8 << 20;

/// Memory is that of the process: one target at a time.
static ALONE: Mutex<()> = Mutex::new(());

/// How an input ended.
struct Ended {
    verdict: Result<bool, String>,
    time: Duration,
    /// Memory touched, bytes.
    memory: u64,
}

/// The inputs of one target.
pub struct Trials {
    folder: PathBuf,
    law: Law,
    inputs: Sender<PathBuf>,
    ended: Receiver<Ended>,
    findings: Vec<(PathBuf, String)>,
    /// How long an input may take.
    pub patience: Duration,
    /// Inputs that were read.
    pub read: u64,
    /// Inputs that were refused with a message.
    pub refused: u64,
    /// The longest time and the most memory, bytes, of any input.
    pub longest: Duration,
    pub most_memory: u64,
    _alone: MutexGuard<'static, ()>,
}

impl Trials {
    /// In a folder of its own, with the files beside the inputs that they may name.
    pub fn new(target: &str, law: Law) -> Self {
        let alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fuzzing").join(target.replace(' ', "_"));
        // What an earlier run left.
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        seeds::put_beside(&folder);
        let (inputs, ended) = worker(law);
        Self {
            folder,
            law,
            inputs,
            ended,
            findings: Vec::new(),
            patience: PATIENCE,
            read: 0,
            refused: 0,
            longest: Duration::ZERO,
            most_memory: 0,
            _alone: alone,
        }
    }

    /// Tries a file of these bytes. Should it end the process, it is found in the folder of the target as `input`.
    pub fn hold(&mut self, ending: &str, bytes: &[u8]) {
        let input = self.folder.join(format!("input.{ending}"));
        fs::write(&input, bytes).unwrap();
        self.inputs.send(input.clone()).unwrap();
        let problem = match self.ended.recv_timeout(self.patience) {
            Ok(Ended { verdict, time, memory }) => {
                self.longest = self.longest.max(time);
                self.most_memory = self.most_memory.max(memory);
                match verdict {
                    Err(problem) => Some(problem),
                    _ if memory > MOST_MEMORY => Some(format!("touches {} MiB", memory >> 20)),
                    Ok(true) => {
                        self.read += 1;
                        None
                    }
                    Ok(false) => {
                        self.refused += 1;
                        None
                    }
                }
            }
            Err(RecvTimeoutError::Timeout) => {
                // The thread that hangs is left to itself.
                (self.inputs, self.ended) = worker(self.law);
                Some(format!("takes longer than {:?}", self.patience))
            }
            Err(RecvTimeoutError::Disconnected) => unreachable!("panics are caught"),
        };
        if let Some(problem) = problem.filter(|problem| !self.is_known(problem)) {
            let kept = self.folder.join(format!("finding-{}.{ending}", self.findings.len()));
            fs::write(&kept, bytes).unwrap();
            println!("{}: {problem}", kept.display());
            self.findings.push((kept, problem));
        }
    }

    /// True if something was found that reads alike but for what is quoted of the input.
    fn is_known(&self, problem: &str) -> bool {
        let words = |text: &str| -> Vec<String> {
            let words = text.split(|c: char| !c.is_ascii_alphabetic()).filter(|word| word.len() > 3);
            words.take(6).map(str::to_owned).collect()
        };
        self.findings.iter().any(|(_, known)| words(known) == words(problem))
    }

    pub fn findings(&self) -> usize {
        self.findings.len()
    }

    /// Where the input of a finding is kept.
    pub fn kept(&self, finding: usize) -> &Path {
        &self.findings[finding].0
    }

    /// Fails if anything was found.
    #[track_caller]
    pub fn finish(self) {
        assert!(self.findings.is_empty(), "{:#?}", self.findings);
    }
}

/// A thread that holds the law for each path it is sent.
fn worker(law: Law) -> (Sender<PathBuf>, Receiver<Ended>) {
    let (inputs, paths) = channel::<PathBuf>();
    let (verdicts, ended) = channel();
    let work = move || {
        for path in paths {
            if verdicts.send(hold(law, &path)).is_err() {
                return;
            }
        }
    };
    thread::Builder::new().stack_size(STACK).spawn(work).unwrap();
    (inputs, ended)
}

fn hold(law: Law, path: &Path) -> Ended {
    // Makes the peak start anew from what is resident now (Linux; elsewhere memory is not looked at).
    let _ = fs::write("/proc/self/clear_refs", "5");
    let before = status("VmRSS:");
    let begin = Instant::now();
    let verdict = catch_unwind(AssertUnwindSafe(|| law(path)));
    let time = begin.elapsed();
    let memory = status("VmHWM:").saturating_sub(before);
    let verdict = match verdict {
        Ok(Ok(read)) => Ok(read),
        Ok(Err(problem)) => Err(problem),
        Err(panic) => Err(format!("panic: {}", text_of(panic.as_ref()))),
    };
    Ended { verdict, time, memory }
}

fn text_of(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("of no text")
}

/// A line of the process's status, bytes; 0 where there is none.
fn status(line: &str) -> u64 {
    let text = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let value = text.lines().find_map(|text| text.strip_prefix(line));
    let kibibytes = value.and_then(|value| value.trim().strip_suffix(" kB")?.parse::<u64>().ok());
    kibibytes.unwrap_or(0) << 10
}
