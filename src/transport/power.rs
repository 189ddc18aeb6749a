//! The power balance of a scene: what is emitted and comes in from outside is absorbed, or leaves.
//!
//! Every term is an integral of radiance over a surface and the directions on one side of it, Φ = ∫∫ L cosθ dω dA, drawn
//! uniformly by area and by the cosine, so that each sample is worth π A L; the radiance is what a path from there finds. What a surface absorbs is
//! what arrives less what leaves, and what it emits itself. What leaves the scene crosses a sphere around all of it.
//!
//! Light straight from a lamp is left out there, as a small lamp is seldom met by chance: rays are sent out by lamps instead, each of which escapes or
//! arrives at a surface.
//!
//! The terms are estimated apart: that they add up says that light is where it should be, and that nothing absorbs a negative power, that no
//! surface makes light.
//!
//! This takes samples of its own. Renders are not slowed by it.

mod lamps;

use std::array;
use std::f32::consts::{PI, TAU};

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use serde::Serialize;
use thiserror::Error;

use lamps::{Lamps, SentRay};

use super::counters::Counters;
use super::interiors::Interiors;
use super::renderer::Renderer;
use super::shading::color;
use super::substance::Substance;
use super::world::{SurfacePoint, UPWARDS};
use crate::math::distribution::Discrete;
use crate::math::robust::offset_from_surface;
use crate::math::sampler::HashGenerator;
use crate::math::{Frame, SampleStream, warp};
use crate::plan::Kernel;
use crate::radiometry::{Area, ProjectedSolidAngle, Radiance, Rgb};
use crate::raycast::{Hit, Ray, RayCaster};

/// Streams beyond those of any pixel.
const STREAMS: u64 = u64::MAX - 8;

/// Sum of the area vectors of a closed mesh over its area: what single precision leaves of 0.
const ROUNDING: f64 = 1e-3;

const CAN: u32 = Kernel::Generic.abilities().bits();

/// A power by channel, W, and its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Power {
    /// Estimate.
    pub value: [f64; 3],
    /// One σ.
    pub stderr: [f64; 3],
}

/// Where the power goes that is in a scene.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct PowerBalance {
    /// By lights and materials.
    pub emitted: Power,
    /// From the environment and in parallel light, through a sphere around the scene.
    pub entered: Power,
    /// At surfaces and in bodies.
    pub absorbed: Power,
    /// Through that sphere, straight on from where it was emitted or came in.
    pub escaped: Power,
    /// Through that sphere, after it was scattered.
    pub scattered_out: Power,
    /// Emitted and entered less all others: 0 but for noise.
    pub residual: Power,
}

/// Why there is no balance of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum Unbalanced {
    /// There is nothing that a sphere could be put around.
    #[error("the scene is empty")]
    NoGeometry,
}

impl PowerBalance {
    /// The residual in standard errors, in the worst channel.
    pub fn sigmas(&self) -> f64 {
        let Power { value, stderr } = self.residual;
        let sigmas = |c: usize| if value[c] == 0.0 { 0.0 } else { value[c].abs() / stderr[c] };
        (0..3).map(sigmas).fold(0.0, f64::max)
    }
}

/// The triangles of a scene, drawn by area.
struct Surfaces {
    triangles: Vec<(u32, u32)>,
    by_area: Discrete,
    /// By instance: triangles face outwards alike, so that it has an inside.
    is_closed: Vec<bool>,
    /// m².
    area: f32,
}

impl<C: RayCaster> Renderer<C> {
    /// The power balance of the scene, from `samples` samples of each of its parts. Paths are limited as in pictures: where they are cut, it does not close.
    ///
    /// # Errors
    /// If the scene has nothing to be lit.
    pub fn power_balance(&mut self, samples: u64) -> Result<PowerBalance, Unbalanced> {
        let surfaces = self.surfaces().ok_or(Unbalanced::NoGeometry)?;
        let (center, radius) = self.bounding_sphere();
        let sphere_area = 4.0 * PI * radius * radius;
        let limit = self.depth_limit();
        self.limit_depth(Some(0));
        let through_sphere = flux(sphere_area);
        let [straight] = tally(samples, through_sphere, |i| [self.leaving(center, radius, i)]);
        self.limit_depth(limit);
        let [entered, left, gained] = tally(samples, through_sphere, |i| {
            let (entering, leaving) = (self.entering(center, radius, i), self.leaving(center, radius, i));
            [entering, leaving, entering - leaving]
        });
        let [shone, absorbed, kept] = tally(samples, flux(surfaces.area), |i| {
            let (emitted, absorbed) = self.at_surface(&surfaces, i);
            [emitted, absorbed, emitted - absorbed]
        });
        let lamps = Lamps::new(&self.world, center, radius);
        let sent = lamps.emitted() + lamps.entering();
        let [escaped, arrived, hidden] = tally(samples, 1.0, |i| {
            let (escaped, arrived) = self.sent_by_lamp(&lamps, &surfaces, i);
            [escaped, arrived, sent - escaped - arrived]
        });
        Ok(PowerBalance {
            emitted: shone.plus(&Power::exact(lamps.emitted())),
            entered: entered.plus(&Power::exact(lamps.entering())),
            absorbed: absorbed.plus(&arrived),
            escaped: straight.plus(&escaped),
            scattered_out: left.less(&straight),
            residual: hidden.plus(&gained).plus(&kept),
        })
    }

