//! The tables of `docs/energy.md`: what the area integral makes of a white furnace, and what the planar
//! profile by itself would.
//!
//! `cargo run --release --example energy_table [MODEL.glb]`; a model adds a row.

#[path = "../tests/common"]
#[allow(dead_code)]
mod common {
    pub mod bodies;
    pub mod scenes;
}

use std::env;
use std::error::Error;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use alabaster::diffusion::NormalizedDiffusion;
use alabaster::film::Film;
use alabaster::math::sampler::HashGenerator;
use alabaster::plan::{Abilities, Plan, Request};
use alabaster::radiometry::Rgb;
use alabaster::raycast::embree::EmbreeCaster;
use alabaster::raycast::{Hit, Ray, RayCaster, RaycastError};
use alabaster::scene::{Method, Scene, read_scene};
use alabaster::transport::area_integral::AreaIntegral;
use alabaster::transport::spread::{Channels, Spread};
use alabaster::transport::world::World;
use common::bodies;
use common::scenes::{Statistics, furnace, in_furnace, renderer, white};
use rayon::prelude::*;

const SIDE: u32 = 64;
const SAMPLES: u64 = 32;
/// Lines of the area integral at each pixel, for the planar profile.
const LINES: u32 = 64;
const INDICES: [f32; 4] = [1.0, 1.33, 1.5, 1.0 / 1.33];
const ROUGHNESSES: [f32; 2] = [0.0, 0.5];

/// A body of the tables.
struct Row {
    name: String,
    scene: Scene,
    sigma_t: f32,
    indices: Vec<f32>,
    /// Mean that pbrt-v3's BSSRDF rendered of a like body with index 1.33 in its own white furnace.
    pbrt: &'static str,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut rows = rows();
    if let Some(model) = env::args_os().nth(1) {
        rows.push(model_row(Path::new(&model))?);
    }
    let furnaces: Vec<Vec<Furnace>> = rows.iter().map(furnaces).collect();
    print_summary(&rows, &furnaces);
    println!();
    print_means(&rows, &furnaces);
    Ok(())
}

fn furnaces(row: &Row) -> Vec<Furnace> {
    let pairs = row.indices.iter().flat_map(|&eta| ROUGHNESSES.map(|roughness| (eta, roughness)));
    pairs.map(|(eta, roughness)| Furnace::render(row, eta, roughness)).collect()
}

fn print_summary(rows: &[Row], furnaces: &[Vec<Furnace>]) {
    println!(
        "| body | σ_t, 1/m | planar profile: mean | largest pixel | pbrt-v3, mean | alabaster: mean farthest from 1 | pixel farthest from 1 |"
    );
    println!("|---|---|---|---|---|---|---|");
    for (row, furnaces) in rows.iter().zip(furnaces) {
        let planar = planar_profile(row);
        let (mean, sigma) = (planar.mean(), planar.standard_error());
        let Some(farthest) = furnaces.iter().max_by(|a, b| a.offset().total_cmp(&b.offset())) else {
            continue;
        };
        let pixel = furnaces.iter().map(|f| f.largest_offset).fold(0.0, f64::max);
        println!(
            "| {} | {} | {mean:.3} ± {sigma:.3} | {:.2} | {} | {} | {pixel:.3} |",
            row.name,
            row.sigma_t.round(),
            planar.max,
            row.pbrt,
            farthest.text()
        );
    }
}

fn print_means(rows: &[Row], furnaces: &[Vec<Furnace>]) {
    let pairs = INDICES.iter().flat_map(|eta| ROUGHNESSES.map(|roughness| (eta, roughness)));
    let columns: Vec<String> = pairs
        .map(|(eta, roughness)| format!("η {eta:.2}, {}", if roughness > 0.0 { "rough" } else { "smooth" }))
        .collect();
    println!("| body | σ_t, 1/m | {} |", columns.join(" | "));
    println!("|---|---|{}", "---|".repeat(columns.len()));
    for (row, furnaces) in rows.iter().zip(furnaces).filter(|(row, _)| row.indices == INDICES) {
        let cells: Vec<String> = furnaces.iter().map(Furnace::text).collect();
        println!("| {} | {} | {} |", row.name, row.sigma_t.round(), cells.join(" | "));
    }
}

fn rows() -> Vec<Row> {
    let pbrt = [
        "1.018",
        ".35",
        ".66",
        ".90",
        ".99",
        "1.015",
        "1.55",
        "1.76",
        "1.43",
        "1.60",
        "1.22",
        "79 (σ_t not recorded)",
        "79 (σ_t not recorded)",
    ];
    let mut rows: Vec<Row> =
        bodies::bodies().into_iter().zip(pbrt).map(|(body, pbrt)| row(body, &INDICES, pbrt)).collect();
    rows.push(row(bodies::bubble(), &[0.8], "not a number"));
    rows
}

