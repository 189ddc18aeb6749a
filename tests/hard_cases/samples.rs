//! Many samples of many scenes.

use std::path::Path;
use std::time::Instant;

use alabaster::scene::{Method, Scene, read_scene};
use alabaster::transport::{Counters, RenderOptions, Renderer};
use rayon::prelude::*;

use crate::common::assets::files;
use crate::common::backends::MODES;
use crate::common::bodies::bodies;
use crate::common::scenes::{body, caster, furnace};
use crate::lights::under_uneven_sky;
use crate::record::record;

/// Samples in a run of the suite.
const SAMPLES: f64 = 4e5;

/// The scenes that come with the program, and the bodies of the furnace under an uneven sky.
fn scenes() -> Vec<(String, Scene)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let name = |path: &Path| path.file_stem().unwrap().to_string_lossy().into_owned();
    let mut scenes: Vec<_> =
        files(&folder, &["toml"]).iter().map(|path| (name(path), read_scene(path).unwrap())).collect();
    for found in bodies() {
        for roughness in [0.0, 0.4] {
            let name = format!("{} σ_t {} roughness {roughness}", found.name, found.sigma_t);
            let material = body(1.5, roughness, 1.0 / found.sigma_t);
            scenes.push((name, under_uneven_sky(furnace(found.mesh.clone(), material))));
        }
    }
    scenes
}

/// Takes `count` samples of `scene`, spread over its picture: how many are no numbers, and what happened on the way.
fn sample(scene: &Scene, method: Method, count: u64) -> (u64, Counters) {
    let options = RenderOptions { method, ..RenderOptions::of(scene, 9) };
    let renderer = Renderer::new(scene.clone(), options, caster).unwrap();
    let (width, height) = (u64::from(scene.film.width), u64::from(scene.film.height));
    // Coprime to the number of pixels of any picture whose sides are powers of two and three.
    let pixel = |index: u64| index.wrapping_mul(1_000_003) % (width * height);
    const PART: u64 = 1 << 12;
    (0..count.div_ceil(PART))
        .into_par_iter()
        .map(|part| {
            let (mut nonfinite, mut counters) = (0, Counters::default());
            for index in part * PART..((part + 1) * PART).min(count) {
                let (pixel, sample) = (pixel(index), index / (width * height));
                let (x, y) = ((pixel % width) as u32, (pixel / width) as u32);
                nonfinite += u64::from(!renderer.sample(x, y, sample, &mut counters).is_finite());
            }
            (nonfinite, counters)
        })
        .reduce(Default::default, |(n, mut all), (m, counters)| {
            all.merge(&counters);
            (n + m, all)
        })
}

#[test]
fn every_sample_is_a_number() {
    let asked = std::env::var("ALABASTER_SAMPLES").ok().map(|text| text.parse::<f64>().unwrap());
    let methods = [Method::Bssrdf, Method::Walk, Method::Diffuse];
    let scenes = scenes();
    let each = (asked.unwrap_or(SAMPLES) / (scenes.len() * methods.len() * MODES.len()) as f64).ceil() as u64;
    let (mut taken, mut nonfinite) = (0, 0);
    for (name, mut scene) in scenes {
        for (mode, method) in MODES.into_iter().flat_map(|mode| methods.map(|method| (mode, method))) {
            scene.render.color_mode = mode;
            let begin = Instant::now();
            let (found, counters) = sample(&scene, method, each);
            let rate = each as f64 / begin.elapsed().as_secs_f64();
            println!(
                "{name} by {}, {mode:?}: {found} of {each} no numbers, {} rejected, {} capped, {rate:.0} samples/s",
                method.name(),
                counters.rejected,
                counters.capped_paths
            );
            taken += each;
            nonfinite += found;
        }
    }
    assert_eq!(nonfinite, 0);
    record("every_sample_is_a_number", format!("{nonfinite} of {:.0e} samples are no numbers", taken as f64));
}
