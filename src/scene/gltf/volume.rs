//! What is inside a glTF body: KHR_materials_volume with either draft of scattering.

use super::extensions::Volume;
use crate::radiometry::{Rgb, Spectrum};

/// Smallest attenuation colour: black would be an infinite coefficient. e^−16 of the light is left
/// after one attenuation distance.
const MIN_ATTENUATION_COLOR: f32 = 1.125_351_7e-7;

/// Longest mean free path, m, where there is no extinction in a channel.
const MAX_MEAN_FREE_PATH: f32 = 1e6;

/// Which draft says how the multi-scatter colour becomes a single-scattering albedo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ScatterDraft {
    /// KHR_materials_volume_scatter.
    VolumeScatter,
    /// KHR_materials_scatter, which replaces it.
    Scatter,
}

impl ScatterDraft {
    /// Default multi-scatter colour.
    pub fn default_color(self) -> [f32; 3] {
        match self {
            Self::VolumeScatter => [0.0; 3],
            Self::Scatter => [1.0; 3],
        }
    }

    /// Default scatter strength; the older draft has none and scatters fully.
    pub fn default_strength(self) -> f32 {
        match self {
            Self::VolumeScatter => 1.0,
            Self::Scatter => 0.0,
        }
    }

    /// Single-scattering albedo of one channel from the multi-scatter colour ρ, both in [0, 1], and
    /// the mean cosine g (fit of Kulla and Conty 2017; the newer draft adds the similarity relation).
    pub fn single_scattering_albedo(self, multiscatter: f32, g: f32) -> f32 {
        let rho = f64::from(multiscatter);
        let s = 4.09712 + 4.20863 * rho - (9.59217 + 41.6808 * rho + 17.7126 * rho * rho).sqrt();
        let g = match self {
            Self::VolumeScatter => 0.0,
            Self::Scatter => f64::from(g),
        };
        let albedo = (1.0 - s * s) / (1.0 - g * s * s);
        albedo.clamp(0.0, 1.0) as f32
    }
}

/// Extinction coefficient σ_t = −ln(c)/d, 1/m, of attenuation colour c at distance d. Without
/// scattering it is all absorption.
pub(super) fn extinction(volume: &Volume) -> Rgb {
    let distance = volume.attenuation_distance;
    // 0 − … so that white gives 0 and not −0.
    Spectrum(volume.attenuation_color.map(|c| 0.0 - c.clamp(MIN_ATTENUATION_COLOR, 1.0).ln() / distance))
}

/// 1/σ_t, m, bounded where a channel has no extinction.
pub(super) fn mean_free_path(sigma_t: Rgb) -> Rgb {
    sigma_t.map(|s| (1.0 / s).min(MAX_MEAN_FREE_PATH))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extinction_leaves_the_attenuation_colour_after_its_distance() {
        let volume =
            Volume { thickness_factor: 1.0, attenuation_distance: 0.02, attenuation_color: [0.1, 0.5, 0.9] };
        let sigma_t = extinction(&volume);
        for c in 0..3 {
            let left = (-sigma_t[c] * volume.attenuation_distance).exp();
            // Four roundings (ln, /, ×, exp), the exponent's amplified by |ln c| < 2.4.
            assert!((left - volume.attenuation_color[c]).abs() <= 8.0 * f32::EPSILON, "{left}");
        }
        assert_eq!(extinction(&Volume::default()), Rgb::ZERO);
        let black = Volume { attenuation_color: [0.0; 3], ..volume };
        assert!(extinction(&black).is_finite());
        assert!(mean_free_path(Rgb::ZERO).is_finite());
    }

    #[test]
    fn albedo_mapping_meets_its_ends_and_grows() {
        for draft in [ScatterDraft::VolumeScatter, ScatterDraft::Scatter] {
            for g in [-0.9, 0.0, 0.9] {
                let albedo = |rho| draft.single_scattering_albedo(rho, g);
                // The fit's own error at its ends: s(0) = 0.99999, s(1) = −0.00002.
                assert!(albedo(0.0) < 3e-4, "{}", albedo(0.0));
                assert!(albedo(1.0) > 1.0 - 1e-6, "{}", albedo(1.0));
                let steps: Vec<f32> = (0..=100).map(|i| albedo(i as f32 / 100.0)).collect();
                assert!(steps.is_sorted());
            }
        }
    }

    #[test]
    fn drafts_agree_for_isotropic_scattering_and_differ_otherwise() {
        let both = |g| {
            [ScatterDraft::VolumeScatter, ScatterDraft::Scatter].map(|d| d.single_scattering_albedo(0.5, g))
        };
        let [old, new] = both(0.0);
        assert_eq!(old, new);
        let [old, new] = both(0.8);
        assert!(new > old);
    }
}
