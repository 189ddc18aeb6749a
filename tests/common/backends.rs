//! The same work with every backend of this build, by colour and by wavelength.

use std::fmt;
use std::sync::atomic::AtomicBool;

use alabaster::film::Film;
use alabaster::plan::Kernel;
use alabaster::radiometry::Rgb;
use alabaster::raycast::bvh::BvhCaster;
#[cfg(feature = "embree")]
use alabaster::raycast::embree::EmbreeCaster;
use alabaster::raycast::{Backend, Geometry, RayCaster, RaycastError};
use alabaster::scene::{ColorMode, Method, Scene};
use alabaster::transport::{Counters, RenderOptions, Renderer};
use glam::Vec3;

use super::scenes::options;
use super::walks::{Found, White, picture, trace};

/// The options of the tests with `method`.
pub fn by(method: Method) -> RenderOptions {
    RenderOptions { method, ..options() }
}

/// Work on a renderer, whatever casts its rays.
pub trait Work {
    type Result;
    fn run<C: RayCaster>(&self, renderer: &Renderer<C>) -> Self::Result;
}

/// What paths carry.
pub const MODES: [ColorMode; 2] = [ColorMode::Rgb, ColorMode::Spectral];

/// How a scene is rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setup {
    pub backend: Backend,
    pub mode: ColorMode,
}

impl fmt::Display for Setup {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{} by {}", self.mode_name(), self.backend.name())
    }
}

impl Setup {
    pub fn mode_name(&self) -> &'static str {
        if self.mode == ColorMode::Spectral { "spectral" } else { "rgb" }
    }

    /// The name of the mode, where figures are those of one backend for all.
    pub fn recorded(&self) -> Option<&'static str> {
        (self.backend == Backend::Bvh).then_some(self.mode_name())
    }
}

/// What each backend makes of `scene` in each mode.
pub fn renderings<W: Work>(scene: &Scene, options: RenderOptions, work: &W) -> Vec<(Setup, W::Result)> {
    MODES.into_iter().flat_map(|mode| renderings_in(mode, scene, options, work)).collect()
}

/// What each backend makes of `scene` in one mode.
pub fn renderings_in<W: Work>(
    mode: ColorMode,
    scene: &Scene,
    options: RenderOptions,
    work: &W,
) -> Vec<(Setup, W::Result)> {
    fn run<C: RayCaster, W: Work>(
        scene: Scene,
        options: RenderOptions,
        work: &W,
        build: fn(&Geometry) -> Result<C, RaycastError>,
    ) -> W::Result {
        work.run(&Renderer::new(scene, options, build).unwrap())
    }
    let mut scene = scene.clone();
    scene.render.color_mode = mode;
    let with = |backend: &Backend| match backend {
        #[cfg(feature = "embree")]
        Backend::Embree => run(scene.clone(), options, work, |geometry| EmbreeCaster::new(geometry, 1)),
        _ => run(scene.clone(), options, work, BvhCaster::new),
    };
    // The third is a yardstick for speed.
    let backends = Backend::available().iter().filter(|backend| **backend != Backend::Obvhs);
    backends.map(|backend| (Setup { backend: *backend, mode }, with(backend))).collect()
}

/// How many of `samples` to take: a quarter by wavelength, which costs more and breaks alike.
fn share<C: RayCaster>(renderer: &Renderer<C>, samples: u64) -> u64 {
    if renderer.kernel() == Kernel::Spectral { samples.div_ceil(4) } else { samples }
}

/// One film of `samples` samples, each of which `see` makes of what the renderer does.
fn exposed<C: RayCaster>(
    renderer: &Renderer<C>,
    samples: u64,
    see: impl Fn(u32, u32, u64, Rgb) -> Rgb + Sync,
) -> (Film, Counters) {
    let size = renderer.scene().film;
    let mut film = Film::new(size.width, size.height).unwrap();
    let counters = film.accumulate(
        0..samples,
        |x, y, sample, counters: &mut Counters| see(x, y, sample, renderer.sample(x, y, sample, counters)),
        |total, counters| total.merge(&counters),
        &AtomicBool::new(false),
        |_| (),
    );
    (film, counters)
}

/// Samples of each pixel of a scene's picture.
pub struct Pictures(pub u64);

impl Work for Pictures {
    type Result = Found;
    fn run<C: RayCaster>(&self, renderer: &Renderer<C>) -> Found {
        picture(renderer, share(renderer, self.0))
    }
}

/// So many rays, the origin and direction of each by a function.
pub struct Rays<F>(pub u64, pub F);

impl<F: Fn(u64) -> (Vec3, Vec3) + Sync> Work for Rays<F> {
    type Result = Found;
    fn run<C: RayCaster>(&self, renderer: &Renderer<C>) -> Found {
        trace(renderer, share(renderer, self.0), &self.1)
    }
}

/// Films with so many samples of each pixel.
pub struct Films(pub u64);

impl Work for Films {
    type Result = (Film, Counters);
    fn run<C: RayCaster>(&self, renderer: &Renderer<C>) -> (Film, Counters) {
        exposed(renderer, share(renderer, self.0), |_, _, _, radiance| radiance)
    }
}

/// Films, without colour, of what [`White`] makes of so many samples of each pixel.
pub struct Levels(pub u64);

impl Work for Levels {
    type Result = (Film, Counters);
    fn run<C: RayCaster>(&self, renderer: &Renderer<C>) -> (Film, Counters) {
        let white = White::of(renderer);
        exposed(renderer, self.0, |x, y, sample, radiance| {
            Rgb::splat(white.level_of_pixel(x, y, sample, radiance) as f32)
        })
    }
}

/// Mean over pixels and channels of the squared relative difference of two films, and what it would be of films that
/// differ by their noise alone.
pub fn relative_difference(a: &Film, b: &Film) -> (f64, f64) {
    let (mut difference, mut noise) = (0.0, 0.0);
    for (a, b) in a.rows().zip(b.rows()) {
        for c in 0..3 {
            let (x, y) = (f64::from(a.mean()[c]), f64::from(b.mean()[c]));
            difference += (x - y).powi(2) / (y * y + 0.01);
            noise += (a.variance_of_mean(c) + b.variance_of_mean(c)) / (y * y + 0.01);
        }
    }
    let count = 3.0 * a.pixel_count() as f64;
    (difference / count, noise / count)
}
