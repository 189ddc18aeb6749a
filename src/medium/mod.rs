//! What is inside a translucent body: coefficients, measured materials, similarity, and the albedo of a
//! thick flat piece of it.

pub mod coefficients;
pub mod halfspace;
pub mod presets;

pub use coefficients::Medium;
pub use halfspace::PlanarAlbedo;
