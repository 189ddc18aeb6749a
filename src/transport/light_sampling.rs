//! Direct light: which emitter, which point on it, and the density with which it would have been chosen.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use super::basis::Basis;
use super::light_choice::{LightChoice, Reach, Receiver};
use super::shading::color;
use super::substance::Substance;
use super::world::{SurfacePoint, World};
use crate::math::distribution::{Discrete, Piecewise2d};
use crate::math::{Frame, warp};
use crate::radiometry::Spectrum;
use crate::raycast::{Hit, RayCaster};
use crate::scene::environment::{direction_to_uv, uv_to_direction};
use crate::scene::light::spot_falloff;
use crate::scene::{Environment, Light};

/// Light towards a point from one direction.
#[derive(Clone, Copy, Debug)]
pub struct LightSample<const N: usize = 3> {
    /// Unit direction to the light.
    pub direction: Vec3,
    /// Distance to it, m; infinite for far light.
    pub distance: f32,
    /// Radiance over density, or irradiance-like intensity over squared distance for lights without size;
    /// divided by the probability of the choice of emitter.
    pub value: Spectrum<N>,
    /// Density per solid angle, choice of emitter included; `None` for a light that only this
    /// sampling can find.
    pub density: Option<f32>,
}

/// An instance whose material emits.
struct EmissiveMesh {
    instance: u32,
    /// m².
    area: f32,
    /// By area.
    triangles: Discrete,
}

enum Emitter {
    Light(usize),
    Mesh(EmissiveMesh),
    Environment(Piecewise2d),
}

/// All emitters.
pub struct LightSampler {
    emitters: Vec<Emitter>,
    choice: LightChoice,
    of_light: Vec<Option<usize>>,
    of_instance: Vec<Option<usize>>,
    of_environment: Option<usize>,
}

impl LightSampler {
    /// Collects the emitters of `world`, whose geometry fits a sphere of radius `world_radius`.
    pub fn new<C: RayCaster>(world: &World<C>, world_radius: f32) -> Self {
        let scene = world.scene();
        let mut emitters = Vec::new();
        let mut reaches = Vec::new();
        let mut add = |emitter, reach| {
            emitters.push(emitter);
            reaches.push(reach);
            emitters.len() - 1
        };
        let of_light = scene
            .lights
            .iter()
            .enumerate()
            .map(|(index, light)| reach(light).map(|reach| add(Emitter::Light(index), reach)))
            .collect();
        let of_instance = (0..world.substances().len() as u32)
            .map(|instance| emissive_mesh(world, instance).map(|(emitter, reach)| add(emitter, reach)))
            .collect();
        let of_environment = scene
            .environment
            .as_ref()
            .and_then(environment_emitter)
            .map(|(emitter, reach)| add(emitter, reach));
        let choice = LightChoice::new(reaches, world_radius);
        Self { emitters, choice, of_light, of_instance, of_environment }
    }

    /// How many emitters there are to draw from.
    pub fn emitter_count(&self) -> usize {
        self.emitters.len()
    }

    /// Draws light for `receiver`; `u[0]` chooses the emitter, the others the point on it.
    /// `CAN` is what the kernel that asks has code for.
    pub fn sample<C: RayCaster, B: Basis<N>, const N: usize, const CAN: u32>(
        &self,
        basis: &B,
        world: &World<C>,
        receiver: &Receiver,
        u: [f32; 3],
    ) -> Option<LightSample<N>> {
        let (index, probability) = self.choice.sample(receiver, u[0])?;
        let point = receiver.position;
        let sample = match &self.emitters[index] {
            Emitter::Light(index) => {
                let light = &world.scene().lights[*index];
                sample_light(light, basis.light(*index, light), point, u[1], u[2])
            }
            Emitter::Mesh(mesh) => sample_mesh::<C, B, N, CAN>(basis, world, mesh, point, u[1], u[2]),
            Emitter::Environment(distribution) => {
                sample_environment(basis, world.scene().environment.as_ref()?, distribution, u[1], u[2])
            }
        }?;
        Some(LightSample {
            value: sample.value / probability,
            density: sample.density.map(|d| d * probability),
            ..sample
        })
    }

