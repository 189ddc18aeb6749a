//! The models by name, built for a medium whose mean free path 1/σ_t is the unit of length.

use crate::diffusion::{
    DiffusionModel, Fit, HalfSpace, ModelKind, Multipole, MultipoleError, NormalizedDiffusionModel, Profile,
    ShapeTable, UniformlyLitDirectionalDipole, tabulated,
};
use crate::medium::Entry;

/// A model, as the command line names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModelChoice {
    /// A model of a half-space; normalized diffusion with the fit for the entry, the directional dipole averaged over
    /// directions where light enters from all sides.
    Analytic(ModelKind),
    /// Normalized diffusion with one of its three fits.
    Normalized(Fit),
    /// The profile tabulated from Monte Carlo.
    Tabulated,
    /// The multipole of a slab.
    Multipole,
}

/// Why a model has nothing to say about a medium.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotApplicable {
    /// 1/σ_tr is infinite.
    #[error("without absorption there is no diffuse mean free path to scale it with")]
    NoAbsorption,
    /// Index or mean cosine outside of the table.
    #[error("the table does not cover index {eta} with g {g}")]
    NotTabulated {
        /// Relative index.
        eta: f64,
        /// Mean cosine.
        g: f64,
    },
    /// The multipole refuses the slab.
    #[error("{0}; all lengths in mean free paths 1/sigma_t")]
    Slab(MultipoleError),
}

impl ModelChoice {
    /// Those shown where none is asked for.
    pub const USUAL: [Self; 6] = [
        Self::Analytic(ModelKind::Dipole),
        Self::Analytic(ModelKind::BetterDipole),
        Self::Analytic(ModelKind::DirectionalDipole),
        Self::Analytic(ModelKind::NormalizedDiffusion),
        Self::Analytic(ModelKind::PhotonBeam),
        Self::Tabulated,
    ];

    /// Every model of a half-space.
    pub const ALL: [Self; 9] = [
        Self::Analytic(ModelKind::Dipole),
        Self::Analytic(ModelKind::BetterDipole),
        Self::Analytic(ModelKind::DirectionalDipole),
        Self::Analytic(ModelKind::NormalizedDiffusion),
        Self::Analytic(ModelKind::PhotonBeam),
        Self::Tabulated,
        Self::Normalized(Fit::Searchlight),
        Self::Normalized(Fit::DiffuseTransmission),
        Self::Normalized(Fit::DiffuseMeanFreePath),
    ];

    /// The name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Analytic(kind) => kind.name(),
            Self::Normalized(Fit::Searchlight) => "normalized-diffusion-searchlight",
            Self::Normalized(Fit::DiffuseTransmission) => "normalized-diffusion-diffuse",
            Self::Normalized(Fit::DiffuseMeanFreePath) => "normalized-diffusion-dmfp",
            Self::Tabulated => "tabulated",
            Self::Multipole => "multipole",
        }
    }

    /// The model of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().chain([Self::Multipole]).find(|choice| choice.name() == name)
    }

    /// The model of the half-space `medium` (lengths in mean free paths), whose exact total albedo is `albedo`.
    ///
    /// # Errors
    /// If the model has nothing to say about this medium.
    pub fn build(
        self,
        medium: &HalfSpace,
        entry: Entry,
        albedo: f64,
    ) -> Result<Box<dyn DiffusionModel>, NotApplicable> {
        let normalized = |fit| {
            let length = match fit {
                Fit::DiffuseMeanFreePath => (medium.diffusion_coefficient() / medium.sigma_a).sqrt(),
                Fit::Searchlight | Fit::DiffuseTransmission => medium.mean_free_path_reduced(),
            };
            NormalizedDiffusionModel::new(fit, albedo, length)
        };
        Ok(match (self, entry) {
            (Self::Analytic(ModelKind::DirectionalDipole), Entry::Diffuse) => {
                Box::new(UniformlyLitDirectionalDipole::new(medium))
            }
            (Self::Analytic(ModelKind::NormalizedDiffusion), Entry::Diffuse) => {
                Box::new(normalized(Fit::DiffuseTransmission))
            }
            (Self::Analytic(kind), _) => kind.build(medium, albedo),
            (Self::Normalized(Fit::DiffuseMeanFreePath), _) if medium.sigma_a == 0.0 => {
                return Err(NotApplicable::NoAbsorption);
            }
            (Self::Normalized(fit), _) => Box::new(normalized(fit)),
            (Self::Tabulated, _) => Box::new(TabulatedModel::new(medium, entry, albedo)?),
            (Self::Multipole, _) => Box::new(
                // A half-space is a slab of any great thickness.
                Multipole::new(medium, 1e6 * medium.mean_free_path_reduced()).map_err(NotApplicable::Slab)?,
            ),
        })
    }
}

/// The tabulated profile times the albedo.
pub struct TabulatedModel {
    table: ShapeTable,
    absorbed_share: f32,
    mean_free_path: f32,
    albedo: f64,
}

impl TabulatedModel {
    /// The profile of `medium`, whose exact total albedo is `albedo`.
    ///
    /// # Errors
    /// If the table does not cover it.
    pub fn new(medium: &HalfSpace, entry: Entry, albedo: f64) -> Result<Self, NotApplicable> {
        let HalfSpace { eta, g, .. } = *medium;
        if !tabulated::covers(eta, g) {
            return Err(NotApplicable::NotTabulated { eta, g });
        }
        Ok(Self {
            table: tabulated::shape_table(entry, eta, g),
            absorbed_share: medium.absorbed_share_reduced() as f32,
            mean_free_path: medium.mean_free_path_reduced() as f32,
            albedo,
        })
    }
}

impl DiffusionModel for TabulatedModel {
    fn reflectance(&self, radius: f64) -> f64 {
        let shape = self.table.shape(self.absorbed_share, self.mean_free_path);
        self.albedo * f64::from(shape.density(radius as f32))
    }

    fn albedo(&self) -> f64 {
        self.albedo
    }
}

/// What a multipole lets through, as a profile of its own.
pub struct FarFace(pub Multipole);

impl DiffusionModel for FarFace {
    fn reflectance(&self, radius: f64) -> f64 {
        self.0.transmittance(radius)
    }

    fn albedo(&self) -> f64 {
        self.0.total_transmittance()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_back_to_their_models() {
        for choice in ModelChoice::ALL {
            assert_eq!(ModelChoice::from_name(choice.name()), Some(choice));
        }
        assert_eq!(ModelChoice::from_name("tripole"), None);
    }
}
