//! White furnace: in uniform surroundings of radiance 1 a body that absorbs nothing must look exactly
//! like the background, whatever its shape, index, roughness or mean free path.

mod common;

use alabaster::scene::shape;
use alabaster::transport::Counters;
use common::scenes::{Statistics, body, furnace, l_shape, renderer, two_slabs};
use glam::Vec3;

const SAMPLES: u64 = 16;

/// Renders [`SAMPLES`] samples per pixel of a 24×24 picture and checks mean and extremes.
fn check(name: &str, mesh: alabaster::scene::Mesh, eta: f32, roughness: f32, free_path: f32) {
    let scene = furnace(mesh, body(eta, roughness, free_path));
    let renderer = renderer(scene);
    let mut counters = Counters::default();
    let mut all = Statistics::default();
    for y in 0..24 {
        for x in 0..24 {
            for sample in 0..SAMPLES {
                let radiance = renderer.sample(x, y, sample, &mut counters);
                assert!(radiance.is_finite(), "{name}: not finite at ({x}, {y})");
                // The channels of a sample are not independent: their mean is one number.
                all.add(f64::from(radiance.mean()));
            }
        }
    }
    let (mean, sigma) = (all.mean(), all.standard_error());
    println!(
        "{name:28} eta {eta:.3} roughness {roughness} free path {free_path}: {mean:.5} ± {sigma:.5} max {:.2}",
        all.max
    );
    // Rounding of products along a path of some hundred factors leaves a few 1e-6.
    assert!((mean - 1.0).abs() < 3.0 * sigma + 1e-5, "{name}: {mean} ± {sigma}");
}

#[test]
fn bodies_that_absorb_nothing_vanish_in_uniform_light() {
    for eta in [1.0, 1.33, 1.5, 1.0 / 1.33] {
        for roughness in [0.0, 0.5] {
            let sphere = || shape::sphere(Vec3::ZERO, 1.0, 5);
            for free_path in [1.0, 0.3, 0.1, 0.01] {
                check("sphere", sphere(), eta, roughness, free_path);
            }
            for free_path in [1.0, 0.2, 0.04] {
                check("slab", shape::cuboid(Vec3::ZERO, Vec3::new(4.0, 0.2, 4.0)), eta, roughness, free_path);
                check("L", l_shape(), eta, roughness, free_path);
                check("two slabs", two_slabs(), eta, roughness, free_path);
            }
        }
    }
}