    /// Density per solid angle with which [`Self::sample`] for `receiver` finds the point `hit` on an
    /// emitter, seen in unit `direction`.
    pub fn density<C: RayCaster>(
        &self,
        world: &World<C>,
        receiver: &Receiver,
        direction: Vec3,
        hit: &SurfacePoint,
    ) -> f32 {
        let index = match world.substance(hit.instance) {
            Substance::Light(light) => self.of_light[light],
            Substance::Material(_) => self.of_instance[hit.instance as usize],
        };
        let Some(index) = index else { return 0.0 };
        let squared = hit.position.distance_squared(receiver.position);
        let cos = direction.dot(hit.geometric_normal).abs();
        let density = match &self.emitters[index] {
            Emitter::Light(light) => {
                light_density(&world.scene().lights[*light], receiver.position, squared, cos)
            }
            Emitter::Mesh(mesh) => squared / (cos * mesh.area),
            Emitter::Environment(_) => 0.0,
        };
        self.choice.probability(receiver, index) * density
    }

    /// Density per solid angle with which [`Self::sample`] for `receiver` finds the environment in unit
    /// `direction`.
    pub fn environment_density(
        &self,
        environment: &Environment,
        receiver: &Receiver,
        direction: Vec3,
    ) -> f32 {
        let Some(index) = self.of_environment else { return 0.0 };
        let Emitter::Environment(distribution) = &self.emitters[index] else { return 0.0 };
        let Environment::Map { rotation, .. } = environment else { return 0.0 };
        let uv = direction_to_uv(*rotation * direction);
        let density = distribution.density(uv.x, uv.y) / (2.0 * PI * PI * sin_polar(uv.y));
        self.choice.probability(receiver, index) * density
    }
}

/// Where `light` is and what it sends; `None` if it sends nothing.
fn reach(light: &Light) -> Option<Reach> {
    let near = |center: Vec3, radius: f32, normal: Option<Vec3>, intensity: f32| Reach::Near {
        center,
        radius,
        normal,
        intensity,
    };
    let (reach, value) = match *light {
        Light::Quad { center, half_u, half_v, radiance } => {
            let cross = half_u.cross(half_v);
            let radius = (half_u.length_squared() + half_v.length_squared()).sqrt();
            let intensity = 4.0 * cross.length() * radiance.rgb.mean();
            (near(center, radius, Some(cross.normalize_or_zero()), intensity), radiance)
        }
        Light::Disk { center, normal, radius, radiance } => {
            (near(center, radius, Some(normal), PI * radius * radius * radiance.rgb.mean()), radiance)
        }
        Light::Sphere { center, radius, radiance } => {
            (near(center, radius, None, PI * radius * radius * radiance.rgb.mean()), radiance)
        }
        Light::Point { position, intensity } => (near(position, 0.0, None, intensity.rgb.mean()), intensity),
        Light::Spot { position, intensity, .. } => {
            (near(position, 0.0, None, intensity.rgb.mean()), intensity)
        }
        Light::Directional { direction, irradiance } => {
            (Reach::Far { direction: Some(-direction), irradiance: irradiance.rgb.mean() }, irradiance)
        }
    };
    (!value.rgb.is_black()).then_some(reach)
}

/// The triangles of an instance as an emitter; `None` if it does not emit.
fn emissive_mesh<C: RayCaster>(world: &World<C>, instance: u32) -> Option<(Emitter, Reach)> {
    let Substance::Material(material) = world.substance(instance) else { return None };
    // The factor bounds what a texture leaves of it: good enough to choose between lights.
    let radiance = world.scene().materials[material].emission.factor.mean();
    let areas = if radiance > 0.0 { triangle_areas(world, instance) } else { Vec::new() };
    let area = areas.iter().map(|&a| f64::from(a)).sum::<f64>() as f32;
    if area <= 0.0 {
        return None;
    }
    let (low, high) = world.bounds(instance);
    // Seen from afar a convex closed surface shows a quarter of its area, on average over directions.
    let reach = Reach::Near {
        center: 0.5 * (low + high),
        radius: 0.5 * (high - low).length(),
        normal: None,
        intensity: 0.25 * area * radiance,
    };
    Some((Emitter::Mesh(EmissiveMesh { instance, area, triangles: Discrete::new(areas) }), reach))
}

