//! One walk without absorption for all albedos of a slab.
//!
//! A packet that leaves after n collisions would have been left with ωⁿ of its weight in a slab of albedo ω. Each flight is scored by the
//! chance that it leaves through the face ahead, e^(−τ)(1 − F), whether it does or not.

use std::sync::atomic::AtomicBool;

use alabaster::optics::fresnel::Interface;
use alabaster::slab::{Estimate, Face, Observer, Photon, Roulette, Scores, Source, Walk, estimate};

use super::slab;

/// Numbers of collisions beyond this count as this; the roulette lets one photon in 10⁶ come so far.
const MOST_COLLISIONS: usize = 1 << 16;
const PILOT: u64 = 1 << 15;

/// A slab to be walked through without absorption.
pub struct White<'a> {
    tau: f64,
    g: f64,
    eta: f64,
    /// 1 − ω of the slabs that are wanted.
    absorbed: &'a [f64],
}

/// Light that left, for one albedo.
pub struct Left {
    pub reflected: Estimate,
    pub transmitted: Estimate,
}

impl<'a> White<'a> {
    pub fn new(tau: f64, g: f64, eta: f64, absorbed: &'a [f64]) -> Self {
        Self { tau, g, eta, absorbed }
    }

    /// For each albedo, with a standard error of about `sigma` or less.
    pub fn run_to_sigma(&self, source: Source, sigma: f64, seed: u64) -> Vec<Left> {
        let pilot = self.run(source, PILOT, seed);
        let errors = pilot.iter().flat_map(|left| [left.reflected, left.transmitted]);
        let largest = errors.map(|found| found.standard_error).fold(0.0, f64::max);
        let photons = (PILOT as f64 * (largest / sigma).powi(2)) as u64 + PILOT;
        self.run(source, photons, seed + 1)
    }

    fn run(&self, source: Source, photons: u64, seed: u64) -> Vec<Left> {
        // As in the walks for the tabulated profile: each doubling of the collisions takes about the same work. Light in a slab
        // leaves it before.
        let collisions = if self.tau.is_finite() { 1 << 12 } else { (4.0 / (1.0 - self.g).sqrt()) as u64 };
        let walk =
            Walk::new(&slab(self.tau, 1.0, self.g, self.eta), source, Roulette { weight: 0.0, collisions });
        let stop = AtomicBool::new(false);
        let found = estimate(&walk, photons, seed, || Tally::new(self), |_| {}, &stop).estimates;
        found.chunks(2).map(|pair| Left { reflected: pair[0], transmitted: pair[1] }).collect()
    }
}

struct Tally<'a> {
    white: &'a White<'a>,
    specular: f64,
    /// By number of collisions: what left at the top, at the bottom.
    left: Vec<[f64; 2]>,
}

impl<'a> Tally<'a> {
    fn new(white: &'a White) -> Self {
        Self { white, specular: 0.0, left: Vec::new() }
    }

    fn score(&mut self, collisions: u64, face: usize, weight: f64) {
        let n = (collisions as usize).min(MOST_COLLISIONS);
        if n >= self.left.len() {
            self.left.resize(n + 1, [0.0; 2]);
        }
        self.left[n][face] += weight;
    }
}

impl Observer for Tally<'_> {
    fn fly(&mut self, photon: &Photon) {
        let White { tau, eta, .. } = *self.white;
        let [.., mut z] = photon.position;
        let [.., mut down] = photon.direction;
        let mut weight = photon.weight;
        let inside = Interface::new(down.abs(), 1.0 / eta);
        // The flight goes on to and fro between the faces as long as anything is left of it.
        while weight > 1e-12 {
            let to_face = if down < 0.0 { z / -down } else { (tau - z) / down };
            weight *= (-to_face).exp();
            self.score(photon.collisions, usize::from(down > 0.0), weight * inside.transmittance);
            weight *= inside.reflectance;
            z = if down < 0.0 { 0.0 } else { tau };
            down = -down;
        }
    }

    fn collide(&mut self, _photon: &Photon) {}

    fn leave(&mut self, _photon: &Photon, _face: Face) {}

    fn reflect_at_entry(&mut self, weight: f64, _cosine: f64) {
        self.specular += weight;
    }
}

impl Scores for Tally<'_> {
    fn sums(&self) -> Vec<f64> {
        let left = |share: &f64| {
            let mut sums = [self.specular, 0.0];
            for (n, [top, bottom]) in self.left.iter().enumerate() {
                // ωⁿ with the digits of 1 − ω.
                let weight = (n as f64 * (-share).ln_1p()).exp();
                sums[0] += top * weight;
                sums[1] += bottom * weight;
            }
            sums
        };
        self.white.absorbed.iter().flat_map(left).collect()
    }
}
