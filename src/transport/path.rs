//! The path tracer: one path from the camera, with direct light at every vertex.

mod below;
mod contact;
mod guiding;
mod passage;
mod random_walk;
mod sphere_walk;

use glam::Vec3;

use guiding::Technique;
use random_walk::Walked;

use super::counters::Counters;
use super::entry::Response;
use super::interiors::Interiors;
use super::light_choice::Receiver;
use super::renderer::Renderer;
use super::shading::{Lobes, Orientation, color, emitted, resolve_bsdf};
use super::substance::Substance;
use super::world::SurfacePoint;
use crate::math::robust::offset_from_surface;
use crate::math::sampler::HashGenerator;
use crate::math::{Frame, SampleStream};
use crate::plan::Abilities;
use crate::radiometry::Rgb;
use crate::raycast::{Hit, Ray, RayCaster};
use crate::scene::{ScatteringInput, Scene};

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
pub(super) struct Path<'a, C, const CAN: u32> {
    renderer: &'a Renderer<C>,
    stream: SampleStream,
    counters: &'a mut Counters,
    interiors: Interiors,
    throughput: Rgb,
    radiance: Rgb,
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
}

impl<'a, C: RayCaster, const CAN: u32> Path<'a, C, CAN> {
    const COVERAGE: bool = Abilities::COVERAGE.are_in(CAN);
    const INTERIORS: bool = Abilities::INTERIORS.are_in(CAN);
    const SUBSURFACE: bool = Abilities::SUBSURFACE.are_in(CAN);
    const WALKS: bool = Abilities::WALKS.are_in(CAN);

    pub fn new(
        renderer: &'a Renderer<C>,
        stream: SampleStream,
        interiors: &Interiors,
        counters: &'a mut Counters,
    ) -> Self {
        let random = stream.generator(place::WALK);
        Self {
            renderer,
            stream,
            counters,
            interiors: if Self::INTERIORS { *interiors } else { Interiors::default() },
            throughput: Rgb::ONE,
            radiance: Rgb::ZERO,
            scattered_from: None,
            bounce: 0,
            passed: 0,
            flights: 0,
            entrance: None,
            technique: Technique::default(),
            expected: 1.0,
            random,
        }
    }

    /// Radiance that arrives at `origin` against unit `direction`, W/(m² sr).
    pub fn radiance(mut self, origin: Vec3, direction: Vec3) -> Rgb {
        let mut next = Next { origin, direction };
        while let Some(after) = self.step(&next) {
            next = after;
        }
        self.radiance
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
                let radiance = emitted(&world.scene().lights[light], &surface, from.direction);
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
        self.radiance += self.throughput * environment.radiance(direction) * weight;
    }

    fn add_emission(&mut self, radiance: Rgb, surface: &SurfacePoint, direction: Vec3) {
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
        let material = &scene.materials[material];
        let faces = material.double_sided || direction.dot(surface.geometric_normal) < 0.0;
        if faces && !material.emission.factor.is_black() {
            let radiance = color::<CAN>(scene, &material.emission, surface);
            self.add_emission(radiance, surface, direction);
        }
    }

