//! Effects switched on or off by the user, whatever the scene calls for.

use thiserror::Error;

use super::effect_kind::EffectKind;
use super::effects::effects;
use super::kernel::Abilities;
use super::without::leave_out;
use crate::scene::Scene;

/// Why an effect cannot be switched as asked for.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum ForceError {
    /// Two wishes that cannot both be met.
    #[error("`{0}` and `{1}` contradict each other; drop one of them")]
    Contradiction(String, String),
    /// The scene has nothing to show it on.
    #[error("`{}=on`: the scene cannot do it: {reason}; {remedy}", .kind.word())]
    NotThere {
        /// The effect.
        kind: EffectKind,
        /// Why not.
        reason: String,
        /// What would help.
        remedy: &'static str,
    },
    /// Bodies are where they are.
    #[error("`nested-media=off`: {0}; move the bodies apart, or leave one out of the scene")]
    Placed(String),
}

/// Effects that are switched on or off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Forces {
    /// By the place of the effect among all.
    on: u32,
    off: u32,
}

/// Wishes that exclude each other, beside an effect on and off.
const CONTRADICTIONS: [[(EffectKind, bool); 2]; 7] = [
    [(EffectKind::AreaIntegral, true), (EffectKind::RandomWalk, true)],
    [(EffectKind::AreaIntegral, true), (EffectKind::SubsurfaceScattering, false)],
    [(EffectKind::RandomWalk, true), (EffectKind::SubsurfaceScattering, false)],
    [(EffectKind::NormalMaps, true), (EffectKind::Textures, false)],
    [(EffectKind::TexturedCoefficients, true), (EffectKind::Textures, false)],
    [(EffectKind::Dispersion, true), (EffectKind::Spectral, false)],
    [(EffectKind::Dispersion, true), (EffectKind::Refraction, false)],
];

impl Forces {
    /// Each effect switched as said; dispersion brings wavelengths with it.
    ///
    /// # Errors
    /// Wishes that contradict each other.
    pub fn new(wishes: impl IntoIterator<Item = (EffectKind, bool)>) -> Result<Self, ForceError> {
        let mut forces = Self::default();
        for (kind, on) in wishes {
            *(if on { &mut forces.on } else { &mut forces.off }) |= 1 << kind as u32;
        }
        let opposites = EffectKind::ALL.map(|kind| [(kind, true), (kind, false)]);
        for [first, second] in opposites.into_iter().chain(CONTRADICTIONS) {
            if forces.has(first) && forces.has(second) {
                return Err(ForceError::Contradiction(typed(first), typed(second)));
            }
        }
        if forces.is_on(EffectKind::Dispersion) {
            forces.on |= 1 << EffectKind::Spectral as u32;
        }
        Ok(forces)
    }

    fn has(&self, (kind, on): (EffectKind, bool)) -> bool {
        (if on { self.on } else { self.off }) & 1 << kind as u32 != 0
    }

    /// True if the effect is switched on.
    pub fn is_on(&self, kind: EffectKind) -> bool {
        self.has((kind, true))
    }

    /// True if the effect is switched off.
    pub fn is_off(&self, kind: EffectKind) -> bool {
        self.has((kind, false))
    }

    /// What a kernel has to have code for because of effects that are switched on.
    pub fn abilities(&self) -> Abilities {
        let on = EffectKind::ALL.into_iter().filter(|&kind| self.is_on(kind));
        on.fold(Abilities::NONE, |all, kind| all.and(kind.abilities()))
    }

    /// Leaves the effects that are switched off out of `scene`; to do so again changes nothing. The methods of translucent bodies are left
    /// to the plan.
    ///
    /// # Errors
    /// An effect is switched on that the scene cannot have, or off that it cannot do without.
    pub fn apply(&self, scene: &mut Scene) -> Result<(), ForceError> {
        if *self == Self::default() {
            return Ok(());
        }
        self.check(scene)?;
        EffectKind::ALL.into_iter().filter(|&kind| self.is_off(kind)).for_each(|kind| leave_out(scene, kind));
        Ok(())
    }

    fn check(&self, scene: &Scene) -> Result<(), ForceError> {
        // Whether there is any dispersion is seen by wavelength.
        let found = effects(scene, &[], &Self { on: 1 << EffectKind::Spectral as u32, off: 0 });
        let of = |kind: EffectKind| &found[kind as usize];
        for kind in EffectKind::ALL.into_iter().filter(|&kind| self.is_on(kind)) {
            let called_for = match kind {
                EffectKind::AreaIntegral | EffectKind::RandomWalk => of(EffectKind::SubsurfaceScattering),
                _ => of(kind),
            };
            if !called_for.on
                && let Some(remedy) = remedy(kind)
            {
                return Err(ForceError::NotThere { kind, reason: called_for.reason.clone(), remedy });
            }
        }
        let nested = of(EffectKind::NestedMedia);
        match self.is_off(EffectKind::NestedMedia) && nested.on {
            true => Err(ForceError::Placed(nested.reason.clone())),
            false => Ok(()),
        }
    }
}

/// As a wish is typed.
fn typed((kind, on): (EffectKind, bool)) -> String {
    format!("{}={}", kind.word(), if on { "on" } else { "off" })
}

/// What gives a scene the effect; `None` if a kernel can keep the code for it without.
fn remedy(kind: EffectKind) -> Option<&'static str> {
    Some(match kind {
        EffectKind::SubsurfaceScattering | EffectKind::AreaIntegral | EffectKind::RandomWalk => {
            "give an object a material of type \"translucent\""
        }
        EffectKind::RoughSurfaces => "give a material a `roughness`",
        EffectKind::AnisotropicScattering => "give a translucent material a mean cosine `g`",
        EffectKind::ColoursOfMeanFreePaths => "give a translucent material a mean free path for each channel",
        EffectKind::Dispersion => {
            "give a clear material an `abbe` number, or `cauchy` or `sellmeier` coefficients"
        }
        EffectKind::AreaLights => "add a light that has a size, or a material with `emission`",
        EffectKind::LightsWithoutSize => "add a light of type \"point\", \"spot\" or \"directional\"",
        EffectKind::Environment => "add an [environment]",
        EffectKind::Lens => "give the camera an `aperture`",
        EffectKind::IndirectLight => "take `max_depth` out of [render]",
        EffectKind::Refraction
        | EffectKind::Absorption
        | EffectKind::TexturedCoefficients
        | EffectKind::Textures
        | EffectKind::NormalMaps
        | EffectKind::PartialCoverage
        | EffectKind::Spectral
        | EffectKind::NestedMedia => return None,
    })
}
