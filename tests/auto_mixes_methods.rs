//! Bodies with different methods in one scene, in the white furnace: nothing absorbs, so nothing shows.

mod common;

use alabaster::scene::{Instance, Material, Mesh, Method, Scene, shape};
use alabaster::transport::{RenderOptions, Renderer};
use common::scenes::{Caster, caster, furnace, options, white};
use common::walks::picture;
use glam::{Affine3A, Vec3};

/// 1/m.
fn material(eta: f32, sigma_s: f32) -> Material {
    white(eta, 0.0, alabaster::radiometry::Rgb::splat(sigma_s))
}

/// One of thin medium that is walked in and one of dense medium that is not.
fn scene(thin: Mesh, dense: Mesh, dense_eta: f32) -> Scene {
    let mut scene = furnace(thin, material(1.3, 2.0));
    scene.materials.push(material(dense_eta, 2000.0));
    scene.meshes.push(dense);
    let transform = Affine3A::IDENTITY;
    scene.instances.push(Instance { name: "dense".into(), mesh: 1, material: 1, transform });
    scene
}

fn renderer(scene: Scene) -> Renderer<Caster> {
    let options = RenderOptions { method: Method::Auto, accuracy: 0.25, ..options() };
    let renderer = Renderer::new(scene, options, caster).unwrap();
    let methods: Vec<Method> = renderer.plan().objects.iter().map(|object| object.method).collect();
    assert!(methods[0] == Method::Walk && methods[1] != Method::Walk, "{methods:?}");
    renderer
}

#[test]
fn a_body_beside_or_inside_one_of_another_method_vanishes() {
    let sphere = |center: Vec3, radius| shape::sphere(center, radius, 5);
    let beside = scene(sphere(Vec3::X * 0.5, 0.5), sphere(Vec3::X * -0.52, 0.5), 1.5);
    let inside = scene(sphere(Vec3::ZERO, 0.8), sphere(Vec3::Y * 0.1, 0.5), 1.45);
    for (name, scene) in [("beside", beside), ("inside", inside)] {
        let renderer = renderer(scene);
        let found = picture(&renderer, 64);
        let (mean, sigma) = (found.mean.mean(), found.mean.standard_error());
        println!("{name}: {mean:.5} ± {sigma:.5} {:?}", found.counters);
        assert!(found.counters.collisions > 0);
        // Directions that the interpolated normals of a coarse sphere send to the wrong side are lost.
        let lost = (found.counters.rejected + found.counters.capped_paths) as f64 / (576.0 * 64.0);
        assert!(lost < 1e-3, "{lost}");
        assert!((mean - 1.0).abs() < 3.0 * sigma + lost + 1e-4, "{name}: {mean} ± {sigma}");
    }
}
