//! What ray casters race on where no scene is given.

use glam::{Affine3A, Vec3};

use crate::radiometry::Rgb;
use crate::scene::{
    Camera, ColorInput, Environment, FilmSettings, Filter, Instance, Light, Material, Mesh, Method,
    ScatteringInput, Scene, SubsurfaceSettings, Surface, shape,
};

/// Triangles are divided so often: 1 310 720 of them.
const LEVELS: u32 = 8;

/// A bumpy ball of marble, 8 cm across, of more than a million triangles, under a lamp in a dim room.
pub fn ball() -> Scene {
    let medium = ScatteringInput::Coefficients {
        // Marble (Jensen, Marschner, Levoy, Hanrahan 2001, table 1), 1/m.
        sigma_a: Rgb::new(2.1, 4.1, 7.1),
        sigma_s: Rgb::new(2190.0, 2620.0, 3000.0),
        g: 0.0,
    };
    Scene {
        camera: Camera {
            position: Vec3::new(0.0, 0.05, 0.25),
            vertical_fov: 22.0_f32.to_radians(),
            ..Camera::default()
        },
        film: FilmSettings { width: 512, height: 512, filter: Filter::Box },
        meshes: vec![bumpy(0.04)],
        instances: vec![Instance {
            name: "ball".into(),
            mesh: 0,
            material: 0,
            transform: Affine3A::IDENTITY,
        }],
        materials: vec![Material {
            name: "marble".into(),
            surface: Surface::Translucent { ior: 1.5, roughness: 0.3, medium },
            emission: ColorInput::constant(Rgb::ZERO),
            ..Material::default()
        }],
        environment: Some(Environment::Constant(Rgb::splat(0.3))),
        lights: vec![Light::Sphere {
            center: Vec3::new(0.3, 0.3, 0.2),
            radius: 0.05,
            radiance: Rgb::splat(20.0).into(),
        }],
        // Most of a render's rays are then probes.
        subsurface: SubsurfaceSettings { method: Method::Bssrdf, ..SubsurfaceSettings::default() },
        ..Scene::default()
    }
}

/// A sphere with large and small bumps.
fn bumpy(radius: f32) -> Mesh {
    let mut mesh = shape::sphere(Vec3::ZERO, 1.0, LEVELS);
    let height = |frequency: f32, p: Vec3| {
        (7.0 * frequency * p.x).sin() * (9.0 * frequency * p.y).sin() * (8.0 * frequency * p.z).sin()
    };
    for position in &mut mesh.positions {
        let direction = position.normalize_or(Vec3::Y);
        *position = direction * radius * (1.0 + 0.1 * height(1.0, direction) + 0.02 * height(5.0, direction));
    }
    mesh.normals.clear();
    mesh
}
