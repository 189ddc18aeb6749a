//! What the tests of the random walk share.

use alabaster::plan::Kernel;
use alabaster::radiometry::Rgb;
use alabaster::raycast::RayCaster;
use alabaster::raycast::bvh::BvhCaster;
use alabaster::scene::{ColorMode, Environment, Mesh, Method, Scene};
use alabaster::transport::{Counters, RenderOptions, Renderer};
use glam::Vec3;
use rayon::prelude::*;

use super::scenes::{Caster, Statistics, caster, options};

/// A renderer that walks.
pub fn walker(scene: Scene) -> Renderer<Caster> {
    Renderer::new(scene, RenderOptions { method: Method::Walk, ..options() }, caster).unwrap()
}

/// A renderer that walks from collision to collision.
pub fn plain_walker(scene: Scene) -> Renderer<Caster> {
    let options = RenderOptions { method: Method::Walk, spheres: false, ..options() };
    Renderer::new(scene, options, caster).unwrap()
}

/// Makes one number of a sample: the mean of its channels, or by wavelength its luminance over that of white at the wavelengths it is of. In light
/// that is white, and all that does not depend on the wavelength, its mean is that of the radiance; and what a sample varies for its choice
/// of wavelengths alone is left out.
pub struct White(Option<Renderer<BvhCaster>>);

impl White {
    /// For samples of `renderer`, whose seed is that of [`options`].
    pub fn of<C: RayCaster>(renderer: &Renderer<C>) -> Self {
        let nothing_but_light = || {
            let mut scene = Scene { environment: Some(Environment::Constant(Rgb::ONE)), ..Scene::default() };
            scene.film = renderer.scene().film;
            scene.render.color_mode = ColorMode::Spectral;
            Renderer::new(scene, options(), BvhCaster::new).unwrap()
        };
        Self((renderer.kernel() == Kernel::Spectral).then(nothing_but_light))
    }

    /// Of sample number `sample` of a pixel.
    pub fn level_of_pixel(&self, x: u32, y: u32, sample: u64, radiance: Rgb) -> f64 {
        self.level(radiance, |white| white.sample(x, y, sample, &mut Counters::default()))
    }

    /// Of sample number `sample` of a ray.
    pub fn level_of_ray(&self, sample: u64, radiance: Rgb) -> f64 {
        self.level(radiance, |white| white.radiance(Vec3::ZERO, Vec3::Z, sample, &mut Counters::default()))
    }

    fn level(&self, radiance: Rgb, white: impl FnOnce(&Renderer<BvhCaster>) -> Rgb) -> f64 {
        match &self.0 {
            None => radiance.mean().into(),
            Some(renderer) => f64::from(radiance.luminance()) / f64::from(white(renderer).luminance()),
        }
    }
}

/// What many rays found.
#[derive(Default)]
pub struct Found {
    /// By channel.
    pub radiance: [Statistics; 3],
    /// All channels of a sample together, which are not independent: as [`White`] has it.
    pub mean: Statistics,
    /// Collisions of each path.
    pub collisions: Statistics,
    pub counters: Counters,
}

impl Found {
    /// What is told apart: the channels, or by wavelength nothing.
    pub fn parts(&self, mode: ColorMode) -> &[Statistics] {
        if mode == ColorMode::Spectral { std::slice::from_ref(&self.mean) } else { &self.radiance }
    }

    fn add(&mut self, radiance: Rgb, level: f64) {
        assert!(radiance.is_finite());
        self.mean.add(level);
        self.radiance.iter_mut().zip(radiance.0).for_each(|(all, x)| all.add(f64::from(x)));
    }

    pub fn merge(&mut self, part: &Self) {
        self.counters.merge(&part.counters);
        self.collisions.merge(&part.collisions);
        self.mean.merge(&part.mean);
        self.radiance.iter_mut().zip(&part.radiance).for_each(|(all, part)| all.merge(part));
    }
}

/// Radiance and collisions for `count` rays, the origin and direction of each by `ray`. The result does not depend
/// on the number of threads.
pub fn trace<C: RayCaster>(
    renderer: &Renderer<C>,
    count: u64,
    ray: impl Fn(u64) -> (Vec3, Vec3) + Sync,
) -> Found {
    const PART: u64 = 1024;
    let white = White::of(renderer);
    let parts: Vec<Found> = (0..count.div_ceil(PART))
        .into_par_iter()
        .map(|part| {
            let mut found = Found::default();
            for sample in part * PART..((part + 1) * PART).min(count) {
                let (origin, direction) = ray(sample);
                let before = found.counters.collisions;
                let radiance = renderer.radiance(origin, direction, sample, &mut found.counters);
                found.collisions.add((found.counters.collisions - before) as f64);
                found.add(radiance, white.level_of_ray(sample, radiance));
            }
            found
        })
        .collect();
    let mut all = Found::default();
    parts.iter().for_each(|part| all.merge(part));
    all
}

/// Every pixel of the scene's picture, `samples` times. The result does not depend on the number of threads.
pub fn picture<C: RayCaster>(renderer: &Renderer<C>, samples: u64) -> Found {
    let (width, height) = (renderer.scene().film.width, renderer.scene().film.height);
    let white = White::of(renderer);
    let row = |y: u32| {
        let mut found = Found::default();
        for x in 0..width {
            for sample in 0..samples {
                let before = found.counters.collisions;
                let radiance = renderer.sample(x, y, sample, &mut found.counters);
                found.collisions.add((found.counters.collisions - before) as f64);
                found.add(radiance, white.level_of_pixel(x, y, sample, radiance));
            }
        }
        found
    };
    let rows: Vec<Found> = (0..height).into_par_iter().map(row).collect();
    let mut found = Found::default();
    rows.iter().for_each(|row| found.merge(row));
    found
}

/// Without interpolated normals: laws of light in polyhedra hold to all digits.
pub fn faceted(mesh: Mesh) -> Mesh {
    Mesh { normals: Vec::new(), ..mesh }
}
