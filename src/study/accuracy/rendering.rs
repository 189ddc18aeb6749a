//! Rendering the runs of a study.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

use super::plan::{Rate, Role, Series};
use super::store::{Point, Record, Run};
use crate::film::{Film, FilmError, Picture};
use crate::raycast::{Geometry, RayCaster, RaycastError};
use crate::scene::Scene;
use crate::transport::{Counters, RenderError, Renderer};

/// A pilot ends when it has taken so many samples, if its time is not up before.
const PILOT_SAMPLES: u64 = 64;

/// A renderer for a series, and the seconds it took to make ready.
pub struct Ready<C> {
    renderer: Renderer<C>,
    setup_seconds: f64,
}

/// Makes a renderer ready for `series` of runs of `scene`, which is of the size that is studied.
///
/// # Errors
/// If the scene cannot be rendered so.
pub fn make_ready<C: RayCaster>(
    series: &Series,
    scene: &Scene,
    build: impl FnOnce(&Geometry) -> Result<C, RaycastError>,
) -> Result<Ready<C>, RenderError> {
    let start = Instant::now();
    let changed = match series.role {
        Role::Effect(Some(effect)) => effect.off(scene),
        _ => None,
    };
    let scene = changed.unwrap_or_else(|| scene.clone());
    let options = series.candidate.options(&scene);
    let mut renderer = Renderer::new(scene, options, build)?;
    if series.role == Role::AnyDirection {
        renderer.forget_direction_of_entry();
    }
    Ok(Ready { renderer, setup_seconds: start.elapsed().as_secs_f64() })
}

impl<C: RayCaster> Ready<C> {
    /// What a sample costs, measured for about so many seconds; `None` if it was stopped.
    ///
    /// # Errors
    /// If there is no memory for a film.
    pub fn rate(&mut self, seconds: f64, stop: &AtomicBool) -> Result<Option<Rate>, FilmError> {
        let mut film = self.film()?;
        // The first sample also loads what memory holds; it counts only where it is slow anyway.
        let mut timed = 0.0;
        let (mut samples, mut taken) = (0, 0);
        while timed < seconds && taken < PILOT_SAMPLES {
            let pass = taken.max(1);
            let start = Instant::now();
            self.renderer.expose(&mut film, taken..taken + pass, stop, &|_| ());
            if stop.load(Ordering::Relaxed) {
                return Ok(None);
            }
            let of_pass = start.elapsed().as_secs_f64();
            if taken > 0 || of_pass >= seconds {
                timed += of_pass;
                samples += pass;
            }
            taken += pass;
        }
        Ok(Some(Rate { setup_seconds: self.setup_seconds, seconds_per_sample: timed / samples as f64 }))
    }

    /// A run with `seed`, judged at each of `levels` samples per pixel; `None` if it was stopped. `progress` is told the
    /// share that is done.
    ///
    /// # Errors
    /// If there is no memory for a film.
    pub fn run(
        &mut self,
        seed: u64,
        levels: &[u64],
        judge: impl Fn(&Picture) -> Vec<f64>,
        stop: &AtomicBool,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Option<Run>, FilmError> {
        self.renderer.reseed(seed);
        let mut film = self.film()?;
        let total = film.pixel_count() * levels.last().copied().unwrap_or(0);
        let done = AtomicU64::new(0);
        let advance = |added| {
            let done = done.fetch_add(added, Ordering::Relaxed) + added;
            progress(done as f64 / total as f64);
        };
        let mut counters = Counters::default();
        let (mut points, mut taken, mut seconds) = (Vec::new(), 0, 0.0);
        for &level in levels {
            let start = Instant::now();
            counters.merge(&self.renderer.expose(&mut film, taken..level, stop, &advance));
            seconds += start.elapsed().as_secs_f64();
            if stop.load(Ordering::Relaxed) {
                return Ok(None);
            }
            points.push(Point { spp: level, seconds, relmse: judge(&film.picture()) });
            taken = level;
        }
        let nonfinite = film.tally().nonfinite;
        let record = Record {
            seed,
            setup_seconds: self.setup_seconds,
            points,
            nonfinite,
            capped: counters.capped_paths,
            collisions: counters.collisions,
        };
        Ok(Some(Run { record, picture: film.picture() }))
    }

    fn film(&self) -> Result<Film, FilmError> {
        let size = self.renderer.scene().film;
        Film::new(size.width, size.height)
    }
}
