//! The vocabulary of light: quantities with units and the laws between them, solid angles, photons, spectra and
//! colour. `docs/radiometry.md` has the table of notions.

pub mod color;
pub mod law;
pub mod photon;
pub mod quantity;
pub mod solid_angle;
pub mod spectrum;

pub use photon::{Wavelength, WavelengthError};
pub use quantity::{
    Amount, Area, Bandwidth, Exitance, Irradiance, PhotonEnergy, ProjectedArea, Radiance, RadiantEnergy,
    RadiantFlux, RadiantIntensity, SpectralEnergy, SpectralFlux, SpectralRadiance,
};
pub use solid_angle::{ProjectedSolidAngle, SolidAngle};
pub use spectrum::{Rgb, Spectrum};

/// Luminous efficacy used to turn photometric units (lumen, candela, lux) into radiometric ones,
/// in lm/W: the value at 555 nm, K_cd, that defines the candela. glTF prescribes it for its lights.
pub const LUMENS_PER_WATT: f32 = 683.0;
