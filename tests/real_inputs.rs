//! Models and environments of others: all of them load and render, and none gains or loses light.

mod common;
#[path = "common/program.rs"]
#[allow(dead_code)]
mod program;

use std::path::{Path, PathBuf};
use std::time::Instant;

use alabaster::film::exr::read_picture;
use alabaster::radiometry::Rgb;
use alabaster::scene::{Camera, ColorInput, Environment, FilmSettings, Filter, Scene, read_scene};
use alabaster::transport::Counters;
use common::assets::{assets, files};
use common::scenes::{Statistics, body, renderer};
use program::run;

/// Requires an extension that is not supported.
const UNSUPPORTED: &str = "IridescenceSuzanne.glb";

fn models(assets: &Path) -> Vec<PathBuf> {
    ["meshes", "khronos", "gltf-scatter"]
        .iter()
        .flat_map(|folder| files(&assets.join(folder), &["glb", "gltf"]))
        .filter(|path| !path.ends_with(UNSUPPORTED))
        .collect()
}

/// Renders with the program at 32×32, 4 samples a pixel; the picture must be finite and not black.
fn renders(scene: &Path) {
    let folder = tempfile::tempdir().unwrap();
    let size = ["--width", "32", "--height", "32", "--spp", "4", "--json"];
    let arguments = [&["render", scene.to_str().unwrap(), "-o", "out.exr"], &size[..]].concat();
    let result = run(folder.path(), &arguments);
    assert_eq!(result.code, 0, "{}: {result:?}", scene.display());
    let report: serde_json::Value = serde_json::from_str(&result.stdout).unwrap();
    assert_eq!(report["nonfinite"], 0, "{}: {report}", scene.display());
    let picture = read_picture(&folder.path().join("out.exr")).unwrap();
    assert!(picture.pixels.iter().all(|pixel| pixel.is_finite() && pixel.min_component() >= 0.0));
    let lit = picture.pixels.iter().filter(|pixel| !pixel.is_black()).count();
    assert!(2 * lit > picture.pixels.len(), "{}: only {lit} pixels see light", scene.display());
}

#[test]
fn every_model_renders() {
    let Some(assets) = assets() else { return };
    for path in models(&assets) {
        renders(&path);
    }
    let folder = tempfile::tempdir().unwrap();
    let refused = assets.join("khronos").join(UNSUPPORTED);
    run(folder.path(), &["render", refused.to_str().unwrap(), "-o", "out.exr"])
        .is_refused("KHR_materials_iridescence");
}

#[test]
fn every_environment_lights_a_model() {
    let Some(assets) = assets() else { return };
    for map in files(&assets.join("env"), &["hdr", "exr"]) {
        let folder = tempfile::tempdir().unwrap();
        let scene = folder.path().join("scene.toml");
        let text = format!(
            "[[object]]\ngltf = '{}'\nmaterial = 'skin'\n\
             [material.skin]\ntype = 'translucent'\nalbedo = 'base-color'\nmean_free_path = 0.001\n\
             [environment]\nimage = '{}'\n",
            assets.join("meshes/leeperrysmith-head-textured.glb").display(),
            map.display()
        );
        std::fs::write(&scene, text).unwrap();
        renders(&scene);
    }
}

/// The scene in nothing but uniform light of radiance 1.
fn in_uniform_light(mut scene: Scene) -> Scene {
    scene.lights.clear();
    scene.materials.iter_mut().for_each(|m| m.emission = ColorInput::constant(Rgb::ZERO));
    scene.environment = Some(Environment::Constant(Rgb::ONE));
    scene.film = FilmSettings { width: 32, height: 32, filter: Filter::Box };
    scene
}

/// Mean over the channels of every sample of the picture.
fn samples(scene: Scene, per_pixel: u64) -> Statistics {
    let renderer = renderer(scene);
    let film = renderer.scene().film;
    let (mut counters, mut statistics) = (Counters::default(), Statistics::default());
    for y in 0..film.height {
        for x in 0..film.width {
            for sample in 0..per_pixel {
                let radiance = renderer.sample(x, y, sample, &mut counters);
                assert!(radiance.is_finite(), "not finite at ({x}, {y})");
                statistics.add(f64::from(radiance.mean()));
            }
        }
    }
    statistics
}

/// In uniform light of radiance 1 nothing can look brighter than 1.
#[test]
fn no_model_gains_light() {
    let Some(assets) = assets() else { return };
    for path in models(&assets) {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let seen = samples(in_uniform_light(read_scene(&path).unwrap()), 16);
        let (mean, sigma) = (seen.mean(), seen.standard_error());
        println!("{name}: {mean:.4} ± {sigma:.4}, brightest sample {:.2}", seen.max);
        // Rounding of products along a path of some hundred factors leaves a few 1e-6.
        assert!(mean > 0.0 && mean <= 1.0 + 3.0 * sigma + 1e-5, "{name}: {mean} ± {sigma}");
    }
}

/// A skull that absorbs nothing cannot be told from the uniform light around it.
#[test]
fn the_skull_vanishes_in_uniform_light() {
    let Some(assets) = assets() else { return };
    let skull = read_scene(&assets.join("meshes/skull-100k.glb")).unwrap();
    for eta in [1.0, 1.33, 1.5, 1.0 / 1.33] {
        for roughness in [0.0, 0.5] {
            let begin = Instant::now();
            let mut scene = in_uniform_light(skull.clone());
            // 2 mm, while the bone is 1 to 10 mm thick; the camera so close that the skull fills most.
            scene.materials = vec![body(eta, roughness, 0.002)];
            scene.instances.iter_mut().for_each(|instance| instance.material = 0);
            scene.camera = Camera { vertical_fov: 0.6 * scene.camera.vertical_fov, ..scene.camera };
            let seen = samples(scene, 4);
            let (mean, sigma) = (seen.mean(), seen.standard_error());
            println!(
                "eta {eta:.3} roughness {roughness}: {mean:.5} ± {sigma:.5}, brightest sample {:.2}, {:.1} s",
                seen.max,
                begin.elapsed().as_secs_f32()
            );
            assert!((mean - 1.0).abs() < 3.0 * sigma + 1e-5, "{mean} ± {sigma}");
        }
    }
}
