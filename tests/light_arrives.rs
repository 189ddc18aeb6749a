//! Light from every kind of emitter arrives with the irradiance that radiometry asks for, and drawing
//! it directly or finding it by scattering gives one result.

mod common;

use std::f64::consts::PI;

use alabaster::radiometry::Rgb;
use alabaster::scene::{
    ColorInput, Environment, Instance, Light, Material, Mesh, ScalarInput, Scene, Surface, shape,
};
use alabaster::transport::Counters;
use common::scenes::{Statistics, furnace, renderer};
use glam::{Affine3A, Mat3, Vec3};

/// A white floor in the plane y = 0, seen from above in a narrow view around the origin, lit by
/// `lights` alone.
fn floor(surface: Surface, lights: Vec<Light>) -> Scene {
    let material = Material { surface, emission: ColorInput::constant(Rgb::ZERO), ..Material::default() };
    let mut scene = furnace(shape::quad(Vec3::ZERO, Vec3::Z * 50.0, Vec3::X * 50.0), material);
    // From the side, past the lights above.
    scene.camera.position = Vec3::new(6.0, 3.0, 1.5);
    scene.camera.vertical_fov = 1e-3;
    scene.environment = None;
    scene.lights = lights;
    scene
}

fn white() -> Surface {
    Surface::Diffuse { reflectance: ColorInput::constant(Rgb::ONE) }
}

/// Radiance of the middle of the floor, from independent samples.
fn radiance(scene: Scene, samples: u64) -> Statistics {
    let renderer = renderer(scene);
    let mut counters = Counters::default();
    let mut statistics = Statistics::default();
    for sample in 0..samples {
        let pixel = (sample % 576) as u32;
        let value = renderer.sample(pixel % 24, pixel / 24, sample / 576, &mut counters);
        statistics.add(f64::from(value[1]));
    }
    statistics
}

fn assert_irradiance(name: &str, scene: Scene, expected: f64) {
    let statistics = radiance(scene, 60_000);
    let irradiance = statistics.mean() * PI;
    let sigma = statistics.standard_error() * PI;
    println!("{name}: {irradiance:.6} ± {sigma:.6}, expected {expected:.6}");
    // Across the view of a thousandth of a radian irradiance varies by less than 1e-3 of itself, and
    // to both sides of the middle.
    assert!(
        (irradiance - expected).abs() <= 3.0 * sigma + 2e-4 * expected,
        "{name}: {irradiance} {expected}"
    );
}

#[test]
fn each_light_gives_the_irradiance_of_its_geometry() {
    let radiance = Rgb::splat(3.0).into();
    let height = 2.0;
    let above = Vec3::Y * height;
    let point = Light::Point { position: above, intensity: Rgb::splat(7.0).into() };
    assert_irradiance("point", floor(white(), vec![point]), 7.0 / 4.0);
    let slanted = Light::Point { position: Vec3::new(2.0, 2.0, 0.0), intensity: Rgb::splat(7.0).into() };
    // I cosθ / d²
    assert_irradiance("slanted point", floor(white(), vec![slanted]), 7.0 / 8.0 / 2.0_f64.sqrt());
    let sun = Light::Directional {
        direction: Vec3::new(1.0, -1.0, 0.0).normalize(),
        irradiance: Rgb::splat(2.0).into(),
    };
    assert_irradiance("directional", floor(white(), vec![sun]), 2.0 / 2.0_f64.sqrt());
    let spot = |inner, outer| Light::Spot {
        position: above,
        direction: Vec3::NEG_Y,
        intensity: Rgb::splat(7.0).into(),
        inner_angle: inner,
        outer_angle: outer,
    };
    assert_irradiance("spot", floor(white(), vec![spot(0.1, 0.2)]), 7.0 / 4.0);
    // A sphere of radius r at distance d above: E = π L (r/d)². Its mesh is inside of it by less than 1e-4.
    let sphere = Light::Sphere { center: above, radius: 1.2, radiance };
    assert_irradiance("sphere", floor(white(), vec![sphere]), PI * 3.0 * (1.2_f64 / 2.0).powi(2));
    // A disk facing the point: E = π L r²/(r² + h²).
    let disk = Light::Disk { center: above, normal: Vec3::NEG_Y, radius: 1.5, radiance };
    assert_irradiance("disk", floor(white(), vec![disk]), PI * 3.0 * 2.25 / (2.25 + 4.0));
    // A square of half side a: four corners of E = L/2 · 2 a/√(a²+h²) atan(a/√(a²+h²)) each.
    let a = 1.0;
    let quad = Light::Quad { center: above, half_u: Vec3::X, half_v: Vec3::Z, radiance };
    let x = a / (a * a + 4.0_f64).sqrt();
    assert_irradiance("quad", floor(white(), vec![quad.clone()]), 4.0 * 3.0 * x * x.atan());
    let away = Light::Quad { center: above, half_u: Vec3::Z, half_v: Vec3::X, radiance };
    assert_irradiance("quad from behind", floor(white(), vec![away]), 0.0);
    // Several lights add up, whichever is chosen how often.
    let all =
        vec![quad, Light::Point { position: Vec3::new(2.0, 2.0, 0.0), intensity: Rgb::splat(7.0).into() }];
    let expected = 4.0 * 3.0 * x * x.atan() + 7.0 / 8.0 / 2.0_f64.sqrt();
    assert_irradiance("two lights", floor(white(), all), expected);
}

