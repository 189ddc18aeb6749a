//! One picture beside another: errors, bias and its noise, what a person would see, and where.
//!
//! A is what is judged, B the reference. Pixels of which a channel is not finite in either picture are left out
//! of every number, and counted.

pub mod flip;
pub mod heat_map;
pub mod legend;
pub mod metrics;
pub mod overlap;

pub use metrics::{Comparison, Estimate, NothingToCompare, compare};
