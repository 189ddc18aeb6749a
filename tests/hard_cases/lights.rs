//! Lights and cameras where they should not be: without area, in the plane they light, in the medium, on its surface, very far away.

use std::f64::consts::PI;

use alabaster::radiometry::Rgb;
use alabaster::scene::{Camera, ColorInput, Environment, Light, Material, Method, Scene, Surface, shape};
use glam::{Mat3, Vec3};

use crate::common::backends::{Pictures, by, renderings};
use crate::common::scenes::{furnace, white};
use crate::media::translucent;
use crate::record::{Figures, assert_fails, record};

/// `scene` under a sky that is bright on one side and dim on the other.
pub fn under_uneven_sky(scene: Scene) -> Scene {
    let (width, height) = (16, 8);
    let bright = |i: usize| if i % width < 5 && i / width < 4 { 4.0 } else { 0.3 };
    let radiance = (0..width * height).map(|i| Rgb::new(1.0, 0.8, 0.6) * bright(i)).collect();
    let rotation = Mat3::from_rotation_y(0.7);
    Scene { environment: Some(Environment::Map { width, height, radiance, rotation }), ..scene }
}

/// A white floor seen closely from the side, lit by `lights` alone.
fn floor(lights: Vec<Light>) -> Scene {
    let material = Material {
        surface: Surface::Diffuse { reflectance: ColorInput::constant(Rgb::ONE) },
        emission: ColorInput::constant(Rgb::ZERO),
        ..Material::default()
    };
    let scene = furnace(shape::quad(Vec3::ZERO, Vec3::Z * 50.0, Vec3::X * 50.0), material);
    let camera =
        Camera { position: Vec3::new(6.0, 3.0, 1.5), target: Vec3::ZERO, vertical_fov: 1e-3, ..scene.camera };
    Scene { camera, environment: None, lights, ..scene }
}

/// Lights of no size, or seen from their own plane, light nothing and are no trouble.
#[test]
fn lights_without_area() {
    let radiance = Rgb::splat(5.0).into();
    let lights = [
        Light::Quad { center: Vec3::Y, half_u: Vec3::ZERO, half_v: Vec3::Z, radiance },
        Light::Quad { center: Vec3::Y, half_u: Vec3::X * 1e-30, half_v: Vec3::Z * 1e-30, radiance },
        Light::Disk { center: Vec3::Y, normal: Vec3::NEG_Y, radius: 0.0, radiance },
        Light::Sphere { center: Vec3::Y, radius: 0.0, radiance },
        Light::Sphere { center: Vec3::Y, radius: 1e-30, radiance },
    ];
    let translucent = furnace(shape::sphere(Vec3::ZERO, 0.9, 4), white(1.4, 0.3, Rgb::splat(5.0)));
    for light in lights {
        let body = Scene { environment: None, lights: vec![light.clone()], ..translucent.clone() };
        for (scene, method) in
            [(floor(vec![light]), Method::Bssrdf), (body.clone(), Method::Bssrdf), (body, Method::Walk)]
        {
            for (setup, found) in renderings(&scene, by(method), &Pictures(4)) {
                assert_eq!((found.mean.max, found.counters.rejected), (0.0, 0), "{method:?} {setup}");
            }
        }
    }
    // A density of 1/area.
    assert_fails("radiance over 1/area", 0.0 * (1.0_f32 / 0.0), f32::is_finite);
    record("lights_without_area", "black, nothing rejected".into());
}

#[test]
fn light_in_the_plane_it_lights() {
    let quad = |center: Vec3| Light::Quad {
        center,
        half_u: Vec3::Z,
        half_v: Vec3::X,
        radiance: Rgb::splat(5.0).into(),
    };
    let mut figure = Figures::default();
    // Beside what is seen, in the plane; and standing on it.
    let wall = Light::Quad {
        center: Vec3::new(-2.0, 1.0, 0.0),
        half_u: Vec3::Y,
        half_v: Vec3::Z,
        radiance: Rgb::splat(5.0).into(),
    };
    for (name, light, lit) in [("in the plane", quad(Vec3::X * -3.0), false), ("standing on it", wall, true)]
    {
        for (setup, found) in renderings(&floor(vec![light]), by(Method::Bssrdf), &Pictures(16)) {
            assert_eq!(found.counters.rejected, 0);
            assert_eq!(found.mean.max > 0.0, lit, "{name} {setup}: {}", found.mean.max);
            figure.keep(
                setup,
                format!(
                    "brightest sample: in the plane 0, from a wall that stands on it {:.2}",
                    found.mean.max
                ),
            );
        }
    }
    record("light_in_the_plane_it_lights", figure.written());
}

