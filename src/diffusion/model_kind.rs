//! The analytic models by the names that a scene file gives them.

use super::normalized_diffusion::{Fit, NormalizedDiffusionModel};
use super::{BetterDipole, DiffusionModel, Dipole, DirectionalDipole, HalfSpace, PhotonBeam};

/// An analytic model of a half-space lit at normal incidence.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ModelKind {
    /// Jensen et al. 2001.
    Dipole,
    /// d'Eon 2012.
    BetterDipole,
    /// Frisvad et al. 2014.
    DirectionalDipole,
    /// Christensen and Burley 2015, their fit to a searchlight.
    NormalizedDiffusion,
    /// Habel et al. 2013.
    PhotonBeam,
}

impl ModelKind {
    /// Every model, oldest method first.
    pub const ALL: [Self; 5] = [
        Self::Dipole,
        Self::BetterDipole,
        Self::DirectionalDipole,
        Self::NormalizedDiffusion,
        Self::PhotonBeam,
    ];

    /// The name in scene files, on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Dipole => "dipole",
            Self::BetterDipole => "better-dipole",
            Self::DirectionalDipole => "directional-dipole",
            Self::NormalizedDiffusion => "normalized-diffusion",
            Self::PhotonBeam => "photon-beam",
        }
    }

    /// The model of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// The model of `half_space`. `albedo` is the exact total albedo of that half-space, which
    /// normalized diffusion is given and the others estimate.
    pub fn build(self, half_space: &HalfSpace, albedo: f64) -> Box<dyn DiffusionModel> {
        match self {
            Self::Dipole => Box::new(Dipole::new(half_space)),
            Self::BetterDipole => Box::new(BetterDipole::new(half_space)),
            Self::DirectionalDipole => Box::new(DirectionalDipole::new(half_space)),
            Self::NormalizedDiffusion => Box::new(NormalizedDiffusionModel::new(
                Fit::Searchlight,
                albedo,
                half_space.mean_free_path_reduced(),
            )),
            Self::PhotonBeam => Box::new(PhotonBeam::new(half_space)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_back_to_their_models() {
        for kind in ModelKind::ALL {
            assert_eq!(ModelKind::from_name(kind.name()), Some(kind));
        }
        assert_eq!(ModelKind::from_name("tripole"), None);
    }

    #[test]
    fn every_model_is_finite_and_not_negative_in_every_limit() {
        let media = [
            HalfSpace::new(0.0, 1.0, 0.0, 1.5),
            HalfSpace::new(1e-12, 1.0, 0.0, 1.5),
            HalfSpace::new(1.0, 0.0, 0.0, 1.5),
            HalfSpace::new(1.0, 1e-12, 0.0, 1.5),
            HalfSpace::new(0.1, 1.0, 0.99, 1.0),
            HalfSpace::new(0.1, 1.0, -0.99, 1.0 + 1e-9),
            HalfSpace::new(0.1, 1.0, 0.5, 0.75),
            HalfSpace::new(1e-9, 1e9, 0.5, 2.5),
        ];
        for half_space in media.map(Result::unwrap) {
            for kind in ModelKind::ALL {
                let model = kind.build(&half_space, 0.5);
                let context = format!("{kind:?} {half_space:?}");
                assert!(model.albedo() >= 0.0 && model.albedo() < 2.0, "{context}: {}", model.albedo());
                assert!(model.reflectance(0.0) >= 0.0, "{context}");
                for radius in [1e-12, 1e-6, 1e-3, 1.0, 1e3, 1e9] {
                    let value = model.reflectance(radius * half_space.mean_free_path_reduced());
                    assert!(value >= 0.0 && value.is_finite(), "{context} at {radius}: {value}");
                }
            }
        }
    }
}
