//! Means with their standard errors, the same bits on any number of threads.

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::walk::{Observer, Walk, random_stream};

/// A Monte Carlo estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Estimate {
    /// Mean.
    pub value: f64,
    /// Standard error of the mean (one σ); infinite if a single batch of packets cannot tell.
    #[serde(rename = "stderr")]
    pub standard_error: f64,
}

impl std::ops::Mul<f64> for Estimate {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self { value: self.value * factor, standard_error: self.standard_error * factor.abs() }
    }
}

/// An observer whose scores can be averaged over batches.
pub trait Scores: Observer + Send {
    /// Sums over the packets observed, always the same number of them.
    fn sums(&self) -> Vec<f64>;
}

/// Into how many batches the packets are divided. The standard error comes from the spread between
/// batches, whatever the correlation of scores within a packet's history; it has itself an error of
/// 1/√(2·255) = 4 %.
pub const BATCHES: u64 = 256;

/// Batches whose scores are held at the same time.
const ROUND: u64 = 32;

/// Packets between two looks at whether to stop.
const SLICE: u64 = 1 << 10;

/// What was estimated.
pub struct Outcome {
    /// Per packet, one for each sum of the observer.
    pub estimates: Vec<Estimate>,
    /// Packets walked: fewer than asked for if it was stopped.
    pub photons: u64,
}

/// Walks `photons` packets in [`BATCHES`] batches on all threads; `observer` makes an empty observer for a batch, given its number.
///
/// Batch k uses stream k of `seed`, and batches are summed in order: the result depends on nothing else.
/// `advance` is told now and then how many packets more are done. When `stop` becomes true, those that have
/// been walked count.
pub fn estimate<S: Scores>(
    walk: &Walk,
    photons: u64,
    seed: u64,
    observer: impl Fn(u64) -> S + Sync,
    advance: impl Fn(u64) + Sync,
    stop: &AtomicBool,
) -> Outcome {
    let batch = |k: u64| {
        let count = photons / BATCHES + u64::from(k < photons % BATCHES);
        let mut scores = observer(k);
        let mut random = random_stream(seed, k);
        let mut done = 0;
        while done < count && !stop.load(Ordering::Relaxed) {
            let slice = SLICE.min(count - done);
            walk.go_on(slice, &mut random, &mut scores);
            done += slice;
            advance(slice);
        }
        (done, scores.sums())
    };
    let mut moments = Moments::default();
    for first in (0..BATCHES).step_by(ROUND as usize) {
        if stop.load(Ordering::Relaxed) {
            break;
        }
        let round: Vec<_> = (first..first + ROUND).into_par_iter().map(batch).collect();
        round.iter().for_each(|(count, sums)| moments.add(*count, sums));
    }
    Outcome { estimates: moments.estimates(), photons: moments.photons }
}

/// Sums over batches of the batches' sums and of their squares per packet.
#[derive(Default)]
struct Moments {
    batches: u64,
    photons: u64,
    sums: Vec<f64>,
    squares: Vec<f64>,
}

impl Moments {
    fn add(&mut self, count: u64, sums: &[f64]) {
        self.sums.resize(sums.len(), 0.0);
        self.squares.resize(sums.len(), 0.0);
        if count == 0 {
            return;
        }
        self.batches += 1;
        self.photons += count;
        for ((total, square), sum) in self.sums.iter_mut().zip(&mut self.squares).zip(sums) {
            *total += sum;
            *square += sum * sum / count as f64;
        }
    }

    /// With n_b packets and sum s_b in batch b: mean m = Σs_b/N, and as Var(s_b) = n_b σ², an estimate of σ²
    /// from B batches is (Σ s_b²/n_b − N m²)/(B − 1).
    fn estimates(&self) -> Vec<Estimate> {
        let photons = self.photons as f64;
        let degrees = self.batches.saturating_sub(1) as f64;
        let estimate = |(sum, square): (&f64, &f64)| {
            let value = sum / photons;
            // Rounding may make it negative.
            let variance =
                if degrees > 0.0 { ((square - value * sum) / degrees).max(0.0) } else { f64::INFINITY };
            Estimate { value, standard_error: (variance / photons).sqrt() }
        };
        self.sums.iter().zip(&self.squares).map(estimate).collect()
    }
}
