//! What walks win by knowing the free space around them: processor time and variance of the light that a path finds, of
//! the plain walk and of the walk on spheres, and the gain in efficiency 1/(time · variance).
//!
//! `cargo bench --bench sphere_walk [SECONDS]`: seconds for each of both walks on each body. The time includes that for filling
//! the grid, so the gain is less for few seconds.

#[path = "../tests/common"]
#[allow(dead_code)]
mod common {
    pub mod cpu_time;
    pub mod scenes;
}

use std::env;

use alabaster::radiometry::Rgb;
use alabaster::scene::{Light, Material, Mesh, Method, ScatteringInput, Scene, Surface, shape};
use alabaster::transport::{Counters, RenderOptions, Renderer};
use common::cpu_time::{process_seconds, thread_seconds};
use common::scenes::{Caster, Statistics, caster, furnace, options, white};
use glam::Vec3;

fn main() {
    let seconds = env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(1.0);
    println!("body, mfp thick, 1 - albedo, g, index: µs a path plain, on spheres; variance ratio; gain");
    let ball = || shape::sphere(Vec3::ZERO, 1.0, 6);
    let slab = || shape::cuboid(Vec3::ZERO, Vec3::new(2.0, 0.5, 2.0));
    if let Ok(row) = env::var("ROW") {
        let n: Vec<f32> = row.split(' ').map(|x| x.parse().unwrap()).collect();
        compare("sphere", ball(), [n[0], n[1], n[2], n[3]], 0.5 * n[0], seconds);
        return;
    }
    for ior in [1.0, 1.5] {
        for (thickness, absorbed, g) in [
            (4.0, 1e-2, 0.0),
            (6.0, 1e-2, 0.0),
            (10.0, 1e-2, 0.0),
            (20.0, 1e-2, 0.0),
            (60.0, 0.1, 0.0),
            (60.0, 1e-4, 0.0),
            (60.0, 1e-3, 0.5),
            (200.0, 1e-4, 0.0),
            (2000.0, 1e-2, 0.0),
            (2000.0, 1e-4, 0.0),
        ] {
            compare("sphere", ball(), [thickness, absorbed, g, ior], 0.5 * thickness, seconds);
        }
        compare("slab", slab(), [4.0, 1e-2, 0.0, ior], 8.0, seconds);
        compare("slab", slab(), [50.0, 1e-4, 0.0, ior], 100.0, seconds);
    }
}

/// Prints a line about `mesh`, its thickness, share absorbed at a collision, g and index in `numbers`.
fn compare(name: &str, mesh: Mesh, numbers: [f32; 4], sigma_t: f32, seconds: f64) {
    let [thickness, absorbed, g, ior] = numbers;
    let medium = ScatteringInput::Coefficients {
        sigma_a: Rgb::splat(absorbed * sigma_t),
        sigma_s: Rgb::splat((1.0 - absorbed) * sigma_t),
        g,
    };
    let surface = Surface::Translucent { ior, roughness: 0.0, medium };
    let scene = lit(mesh, Material { surface, ..white(ior, 0.0, Rgb::ONE) });
    let [plain, spheres] = [false, true].map(|spheres| measure(scene.clone(), spheres, seconds));
    println!(
        "{name} {thickness} {absorbed} {g} {ior}: {:.2} {:.2}; {:.2}; {:.2}   (means {:.4} ± {:.4}, {:.4} ± {:.4})",
        plain.microseconds,
        spheres.microseconds,
        spheres.variance / plain.variance,
        plain.variance * plain.microseconds / (spheres.variance * spheres.microseconds),
        plain.mean,
        plain.error,
        spheres.mean,
        spheres.error,
    );
}

/// A body under a lamp in a dim room.
fn lit(mesh: Mesh, material: Material) -> Scene {
    let mut scene = furnace(mesh, material);
    scene.lights =
        vec![Light::Sphere { center: Vec3::new(1.0, 4.0, 2.0), radius: 1.0, radiance: Rgb::splat(5.0) }];
    scene
}

struct Measured {
    microseconds: f64,
    mean: f64,
    error: f64,
    /// Of a path.
    variance: f64,
    /// Of making ready, by all threads.
    setup: f64,
}

fn measure(scene: Scene, spheres: bool, seconds: f64) -> Measured {
    let options = RenderOptions { method: Method::Walk, spheres, ..options() };
    let start = process_seconds();
    let renderer: Renderer<Caster> = Renderer::new(scene, options, caster).unwrap();
    let setup = process_seconds() - start;
    let mut counters = Counters::default();
    let mut found = Statistics::default();
    let start = thread_seconds();
    let mut count = 0_u32;
    while !count.is_multiple_of(64) || count == 0 || thread_seconds() - start < seconds {
        let origin = Vec3::new(0.3, 3.0, 0.2);
        let radiance = renderer.radiance(origin, Vec3::NEG_Y, u64::from(count), &mut counters);
        found.add(f64::from(radiance.mean()));
        count += 1;
    }
    let taken = thread_seconds() - start;
    if env::var("ROW").is_ok() {
        println!(
            "{count} paths: {} collisions {} steps {} rays, set-up {setup:.3}",
            counters.collisions as f64 / f64::from(count),
            counters.sphere_steps as f64 / f64::from(count),
            counters.rays as f64 / f64::from(count)
        );
    }
    Measured {
        microseconds: taken / f64::from(count) * 1e6,
        mean: found.mean(),
        error: found.standard_error(),
        variance: found.standard_error().powi(2) * f64::from(count),
        setup,
    }
}
