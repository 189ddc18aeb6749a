//! The vocabulary of light: spectra by channel, colour spaces, photometric units.

pub mod color;
pub mod spectrum;

pub use spectrum::{Rgb, Spectrum};

/// Luminous efficacy used to turn photometric units (lumen, candela, lux) into radiometric ones,
/// in lm/W: the value at 555 nm, K_cd, that defines the candela. glTF prescribes it for its lights.
pub const LUMENS_PER_WATT: f32 = 683.0;