fn environment_emitter(environment: &Environment) -> Option<(Emitter, Reach)> {
    let Environment::Map { .. } = environment else { return None };
    let (distribution, mean) = environment_distribution(environment);
    let reach = Reach::Far { direction: None, irradiance: PI * mean };
    (!distribution.is_empty()).then_some((Emitter::Environment(distribution), reach))
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
fn from_area<const N: usize>(
    point: Vec3,
    target: Vec3,
    normal: Vec3,
    radiance: Spectrum<N>,
    density: f32,
) -> Option<LightSample<N>> {
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

/// Light from `light`, which emits `emitted` in the unit of its kind.
fn sample_light<const N: usize>(
    light: &Light,
    emitted: Spectrum<N>,
    point: Vec3,
    u: f32,
    v: f32,
) -> Option<LightSample<N>> {
    match *light {
        Light::Quad { center, half_u, half_v, .. } => {
            let cross = half_u.cross(half_v);
            let target = center + half_u * (2.0 * u - 1.0) + half_v * (2.0 * v - 1.0);
            let area = 4.0 * cross.length();
            from_area(point, target, cross.normalize_or_zero(), emitted, 1.0 / area)
        }
        Light::Disk { center, normal, radius, .. } => {
            let p = warp::square_to_disk(u, v) * radius;
            let frame = Frame::from_normal(normal);
            let target = center + frame.tangent * p.x + frame.bitangent * p.y;
            from_area(point, target, normal, emitted, 1.0 / (PI * radius * radius))
        }
        Light::Sphere { center, radius, .. } => {
            let offset = center - point;
            let squared = offset.length_squared();
            let one_minus_cos = cone_of_sphere(squared, radius)?;
            let local = warp::square_to_cone(u, v, one_minus_cos);
            let direction = Frame::from_normal(offset / squared.sqrt()).to_world(local);
            // Nearer of the two crossings, by the sine: at a distance of 10⁴ radii the cosine no longer tells it from the farther one.
            let along = direction.dot(offset);
            let inside = (radius * radius - squared * local.truncate().length_squared()).max(0.0).sqrt();
            let density = 1.0 / (2.0 * PI * one_minus_cos);
            Some(LightSample {
                direction,
                distance: along - inside,
                value: emitted / density,
                density: Some(density),
            })
        }
        Light::Point { position, .. } => from_point(point, position, emitted),
        Light::Spot { position, direction, inner_angle, outer_angle, .. } => {
            let sample = from_point(point, position, emitted)?;
            let fade = spot_falloff(-sample.direction.dot(direction), inner_angle, outer_angle);
            (fade > 0.0).then_some(LightSample { value: sample.value * fade, ..sample })
        }
        Light::Directional { direction, .. } => Some(LightSample {
            direction: -direction,
            distance: f32::INFINITY,
            value: emitted,
            density: None,
        }),
    }
}

fn from_point<const N: usize>(point: Vec3, position: Vec3, intensity: Spectrum<N>) -> Option<LightSample<N>> {
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

fn light_density(light: &Light, origin: Vec3, squared: f32, cos: f32) -> f32 {
    let by_area = |area: f32| squared / (cos * area);
    match light {
        Light::Quad { half_u, half_v, .. } => by_area(4.0 * half_u.cross(*half_v).length()),
        Light::Disk { radius, .. } => by_area(PI * radius * radius),
        Light::Sphere { center, radius, .. } => {
            cone_of_sphere((*center - origin).length_squared(), *radius).map_or(0.0, |c| 1.0 / (2.0 * PI * c))
        }
        Light::Point { .. } | Light::Spot { .. } | Light::Directional { .. } => 0.0,
    }
}

fn sample_mesh<C: RayCaster, B: Basis<N>, const N: usize, const CAN: u32>(
    basis: &B,
    world: &World<C>,
    mesh: &EmissiveMesh,
    point: Vec3,
    u: f32,
    v: f32,
) -> Option<LightSample<N>> {
    let (primitive, _, u) = mesh.triangles.sample(u)?;
    let barycentric = warp::square_to_triangle(u, v);
    let on_triangle = Hit {
        t: 0.0,
        u: barycentric.x,
        v: barycentric.y,
        instance: mesh.instance,
        primitive: primitive as u32,
    };
    let surface = world.surface::<CAN>(&on_triangle);
    let Substance::Material(index) = world.substance(mesh.instance) else { return None };
    let material = &world.scene().materials[index];
    let radiance = color::<CAN>(world.scene(), &material.emission, &surface);
    let radiance = basis.emission(index, &material.emission, radiance);
    let toward = point - surface.position;
    let normal = surface.geometric_normal;
    let normal = if material.double_sided && toward.dot(normal) < 0.0 { -normal } else { normal };
    from_area(point, surface.position, normal, radiance, 1.0 / mesh.area)
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

fn sample_environment<B: Basis<N>, const N: usize>(
    basis: &B,
    environment: &Environment,
    distribution: &Piecewise2d,
    u: f32,
    v: f32,
) -> Option<LightSample<N>> {
    let Environment::Map { rotation, .. } = environment else { return None };
    let (x, y, density) = distribution.sample(u, v)?;
    let direction = rotation.transpose() * uv_to_direction(Vec2::new(x, y));
    let density = density / (2.0 * PI * PI * sin_polar(y));
    Some(LightSample {
        direction,
        distance: f32::INFINITY,
        value: basis.environment(environment, direction) / density,
        density: Some(density),
    })
}
