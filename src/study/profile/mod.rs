//! Diffusion profiles beside the truth: every model of R(r) against photon Monte Carlo.
//!
//! Lengths inside are mean free paths 1/σ_t of the channel, light is per unit flux that entered; outputs are in
//! millimetres. Both sides are compared as light in rings of a twelfth of a decade of radius ([`rings`]).

pub mod comparison;
pub mod cost;
pub mod figures;
pub mod fit;
pub mod lengths;
pub mod material;
pub mod measured;
pub mod models;
pub mod rings;
pub mod summary;
pub mod sweep;
pub mod tables;
pub mod truth;

pub use comparison::{ChannelResult, ModelResult, Quantity, Settings, compare};
pub use fit::{FitProblem, FitResult};
pub use material::{Channel, Coefficients, Material, MaterialError};
pub use measured::MeasuredProfile;
pub use models::ModelChoice;
pub use sweep::{Sweep, SweepPoint};
pub use truth::{Effort, Watch};
