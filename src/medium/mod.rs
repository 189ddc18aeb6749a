//! Media: coefficients and measured materials.

pub mod presets;
