//! What walks win by being guided: the gain in efficiency 1/(time · variance) of the guided walk over the classic one, for
//! the light that a path finds.
//!
//! `cargo bench --bench guided_walk [SECONDS [ROWS]]`: seconds for each number, half of them for each walk; both take turns.
//! ROWS: only rows whose name contains it, as "slab 20". Below, the gain in the variance among paths that scattered in the body, without the noise of
//! whether light is mirrored by the boundary; and microseconds a path, the ratio of the variances, and the difference of the means.

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
use common::cpu_time::thread_seconds;
use common::scenes::{Caster, Statistics, caster, furnace, options, white};
use glam::Vec3;

const ALBEDOS: [f32; 9] = [0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 0.99, 0.999, 0.9999];

/// Turns of both walks.
const TURNS: u32 = 8;

fn main() {
    // Cargo adds "--bench".
    let mut arguments = env::args().skip(1).filter(|argument| argument != "--bench");
    let seconds = arguments.next().and_then(|argument| argument.parse().ok()).unwrap_or(2.0);
    let only = arguments.next().unwrap_or_default();
    println!("body, mfp thick, g, index, light; gain by albedo: {ALBEDOS:?}");
    for light in ["uniform", "lamp"] {
        for ior in [1.0, 1.5] {
            for (body, thickness, g) in [
                ("sphere", 40.0, 0.0),
                ("slab", 20.0, 0.0),
                ("slab", 4.0, 0.0),
                ("sphere", 8.0, 0.0),
                ("sphere", 2.0, 0.0),
                ("slab", 20.0, 0.8),
            ] {
                let name = format!("{body} {thickness} {g} {ior} {light}");
                if name.contains(&only) {
                    row(&name, body, [thickness, g, ior], light, seconds);
                }
            }
        }
    }
}

fn row(name: &str, body: &str, numbers: [f32; 3], light: &str, seconds: f64) {
    print!("{name}:");
    let (mut entered, mut rest) = (String::new(), String::new());
    for albedo in ALBEDOS {
        let scene = scene(body, numbers, albedo, light);
        let [classic, guided] = compare(&scene, seconds);
        let gain = classic.cost_of(&classic.mean) / guided.cost_of(&guided.mean);
        print!(" {gain:.2}");
        entered += &format!(" {:.2}", classic.cost_of(&classic.entered) / guided.cost_of(&guided.entered));
        let sigma = (guided.mean.mean() - classic.mean.mean())
            / guided.mean.standard_error().hypot(classic.mean.standard_error());
        rest += &format!(
            " [{:.2}→{:.2} µs, var {:.2}, {sigma:.1}σ]",
            classic.microseconds(),
            guided.microseconds(),
            variance(&guided.mean) / variance(&classic.mean)
        );
    }
    println!("\n    entered:{entered}\n    {rest}");
}

fn scene(body: &str, [thickness, g, ior]: [f32; 3], albedo: f32, light: &str) -> Scene {
    let mesh: Mesh = match body {
        "sphere" => shape::sphere(Vec3::ZERO, 1.0, 6),
        _ => shape::cuboid(Vec3::ZERO, Vec3::new(4.0, 1.0, 4.0)),
    };
    let sigma_t = if body == "sphere" { 0.5 * thickness } else { thickness };
    let medium = ScatteringInput::Coefficients {
        sigma_a: Rgb::splat((1.0 - albedo) * sigma_t),
        sigma_s: Rgb::splat(albedo * sigma_t),
        g,
    };
    let surface = Surface::Translucent { ior, roughness: 0.0, medium };
    let mut scene = furnace(mesh, Material { surface, ..white(ior, 0.0, Rgb::ONE) });
    if light == "lamp" {
        let center = Vec3::new(1.0, 4.0, 2.0);
        scene.lights = vec![Light::Sphere { center, radius: 1.0, radiance: Rgb::splat(5.0).into() }];
    }
    scene
}

/// A walk's paths.
struct Measured {
    renderer: Renderer<Caster>,
    mean: Statistics,
    /// Of paths with a collision.
    entered: Statistics,
    seconds: f64,
    count: u64,
}

impl Measured {
    fn new(scene: Scene, guiding: bool) -> Self {
        let options = RenderOptions { method: Method::Walk, guiding, ..options() };
        let renderer = Renderer::new(scene, options, caster).unwrap();
        Self { renderer, mean: Statistics::default(), entered: Statistics::default(), seconds: 0.0, count: 0 }
    }

    fn run(&mut self, seconds: f64) {
        let mut counters = Counters::default();
        let start = thread_seconds();
        loop {
            for _ in 0..256 {
                let origin = Vec3::new(0.3, 3.0, 0.2);
                let before = counters.collisions;
                let radiance = self.renderer.radiance(origin, Vec3::NEG_Y, self.count, &mut counters);
                self.mean.add(f64::from(radiance.mean()));
                if counters.collisions > before {
                    self.entered.add(f64::from(radiance.mean()));
                }
                self.count += 1;
            }
            let taken = thread_seconds() - start;
            if taken > seconds {
                self.seconds += taken;
                break;
            }
        }
    }

    fn microseconds(&self) -> f64 {
        self.seconds / self.count as f64 * 1e6
    }

    /// Seconds for an estimate of variance 1.
    fn cost_of(&self, found: &Statistics) -> f64 {
        self.seconds / self.count as f64 * variance(found)
    }
}

/// Of one number.
fn variance(found: &Statistics) -> f64 {
    found.standard_error().powi(2) * found.count()
}

fn compare(scene: &Scene, seconds: f64) -> [Measured; 2] {
    let mut walks = [false, true].map(|guiding| Measured::new(scene.clone(), guiding));
    for _ in 0..TURNS {
        for walk in &mut walks {
            walk.run(0.5 * seconds / f64::from(TURNS));
        }
    }
    walks
}
