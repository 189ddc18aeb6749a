//! What is inside a translucent body: coefficients, measured materials, similarity, and exact transport
//! in flat pieces of it.

pub mod albedo_inversion;
pub mod coefficients;
mod discrete_ordinates;
pub mod dwivedi;
pub mod entry;
pub mod planar_albedo;
pub mod plane_parallel;
pub mod presets;
pub mod sphere_step;

pub use albedo_inversion::AlbedoInversion;
pub use coefficients::Medium;
pub use entry::Entry;
pub use planar_albedo::PlanarAlbedo;
pub use plane_parallel::PlaneParallel;
pub use sphere_step::SphereStep;
