//! The walk guided towards where light leaves against the classic walk.

mod common;

use alabaster::math::sampler::HashGenerator;
use alabaster::medium::dwivedi::Mode;
use alabaster::radiometry::Rgb;
use alabaster::scene::{Environment, Light, Material, Mesh, Method, ScatteringInput, Scene, Surface, shape};
use alabaster::transport::{RenderOptions, Renderer};
use common::scenes::{Caster, Statistics, caster, furnace, join, l_shape, options, white};
use common::walks::{Found, trace, walker};
use glam::{Quat, Vec3};

/// Of [`options`].
const SEED: u64 = 1;

/// No light weighs more than this many times what it would in the classic walk.
const BOUND: f64 = 10.0;

fn classic_walker(scene: Scene, seed: u64) -> Renderer<Caster> {
    let options = RenderOptions { method: Method::Walk, guiding: false, seed, ..options() };
    Renderer::new(scene, options, caster).unwrap()
}

/// The channels scatter and absorb differently.
fn absorbing(ior: f32, albedo: [f32; 3], sigma_t: f32, g: f32) -> Material {
    let sigma_t = Rgb::new(1.0, 0.7, 1.6) * sigma_t;
    let albedo = Rgb::from_fn(|c| albedo[c]);
    let sigma_a = (Rgb::ONE - albedo) * sigma_t;
    let medium = ScatteringInput::Coefficients { sigma_a, sigma_s: albedo * sigma_t, g };
    Material { surface: Surface::Translucent { ior, roughness: 0.0, medium }, ..white(ior, 0.0, Rgb::ONE) }
}

/// A body under a lamp in a dim room.
fn lit(mesh: Mesh, material: Material) -> Scene {
    let mut scene = furnace(mesh, material);
    scene.environment = Some(Environment::Constant(Rgb::splat(0.4)));
    scene.lights = vec![Light::Sphere {
        center: Vec3::new(1.0, 4.0, 2.0),
        radius: 1.5,
        radiance: Rgb::splat(3.0).into(),
    }];
    scene
}

/// Two hollow eyes and a jaw: a thick shell around a space that is part of the outside, open below, and
/// a bar close under it, all one closed mesh.
fn skull() -> Mesh {
    let mut inside = shape::sphere(Vec3::new(0.0, -0.1, 0.0), 0.6, 4);
    inside.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    inside.normals.iter_mut().for_each(|n| *n = -*n);
    let mut jaw = shape::cuboid(Vec3::new(0.0, -1.15, 0.2), Vec3::new(1.2, 0.2, 0.5));
    jaw.positions.iter_mut().for_each(|p| *p = Quat::from_rotation_y(0.4) * *p);
    jaw.normals.clear();
    let mut shell = shape::sphere(Vec3::ZERO, 0.9, 4);
    shell.normals.clear();
    inside.normals.clear();
    join([shell, inside, jaw])
}

/// Rays from above, spread over what is within 0.8 of the origin.
fn from_above(first: u64) -> impl Fn(u64) -> (Vec3, Vec3) + Sync {
    move |sample| {
        let mut random = HashGenerator::new(first + sample);
        let [x, z] = [(); 2].map(|()| 0.8 * (2.0 * random.next_f32() - 1.0));
        let origin = Vec3::new(0.5, 3.0, 0.8);
        (origin, (Vec3::new(x, 0.0, z) - origin).normalize())
    }
}

/// Distance of two means in units of their σ.
fn pull(a: &Statistics, b: &Statistics) -> f64 {
    (b.mean() - a.mean()) / a.standard_error().hypot(b.standard_error())
}

/// What the classic walk and the guided one found: by rays and random numbers of their own, and of the `place` of the scene.
fn both(scene: &Scene, place: u64) -> [Found; 2] {
    [false, true].map(|guiding| {
        let own = 2 * place + u64::from(guiding);
        let options = RenderOptions { method: Method::Walk, guiding, seed: 100 + own, ..options() };
        let renderer = Renderer::new(scene.clone(), options, caster).unwrap();
        trace(&renderer, PATHS, from_above(own * PATHS))
    })
}

/// For a standard error below 4 % of the mean in each of fifty scenes.
const PATHS: u64 = 25_000;

/// Means agree to 3σ over the channels and to 4σ in each, of which there are 150, and the squares of the former
/// are those of a normal distribution of σ = 1.
#[test]
fn guides_change_no_mean() {
    let bodies = [
        ("sphere", shape::sphere(Vec3::ZERO, 1.0, 4), 8.0),
        ("box", shape::cuboid(Vec3::ZERO, Vec3::new(1.4, 0.8, 1.2)), 6.0),
        ("slab", shape::cuboid(Vec3::ZERO, Vec3::new(4.0, 0.3, 4.0)), 16.0),
        ("concave L", l_shape(), 4.0),
        ("skull", skull(), 10.0),
    ];
    let albedos = [[0.3; 3], [0.7, 0.5, 0.6], [0.9; 3], [0.95, 0.4, 0.8], [0.9999, 0.6, 0.97]];
    let mut squares = Statistics::default();
    let mut place = 0;
    for (name, mesh, sigma_t) in bodies {
        for ior in [1.0, 1.5] {
            for albedo in albedos {
                let scene = lit(mesh.clone(), absorbing(ior, albedo, sigma_t, 0.0));
                let name = format!("{name}, η {ior}, ω {albedo:?}");
                let [classic, guided] = both(&scene, place);
                place += 1;
                let z = pull(&classic.mean, &guided.mean);
                let (mean, sigma) = (classic.mean.mean(), classic.mean.standard_error());
                println!(
                    "{name}: {mean:.5} ± {sigma:.5}, guided {z:+.2} σ, largest {:.2} {:.2}",
                    classic.mean.max, guided.mean.max
                );
                assert!(z.abs() < 3.0, "{name}: {z} σ");
                for (a, b) in classic.radiance.iter().zip(&guided.radiance) {
                    assert!(pull(a, b).abs() < 4.0, "{name}: {} σ", pull(a, b));
                }
                assert!(sigma < 0.04 * mean, "{name}: {sigma} of {mean}");
                assert_eq!((guided.counters.capped_paths, guided.counters.rejected), (0, 0), "{name}");
                assert!(guided.mean.max <= BOUND * classic.mean.max, "{name}: {}", guided.mean.max);
                squares.add(z * z);
            }
        }
    }
    println!("mean square {:.3} ± {:.3}", squares.mean(), squares.standard_error());
    // The square of a normal number has variance 2.
    assert!((squares.mean() - 1.0).abs() < 3.0 * (2.0 / 50.0_f64).sqrt());
}

