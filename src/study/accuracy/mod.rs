//! What accuracy costs in time: every method on one scene, against a reference by the random walk.
//!
//! relMSE of a picture after T seconds is B² + V/T. The study measures B², the bias, and V, the noise, of every method
//! apart ([`errors`]), with the noise of the reference subtracted, and from them the time T* = (V_walk − V)/B²
//! beyond which the walk is the better buy. Everything is averaged over independent runs, whose spread gives the
//! errors of the figures ([`mod@jackknife`]).

pub mod advice;
pub mod candidate;
pub mod collisions;
pub mod crossover;
pub mod effects;
pub mod errors;
pub mod evaluate;
pub mod jackknife;
pub mod maps;
pub mod model;
pub mod parts;
pub mod plan;
pub mod regions;
pub mod rendering;
pub mod report;
pub mod results;
pub mod settings;
pub mod store;
pub mod study;
pub mod summary;
pub mod tables;
pub mod tail;

pub use candidate::{Candidate, candidates};
pub use results::Results;
pub use settings::{Settings, affordable, digest};
pub use store::Store;
pub use study::{Outcome, StudyError, Watch, study};
