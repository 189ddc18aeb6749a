//! The contest: every ray caster on the same rays, taking turns, so that what slows the machine down slows all of them.

use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use thiserror::Error;

use super::Kind;
use super::agreement::Agreement;
use super::record::{Query, Recorder, Recording, record};
use super::replay::{Spread, seconds, seconds_on_all_threads};
use crate::film::{Film, FilmError};
use crate::raycast::bvh::BvhCaster;
#[cfg(feature = "embree")]
use crate::raycast::embree::EmbreeCaster;
use crate::raycast::obvhs::ObvhsCaster;
use crate::raycast::{Backend, Hit, RayCaster};
use crate::scene::{FilmSettings, Scene};
use crate::transport::{RenderError, RenderOptions, Renderer};

/// How much is measured.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Rays of each kind, at most.
    pub rays: usize,
    /// Turns of each caster.
    pub rounds: usize,
    /// Rays of all kinds together whose hits are compared, at least; those that are raced on are in any case.
    pub compared: u64,
    /// How scenes are rendered.
    pub options: RenderOptions,
}

/// Why there was no contest.
#[derive(Debug, Error)]
pub enum ContestError {
    /// The scene cannot be rendered.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// There is no film for the picture.
    #[error(transparent)]
    Film(#[from] FilmError),
}

/// What was measured.
pub struct Results {
    /// Triangles, those of instances counted once.
    pub triangles: usize,
    /// Rays by kind; kinds of which the scene has some.
    pub rays: Vec<(Kind, usize)>,
    /// Samples of the picture that are rendered: one in each pixel.
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
    render: Box<dyn Fn() -> Result<f64, FilmError> + 'a>,
    agree: OnRays<'a, Agreement>,
}

/// What is found of rays of a kind.
type OnRays<'a, T> = Box<dyn Fn(Kind, &[Query]) -> T + 'a>;

/// Holds the contest. `advance` is told of every step, and of how many there are.
///
/// # Errors
/// If the scene cannot be rendered, or there is no memory for its film.
pub fn contest(
    scene: &Scene,
    settings: &Settings,
    advance: &dyn Fn(usize, usize),
) -> Result<Results, ContestError> {
    Film::new(scene.film.width, scene.film.height)?;
    let scene = &Scene { film: fitted(scene.film, settings.rays), ..scene.clone() };
    // Which caster answers does not matter; this one is in every build.
    let source = Renderer::new(scene.clone(), settings.options, |geometry| {
        BvhCaster::new(geometry).map(Recorder::new)
    })?;
    let recording = record(&source, settings.rays);
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
    let entrants = [
        #[cfg(feature = "embree")]
        entrant(Backend::Embree, &embree, reference, (reference.build_time(), reference.bytes())),
        entrant(Backend::Bvh, &bvh, reference, (bvh.caster().build_time(), bvh.caster().bytes())),
        entrant(Backend::Obvhs, &obvhs, reference, (obvhs.caster().build_time(), obvhs.caster().bytes())),
    ];
    let kinds: Vec<Kind> = Kind::NAMES
        .into_iter()
        .map(|(_, kind)| kind)
        .filter(|kind| !recording.of(*kind).is_empty())
        .collect();
    let parts = settings.compared.div_ceil(recording.len()).max(1) as usize;
    let steps = settings.rounds * (kinds.len() + 1) + parts;
    let mut step = 0;
    let mut advance = || {
        step += 1;
        advance(step.min(steps), steps);
    };
    let turns = race(&entrants, &recording, &kinds, settings.rounds, &mut advance)?;
    let rays = kinds.iter().map(|kind| (*kind, recording.of(*kind).len())).collect();
    let contestants = entrants.iter().zip(&turns).map(|(entrant, own)| Contestant {
        backend: entrant.backend,
        build_time: entrant.build_time,
        bytes: entrant.bytes,
        speeds: speeds(&kinds, &recording, own, &turns[0]),
        render_seconds: Spread::of(&own.renders),
        render_ratio: ratio(&turns[0].renders, &own.renders),
        agreement: Agreement::default(),
    });
    let mut contestants: Vec<_> = contestants.collect();
    let compared = compare(&entrants, recording, &source, settings, &mut advance);
    for (contestant, agreement) in contestants.iter_mut().zip(compared) {
        contestant.agreement = agreement;
    }
    Ok(Results {
        triangles: scene.meshes.iter().map(|mesh| mesh.triangles.len()).sum(),
        samples: u64::from(scene.film.width) * u64::from(scene.film.height),
        rays,
        contestants,
    })
}

/// The film, halved until it has no more pixels than there are to be `rays`.
fn fitted(mut film: FilmSettings, rays: usize) -> FilmSettings {
    while u64::from(film.width) * u64::from(film.height) > rays.max(1) as u64 {
        (film.width, film.height) = (film.width.div_ceil(2), film.height.div_ceil(2));
    }
    film
}

fn entrant<'a, C: RayCaster>(
    backend: Backend,
    renderer: &'a Renderer<C>,
    reference: &'a impl RayCaster,
    (build_time, bytes): (Duration, usize),
) -> Entrant<'a> {
    let caster = renderer.caster();
    Entrant {
        backend,
        build_time,
        bytes,
        cast: Box::new(move |kind, queries| seconds(caster, kind, queries)),
        cast_on_all: Box::new(move |kind, queries| seconds_on_all_threads(caster, kind, queries)),
        render: Box::new(move || render(renderer)),
        agree: Box::new(move |kind, queries| {
            let corners = |hit: &Hit| renderer.triangle(hit);
            Agreement::of(reference, caster, &corners, kind, queries)
        }),
    }
}

/// Seconds for a sample in every pixel, on all threads.
fn render<C: RayCaster>(renderer: &Renderer<C>) -> Result<f64, FilmError> {
    let FilmSettings { width, height, .. } = renderer.scene().film;
    let mut film = Film::new(width, height)?;
    let start = Instant::now();
    renderer.expose(&mut film, 0..1, &AtomicBool::new(false), &|_| {});
    Ok(start.elapsed().as_secs_f64())
}

/// Seconds of one caster, by turn.
#[derive(Clone, Default)]
struct Turns {
    /// By kind: on one thread, and on all.
    casts: Vec<[Vec<f64>; 2]>,
    renders: Vec<f64>,
}

/// The turns of each.
fn race(
    entrants: &[Entrant],
    recording: &Recording,
    kinds: &[Kind],
    rounds: usize,
    advance: &mut dyn FnMut(),
) -> Result<Vec<Turns>, FilmError> {
    let casts = vec![Default::default(); kinds.len()];
    let mut turns = vec![Turns { casts, renders: vec![] }; entrants.len()];
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
            turns.renders.push((entrant.render)()?);
        }
        advance();
    }
    Ok(turns)
}

/// How the answers of each compare with those of the first: about `recording` and, until there are as many as wanted, further rays of
/// `source`.
fn compare(
    entrants: &[Entrant],
    mut recording: Recording,
    source: &Renderer<Recorder<BvhCaster>>,
    settings: &Settings,
    advance: &mut dyn FnMut(),
) -> Vec<Agreement> {
    let mut agreements = vec![Agreement::default(); entrants.len()];
    let mut compared = 0;
    loop {
        for (entrant, agreement) in entrants.iter().zip(&mut agreements).skip(1) {
            for (_, kind) in Kind::NAMES {
                *agreement = std::mem::take(agreement).and((entrant.agree)(kind, recording.of(kind)));
            }
        }
        compared += recording.len();
        advance();
        if compared >= settings.compared {
            return agreements;
        }
        recording = record(source, settings.rays);
    }
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