    /// The power of a ray that a light sends out and that leaves the scene, or that arrives at a surface; neither inside of a body.
    fn sent_by_lamp(&self, lamps: &Lamps, surfaces: &Surfaces, sample: u64) -> (Rgb, Rgb) {
        let nothing = (Rgb::ZERO, Rgb::ZERO);
        let mut random = HashGenerator::new(self.options.seed ^ sample.wrapping_mul(3).wrapping_add(2));
        let Some(SentRay { origin, direction, power }) = lamps.send(&self.world, &mut random) else {
            return nothing;
        };
        let from_inside = |hit: &Hit| {
            self.is_body(hit.instance, surfaces) && self.world.geometric_normal(hit).dot(direction) > 0.0
        };
        match self.world.caster().closest(&Ray::new(origin, direction)) {
            _ if self.is_in_body(origin) => nothing,
            None => (power, Rgb::ZERO),
            Some(hit) if from_inside(&hit) => nothing,
            Some(_) => (Rgb::ZERO, power),
        }
    }

    fn random_point(&self, instance: u32, primitive: u32, random: &mut HashGenerator) -> SurfacePoint {
        let barycentric = warp::square_to_triangle(random.next_f32(), random.next_f32());
        let hit = Hit { t: 0.0, u: barycentric.x, v: barycentric.y, instance, primitive };
        self.world.surface::<CAN>(&hit)
    }

    /// True for what goes on inside of which is its own: what is absorbed in it is what does not come out.
    fn is_body(&self, instance: u32, surfaces: &Surfaces) -> bool {
        let is_translucent = self.world.method(instance).is_some() && surfaces.is_closed[instance as usize];
        is_translucent || self.world.interior(instance).is_some()
    }

    fn is_in_body(&self, point: Vec3) -> bool {
        self.world.has_interiors() && self.world.interiors_at(point, UPWARDS).current().is_some()
    }

    fn surfaces(&self) -> Option<Surfaces> {
        let mut triangles = Vec::new();
        let (mut areas, mut is_closed) = (Vec::new(), Vec::new());
        for instance in 0..self.world.substances().len() as u32 {
            let (mut whole, mut directed) = (0.0, DVec3::ZERO);
            for (primitive, [a, b, c]) in (0..).zip(self.world.triangles(instance)) {
                let vector = 0.5 * (b - a).cross(c - a);
                triangles.push((instance, primitive));
                areas.push(vector.length());
                whole += f64::from(vector.length());
                directed += vector.as_dvec3();
            }
            is_closed.push(directed.length() <= ROUNDING * whole);
        }
        let area = areas.iter().map(|&area| f64::from(area)).sum::<f64>() as f32;
        (area > 0.0).then(|| Surfaces { triangles, by_area: Discrete::new(areas), is_closed, area })
    }

