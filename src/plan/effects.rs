//! Which effects of light a scene calls for, and why.
//!
//! Only what is placed in the scene counts, and only what it comes to: a coefficient of 0, an index of 1, a black light or a colour
//! without texture call for nothing.

use glam::Vec3;

use super::PlannedObject;
use super::effect_kind::EffectKind;
use super::force::Forces;
use super::spectral::{not_spectral, spectral};
use crate::optics::is_smooth;
use crate::scene::material::Coverage;
use crate::scene::{Environment, Instance, Light, Material, Method, ScatteringInput, Scene, Surface};

/// An effect and whether the scene calls for it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Effect {
    /// Which one.
    pub kind: EffectKind,
    /// True if the scene calls for it, or the user.
    pub on: bool,
    /// What calls for it, or that nothing does.
    pub reason: String,
}

/// What a material has that calls for an effect, in words.
type Cause = fn(&Material) -> Option<String>;

/// What an effect is called for by, and what is said if nothing does.
enum Caller {
    Material(Cause, &'static str),
    /// Objects that get a method.
    Method(Method, &'static str),
    Scene(fn(&Scene) -> Option<String>, &'static str),
}

/// What calls for an effect in `scene`.
fn caller(kind: EffectKind, scene: &Scene) -> Caller {
    use Caller::{Material, Method as OfMethod, Scene};
    match kind {
        EffectKind::SubsurfaceScattering => Material(scattering, "no material scatters inside"),
        EffectKind::AreaIntegral => OfMethod(Method::Bssrdf, "no object is rendered by bssrdf"),
        EffectKind::RandomWalk => OfMethod(Method::Walk, "no object is rendered by walk"),
        EffectKind::Refraction => Material(refraction, "no material has an index of refraction other than 1"),
        EffectKind::RoughSurfaces => Material(roughness, "every surface is perfectly smooth or diffuse"),
        EffectKind::Absorption => Material(absorption, "no clear body absorbs"),
        EffectKind::AnisotropicScattering => {
            Material(anisotropy, "every medium scatters alike in all directions")
        }
        EffectKind::ColoursOfMeanFreePaths => {
            Material(unequal_channels, "all channels have the same mean free path")
        }
        EffectKind::TexturedCoefficients => Material(textured_coefficients, "no medium has a texture"),
        EffectKind::Textures => Material(textures, "no material has a texture"),
        EffectKind::NormalMaps => Material(normal_map, "no material has a normal map"),
        EffectKind::PartialCoverage => Material(coverage, "every surface is there everywhere"),
        EffectKind::Spectral => Scene(spectral, not_spectral(scene)),
        EffectKind::Dispersion => Material(dispersion, "no clear body has a dispersion"),
        EffectKind::NestedMedia => {
            Scene(nested_media, "no two bodies that light enters are close to each other")
        }
        EffectKind::AreaLights => Scene(area_lights, "nothing that has a size shines"),
        EffectKind::LightsWithoutSize => Scene(delta_lights, "every light has a size"),
        EffectKind::Environment => Scene(environment, "no light comes from far around"),
        EffectKind::Lens => Scene(lens, "the camera is a pinhole"),
        EffectKind::IndirectLight => Scene(indirect_light, "paths end after one bounce"),
    }
}

/// All effects there are, each on or off in `scene`, folded, whose translucent bodies are rendered as `objects` says.
pub fn effects(scene: &Scene, objects: &[PlannedObject], forces: &Forces) -> Vec<Effect> {
    let is_spectral = !forces.is_off(EffectKind::Spectral)
        && (forces.is_on(EffectKind::Spectral) || spectral(scene).is_some());
    let effect = |kind| {
        let (cause, without) = match caller(kind, scene) {
            Caller::Material(cause, without) => (users(scene, cause), without),
            Caller::Method(method, without) => (rendered_by(objects, method), without),
            Caller::Scene(cause, without) => (cause(scene), without),
        };
        let reason = cause.as_ref().map_or(without.to_string(), String::clone);
        match cause.is_some() {
            _ if forces.is_off(kind) => Effect { kind, on: false, reason: "switched off".into() },
            false if forces.is_on(kind) => {
                Effect { kind, on: true, reason: format!("switched on; {reason}") }
            }
            true if kind == EffectKind::Dispersion && !is_spectral => {
                Effect { kind, on: false, reason: format!("{reason}, but red, green and blue refract alike") }
            }
            on => Effect { kind, on, reason },
        }
    };
    EffectKind::ALL.map(effect).into()
}

/// The placed materials that have `cause`.
pub(super) fn users(scene: &Scene, cause: Cause) -> Option<String> {
    first_of(scene.instances.iter().filter_map(|placed| {
        let is_there = !scene.meshes[placed.mesh].triangles.is_empty();
        let material = &scene.materials[placed.material];
        let cause = is_there.then(|| cause(material)).flatten()?;
        Some(format!("{} of {} {cause}", quoted("material", &material.name), quoted("object", &placed.name)))
    }))
}

fn rendered_by(objects: &[PlannedObject], method: Method) -> Option<String> {
    let users = objects.iter().filter(|object| object.method == method);
    first_of(users.map(|object| {
        let profile = match method {
            Method::Bssrdf => format!(" with the profile {}", object.profile.name()),
            _ => String::new(),
        };
        format!("{}{profile}: {}", quoted("object", &object.object), object.reason)
    }))
}

/// The first, and how many more there are.
pub(super) fn first_of(mut users: impl Iterator<Item = String>) -> Option<String> {
    let first = users.next()?;
    Some(match users.count() {
        0 => first,
        more => format!("{first}, and {more} more"),
    })
}

fn quoted(kind: &str, name: &str) -> String {
    if name.is_empty() { format!("{kind} without name") } else { format!("{kind} `{name}`") }
}

fn medium(material: &Material) -> Option<&ScatteringInput> {
    match &material.surface {
        Surface::Translucent { medium, .. } => Some(medium).filter(|medium| scatters(medium)),
        _ => None,
    }
}

fn scatters(medium: &ScatteringInput) -> bool {
    match medium {
        ScatteringInput::Coefficients { sigma_s, .. } | ScatteringInput::Spectral { sigma_s, .. } => {
            !sigma_s.is_black()
        }
        ScatteringInput::Albedo { albedo, .. } => !albedo.factor.is_black(),
    }
}

fn scattering(material: &Material) -> Option<String> {
    medium(material).map(|_| "scatters inside".into())
}

fn refraction(material: &Material) -> Option<String> {
    let ior = match &material.surface {
        Surface::Dielectric { ior, .. } | Surface::Translucent { ior, .. } => *ior,
        Surface::MetallicRoughness(m) if m.transmission.factor > 0.0 && !m.thin => m.ior,
        _ => return None,
    };
    (ior != 1.0).then(|| format!("has ior {ior}"))
}

fn roughness(material: &Material) -> Option<String> {
    let roughness = material.roughness()?;
    (!is_smooth(roughness)).then(|| format!("has roughness {roughness}"))
}

fn absorption(material: &Material) -> Option<String> {
    let sigma_a =
        match &material.surface {
            Surface::Dielectric { sigma_a, .. } => *sigma_a,
            Surface::MetallicRoughness(m) if m.transmission.factor > 0.0 && !m.thin => m.sigma_a,
            Surface::Translucent {
                medium: ScatteringInput::Coefficients { sigma_a, sigma_s, .. }, ..
            } if sigma_s.is_black() => *sigma_a,
            _ => return None,
        };
    (!sigma_a.is_black()).then(|| "is clear and absorbs".into())
}

fn anisotropy(material: &Material) -> Option<String> {
    let g = medium(material)?.g();
    (g != 0.0).then(|| format!("has g {g}"))
}

fn unequal_channels(material: &Material) -> Option<String> {
    let [r, g, b] = medium(material)?.sigma_t().0;
    (r != g || g != b).then(|| "has a mean free path of its own for each channel".into())
}

fn textured_coefficients(material: &Material) -> Option<String> {
    match medium(material)? {
        ScatteringInput::Albedo { albedo, .. } if albedo.texture.is_some() || albedo.vertex_color => {
            Some("has a textured albedo".into())
        }
        _ => None,
    }
}

fn textures(material: &Material) -> Option<String> {
    match material.textures().len() {
        0 => material.varies().then(|| "is coloured by vertices".into()),
        1 => Some("has a texture".into()),
        count => Some(format!("has {count} textures")),
    }
}

fn normal_map(material: &Material) -> Option<String> {
    material.normal_map.filter(|(_, scale)| *scale != 0.0).map(|_| "has a normal map".into())
}

fn coverage(material: &Material) -> Option<String> {
    match material.coverage {
        Coverage::Full => None,
        Coverage::Mask { .. } => Some("is cut out by its alpha".into()),
        Coverage::Blend { .. } => Some("is blended by its alpha".into()),
    }
}

pub(super) fn dispersion(material: &Material) -> Option<String> {
    let dispersion = material.surface.dispersion()?;
    // To two places, as data sheets have it.
    Some(format!("has Abbe number {}", (100.0 * dispersion.abbe()).round() / 100.0))
}

pub(super) fn by_wavelength(material: &Material) -> Option<String> {
    matches!(medium(material)?, ScatteringInput::Spectral { .. }).then(|| "is given by wavelength".into())
}

/// True if light goes on inside.
fn is_body(material: &Material) -> bool {
    matches!(material.surface, Surface::Translucent { .. }) || material.surface.is_clear_body()
}

/// Bodies whose boxes overlap may be one inside the other.
fn nested_media(scene: &Scene) -> Option<String> {
    let bodies: Vec<_> =
        scene.instances.iter().filter(|placed| is_body(&scene.materials[placed.material])).collect();
    let bounds: Vec<_> = bodies.iter().map(|placed| bounds(scene, placed)).collect();
    let mut pairs = (0..bodies.len()).flat_map(|i| (0..i).map(move |j| (j, i))).filter_map(|(j, i)| {
        let ([a_low, a_high], [b_low, b_high]) = (bounds[j], bounds[i]);
        let overlap = a_low.cmple(b_high).all() && b_low.cmple(a_high).all();
        overlap.then(|| {
            format!(
                "{} reaches into the box of {}",
                quoted("object", &bodies[j].name),
                quoted("object", &bodies[i].name)
            )
        })
    });
    pairs.next()
}

/// Lowest and highest corner of the box around a placed mesh; of nothing, a box that overlaps with none.
fn bounds(scene: &Scene, placed: &Instance) -> [Vec3; 2] {
    let points = scene.meshes[placed.mesh].positions.iter();
    let join = |[low, high]: [Vec3; 2], point: Vec3| [low.min(point), high.max(point)];
    points
        .map(|point| placed.transform.transform_point3(*point))
        .fold([Vec3::INFINITY, Vec3::NEG_INFINITY], join)
}

fn area_lights(scene: &Scene) -> Option<String> {
    let lights =
        scene.lights.iter().filter(|light| light.has_size()).map(|_| "a light has a size".to_string());
    let shining = scene.instances.iter().filter(|placed| {
        !scene.materials[placed.material].emission.factor.is_black()
            && !scene.meshes[placed.mesh].triangles.is_empty()
    });
    let shining = shining.map(|placed| format!("{} shines", quoted("object", &placed.name)));
    first_of(shining.chain(lights))
}

fn delta_lights(scene: &Scene) -> Option<String> {
    let kind = |light: &Light| match light {
        Light::Point { .. } => Some("there is a point light"),
        Light::Spot { .. } => Some("there is a spot"),
        Light::Directional { .. } => Some("there is a directional light"),
        Light::Quad { .. } | Light::Disk { .. } | Light::Sphere { .. } => None,
    };
    let lights = scene.lights.iter().filter_map(kind).map(String::from);
    first_of(lights)
}

fn environment(scene: &Scene) -> Option<String> {
    let cause = match &scene.environment {
        Some(Environment::Constant(radiance)) if !radiance.is_black() => Some("there is light all around"),
        Some(Environment::Map { .. }) => Some("there is an environment map"),
        _ => None,
    };
    cause.map(String::from)
}

fn lens(scene: &Scene) -> Option<String> {
    let aperture = scene.camera.aperture;
    (aperture > 0.0).then(|| format!("the lens is {} mm wide", 1000.0 * aperture))
}

fn indirect_light(scene: &Scene) -> Option<String> {
    match scene.render.max_depth {
        0 => Some("paths go on until roulette ends them".into()),
        1 => None,
        depth => Some(format!("paths go on for up to {depth} bounces")),
    }
}
