//! A diffuse base under a dielectric coat: the dielectric of glTF 2.0 without its specular transmission.

use std::f32::consts::PI;

use glam::Vec3;

use super::albedo::SchlickAlbedo;
use super::bsdf::{BsdfSample, mirrored, to_side};
use super::fresnel::schlick_weight;
use super::microfacet::{Ggx, is_smooth};
use crate::math::warp::{cosine_hemisphere_density, square_to_cosine_hemisphere};
use crate::radiometry::Spectrum;

/// GGX reflection with Schlick's Fresnel factor over a base that reflects and transmits diffusely.
///
/// The glTF specification weights the base by 1 − F at the half vector, which makes energy towards
/// grazing. Here the base gets what the coat leaves in both directions,
/// (1 − E(μ_o))(1 − E(μ_i)) / (1 − Ē) (Kelemen and Szirmay-Kalos 2001, section 2.2): reciprocal, and a
/// white base reflects the rest, less a guard of about 0.1 % against errors of the albedo table, so that
/// the sum never exceeds 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plastic<const N: usize = 3> {
    /// Reflectance of the coat at normal incidence.
    pub reflectance_normal: f32,
    /// GGX width, roughness².
    pub alpha: f32,
    /// Share of the light in the base that is reflected diffusely; with `transmittance` at most 1.
    pub reflectance: Spectrum<N>,
    /// Share of the light in the base that is transmitted diffusely.
    pub transmittance: Spectrum<N>,
    /// True if the surface is a thin wall, with the same medium on both sides.
    pub thin: bool,
}

/// Probabilities of the lobes; they sum to 1.
struct Choice {
    specular: f32,
    reflection: f32,
    transmission: f32,
}

impl<const N: usize> Plastic<N> {
    /// True if the base is black and the coat smooth.
    pub fn is_delta_only(&self) -> bool {
        is_smooth(self.alpha) && self.reflectance.is_black() && self.transmittance.is_black()
    }

    /// f·|cos_i|, 1/sr; without a smooth coat, which is a delta lobe.
    pub fn evaluate(&self, wo: Vec3, wi: Vec3) -> Spectrum<N> {
        let base = self.base_factor(wo.z.abs(), wi.z.abs()) * wi.z.abs() / PI;
        if wo.z * wi.z < 0.0 {
            return self.transmittance * base;
        }
        if wo.z * wi.z == 0.0 {
            return Spectrum::ZERO;
        }
        let mut value = self.reflectance * base;
        if !is_smooth(self.alpha) {
            let (coat, cos) = self.ggx().reflection(to_side(wo, wo.z), to_side(wi, wo.z));
            value += Spectrum::splat(coat * self.schlick(cos));
        }
        value
    }

    /// Density of [`Self::sample`] per solid angle; without a smooth coat.
    pub fn density(&self, wo: Vec3, wi: Vec3) -> f32 {
        let Some(choice) = self.choice(wo) else { return 0.0 };
        let diffuse = cosine_hemisphere_density(wi.z.abs());
        if wo.z * wi.z < 0.0 {
            return choice.transmission * diffuse;
        }
        if wo.z * wi.z == 0.0 {
            return 0.0;
        }
        let specular = if is_smooth(self.alpha) {
            0.0
        } else {
            choice.specular * self.ggx().reflection_density(to_side(wo, wo.z), to_side(wi, wo.z))
        };
        specular + choice.reflection * diffuse
    }

    /// Chooses the coat or one of the diffuse lobes by their albedos.
    pub fn sample(&self, wo: Vec3, u: [f32; 3]) -> Option<BsdfSample<N>> {
        let choice = self.choice(wo)?;
        let direction = if u[2] < choice.specular {
            if is_smooth(self.alpha) {
                let weight = Spectrum::splat(self.schlick(wo.z.abs()) / choice.specular);
                return Some(BsdfSample::reflected(mirrored(wo), weight, choice.specular, true));
            }
            let sample = self.ggx().sample_reflection(to_side(wo, wo.z), [u[0], u[1]])?;
            to_side(sample.direction, wo.z)
        } else {
            let transmits = u[2] >= choice.specular + choice.reflection;
            let side = if transmits { -wo.z } else { wo.z };
            to_side(square_to_cosine_hemisphere(u[0], u[1]), side)
        };
        let density = self.density(wo, direction);
        if density <= 0.0 {
            return None;
        }
        let weight = self.evaluate(wo, direction) / density;
        Some(if direction.z * wo.z > 0.0 {
            BsdfSample::reflected(direction, weight, density, false)
        } else {
            BsdfSample::transmitted(direction, weight, density, false, !self.thin)
        })
    }

    pub(super) fn albedo_estimate(&self, wo: Vec3) -> f32 {
        let [specular, reflection, transmission] = self.lobe_albedos(wo);
        specular + reflection + transmission
    }

    fn choice(&self, wo: Vec3) -> Option<Choice> {
        let [specular, reflection, transmission] = self.lobe_albedos(wo);
        let sum = specular + reflection + transmission;
        (sum > 0.0 && wo.z != 0.0).then(|| Choice {
            specular: specular / sum,
            reflection: reflection / sum,
            transmission: transmission / sum,
        })
    }

    /// Albedos of coat, diffuse reflection and diffuse transmission towards `wo`, largest channel.
    fn lobe_albedos(&self, wo: Vec3) -> [f32; 3] {
        let specular = self.coat_albedo(wo.z.abs());
        let base = 1.0 - specular;
        [specular, base * self.reflectance.max_component(), base * self.transmittance.max_component()]
    }

    /// What the coat leaves to the base between two cosines, relative to a bare Lambert surface.
    fn base_factor(&self, cos_o: f32, cos_i: f32) -> f32 {
        if self.reflectance.is_black() && self.transmittance.is_black() {
            return 0.0;
        }
        let mean = 1.0 - SchlickAlbedo::mean(self.alpha).at(self.reflectance_normal);
        if mean <= 0.0 {
            return 0.0;
        }
        let left = |cos| SchlickAlbedo::least_remainder(cos, self.alpha, self.reflectance_normal);
        left(cos_o) * left(cos_i) / mean
    }

    fn coat_albedo(&self, cos: f32) -> f32 {
        SchlickAlbedo::directional(cos, self.alpha).at(self.reflectance_normal)
    }

    fn schlick(&self, cos: f32) -> f32 {
        self.reflectance_normal + (1.0 - self.reflectance_normal) * schlick_weight(cos)
    }

    fn ggx(&self) -> Ggx {
        Ggx { alpha: self.alpha }
    }
}
