//! What the channels of a path are: red, green and blue, or wavelengths.
//!
//! A path tracer is compiled for each. What a scene is made of is looked up in a basis, and what a path brings to the film leaves it again as a
//! colour; everything in between is the same code.

use glam::Vec3;

use super::guide::Guide;
use super::scatterer::{Given, Immersed, Local, Scatterer};
use super::spectra::{Part, SceneSpectra};
use super::spheres::Spheres;
use crate::medium::Medium;
use crate::radiometry::spectrum::hero::{CARRIED, HeroWavelengths};
use crate::radiometry::spectrum::regular::{self, RegularSpectrum};
use crate::radiometry::{Rgb, Spectrum};
use crate::scene::{ColorInput, Environment, Light};

/// What the `N` channels of a path are.
pub trait Basis<const N: usize>: Copy {
    /// Directions can depend on the channel.
    const DISPERSES: bool;

    /// A share of light, that `input` of a material gives as `rgb` at some point.
    fn share(&self, material: usize, part: Part, input: &ColorInput, rgb: Rgb) -> Spectrum<N>;

    /// Radiance, W/(m² sr), that the emission of a material gives as `rgb` at some point.
    fn emission(&self, material: usize, input: &ColorInput, rgb: Rgb) -> Spectrum<N>;

    /// What a light emits, in the unit of its kind.
    fn light(&self, index: usize, light: &Light) -> Spectrum<N>;

    /// Radiance that arrives from unit `direction`, W/(m² sr).
    fn environment(&self, environment: &Environment, direction: Vec3) -> Spectrum<N>;

    /// Absorption coefficient in a clear body of a material, 1/m, that the scene gives as `rgb`.
    fn absorption(&self, material: usize, rgb: Rgb) -> Spectrum<N>;

    /// What a translucent material is given by.
    fn given(&self, scatterer: &Scatterer) -> Given<N>;

    /// A translucent material where nothing is textured.
    fn constant(&self, immersed: &Immersed) -> Option<Local<N>>;

    /// The guide of walks in `medium`, if they are worth to be guided.
    fn guide(&self, immersed: &Immersed, medium: &Medium<N>) -> Option<Guide<N>>;

    /// Steps of walks on spheres, if they have been prepared for these channels.
    fn spheres<'s>(&self, immersed: &'s Immersed) -> Option<Spheres<'s, N>>;

    /// True if the index of refraction of a material differs between channels.
    fn is_dispersive(&self, material: usize) -> bool;

    /// Index of refraction of a material at `channel`; `ior` is that which the scene gives.
    fn ior(&self, material: usize, ior: f32, channel: usize) -> f32;

    /// The colour of what arrives.
    fn rgb(&self, radiance: Spectrum<N>) -> Rgb;
}

/// Red, green and blue of the film.
#[derive(Clone, Copy, Debug)]
pub struct Tristimulus;

impl Basis<3> for Tristimulus {
    const DISPERSES: bool = false;

    fn share(&self, _: usize, _: Part, _: &ColorInput, rgb: Rgb) -> Rgb {
        rgb
    }

    fn emission(&self, _: usize, _: &ColorInput, rgb: Rgb) -> Rgb {
        rgb
    }

    fn light(&self, _: usize, light: &Light) -> Rgb {
        light.emitted().rgb
    }

    fn environment(&self, environment: &Environment, direction: Vec3) -> Rgb {
        environment.radiance(direction)
    }

    fn absorption(&self, _: usize, rgb: Rgb) -> Rgb {
        rgb
    }

    fn given(&self, scatterer: &Scatterer) -> Given<3> {
        *scatterer.given()
    }

    fn constant(&self, immersed: &Immersed) -> Option<Local> {
        immersed.constant().copied()
    }

    fn guide(&self, immersed: &Immersed, medium: &Medium) -> Option<Guide> {
        match immersed.prepared_guide() {
            Some((prepared, guide)) if prepared == medium => *guide,
            _ => immersed.new_guide(medium),
        }
    }

    fn spheres<'s>(&self, immersed: &'s Immersed) -> Option<Spheres<'s>> {
        immersed.spheres()?.of([0, 1, 2])
    }

    fn is_dispersive(&self, _: usize) -> bool {
        false
    }

    fn ior(&self, _: usize, ior: f32, _: usize) -> f32 {
        ior
    }

    fn rgb(&self, radiance: Rgb) -> Rgb {
        radiance
    }
}

