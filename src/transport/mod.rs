//! Light carried through the scene: the path tracer, direct light, the area integral.

pub mod area_integral;
pub mod basis;
pub mod clearance;
mod contact;
pub mod counters;
mod entry;
mod exposure;
pub mod form;
pub mod guide;
mod inspection;
pub mod interiors;
mod inventory;
pub mod light_choice;
pub mod light_sampling;
mod path;
mod placement;
mod power;
mod recenter;
pub mod renderer;
pub mod scatterer;
mod shading;
pub mod spectra;
pub mod spheres;
pub mod spread;
pub mod substance;
mod warnings;
pub mod world;

pub use counters::{Counters, ProbeCounters};
pub use inspection::{Boundaries, PlaneBssrdf};
pub use inventory::Inventory;
pub use power::{Power, PowerBalance, Unbalanced};
pub use renderer::{RenderError, RenderOptions, Renderer};
pub use shading::Lobes;
