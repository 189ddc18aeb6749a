//! Reflection by a conductor.

use glam::Vec3;

use super::bsdf::{BsdfSample, mirrored, to_side};
use super::fresnel::fresnel_conductor_schlick;
use super::microfacet::{Ggx, is_smooth};
use crate::radiometry::Spectrum;

/// A conductor under GGX microfacets, Fresnel by Schlick. Light that would leave after a second
/// microfacet is lost: a rough metal reflects somewhat less than a smooth one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metal<const N: usize = 3> {
    /// Reflectance at normal incidence, in [0, 1].
    pub reflectance_normal: Spectrum<N>,
    /// GGX width, roughness².
    pub alpha: f32,
}

impl<const N: usize> Metal<N> {
    /// True if reflection is a mirror.
    pub fn is_smooth(&self) -> bool {
        is_smooth(self.alpha)
    }

    /// f·|cos_i|, 1/sr.
    pub fn evaluate(&self, wo: Vec3, wi: Vec3) -> Spectrum<N> {
        if self.is_smooth() || wo.z * wi.z <= 0.0 {
            return Spectrum::ZERO;
        }
        let (value, cos) = self.ggx().reflection(to_side(wo, wo.z), to_side(wi, wo.z));
        fresnel_conductor_schlick(self.reflectance_normal, cos) * value
    }

    /// Density of [`Self::sample`] per solid angle.
    pub fn density(&self, wo: Vec3, wi: Vec3) -> f32 {
        if self.is_smooth() || wo.z * wi.z <= 0.0 {
            return 0.0;
        }
        self.ggx().reflection_density(to_side(wo, wo.z), to_side(wi, wo.z))
    }

    /// Reflects at a visible microfacet.
    pub fn sample(&self, wo: Vec3, u: [f32; 2]) -> Option<BsdfSample<N>> {
        if wo.z == 0.0 {
            return None;
        }
        if self.is_smooth() {
            let weight = fresnel_conductor_schlick(self.reflectance_normal, wo.z.abs());
            return Some(BsdfSample::reflected(mirrored(wo), weight, 1.0, true));
        }
        let upper = to_side(wo, wo.z);
        let sample = self.ggx().sample_reflection(upper, u)?;
        let density = self.ggx().reflection_density(upper, sample.direction);
        let weight = fresnel_conductor_schlick(self.reflectance_normal, sample.cos_microfacet);
        let direction = to_side(sample.direction, wo.z);
        Some(BsdfSample::reflected(direction, weight * sample.weight, density, false))
    }

    pub(super) fn albedo_estimate(&self, wo: Vec3) -> f32 {
        fresnel_conductor_schlick(self.reflectance_normal, wo.z.abs()).max_component()
    }

    fn ggx(&self) -> Ggx {
        Ggx { alpha: self.alpha }
    }
}
