//! What ends work early: a signal, or its time being up.

use std::process;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::console::say;
use super::error::{CliError, Exit};

/// Flags that whatever takes long looks at.
#[derive(Clone, Debug, Default)]
pub struct Stop {
    /// No further samples or photons are wanted.
    pub now: Arc<AtomicBool>,
    interrupted: Arc<AtomicBool>,
}

impl Stop {
    /// Listens for Ctrl-C, SIGTERM and SIGHUP: the first one stops the work, a second one ends the
    /// program on the spot.
    pub fn on_signals() -> Result<Self, CliError> {
        let stop = Self::default();
        let flags = stop.clone();
        ctrlc::set_handler(move || {
            flags.now.store(true, Ordering::Relaxed);
            if flags.interrupted.swap(true, Ordering::Relaxed) {
                process::exit(Exit::Interrupted as i32);
            }
            say("stopping; interrupt again to quit without saving");
        })
        .map_err(|error| CliError::machine(format!("signals cannot be handled: {error}")))?;
        Ok(stop)
    }

    /// True once a signal has come.
    pub fn interrupted(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
    }
}
