//! The GGX distribution of microfacet normals, isotropic, with Smith masking.
//!
//! Directions are in the local frame and on the +z side unless said otherwise; a body lit from its
//! inside is handled by mirroring z before and after. References: Walter et al. 2007 (distribution),
//! Heitz 2014 (masking), Dupuy and Benyoub 2023 (sampling).

use std::f32::consts::{PI, TAU};

use glam::Vec3;

use super::fresnel::reflect;
use crate::math::robust::safe_sqrt;

/// Below this α a surface is treated as exactly smooth: its lobe is about a milliradian wide, and the
/// peak 1/(πα²) of the distribution would leave single precision few digits to work with.
pub const SMOOTH_ALPHA: f32 = 1e-3;

/// True if a surface of GGX width `alpha` (= roughness²) is treated as a mirror (delta lobe).
pub fn is_smooth(alpha: f32) -> bool {
    alpha.is_nan() || alpha < SMOOTH_ALPHA
}

/// A GGX microfacet surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx {
    /// Width of the distribution of slopes; roughness² in glTF.
    pub alpha: f32,
}

/// A direction found by reflecting at a sampled visible microfacet.
#[derive(Clone, Copy, Debug)]
pub struct MicrofacetReflection {
    /// The reflected direction.
    pub direction: Vec3,
    /// Cosine between either direction and the microfacet.
    pub cos_microfacet: f32,
    /// G₂/G₁: what is left of the light after shadowing, before Fresnel.
    pub weight: f32,
}

impl Ggx {
    /// Density D(m) of microfacet normals, 1/sr: ∫ D(m) m_z dω = 1 (Walter et al. 2007, eq. 33).
    pub fn distribution(&self, m: Vec3) -> f32 {
        if m.z <= 0.0 {
            return 0.0;
        }
        // cos²α² + sin² instead of cos²(α² − 1) + 1, which cancels near the normal.
        let a2 = self.alpha * self.alpha;
        let t = m.z * m.z * a2 + m.x * m.x + m.y * m.y;
        a2 / (PI * t * t)
    }

    /// √(cos² + α² sin²), in which G₁ and G₂ have no division by a vanishing cosine:
    /// 1 + 2Λ = `slope_root` / cos.
    fn slope_root(&self, cos: f32) -> f32 {
        let a2 = self.alpha * self.alpha;
        safe_sqrt(a2 + (1.0 - a2) * cos * cos)
    }

    /// Masking G₁ = 1/(1 + Λ), the share of the projected microfacet area visible under `cos`, with
    /// Smith's Λ = (root/cos − 1)/2 (Heitz 2014, eq. 72).
    pub fn masking(&self, cos: f32) -> f32 {
        2.0 * cos / (cos + self.slope_root(cos))
    }

    /// G₂ / cos_o, finite at grazing `cos_o`, with the height-correlated masking and shadowing
    /// G₂ = 1/(1 + Λ_o + Λ_i) (Heitz 2014, eq. 99).
    pub(super) fn shadowing_over_cos(&self, cos_o: f32, cos_i: f32) -> f32 {
        let sum = cos_i * self.slope_root(cos_o) + cos_o * self.slope_root(cos_i);
        if sum > 0.0 { 2.0 * cos_i / sum } else { 0.0 }
    }

    /// G₂ / G₁(o), the weight of a direction found through a visible normal; at most 1.
    pub(super) fn shadowing_given_visible(&self, cos_o: f32, cos_i: f32) -> f32 {
        let root = self.slope_root(cos_o);
        let sum = cos_i * root + cos_o * self.slope_root(cos_i);
        if sum > 0.0 { (cos_i * (cos_o + root) / sum).min(1.0) } else { 0.0 }
    }

    /// A microfacet normal as seen from `wo`, by the spherical caps of Dupuy and Benyoub 2023
    /// (listing 3); density [`Self::visible_normal_density`].
    pub fn sample_visible_normal(&self, wo: Vec3, u: [f32; 2]) -> Vec3 {
        let w = Vec3::new(self.alpha * wo.x, self.alpha * wo.y, wo.z).normalize();
        // The cap −w_z ≤ z ≤ 1, written with 1 − z so that neither sin nor z + w_z cancels.
        let one_minus_z = u[1] * (1.0 + w.z);
        let sin = safe_sqrt(one_minus_z * (2.0 - one_minus_z));
        let (sin_phi, cos_phi) = (TAU * u[0]).sin_cos();
        let h = Vec3::new(sin * cos_phi + w.x, sin * sin_phi + w.y, (1.0 - u[1]) * (1.0 + w.z));
        Vec3::new(self.alpha * h.x, self.alpha * h.y, h.z).normalize()
    }

    /// Density G₁ (wo·m) D(m) / cos_o of visible normals, 1/sr (Heitz 2014, eq. 16).
    pub fn visible_normal_density(&self, wo: Vec3, m: Vec3) -> f32 {
        let cos = wo.dot(m).max(0.0);
        2.0 * cos * self.distribution(m) / (wo.z + self.slope_root(wo.z))
    }

    /// D G₂ / (4 cos_o), 1/sr: reflection times cos_i, without Fresnel, and the cosine with the
    /// microfacet at which Fresnel is to be taken. Both directions must have z > 0.
    pub fn reflection(&self, wo: Vec3, wi: Vec3) -> (f32, f32) {
        let m = (wo + wi).normalize_or_zero();
        let value = 0.25 * self.distribution(m) * self.shadowing_over_cos(wo.z, wi.z);
        (value, wo.dot(m))
    }

    /// Density of [`Self::sample_reflection`] per solid angle of `wi`. Its integral is below 1 by the
    /// probability that the reflected ray goes below the horizon.
    pub fn reflection_density(&self, wo: Vec3, wi: Vec3) -> f32 {
        let m = (wo + wi).normalize_or_zero();
        0.5 * self.distribution(m) / (wo.z + self.slope_root(wo.z))
    }

    /// Reflects `wo` at a visible microfacet; nothing if the result points below the horizon.
    pub fn sample_reflection(&self, wo: Vec3, u: [f32; 2]) -> Option<MicrofacetReflection> {
        let m = self.sample_visible_normal(wo, u);
        let direction = reflect(wo, m);
        (direction.z > 0.0).then(|| MicrofacetReflection {
            direction,
            cos_microfacet: wo.dot(m),
            weight: self.shadowing_given_visible(wo.z, direction.z),
        })
    }
}
