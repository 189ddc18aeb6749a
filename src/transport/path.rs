//! The path tracer: one path from the camera, with direct light at every vertex.

mod below;
mod contact;
mod dispersion;
mod guiding;
mod passage;
mod random_walk;
mod sphere_walk;
mod surface;

use glam::Vec3;

use guiding::Technique;
use random_walk::Walked;

use super::basis::Basis;
use super::counters::Counters;
use super::entry::Response;
use super::interiors::Interiors;
use super::light_choice::Receiver;
use super::renderer::Renderer;
use super::shading::{color, emitted};
use super::substance::Substance;
use super::world::SurfacePoint;
use crate::math::SampleStream;
use crate::math::robust::offset_from_surface;
use crate::math::sampler::HashGenerator;
use crate::plan::Abilities;
use crate::radiometry::{Rgb, Spectrum};
use crate::raycast::{Hit, Ray, RayCaster};

/// Sets of the sample stream by the place they are used at.
pub(super) mod place {
    /// Film and lens.
    pub const CAMERA: u32 = 0;
    /// First set of a bounce, and how many a bounce has.
    pub const fn bounce(bounce: u32) -> u32 {
        1 + bounce * 6
    }
    /// Lobe, direction, roulette.
    pub const SCATTER: u32 = 0;
    /// Direct light at the point hit.
    pub const LIGHT: u32 = 1;
    /// Where light came in (two sets).
    pub const PROBE: u32 = 2;
    /// Direction at the point of entry.
    pub const ENTRY: u32 = 4;
    /// Direct light at the point of entry.
    pub const ENTRY_LIGHT: u32 = 5;
    /// Partial coverage: beyond all bounces' sets of the low-discrepancy sequence.
    pub const COVERAGE: u32 = 1 << 24;
    /// Walks inside scattering bodies.
    pub const WALK: u32 = 1 << 25;
    /// The wavelengths that a path carries.
    pub const WAVELENGTHS: u32 = 1 << 26;
}

/// Bounces before roulette may end a path.
const ROULETTE_START: u32 = 3;

/// Bounces after which a path is cut, where the scene sets no limit. Roulette ends paths long before;
/// this holds light that total internal reflection and zero absorption keep for ever. It is counted.
const LONGEST_PATH: u32 = 4096;

/// The vertex a ray was scattered from, where direct light could have been drawn as well.
#[derive(Clone, Copy)]
struct Origin {
    receiver: Receiver,
    /// Density per solid angle of the direction taken.
    density: f32,
}

/// Where a path goes on.
#[derive(Clone, Copy)]
struct Next {
    origin: Vec3,
    direction: Vec3,
}

/// A triangle that a path leaves.
#[derive(Clone, Copy)]
struct Entrance {
    /// Unit normal.
    normal: Vec3,
    /// How far the path was moved off it, m.
    offset: f32,
}

impl Entrance {
    fn new(surface: &SurfacePoint, origin: Vec3) -> Self {
        let normal = surface.geometric_normal;
        Self { normal, offset: (origin - surface.position).dot(normal).abs() }
    }
}

/// A path under construction.
pub(super) struct Path<'a, C, B, const N: usize, const CAN: u32> {
    renderer: &'a Renderer<C>,
    /// What its channels are.
    basis: B,
    stream: SampleStream,
    counters: &'a mut Counters,
    interiors: Interiors<N>,
    throughput: Spectrum<N>,
    radiance: Spectrum<N>,
    scattered_from: Option<Origin>,
    bounce: u32,
    /// Surfaces with partial coverage that were not there.
    passed: u32,
    /// Flights inside scattering bodies.
    flights: u32,
    /// The triangle through which or from which the path last went on.
    entrance: Option<Entrance>,
    /// How walks are drawn.
    technique: Technique,
    /// What the path is expected to carry where it finds light, at most: roulette plays with what is less.
    expected: f32,
    /// For walks, whose length is not known beforehand.
    random: HashGenerator,
    /// Only the first channel goes on.
    is_alone: bool,
}

impl<'a, C: RayCaster, B: Basis<N>, const N: usize, const CAN: u32> Path<'a, C, B, N, CAN> {
    const COVERAGE: bool = Abilities::COVERAGE.are_in(CAN);
    const INTERIORS: bool = Abilities::INTERIORS.are_in(CAN);
    const SUBSURFACE: bool = Abilities::SUBSURFACE.are_in(CAN);
    const WALKS: bool = Abilities::WALKS.are_in(CAN);

