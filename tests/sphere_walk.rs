//! The walk on spheres against the walk from collision to collision.

mod common;

use alabaster::math::sampler::HashGenerator;
use alabaster::radiometry::Rgb;
use alabaster::scene::{
    ColorInput, Environment, Instance, Light, Material, Mesh, Method, ScatteringInput, Scene, Surface, shape,
};
use alabaster::transport::{RenderOptions, Renderer};
use common::scenes::{caster, furnace, options, white};
use common::walks::{Found, picture, plain_walker, trace, walker};
use glam::{Affine3A, Vec3};

/// The channels scatter and absorb differently.
fn colored(ior: f32, roughness: f32, albedo: [f32; 3], sigma_t: f32) -> Material {
    let sigma_t = Rgb::new(1.0, 0.7, 1.5) * sigma_t;
    let albedo = Rgb::from_fn(|c| albedo[c]);
    let medium = ScatteringInput::Coefficients {
        sigma_a: (Rgb::ONE - albedo) * sigma_t,
        sigma_s: albedo * sigma_t,
        g: 0.0,
    };
    Material { surface: Surface::Translucent { ior, roughness, medium }, ..white(ior, roughness, Rgb::ONE) }
}

/// A body under a lamp in a dim room.
fn lit(mesh: Mesh, material: Material) -> Scene {
    let mut scene = furnace(mesh, material);
    scene.environment = Some(Environment::Constant(Rgb::splat(0.3)));
    scene.lights = vec![Light::Sphere {
        center: Vec3::new(1.0, 4.0, 2.0),
        radius: 1.0,
        radiance: Rgb::splat(5.0).into(),
    }];
    scene
}

/// Rays from above, spread over what is within `reach` of the origin.
fn from_above(reach: f32) -> impl Fn(u64) -> (Vec3, Vec3) + Sync {
    move |sample| {
        let mut random = HashGenerator::new(sample);
        let [x, z] = [(); 2].map(|()| reach * (2.0 * random.next_f32() - 1.0));
        let origin = Vec3::new(0.5, 3.0, 0.8);
        (origin, (Vec3::new(x, 0.0, z) - origin).normalize())
    }
}

/// Means agree to 4σ in the channels, of which there are dozens, and to 3σ over them; both σ are below `precision`
/// of the mean.
#[track_caller]
fn assert_same(name: &str, plain: &Found, spheres: &Found, precision: f64) {
    assert_eq!(plain.counters.sphere_steps, 0);
    assert!(spheres.counters.sphere_steps > 1000, "{name}: {} steps", spheres.counters.sphere_steps);
    let channels = plain.radiance.iter().zip(&spheres.radiance).map(|pair| (pair, 4.0));
    for ((a, b), allowed) in channels.chain([((&plain.mean, &spheres.mean), 3.0)]) {
        let (mean, sigma) = (a.mean(), a.standard_error().hypot(b.standard_error()));
        println!(
            "{name}: {mean:.5}, on spheres {:.5}, difference {:.2} σ",
            b.mean(),
            (b.mean() - mean) / sigma
        );
        assert!((b.mean() - mean).abs() < allowed * sigma, "{name}: {} not {mean} ± {sigma}", b.mean());
        assert!(sigma < precision * mean, "{name}: σ {sigma} of {mean}");
    }
    for found in [plain, spheres] {
        assert_eq!((found.counters.capped_paths, found.counters.rejected), (0, 0), "{name}");
    }
}

fn check(name: &str, scene: &Scene, paths: u64, precision: f64) {
    let [plain, spheres] = [plain_walker(scene.clone()), walker(scene.clone())]
        .map(|renderer| trace(&renderer, paths, from_above(0.7)));
    assert_same(name, &plain, &spheres, precision);
}

#[test]
fn steps_on_spheres_change_no_mean() {
    let bodies = [
        ("sphere", shape::sphere(Vec3::ZERO, 1.0, 5)),
        ("box", shape::cuboid(Vec3::ZERO, Vec3::new(1.6, 0.8, 1.2))),
    ];
    for (name, mesh) in bodies {
        for (ior, roughness) in [(1.0, 0.0), (1.5, 0.0), (1.5, 0.5)] {
            for albedo in [[0.9; 3], [1.0, 0.999, 0.9]] {
                let scene = lit(mesh.clone(), colored(ior, roughness, albedo, 25.0));
                check(&format!("{name} η {ior} roughness {roughness} ω {albedo:?}"), &scene, 120_000, 0.02);
            }
        }
    }
}

