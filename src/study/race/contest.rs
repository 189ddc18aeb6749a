//! The contest: every ray caster on the same rays, taking turns, so that what slows the machine down slows all of them.

use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::Kind;
use super::agreement::Agreement;
use super::record::{Query, Recorder, Recording, Sample, record};
use super::replay::{Spread, seconds, seconds_on_all_threads};
use crate::raycast::bvh::BvhCaster;
#[cfg(feature = "embree")]
use crate::raycast::embree::EmbreeCaster;
use crate::raycast::obvhs::ObvhsCaster;
use crate::raycast::{Backend, RayCaster};
use crate::scene::Scene;
use crate::transport::{Counters, RenderError, RenderOptions, Renderer};

/// How much is measured.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Rays of each kind, at most.
    pub rays: usize,
    /// Turns of each caster.
    pub rounds: usize,
    /// How scenes are rendered.
    pub options: RenderOptions,
}

/// What was measured.
pub struct Results {
    /// Triangles, those of instances counted once.
    pub triangles: usize,
    /// Rays by kind; kinds of which the scene has some.
    pub rays: Vec<(Kind, usize)>,
    /// Samples of the picture that are rendered.
    pub samples: u64,
    /// The casters; the first is the one that others are compared with.
    pub contestants: Vec<Contestant>,
}

/// What was measured of a caster.
pub struct Contestant {
    /// Which one.
    pub backend: Backend,
    /// How long it took to build.
    pub build_time: Duration,
    /// What it holds.
    pub bytes: usize,
    /// By kind of ray.
    pub speeds: Vec<Speed>,
    /// Seconds for [`Results::samples`], on all threads.
    pub render_seconds: Spread,
    /// How many times as fast as the first caster a picture is rendered.
    pub render_ratio: Spread,
    /// Its answers against those of the first.
    pub agreement: Agreement,
}

/// How fast rays of a kind are cast.
#[derive(Clone, Copy, Debug)]
pub struct Speed {
    /// What they are cast for.
    pub kind: Kind,
    /// Millions of rays per second, on one thread.
    pub one_thread: Spread,
    /// The same on all threads.
    pub all_threads: Spread,
    /// How many times as fast as the first caster, on one thread; in the same turn.
    pub ratio: Spread,
}

/// What can be asked of a caster of any kind. Behind the pointers whole recordings are replayed, not single rays.
struct Entrant<'a> {
    backend: Backend,
    build_time: Duration,
    bytes: usize,
    cast: OnRays<'a, f64>,
    cast_on_all: OnRays<'a, f64>,
    render: Box<dyn Fn() -> f64 + 'a>,
    agree: OnRays<'a, Agreement>,
}

/// What is found of rays of a kind.
type OnRays<'a, T> = Box<dyn Fn(Kind, &[Query]) -> T + 'a>;

/// Holds the contest. `advance` is told of every step, and of how many there are.
///
/// # Errors
/// If the scene cannot be rendered.
pub fn contest(
    scene: &Scene,
    settings: &Settings,
    advance: &dyn Fn(usize, usize),
) -> Result<Results, RenderError> {
    let recording = recording(scene, settings)?;
    let bvh = Renderer::new(scene.clone(), settings.options, BvhCaster::new)?;
    let obvhs = Renderer::new(scene.clone(), settings.options, ObvhsCaster::new)?;
    #[cfg(feature = "embree")]
    let embree = Renderer::new(scene.clone(), settings.options, |geometry| {
        EmbreeCaster::new(geometry, rayon::current_num_threads())
    })?;
    #[cfg(feature = "embree")]
    let reference = embree.caster();
    #[cfg(not(feature = "embree"))]
    let reference = bvh.caster();
    let film = scene.film;
    let samples = (u64::from(film.width) * u64::from(film.height)).min(settings.rays as u64);
    let entrants = [
        #[cfg(feature = "embree")]
        entrant(Backend::Embree, &embree, reference, samples, (reference.build_time(), reference.bytes())),
        entrant(Backend::Bvh, &bvh, reference, samples, (bvh.caster().build_time(), bvh.caster().bytes())),
        entrant(
            Backend::Obvhs,
            &obvhs,
            reference,
            samples,
            (obvhs.caster().build_time(), obvhs.caster().bytes()),
        ),
    ];
    let kinds: Vec<Kind> = Kind::NAMES
        .into_iter()
        .map(|(_, kind)| kind)
        .filter(|kind| !recording.of(*kind).is_empty())
        .collect();
    Ok(Results {
        triangles: scene.meshes.iter().map(|mesh| mesh.triangles.len()).sum(),
        samples,
        rays: kinds.iter().map(|kind| (*kind, recording.of(*kind).len())).collect(),
        contestants: measure(&entrants, &recording, &kinds, settings.rounds, advance),
    })
}