    pub fn new(
        renderer: &'a Renderer<C>,
        basis: B,
        stream: SampleStream,
        interiors: &Interiors<N>,
        counters: &'a mut Counters,
    ) -> Self {
        let random = stream.generator(place::WALK);
        let mut path = Self {
            renderer,
            basis,
            stream,
            counters,
            interiors: if Self::INTERIORS { *interiors } else { Interiors::default() },
            throughput: Spectrum::ONE,
            radiance: Spectrum::ZERO,
            scattered_from: None,
            bounce: 0,
            passed: 0,
            flights: 0,
            entrance: None,
            technique: Technique::default(),
            expected: 1.0,
            random,
            is_alone: false,
        };
        if B::DISPERSES && path.is_in_dispersive_body() {
            path.leave_others();
        }
        path
    }

    /// Radiance that arrives at `origin` against unit `direction`, W/(m² sr).
    pub fn radiance(mut self, origin: Vec3, direction: Vec3) -> Rgb {
        let mut next = Next { origin, direction };
        while let Some(after) = self.step(&next) {
            next = after;
        }
        self.basis.rgb(self.radiance)
    }

    /// Follows one ray; `None` where the path ends.
    fn step(&mut self, from: &Next) -> Option<Next> {
        let world = &self.renderer.world;
        let inside = if Self::INTERIORS { self.interiors.current() } else { None };
        let (from, hit) = match &inside {
            Some(body) if Self::WALKS && body.medium.scatters() => match self.walk(*from, body)? {
                Walked::Met { from, hit } => (from, Some(hit)),
                Walked::Escaped(next) => return Some(next),
            },
            _ => (*from, self.closest(from)),
        };
        let Some(hit) = hit else {
            self.add_environment(from.direction);
            return None;
        };
        let surface = world.surface::<CAN>(&hit);
        if let Some(body) = inside.filter(|body| !body.medium.scatters()) {
            let distance = surface.position.distance(from.origin);
            self.throughput *= body.medium.sigma_a.map(|s| (-s * distance).exp());
        }
        let material = match world.substance(hit.instance) {
            Substance::Light(light) => {
                let radiance = emitted(&self.basis, world.scene(), light, &surface, from.direction);
                self.add_emission(radiance, &surface, from.direction);
                return None;
            }
            Substance::Material(material) => material,
        };
        if Self::COVERAGE && world.has_partial_coverage() && !self.covers(material, &surface) {
            let origin = leave(&surface, from.direction);
            return Some(Next { origin, direction: from.direction });
        }
        self.add_material_emission(material, &surface, from.direction);
        if Self::WALKS && self.renderer.has_walks && self.passes(&surface, from.direction) {
            return self.pass(&surface, from.direction);
        }
        if self.bounce >= self.limit() {
            self.counters.capped_paths += 1;
            return None;
        }
        let next = if Self::SUBSURFACE && self.is_translucent(material, hit.instance) {
            self.scatter_translucent(material, &surface, -from.direction)
        } else {
            self.scatter_bsdf(material, &surface, -from.direction)
        }?;
        self.survives_roulette().then_some(next)
    }

    /// True if light from under the surface is taken where it leaves.
    fn is_translucent(&self, material: usize, instance: u32) -> bool {
        let is_walked = Self::WALKS && self.renderer.world.is_walked(instance);
        !is_walked && self.renderer.scatterers[material].is_some()
    }

    fn closest(&mut self, from: &Next) -> Option<Hit> {
        self.counters.rays += 1;
        self.renderer.world.caster().closest(&Ray::new(from.origin, from.direction))
    }

    /// Bounces after which the path is cut.
    fn limit(&self) -> u32 {
        match self.renderer.depth_limit {
            // Total reflection holds what scatters little for long; flights are counted there.
            None if Self::WALKS && self.interiors.current().is_some_and(|body| body.medium.scatters()) => {
                u32::MAX
            }
            None => LONGEST_PATH,
            Some(depth) => depth.min(LONGEST_PATH),
        }
    }

    fn set(&self, place: u32) -> u32 {
        place::bounce(self.bounce) + place
    }

