//! On a thick flat body in uniform light the area integral reflects what planar transport theory says.

mod common;

use alabaster::medium::{AlbedoInversion, Entry, PlaneParallel};
use alabaster::optics::Boundary;
use alabaster::radiometry::Rgb;
use alabaster::scene::{ColorInput, Material, ScatteringInput, Scene, Surface, shape};
use alabaster::transport::Counters;
use common::scenes::{Statistics, furnace, renderer};
use glam::Vec3;

/// A slab many free paths wide and thick, seen from `height` above its middle.
fn slab_scene(medium: ScatteringInput, ior: f32, roughness: f32) -> Scene {
    let material = Material {
        surface: Surface::Translucent { ior, roughness, medium },
        emission: ColorInput::constant(Rgb::ZERO),
        ..Material::default()
    };
    let mut scene = furnace(shape::cuboid(Vec3::new(0.0, -5.0, 0.0), Vec3::new(40.0, 10.0, 40.0)), material);
    scene.camera.position = Vec3::new(0.0, 4.0, 1.0);
    scene.camera.vertical_fov = 0.02;
    scene
}

fn reflected(scene: Scene) -> [Statistics; 3] {
    let renderer = renderer(scene);
    let mut counters = Counters::default();
    let mut statistics: [Statistics; 3] = Default::default();
    for pixel in 0..24 * 24 {
        for sample in 0..256 {
            let radiance = renderer.sample(pixel % 24, pixel / 24, sample, &mut counters);
            for (statistic, value) in statistics.iter_mut().zip(radiance.0) {
                statistic.add(f64::from(value));
            }
        }
    }
    statistics
}

/// Cosine of the view of [`slab_scene`].
fn view_cosine() -> f32 {
    4.0 / 17.0_f32.sqrt()
}

/// Share of uniform light that an observer sees come back from `slab_scene` if the body returns `albedo`.
fn seen(boundary: &Boundary, albedo: f64) -> f64 {
    let specular = f64::from(boundary.reflectance(view_cosine()));
    specular + (1.0 - specular) * albedo
}

#[test]
fn coefficients_give_the_albedo_of_transport_theory() {
    let sigma_t = 25.0;
    let absorbed = Rgb::new(0.001, 0.05, 0.3);
    for (ior, roughness, g) in [
        (1.0, 0.0, 0.0),
        (1.33, 0.0, 0.0),
        (1.5, 0.0, 0.0),
        (1.5, 0.4, 0.0),
        (0.75, 0.0, 0.0),
        (1.0, 0.0, 0.8),
        (1.4, 0.0, 0.8),
    ] {
        // As many reduced free paths wide and thick, whatever g.
        let sigma_t = sigma_t / (1.0 - g);
        let medium = ScatteringInput::Coefficients {
            sigma_a: absorbed * sigma_t,
            sigma_s: (Rgb::ONE - absorbed) * sigma_t,
            g,
        };
        let statistics = reflected(slab_scene(medium, ior, roughness));
        let boundary = Boundary::new(ior, roughness * roughness);
        let transport = PlaneParallel::new(f64::from(ior), f64::from(g));
        for (c, statistic) in statistics.iter().enumerate() {
            let albedo = transport.half_space(f64::from(absorbed[c])).albedo(Entry::Diffuse);
            let exact = seen(&boundary, albedo);
            let (mean, sigma) = (statistic.mean(), statistic.standard_error());
            println!(
                "ior {ior} roughness {roughness} g {g} channel {c}: {mean:.5} ± {sigma:.5}, exact {exact:.5}"
            );
            assert!((mean - exact).abs() < 3.0 * sigma + 3e-4, "{mean} ± {sigma} against {exact}");
            assert!((mean / exact - 1.0).abs() < 0.005);
        }
    }
}

#[test]
fn the_albedo_asked_for_is_the_albedo_rendered() {
    let albedo = Rgb::new(0.9, 0.5, 0.1);
    let mean_free_path = Rgb::new(0.03, 0.02, 0.01);
    for g in [0.0, 0.8] {
        let asked = ScatteringInput::Albedo { albedo: ColorInput::constant(albedo), mean_free_path, g };
        // The coefficients by which exact transport gives the same albedo.
        let inversion = AlbedoInversion::new(1.4, f64::from(g), Entry::Diffuse);
        let medium = inversion.medium(albedo, mean_free_path);
        let inverted = ScatteringInput::Coefficients { sigma_a: medium.sigma_a, sigma_s: medium.sigma_s, g };
        for input in [asked, inverted] {
            for (c, statistic) in reflected(slab_scene(input.clone(), 1.4, 0.0)).iter().enumerate() {
                let exact = seen(&Boundary::new(1.4, 0.0), f64::from(albedo[c]));
                let mean = statistic.mean();
                println!("g {g} channel {c}: {mean:.5}, exact {exact:.5}");
                assert!((mean / exact - 1.0).abs() < 0.005, "{mean} against {exact}");
            }
        }
    }
}
