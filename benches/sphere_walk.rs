//! What walks win by knowing the free space around them: processor time and variance of the light that a path finds, of
//! the plain walk and of the walk on spheres, and the gain in efficiency 1/(time · variance). In anisotropic media also with similarity,
//! which is an approximation: the means differ by its error.
//!
//! `cargo bench --bench sphere_walk [SECONDS [THICKNESS]]`: seconds for each walk on each body, half of them plain; only bodies so many mean free
//! paths thick. Both walks take turns, so that what else the machine does falls on both alike. The last gain is that of a picture of 256 × 256
//! pixels and 16 samples, the time for making ready included.

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

/// How often the walks take turns.
const TURNS: u32 = 32;

/// Paths of the picture.
const PICTURE: f64 = 256.0 * 256.0 * 16.0;

fn main() {
    let numbers: Vec<f64> = env::args().skip(1).filter_map(|argument| argument.parse().ok()).collect();
    let seconds = numbers.first().copied().unwrap_or(1.0);
    println!(
        "body, mfp thick, 1 - albedo, g, index: µs a path plain, on spheres; variance ratio; gain; of a picture"
    );
    let ball = || shape::sphere(Vec3::ZERO, 1.0, 6);
    let slab = || shape::cuboid(Vec3::ZERO, Vec3::new(2.0, 0.5, 2.0));
    for ior in [1.0, 1.5] {
        for (is_slab, thickness, absorbed, g) in [
            (false, 4.0, 1e-2, 0.0),
            (false, 10.0, 1e-2, 0.0),
            (false, 20.0, 1e-2, 0.0),
            (false, 60.0, 0.1, 0.0),
            (false, 60.0, 1e-4, 0.0),
            (false, 60.0, 1e-3, 0.5),
            (false, 200.0, 1e-4, 0.0),
            (false, 500.0, 1e-4, 0.8),
            (false, 2000.0, 1e-2, 0.0),
            (false, 2000.0, 1e-4, 0.0),
            (true, 4.0, 1e-2, 0.0),
            (true, 50.0, 1e-4, 0.0),
        ] {
            if numbers.get(1).is_some_and(|&wanted| wanted != f64::from(thickness)) {
                continue;
            }
            let (name, mesh, width) = if is_slab { ("slab", slab(), 0.5) } else { ("sphere", ball(), 2.0) };
            let scene = scene(mesh, [thickness / width, absorbed, g, ior]);
            let name = format!("{name} {thickness} {absorbed} {g} {ior}");
            compare(&name, &scene, false, seconds);
            if g != 0.0 && ior != 1.0 {
                compare(&format!("{name} similarity"), &scene, true, seconds);
            }
        }
    }
}

/// A body under a lamp in a dim room, of extinction, share absorbed at a collision, g and index in `numbers`.
fn scene(mesh: Mesh, [sigma_t, absorbed, g, ior]: [f32; 4]) -> Scene {
    let medium = ScatteringInput::Coefficients {
        sigma_a: Rgb::splat(absorbed * sigma_t),
        sigma_s: Rgb::splat((1.0 - absorbed) * sigma_t),
        g,
    };
    let surface = Surface::Translucent { ior, roughness: 0.0, medium };
    let mut scene = furnace(mesh, Material { surface, ..white(ior, 0.0, Rgb::ONE) });
    scene.lights = vec![Light::Sphere {
        center: Vec3::new(1.0, 4.0, 2.0),
        radius: 1.0,
        radiance: Rgb::splat(5.0).into(),
    }];
    scene
}

/// Prints a line about `scene`.
fn compare(name: &str, scene: &Scene, similarity: bool, seconds: f64) {
    let plain = RenderOptions { method: Method::Walk, spheres: false, ..options() };
    let mut walks = [plain, RenderOptions { spheres: true, similarity, ..plain }]
        .map(|options| Measured::new(scene.clone(), options));
    for _ in 0..TURNS {
        walks.iter_mut().for_each(|walk| walk.go_on(0.5 * seconds / f64::from(TURNS)));
    }
    let [plain, spheres] = &walks;
    let less_noise = plain.variance() / spheres.variance();
    let of_picture = |walk: &Measured| walk.setup + PICTURE * walk.seconds_per_path();
    println!(
        "{name}: {:.2} {:.2}; {:.2}; {:.2}; {:.2}   (means {:.4} ± {:.4}, {:.4} ± {:.4}; ready in {:.2} s, {:.2} s)",
        plain.seconds_per_path() * 1e6,
        spheres.seconds_per_path() * 1e6,
        1.0 / less_noise,
        less_noise * plain.seconds_per_path() / spheres.seconds_per_path(),
        less_noise * of_picture(plain) / of_picture(spheres),
        plain.found.mean(),
        plain.found.standard_error(),
        spheres.found.mean(),
        spheres.found.standard_error(),
        plain.setup,
        spheres.setup,
    );
}

/// What paths found and took.
struct Measured {
    renderer: Renderer<Caster>,
    counters: Counters,
    found: Statistics,
    paths: u32,
    seconds: f64,
    /// Processor time of making ready, by all threads.
    setup: f64,
}

impl Measured {
    fn new(scene: Scene, options: RenderOptions) -> Self {
        let start = process_seconds();
        let renderer: Renderer<Caster> = Renderer::new(scene, options, caster).unwrap();
        let setup = process_seconds() - start;
        let (counters, found) = Default::default();
        Self { renderer, counters, found, paths: 0, seconds: 0.0, setup }
    }

    /// Follows paths for so many seconds more.
    fn go_on(&mut self, seconds: f64) {
        let start = thread_seconds();
        let mut taken = 0.0;
        while taken < seconds {
            for _ in 0..64 {
                let (origin, path) = (Vec3::new(0.3, 3.0, 0.2), u64::from(self.paths));
                let radiance = self.renderer.radiance(origin, Vec3::NEG_Y, path, &mut self.counters);
                self.found.add(f64::from(radiance.mean()));
                self.paths += 1;
            }
            taken = thread_seconds() - start;
        }
        self.seconds += taken;
    }

    fn seconds_per_path(&self) -> f64 {
        self.seconds / f64::from(self.paths)
    }

    /// Of a path.
    fn variance(&self) -> f64 {
        self.found.standard_error().powi(2) * f64::from(self.paths)
    }
}
