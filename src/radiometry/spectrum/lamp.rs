//! Lamps: light whose spectrum is known by name or temperature, as bright as wanted.

use std::fmt;

use glam::DVec3;
use thiserror::Error;

use super::blackbody::{Blackbody, TemperatureError};
use super::illuminant::{Illuminant, IlluminantError};
use super::observer::xyz;
use crate::radiometry::Rgb;
use crate::radiometry::color::{RGB_TO_XYZ, XYZ_TO_RGB};

/// By which law a lamp shines.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Law {
    /// Planck's, and the temperature in K.
    Blackbody(Blackbody, f64),
    Illuminant(Illuminant),
}

/// A spectrum of emission, on the scale on which its luminance Y is 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lamp {
    law: Law,
    /// Y of the law as it is.
    luminance: f64,
}

/// There is no such lamp.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum LampError {
    /// No body has such a temperature.
    #[error(transparent)]
    Temperature(#[from] TemperatureError),
    /// A body that sends no light that could be scaled.
    #[error("a temperature of {0} K; a body shines visibly from about 800 K")]
    Invisible(f64),
    /// No illuminant has such a name.
    #[error(transparent)]
    Illuminant(#[from] IlluminantError),
}

impl Lamp {
    /// A blackbody of a temperature in K.
    ///
    /// # Errors
    /// If no body has it, or one that has it sends no visible light in double precision.
    pub fn blackbody(kelvin: f64) -> Result<Self, LampError> {
        let lamp = Self::new(Law::Blackbody(Blackbody::new(kelvin)?, kelvin));
        if lamp.luminance.is_normal() { Ok(lamp) } else { Err(LampError::Invisible(kelvin)) }
    }

    /// The standard illuminant of a name.
    ///
    /// # Errors
    /// If none is named so.
    pub fn illuminant(name: &str) -> Result<Self, LampError> {
        Ok(Self::new(Law::Illuminant(Illuminant::from_name(name)?)))
    }

    fn new(law: Law) -> Self {
        Self { law, luminance: xyz(|nanometres| law.power(nanometres))[1] }
    }

    /// Power per wavelength at `nanometres`, on the scale on which constant 1 has the luminance 1, as this has.
    pub fn relative_power(&self, nanometres: f64) -> f64 {
        self.law.power(nanometres) / self.luminance
    }

    /// True if it is the white of linear Rec.709: all channels are alike then, and nothing is lost by them.
    pub fn is_white(&self) -> bool {
        self.law == Law::Illuminant(Illuminant::D65)
    }

    /// Its colour, of luminance 1. Below about 1900 K it is more saturated than Rec.709 can show: channels that would be negative are
    /// 0, and the others as much less as keeps the luminance.
    pub fn rgb(&self) -> Rgb {
        let color = *XYZ_TO_RGB * DVec3::from(xyz(|nanometres| self.relative_power(nanometres)));
        let shown = color.max(DVec3::ZERO);
        let shown = shown / RGB_TO_XYZ.row(1).dot(shown);
        Rgb::from_fn(|channel| shown[channel] as f32)
    }
}

impl Law {
    /// Power per wavelength, in a unit of its own.
    fn power(&self, nanometres: f64) -> f64 {
        match self {
            Self::Blackbody(body, _) => body.shape(nanometres),
            Self::Illuminant(illuminant) => illuminant.relative_power(nanometres),
        }
    }
}

/// In words: "a blackbody of 2856 K".
impl fmt::Display for Lamp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.law {
            Law::Blackbody(_, kelvin) => write!(f, "a blackbody of {kelvin} K"),
            Law::Illuminant(illuminant) => write!(f, "illuminant {}", illuminant.name().unwrap_or("D")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::radiometry::spectrum::observer::chromaticity;

    fn lamps() -> Vec<Lamp> {
        let bodies =
            [1000.0, 2000.0, 2856.0, 6500.0, 20_000.0].map(|kelvin| Lamp::blackbody(kelvin).unwrap());
        bodies.into_iter().chain(Illuminant::NAMES.map(|name| Lamp::illuminant(name).unwrap())).collect()
    }

    #[test]
    fn every_lamp_has_the_luminance_1() {
        for lamp in lamps() {
            let luminance = xyz(|nanometres| lamp.relative_power(nanometres))[1];
            // 471 roundings.
            assert!((luminance - 1.0).abs() < 471.0 * f64::EPSILON, "{lamp}: {luminance}");
            let seen = RGB_TO_XYZ.row(1).dot(DVec3::from(lamp.rgb().0.map(f64::from)));
            // Each channel rounds to single precision.
            assert!((seen - 1.0).abs() < f64::from(f32::EPSILON), "{lamp}: {seen}");
            assert!(lamp.rgb().min_component() >= 0.0);
        }
    }

    #[test]
    fn colors_are_those_of_the_spectra() {
        for lamp in lamps() {
            let [x, y] = chromaticity(xyz(|nanometres| lamp.relative_power(nanometres)));
            let [r, g, b] = lamp.rgb().0.map(f64::from);
            let [shown_x, shown_y] = chromaticity((*RGB_TO_XYZ * DVec3::new(r, g, b)).to_array());
            // Nothing was cut where no channel is 0.
            if r.min(g).min(b) > 0.0 {
                assert!((x - shown_x).abs() < 1e-6 && (y - shown_y).abs() < 1e-6, "{lamp}");
            }
        }
        let [r, g, b] = Lamp::blackbody(1000.0).unwrap().rgb().0;
        assert!(r > g && g > b && b == 0.0, "{r} {g} {b}");
        // In single precision, three roundings of numbers up to 3 in the matrix.
        let white = Lamp::illuminant("D65").unwrap();
        assert!(white.rgb().0.iter().all(|channel| (channel - 1.0).abs() <= f32::EPSILON), "{white}");
        assert!(white.is_white() && lamps().iter().filter(|lamp| lamp.is_white()).count() == 1);
    }

    #[test]
    fn lamps_are_named() {
        assert_eq!(Lamp::blackbody(2856.5).unwrap().to_string(), "a blackbody of 2856.5 K");
        for name in Illuminant::NAMES {
            assert_eq!(Lamp::illuminant(name).unwrap().to_string(), format!("illuminant {name}"));
        }
    }

    #[test]
    fn what_is_no_lamp_is_refused() {
        for kelvin in [0.0, -2856.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(Lamp::blackbody(kelvin), Err(LampError::Temperature(_))), "{kelvin}");
        }
        for kelvin in [1.0, f64::MAX] {
            assert_eq!(Lamp::blackbody(kelvin), Err(LampError::Invisible(kelvin)));
        }
        assert!(Lamp::illuminant("F11").unwrap_err().to_string().contains("known are A, D50"));
    }
}