/// Lights without size are found by nothing but direct light, so that all that a sphere hides has to be drawn for it.
#[test]
fn direct_light_is_drawn_for_what_scattered_in_a_sphere() {
    let mut scene = lit(shape::sphere(Vec3::ZERO, 1.0, 5), colored(1.0, 0.0, [1.0, 0.99, 0.9], 12.0));
    scene.environment = None;
    scene.lights = vec![
        Light::Point { position: Vec3::new(1.0, 1.2, 0.3), intensity: Rgb::splat(3.0).into() },
        Light::Directional { direction: Vec3::NEG_Y, irradiance: Rgb::ONE.into() },
    ];
    check("lights without size", &scene, 200_000, 0.01);
    // The same from inside, behind a surface that is not the body's.
    scene.lights = vec![Light::Sphere {
        center: Vec3::new(0.0, 0.2, 0.0),
        radius: 0.2,
        radiance: Rgb::splat(4.0).into(),
    }];
    let [plain, spheres] = [plain_walker(scene.clone()), walker(scene)]
        .map(|renderer| trace(&renderer, 20_000, from_above(0.7)));
    assert_eq!(spheres.counters.sphere_steps, 0, "lit inside");
    assert!(spheres.counters.rays < plain.counters.rays);
}

/// Places the first mesh once more.
fn place(scene: &mut Scene, name: &str, transform: Affine3A, material: Material) {
    scene.instances.push(Instance { name: name.into(), mesh: 0, material: scene.materials.len(), transform });
    scene.materials.push(material);
}

#[test]
fn bodies_that_overlap_or_are_nested_keep_spheres_apart() {
    for ior in [1.0, 1.5] {
        let mut scene = lit(shape::sphere(Vec3::ZERO, 0.8, 5), colored(ior, 0.0, [1.0, 0.999, 0.95], 30.0));
        let beside = Affine3A::from_scale_rotation_translation(
            Vec3::new(0.7, 0.6, 0.8),
            glam::Quat::from_rotation_y(0.4),
            Vec3::new(0.5, 0.2, 0.0),
        );
        place(&mut scene, "beside", beside, colored(1.3, 0.0, [0.9, 1.0, 0.99], 40.0));
        let within = Affine3A::from_scale_rotation_translation(
            Vec3::splat(0.25),
            glam::Quat::IDENTITY,
            Vec3::new(-0.3, 0.2, 0.0),
        );
        let dark = Surface::Diffuse { reflectance: ColorInput::constant(Rgb::new(0.1, 0.5, 0.2)) };
        place(&mut scene, "within", within, Material { surface: dark, ..white(1.0, 0.0, Rgb::ONE) });
        check(&format!("overlapping, η {ior}"), &scene, 100_000, 0.02);
    }
}

/// The light of all channels together is the same for every path: its σ is that of rounding.
#[test]
fn thick_bodies_that_absorb_nothing_vanish_in_uniform_light() {
    for (name, mesh) in [
        ("sphere", shape::sphere(Vec3::ZERO, 1.0, 5)),
        ("box", shape::cuboid(Vec3::ZERO, Vec3::new(1.6, 0.8, 1.2))),
    ] {
        for ior in [1.0, 1.5] {
            let scene = furnace(mesh.clone(), white(ior, 0.0, Rgb::new(1.0, 0.7, 1.5) * 60.0));
            let found = picture(&walker(scene), 12);
            let (mean, sigma) = (found.mean.mean(), found.mean.standard_error());
            println!("{name} η {ior}: {mean:.6} ± {sigma:.6}, {} steps", found.counters.sphere_steps);
            assert!(found.counters.sphere_steps > 1000);
            assert!((mean - 1.0).abs() < 3.0 * sigma + 1e-5, "{mean} ± {sigma}");
            assert!(sigma < 1e-3);
            for channel in &found.radiance {
                let (mean, sigma) = (channel.mean(), channel.standard_error());
                assert!((mean - 1.0).abs() < 4.0 * sigma + 1e-5, "{mean} ± {sigma}");
                assert!(channel.max < 3.0 + 1e-3);
            }
        }
    }
}

