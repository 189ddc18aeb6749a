//! On a thick flat body in uniform light the area integral reflects what planar transport theory says.

mod common;

use alabaster::medium::halfspace::planar_albedo;
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

#[test]
fn coefficients_give_the_albedo_of_transport_theory() {
    let sigma_t = 25.0;
    for (ior, roughness) in [(1.0, 0.0), (1.33, 0.0), (1.5, 0.0), (1.5, 0.4), (0.75, 0.0)] {
        let absorbed = Rgb::new(0.001, 0.05, 0.3);
        let sigma_a = absorbed * sigma_t;
        let sigma_s = (Rgb::ONE - absorbed) * sigma_t;
        let medium = ScatteringInput::Coefficients { sigma_a, sigma_s, g: 0.0 };
        let statistics = reflected(slab_scene(medium, ior, roughness));
        let boundary = Boundary::new(ior, roughness * roughness);
        let specular = f64::from(boundary.reflectance(view_cosine()));
        for (c, statistic) in statistics.iter().enumerate() {
            let albedo = planar_albedo(f64::from(absorbed[c]), f64::from(ior));
            let exact = specular + (1.0 - specular) * albedo;
            let (mean, sigma) = (statistic.mean(), statistic.standard_error());
            println!("ior {ior} roughness {roughness} channel {c}: {mean:.5} ± {sigma:.5}, exact {exact:.5}");
            assert!((mean - exact).abs() < 3.0 * sigma + 3e-4, "{mean} ± {sigma} against {exact}");
            assert!((mean / exact - 1.0).abs() < 0.003);
        }
    }
}

#[test]
fn the_albedo_asked_for_is_the_albedo_rendered() {
    let albedo = Rgb::new(0.9, 0.5, 0.1);
    let mean_free_path = Rgb::new(0.03, 0.02, 0.01);
    for g in [0.0, 0.8] {
        let medium = ScatteringInput::Albedo { albedo: ColorInput::constant(albedo), mean_free_path, g };
        let specular = f64::from(Boundary::new(1.4, 0.0).reflectance(view_cosine()));
        for (c, statistic) in reflected(slab_scene(medium, 1.4, 0.0)).iter().enumerate() {
            let exact = specular + (1.0 - specular) * f64::from(albedo[c]);
            assert!((statistic.mean() / exact - 1.0).abs() < 0.003, "{} against {exact}", statistic.mean());
        }
    }
}
