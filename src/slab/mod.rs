//! Photon Monte Carlo in layered slabs: the truth for diffusion profiles.

pub mod csv;
pub mod estimate;
pub mod layers;
mod lines;
pub mod mci;
pub mod mco;
pub mod scattered;
pub mod tally;
pub mod walk;
pub mod white;

use std::sync::atomic::AtomicBool;

pub use estimate::{BATCHES, Estimate, Outcome, Scores, estimate};
pub use layers::{Layer, LayerError, LayerStack};
pub use mci::{MciError, MciRun, read_mci};
pub use scattered::{Inside, Leaving, Scattered};
pub use tally::{Grid, Pieces, Tally};
pub use walk::{Face, Observer, Photon, Roulette, Source, Walk};

/// What is to be simulated.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulation {
    /// The layers.
    pub stack: LayerStack,
    /// How light enters.
    pub source: Source,
    /// Where it is counted.
    pub grid: Grid,
    /// Number of photon packets.
    pub photons: u64,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl Simulation {
    /// Runs on all threads; the result depends on nothing but `self`. `advance` is told of packets done.
    /// When `stop` becomes true, what is done so far counts: the second value is the number of packets walked.
    pub fn run(&self, advance: impl Fn(u64) + Sync, stop: &AtomicBool) -> (Scattered, u64) {
        let walk = Walk::new(&self.stack, self.source, Roulette::default());
        let pieces = Pieces::new(&self.stack, self.grid);
        let outcome = estimate(&walk, self.photons, self.seed, |_| Tally::new(&pieces), advance, stop);
        (Scattered::new(&pieces, &outcome.estimates), outcome.photons)
    }
}