/// Four wavelengths, of which the first decides where light goes that is not bent alike.
///
/// What a scene is made of is tabulated by wavelength, and looked up in a row: in that before or after a wavelength, drawn so that it is the wavelength in the mean.
/// So light is linear between the wavelengths of the rows. Where light is bent, and which colour it has, goes by the wavelength itself.
#[derive(Clone, Copy)]
pub struct Wavelengths<'a> {
    carried: HeroWavelengths,
    rows: [usize; CARRIED],
    spectra: &'a SceneSpectra,
}

impl<'a> Wavelengths<'a> {
    /// In the scene that `spectra` are of; `u` in [0, 1) decides on rows.
    pub fn new(carried: HeroWavelengths, u: f32, spectra: &'a SceneSpectra) -> Self {
        let rows = carried.nanometres.map(|nanometres| regular::row(nanometres, u));
        Self { carried, rows, spectra }
    }

    fn regular(&self, spectrum: &RegularSpectrum) -> Spectrum<CARRIED> {
        Spectrum(self.rows.map(|row| spectrum[row]))
    }

    /// An emission that is `rgb` where it was looked up.
    fn emitted(&self, rgb: Rgb) -> Spectrum<CARRIED> {
        self.spectra.filters(rgb, self.carried.nanometres) * self.regular(self.spectra.daylight())
    }
}

impl Basis<CARRIED> for Wavelengths<'_> {
    const DISPERSES: bool = true;

    fn share(&self, material: usize, part: Part, input: &ColorInput, rgb: Rgb) -> Spectrum<CARRIED> {
        if input.varies() {
            return self.spectra.shares(rgb, self.carried.nanometres);
        }
        self.regular(self.spectra.material(material).part(part))
    }

    fn emission(&self, material: usize, input: &ColorInput, rgb: Rgb) -> Spectrum<CARRIED> {
        match input.varies() {
            true => self.emitted(rgb),
            false => self.regular(&self.spectra.material(material).emission),
        }
    }

    fn light(&self, index: usize, _: &Light) -> Spectrum<CARRIED> {
        self.regular(self.spectra.light(index))
    }

    fn environment(&self, environment: &Environment, direction: Vec3) -> Spectrum<CARRIED> {
        match environment {
            Environment::Constant(_) => self.regular(self.spectra.environment()),
            Environment::Map { .. } => self.emitted(environment.radiance(direction)),
        }
    }

    fn absorption(&self, material: usize, _: Rgb) -> Spectrum<CARRIED> {
        self.regular(&self.spectra.material(material).absorption)
    }

    fn given(&self, scatterer: &Scatterer) -> Given<CARRIED> {
        match scatterer.given_by_wavelength() {
            Some(Given::Medium(medium)) => Given::Medium(medium.channels(self.rows)),
            Some(Given::FreePath { length, g }) => Given::FreePath { length: self.regular(length), g: *g },
            None => Given::Medium(Medium::clear(Spectrum::ZERO)),
        }
    }

    fn constant(&self, immersed: &Immersed) -> Option<Local<CARRIED>> {
        immersed.by_wavelength().map(|local| Local {
            albedo: self.regular(&local.albedo),
            absorbed: self.regular(&local.absorbed),
            length: self.regular(&local.length),
        })
    }

    fn guide(&self, immersed: &Immersed, medium: &Medium<CARRIED>) -> Option<Guide<CARRIED>> {
        immersed.new_guide(medium)
    }

    fn spheres<'s>(&self, immersed: &'s Immersed) -> Option<Spheres<'s, CARRIED>> {
        immersed.spheres_by_wavelength()?.of(self.rows)
    }

    fn is_dispersive(&self, material: usize) -> bool {
        self.spectra.material(material).dispersion.is_some()
    }

    fn ior(&self, material: usize, ior: f32, channel: usize) -> f32 {
        match &self.spectra.material(material).dispersion {
            Some(dispersion) => dispersion.ior(self.carried.nanometres[channel].into()) as f32,
            None => ior,
        }
    }

    fn rgb(&self, radiance: Spectrum<CARRIED>) -> Rgb {
        self.carried.rgb(radiance.0)
    }
}