/// A flight that is known to meet nothing is the flight that a ray would find to meet nothing.
#[test]
fn flights_without_rays_are_those_with_rays_bit_for_bit() {
    let scene = lit(shape::sphere(Vec3::X * 0.3, 1.0, 4), forward(1.4));
    let renderers = [plain_walker(scene.clone()), walker(scene)];
    let mut counters = [Default::default(); 2];
    for pixel in 0..24 * 24 {
        let [plain, free] = [0, 1]
            .map(|i| renderers[i].sample(pixel % 24, pixel / 24, 0, &mut counters[i]).0.map(f32::to_bits));
        assert_eq!(plain, free);
    }
    let [plain, free] = counters;
    assert_eq!((plain.collisions, free.sphere_steps), (free.collisions, 0));
    let spared = plain.rays - free.rays;
    println!("{spared} of {} flights without a ray", plain.collisions);
    assert!(spared > plain.collisions / 2);
}

/// Where light is drawn at collisions, shadow rays from the depth are few and weigh the more.
#[test]
fn few_shadow_rays_from_the_depth_bring_all_light() {
    let scene = lit(shape::sphere(Vec3::ZERO, 1.0, 4), forward(1.0));
    let [plain, free] = [plain_walker(scene.clone()), walker(scene)]
        .map(|renderer| trace(&renderer, 60_000, from_above(0.7)));
    assert!(2 * free.counters.rays < plain.counters.rays);
    let (mean, sigma) = (plain.mean.mean(), plain.mean.standard_error().hypot(free.mean.standard_error()));
    println!("{mean:.5}, with few shadow rays {:.5}, σ {sigma:.5}", free.mean.mean());
    assert!((free.mean.mean() - mean).abs() < 3.0 * sigma);
    assert!(sigma < 0.01 * mean);
}

/// Of order-1 similarity far from surfaces nothing is to be seen: less than half a percent, which is what is said of it; and noise, 3σ. What is
/// left out are the moments of the direction from the second on, which light that comes from two reduced free paths away has lost but
/// for e⁻² of it.
#[test]
fn similarity_changes_means_by_less_than_half_a_percent() {
    for (roughness, g) in [(0.0, 0.8), (0.5, -0.4)] {
        let medium = ScatteringInput::Coefficients {
            sigma_a: Rgb::new(0.01, 0.03, 0.1),
            sigma_s: Rgb::splat(30.0 / (1.0 - g)),
            g,
        };
        let surface = Surface::Translucent { ior: 1.5, roughness, medium };
        let material = Material { surface, ..white(1.5, roughness, Rgb::ONE) };
        let scene = lit(shape::sphere(Vec3::ZERO, 1.0, 5), material);
        let options = RenderOptions { method: Method::Walk, similarity: true, ..options() };
        let similar = Renderer::new(scene.clone(), options, caster).unwrap();
        let [exact, similar] = [walker(scene), similar].map(|walk| trace(&walk, 500_000, from_above(0.7)));
        let (mean, sigma) =
            (exact.mean.mean(), exact.mean.standard_error().hypot(similar.mean.standard_error()));
        println!("g {g}: {mean:.5}, similar {:.5}, σ {sigma:.5}", similar.mean.mean());
        assert!((similar.mean.mean() - mean).abs() < 3.0 * sigma + 0.005 * mean);
        assert!(sigma < 0.005 * mean);
        assert_eq!((exact.counters.sphere_steps, similar.counters.capped_paths), (0, 0));
        assert!(similar.counters.sphere_steps > 1000);
        assert!(similar.counters.collisions < exact.counters.collisions);
    }
}

/// Light drawn at collisions in one medium would be weighted against light found in another.
#[test]
fn no_similar_medium_is_taken_where_light_is_drawn_at_collisions() {
    let scene = lit(shape::sphere(Vec3::ZERO, 1.0, 4), forward(1.0));
    let options = RenderOptions { method: Method::Walk, similarity: true, ..options() };
    let similar = trace(&Renderer::new(scene, options, caster).unwrap(), 5_000, from_above(0.7));
    assert!(similar.counters.collisions > 1000);
    assert_eq!(similar.counters.sphere_steps, 0);
}

/// Scatters forward: steps on spheres are for isotropic scattering only.
fn forward(ior: f32) -> Material {
    let medium = ScatteringInput::Coefficients {
        sigma_a: Rgb::new(0.1, 0.3, 1.0),
        sigma_s: Rgb::new(30.0, 20.0, 40.0),
        g: 0.5,
    };
    Material { surface: Surface::Translucent { ior, roughness: 0.0, medium }, ..white(ior, 0.0, Rgb::ONE) }
}
