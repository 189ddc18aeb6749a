//! What share of a render's time is spent in ray queries.
//!
//! `cargo run --release --example time_in_embree [SCENE]`, by default `scenes/alabaster.toml`, on one thread.
//!
//! A timer around every query would take as long as the query. So all queries of a render are recorded once,
//! in their order, by a ray caster that passes them on. Then the render without the recorder and the replay of
//! the record are timed in turn; the share is the quotient of the two. The replay reads its rays from memory one
//! after another and has the caches to itself, where the render's shading also uses them, so the true
//! share is rather a little higher. Processor time of the thread; the least of several rounds.

#[path = "../tests/common"]
#[allow(dead_code)]
mod common {
    pub mod cpu_time;
    pub mod scenes;
}

use std::env;
use std::error::Error;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use alabaster::raycast::embree::EmbreeCaster;
use alabaster::raycast::{DistanceQuery, Hit, Ray, RayCaster};
use alabaster::scene::{Scene, read_scene};
use alabaster::transport::{Counters, Renderer};
use common::cpu_time::thread_seconds;
use common::scenes::options;

const SIDE: u32 = 128;
const SAMPLES: u64 = 16;
const ROUNDS: u32 = 5;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Closest,
    Occluded,
    /// All hits with an instance.
    AllHits(u32),
}

type Choice = fn(Kind) -> bool;

struct Query {
    kind: Kind,
    ray: Ray,
}

/// Passes queries on and keeps a copy.
struct Recorder {
    caster: EmbreeCaster,
    queries: Mutex<Vec<Query>>,
}

impl Recorder {
    fn record(&self, kind: Kind, ray: &Ray) {
        self.queries.lock().unwrap_or_else(PoisonError::into_inner).push(Query { kind, ray: *ray });
    }
}

impl RayCaster for Recorder {
    fn closest(&self, ray: &Ray) -> Option<Hit> {
        self.record(Kind::Closest, ray);
        self.caster.closest(ray)
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.record(Kind::Occluded, ray);
        self.caster.occluded(ray)
    }

    fn all_hits(&self, ray: &Ray, instance: u32, hits: &mut Vec<Hit>) {
        self.record(Kind::AllHits(instance), ray);
        self.caster.all_hits(ray, instance, hits);
    }

    fn distance_to_nearest(&self, query: &DistanceQuery, instance: u32) -> f32 {
        self.caster.distance_to_nearest(query, instance)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/alabaster.toml");
    let path = env::args_os().nth(1).map_or(default, PathBuf::from);
    let mut scene = read_scene(&path)?;
    (scene.film.width, scene.film.height) = (SIDE, SIDE);

    let queries = record(scene.clone())?;
    let renderer = Renderer::new(scene, options(), |geometry| EmbreeCaster::new(geometry, 1))?;
    let of = |wanted: Choice| queries.iter().filter(move |query| wanted(query.kind));
    let least =
        |mut run: Box<dyn FnMut() + '_>| (0..ROUNDS).map(|_| seconds(&mut *run)).fold(f64::MAX, f64::min);
    let render = least(Box::new(|| render(&renderer)));
    let caster = renderer.caster();
    let all = least(Box::new(|| replay(caster, queries.iter())));

    let samples = (u64::from(SIDE * SIDE) * SAMPLES) as f64;
    println!("{}: {SIDE} × {SIDE} pixels, {SAMPLES} samples each", path.display());
    println!("render: {:.0} ns per camera sample", 1e9 * render / samples);
    println!(
        "queries: {:.0} ns per camera sample, {:.1} % of the render",
        1e9 * all / samples,
        100.0 * all / render
    );
    let kinds: [(&str, Choice); 3] = [
        ("nearest hit", |kind| kind == Kind::Closest),
        ("occlusion", |kind| kind == Kind::Occluded),
        ("all hits of a probe", |kind| matches!(kind, Kind::AllHits(_))),
    ];
    for (name, wanted) in kinds {
        let count = of(wanted).count();
        if count > 0 {
            let time = least(Box::new(|| replay(caster, of(wanted))));
            println!(
                "  {name:20} {:5.2} per camera sample, {:4.0} ns each, {:4.1} % of the render",
                count as f64 / samples,
                1e9 * time / count as f64,
                100.0 * time / render
            );
        }
    }
    Ok(())
}

fn record(scene: Scene) -> Result<Vec<Query>, Box<dyn Error>> {
    let renderer = Renderer::new(scene, options(), |geometry| {
        Ok(Recorder { caster: EmbreeCaster::new(geometry, 1)?, queries: Mutex::default() })
    })?;
    render(&renderer);
    let recorded = &mut *renderer.caster().queries.lock().unwrap_or_else(PoisonError::into_inner);
    Ok(std::mem::take(recorded))
}

fn render<C: RayCaster>(renderer: &Renderer<C>) {
    let mut counters = Counters::default();
    for y in 0..SIDE {
        for x in 0..SIDE {
            for sample in 0..SAMPLES {
                black_box(renderer.sample(x, y, sample, &mut counters));
            }
        }
    }
}

fn replay<'a>(caster: &EmbreeCaster, queries: impl Iterator<Item = &'a Query>) {
    let mut hits = Vec::new();
    for Query { kind, ray } in queries {
        match kind {
            Kind::Closest => drop(black_box(caster.closest(ray))),
            Kind::Occluded => drop(black_box(caster.occluded(ray))),
            Kind::AllHits(instance) => {
                caster.all_hits(ray, *instance, &mut hits);
                black_box(hits.len());
            }
        }
    }
}

fn seconds(run: &mut dyn FnMut()) -> f64 {
    let start = thread_seconds();
    run();
    thread_seconds() - start
}
