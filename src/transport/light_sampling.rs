//! Direct light: which emitter, which point on it, and the density with which it would have been chosen.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use super::world::{Substance, SurfacePoint, World};
use crate::math::distribution::{Discrete, Piecewise2d};
use crate::math::{Frame, warp};
use crate::radiometry::Rgb;
use crate::raycast::RayCaster;
use crate::scene::environment::{direction_to_uv, uv_to_direction};
use crate::scene::light::spot_falloff;
use crate::scene::{Environment, Light};

/// Light towards a point from one direction.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit direction to the light.
    pub direction: Vec3,
    /// Distance to it, m; infinite for far light.
    pub distance: f32,
    /// Radiance over density, or irradiance-like intensity over squared distance for lights without size;
    /// divided by the probability of the choice of emitter.
    pub value: Rgb,
    /// Density per solid angle, choice of emitter included; `None` for a light that only this
    /// sampling can find.
    pub density: Option<f32>,
}

enum Emitter {
    Light(usize),
    /// Instance, and its triangles by area.
    Mesh(u32, Discrete),
    Environment(Piecewise2d),
}

/// All emitters, chosen by power.
pub struct LightSampler {
    emitters: Vec<Emitter>,
    choice: Discrete,
    of_light: Vec<Option<usize>>,
    of_instance: Vec<Option<usize>>,
    of_environment: Option<usize>,
    /// Area of each emissive mesh, m².
    area: Vec<f32>,
}

impl LightSampler {
    /// Collects the emitters of `world`.
    pub fn new<C: RayCaster>(world: &World<C>, world_radius: f32) -> Self {
        let scene = world.scene();
        let mut sampler = Self {
            emitters: Vec::new(),
            choice: Discrete::default(),
            of_light: vec![None; scene.lights.len()],
            of_instance: vec![None; world.substances().len()],
            of_environment: None,
            area: Vec::new(),
        };
        let mut powers = Vec::new();
        for (index, light) in scene.lights.iter().enumerate() {
            let power = power(light, world_radius);
            if power > 0.0 {
                sampler.of_light[index] = Some(sampler.push(Emitter::Light(index), 0.0));
                powers.push(power);
            }
        }
        for (index, substance) in world.substances().iter().enumerate() {
            let Substance::Material(material) = *substance else { continue };
            let radiance = mean_emission(world, material);
            if radiance <= 0.0 {
                continue;
            }
            let areas = triangle_areas(world, index as u32);
            let area = areas.iter().map(|&a| f64::from(a)).sum::<f64>() as f32;
            if area > 0.0 {
                let emitter = Emitter::Mesh(index as u32, Discrete::new(areas));
                sampler.of_instance[index] = Some(sampler.push(emitter, area));
                powers.push(PI * area * radiance);
            }
        }
        if let Some(environment @ Environment::Map { .. }) = &scene.environment {
            let (distribution, mean) = environment_distribution(environment);
            if !distribution.is_empty() {
                sampler.of_environment = Some(sampler.push(Emitter::Environment(distribution), 0.0));
                powers.push(4.0 * PI * PI * world_radius * world_radius * mean);
            }
        }
        // Half by power, half alike: a weak light close by may still be the one that counts.
        let total: f32 = powers.iter().sum();
        let count = powers.len() as f32;
        sampler.choice = Discrete::new(powers.iter().map(|p| 0.5 * p / total + 0.5 / count));
        sampler
    }

    fn push(&mut self, emitter: Emitter, area: f32) -> usize {
        self.emitters.push(emitter);
        self.area.push(area);
        self.emitters.len() - 1
    }

    /// Draws light towards `point`; `u` chooses the emitter and, reused, the point on it with `v`.
    pub fn sample<C: RayCaster>(&self, world: &World<C>, point: Vec3, u: [f32; 3]) -> Option<LightSample> {
        let (index, probability, _) = self.choice.sample(u[0])?;
        let sample = match &self.emitters[index] {
            Emitter::Light(light) => sample_light(&world.scene().lights[*light], point, u[1], u[2]),
            Emitter::Mesh(instance, triangles) => {
                sample_mesh(world, *instance, triangles, self.area[index], point, u[1], u[2])
            }
            Emitter::Environment(distribution) => {
                sample_environment(world.scene().environment.as_ref()?, distribution, u[1], u[2])
            }
        }?;
        Some(LightSample {
            value: sample.value / probability,
            density: sample.density.map(|d| d * probability),
            ..sample
        })
    }

    /// Density per solid angle with which [`Self::sample`] at `origin` finds the point `hit` on an
    /// emitter, seen in unit `direction` at `distance`.
    pub fn density<C: RayCaster>(
        &self,
        world: &World<C>,
        origin: Vec3,
        direction: Vec3,
        distance: f32,
        hit: &SurfacePoint,
    ) -> f32 {
        let cos = direction.dot(hit.geometric_normal).abs();
        match world.substance(hit.instance) {
            Substance::Light(light) => self.of_light[light].map_or(0.0, |index| {
                self.choice.probability(index)
                    * light_density(&world.scene().lights[light], origin, distance, cos)
            }),
            Substance::Material(_) => self.of_instance[hit.instance as usize].map_or(0.0, |index| {
                self.choice.probability(index) * distance * distance / (cos * self.area[index])
            }),
        }
    }

