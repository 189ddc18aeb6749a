//! Film, subsurface and render settings.

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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SubsurfaceSettings {
    /// Method.
    pub method: Method,
    /// Diffusion profile, where the method uses one.
    pub profile: ProfileChoice,
}

/// How much work is done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderSettings {
    /// Samples per pixel.
    pub spp: u32,
    /// Longest path in bounces; 0: no limit.
    pub max_depth: u32,
}

impl Default for RenderSettings {
    fn default() -> Self {
        Self { spp: 64, max_depth: 0 }
    }
}
