//! Walks guided towards where light leaves ([`crate::transport::guide`]), and how they are combined with the classic walk.
//!
//! **Combination.** A path draws once whether its walks are classic, with probability α = 1/10, or guided. Whichever it is, it is
//! weighted against both (one-sample multiple importance sampling by the balance heuristic, Veach 1997, section 9.2.4): with G/C the ratio of
//! the densities with which guides and the classic walk draw all the flights of the path, light that the classic walk gives the weight w
//! weighs
//!
//! w / (α + (1 − α) G/C) ≤ w/α,
//!
//! so that no path, however long and wherever its guide took it, weighs more than 1/α times what it would in the classic walk, whose light
//! in all channels together never grows. A guide that looks the wrong way at a corner costs time, and makes no bright dots.
//!
//! **Roulette.** Guided light comes out with about what is expected of it, and less than it came in with. Roulette plays
//! with what falls below that expectation instead of what falls below 1, or it would undo the guide. It never raises light above what it
//! would be worth in the classic walk, so that the bound holds for what roulette leaves, too.

use glam::Vec3;

use super::random_walk::Turn;
use super::{Next, Path};
use crate::math::Frame;
use crate::optics::phase::HenyeyGreenstein;
use crate::raycast::RayCaster;
use crate::transport::basis::Basis;
use crate::transport::guide::{Guide, Heading, Layer, Lobe};
use crate::transport::interiors::Interior;
use crate::transport::spread::Channels;
use crate::transport::substance::Substance;

/// Probability of a classic path.
const CLASSIC: f32 = 0.1;

/// Limits of a ratio of densities, so that it stays a number: beyond them light weighs 1/α, or nothing.
const RATIOS: [f32; 2] = [1e-30, 1e30];

/// How the walks of a path are drawn.
#[derive(Clone, Copy)]
pub(super) struct Technique {
    /// Guided rather than classic, once that has been drawn.
    guided: Option<bool>,
    /// G/C so far.
    ratio: f32,
}

impl Default for Technique {
    fn default() -> Self {
        Self { guided: None, ratio: 1.0 }
    }
}

impl Technique {
    /// By which the classic weight of the path is multiplied.
    pub fn weight(&self) -> f32 {
        1.0 / (CLASSIC + (1.0 - CLASSIC) * self.ratio)
    }

    /// Density of what guides draw `ratio` times as likely as the classic walk, relative to the latter.
    fn density(&self, ratio: f32) -> f32 {
        (CLASSIC + (1.0 - CLASSIC) * self.ratio * ratio) * self.weight()
    }

    /// Density per solid angle, 1/sr, of a turn at `position` to the direction `after`, whose phase function is `phase`.
    pub fn density_towards<const N: usize>(
        &self,
        layer: &Layer<N>,
        position: Vec3,
        after: Vec3,
        phase: f32,
        channels: Channels<N>,
    ) -> f32 {
        let heading = layer.turned(position, after, phase, channels);
        phase * self.density(heading.ratio())
    }
}

/// A flight about to be drawn in a guided body.
#[derive(Clone, Copy)]
pub(super) struct Course<const N: usize> {
    pub layer: Layer<N>,
    pub heading: Heading<N>,
    /// By which lobe.
    pub lobe: Lobe,
}

impl<C: RayCaster, B: Basis<N>, const N: usize, const CAN: u32> Path<'_, C, B, N, CAN> {
    /// The guide of a walk that begins with `from` in `body`, if it has one.
    pub(super) fn guide(&mut self, from: &Next, body: &Interior<N>) -> Option<Layer<N>> {
        if !self.renderer.options.guiding {
            return None;
        }
        let bounds = self.bounds(body);
        let guide = self.guide_of(body).filter(|guide| guide.pays_in(bounds.width()))?;
        let normal = self.entrance?.normal;
        let normal = if normal.dot(from.direction) > 0.0 { -normal } else { normal };
        if self.technique.guided.is_none() {
            self.technique.guided = Some(self.random.next_f32() >= CLASSIC);
        }
        self.expected = self.expected.min(guide.expected());
        Some(Layer::new(guide, from.origin, normal, bounds.exit(from.origin, -normal)))
    }

    /// The guide of the medium in `body`, if it has one.
    fn guide_of(&self, body: &Interior<N>) -> Option<Guide<N>> {
        let renderer = self.renderer;
        let Substance::Material(material) = renderer.world.substance(body.instance) else { return None };
        let around = self.interiors.ior_around(body.instance);
        let scatterer = renderer.scatterers[material].as_ref()?;
        self.basis.guide(scatterer.immersed(around), &body.medium)
    }

    fn is_guided(&self) -> bool {
        self.technique.guided == Some(true)
    }

    /// The flight after `from`, whose direction is given.
    pub(super) fn set_out(&mut self, layer: Layer<N>, from: &Next) -> Course<N> {
        let channels = Channels::of(self.throughput);
        let lobe = self.draw_lobe(&layer, from.origin, &channels);
        Course { heading: layer.straight(from.origin, from.direction, channels), layer, lobe }
    }

    fn draw_lobe(&mut self, layer: &Layer<N>, point: Vec3, channels: &Channels<N>) -> Lobe {
        if self.is_guided() { layer.draw_lobe(point, channels, &mut self.random) } else { Lobe::Plain }
    }

    /// Draws a direction after a collision at `position`, and with it the course of the flight.
    pub(super) fn turn_guided(
        &mut self,
        layer: Layer<N>,
        phase: HenyeyGreenstein,
        position: Vec3,
        direction: Vec3,
    ) -> (Turn, Course<N>) {
        let channels = Channels::of(self.throughput);
        let lobe = self.draw_lobe(&layer, position, &channels);
        let turn = match layer.draw_cosine(lobe, &mut self.random) {
            Some(cosine) => {
                let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
                let (y, x) = (std::f32::consts::TAU * self.random.next_f32()).sin_cos();
                let local = Vec3::new(sine * x, sine * y, cosine);
                let after = Frame::from_normal(layer.normal()).to_world(local).normalize();
                Turn { direction: after, density: phase.density(f64::from(after.dot(direction))) as f32 }
            }
            None => self.turn(phase, direction),
        };
        let heading = layer.turned(position, turn.direction, turn.density, channels);
        let density = turn.density * self.technique.density(heading.ratio());
        (Turn { density, ..turn }, Course { layer, heading, lobe })
    }

    /// Weighs a path by what guides draw `ratio` times as likely as the classic walk.
    pub(super) fn weigh(&mut self, ratio: f32) {
        let before = self.technique.weight();
        self.technique.ratio = (self.technique.ratio * ratio).clamp(RATIOS[0], RATIOS[1]);
        self.throughput *= self.technique.weight() / before;
    }
}
