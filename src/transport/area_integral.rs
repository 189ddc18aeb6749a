//! The area integral of the BSSRDF, L_o = ∫_A ∫_Ω S L_i cosθ dω dA, sampled with probe rays.
//!
//! Light that leaves at x_o came in at some x_i on the same body. Given x_o, this module draws x_i.
//!
//! **Drawing.** A radius is drawn from the profile of one colour channel, an angle uniformly, and
//! the point of the disk around x_o so found is carried onto the body by a probe: a segment through
//! it along the normal, which reports *every* sheet it crosses. A sheet seen edge-on along the normal is
//! seen along one of the two tangents, so there are three axes (King et al. 2013, "BSSRDF Importance
//! Sampling"). The same point can thus be found in up to nine ways, three axes and three channels.
//! They are combined by multiple importance sampling: the channels by the mean R̄ of their
//! densities, the axes by the partition of unity π_a = |n·a| / Σ_b |n·b|, which depends on nothing
//! but the sheet's geometric normal n. Through axis a, a point at distance r is found with area density
//! |n·a| R̄(r_a), r_a being its distance from the axis, so it has in channel c the weight
//!
//! w_c = π_a R_c(r) / (|n·a| R̄(r_a)) = γ R_c(r) / R̄(r_a),  γ = 1 / Σ_b |n·b| ≤ 1.
//!
//! The sum of w_c over all crossings of the three probes is an unbiased estimate of ∫_A R_c dA
//! ([`AreaIntegral::crossings`]).
//!
//! **Length of the probe.** The profile has no end, so a probe of fixed length would lose energy. The
//! probe is cut at random instead: with u uniform, it reaches as far as R̄(r) ≥ τ u R̄(r_a). A crossing
//! is then included with probability q = min(1, R̄(r)/(τ R̄(r_a))) and its weight divided by q.
//!
//! **Energy.** ∫_A R_c dA is 1 on a plane, but below 1 on small convex bodies and above 1 in slabs and
//! concave corners, where the same energy is counted on several sheets; a path that visits such places again
//! and again would gain without bound. Here every line of the disk carries just the energy it has on
//! the plane, R_c(r_a)/R̄(r_a): where a probe crosses several sheets they share it in proportion to w_c, and where
//! it crosses none, the next axis and then a new line is asked. So the weight of x_i has the expectation 1 in
//! every channel on every body. Channels are drawn, and R̄ is the mean of the densities, in proportion
//! to the light they carry; so the light carried by all channels together is exactly the same after as before,
//! and no weight can exceed the inverse of its channel's share.

use std::cell::RefCell;
use std::f32::consts::TAU;

use glam::Vec3;
use smallvec::SmallVec;

use super::counters::ProbeCounters;
use super::spread::{Channels, Spread};
use crate::diffusion::Profile;
use crate::math::sampler::HashGenerator;
use crate::math::{Frame, SampleStream};
use crate::radiometry::Spectrum;
use crate::raycast::{Hit, Ray, RayCaster};

/// Share τ of the density on the disk below which crossings are included by chance only.
const CERTAIN_RATIO: f32 = 0.05;

/// Lines tried before light is taken to enter where it left. A body fills a good part of the ball that
/// its own diameter allows, so that this is not reached in practice; it is counted.
const MAX_LINES: u32 = 64;

/// Where the light that leaves at x_o came in.
#[derive(Clone, Copy, Debug)]
pub struct EntryPoint<const N: usize = 3> {
    /// The crossing; `None`: at x_o itself.
    pub hit: Option<Hit>,
    /// Weight per channel; expectation 1, mean over the channels by what they carry always 1.
    pub weight: Spectrum<N>,
}

/// A sheet crossed by a probe.
#[derive(Clone, Copy, Debug)]
pub struct Crossing<const N: usize = 3> {
    /// Where.
    pub hit: Hit,
    /// Weight w_c per channel (for the profile cut at the body's diameter).
    pub weight: Spectrum<N>,
}

/// Crossings of a probe. Most have one or two; of more than a few the rest are on the heap.
type Crossings<const N: usize> = SmallVec<[Crossing<N>; 8]>;

thread_local! {
    static HITS: RefCell<Vec<Hit>> = const { RefCell::new(Vec::new()) };
}

