//! Camera samples per second on one thread: the main scene, and the marble sphere.

use std::hint::black_box;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use alabaster::film::Film;
use alabaster::plan::Forces;
use alabaster::raycast::embree::EmbreeCaster;
use alabaster::scene::{Method, ProfileChoice, read_scene};
use alabaster::transport::{RenderOptions, Renderer};
use criterion::{Criterion, Throughput};

/// Side of the picture: a sample of each of its pixels is one iteration, so that every iteration
/// meets object and background in the proportion of the picture.
const SIDE: u32 = 64;

fn main() {
    rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global().unwrap();
    let mut criterion = Criterion::default().sample_size(20).configure_from_args();
    let mut group = criterion.benchmark_group("render");
    group.throughput(Throughput::Elements(u64::from(SIDE * SIDE)));
    for name in ["alabaster", "marble-sphere"] {
        let renderer = renderer(name);
        let mut film = Film::new(SIDE, SIDE).unwrap();
        let mut sample = 0;
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let one = sample..sample + 1;
                black_box(renderer.expose(&mut film, one, &AtomicBool::new(false), &|_| ()));
                sample += 1;
            });
        });
    }
    group.finish();
    criterion.final_summary();
}

fn renderer(name: &str) -> Renderer<EmbreeCaster> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(format!("{name}.toml"));
    let mut scene = read_scene(&path).unwrap();
    (scene.film.width, scene.film.height) = (SIDE, SIDE);
    let options = RenderOptions {
        seed: 1,
        method: Method::Bssrdf,
        accuracy: 0.02,
        profile: ProfileChoice::Auto,
        max_depth: 0,
        spheres: true,
        guiding: true,
        similarity: false,
        forces: Forces::default(),
    };
    Renderer::new(scene, options, |geometry| EmbreeCaster::new(geometry, 1)).unwrap()
}