/// In uniform light of radiance 1 and with a boundary through which no light is drawn directly, what a path brings is what it
/// weighs: at most 1/α times all channels together, wherever it has been. Corners and edges, seen closely.
#[test]
fn no_path_weighs_more_than_the_bound() {
    let mesh = shape::cuboid(Vec3::ZERO, Vec3::splat(1.0));
    for albedo in [[0.8; 3], [0.9; 3], [0.9999, 0.3, 0.9]] {
        let scene = furnace(mesh.clone(), absorbing(1.5, albedo, 6.0, 0.0));
        let corner = |sample| {
            let mut random = HashGenerator::new(sample);
            let [x, y, z] = [(); 3].map(|()| 0.5 - 0.02 * random.next_f32());
            let origin = Vec3::new(1.5, 1.6, 1.4);
            (origin, (Vec3::new(x, y, z) - origin).normalize())
        };
        let [classic, guided] = [classic_walker(scene.clone(), SEED + 1), walker(scene)]
            .map(|renderer| trace(&renderer, 60_000, corner));
        let z = pull(&classic.mean, &guided.mean);
        println!("ω {albedo:?}: {:.3} {:.3}, {z:+.2} σ", classic.mean.max, guided.mean.max);
        assert!(guided.counters.collisions != classic.counters.collisions, "no guide");
        // A hundred roundings.
        assert!(classic.mean.max < 1.0 + 1e-5 && guided.mean.max < BOUND * (1.0 + 1e-5));
        assert!(z.abs() < 3.0, "{z} σ");
    }
}

/// Where guides do not pay there are none: the picture is that of the classic walk, bit for bit.
#[test]
fn what_guides_do_not_help_is_left_alone() {
    let sphere = || shape::sphere(Vec3::ZERO, 1.0, 4);
    let bodies = [
        ("scatters forwards", absorbing(1.5, [0.8; 3], 40.0, 0.8)),
        ("is thin", absorbing(1.0, [0.8; 3], 2.0, 0.0)),
        ("absorbs next to nothing", absorbing(1.5, [0.9999; 3], 8.0, 0.0)),
        ("brings out next to nothing", absorbing(1.5, [0.1; 3], 8.0, 0.0)),
    ];
    for (name, material) in bodies {
        let scene = lit(sphere(), material);
        let [classic, guided] = [classic_walker(scene.clone(), SEED), walker(scene)]
            .map(|renderer| trace(&renderer, 1000, from_above(0)));
        assert_eq!(classic.mean.mean(), guided.mean.mean(), "{name}");
        assert_eq!(classic.counters.collisions, guided.counters.collisions, "{name}");
    }
}

/// What light brings out of a half-space of uniform surroundings, from straight down: by the classic walk, by a guided one, and by a guided one
/// that is weighted by nothing but absorption.
fn half_space(albedo: f32, guided: Option<bool>, paths: u64) -> Statistics {
    let mode = Mode::new(f64::from(albedo));
    let mut random = HashGenerator::new(paths);
    let mut found = Statistics::default();
    for _ in 0..paths {
        let (mut depth, mut cosine, mut weight) = (0.0_f32, -1.0_f32, 1.0_f32);
        while weight > 1e-6 {
            let stretch = guided.map_or(1.0, |_| mode.stretch(cosine));
            let flight = random.next_exponential() / stretch;
            let out = if cosine > 0.0 { depth / cosine } else { f32::INFINITY };
            let correction = |distance: f32| ((stretch - 1.0) * distance).exp();
            let weighted = guided == Some(true);
            if flight >= out {
                found.add(f64::from(if weighted { weight * correction(out) } else { weight }));
                weight = -1.0;
                break;
            }
            depth -= flight * cosine;
            weight *= albedo * if weighted { correction(flight) / stretch } else { 1.0 };
            cosine = match guided {
                Some(_) => mode.sample(random.next_f32()),
                None => 2.0 * random.next_f32() - 1.0,
            };
            if weighted {
                weight /= 4.0 * std::f32::consts::PI * mode.density(cosine);
            }
        }
        if weight >= 0.0 {
            found.add(0.0);
        }
    }
    found
}

/// The densities that guides weigh by are those by which they draw, and it shows if one does not weigh.
#[test]
fn without_weights_guides_are_too_bright() {
    for albedo in [0.6, 0.8, 0.95] {
        let [classic, guided, naive] =
            [None, Some(true), Some(false)].map(|guided| half_space(albedo, guided, 100_000));
        let right = pull(&classic, &guided);
        let wrong = pull(&classic, &naive);
        println!("ω {albedo}: {:.4}, {right:+.2} σ, without weights {wrong:+.0} σ", classic.mean());
        assert!(right.abs() < 3.0, "{right} σ");
        assert!(wrong > 30.0, "{wrong} σ");
        assert!(guided.standard_error() < 0.7 * classic.standard_error());
    }
}
