//! Makes `src/plan/method_errors.csv`: how far the methods that approximate are from the walk, on simple bodies.
//!
//! `cargo run --release --example make_method_table [FILE]`
//!
//! A sphere, a cube and a slab of a gray medium are rendered by each method and by the walk. One picture has three lights, each in a channel of its own:
//! from the front in red, from the side and a little from behind in green, from all around in blue. The error is the mean square over the pixels of the body,
//! noise apart, relative to that of the picture; in green to that of red, for what the side away from the light shows is little. It takes some ten minutes of
//! processor time; rows that are in the file are kept, so that it goes on where it was interrupted.

#[path = "../tests/common"]
#[allow(dead_code)]
mod common {
    pub mod method_error;
    pub mod scenes;
}

use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::path::PathBuf;
use std::time::Instant;

use alabaster::radiometry::Rgb;
use alabaster::scene::environment::uv_to_direction;
use alabaster::scene::{
    Camera, Environment, FilmSettings, Filter, Instance, Material, Mesh, Method, ScatteringInput, Scene,
    Surface, shape,
};
use common::method_error::{ChannelError, Groups};
use common::scenes::white;
use glam::{Affine3A, Mat3, Vec2, Vec3};

const ETAS: [f32; 3] = [1.5, 1.33, 1.0];
/// σ_a/σ_t'.
const ABSORBED: [f32; 5] = [0.0, 1e-3, 1e-2, 0.1, 0.4];
/// Mean chords in reduced mean free paths.
const THICKNESSES: [f32; 7] = [1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0];
const BODIES: [&str; 3] = ["sphere", "cube", "slab"];

/// What the channels of a picture show.
const LIGHTS: [&str; 3] = ["front", "side", "around"];

/// Seconds for a body of each thickness, from which on it is not made more precise. The thicker, the smaller is what is looked for.
const SECONDS: [f64; 7] = [0.15, 0.15, 0.25, 0.7, 1.7, 4.0, 12.0];
/// Errors below this need not be told apart.
const FLOOR: f64 = 0.009;
/// Walks for each sample of another method: they have the most noise.
const WALKS: u64 = 4;

const HEADER: &str = "# Errors of methods against the walk, noise apart, made by examples/make_method_table.rs\n\
    # absorbed: sigma_a/sigma_t'; thickness: mean chord 4V/S in reduced mean free paths\n\
    # square: relative mean square error, with its standard error; bias: relative mean error\n\
    body,eta,absorbed,thickness,light,diffuse_square,diffuse_sigma,diffuse_bias,bssrdf_square,bssrdf_sigma,bssrdf_bias\n";

fn main() -> io::Result<()> {
    let default = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("src/plan/method_errors.csv");
    let path = std::env::args_os().nth(1).map_or_else(default, PathBuf::from);
    let known = fs::read_to_string(&path).unwrap_or_default();
    let mut file = OpenOptions::new().create(true).append(true).open(&path)?;
    if known.is_empty() {
        file.write_all(HEADER.as_bytes())?;
    }
    for eta in ETAS {
        for body in BODIES {
            for absorbed in ABSORBED {
                for (thickness, seconds) in THICKNESSES.into_iter().zip(SECONDS) {
                    let start = format!("{body},{eta},{absorbed},{thickness},");
                    if !known.contains(&format!("\n{start}")) {
                        let scene = scene(body, eta, absorbed, thickness);
                        file.write_all(rows(&start, &scene, seconds).as_bytes())?;
                    }
                }
            }
        }
    }
    Ok(())
}

/// A row for each light.
fn rows(start: &str, scene: &Scene, seconds: f64) -> String {
    let [diffuse, bssrdf] = errors(scene, seconds);
    let columns = |e: &ChannelError| format!("{:.3e},{:.2e},{:+.4}", e.square, e.square_sigma, e.bias);
    let row = |light: usize| {
        format!("{start}{},{},{}\n", LIGHTS[light], columns(&diffuse[light]), columns(&bssrdf[light]))
    };
    (0..3).map(row).collect()
}

