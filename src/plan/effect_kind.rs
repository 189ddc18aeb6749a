//! The effects of light that are told apart, by name.

use super::kernel::Abilities;

/// An effect of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EffectKind {
    /// Light that goes in and comes out elsewhere, by whatever method.
    SubsurfaceScattering,
    /// The same, by the area integral of the BSSRDF.
    AreaIntegral,
    /// The same, collision by collision.
    RandomWalk,
    /// Another index of refraction inside of bodies than around them.
    Refraction,
    /// Boundaries and metals with microfacets.
    RoughSurfaces,
    /// Absorption in clear bodies.
    Absorption,
    /// Scattering that is not alike in all directions.
    AnisotropicScattering,
    /// Mean free paths that differ between the channels.
    ColoursOfMeanFreePaths,
    /// Media whose albedo varies over the surface.
    TexturedCoefficients,
    /// Anything that varies over a surface.
    Textures,
    /// Normals from textures.
    NormalMaps,
    /// Surfaces that are there in part only.
    PartialCoverage,
    /// Light by wavelength, not by red, green and blue.
    Spectral,
    /// Indices of refraction that depend on the wavelength.
    Dispersion,
    /// Bodies inside of others.
    NestedMedia,
    /// Light from what has a size.
    AreaLights,
    /// Light from points, spots and directions.
    LightsWithoutSize,
    /// Light from infinitely far away.
    Environment,
    /// Depth of field.
    Lens,
    /// Light that comes by way of more than one surface.
    IndirectLight,
}

impl EffectKind {
    /// All of them, in the order of reports.
    pub const ALL: [Self; 20] = [
        Self::SubsurfaceScattering,
        Self::AreaIntegral,
        Self::RandomWalk,
        Self::Refraction,
        Self::RoughSurfaces,
        Self::Absorption,
        Self::AnisotropicScattering,
        Self::ColoursOfMeanFreePaths,
        Self::TexturedCoefficients,
        Self::Textures,
        Self::NormalMaps,
        Self::PartialCoverage,
        Self::Spectral,
        Self::Dispersion,
        Self::NestedMedia,
        Self::AreaLights,
        Self::LightsWithoutSize,
        Self::Environment,
        Self::Lens,
        Self::IndirectLight,
    ];

    /// Its name in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::SubsurfaceScattering => "subsurface scattering",
            Self::AreaIntegral => "area integral",
            Self::RandomWalk => "random walk",
            Self::Refraction => "refraction",
            Self::RoughSurfaces => "rough surfaces",
            Self::Absorption => "absorption",
            Self::AnisotropicScattering => "anisotropic scattering",
            Self::ColoursOfMeanFreePaths => "colours of mean free paths",
            Self::TexturedCoefficients => "textured coefficients",
            Self::Textures => "textures",
            Self::NormalMaps => "normal maps",
            Self::PartialCoverage => "partial coverage",
            Self::Spectral => "spectral",
            Self::Dispersion => "dispersion",
            Self::NestedMedia => "nested media",
            Self::AreaLights => "area lights",
            Self::LightsWithoutSize => "lights without size",
            Self::Environment => "environment",
            Self::Lens => "lens",
            Self::IndirectLight => "indirect light",
        }
    }

    /// True if it is a choice of how light under the surface is computed.
    pub fn is_method(self) -> bool {
        matches!(self, Self::SubsurfaceScattering | Self::AreaIntegral | Self::RandomWalk)
    }

    /// Its name as one word, as it is typed.
    pub fn word(self) -> String {
        self.name().replace(' ', "-")
    }

    /// The effect with a name, in words or as one; `None` if there is none.
    pub fn of_name(name: &str) -> Option<Self> {
        let words = name.trim().to_lowercase().replace(['-', '_'], " ");
        Self::ALL.into_iter().find(|kind| kind.name() == words)
    }

    /// What a kernel has to have code for if a path is to meet the effect; nothing for those that all kernels know.
    pub const fn abilities(self) -> Abilities {
        match self {
            Self::AreaIntegral | Self::SubsurfaceScattering => Abilities::SUBSURFACE,
            Self::RandomWalk => Abilities::WALKS.and(Abilities::INTERIORS),
            Self::Refraction | Self::Absorption | Self::NestedMedia => Abilities::INTERIORS,
            Self::TexturedCoefficients | Self::Textures | Self::NormalMaps => Abilities::TEXTURES,
            Self::PartialCoverage => Abilities::COVERAGE.and(Abilities::TEXTURES),
            Self::Spectral | Self::Dispersion => Abilities::SPECTRAL,
            Self::RoughSurfaces
            | Self::AnisotropicScattering
            | Self::ColoursOfMeanFreePaths
            | Self::AreaLights
            | Self::LightsWithoutSize
            | Self::Environment
            | Self::Lens
            | Self::IndirectLight => Abilities::NONE,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_printed_can_be_typed() {
        for (place, kind) in EffectKind::ALL.into_iter().enumerate() {
            assert_eq!(kind as usize, place);
            for name in [kind.name(), &kind.word(), &kind.name().to_uppercase(), " lens "] {
                let expected = if name == " lens " { EffectKind::Lens } else { kind };
                assert_eq!(EffectKind::of_name(name), Some(expected));
            }
        }
        assert_eq!(EffectKind::of_name("lenses"), None);
    }
}
