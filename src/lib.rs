//! alabaster: a physically based renderer for subsurface scattering.
//!
//! The modules are the rooms of the house, in the order in which data walks through them: a scene
//! file becomes a [`scene::Scene`], a [`plan`] says how each body is rendered, light is [`transport`]ed through it with ray queries answered by
//! [`raycast`], and lands on [`film`]. The physics stands in rooms of its own, each usable alone:
//! [`math`], [`radiometry`], [`optics`] (what happens at a point), [`medium`] (coefficients),
//! [`diffusion`] (profiles R(r)). See `docs/architecture.md`.

pub mod cli;
pub mod diffusion;
pub mod film;
pub mod math;
pub mod medium;
pub mod open_exr;
pub mod optics;
pub mod plan;
pub mod radiometry;
pub mod raycast;
pub mod scene;
pub mod slab;
pub mod study;
pub mod transport;