    /// Centre and radius of a sphere around all geometry, m.
    fn bounding_sphere(&self) -> (Vec3, f32) {
        let bounds = (0..self.world.substances().len() as u32).map(|instance| self.world.bounds(instance));
        let (low, high) = bounds
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), (a, b)| (low.min(a), high.max(b)));
        // A little more, so that nothing lies on it.
        (0.5 * (low + high), 0.5 * (high - low).length() * 1.01 + f32::MIN_POSITIVE)
    }

    /// Radiance that leaves through the sphere at a random point, in a random direction.
    fn leaving(&self, center: Vec3, radius: f32, sample: u64) -> Rgb {
        let (origin, direction) = crossing(center, radius, sample, self.options.seed);
        self.found(origin, direction, sample, 1)
    }

    /// Radiance of the environment that comes in there, from the opposite side of the sphere.
    fn entering(&self, center: Vec3, radius: f32, sample: u64) -> Rgb {
        let (_, direction) = crossing(center, radius, sample, self.options.seed);
        self.scene().environment.as_ref().map_or(Rgb::ZERO, |environment| environment.radiance(direction))
    }

    /// What a random point of a surface emits by itself if it is no light, and what it absorbs, in a random direction on either side.
    fn at_surface(&self, surfaces: &Surfaces, sample: u64) -> (Rgb, Rgb) {
        let nothing = (Rgb::ZERO, Rgb::ZERO);
        let mut random = HashGenerator::new(self.options.seed ^ sample.wrapping_mul(3).wrapping_add(1));
        let Some((index, _, _)) = surfaces.by_area.sample(random.next_f32()) else { return nothing };
        let (instance, primitive) = surfaces.triangles[index];
        let point = self.random_point(instance, primitive, &mut random);
        let (side, sides) = match self.is_body(instance, surfaces) {
            true => (1.0, 1.0),
            false => (if random.next_f32() < 0.5 { 1.0 } else { -1.0 }, 2.0),
        };
        let normal = point.geometric_normal * side;
        let local = warp::square_to_cosine_hemisphere(random.next_f32(), random.next_f32());
        let outward = Frame::from_normal(normal).to_world(local);
        if outward.dot(normal) <= 0.0 {
            return nothing;
        }
        let origin = offset_from_surface(point.position, point.error, point.geometric_normal, outward);
        if self.is_in_body(origin) {
            return nothing;
        }
        let own = match self.world.substance(instance) {
            Substance::Light(_) => Rgb::ZERO,
            Substance::Material(material) => {
                let material = &self.scene().materials[material];
                let shines = material.double_sided || side > 0.0;
                if shines { color::<CAN>(self.scene(), &material.emission, &point) } else { Rgb::ZERO }
            }
        };
        let arriving = self.found(origin, outward, sample, 2);
        let leaving = self.found(origin, -outward, sample, 3);
        (own * sides, (arriving - leaving + own) * sides)
    }

    /// Radiance that a path from the air finds, but straight from a lamp.
    fn found(&self, origin: Vec3, direction: Vec3, sample: u64, part: u64) -> Rgb {
        let first = self.world.caster().closest(&Ray::new(origin, direction));
        if first.is_some_and(|hit| matches!(self.world.substance(hit.instance), Substance::Light(_))) {
            return Rgb::ZERO;
        }
        let stream = SampleStream::new(self.options.seed, STREAMS + part, sample);
        let radiance =
            self.follow(stream, &Interiors::default(), origin, direction, &mut Counters::default());
        if radiance.is_finite() { radiance } else { Rgb::ZERO }
    }
}

/// A random point of the sphere, and a direction into it, cosine-distributed: what is seen from there is what leaves there.
fn crossing(center: Vec3, radius: f32, sample: u64, seed: u64) -> (Vec3, Vec3) {
    let mut random = HashGenerator::new(seed ^ sample.wrapping_mul(3));
    let z = 2.0 * random.next_f32() - 1.0;
    let (sin, cos) = (TAU * random.next_f32()).sin_cos();
    let across = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
    let normal = Vec3::new(across * cos, across * sin, z);
    let local = warp::square_to_cosine_hemisphere(random.next_f32(), random.next_f32());
    (center + normal * radius, Frame::from_normal(-normal).to_world(local))
}

/// The power, W, that radiance 1 takes through an area (m²), in the directions on one side of it.
fn flux(area: f32) -> f64 {
    (Radiance(1.0).exitance(ProjectedSolidAngle::HEMISPHERE) * Area(area.into())).0
}

/// Means of `K` values, times `scale`.
fn tally<const K: usize>(samples: u64, scale: f64, sample: impl Fn(u64) -> [Rgb; K] + Sync) -> [Power; K] {
    let drawn: Vec<[Rgb; K]> = (0..samples).into_par_iter().map(&sample).collect();
    let count = samples.max(2) as f64;
    let mean =
        |k: usize, c: usize| drawn.iter().map(|radiances| f64::from(radiances[k][c])).sum::<f64>() / count;
    let error = |k: usize, c: usize, mean: f64| {
        let squares: f64 = drawn.iter().map(|radiances| (f64::from(radiances[k][c]) - mean).powi(2)).sum();
        (squares / (count - 1.0) / count).sqrt()
    };
    array::from_fn(|k| {
        let means: [f64; 3] = array::from_fn(|c| mean(k, c));
        Power {
            value: means.map(|mean| mean * scale),
            stderr: array::from_fn(|c| error(k, c, means[c]) * scale),
        }
    })
}

impl Power {
    fn exact(power: Rgb) -> Self {
        Self { value: power.0.map(f64::from), stderr: [0.0; 3] }
    }

    fn plus(&self, other: &Self) -> Self {
        Self {
            value: array::from_fn(|c| self.value[c] + other.value[c]),
            stderr: array::from_fn(|c| self.stderr[c].hypot(other.stderr[c])),
        }
    }

    fn less(&self, other: &Self) -> Self {
        self.plus(&Self { value: other.value.map(|x| -x), ..*other })
    }
}
