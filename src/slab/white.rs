//! White Monte Carlo: one walk without absorption gives the profile for every albedo (Kienle and
//! Patterson 1996; Alerstam et al. 2008).
//!
//! A packet that leaves after n collisions in a medium that absorbs nothing would have been left with weight ωⁿ in one of
//! single-scattering albedo ω and the same extinction. So light is sorted by ring and by number of collisions.
//!
//! Moreover every flight towards the surface is scored by the chance that it ends outside, e^(−τ)(1 − F),
//! whether it does or not: the point where it would is known, and several flights of each packet count.
//!
//! Where the medium scatters forwards, few flights turn back after few collisions, and these are nearly all the light
//! of a dark medium. So at the first collisions two directions are looked into besides that in which the packet goes
//! on: one of the phase function and one uniform in the cone of escape, combined by the balance heuristic (Veach 1997).

use std::f64::consts::TAU;

use rand_xoshiro::Xoshiro256PlusPlus;

use super::estimate::Scores;
use super::layers::{LayerError, LayerStack};
use super::walk::{
    Face, Observer, Photon, Roulette, Source, Walk, in_unit_disk, random_stream, scattered, uniform,
};
use crate::optics::fresnel::Interface;
use crate::optics::phase::HenyeyGreenstein;

/// Rings per decade of radius.
pub const RINGS_PER_DECADE: usize = 24;
/// Decades of radius, in mean free paths 1/σ_t, from [`FIRST_RADIUS`].
pub const DECADES: usize = 8;
/// Upper radius of the first ring, in mean free paths. It reaches to the axis.
pub const FIRST_RADIUS: f64 = 1e-5;
/// Rings: one to the axis, the logarithmic ones, one without end.
pub const RINGS: usize = DECADES * RINGS_PER_DECADE + 2;

/// Numbers of collisions below this have a class each; above, classes are [`CLASS_RATIO`] wide.
const EXACT_CLASSES: usize = 64;
/// Within a class the number of collisions varies by ±2 % about the mean. To first order this averages
/// out; to second order it errs by at most (x²/2) (0.02²/3) e^(−x) < 4·10⁻⁵, x being n(1−ω).
const CLASS_RATIO: f64 = 1.04;
/// Up to 64 · 1.04⁵⁰⁰ = 2·10¹⁰ collisions.
const CLASSES: usize = EXACT_CLASSES + 500;

/// Flights that start deeper than this are scored by what becomes of them.
const LARGEST_DEPTH: f64 = 12.0;

/// Collisions at which two directions are looked into, times √(1 − g).
const LOOKS: f64 = 8.0;

/// Seed of the directions that are looked into: not that of the walk, which they do not change.
const LOOK_SEED: u64 = 0x51ab;

/// The half-space of index `eta` and mean cosine `g` whose extinction coefficient is 1, without absorption.
///
/// # Errors
/// If a value is outside its range.
pub fn white_walk(eta: f64, g: f64, source: Source) -> Result<Walk, LayerError> {
    let stack = LayerStack::half_space(eta, 0.0, 1.0, g)?;
    // Early roulette: then each doubling of the number of collisions takes about the same work, and every albedo
    // and radius has about the same share of it. Measured: for the same work the error summed over rings is a
    // quarter to a half of what it is with roulette after 64/(1 − g).
    let collisions = (4.0 / (1.0 - g).sqrt()).round() as u64;
    Ok(Walk::new(&stack, source, Roulette { weight: 0.0, collisions, kept: 0.6 }))
}

/// Radius of the outer edge of ring `i`, in mean free paths.
pub fn ring_edge(i: usize) -> f64 {
    FIRST_RADIUS * 10.0_f64.powf(i as f64 / RINGS_PER_DECADE as f64)
}

/// Counts of one batch of a white walk.
pub struct WhiteTally<'a> {
    /// Absorbed shares 1 − ω for which [`Scores::sums`] gives rings.
    absorbed_shares: &'a [f64],
    eta: f64,
    phase: HenyeyGreenstein,
    /// Cosine of the largest angle with the normal at which light comes out.
    escape_cosine: f64,
    /// Collisions at which directions are looked into.
    looks: u64,
    random: Xoshiro256PlusPlus,
    /// Weight that entered.
    entered: f64,
    /// By ring and, within it, class.
    left: Vec<f64>,
    /// By class: weight, and weight times collisions.
    class_moments: Vec<[f64; 2]>,
    /// Whether the present flight has been scored.
    scored: bool,
}

impl<'a> WhiteTally<'a> {
    /// An empty tally of batch number `batch` for the walk of relative index `eta` and mean cosine `g`.
    pub fn new(eta: f64, g: f64, absorbed_shares: &'a [f64], batch: u64) -> Self {
        Self {
            absorbed_shares,
            eta,
            phase: HenyeyGreenstein { g },
            escape_cosine: (1.0 - 1.0 / (eta * eta)).max(0.0).sqrt(),
            looks: (LOOKS / (1.0 - g).sqrt()).round() as u64,
            random: random_stream(LOOK_SEED, batch),
            entered: 0.0,
            left: vec![0.0; RINGS * CLASSES],
            class_moments: vec![[0.0; 2]; CLASSES],
            scored: false,
        }
    }