    /// Density per solid angle with which [`Self::sample`] finds the environment in unit `direction`.
    pub fn environment_density(&self, environment: &Environment, direction: Vec3) -> f32 {
        let Some(index) = self.of_environment else { return 0.0 };
        let Emitter::Environment(distribution) = &self.emitters[index] else { return 0.0 };
        let Environment::Map { rotation, .. } = environment else { return 0.0 };
        let uv = direction_to_uv(*rotation * direction);
        self.choice.probability(index) * distribution.density(uv.x, uv.y) / (2.0 * PI * PI * sin_polar(uv.y))
    }
}

/// Radiant power, channels averaged, W: only to choose between lights.
fn power(light: &Light, world_radius: f32) -> f32 {
    match light {
        Light::Quad { half_u, half_v, radiance, .. } => {
            PI * 4.0 * half_u.cross(*half_v).length() * radiance.mean()
        }
        Light::Disk { radius, radiance, .. } => PI * PI * radius * radius * radiance.mean(),
        Light::Sphere { radius, radiance, .. } => 4.0 * PI * PI * radius * radius * radiance.mean(),
        Light::Point { intensity, .. } => 4.0 * PI * intensity.mean(),
        Light::Spot { intensity, outer_angle, .. } => 2.0 * PI * (1.0 - outer_angle.cos()) * intensity.mean(),
        Light::Directional { irradiance, .. } => PI * world_radius * world_radius * irradiance.mean(),
    }
}

fn mean_emission<C: RayCaster>(world: &World<C>, material: usize) -> f32 {
    // The factor bounds what a texture leaves of it; good enough to choose between lights.
    world.scene().materials[material].emission.factor.mean()
}

fn triangle_areas<C: RayCaster>(world: &World<C>, instance: u32) -> Vec<f32> {
    let mesh = world.scene().instances[instance as usize].mesh;
    (0..world.scene().meshes[mesh].triangles.len() as u32)
        .map(|primitive| {
            let [a, b, c] = world.triangle(instance, primitive);
            0.5 * (b - a).cross(c - a).length()
        })
        .collect()
}

/// Light of value `radiance` from the point `target`, a surface element of normal `normal` drawn with
/// `density` per area that emits on one side.
fn from_area(point: Vec3, target: Vec3, normal: Vec3, radiance: Rgb, density: f32) -> Option<LightSample> {
    let offset = target - point;
    let squared = offset.length_squared();
    let distance = squared.sqrt();
    let direction = offset / distance;
    let cos = -direction.dot(normal);
    let density = density * squared / cos;
    (cos > 0.0 && density.is_finite() && density > 0.0).then(|| LightSample {
        direction,
        distance,
        value: radiance / density,
        density: Some(density),
    })
}

fn sample_light(light: &Light, point: Vec3, u: f32, v: f32) -> Option<LightSample> {
    match *light {
        Light::Quad { center, half_u, half_v, radiance } => {
            let cross = half_u.cross(half_v);
            let target = center + half_u * (2.0 * u - 1.0) + half_v * (2.0 * v - 1.0);
            let area = 4.0 * cross.length();
            from_area(point, target, cross.normalize_or_zero(), radiance, 1.0 / area)
        }
        Light::Disk { center, normal, radius, radiance } => {
            let p = warp::square_to_disk(u, v) * radius;
            let frame = Frame::from_normal(normal);
            let target = center + frame.tangent * p.x + frame.bitangent * p.y;
            from_area(point, target, normal, radiance, 1.0 / (PI * radius * radius))
        }
        Light::Sphere { center, radius, radiance } => {
            let offset = center - point;
            let squared = offset.length_squared();
            let one_minus_cos = cone_of_sphere(squared, radius)?;
            let local = warp::square_to_cone(u, v, one_minus_cos);
            let direction = Frame::from_normal(offset / squared.sqrt()).to_world(local);
            // Nearer of the two crossings; written to survive a grazing direction.
            let along = direction.dot(offset);
            let inside = (radius * radius - (squared - along * along)).max(0.0).sqrt();
            let density = 1.0 / (2.0 * PI * one_minus_cos);
            Some(LightSample {
                direction,
                distance: along - inside,
                value: radiance / density,
                density: Some(density),
            })
        }
        Light::Point { position, intensity } => from_point(point, position, intensity),
        Light::Spot { position, direction, intensity, inner_angle, outer_angle } => {
            let sample = from_point(point, position, intensity)?;
            let fade = spot_falloff(-sample.direction.dot(direction), inner_angle, outer_angle);
            (fade > 0.0).then_some(LightSample { value: sample.value * fade, ..sample })
        }
        Light::Directional { direction, irradiance } => Some(LightSample {
            direction: -direction,
            distance: f32::INFINITY,
            value: irradiance,
            density: None,
        }),
    }
}

