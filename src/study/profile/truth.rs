//! The truth: photon Monte Carlo, with its own noise.

use std::sync::atomic::AtomicBool;

use super::material::Channel;
use super::rings::{RINGS, Rings, ring_at};
use crate::diffusion::HalfSpace;
use crate::medium::Entry;
use crate::slab::white::{self, WhiteTally, white_walk};
use crate::slab::{
    Estimate, Face, Layer, LayerError, LayerStack, Observer, Outcome, Photon, Roulette, Scores, Walk,
    estimate,
};

/// How much is simulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Photon packets of a walk.
    pub photons: u64,
    /// Seed of all random numbers.
    pub seed: u64,
}

/// What is told and asked while photons walk.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// Told of packets done.
    pub advance: &'a (dyn Fn(u64) + Sync),
    /// True when what is done has to do.
    pub stop: &'a AtomicBool,
}

/// Walks that [`half_spaces`] needs for `channels`: one for each boundary and phase function.
pub fn walks_needed(channels: &[Channel]) -> u64 {
    groups(channels).len() as u64
}

/// Channels of the same boundary and phase function.
fn groups(channels: &[Channel]) -> Vec<Vec<usize>> {
    let kind = |i: usize| (channels[i].medium.eta, channels[i].medium.g);
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for i in 0..channels.len() {
        match groups.iter_mut().find(|group| kind(group[0]) == kind(i)) {
            Some(group) => group.push(i),
            None => groups.push(vec![i]),
        }
    }
    groups
}

/// Rings of light that leaves the half-space of each channel, in its own mean free paths. `None` if it was stopped before
/// each channel had something.
///
/// # Errors
/// If the Monte Carlo refuses a medium.
pub fn half_spaces(
    channels: &[Channel],
    entry: Entry,
    effort: Effort,
    watch: Watch,
) -> Result<Option<Vec<Rings>>, LayerError> {
    let mut found: Vec<Option<Rings>> = vec![None; channels.len()];
    for group in groups(channels) {
        let HalfSpace { eta, g, .. } = channels[group[0]].medium;
        let share = |&i: &usize| channels[i].medium.sigma_a / channels[i].medium.sigma_t();
        let shares: Vec<f64> = group.iter().map(share).collect();
        for (&i, rings) in group.iter().zip(white_rings(eta, g, entry, &shares, effort, watch)?) {
            found[i] = Some(rings);
        }
    }
    Ok(found.into_iter().collect())
}

/// Rings for each of the shares absorbed at a collision, 1 − ω < 1, from one walk. Empty if it was stopped too early.
///
/// # Errors
/// If `eta` or `g` is outside its range.
pub fn white_rings(
    eta: f64,
    g: f64,
    entry: Entry,
    absorbed_shares: &[f64],
    effort: Effort,
    watch: Watch,
) -> Result<Vec<Rings>, LayerError> {
    let walk = white_walk(eta, g, entry.into())?;
    let empty = |batch| WhiteRings(WhiteTally::new(eta, g, absorbed_shares, batch));
    Ok(rings_per_entered(&estimate(&walk, effort.photons, effort.seed, empty, watch.advance, watch.stop)))
}

/// Rings out of groups of (rings, cumulative rings), followed by the light that entered.
fn rings_per_entered(outcome: &Outcome) -> Vec<Rings> {
    let Some((entered, groups)) = outcome.estimates.split_last() else { return Vec::new() };
    if outcome.photons == 0 {
        return Vec::new();
    }
    let rings = |group: &[Estimate]| {
        let (flux, inside) = group.split_at(RINGS);
        Rings { flux: flux.to_vec(), inside: inside.to_vec() }.scaled(1.0 / entered.value)
    };
    groups.chunks_exact(2 * RINGS).map(rings).collect()
}

