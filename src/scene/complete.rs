//! What a scene file may leave out, filled in; and what it says that is hardly meant.

use std::path::Path;

use glam::Vec3;

use super::shape::horizontal_frame;
use super::{Camera, ColorMode, Environment, Light, ScatteringInput, Scene, SceneError, Surface};
use crate::radiometry::Rgb;

/// Sets the camera, or frames the objects; adds soft light unless the scene `has_lights`; warns of
/// units that look wrong. An error if there is nothing to see.
pub fn complete(
    scene: &mut Scene,
    camera: Option<Camera>,
    has_lights: bool,
    file: &Path,
) -> Result<(), SceneError> {
    let bounds = scene_bounds(scene).ok_or_else(|| SceneError::file(file, "the scene has no triangles"))?;
    if !bounds.diagonal().is_finite() {
        return Err(SceneError::file(file, "the objects reach beyond the range of single precision"));
    }
    scene.camera = camera.unwrap_or_else(|| {
        scene.warnings.push("no camera: looking at all objects from the front, right and above".into());
        framing_camera(&bounds, scene.film.width as f32 / scene.film.height as f32)
    });
    if !has_lights {
        scene.warnings.push("no lights: lit by a soft default rig".into());
        add_default_lights(scene, &bounds);
    }
    let instances = 0..scene.instances.len();
    let hints: Vec<String> =
        instances.flat_map(|i| [unit_hint(scene, i), dispersion_hint(scene, i)]).flatten().collect();
    for hint in hints {
        if !scene.warnings.contains(&hint) {
            scene.warnings.push(hint);
        }
    }
    Ok(())
}

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Bounds {
    low: Vec3,
    high: Vec3,
}

impl Bounds {
    fn center(&self) -> Vec3 {
        0.5 * self.low + 0.5 * self.high
    }

    fn diagonal(&self) -> f32 {
        self.low.distance(self.high)
    }

    fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }
}

fn scene_bounds(scene: &Scene) -> Option<Bounds> {
    (0..scene.instances.len()).filter_map(|i| instance_bounds(scene, i)).reduce(Bounds::union)
}

/// Bounds of the triangles of an instance in the world; `None` if it has none.
fn instance_bounds(scene: &Scene, instance: usize) -> Option<Bounds> {
    let instance = &scene.instances[instance];
    let mesh = &scene.meshes[instance.mesh];
    let used = mesh.triangles.iter().flatten().map(|&i| mesh.positions[i as usize]);
    let points = used.map(|p| instance.transform.transform_point3(p));
    points.map(|p| Bounds { low: p, high: p }).reduce(Bounds::union)
}

/// A camera with the default field of view that sees the whole box from the front, right and above,
/// in a picture `aspect` times as wide as high, with a margin of a tenth.
fn framing_camera(bounds: &Bounds, aspect: f32) -> Camera {
    let default = Camera::default();
    let center = bounds.center();
    let back = Vec3::new(0.6, 0.4, 1.0).normalize();
    let (right, up) = horizontal_frame(back);
    let tangent = (0.5 * default.vertical_fov).tan();
    let distance_for = |corner: usize| {
        let pick = |axis: usize| if corner >> axis & 1 == 0 { bounds.low[axis] } else { bounds.high[axis] };
        let offset = Vec3::new(pick(0), pick(1), pick(2)) - center;
        let sideways = (offset.dot(up).abs()).max(offset.dot(right).abs() / aspect);
        offset.dot(back) + 1.1 * sideways / tangent
    };
    let distance = (0..8).map(distance_for).fold(f32::MIN_POSITIVE, f32::max);
    Camera { position: center + back * distance, target: center, ..default }
}

/// An environment of radiance 0.3 and a key light from above left of the camera. A white diffuse
/// surface that faces the key light comes to a radiance of about 1: the light is as wide as the box
/// (2r) at four times its half diagonal r, so its irradiance is 10·(2r)²/(4r)² = 2.5, and
/// 0.3 + 2.5/π = 1.1.
fn add_default_lights(scene: &mut Scene, bounds: &Bounds) {
    let rays = scene.camera.rays(1.0);
    let half_diagonal = (0.5 * bounds.diagonal()).max(f32::MIN_POSITIVE);
    let toward = (0.8 * rays.up() - 0.7 * rays.right() - 0.6 * rays.forward()).normalize();
    let (u, v) = horizontal_frame(-toward);
    scene.environment = Some(Environment::Constant(Rgb::splat(0.3)));
    scene.lights.push(Light::Quad {
        center: bounds.center() + toward * (4.0 * half_diagonal),
        half_u: u * half_diagonal,
        half_v: v * half_diagonal,
        radiance: Rgb::splat(10.0).into(),
    });
}

/// A warning if the mean free path in a translucent body is so far from its size, in all channels,
/// that coefficients per millimetre or a model in centimetres are likely.
fn unit_hint(scene: &Scene, instance: usize) -> Option<String> {
    let material = &scene.materials[scene.instances[instance].material];
    let Surface::Translucent { medium, .. } = &material.surface else { return None };
    let path = match medium {
        ScatteringInput::Albedo { mean_free_path, .. } => *mean_free_path,
        _ => medium.sigma_t().map(f32::recip),
    };
    let size = instance_bounds(scene, instance)?.diagonal();
    let (shortest, longest) = (path.min_component(), path.max_component());
    let wrong = if shortest > 10.0 * size {
        shortest
    } else if longest < 1e-5 * size {
        longest
    } else {
        return None;
    };
    (wrong.is_finite() && size > 0.0).then(|| {
        format!(
            "material `{}`: mean free path {} mm in a body of {} mm: are the coefficients in 1/m?",
            material.name,
            rounded(1000.0 * wrong),
            rounded(1000.0 * size)
        )
    })
}

/// A warning if the material has a dispersion and is to be rendered without.
fn dispersion_hint(scene: &Scene, instance: usize) -> Option<String> {
    let material = &scene.materials[scene.instances[instance].material];
    let is_rgb = scene.render.color_mode == ColorMode::Rgb;
    material.surface.dispersion().filter(|_| is_rgb).map(|_| {
        format!(
            "material `{}`: rendered without dispersion, since `mode = \"rgb\"`: all wavelengths refract alike",
            material.name
        )
    })
}

/// Three significant digits, for people.
fn rounded(x: f32) -> f32 {
    let text = format!("{x:.2e}");
    text.parse().unwrap_or(x)
}
