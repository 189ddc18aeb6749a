//! Diffusion profiles: how far along the surface light spreads under it. One file a model.

pub mod better_dipole;
pub mod boundary_moments;
pub mod choice;
pub mod dipole;
pub mod directional_dipole;
pub mod directional_weight;
pub mod half_space;
pub mod integrate;
pub mod mirrored_source;
pub mod model_kind;
pub mod multipole;
pub mod normalized_diffusion;
pub mod photon_beam;
pub mod shape;
pub mod shape_of_model;
pub mod tabulated;

pub use better_dipole::BetterDipole;
pub use boundary_moments::BoundaryMoments;
pub use choice::ProfileKind;
pub use dipole::Dipole;
pub use directional_dipole::{DirectionalDipole, UniformlyLitDirectionalDipole};
pub use directional_weight::{DirectionalWeight, DirectionalWeightTable};
pub use half_space::{HalfSpace, HalfSpaceError};
pub use mirrored_source::MirroredSource;
pub use model_kind::ModelKind;
pub use multipole::{Multipole, MultipoleError};
pub use normalized_diffusion::{Fit, NormalizedDiffusion, NormalizedDiffusionModel};
pub use photon_beam::PhotonBeam;
pub use shape::{Shape, ShapeTable};

/// A radially symmetric diffusion profile R(r) of unit energy, ∫₀^∞ R(r) 2πr dr = 1: the planar
/// albedo multiplies it. R falls strictly with r.
pub trait Profile {
    /// R(r), 1/m². Infinite at r = 0 where the profile has a pole.
    fn density(&self, radius: f32) -> f32;

    /// Energy within `radius`, ∫₀^r R(r') 2πr' dr'.
    fn cumulative(&self, radius: f32) -> f32;

    /// The radius within which the share `xi` in [0, 1) of the energy lies: the inverse of
    /// [`Self::cumulative`].
    fn sample_radius(&self, xi: f32) -> f32;

    /// A radius beyond which R stays below `ratio`·R(`radius`), for `ratio` in (0, 1]. An upper
    /// bound; tight to a small factor.
    fn radius_of_ratio(&self, radius: f32, ratio: f32) -> f32;
}

/// A radially symmetric model of how a flat half-space, or slab, spreads the light that enters it at
/// one point, evaluated in double precision: for study, and to tabulate from.
pub trait DiffusionModel: Sync {
    /// R_d(r), 1/m²: flux per area that leaves at distance `radius` (m) from where unit flux entered.
    /// Never negative.
    fn reflectance(&self, radius: f64) -> f64;

    /// Total albedo ∫₀^∞ R_d(r) 2πr dr.
    fn albedo(&self) -> f64;
}
