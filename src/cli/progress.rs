//! How far a render is.

use std::sync::atomic::{AtomicU64, Ordering};

use super::bar::Bar;
use crate::film::schedule::{Limits, Status};

/// Progress of a render, told from any thread.
pub struct Progress {
    limits: Limits,
    pixels: u64,
    samples: AtomicU64,
    /// Bits of the latest error estimate.
    relative_error: AtomicU64,
    bar: Bar,
}

impl Progress {
    /// The start of a render of so many pixels.
    pub fn start(limits: Limits, pixels: u64, quiet: bool) -> Self {
        Self {
            limits,
            pixels,
            samples: AtomicU64::new(0),
            relative_error: AtomicU64::new(f64::INFINITY.to_bits()),
            bar: Bar::start(quiet),
        }
    }

    /// So many samples more, over all pixels.
    pub fn advance(&self, added: u64) {
        self.samples.fetch_add(added, Ordering::Relaxed);
        self.bar.show(|| (self.limits.fraction(&self.status()), self.message()));
    }

    /// A new estimate of the relative error.
    pub fn set_relative_error(&self, error: f64) {
        self.relative_error.store(error.to_bits(), Ordering::Relaxed);
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish();
    }

    /// Seconds since the start.
    pub fn seconds(&self) -> f64 {
        self.bar.seconds()
    }

    /// What has been done; samples per pixel are whole ones of the mean.
    fn status(&self) -> Status {
        Status {
            samples: self.samples.load(Ordering::Relaxed) / self.pixels,
            seconds: self.seconds(),
            relative_error: f64::from_bits(self.relative_error.load(Ordering::Relaxed)),
        }
    }

    fn message(&self) -> String {
        let samples_per_second = self.samples.load(Ordering::Relaxed) as f64 / self.seconds().max(1e-9);
        describe(&self.limits, &self.status(), samples_per_second)
    }
}

fn describe(limits: &Limits, status: &Status, samples_per_second: f64) -> String {
    let done = limits.fraction(status);
    let samples = match limits.samples {
        Some(limit) => format!("{} of {limit} spp", status.samples),
        None => format!("{} spp", status.samples),
    };
    let error = match status.relative_error {
        error if error.is_finite() => format!("relative error {error:.3}"),
        _ => "relative error unknown yet".into(),
    };
    let left = time_left(status.seconds, done);
    format!("{:.0} %, {samples}, {}samples/s, {error}, {left}", 100.0 * done, quantity(samples_per_second))
}

/// How long it will take yet, when `seconds` have been spent on `done` of the work.
pub fn time_left(seconds: f64, done: f64) -> String {
    match seconds * (1.0 - done) / done {
        left if left.is_finite() => format!("{} left", duration(left)),
        _ => "time left unknown".into(),
    }
}

/// A count to three digits, with the prefix of the unit that follows.
pub fn quantity(count: f64) -> String {
    match count {
        count if count >= 1e9 => format!("{:.2} G", count / 1e9),
        count if count >= 1e6 => format!("{:.2} M", count / 1e6),
        count if count >= 1e3 => format!("{:.1} k", count / 1e3),
        count => format!("{count:.0} "),
    }
}

/// A time as people say it.
pub fn duration(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match whole {
        _ if seconds < 9.95 => format!("{seconds:.1} s"),
        ..120 => format!("{whole} s"),
        120..7200 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole / 60 % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_says_what_is_done_and_what_is_left() {
        let limits = Limits { samples: Some(64), ..Limits::default() };
        let status = Status { samples: 16, seconds: 10.0, relative_error: 0.0432 };
        assert_eq!(
            describe(&limits, &status, 1.234e6),
            "25 %, 16 of 64 spp, 1.23 Msamples/s, relative error 0.043, 30 s left"
        );
        let status = Status { samples: 0, seconds: 0.0, relative_error: f64::INFINITY };
        assert_eq!(
            describe(&limits, &status, 0.0),
            "0 %, 0 of 64 spp, 0 samples/s, relative error unknown yet, time left unknown"
        );
    }

    #[test]
    fn durations_are_readable() {
        let said: Vec<String> = [0.04, 9.9, 61.2, 600.0, 7260.0].map(duration).into();
        assert_eq!(said, ["0.0 s", "9.9 s", "61 s", "10 min 00 s", "2 h 01 min"]);
    }
}