/// The area integral around one point.
pub struct AreaIntegral<'a, C, G, P, const N: usize = 3> {
    /// Finds the crossings.
    pub caster: &'a C,
    /// Unit geometric normal of a hit triangle.
    pub geometric_normal: G,
    /// The body.
    pub instance: u32,
    /// Profiles.
    pub spread: &'a Spread<P, N>,
    /// What the channels carry.
    pub channels: Channels<N>,
    /// x_o.
    pub position: Vec3,
    /// Bound on the error of the coordinates of x_o, m.
    pub position_error: f32,
    /// Unit normal at x_o.
    pub normal: Vec3,
}

/// The numbers that fix one line of the disk.
struct Line {
    radius: f32,
    angle: f32,
    /// u of the probe's random end.
    cut: f32,
}

impl<C, G, P, const N: usize> AreaIntegral<'_, C, G, P, N>
where
    C: RayCaster,
    G: Fn(&Hit) -> Vec3,
    P: Profile + Copy,
{
    /// Draws where the light came in. Uses the places `set` and `set + 1` of the stream.
    pub fn sample(&self, stream: &SampleStream, set: u32, counters: &mut ProbeCounters) -> EntryPoint<N> {
        let crossings = &mut Crossings::new();
        HITS.with_borrow_mut(|hits| {
            let [channel, radius, angle, rotation] = stream.quad(set);
            let [cut, accept, choice, _] = stream.quad(set + 1);
            let axes = self.axes(rotation);
            let hero = self.channels.draw(Spectrum::ONE, channel);
            let line =
                Line { radius: self.spread.sample_radius(hero, radius), angle: TAU * angle, cut: 1.0 - cut };
            let densities = self.spread.densities(line.radius, self.channels);
            let mean = self.channels.mean(densities);
            // The energy per channel that this line carries on the plane.
            let budget = if mean > 0.0 && mean.is_finite() { densities / mean } else { Spectrum::ONE };
            if !self.is_resolved(&line) {
                return EntryPoint { hit: None, weight: budget };
            }
            if self.deliver(&axes, &line, accept, hits, crossings, counters) {
                return self.choose(crossings, budget, choice);
            }
            let mut generator = stream.generator(set);
            for _ in 1..MAX_LINES {
                let hero = self.channels.draw(budget, generator.next_f32());
                let line = Line {
                    radius: self.spread.sample_radius(hero, generator.next_f32()),
                    angle: TAU * generator.next_f32(),
                    cut: 1.0 - generator.next_f32(),
                };
                if !self.is_resolved(&line) {
                    return EntryPoint { hit: None, weight: budget };
                }
                let accept = generator.next_f32();
                if self.deliver(&axes, &line, accept, hits, crossings, counters) {
                    return self.choose(crossings, budget, generator.next_f32());
                }
            }
            counters.overflowed += 1;
            EntryPoint { hit: None, weight: budget }
        })
    }

    /// Appends every crossing of the three probes of one line, so that the sum of the weights is
    /// an unbiased estimate of ∫_A R_c dA (of the uncut profile). For checks: the integrator shares
    /// energy between crossings instead, see the module's description.
    pub fn crossings(&self, generator: &mut HashGenerator, found: &mut Vec<Crossing<N>>) {
        let axes = self.axes(generator.next_f32());
        let hero = self.channels.draw(Spectrum::ONE, generator.next_f32());
        let line = Line {
            radius: self.spread.sample_radius(hero, generator.next_f32()),
            angle: TAU * generator.next_f32(),
            cut: 1.0 - generator.next_f32(),
        };
        let (mut hits, mut crossings) = (Vec::new(), Crossings::new());
        let mut counters = ProbeCounters::default();
        for axis in 0..3 {
            self.probe(&axes, axis, &line, &mut hits, &mut crossings, &mut counters);
            let uncut = Spectrum(self.spread.within());
            found.extend(crossings.iter().map(|c| Crossing { weight: c.weight * uncut, ..*c }));
        }
    }

    /// False for a line nearer than the error of the coordinates: light leaves where it entered. A probe could
    /// not tell that the point it finds is as near.
    fn is_resolved(&self, line: &Line) -> bool {
        line.radius > self.position_error
    }

    /// Normal and two tangents turned at random about it.
    fn axes(&self, rotation: f32) -> [Vec3; 3] {
        let frame = Frame::from_normal(self.normal);
        let (sin, cos) = (TAU * rotation).sin_cos();
        let tangent = frame.tangent * cos + frame.bitangent * sin;
        [self.normal, tangent, self.normal.cross(tangent)]
    }

    /// Tries the three axes of a line in turn; true if its energy has found crossings to go to, which
    /// are then in `crossings`. `accept` is uniform: the axes cover [0, 1) one after another with the
    /// sums of their weights, so that a weight below 1 passes what it lacks on to the next axis.
    fn deliver(
        &self,
        axes: &[Vec3; 3],
        line: &Line,
        accept: f32,
        hits: &mut Vec<Hit>,
        crossings: &mut Crossings<N>,
        counters: &mut ProbeCounters,
    ) -> bool {
        let mut rest = accept;
        for axis in 0..3 {
            self.probe(axes, axis, line, hits, crossings, counters);
            rest -= crossings.iter().map(|c| self.channels.mean(c.weight)).sum::<f32>();
            if rest < 0.0 {
                return true;
            }
        }
        false
    }

    /// Casts the probe of `line` along one axis; `crossings` receives what it finds.
    fn probe(
        &self,
        axes: &[Vec3; 3],
        axis: usize,
        line: &Line,
        hits: &mut Vec<Hit>,
        crossings: &mut Crossings<N>,
        counters: &mut ProbeCounters,
    ) {
        crossings.clear();
        let (along, across, third) = (axes[axis], axes[(axis + 1) % 3], axes[(axis + 2) % 3]);
        let (sin, cos) = line.angle.sin_cos();
        let middle = self.position + (across * cos + third * sin) * line.radius;
        let radius = line.radius.max(f32::MIN_POSITIVE);
        let ratio = CERTAIN_RATIO * line.cut;
        let reach = self.spread.reach(radius, ratio);
        // Rounding of x_o must not put its own surface beyond the end.
        let half =
            (reach * reach - radius * radius).max(0.0).sqrt() + 4.0 * self.position_error + radius * 1e-5;
        let ray = Ray { origin: middle - along * half, direction: along * (2.0 * half), t_max: 1.0 };
        self.caster.all_hits(&ray, self.instance, hits);
        counters.cast += 1;
        counters.hits += hits.len() as u64;
        if hits.is_empty() {
            counters.missed += 1;
            return;
        }
        let on_disk = self.channels.mean(self.spread.densities(radius, self.channels));
        for &hit in hits.iter() {
            let height = (2.0 * hit.t - 1.0) * half;
            let distance = (radius * radius + height * height).sqrt();
            let densities = self.spread.densities(distance, self.channels);
            let relative = self.channels.mean(densities) / on_disk;
            if relative < ratio || !relative.is_finite() {
                continue;
            }
            let included = (relative / CERTAIN_RATIO).min(1.0);
            let normal = (self.geometric_normal)(&hit);
            let gamma = 1.0 / axes.iter().map(|a| normal.dot(*a).abs()).sum::<f32>().max(1.0);
            crossings.push(Crossing { hit, weight: densities * (gamma / (on_disk * included)) });
        }
    }

    /// Draws one of the crossings, with the line's energy `budget` shared between them per channel in
    /// proportion to their weights.
    fn choose(&self, crossings: &[Crossing<N>], budget: Spectrum<N>, u: f32) -> EntryPoint<N> {
        if let [only] = crossings {
            return EntryPoint { hit: Some(only.hit), weight: budget };
        }
        let mut total = Spectrum::ZERO;
        for crossing in crossings {
            total += crossing.weight;
        }
        let scale = budget.zip(total, |b, t| if t > 0.0 { b / t } else { 0.0 });
        // A channel that no crossing carries keeps its energy by going to all of them alike.
        let spare = budget.zip(total, |b, t| if t > 0.0 { 0.0 } else { b / crossings.len() as f32 });
        let mut rest = u;
        let mut chosen = None;
        for crossing in crossings {
            let energy = crossing.weight * scale + spare;
            let probability = self.channels.mean(energy);
            if probability > 0.0 {
                chosen = Some(EntryPoint { hit: Some(crossing.hit), weight: energy / probability });
                rest -= probability;
                if rest < 0.0 {
                    break;
                }
            }
        }
        chosen.unwrap_or(EntryPoint { hit: None, weight: budget })
    }
}
