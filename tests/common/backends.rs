//! The same work with every backend of this build.

use std::sync::atomic::AtomicBool;

use alabaster::film::Film;
use alabaster::raycast::bvh::BvhCaster;
#[cfg(feature = "embree")]
use alabaster::raycast::embree::EmbreeCaster;
use alabaster::raycast::{Backend, Geometry, RayCaster, RaycastError};
use alabaster::scene::{Method, Scene};
use alabaster::transport::{Counters, RenderOptions, Renderer};
use glam::Vec3;

use super::scenes::options;
use super::walks::{Found, picture, trace};

/// The options of the tests with `method`.
pub fn by(method: Method) -> RenderOptions {
    RenderOptions { method, ..options() }
}

/// Work on a renderer, whatever casts its rays.
pub trait Work {
    type Result;
    fn run<C: RayCaster>(&self, renderer: &Renderer<C>) -> Self::Result;
}

/// What each backend makes of `scene`, with its name.
pub fn on_backends<W: Work>(
    scene: &Scene,
    options: RenderOptions,
    work: &W,
) -> Vec<(&'static str, W::Result)> {
    fn run<C: RayCaster, W: Work>(
        scene: &Scene,
        options: RenderOptions,
        work: &W,
        build: fn(&Geometry) -> Result<C, RaycastError>,
    ) -> W::Result {
        work.run(&Renderer::new(scene.clone(), options, build).unwrap())
    }
    let with = |backend: &Backend| match backend {
        #[cfg(feature = "embree")]
        Backend::Embree => run(scene, options, work, |geometry| EmbreeCaster::new(geometry, 1)),
        _ => run(scene, options, work, BvhCaster::new),
    };
    // The third is a yardstick for speed.
    let backends = Backend::available().iter().filter(|backend| **backend != Backend::Obvhs);
    backends.map(|backend| (backend.name(), with(backend))).collect()
}

/// Samples of each pixel of a scene's picture.
pub struct Pictures(pub u64);

impl Work for Pictures {
    type Result = Found;
    fn run<C: RayCaster>(&self, renderer: &Renderer<C>) -> Found {
        picture(renderer, self.0)
    }
}

/// So many rays, the origin and direction of each by a function.
pub struct Rays<F>(pub u64, pub F);

impl<F: Fn(u64) -> (Vec3, Vec3) + Sync> Work for Rays<F> {
    type Result = Found;
    fn run<C: RayCaster>(&self, renderer: &Renderer<C>) -> Found {
        trace(renderer, self.0, &self.1)
    }
}

/// Films with so many samples of each pixel.
pub struct Films(pub u64);

impl Work for Films {
    type Result = (Film, Counters);
    fn run<C: RayCaster>(&self, renderer: &Renderer<C>) -> (Film, Counters) {
        let size = renderer.scene().film;
        let mut film = Film::new(size.width, size.height).unwrap();
        let counters = film.accumulate(
            0..self.0,
            |x, y, sample, counters: &mut Counters| renderer.sample(x, y, sample, counters),
            |total, counters| total.merge(&counters),
            &AtomicBool::new(false),
            |_| (),
        );
        (film, counters)
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