/// A ball so far away that its cone has a half angle of 10⁻⁵.
#[test]
fn lights_far_away() {
    let mut figure = Figures::default();
    for exponent in [0, 3, 5, 7] {
        let distance = 10.0_f64.powi(exponent);
        let (radius, ratio) = (1e-4 * distance, 1e-4_f64);
        let radiance = 1.0 / (PI * ratio * ratio);
        let light = Light::Sphere {
            center: Vec3::Y * distance as f32,
            radius: radius as f32,
            radiance: Rgb::splat(radiance as f32).into(),
        };
        for (setup, found) in renderings(&floor(vec![light]), by(Method::Bssrdf), &Pictures(64)) {
            let irradiance = found.mean.mean() * PI;
            let sigma = found.mean.standard_error() * PI;
            // The view takes in a few thousandths of a metre, the nearest light is at 1 m; coordinates are rounded.
            let holds = |irradiance: f64| (irradiance - 1.0).abs() < 3.0 * sigma + 1e-3;
            assert!(holds(irradiance), "{distance} {setup}: {irradiance} ± {sigma}");
            let cosine = (1.0 - (ratio as f32).powi(2)).sqrt();
            assert_fails("2π(1 − cosθ)", f64::from(1.0 - cosine) * 2.0 * PI * radiance, holds);
            figure.keep(setup, format!("irradiance at 10⁷ m: {irradiance:.5} ± {sigma:.5} of 1"));
        }
    }
    record("lights_far_away", figure.written());
}

/// Inside a body that absorbs nothing radiance is n² times that around it, everywhere and in all directions.
#[test]
fn camera_in_the_medium() {
    let mut figure = Figures::default();
    for ior in [1.0_f32, 1.5, 1.0 / 1.33] {
        for position in [Vec3::ZERO, Vec3::new(0.3, -0.5, 0.2)] {
            let scene = furnace(shape::sphere(Vec3::ZERO, 1.0, 4), white(ior, 0.0, Rgb::new(3.0, 2.0, 5.0)));
            let camera = Camera { position, target: Vec3::X, ..scene.camera };
            let scene = Scene { camera, ..scene };
            for (setup, found) in renderings(&scene, by(Method::Walk), &Pictures(8)) {
                let squared = f64::from(ior * ior);
                let (mean, sigma) = (found.mean.mean() / squared, found.mean.standard_error() / squared);
                assert!((mean - 1.0).abs() < 3.0 * sigma + 1e-4, "η {ior} {setup}: {mean} ± {sigma}");
                assert_eq!((found.counters.capped_paths, found.counters.rejected), (0, 0));
                figure.keep(setup, format!("L/n² = {mean:.5} ± {sigma:.5}"));
            }
        }
    }
    record("camera_in_the_medium", figure.written());
}

/// On a vertex, an edge and a face of the mesh, looking along the surface and into it.
#[test]
fn camera_on_the_surface() {
    let mesh = shape::cuboid(Vec3::ZERO, Vec3::splat(2.0));
    let mut figure = Figures::default();
    for position in [Vec3::ONE, Vec3::new(1.0, 1.0, 0.2), Vec3::new(0.2, 0.3, 1.0)] {
        for target in [Vec3::ZERO, Vec3::new(-3.0, 0.3, 1.0), Vec3::splat(3.0)] {
            for (method, inside) in [(Method::Walk, 0.0), (Method::Bssrdf, 0.5)] {
                // Seen from inside, where no light gets but by walks, a body that absorbs nothing would keep paths for ever.
                let material = translucent(1.0, Rgb::splat(inside), Rgb::new(3.0, 2.0, 5.0), 0.0);
                let scene = furnace(mesh.clone(), material);
                let camera = Camera { position, target, ..scene.camera };
                let scene = Scene { camera, ..scene };
                for (setup, found) in renderings(&scene, by(method), &Pictures(4)) {
                    let (mean, sigma) = (found.mean.mean(), found.mean.standard_error());
                    let what = format!("{position} {target} {method:?} {setup}: {mean} ± {sigma}");
                    assert!(mean < 1.0 + 3.0 * sigma + 1e-4, "{what}");
                    assert_eq!((found.counters.capped_paths, found.counters.rejected), (0, 0), "{what}");
                    if method == Method::Bssrdf {
                        continue;
                    }
                    assert!(mean > 1.0 - 3.0 * sigma - 1e-4, "{what}");
                    figure.keep(setup, format!("L = {mean:.5} ± {sigma:.5}"));
                }
            }
        }
    }
    record("camera_on_the_surface", figure.written());
}