    /// Light drawn directly for `receiver` at `surface`, through a lobe given by `response`.
    fn add_direct(
        &mut self,
        place: u32,
        surface: &SurfacePoint,
        receiver: &Receiver,
        response: impl Fn(Vec3) -> Response,
    ) {
        let [u0, u1, u2, _] = self.stream.quad(self.set(place));
        let Renderer { world, lights, .. } = self.renderer;
        let Some(light) = lights.sample::<_, CAN>(world, receiver, [u0, u1, u2]) else { return };
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

    /// Scatters at a surface that acts where it is hit.
    fn scatter_bsdf(&mut self, material: usize, surface: &SurfacePoint, wo: Vec3) -> Option<Next> {
        let world = &self.renderer.world;
        let around = self.ior_outside(surface, wo.dot(surface.geometric_normal) > 0.0);
        let bsdf = self.lobes(material, surface, around);
        // Only the boundary of a body knows inside from outside.
        let two_sided = !Self::INTERIORS || world.interior(surface.instance).is_none();
        let mut orientation = Orientation::new::<CAN>(world.scene(), material, surface, wo, two_sided);
        let frame = Frame::from_normal(orientation.shading);
        let local_wo = frame.to_local(wo);
        let receiver = Receiver {
            position: surface.position,
            normal: (!bsdf.transmits()).then_some(orientation.geometric),
        };
        if !bsdf.is_delta_only() {
            self.add_direct(place::LIGHT, surface, &receiver, |wi| {
                response(&bsdf, &orientation, &frame, local_wo, wi)
            });
        }
        let [lobe, u, v, _] = self.stream.quad(self.set(place::SCATTER));
        let mut sample = bsdf.sample(local_wo, [u, v, lobe], &mut self.random)?;
        let mut direction = frame.to_world(sample.direction);
        if sample.delta && !orientation.agree(direction) {
            // The interpolated normal sends light through the wrong side: use the triangle's own.
            orientation.shading = orientation.geometric;
            let frame = Frame::from_normal(orientation.geometric);
            sample = bsdf.sample(frame.to_local(wo), [u, v, lobe], &mut self.random)?;
            direction = frame.to_world(sample.direction);
        } else if !sample.delta && orientation.folds(direction) {
            if !orientation.agree(direction) {
                direction = orientation.mirrored(direction);
            }
            let Response { value, density } = response(&bsdf, &orientation, &frame, local_wo, direction);
            sample.weight = if density > 0.0 { value / density } else { Rgb::ZERO };
            sample.density = density;
        }
        if direction.dot(orientation.geometric) == 0.0 {
            self.counters.rejected += 1;
            return None;
        }
        self.throughput *= sample.weight;
        self.scattered_from = (!sample.delta).then_some(Origin { receiver, density: sample.density });
        if Self::INTERIORS && sample.crosses_boundary {
            self.cross(surface, wo.dot(surface.geometric_normal) > 0.0);
        }
        let next = Next { origin: leave(surface, direction), direction };
        if Self::WALKS {
            self.entrance = Some(Entrance::new(surface, next.origin));
        }
        Some(next)
    }

    /// What scatters light at a surface that acts where it is hit.
    fn lobes(&self, material: usize, surface: &SurfacePoint, around: f32) -> Lobes<'a> {
        let Renderer { world, scatterers, .. } = self.renderer;
        let walked = if Self::WALKS { scatterers[material].as_ref() } else { None };
        let interface = walked.and_then(|scatterer| scatterer.immersed(around).interface());
        match interface.filter(|interface| !interface.is_smooth()) {
            Some(interface) => Lobes::Interface(interface),
            None => Lobes::Bsdf(resolve_bsdf::<CAN>(world.scene(), material, surface, around)),
        }
    }
}

/// The BSDF towards `wi` and the density that samples it, around the shading normal `frame` and folded by
/// the plane of the triangle.
fn response(bsdf: &Lobes, orientation: &Orientation, frame: &Frame, local_wo: Vec3, wi: Vec3) -> Response {
    let mut response = Response { value: Rgb::ZERO, density: 0.0 };
    for direction in orientation.unfolded(wi) {
        let local = frame.to_local(direction);
        response.value += bsdf.evaluate(local_wo, local);
        response.density += bsdf.density(local_wo, local);
    }
    response
}

/// The albedo asked for at a point, where the input is one.
fn wanted_albedo<const CAN: u32>(scene: &Scene, input: &ScatteringInput, surface: &SurfacePoint) -> Rgb {
    match input {
        ScatteringInput::Albedo { albedo, .. } => color::<CAN>(scene, albedo, surface),
        ScatteringInput::Coefficients { .. } | ScatteringInput::Spectral { .. } => Rgb::ZERO,
    }
}

/// `surface`'s position moved off it, to the side of `direction`.
fn leave(surface: &SurfacePoint, direction: Vec3) -> Vec3 {
    offset_from_surface(surface.position, surface.error, surface.geometric_normal, direction)
}
