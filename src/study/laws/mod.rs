//! The laws that scattering has to obey, checked on the materials of a scene as the renderer uses them, and the orders of the
//! Neumann series of its light.

pub mod bssrdf;
pub mod orders;
pub mod scattering;

pub use bssrdf::{BssrdfLaws, check_bssrdf};
pub use orders::{Order, Orders, neumann_orders};
pub use scattering::{SurfaceLaws, check_surface};
