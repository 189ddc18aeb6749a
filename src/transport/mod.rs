//! Stand-in for the integrator, to be replaced at the merge: seeded noise over a gradient.

use std::marker::PhantomData;

use thiserror::Error;

use crate::math::sampler::SampleStream;
use crate::radiometry::Rgb;
use crate::raycast::{RayCaster, RaycastError};
use crate::scene::{Method, ProfileChoice, Scene};

/// What the renderer is told besides the scene.
#[derive(Clone, Copy, Debug, Default)]
pub struct RenderOptions {
    /// Seed of every random number.
    pub seed: u64,
    /// Subsurface method.
    pub method: Method,
    /// Diffusion profile.
    pub profile: ProfileChoice,
    /// Longest path; 0: no limit.
    pub max_depth: u32,
}

/// Why no renderer can be made.
#[derive(Debug, Error)]
pub enum RenderError {
    /// The ray casting backend failed.
    #[error(transparent)]
    Raycast(#[from] RaycastError),
    /// The scene asks for what is not there.
    #[error("{0}")]
    Unsupported(String),
}

/// Probe rays by outcome.
#[derive(Clone, Copy, Debug, Default)]
pub struct ProbeCounters {
    /// Segments cast.
    pub cast: u64,
    /// Segments without a hit.
    pub missed: u64,
    /// Hits found.
    pub hits: u64,
    /// Segments with more hits than were kept.
    pub overflowed: u64,
}

/// What happened while sampling.
#[derive(Clone, Debug, Default)]
pub struct Counters {
    /// Non-finite terms that were left out before a sample was returned.
    pub nonfinite: u64,
    /// Samples rejected.
    pub rejected: u64,
    /// Paths cut at the depth limit.
    pub capped_paths: u64,
    /// Probe rays.
    pub probes: ProbeCounters,
}

impl Counters {
    /// Adds `other`.
    pub fn merge(&mut self, other: &Self) {
        self.nonfinite += other.nonfinite;
        self.rejected += other.rejected;
        self.capped_paths += other.capped_paths;
        self.probes.cast += other.probes.cast;
        self.probes.missed += other.probes.missed;
        self.probes.hits += other.probes.hits;
        self.probes.overflowed += other.probes.overflowed;
    }
}

/// Takes samples of pixels.
pub struct Renderer<C: RayCaster> {
    scene: Scene,
    options: RenderOptions,
    caster: PhantomData<C>,
}

impl<C: RayCaster> Renderer<C> {
    /// A renderer of `scene`.
    pub fn new(scene: Scene, options: RenderOptions) -> Result<Self, RenderError> {
        Ok(Self { scene, options, caster: PhantomData })
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Radiance of one sample of one pixel.
    pub fn sample(&self, x: u32, y: u32, sample: u64, counters: &mut Counters) -> Rgb {
        counters.probes.cast += 1;
        counters.probes.missed += 1;
        let film = self.scene.film;
        let pixel = u64::from(y) * u64::from(film.width) + u64::from(x);
        let noise = SampleStream::new(self.options.seed, pixel, sample).quad(0);
        Rgb::new(x as f32 / film.width as f32, y as f32 / film.height as f32, 0.2) * (0.5 + noise[0])
    }
}
