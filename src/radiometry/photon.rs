//! Photons: a wavelength, and the energy hc/λ that goes with it.

use std::ops::Sub;

use serde::Serialize;
use thiserror::Error;

use super::quantity::{Bandwidth, PhotonEnergy, RadiantEnergy};

/// Planck constant h, J s (SI, exact).
pub const PLANCK: f64 = 6.626_070_15e-34;
/// Speed of light in vacuum c, m/s (SI, exact).
pub const SPEED_OF_LIGHT: f64 = 299_792_458.0;
/// Boltzmann constant k, J/K (SI, exact).
pub const BOLTZMANN: f64 = 1.380_649e-23;

/// Metres in a nanometre.
pub(super) const NANOMETRE: f64 = 1e-9;

/// A wavelength in vacuum; positive and finite.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Serialize)]
#[serde(transparent)]
#[repr(transparent)]
pub struct Wavelength(f64);

/// No light has such a wavelength.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error("{nanometres} nm is no wavelength; it must be finite and above 0")]
pub struct WavelengthError {
    /// What was given.
    pub nanometres: f64,
}

impl Wavelength {
    /// From nanometres.
    ///
    /// # Errors
    /// If it is not finite and above 0.
    pub fn from_nanometres(nanometres: f64) -> Result<Self, WavelengthError> {
        if nanometres > 0.0 && nanometres.is_finite() {
            Ok(Self(nanometres))
        } else {
            Err(WavelengthError { nanometres })
        }
    }

    /// In nanometres.
    pub fn nanometres(self) -> f64 {
        self.0
    }

    /// Energy of one photon, Q = hc/λ.
    pub fn photon_energy(self) -> PhotonEnergy {
        PhotonEnergy(PLANCK * SPEED_OF_LIGHT / (self.0 * NANOMETRE))
    }
}

impl Sub for Wavelength {
    type Output = Bandwidth;

    fn sub(self, other: Self) -> Bandwidth {
        Bandwidth(self.0 - other.0)
    }
}

impl PhotonEnergy {
    /// Energy of `count` photons.
    pub fn of_photons(self, count: f64) -> RadiantEnergy {
        RadiantEnergy(self.0 * count)
    }
}