/// Of `diffuse` and `bssrdf`, by light, relative.
fn errors(scene: &Scene, seconds: f64) -> [[ChannelError; 3]; 2] {
    let mut walk = Groups::new(scene, Method::Walk, 0);
    let mut others = [Method::Diffuse, Method::Bssrdf].map(|method| Groups::new(scene, method, 0));
    let start = Instant::now();
    let mut samples = 8;
    loop {
        walk.extend_to(WALKS * samples);
        others.iter_mut().for_each(|groups| groups.extend_to(samples));
        let found = others.each_ref().map(|groups| relative(groups.error(&walk)));
        let precise = |e: &ChannelError| e.square_sigma < (0.1 * e.square).max(FLOOR * FLOOR);
        if found.iter().flatten().all(precise) || start.elapsed().as_secs_f64() > seconds {
            return found;
        }
        samples *= 2;
    }
}

fn relative(errors: [ChannelError; 3]) -> [ChannelError; 3] {
    errors.map(|e| {
        let unit = e.reference.max(errors[0].reference);
        ChannelError {
            square: e.square / unit,
            square_sigma: e.square_sigma / unit,
            bias: e.bias / unit.sqrt(),
            reference: e.reference,
        }
    })
}

/// The body, and how wide a part of it the camera looks at.
fn body(name: &str) -> (Mesh, f32) {
    match name {
        "sphere" => (shape::sphere(Vec3::ZERO, 1.0, 4), 2.1),
        "cube" => (shape::cuboid(Vec3::ZERO, Vec3::splat(1.4)), 2.1),
        _ => (shape::cuboid(Vec3::ZERO, Vec3::new(4.0, 4.0, 0.2)), 1.2),
    }
}

/// 4V/S of the bodies, m.
fn mean_chord(name: &str) -> f32 {
    match name {
        "sphere" => 4.0 / 3.0,
        "cube" => 1.4 * 2.0 / 3.0,
        _ => 4.0 * (4.0 * 4.0 * 0.2) / (2.0 * 4.0 * 4.0 + 4.0 * 4.0 * 0.2),
    }
}

fn scene(name: &str, eta: f32, absorbed: f32, thickness: f32) -> Scene {
    let (mesh, width) = body(name);
    let toward_camera = Vec3::new(0.35, 0.3, 1.0).normalize();
    let distance = 8.0;
    let sigma_t = thickness / mean_chord(name);
    let medium = ScatteringInput::Coefficients {
        sigma_a: Rgb::splat(absorbed * sigma_t),
        sigma_s: Rgb::splat((1.0 - absorbed) * sigma_t),
        g: 0.0,
    };
    Scene {
        camera: Camera {
            position: toward_camera * distance,
            vertical_fov: 2.0 * (0.5 * width / distance).atan(),
            ..Camera::default()
        },
        film: FilmSettings { width: 5, height: 5, filter: Filter::Box },
        meshes: vec![mesh],
        instances: vec![Instance { name: name.into(), mesh: 0, material: 0, transform: Affine3A::IDENTITY }],
        materials: vec![Material {
            surface: Surface::Translucent { ior: eta, roughness: 0.0, medium },
            ..white(eta, 0.0, Rgb::ONE)
        }],
        environment: Some(lights()),
        ..Scene::default()
    }
}

/// Wide soft lights, a channel each: walks find them as often as any approximation does.
fn lights() -> Environment {
    const SIZE: (usize, usize) = (64, 32);
    let lobe = |direction: Vec3, toward: Vec3| direction.dot(toward.normalize()).max(0.0).powi(2);
    let radiance = |pixel: usize| {
        let (x, y) = (pixel % SIZE.0, pixel / SIZE.0);
        let uv = Vec2::new((x as f32 + 0.5) / SIZE.0 as f32, (y as f32 + 0.5) / SIZE.1 as f32);
        let direction = uv_to_direction(uv);
        Rgb::new(lobe(direction, Vec3::new(-0.6, 0.6, 0.8)), lobe(direction, Vec3::new(1.0, 0.3, -0.4)), 1.0)
    };
    Environment::Map {
        width: SIZE.0,
        height: SIZE.1,
        radiance: (0..SIZE.0 * SIZE.1).map(radiance).collect(),
        rotation: Mat3::IDENTITY,
    }
}
