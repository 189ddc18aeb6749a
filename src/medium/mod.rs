//! What is inside a translucent body: coefficients, measured materials, similarity, and the albedo of a
//! thick flat piece of it.

pub mod coefficients;
pub mod entry;
pub mod halfspace;
pub mod presets;

pub use coefficients::Medium;
pub use entry::Entry;
pub use halfspace::PlanarAlbedo;
