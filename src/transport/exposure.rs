//! Taking samples by the kernel of a scene: the one place where the code of one is told from that of another, and red, green and blue from wavelengths.

use std::ops::Range;
use std::sync::atomic::AtomicBool;

use glam::Vec3;

use super::basis::{Basis, Tristimulus, Wavelengths};
use super::counters::Counters;
use super::interiors::{Interior, Interiors};
use super::path::{Path, place};
use super::renderer::Renderer;
use super::scatterer::Scatterer;
use super::spectra::{Part, SceneSpectra};
use super::substance::Substance;
use super::world::{UPWARDS, World};
use crate::film::Film;
use crate::math::SampleStream;
use crate::medium::Medium;
use crate::plan::Kernel;
use crate::radiometry::spectrum::hero::{CARRIED, Distribution, HeroWavelengths};
use crate::radiometry::{Rgb, Spectrum};
use crate::raycast::RayCaster;
use crate::scene::camera::CameraRay;
use crate::scene::{ColorInput, ScatteringInput};

/// What the generic kernel has code for, for either kind of channels.
const GENERIC: u32 = Kernel::Generic.abilities().bits();

impl<C: RayCaster> Renderer<C> {
    /// Adds to every pixel of `film` the samples with indices `samples`, on all threads of the current pool. The kernel is chosen once for
    /// all of them; `stop` and `advance` are those of [`Film::accumulate`].
    pub fn expose(
        &self,
        film: &mut Film,
        samples: Range<u64>,
        stop: &AtomicBool,
        advance: &(dyn Fn(u64) + Sync),
    ) -> Counters {
        const SURFACES: u32 = Kernel::Surfaces.abilities().bits();
        const TEXTURES: u32 = Kernel::Textures.abilities().bits();
        const GLASS: u32 = Kernel::Glass.abilities().bits();
        const SUBSURFACE: u32 = Kernel::Subsurface.abilities().bits();
        const TEXTURED_SUBSURFACE: u32 = Kernel::TexturedSubsurface.abilities().bits();
        match self.kernel() {
            Kernel::Surfaces => self.expose_by::<SURFACES>(film, samples, stop, advance),
            Kernel::Textures => self.expose_by::<TEXTURES>(film, samples, stop, advance),
            Kernel::Glass => self.expose_by::<GLASS>(film, samples, stop, advance),
            Kernel::Subsurface => self.expose_by::<SUBSURFACE>(film, samples, stop, advance),
            Kernel::TexturedSubsurface => self.expose_by::<TEXTURED_SUBSURFACE>(film, samples, stop, advance),
            Kernel::Generic => self.expose_by::<GENERIC>(film, samples, stop, advance),
            Kernel::Spectral => self.expose_with(film, samples, stop, advance, |x, y, sample, counters| {
                self.sample(x, y, sample, counters)
            }),
        }
    }

    /// The same by the kernel with the abilities `CAN`.
    fn expose_by<const CAN: u32>(
        &self,
        film: &mut Film,
        samples: Range<u64>,
        stop: &AtomicBool,
        advance: &(dyn Fn(u64) + Sync),
    ) -> Counters {
        self.expose_with(film, samples, stop, advance, |x, y, sample, counters| {
            self.sample_by::<CAN>(x, y, sample, counters)
        })
    }

    fn expose_with(
        &self,
        film: &mut Film,
        samples: Range<u64>,
        stop: &AtomicBool,
        advance: &(dyn Fn(u64) + Sync),
        sample: impl Fn(u32, u32, u64, &mut Counters) -> Rgb + Sync,
    ) -> Counters {
        film.accumulate(samples, sample, |total, counters| total.merge(&counters), stop, advance)
    }

    /// Radiance, W/(m² sr), that sample number `sample` of pixel (`x`, `y`) brings to the film. By the generic kernel: a film is
    /// faster [exposed](Self::expose), to the same bits.
    pub fn sample(&self, x: u32, y: u32, sample: u64, counters: &mut Counters) -> Rgb {
        let stream = self.stream(x, y, sample);
        let ray = self.camera_ray(x, y, &stream);
        self.follow(stream, &self.camera_interiors, ray.origin, ray.direction, counters)
    }

    /// The same by red, green and blue and the kernel with the abilities `CAN`.
    pub(super) fn sample_by<const CAN: u32>(
        &self,
        x: u32,
        y: u32,
        sample: u64,
        counters: &mut Counters,
    ) -> Rgb {
        let stream = self.stream(x, y, sample);
        let ray = self.camera_ray(x, y, &stream);
        Path::<C, _, 3, CAN>::new(self, Tristimulus, stream, &self.camera_interiors, counters)
            .radiance(ray.origin, ray.direction)
    }

