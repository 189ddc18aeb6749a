//! How far some work is: a bar on a terminal, a line now and then elsewhere, on standard error.

use std::io::{self, IsTerminal};
use std::sync::Mutex;
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};

use super::console::say;

const LENGTH: u64 = 1000;
const SECONDS_BETWEEN_REDRAWS: f64 = 0.1;
const SECONDS_BETWEEN_LINES: f64 = 5.0;

/// Shows progress from any thread.
pub struct Bar {
    start: Instant,
    display: Display,
    /// When something is shown next, in seconds since the start.
    next: Mutex<f64>,
}

enum Display {
    Bar(ProgressBar),
    Lines,
    Nothing,
}

impl Bar {
    /// The start of the work.
    pub fn start(quiet: bool) -> Self {
        let display = if quiet {
            Display::Nothing
        } else if io::stderr().is_terminal() {
            Display::Bar(progress_bar())
        } else {
            Display::Lines
        };
        let next = if matches!(display, Display::Lines) { SECONDS_BETWEEN_LINES } else { 0.0 };
        Self { start: Instant::now(), display, next: Mutex::new(next) }
    }

    /// Shows the share of the work that is done, and a message, if it is time to.
    pub fn show(&self, state: impl FnOnce() -> (f64, String)) {
        // Whoever finds the lock taken leaves the showing to its holder.
        let Ok(mut next) = self.next.try_lock() else { return };
        let seconds = self.seconds();
        if seconds < *next {
            return;
        }
        match &self.display {
            Display::Bar(bar) => {
                let (done, message) = state();
                bar.set_position((done * LENGTH as f64) as u64);
                bar.set_message(message);
                *next = seconds + SECONDS_BETWEEN_REDRAWS;
            }
            Display::Lines => {
                say(&state().1);
                *next = seconds + SECONDS_BETWEEN_LINES;
            }
            Display::Nothing => *next = f64::INFINITY,
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        if let Display::Bar(bar) = &self.display {
            bar.finish_and_clear();
        }
    }

    /// Seconds since the start.
    pub fn seconds(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }
}

fn progress_bar() -> ProgressBar {
    let bar = ProgressBar::new(LENGTH);
    match ProgressStyle::with_template("{bar:30} {msg}") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
