//! The kernel of each scene in `scenes/` against the generic one, and against that by wavelength: nanoseconds of processor time per sample on one
//! thread, taking turns, so that what slows the machine down slows all. The bits of the first two are the same (`tests/kernels_agree.rs`).
//!
//! `cargo bench --bench kernels [-- NAME...]`: only those scenes.

#[path = "../tests/common/cpu_time.rs"]
#[allow(dead_code)]
mod cpu_time;

use std::hint::black_box;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use alabaster::film::Film;
use alabaster::plan::Kernel;
use alabaster::raycast::embree::EmbreeCaster;
use alabaster::scene::{ColorMode, read_scene};
use alabaster::transport::{RenderOptions, Renderer};

/// Side of the picture.
const SIDE: u32 = 64;
/// Turns of each kernel.
const TURNS: u64 = 41;
/// Samples of every pixel in a turn.
const SAMPLES: u64 = 8;

fn main() {
    rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global().unwrap();
    let wanted: Vec<String> = std::env::args().skip(1).filter(|name| !name.starts_with('-')).collect();
    println!(
        "| scene | kernel | ns per sample | generic / chosen: median (8th to 92nd percentile) | by wavelength / chosen |"
    );
    println!("|---|---|---|---|---|");
    for name in
        ["alabaster", "candle", "furnace-sphere", "jade", "marble-sphere", "milk", "soap", "glass", "table"]
    {
        if wanted.is_empty() || wanted.iter().any(|wanted| wanted == name) {
            contest(name);
        }
    }
}

fn contest(name: &str) {
    let mut chosen = renderer(name, ColorMode::Rgb);
    let spectral = renderer(name, ColorMode::Spectral);
    let kernel = chosen.kernel();
    let (mut nanoseconds, mut ratios, mut by_wavelength) = (Vec::new(), Vec::new(), Vec::new());
    for turn in 0..TURNS {
        let specialised = seconds(&chosen, turn * SAMPLES);
        chosen.use_kernel(Kernel::Generic);
        let generic = seconds(&chosen, turn * SAMPLES);
        chosen.use_kernel(kernel);
        nanoseconds.push(specialised / (f64::from(SIDE * SIDE) * SAMPLES as f64) * 1e9);
        ratios.push(generic / specialised);
        by_wavelength.push(seconds(&spectral, turn * SAMPLES) / specialised);
    }
    let at = |values: &mut Vec<f64>, share: f64| {
        values.sort_by(f64::total_cmp);
        values[((values.len() - 1) as f64 * share).round() as usize]
    };
    println!(
        "| {name} | {} | {:.0} | {:.3} ({:.3} to {:.3}) | {:.2} ({:.2} to {:.2}) |",
        kernel.name(),
        at(&mut nanoseconds, 0.5),
        at(&mut ratios, 0.5),
        at(&mut ratios, 0.08),
        at(&mut ratios, 0.92),
        at(&mut by_wavelength, 0.5),
        at(&mut by_wavelength, 0.08),
        at(&mut by_wavelength, 0.92)
    );
}

fn seconds(renderer: &Renderer<EmbreeCaster>, sample: u64) -> f64 {
    let mut film = Film::new(SIDE, SIDE).unwrap();
    let start = cpu_time::thread_seconds();
    black_box(renderer.expose(&mut film, sample..sample + SAMPLES, &AtomicBool::new(false), &|_| ()));
    cpu_time::thread_seconds() - start
}

/// Of a scene file, or a mesh alone.
fn renderer(name: &str, mode: ColorMode) -> Renderer<EmbreeCaster> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let file = [format!("{name}.toml"), format!("{name}.glb")].map(|file| folder.join(file));
    let mut scene = read_scene(file.iter().find(|file| file.exists()).unwrap()).unwrap();
    (scene.film.width, scene.film.height) = (SIDE, SIDE);
    scene.render.color_mode = mode;
    let options = RenderOptions::of(&scene, 1);
    Renderer::new(scene, options, |geometry| EmbreeCaster::new(geometry, 1)).unwrap()
}