fn row(body: bodies::Body, indices: &[f32], pbrt: &'static str) -> Row {
    let mut scene = furnace(body.mesh, white(1.0, 0.0, Rgb::splat(body.sigma_t)));
    (scene.film.width, scene.film.height) = (SIDE, SIDE);
    Row { name: body.name.into(), scene, sigma_t: body.sigma_t, indices: indices.to_vec(), pbrt }
}

/// A model from a file, its mean free path a fiftieth of its diagonal.
fn model_row(path: &Path) -> Result<Row, Box<dyn Error>> {
    let mut scene = read_scene(path)?;
    (scene.film.width, scene.film.height) = (SIDE, SIDE);
    let world = world(&scene)?;
    let sigma_t = 50.0 / world.diameter(0);
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(Row {
        name,
        scene: in_furnace(scene, white(1.0, 0.0, Rgb::splat(sigma_t))),
        sigma_t,
        indices: INDICES.to_vec(),
        pbrt: "",
    })
}

/// The scene, with the area integral in all that is translucent.
fn world(scene: &Scene) -> Result<World<EmbreeCaster>, RaycastError> {
    let request = Request { method: Method::Bssrdf, ..Request::from(&scene.subsurface) };
    World::new(scene.clone(), Plan::new(scene, &request).methods(), |geometry| EmbreeCaster::new(geometry, 1))
}

/// ∫_A R dA over the points that the camera sees, by the estimator that shares no energy.
fn planar_profile(row: &Row) -> Statistics {
    let world = world(&row.scene).expect("a scene in memory");
    let camera = row.scene.camera.rays(1.0);
    let pixels: Vec<f64> = (0..SIDE * SIDE)
        .into_par_iter()
        .filter_map(|pixel| {
            let on_film = [pixel % SIDE, pixel / SIDE].map(|i| (i as f32 + 0.5) / SIDE as f32);
            let ray = camera.ray(on_film, [0.5; 2]);
            let ray = Ray::new(ray.origin, ray.direction);
            let hit = world.caster().closest(&ray)?;
            Some(planar_energy_at(&world, &hit, &ray, row.sigma_t, u64::from(pixel)))
        })
        .collect();
    let mut mean = Statistics::default();
    pixels.iter().for_each(|&m| mean.add(m));
    mean
}

fn planar_energy_at(world: &World<EmbreeCaster>, hit: &Hit, ray: &Ray, sigma_t: f32, seed: u64) -> f64 {
    let point = world.surface::<{ Abilities::NONE.bits() }>(hit);
    let normal = point.geometric_normal;
    // The profile of a medium without absorption: planar albedo 1, whatever the index.
    let profile = NormalizedDiffusion::from_albedo(1.0, 1.0 / sigma_t);
    let integral = AreaIntegral {
        caster: world.caster(),
        geometric_normal: |hit: &Hit| world.geometric_normal(hit),
        instance: hit.instance,
        spread: &Spread::new([profile; 3], world.diameter(hit.instance)),
        channels: Channels::of(Rgb::ONE),
        position: point.position,
        position_error: point.error.max_element(),
        normal: if normal.dot(ray.direction) < 0.0 { normal } else { -normal },
    };
    let mut random = HashGenerator::new(seed);
    let mut found = Vec::new();
    for _ in 0..LINES {
        integral.crossings(&mut random, &mut found);
    }
    found.iter().map(|crossing| f64::from(crossing.weight[0])).sum::<f64>() / f64::from(LINES)
}

/// A picture in which everything should be 1.
struct Furnace {
    mean: f64,
    standard_error: f64,
    /// |x − 1| of the pixel where it is largest; noise included.
    largest_offset: f64,
}

impl Furnace {
    fn render(row: &Row, eta: f32, roughness: f32) -> Self {
        let scene = in_furnace(row.scene.clone(), white(eta, roughness, Rgb::splat(row.sigma_t)));
        let renderer = renderer(scene);
        let mut film = Film::new(SIDE, SIDE).expect("a small film");
        film.accumulate(
            0..SAMPLES,
            |x, y, sample, counters| renderer.sample(x, y, sample, counters),
            |_, _| (),
            &AtomicBool::new(false),
            |_| (),
        );
        let mut variance = 0.0;
        let mut means = Statistics::default();
        let mut largest_offset = 0.0_f64;
        for pixel in film.rows() {
            let mean = f64::from(pixel.mean()[0]);
            means.add(mean);
            largest_offset = largest_offset.max((mean - 1.0).abs());
            variance += pixel.variance_of_mean(0);
        }
        let standard_error = variance.sqrt() / f64::from(SIDE * SIDE);
        Self { mean: means.mean(), standard_error, largest_offset }
    }

    fn offset(&self) -> f64 {
        (self.mean - 1.0).abs()
    }

    fn text(&self) -> String {
        format!("{:.5} ± {:.5}", self.mean, self.standard_error)
    }
}
