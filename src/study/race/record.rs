//! What a path tracer asks a ray caster.

use std::sync::{Mutex, MutexGuard, PoisonError};

use super::Kind;
use crate::raycast::{DistanceQuery, Hit, Ray, RayCaster};
use crate::scene::FilmSettings;
use crate::transport::{Counters, Renderer};

/// A ray and what it is cast for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Query {
    /// The ray.
    pub ray: Ray,
    /// The instance that a probe looks for; 0 for other kinds.
    pub instance: u32,
}

/// Rays by kind, in the order in which they were cast.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    queries: [Vec<Query>; 4],
}

impl Recording {
    /// The rays of a kind.
    pub fn of(&self, kind: Kind) -> &[Query] {
        &self.queries[kind as usize]
    }

    /// Rays of all kinds.
    pub fn len(&self) -> u64 {
        self.queries.iter().map(|queries| queries.len() as u64).sum()
    }

    /// True if there is no ray.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// True if there are `limit` rays of each kind of which there are any.
    fn is_full(&self, limit: usize) -> bool {
        self.queries.iter().all(|queries| queries.is_empty() || queries.len() >= limit)
    }
}

/// A ray caster that keeps what it is asked.
pub struct Recorder<C> {
    inner: C,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    recording: Recording,
    /// The next ray is that of a camera.
    begins: bool,
    /// Rays of each kind that are kept.
    limit: usize,
    /// Samples that were rendered so far.
    samples: u64,
}

impl<C> Recorder<C> {
    /// Asks `inner`; keeps nothing before [`record`].
    pub fn new(inner: C) -> Self {
        Self { inner, state: Mutex::default() }
    }

    /// What is asked.
    pub fn inner(&self) -> &C {
        &self.inner
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn keep(&self, kind: Option<Kind>, ray: &Ray, instance: u32) {
        let mut state = self.state();
        let begins = std::mem::take(&mut state.begins);
        let kind = kind.unwrap_or(if begins { Kind::Camera } else { Kind::Bounce });
        let limit = state.limit;
        let queries = &mut state.recording.queries[kind as usize];
        if queries.len() < limit {
            queries.push(Query { ray: *ray, instance });
        }
    }
}

impl<C: RayCaster> RayCaster for Recorder<C> {
    fn closest(&self, ray: &Ray) -> Option<Hit> {
        self.keep(None, ray, 0);
        self.inner.closest(ray)
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.keep(Some(Kind::Shadow), ray, 0);
        self.inner.occluded(ray)
    }

    fn all_hits(&self, ray: &Ray, instance: u32, hits: &mut Vec<Hit>) {
        self.keep(Some(Kind::Probe), ray, instance);
        self.inner.all_hits(ray, instance, hits);
    }

    fn distance_to_nearest(&self, query: &DistanceQuery, instance: u32) -> f32 {
        self.inner.distance_to_nearest(query, instance)
    }
}

/// Renders samples of every pixel in turn, `limit` of them and then as many again at most until there are `limit` rays of every kind that
/// there is: on one thread, so that the rays are the same each time. It goes on where it ended before.
pub fn record<C: RayCaster>(renderer: &Renderer<Recorder<C>>, limit: usize) -> Recording {
    let recorder = renderer.caster();
    let first = recorder.state().samples;
    *recorder.state() = State { limit, ..State::default() };
    let film = renderer.scene().film;
    let mut counters = Counters::default();
    for path in 0..2 * limit as u64 {
        if path >= limit as u64 && recorder.state().recording.is_full(limit) {
            break;
        }
        let Sample { x, y, index } = Sample::spread(&film, first + path);
        recorder.state().begins = true;
        renderer.sample(x, y, index, &mut counters);
        recorder.state().samples = first + path + 1;
    }
    std::mem::take(&mut recorder.state().recording)
}

/// A sample of a pixel.
pub struct Sample {
    /// Column of the pixel.
    pub x: u32,
    /// Row of the pixel.
    pub y: u32,
    /// Its number among those of the pixel.
    pub index: u64,
}

impl Sample {
    /// The `path`-th one where each pixel in turn gets one, in an order without pattern.
    pub fn spread(film: &FilmSettings, path: u64) -> Self {
        let pixels = u64::from(film.width) * u64::from(film.height);
        // About the golden section, and no divisor of the number of pixels.
        let stride = (pixels as f64 * 0.618) as u64 | 1;
        let pixel = (path % pixels).wrapping_mul(stride) % pixels;
        let (x, y) = (pixel % u64::from(film.width), pixel / u64::from(film.width));
        Self { x: x as u32, y: y as u32, index: path / pixels }
    }
}
