//! How far the area integral is from transport theory, and what it costs.
//!
//! `cargo run --release --example compare_volumetric` renders the scenes of `tests/data/volumetric` on one
//! thread and compares them with the pictures of an independent volumetric path tracer that stand there;
//! then it times the marble sphere of `scenes/`.

#[path = "../tests/common"]
#[allow(dead_code)]
mod common {
    pub mod cpu_time;
    pub mod scenes;
    pub mod volumetric;
    pub mod walks;
}

use std::error::Error;
use std::path::Path;

use alabaster::raycast::embree::EmbreeCaster;
use alabaster::scene::{ProfileChoice, read_scene};
use alabaster::transport::Renderer;
use common::scenes::options;
use common::volumetric::{self, Comparison};

fn main() -> Result<(), Box<dyn Error>> {
    println!(
        "| scene | profile | spp | relMSE of the object | of the picture | object's mean against the reference, R / G / B |"
    );
    println!("|---|---|---|---|---|---|");
    for name in ["sphere_marble", "sphere_indexmatched", "slab_thin"] {
        let reference = volumetric::read(name);
        for (profile_name, profile) in ProfileChoice::NAMES {
            for samples in [64, 1024] {
                let comparison = volumetric::compare(&reference, profile, samples);
                print_row(&format!("{name} | {profile_name}"), samples, &comparison);
            }
        }
    }
    println!();
    println!("| scene | pixels | spp | CPU s | µs per camera sample |");
    println!("|---|---|---|---|---|");
    let mut reference = volumetric::read("sphere_marble").scene;
    (reference.film.width, reference.film.height) = (128, 128);
    time("tests/data/volumetric/sphere_marble.toml", reference, 64)?;
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/marble-sphere.toml");
    time("scenes/marble-sphere.toml", read_scene(&path)?, 64)
}

fn print_row(start: &str, samples: u64, comparison: &Comparison) {
    let bias = [0, 1, 2].map(|c| {
        let (bias, sigma) = comparison.bias(c);
        format!(
            "{:.3} against {:.3} ({:+.1} ± {:.1} %)",
            comparison.object_mean[c],
            comparison.reference_mean[c],
            100.0 * bias,
            100.0 * sigma
        )
    });
    println!(
        "| {start} | {samples} | {:.4} | {:.4} | {} |",
        comparison.relative_mse,
        comparison.relative_mse_of_picture,
        bias.join(" / ")
    );
}

fn time(name: &str, scene: alabaster::scene::Scene, samples: u64) -> Result<(), Box<dyn Error>> {
    let pixels = u64::from(scene.film.width) * u64::from(scene.film.height);
    let size = format!("{} × {}", scene.film.width, scene.film.height);
    let renderer = Renderer::new(scene, options(), |geometry| EmbreeCaster::new(geometry, 1))?;
    let (_, seconds) = volumetric::render(&renderer, samples);
    let microseconds = 1e6 * seconds / (pixels * samples) as f64;
    println!("| {name} | {size} | {samples} | {seconds:.2} | {microseconds:.2} |");
    Ok(())
}