fn from_point(point: Vec3, position: Vec3, intensity: Rgb) -> Option<LightSample> {
    let offset = position - point;
    let squared = offset.length_squared();
    let distance = squared.sqrt();
    (squared > 0.0).then(|| LightSample {
        direction: offset / distance,
        distance,
        value: intensity / squared,
        density: None,
    })
}

/// 1 − cosine of the half angle under which a sphere is seen from squared distance `squared`; `None`
/// from inside.
fn cone_of_sphere(squared: f32, radius: f32) -> Option<f32> {
    let sin2 = radius * radius / squared;
    // 1 − √(1 − s) = s/(1 + √(1 − s)) keeps the digits of small lights.
    (sin2 < 1.0).then(|| sin2 / (1.0 + (1.0 - sin2).sqrt()))
}

fn light_density(light: &Light, origin: Vec3, distance: f32, cos: f32) -> f32 {
    let by_area = |area: f32| distance * distance / (cos * area);
    match light {
        Light::Quad { half_u, half_v, .. } => by_area(4.0 * half_u.cross(*half_v).length()),
        Light::Disk { radius, .. } => by_area(PI * radius * radius),
        Light::Sphere { center, radius, .. } => {
            cone_of_sphere((*center - origin).length_squared(), *radius).map_or(0.0, |c| 1.0 / (2.0 * PI * c))
        }
        Light::Point { .. } | Light::Spot { .. } | Light::Directional { .. } => 0.0,
    }
}

fn sample_mesh<C: RayCaster>(
    world: &World<C>,
    instance: u32,
    triangles: &Discrete,
    area: f32,
    point: Vec3,
    u: f32,
    v: f32,
) -> Option<LightSample> {
    let (primitive, _, u) = triangles.sample(u)?;
    let barycentric = warp::square_to_triangle(u, v);
    let hit = crate::raycast::Hit {
        t: 0.0,
        u: barycentric.x,
        v: barycentric.y,
        instance,
        primitive: primitive as u32,
    };
    let surface = world.surface(&hit);
    let Substance::Material(index) = world.substance(instance) else { return None };
    let material = &world.scene().materials[index];
    let radiance = world.scene().color(&material.emission, surface.texture_coordinates, surface.color);
    let toward = point - surface.position;
    let normal = surface.geometric_normal;
    let normal = if material.double_sided && toward.dot(normal) < 0.0 { -normal } else { normal };
    from_area(point, surface.position, normal, radiance, 1.0 / area)
}

fn sin_polar(y: f32) -> f32 {
    // Never exactly 0: a density at the pole stays finite.
    (PI * y).sin().max(1e-6)
}

/// Density over the map in proportion to luminance and solid angle, and the mean radiance. Each cell
/// takes the mean of its neighbourhood, so that bilinear look-up is nowhere brighter than zero density.
fn environment_distribution(environment: &Environment) -> (Piecewise2d, f32) {
    let Environment::Map { width, height, radiance, .. } = environment else {
        return (Piecewise2d::new(1, 1, &[0.0]), 0.0);
    };
    let (width, height) = (*width, *height);
    let brightness: Vec<f32> = radiance.iter().map(|l| l.mean()).collect();
    let at = |x: usize, y: usize| brightness[y.min(height - 1) * width + x % width];
    let mut weights = Vec::with_capacity(width * height);
    let (mut total, mut solid_angle) = (0.0_f64, 0.0_f64);
    for y in 0..height {
        let sin = sin_polar((y as f32 + 0.5) / height as f32);
        for x in 0..width {
            let rows = [y.saturating_sub(1), y, y + 1];
            let columns = [x + width - 1, x, x + 1];
            let sum: f32 = rows.iter().flat_map(|&r| columns.map(|c| at(c, r))).sum();
            weights.push(sum / 9.0 * sin);
            total += f64::from(at(x, y) * sin);
            solid_angle += f64::from(sin);
        }
    }
    (Piecewise2d::new(width, height, &weights), (total / solid_angle) as f32)
}

fn sample_environment(
    environment: &Environment,
    distribution: &Piecewise2d,
    u: f32,
    v: f32,
) -> Option<LightSample> {
    let Environment::Map { rotation, .. } = environment else { return None };
    let (x, y, density) = distribution.sample(u, v)?;
    let direction = rotation.transpose() * uv_to_direction(Vec2::new(x, y));
    let density = density / (2.0 * PI * PI * sin_polar(y));
    Some(LightSample {
        direction,
        distance: f32::INFINITY,
        value: environment.radiance(direction) / density,
        density: Some(density),
    })
}