    /// What the path can bring to the camera. Radiance inside a body is n² times that outside, which its
    /// throughput makes up for: a path is judged without that factor.
    fn carried(&self) -> f32 {
        self.throughput.max_component() * self.ior().powi(2)
    }

    /// Index of refraction of what the path is in.
    fn ior(&self) -> f32 {
        if Self::INTERIORS { self.interiors.ior() } else { 1.0 }
    }

    /// Index of refraction around the boundary of `instance`.
    fn ior_around(&self, instance: u32) -> f32 {
        if Self::INTERIORS { self.interiors.ior_around(instance) } else { 1.0 }
    }

    /// Ends paths that carry little, so that the rest carry as much more.
    fn survives_roulette(&mut self) -> bool {
        let set = self.set(place::SCATTER);
        self.bounce += 1;
        let start = self.bounce < ROULETTE_START;
        self.plays(start, |path| path.stream.quad(set)[3])
    }

    /// Roulette with a number in [0, 1), or only a look whether there is anything to carry on if `spared`.
    fn plays(&mut self, spared: bool, draw: impl FnOnce(&mut Self) -> f32) -> bool {
        let carried = self.carried();
        if !(carried > 0.0 && carried.is_finite()) {
            return false;
        }
        // No other technique has a weight but 1.
        let expected = if Self::WALKS { self.expected.min(self.technique.weight()) } else { 1.0 };
        let chance = carried / expected;
        if spared || chance >= 1.0 {
            return true;
        }
        self.throughput *= 1.0 / chance;
        draw(self) < chance
    }

    /// Weight of light found by a scattered ray against the same light drawn directly.
    fn emission_weight(&self, light_density: impl FnOnce(&Origin) -> f32) -> f32 {
        match &self.scattered_from {
            None => 1.0,
            Some(origin) => origin.density / (origin.density + light_density(origin)),
        }
    }

    fn add_environment(&mut self, direction: Vec3) {
        let Some(environment) = &self.renderer.world.scene().environment else { return };
        let lights = &self.renderer.lights;
        let weight = self
            .emission_weight(|origin| lights.environment_density(environment, &origin.receiver, direction));
        self.radiance += self.throughput * self.basis.environment(environment, direction) * weight;
    }

    fn add_emission(&mut self, radiance: Spectrum<N>, surface: &SurfacePoint, direction: Vec3) {
        if radiance.is_black() {
            return;
        }
        let Renderer { world, lights, .. } = self.renderer;
        let weight =
            self.emission_weight(|origin| lights.density(world, &origin.receiver, direction, surface));
        self.radiance += self.throughput * radiance * weight;
    }

    fn add_material_emission(&mut self, material: usize, surface: &SurfacePoint, direction: Vec3) {
        let scene = self.renderer.world.scene();
        let index = material;
        let material = &scene.materials[index];
        let faces = material.double_sided || direction.dot(surface.geometric_normal) < 0.0;
        if faces && !material.emission.factor.is_black() {
            let radiance = color::<CAN>(scene, &material.emission, surface);
            let radiance = self.basis.emission(index, &material.emission, radiance);
            self.add_emission(radiance, surface, direction);
        }
    }

    /// Light drawn directly for `receiver` at `surface`, through a lobe given by `response`.
    fn add_direct(
        &mut self,
        place: u32,
        surface: &SurfacePoint,
        receiver: &Receiver,
        response: impl Fn(Vec3) -> Response<N>,
    ) {
        let [u0, u1, u2, _] = self.stream.quad(self.set(place));
        let Renderer { world, lights, .. } = self.renderer;
        let Some(light) = lights.sample::<_, _, N, CAN>(&self.basis, world, receiver, [u0, u1, u2]) else {
            return;
        };
        let Response { value, density } = response(light.direction);
        if value.is_black() {
            return;
        }
        let weight = light.density.map_or(1.0, |d| d / (d + density));
        let contribution = self.throughput * value * light.value * weight;
        if !contribution.is_finite() {
            self.counters.rejected += 1;
            return;
        }
        let arrives = self.arrival(surface, light.direction, light.distance);
        self.radiance += contribution * arrives;
    }
}

/// `surface`'s position moved off it, to the side of `direction`.
fn leave(surface: &SurfacePoint, direction: Vec3) -> Vec3 {
    offset_from_surface(surface.position, surface.error, surface.geometric_normal, direction)
}
