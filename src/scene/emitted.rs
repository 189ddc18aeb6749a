//! What a light emits: how much, and by which spectrum.

use glam::DVec3;

use crate::radiometry::Rgb;
use crate::radiometry::color::RGB_TO_XYZ;
use crate::radiometry::spectrum::lamp::Lamp;

/// What a light emits, in the unit of its kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emitted {
    /// Red, green and blue.
    pub rgb: Rgb,
    /// What is known of the wavelengths.
    pub source: Source,
}

/// What is known of the wavelengths of a light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Source {
    /// Nothing but the colour.
    #[default]
    Color,
    /// All.
    Lamp(Lamp),
}

impl Emitted {
    /// A lamp as bright as white light of `strength` in each channel.
    pub fn by(lamp: Lamp, strength: f32) -> Self {
        Self { rgb: lamp.rgb() * strength, source: Source::Lamp(lamp) }
    }

    /// Y of [`Emitted::rgb`], which its spectrum has as well.
    pub fn luminance(&self) -> f64 {
        RGB_TO_XYZ.row(1).dot(DVec3::from(self.rgb.0.map(f64::from)))
    }
}

impl From<Rgb> for Emitted {
    fn from(rgb: Rgb) -> Self {
        Self { rgb, source: Source::Color }
    }
}

impl Source {
    /// The lamp, if it is one.
    pub fn lamp(&self) -> Option<&Lamp> {
        match self {
            Self::Color => None,
            Self::Lamp(lamp) => Some(lamp),
        }
    }

    /// Power per wavelength, on the scale on which constant 1 has the luminance Y = 1, as this has: times the luminance of
    /// [`Emitted::rgb`] it is what the light emits. `None` if nothing is known but the colour.
    pub fn relative_power(&self, nanometres: f64) -> Option<f64> {
        self.lamp().map(|lamp| lamp.relative_power(nanometres))
    }
}
