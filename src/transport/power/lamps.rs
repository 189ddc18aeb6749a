//! Rays that the lights of a scene send out, as many as they have power.

use std::f32::consts::{PI, TAU};

use glam::Vec3;

use crate::math::distribution::Discrete;
use crate::math::robust::offset_from_surface;
use crate::math::sampler::HashGenerator;
use crate::math::{Frame, warp};
use crate::plan::Abilities;
use crate::radiometry::{RadiantFlux, Rgb};
use crate::raycast::{Hit, RayCaster};
use crate::scene::Light;
use crate::scene::light::{spot_falloff, spot_solid_angle};
use crate::transport::substance::Substance;
use crate::transport::world::World;

/// The lights of a scene, drawn by power.
pub struct Lamps {
    lamps: Vec<Lamp>,
    by_power: Discrete,
}

struct Lamp {
    /// By channel, W.
    power: Rgb,
    outlet: Outlet,
}

/// From where, and to where, a light sends rays.
enum Outlet {
    /// From triangles, drawn by area, to all sides of their normals.
    Surface { instance: u32, triangles: Discrete },
    /// To all sides.
    Point(Vec3),
    /// Within the outer half angle, radians, and less outside of the inner one.
    Cone { position: Vec3, direction: Vec3, inner: f32, outer: f32 },
    /// In one direction through a sphere.
    Parallel { center: Vec3, radius: f32, direction: Vec3 },
}

/// A ray that a light sends out.
pub struct SentRay {
    /// Where it begins, m.
    pub origin: Vec3,
    /// Unit direction.
    pub direction: Vec3,
    /// By channel, W: the mean over rays is the power of all lights.
    pub power: Rgb,
}

impl Lamps {
    /// The lights of `world`; of parallel light, what comes to the sphere of `radius` around `center` (m).
    pub fn new<C: RayCaster>(world: &World<C>, center: Vec3, radius: f32) -> Self {
        let scene = world.scene();
        let of_instance = |instance: u32| match world.substance(instance) {
            Substance::Light(light) => {
                let area = |[a, b, c]: [Vec3; 3]| 0.5 * (b - a).cross(c - a).length();
                let triangles = Discrete::new(world.triangles(instance).map(area));
                let power = scene.lights[light].power()?.0;
                Some(Lamp { power, outlet: Outlet::Surface { instance, triangles } })
            }
            Substance::Material(_) => None,
        };
        let without_size = |light: &Light| {
            let power = light.power().map_or(Rgb::ZERO, |RadiantFlux(power)| power);
            match *light {
                Light::Point { position, .. } => Some(Lamp { power, outlet: Outlet::Point(position) }),
                Light::Spot { position, direction, inner_angle: inner, outer_angle: outer, .. } => {
                    Some(Lamp { power, outlet: Outlet::Cone { position, direction, inner, outer } })
                }
                Light::Directional { direction, irradiance } => {
                    let power = irradiance.rgb * (PI * radius * radius);
                    Some(Lamp { power, outlet: Outlet::Parallel { center, radius, direction } })
                }
                Light::Quad { .. } | Light::Disk { .. } | Light::Sphere { .. } => None,
            }
        };
        let with_size = (0..world.substances().len() as u32).filter_map(of_instance);
        let lamps: Vec<Lamp> = with_size.chain(scene.lights.iter().filter_map(without_size)).collect();
        let by_power = Discrete::new(lamps.iter().map(|lamp| lamp.power.mean()));
        Self { lamps, by_power }
    }

    /// Power that comes in from outside, W: parallel light.
    pub fn entering(&self) -> Rgb {
        let entering = self.lamps.iter().filter(|lamp| matches!(lamp.outlet, Outlet::Parallel { .. }));
        entering.fold(Rgb::ZERO, |sum, lamp| sum + lamp.power)
    }

    /// Power that is emitted in the scene, W.
    pub fn emitted(&self) -> Rgb {
        let emitted = self.lamps.iter().filter(|lamp| !matches!(lamp.outlet, Outlet::Parallel { .. }));
        emitted.fold(Rgb::ZERO, |sum, lamp| sum + lamp.power)
    }

    /// Sends out a ray; none if there is no light.
    pub fn send<C: RayCaster>(&self, world: &World<C>, random: &mut HashGenerator) -> Option<SentRay> {
        let (lamp, share, _) = self.by_power.sample(random.next_f32())?;
        let Lamp { power, outlet } = &self.lamps[lamp];
        let (origin, direction, relative) = outlet.draw(world, random)?;
        Some(SentRay { origin, direction, power: *power * (relative / share) })
    }
}

impl Outlet {
    /// Origin and direction of a ray, and its power relative to the mean.
    fn draw<C: RayCaster>(&self, world: &World<C>, random: &mut HashGenerator) -> Option<(Vec3, Vec3, f32)> {
        let pick = random.next_f32();
        let (u, v) = (random.next_f32(), random.next_f32());
        Some(match *self {
            Self::Surface { instance, ref triangles } => {
                let (primitive, _, _) = triangles.sample(pick)?;
                let place = warp::square_to_triangle(random.next_f32(), random.next_f32());
                let hit = Hit { t: 0.0, u: place.x, v: place.y, instance, primitive: primitive as u32 };
                let point = world.surface::<{ Abilities::NONE.bits() }>(&hit);
                let normal = point.geometric_normal;
                let direction = Frame::from_normal(normal).to_world(warp::square_to_cosine_hemisphere(u, v));
                (offset_from_surface(point.position, point.error, normal, direction), direction, 1.0)
            }
            Self::Point(position) => (position, warp::square_to_cone(u, v, 2.0), 1.0),
            Self::Cone { position, direction, inner, outer } => {
                let one_minus_cos = 2.0 * (0.5 * outer).sin().powi(2);
                let local = warp::square_to_cone(u, v, one_minus_cos);
                let falloff = spot_falloff(local.z, inner, outer);
                let relative = falloff * TAU * one_minus_cos / spot_solid_angle(inner, outer);
                (position, Frame::from_normal(direction).to_world(local), relative)
            }
            Self::Parallel { center, radius, direction } => {
                let disk = warp::square_to_disk(u, v) * radius;
                let frame = Frame::from_normal(direction);
                let origin = center - direction * radius + frame.tangent * disk.x + frame.bitangent * disk.y;
                (origin, direction, 1.0)
            }
        })
    }
}
