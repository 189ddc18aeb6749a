//! Stand-in for the integrator, to be replaced at the merge: seeded noise over a gradient.

use thiserror::Error;

use crate::math::sampler::SampleStream;
use crate::radiometry::Rgb;
use crate::raycast::{Geometry, RayCaster, RaycastError};
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
    /// The option is known but not available.
    #[error("{option} \"{value}\" is not available in this version; available: {available}")]
    Unavailable {
        /// Name of the option.
        option: &'static str,
        /// Value asked for.
        value: String,
        /// What could be asked for instead.
        available: &'static str,
    },
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
        self.rejected += other.rejected;
        self.capped_paths += other.capped_paths;
        self.probes.cast += other.probes.cast;
        self.probes.missed += other.probes.missed;
        self.probes.hits += other.probes.hits;
        self.probes.overflowed += other.probes.overflowed;
    }
}

/// Takes samples of pixels.
pub struct Renderer<C> {
    scene: Scene,
    options: RenderOptions,
    caster: C,
}

impl<C: RayCaster> Renderer<C> {
    /// A renderer of `scene`.
    pub fn new(
        scene: Scene,
        options: RenderOptions,
        build: impl FnOnce(&Geometry) -> Result<C, RaycastError>,
    ) -> Result<Self, RenderError> {
        if options.method == Method::Walk {
            return Err(RenderError::Unavailable {
                option: "method",
                value: "walk".into(),
                available: "auto, bssrdf, diffuse",
            });
        }
        let caster = build(&Geometry { meshes: &[], instances: &[] })?;
        Ok(Self { scene, options, caster })
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The ray caster.
    pub fn caster(&self) -> &C {
        &self.caster
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