    /// Scores the light that would leave from `photon`'s position in `direction`, `collisions` behind it, if it weighed `weight`.
    #[inline]
    fn score_flight(&mut self, photon: &Photon, direction: [f64; 3], collisions: u64, weight: f64) {
        let [x, y, z] = photon.position;
        let [dx, dy, down] = direction;
        // z/|down| is the optical depth of the way out, as σ_t = 1.
        let way = -z / down;
        let interface = Interface::new(-down, 1.0 / self.eta);
        let (ex, ey) = (x + dx * way, y + dy * way);
        self.score(weight * (-way).exp() * interface.transmittance, ex * ex + ey * ey, collisions);
    }

    /// A direction uniform in the cone of escape.
    fn escaping(&mut self) -> [f64; 3] {
        let up = 1.0 - (1.0 - self.escape_cosine) * uniform(&mut self.random);
        let (a, b, s) = in_unit_disk(&mut self.random);
        let across = ((1.0 - up) * (1.0 + up) / s).sqrt();
        [a * across, b * across, -up]
    }

    /// Scores the scattered light of a collision that comes out without another.
    #[inline]
    fn look(&mut self, photon: &Photon) {
        let uniform_density = 1.0 / (TAU * (1.0 - self.escape_cosine));
        let directions = [scattered(photon.direction, self.phase, &mut self.random), self.escaping()];
        for direction in directions {
            if -direction[2] > self.escape_cosine {
                let cosine = photon.direction.iter().zip(direction).map(|(a, b)| a * b).sum();
                let density = self.phase.density(cosine);
                let weight = photon.weight * density / (density + uniform_density);
                self.score_flight(photon, direction, photon.collisions + 1, weight);
            }
        }
    }

    #[inline]
    fn score(&mut self, weight: f64, radius_squared: f64, collisions: u64) {
        let class = class(collisions);
        self.left[ring(radius_squared) * CLASSES + class] += weight;
        let moments = &mut self.class_moments[class];
        moments[0] += weight;
        moments[1] += weight * collisions as f64;
    }

    /// Mean number of collisions by class.
    fn class_means(&self) -> Vec<f64> {
        let mean = |[weight, moment]: &[f64; 2]| if *weight > 0.0 { moment / weight } else { 0.0 };
        self.class_moments.iter().map(mean).collect()
    }
}

/// The ring that holds points at this squared distance from the axis.
pub fn ring(radius_squared: f64) -> usize {
    let decades = 0.5 * (radius_squared * (1.0 / (FIRST_RADIUS * FIRST_RADIUS))).log10();
    // Saturates at 0 below the first edge, −∞ included.
    ((decades * RINGS_PER_DECADE as f64 + 1.0) as usize).min(RINGS - 1)
}

#[inline]
fn class(collisions: u64) -> usize {
    if collisions < EXACT_CLASSES as u64 {
        return collisions as usize;
    }
    let steps = (collisions as f64 / EXACT_CLASSES as f64).ln() * (1.0 / CLASS_RATIO.ln());
    (EXACT_CLASSES + steps as usize).min(CLASSES - 1)
}

impl Observer for WhiteTally<'_> {
    #[inline]
    fn fly(&mut self, photon: &Photon) {
        if photon.collisions == 0 {
            self.entered += photon.weight;
            self.scored = false;
        }
        let ([.., z], [.., down]) = (photon.position, photon.direction);
        if !self.scored && down < 0.0 && z < -down * LARGEST_DEPTH {
            self.score_flight(photon, photon.direction, photon.collisions, photon.weight);
            self.scored = true;
        }
    }

    #[inline]
    fn collide(&mut self, photon: &Photon) {
        // The flight that follows has been scored if all its directions have.
        self.scored = photon.collisions < self.looks && photon.position[2] < LARGEST_DEPTH;
        if self.scored {
            self.look(photon);
        }
    }

    fn leave(&mut self, photon: &Photon, _face: Face) {
        if !self.scored {
            self.score(photon.weight, photon.radius_squared(), photon.collisions);
        }
    }

    fn reflect_at_entry(&mut self, _weight: f64, _cosine: f64) {}
}

impl Scores for WhiteTally<'_> {
    /// For each absorbed share, the light that leaves in each ring; then the light that entered.
    fn sums(&self) -> Vec<f64> {
        let means = self.class_means();
        let mut sums = Vec::with_capacity(self.absorbed_shares.len() * RINGS + 1);
        for share in self.absorbed_shares {
            // ωⁿ with the digits of 1 − ω.
            let weights: Vec<f64> = means.iter().map(|n| (n * (-share).ln_1p()).exp()).collect();
            let dot = |row: &[f64]| row.iter().zip(&weights).map(|(a, b)| a * b).sum::<f64>();
            sums.extend(self.left.chunks(CLASSES).map(dot));
        }
        sums.push(self.entered);
        sums
    }
}
