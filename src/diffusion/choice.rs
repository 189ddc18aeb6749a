//! Which diffusion profile a renderer takes where it is left the choice.

use super::ModelKind;
use super::tabulated;

/// A diffusion profile by how it is made: from an analytic model, or from Monte Carlo.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ProfileKind {
    /// The form of a model.
    Model(ModelKind),
    /// Tabulated from Monte Carlo.
    Tabulated,
}

impl ProfileKind {
    /// The name in scene files, on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Model(kind) => kind.name(),
            Self::Tabulated => "tabulated",
        }
    }

    /// The profile for half-spaces of relative index `eta` and mean cosine `g`: the tabulated one, which is
    /// the truth up to interpolation, where the table [covers](tabulated::covers) them, and the most accurate
    /// of the models elsewhere. Whatever the albedo: it may vary over a surface and between its channels.
    pub fn automatic(eta: f64, g: f64) -> Self {
        if tabulated::covers(eta, g) { Self::Tabulated } else { Self::Model(ModelKind::PhotonBeam) }
    }
}