    fn stream(&self, x: u32, y: u32, sample: u64) -> SampleStream {
        let pixel = u64::from(y) * u64::from(self.scene().film.width) + u64::from(x);
        SampleStream::new(self.options.seed, pixel, sample)
    }

    fn camera_ray(&self, x: u32, y: u32, stream: &SampleStream) -> CameraRay {
        let film = self.scene().film;
        let [u, v, lens_u, lens_v] = stream.quad(place::CAMERA);
        let [dx, dy] = film.filter.sample([u, v]);
        let on_film = [(x as f32 + 0.5 + dx) / film.width as f32, (y as f32 + 0.5 + dy) / film.height as f32];
        self.camera.ray(on_film, [lens_u, lens_v])
    }

    /// Radiance, W/(m² sr), that sample number `sample` finds to arrive at `origin` (m) from unit `direction`, by the generic kernel.
    pub fn radiance(&self, origin: Vec3, direction: Vec3, sample: u64, counters: &mut Counters) -> Rgb {
        let stream = SampleStream::new(self.options.seed, u64::MAX, sample);
        let origin = origin - self.center;
        let interiors = self.world.interiors_at(origin, UPWARDS);
        self.follow(stream, &interiors, origin, direction, counters)
    }

    /// The same of the path that `stream` draws from a point of the renderer's coordinates that is in `interiors`, which are filled here.
    pub(super) fn follow(
        &self,
        stream: SampleStream,
        interiors: &Interiors,
        origin: Vec3,
        direction: Vec3,
        counters: &mut Counters,
    ) -> Rgb {
        let Self { world, scatterers, .. } = self;
        match &self.spectra {
            None => {
                let interiors = filled(world, scatterers, &Tristimulus, interiors);
                Path::<C, _, 3, GENERIC>::new(self, Tristimulus, stream, &interiors, counters)
                    .radiance(origin, direction)
            }
            Some(spectra) => {
                let basis = wavelengths(&stream, spectra);
                let interiors = filled(world, scatterers, &basis, interiors);
                Path::<C, _, CARRIED, GENERIC>::new(self, basis, stream, &interiors, counters)
                    .radiance(origin, direction)
            }
        }
    }

    /// The bodies around `position`, found by a ray in `direction`, filled.
    pub(super) fn interiors_at<B: Basis<N>, const N: usize>(
        &self,
        basis: &B,
        position: Vec3,
        direction: Vec3,
    ) -> Interiors<N> {
        filled(&self.world, &self.scatterers, basis, &self.world.interiors_at(position, direction))
    }
}

/// `interiors` with what fills them. Where an albedo is textured there is no point of entry to look it up at: its factor stands for it.
pub(super) fn filled<C: RayCaster, B: Basis<N>, const N: usize>(
    world: &World<C>,
    scatterers: &[Option<Scatterer>],
    basis: &B,
    interiors: &Interiors,
) -> Interiors<N> {
    let albedo = |material: usize, input: &ScatteringInput| match input {
        ScatteringInput::Albedo { albedo, .. } => {
            basis.share(material, Part::Surface, &ColorInput::constant(albedo.factor), albedo.factor)
        }
        ScatteringInput::Coefficients { .. } | ScatteringInput::Spectral { .. } => Spectrum::ZERO,
    };
    interiors.map(|&Interior { instance, diameter, ior, medium }| {
        let Substance::Material(material) = world.substance(instance) else {
            return Interior { instance, diameter, ior, medium: Medium::clear(Spectrum::ZERO) };
        };
        let medium = match scatterers[material].as_ref().filter(|_| world.is_walked(instance)) {
            None => Medium::clear(basis.absorption(material, medium.sigma_a)),
            Some(scatterer) => {
                let around = interiors.ior_around(instance);
                scatterer.medium(basis, around, |input| albedo(material, input))
            }
        };
        Interior { instance, diameter, ior: basis.ior(material, ior, 0), medium }
    })
}

/// The wavelengths of a path.
fn wavelengths<'a>(stream: &SampleStream, spectra: &'a SceneSpectra) -> Wavelengths<'a> {
    let [u, rows, ..] = stream.quad(place::WAVELENGTHS);
    Wavelengths::new(HeroWavelengths::sample(Distribution::Visible, u), rows, spectra)
}