/// The rays of a scene. Which caster answers does not matter; this one is in every build.
fn recording(scene: &Scene, settings: &Settings) -> Result<Recording, RenderError> {
    let renderer = Renderer::new(scene.clone(), settings.options, |geometry| {
        BvhCaster::new(geometry).map(Recorder::new)
    })?;
    Ok(record(&renderer, settings.rays))
}

fn entrant<'a, C: RayCaster>(
    backend: Backend,
    renderer: &'a Renderer<C>,
    reference: &'a impl RayCaster,
    samples: u64,
    (build_time, bytes): (Duration, usize),
) -> Entrant<'a> {
    let caster = renderer.caster();
    Entrant {
        backend,
        build_time,
        bytes,
        cast: Box::new(move |kind, queries| seconds(caster, kind, queries)),
        cast_on_all: Box::new(move |kind, queries| seconds_on_all_threads(caster, kind, queries)),
        render: Box::new(move || render(renderer, samples)),
        agree: Box::new(move |kind, queries| Agreement::of(reference, caster, kind, queries)),
    }
}

/// Seconds for `samples`, spread over the picture, on all threads.
fn render<C: RayCaster>(renderer: &Renderer<C>, samples: u64) -> f64 {
    let start = Instant::now();
    (0..samples).into_par_iter().for_each_init(Counters::default, |counters, index| {
        let Sample { x, y, index } = Sample::spread(&renderer.scene().film, index);
        std::hint::black_box(renderer.sample(x, y, index, counters));
    });
    start.elapsed().as_secs_f64()
}

/// Seconds of one caster, by turn.
#[derive(Clone, Default)]
struct Turns {
    /// By kind: on one thread, and on all.
    casts: Vec<[Vec<f64>; 2]>,
    renders: Vec<f64>,
}

fn measure(
    entrants: &[Entrant],
    recording: &Recording,
    kinds: &[Kind],
    rounds: usize,
    advance: &dyn Fn(usize, usize),
) -> Vec<Contestant> {
    let casts = vec![Default::default(); kinds.len()];
    let mut turns = vec![Turns { casts, renders: vec![] }; entrants.len()];
    let steps = rounds * (kinds.len() + 1) + kinds.len();
    let mut step = 0;
    let mut advance = || {
        step += 1;
        advance(step, steps);
    };
    for _ in 0..rounds {
        for (index, kind) in kinds.iter().enumerate() {
            let queries = recording.of(*kind);
            for (entrant, turns) in entrants.iter().zip(&mut turns) {
                let [one, all] = &mut turns.casts[index];
                one.push((entrant.cast)(*kind, queries));
                all.push((entrant.cast_on_all)(*kind, queries));
            }
            advance();
        }
        for (entrant, turns) in entrants.iter().zip(&mut turns) {
            turns.renders.push((entrant.render)());
        }
        advance();
    }
    let mut agreements = vec![Agreement::default(); entrants.len()];
    for kind in kinds {
        for (entrant, agreement) in entrants.iter().zip(&mut agreements).skip(1) {
            let queries = recording.of(*kind);
            *agreement = std::mem::take(agreement).and((entrant.agree)(*kind, queries));
        }
        advance();
    }
    let first = turns[0].clone();
    entrants
        .iter()
        .zip(turns)
        .zip(agreements)
        .map(|((entrant, turns), agreement)| Contestant {
            backend: entrant.backend,
            build_time: entrant.build_time,
            bytes: entrant.bytes,
            speeds: speeds(kinds, recording, &turns, &first),
            render_seconds: Spread::of(&turns.renders),
            render_ratio: ratio(&first.renders, &turns.renders),
            agreement,
        })
        .collect()
}

fn speeds(kinds: &[Kind], recording: &Recording, turns: &Turns, first: &Turns) -> Vec<Speed> {
    let speed = |(index, kind): (usize, &Kind)| {
        let millions = 1e-6 * recording.of(*kind).len() as f64;
        let per_second =
            |seconds: &[f64]| Spread::of(&seconds.iter().map(|s| millions / s).collect::<Vec<_>>());
        let [one, all] = &turns.casts[index];
        Speed {
            kind: *kind,
            one_thread: per_second(one),
            all_threads: per_second(all),
            ratio: ratio(&first.casts[index][0], one),
        }
    };
    kinds.iter().enumerate().map(speed).collect()
}

/// `first` over `second`, turn by turn.
fn ratio(first: &[f64], second: &[f64]) -> Spread {
    Spread::of(&first.iter().zip(second).map(|(a, b)| a / b).collect::<Vec<_>>())
}
