//! The form in which the profiles of a material are evaluated, under one boundary.

use thiserror::Error;

use crate::diffusion::{
    BetterDipole, Dipole, DirectionalWeightTable, HalfSpaceError, ModelKind, PhotonBeam, ProfileKind,
    ShapeTable, UniformlyLitDirectionalDipole, tabulated,
};
use crate::medium::Entry;
use crate::optics::Boundary;

/// Why there is no such profile.
#[derive(Debug, Error)]
pub enum FormError {
    /// The table does not cover the material.
    #[error(
        "the tabulated profile covers relative indices from {} to {:.3} and g from {} to {}, not {eta} with g = {g}; \
         choose the profile \"photon-beam\", or leave it to \"auto\"",
        tabulated::eta_range()[0], tabulated::eta_range()[1], tabulated::g_range()[0], tabulated::g_range()[1]
    )]
    NotTabulated {
        /// Relative index asked for.
        eta: f64,
        /// Mean cosine asked for.
        g: f64,
    },
    /// No medium has this index or mean cosine.
    #[error(transparent)]
    HalfSpace(#[from] HalfSpaceError),
}

/// What makes the profiles of a material, whatever its albedo.
///
/// Only their form: the energy is that of transport theory, whatever the profile. The models' own differ from it
/// by up to a third.
pub enum Form {
    /// Normalized diffusion.
    Normalized,
    /// Any other.
    Shaped {
        /// Profiles.
        shapes: ShapeTable,
        /// What they leave to the direction of entry.
        directional: Option<DirectionalWeightTable>,
    },
}

/// The profile for a body of relative index `eta`: the one `asked` for, or the best one.
///
/// # Errors
/// If it is asked for where it does not exist.
pub fn profile_kind(asked: Option<ProfileKind>, eta: f64, g: f64) -> Result<ProfileKind, FormError> {
    match asked {
        None => Ok(ProfileKind::automatic(eta, g)),
        Some(ProfileKind::Tabulated) if !tabulated::covers(eta, g) => Err(FormError::NotTabulated { eta, g }),
        Some(kind) => Ok(kind),
    }
}

impl Form {
    /// The form of profile `kind` under `boundary`, for mean cosine `g`. Up to a few tenths of a second.
    ///
    /// # Errors
    /// If no half-space has such an index or mean cosine.
    pub fn new(kind: ProfileKind, boundary: &Boundary, g: f64) -> Result<Self, HalfSpaceError> {
        let eta = f64::from(boundary.eta());
        let shapes = match kind {
            ProfileKind::Tabulated => tabulated::shape_table(Entry::Diffuse, eta, g),
            ProfileKind::Model(ModelKind::NormalizedDiffusion) => return Ok(Self::Normalized),
            ProfileKind::Model(ModelKind::Dipole) => ShapeTable::of_model(eta, g, Dipole::new)?,
            ProfileKind::Model(ModelKind::BetterDipole) => ShapeTable::of_model(eta, g, BetterDipole::new)?,
            ProfileKind::Model(ModelKind::PhotonBeam) => ShapeTable::of_model(eta, g, PhotonBeam::new)?,
            ProfileKind::Model(ModelKind::DirectionalDipole) => {
                ShapeTable::of_model(eta, g, UniformlyLitDirectionalDipole::new)?
            }
        };
        let directional = match kind {
            ProfileKind::Model(ModelKind::DirectionalDipole) => Some(DirectionalWeightTable::new(boundary)?),
            _ => None,
        };
        Ok(Self::Shaped { shapes, directional })
    }
}
