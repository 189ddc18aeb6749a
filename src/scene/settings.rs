//! Film, subsurface and render settings.

use crate::diffusion::{ModelKind, ProfileKind};

/// Resolution and reconstruction filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmSettings {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Reconstruction filter, applied by sample placement.
    pub filter: Filter,
}

impl Default for FilmSettings {
    fn default() -> Self {
        Self { width: 512, height: 512, filter: Filter::default() }
    }
}

/// Reconstruction filters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// The pixel's own square.
    Box,
    /// Gaussian of standard deviation 0.5 pixel, cut at 1.5 pixels.
    Gaussian,
    /// Blackman–Harris window 3 pixels wide.
    #[default]
    BlackmanHarris,
}

/// How light under the surface is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Method {
    /// The program chooses.
    #[default]
    Auto,
    /// The area integral of the BSSRDF with probe rays.
    Bssrdf,
    /// Volumetric random walk.
    Walk,
    /// Light leaves where it entered.
    Diffuse,
}

/// Diffusion profiles by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ProfileChoice {
    /// The program chooses.
    #[default]
    Auto,
    /// Jensen et al. 2001.
    Dipole,
    /// d'Eon 2012.
    BetterDipole,
    /// Frisvad et al. 2014.
    DirectionalDipole,
    /// Christensen and Burley 2015.
    NormalizedDiffusion,
    /// Habel et al. 2013.
    PhotonBeam,
    /// Tabulated from Monte Carlo.
    Tabulated,
}

/// How subsurface scattering is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SubsurfaceSettings {
    /// Method.
    pub method: Method,
    /// Diffusion profile, where the method uses one.
    pub profile: ProfileChoice,
    /// The largest relative error that an approximation may be expected to have where the program chooses the method.
    pub accuracy: f32,
    /// Whether walks take the isotropic medium of reduced coefficients for an anisotropic one far from surfaces: faster, and an
    /// approximation.
    pub similarity: bool,
}

impl Default for SubsurfaceSettings {
    fn default() -> Self {
        Self {
            method: Method::default(),
            profile: ProfileChoice::default(),
            accuracy: 0.02,
            similarity: false,
        }
    }
}

/// How much work is done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderSettings {
    /// Samples per pixel.
    pub spp: u32,
    /// Longest path in bounces; 0: no limit.
    pub max_depth: u32,
    /// How colour is carried.
    pub color_mode: ColorMode,
}

/// How colour is carried along a path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorMode {
    /// The program chooses.
    #[default]
    Auto,
    /// Three channels at once.
    Rgb,
    /// By wavelength.
    Spectral,
}

impl Filter {
    /// Names in scene files and on the command line.
    pub const NAMES: [(&'static str, Self); 3] =
        [("box", Self::Box), ("gaussian", Self::Gaussian), ("blackman-harris", Self::BlackmanHarris)];
}

impl Method {
    /// Names in scene files and on the command line.
    pub const NAMES: [(&'static str, Self); 4] =
        [("auto", Self::Auto), ("bssrdf", Self::Bssrdf), ("walk", Self::Walk), ("diffuse", Self::Diffuse)];

    /// Name in scene files and on the command line.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, method)| *method == self).map_or("", |(name, _)| name)
    }
}

impl ProfileChoice {
    /// Names in scene files and on the command line.
    pub const NAMES: [(&'static str, Self); 7] = [
        ("auto", Self::Auto),
        ("dipole", Self::Dipole),
        ("better-dipole", Self::BetterDipole),
        ("directional-dipole", Self::DirectionalDipole),
        ("normalized-diffusion", Self::NormalizedDiffusion),
        ("photon-beam", Self::PhotonBeam),
        ("tabulated", Self::Tabulated),
    ];

    /// The profile chosen; `None`: the program chooses.
    pub fn kind(self) -> Option<ProfileKind> {
        let model = match self {
            Self::Auto => return None,
            Self::Tabulated => return Some(ProfileKind::Tabulated),
            Self::Dipole => ModelKind::Dipole,
            Self::BetterDipole => ModelKind::BetterDipole,
            Self::DirectionalDipole => ModelKind::DirectionalDipole,
            Self::NormalizedDiffusion => ModelKind::NormalizedDiffusion,
            Self::PhotonBeam => ModelKind::PhotonBeam,
        };
        Some(ProfileKind::Model(model))
    }

    /// Name in scene files and on the command line.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, choice)| *choice == self).map_or("", |(name, _)| name)
    }
}

impl ColorMode {
    /// Names in scene files and on the command line.
    pub const NAMES: [(&'static str, Self); 3] =
        [("auto", Self::Auto), ("rgb", Self::Rgb), ("spectral", Self::Spectral)];
}

impl Default for RenderSettings {
    fn default() -> Self {
        Self { spp: 64, max_depth: 0, color_mode: ColorMode::default() }
    }
}
