//! Diffusion profiles: how far along the surface light spreads under it. One file a model.

pub mod normalized_diffusion;
pub mod shape;

pub use normalized_diffusion::NormalizedDiffusion;
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
