//! How far a photon Monte Carlo is.

use std::sync::atomic::{AtomicU64, Ordering};

use super::bar::Bar;
use super::progress::{quantity, time_left};

/// Progress of a run, told from any thread.
pub struct PhotonProgress<'a> {
    label: &'a str,
    photons: u64,
    done: AtomicU64,
    /// What shows it.
    pub bar: Bar,
}

impl<'a> PhotonProgress<'a> {
    /// The start of a run of so many photons, called `label`.
    pub fn start(photons: u64, label: &'a str, quiet: bool) -> Self {
        Self { label, photons, done: AtomicU64::new(0), bar: Bar::start(quiet) }
    }

    /// So many photons more.
    pub fn advance(&self, added: u64) {
        let done = self.done.fetch_add(added, Ordering::Relaxed) + added;
        self.bar.show(|| {
            let seconds = self.bar.seconds();
            let fraction = done as f64 / self.photons as f64;
            let rate = quantity(done as f64 / seconds.max(1e-9));
            let left = time_left(seconds, fraction);
            (fraction, format!("{}: {:.0} %, {rate}photons/s, {left}", self.label, 100.0 * fraction))
        });
    }
}