#[test]
fn an_emissive_mesh_is_a_light() {
    let mut scene = floor(white(), Vec::new());
    scene.materials.push(Material {
        surface: Surface::Diffuse { reflectance: ColorInput::constant(Rgb::ZERO) },
        emission: ColorInput::constant(Rgb::splat(3.0)),
        ..Material::default()
    });
    scene.meshes.push(shape::sphere(Vec3::ZERO, 1.0, 5));
    scene.instances.push(Instance {
        name: "lamp".into(),
        mesh: 1,
        material: 1,
        transform: Affine3A::from_scale_rotation_translation(
            Vec3::new(-1.2, 1.2, 1.2),
            glam::Quat::IDENTITY,
            Vec3::Y * 2.0,
        ),
    });
    // The icosphere of level 5 is 4e-4 smaller in cross-section than the sphere.
    let statistics = radiance(scene, 120_000);
    let expected = 3.0 * (1.2_f64 / 2.0).powi(2);
    let sigma = statistics.standard_error();
    assert!((statistics.mean() - expected).abs() < 3.0 * sigma + 1e-3 * expected, "{}", statistics.mean());
}

/// An environment map of one bright and many dim pixels, drawn by luminance and found by scattering.
#[test]
fn environment_maps_give_the_irradiance_of_their_pixels() {
    let (width, height) = (16, 8);
    let mut radiance = vec![Rgb::splat(0.2); width * height];
    radiance[width + 3] = Rgb::splat(40.0);
    let rotation = Mat3::from_rotation_y(0.7);
    let environment = Environment::Map { width, height, radiance, rotation };
    let mut expected = 0.0;
    // Midpoint rule over the upper hemisphere by equal steps of cos² and azimuth.
    let side = 632;
    for i in 0..side {
        for j in 0..side {
            let cos2 = (i as f32 + 0.5) / side as f32;
            let phi = std::f32::consts::TAU * (j as f32 + 0.5) / side as f32;
            let sin = (1.0 - cos2).sqrt();
            let direction = Vec3::new(sin * phi.cos(), cos2.sqrt(), sin * phi.sin());
            expected += PI * f64::from(environment.radiance(direction)[1]) / f64::from(side * side);
        }
    }
    let mut scene = floor(white(), Vec::new());
    scene.environment = Some(environment);
    assert_irradiance("environment", scene, expected);
}

/// A rough metal sees a light by its lobe and by the light's own density: whatever the share, multiple
/// importance sampling keeps the mean, here known because a light that fills half the sky is uniform.
#[test]
fn direct_and_scattered_light_do_not_count_twice() {
    for roughness in [0.2, 0.5, 1.0] {
        let metal = Surface::Metal {
            reflectance: ColorInput::constant(Rgb::ONE),
            roughness: ScalarInput::constant(roughness),
        };
        // Inside a large lamp all surroundings have one radiance, as with a constant environment.
        let lamp = |flip: bool| {
            let mut mesh = shape::sphere(Vec3::ZERO, 100.0, 4);
            if flip {
                mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
                mesh.normals.iter_mut().for_each(|n| *n = -*n);
            }
            mesh
        };
        let mut lit = floor(metal.clone(), Vec::new());
        lit.materials.push(Material {
            surface: Surface::Diffuse { reflectance: ColorInput::constant(Rgb::ZERO) },
            emission: ColorInput::constant(Rgb::ONE),
            ..Material::default()
        });
        lit.meshes.push(lamp(true));
        lit.instances.push(Instance {
            name: "lamp".into(),
            mesh: 1,
            material: 1,
            transform: Affine3A::IDENTITY,
        });
        let mut open = floor(metal, Vec::new());
        open.environment = Some(Environment::Constant(Rgb::ONE));
        let (lit, open) = (radiance(lit, 100_000), radiance(open, 100_000));
        let sigma = lit.standard_error().hypot(open.standard_error());
        println!("roughness {roughness}: {:.5} against {:.5} ± {sigma:.5}", lit.mean(), open.mean());
        assert!((lit.mean() - open.mean()).abs() < 3.0 * sigma + 1e-4);
    }
}

/// A closed clear body in uniform light is invisible: what it reflects it also keeps out.
#[test]
fn clear_bodies_vanish_in_uniform_light() {
    for (ior, roughness) in [(1.5, 0.0), (1.33, 0.0), (0.8, 0.0), (1.0, 0.0)] {
        let mut mesh: Mesh = shape::sphere(Vec3::ZERO, 1.0, 5);
        mesh.normals.clear();
        let material = Material {
            surface: Surface::Dielectric {
                ior,
                dispersion: None,
                roughness: ScalarInput::constant(roughness),
                sigma_a: Rgb::ZERO,
                tint: ColorInput::constant(Rgb::ONE),
            },
            emission: ColorInput::constant(Rgb::ZERO),
            ..Material::default()
        };
        let renderer = renderer(furnace(mesh, material));
        let mut counters = Counters::default();
        for pixel in 0..576 {
            for sample in 0..16 {
                let value = renderer.sample(pixel % 24, pixel / 24, sample, &mut counters)[1];
                // Without absorption and roulette the path's weight is a product of (n₁/n₂)² and its inverse.
                assert!((value - 1.0).abs() < 1e-4, "ior {ior}: {value} {counters:?}");
            }
        }
        assert_eq!(counters.capped_paths, 0);
    }
}