/// Appends the rings and their cumulative sums, so that these have standard errors of their own.
fn push_with_cumulative(sums: &mut Vec<f64>, rings: &[f64]) {
    sums.extend(rings);
    sums.extend(rings.iter().scan(0.0, |sum, x| {
        *sum += x;
        Some(*sum)
    }));
}

/// A white tally in the rings of this study.
struct WhiteRings<'a>(WhiteTally<'a>);

impl Observer for WhiteRings<'_> {
    #[inline]
    fn fly(&mut self, photon: &Photon) {
        self.0.fly(photon);
    }

    #[inline]
    fn collide(&mut self, photon: &Photon) {
        self.0.collide(photon);
    }

    fn leave(&mut self, photon: &Photon, face: Face) {
        self.0.leave(photon, face);
    }

    fn reflect_at_entry(&mut self, weight: f64, cosine: f64) {
        self.0.reflect_at_entry(weight, cosine);
    }
}

impl Scores for WhiteRings<'_> {
    fn sums(&self) -> Vec<f64> {
        let fine = self.0.sums();
        let Some((entered, groups)) = fine.split_last() else { return Vec::new() };
        let mut sums = Vec::new();
        for rings in groups.chunks_exact(white::RINGS) {
            // The first and the last ring are the same in both; of the others, two make one.
            let (first, rest) = (rings[0], &rings[1..]);
            let pairs = rest.chunks(2).map(|pair| pair.iter().sum::<f64>());
            push_with_cumulative(&mut sums, &[first].into_iter().chain(pairs).collect::<Vec<_>>());
        }
        sums.push(*entered);
        sums
    }
}

/// Light that leaves a slab in the same medium on both sides, in its mean free paths: at the face where it entered, and
/// at the other. What never collided is in the first ring. `None` if it was stopped too early.
///
/// # Errors
/// If the Monte Carlo refuses the slab.
pub fn slab(
    medium: &HalfSpace,
    thickness: f64,
    entry: Entry,
    effort: Effort,
    watch: Watch,
) -> Result<Option<[Rings; 2]>, LayerError> {
    let sigma_t = medium.sigma_t();
    let layer = Layer {
        ior: medium.eta,
        sigma_a: medium.sigma_a / sigma_t,
        sigma_s: medium.sigma_s / sigma_t,
        g: medium.g,
        thickness: thickness * sigma_t,
    };
    let stack = LayerStack::new(1.0, vec![layer], 1.0)?;
    let walk = Walk::new(&stack, entry.into(), Roulette::default());
    let outcome =
        estimate(&walk, effort.photons, effort.seed, |_| SlabRings::new(), watch.advance, watch.stop);
    let rings = rings_per_entered(&outcome);
    Ok(<[Rings; 2]>::try_from(rings).ok())
}

/// Rings at both faces of a slab.
struct SlabRings {
    faces: [Vec<f64>; 2],
    entered: f64,
}

impl SlabRings {
    fn new() -> Self {
        Self { faces: [vec![0.0; RINGS], vec![0.0; RINGS]], entered: 0.0 }
    }
}

impl Observer for SlabRings {
    #[inline]
    fn fly(&mut self, photon: &Photon) {
        if photon.collisions == 0 {
            self.entered += photon.weight;
        }
    }

    #[inline]
    fn collide(&mut self, _photon: &Photon) {}

    fn leave(&mut self, photon: &Photon, face: Face) {
        let face = match face {
            Face::Top => 0,
            Face::Bottom => 1,
        };
        let ring = if photon.collisions == 0 { 0 } else { ring_at(photon.radius_squared()) };
        self.faces[face][ring] += photon.weight;
    }

    fn reflect_at_entry(&mut self, _weight: f64, _cosine: f64) {}
}

impl Scores for SlabRings {
    fn sums(&self) -> Vec<f64> {
        let mut sums = Vec::with_capacity(4 * RINGS + 1);
        self.faces.iter().for_each(|rings| push_with_cumulative(&mut sums, rings));
        sums.push(self.entered);
        sums
    }
}
