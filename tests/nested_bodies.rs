//! Bodies inside bodies: milk in its glass, where the milk reaches a little into the glass wall.

mod common;

use alabaster::radiometry::Rgb;
use alabaster::scene::{ColorInput, Instance, Material, Mesh, ScalarInput, Scene, Surface, shape};
use alabaster::transport::Counters;
use common::scenes::{Statistics, body, furnace, join, renderer};
use common::walks::walker;
use glam::{Affine3A, Vec3};

/// A hollow glass ball: outer wall at radius 1, inner at 0.85, as one closed mesh.
fn glass_ball() -> Mesh {
    let mut inner = shape::sphere(Vec3::ZERO, 0.85, 5);
    inner.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    inner.normals.iter_mut().for_each(|n| *n = -*n);
    join([shape::sphere(Vec3::ZERO, 1.0, 5), inner])
}

fn glass() -> Material {
    Material {
        surface: Surface::Dielectric {
            ior: 1.5,
            dispersion: None,
            roughness: ScalarInput::constant(0.0),
            sigma_a: Rgb::ZERO,
            tint: ColorInput::constant(Rgb::ONE),
        },
        emission: ColorInput::constant(Rgb::ZERO),
        ..Material::default()
    }
}

fn milk_in_glass(milk: Mesh, roughness: f32) -> Scene {
    let mut scene = furnace(glass_ball(), glass());
    scene.materials.push(body(1.33, roughness, 0.05));
    scene.meshes.push(milk);
    scene.instances.push(Instance {
        name: "milk".into(),
        mesh: 1,
        material: 1,
        transform: Affine3A::IDENTITY,
    });
    scene
}

/// Nothing absorbs, so in uniform light nothing shows, on whatever side of the glass light goes in.
#[test]
fn milk_that_absorbs_nothing_vanishes_with_its_glass() {
    let full = shape::sphere(Vec3::ZERO, 0.87, 5);
    // A cylinder-like box through the middle: its sides are in the cavity, its ends in the wall.
    let bar = shape::cuboid(Vec3::ZERO, Vec3::new(0.4, 1.8, 0.4));
    // Half inside, half outside of the glass.
    let through = shape::cuboid(Vec3::X * 0.9, Vec3::new(0.8, 0.3, 0.3));
    for (name, milk) in [("full", full), ("bar", bar), ("through", through)] {
        for roughness in [0.0, 0.4] {
            for (method, renderer) in [("bssrdf", renderer as fn(_) -> _), ("walk", walker)] {
                let renderer = renderer(milk_in_glass(milk.clone(), roughness));
                let mut counters = Counters::default();
                let mut statistics = Statistics::default();
                for pixel in 0..576 {
                    for sample in 0..32 {
                        let value = renderer.sample(pixel % 24, pixel / 24, sample, &mut counters);
                        assert!(value.is_finite());
                        statistics.add(f64::from(value.mean()));
                    }
                }
                let (mean, sigma) = (statistics.mean(), statistics.standard_error());
                println!(
                    "{method}: {name} roughness {roughness}: {mean:.5} ± {sigma:.5} max {:.2} {counters:?}",
                    statistics.max
                );
                // Directions that the interpolated normals of a coarse sphere send to the wrong side are lost.
                let lost = (counters.rejected + counters.capped_paths) as f64 / (576.0 * 32.0);
                assert!(lost < 1e-3, "{lost}");
                assert!((mean - 1.0).abs() < 3.0 * sigma + lost + 1e-4, "{method}: {name}: {mean} ± {sigma}");
            }
        }
    }
}
