//! The metallic-roughness material of glTF 2.0 (appendix B of its specification) with
//! KHR_materials_ior, _transmission, _volume and _diffuse_transmission, resolved at a point.

use glam::Vec3;

use super::bsdf::{Bsdf, BsdfSample};
use super::dielectric::{Dielectric, ThinDielectric};
use super::metal::Metal;
use super::plastic::Plastic;
use crate::radiometry::Spectrum;

/// glTF's nested `mix`es, multiplied out: a metal, a clear dielectric and a coated diffuse base, each
/// with its share, which sum to 1. All colours and shares are in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetallicRoughness<const N: usize = 3> {
    /// Base colour: of the diffuse base, of the metal at normal incidence, of specular transmission.
    pub base_color: Spectrum<N>,
    /// Share of metal.
    pub metallic: f32,
    /// GGX width, roughness².
    pub alpha: f32,
    /// n_inside / n_outside; gives also the reflectance of the coat at normal incidence.
    pub eta: f32,
    /// Share of the dielectric base that transmits specularly.
    pub transmission: f32,
    /// Share of the remaining base that transmits diffusely instead of reflecting.
    pub diffuse_transmission: f32,
    /// Colour of diffuse transmission.
    pub diffuse_transmission_color: Spectrum<N>,
    /// True if the surface is a thin wall: specular transmission goes straight on, no medium changes.
    pub thin: bool,
}

impl<const N: usize> MetallicRoughness<N> {
    /// f·|cos_i|, 1/sr; delta lobes are left out.
    pub fn evaluate(&self, wo: Vec3, wi: Vec3) -> Spectrum<N> {
        let mut sum = Spectrum::ZERO;
        for (share, part) in self.parts() {
            if share > 0.0 {
                sum += part.evaluate(wo, wi) * share;
            }
        }
        sum
    }

    /// Density of [`Self::sample`] per solid angle; delta lobes are left out.
    pub fn density(&self, wo: Vec3, wi: Vec3) -> f32 {
        let parts = self.parts();
        let chances = chances(&parts, wo);
        let density = |(chance, (_, part)): (f32, &(f32, Bsdf<N>))| {
            if chance > 0.0 { chance * part.density(wo, wi) } else { 0.0 }
        };
        chances.into_iter().zip(&parts).map(density).sum()
    }

    /// Chooses a part, draws from it, and weights the draw by what all parts do in that direction.
    pub fn sample(&self, wo: Vec3, u: [f32; 3]) -> Option<BsdfSample<N>> {
        let parts = self.parts();
        let chances = chances(&parts, wo);
        let (chosen, rest) = choose(&chances, u[2])?;
        let (share, part) = &parts[chosen];
        let chance = chances[chosen];
        let sample = part.sample(wo, [u[0], u[1], rest])?;
        if sample.delta {
            let weight = sample.weight * (share / chance);
            return Some(BsdfSample { weight, density: chance * sample.density, ..sample });
        }
        let mut value = sample.weight * (sample.density * share);
        let mut density = sample.density * chance;
        for (i, (share, part)) in parts.iter().enumerate() {
            if i != chosen && *share > 0.0 {
                value += part.evaluate(wo, sample.direction) * *share;
                density += part.density(wo, sample.direction) * chances[i];
            }
        }
        Some(BsdfSample { weight: value / density, density, ..sample })
    }

    /// True if every part that is there has delta lobes only.
    pub fn is_delta_only(&self) -> bool {
        self.parts().iter().all(|(share, part)| *share <= 0.0 || part.is_delta_only())
    }

    fn parts(&self) -> [(f32, Bsdf<N>); 3] {
        let Self { base_color, metallic, alpha, eta, transmission, .. } = *self;
        let dielectric = 1.0 - metallic;
        let metal = Metal { reflectance_normal: base_color, alpha };
        let clear = if self.thin {
            Bsdf::ThinDielectric(ThinDielectric { eta, alpha, tint: base_color })
        } else {
            Bsdf::Dielectric(Dielectric { eta, alpha, tint: base_color })
        };
        let amplitude = (eta - 1.0) / (eta + 1.0);
        let plastic = Plastic {
            reflectance_normal: amplitude * amplitude,
            alpha,
            reflectance: base_color * (1.0 - self.diffuse_transmission),
            transmittance: self.diffuse_transmission_color * self.diffuse_transmission,
            thin: self.thin,
        };
        [
            (metallic, Bsdf::Metal(metal)),
            (dielectric * transmission, clear),
            (dielectric * (1.0 - transmission), Bsdf::Plastic(plastic)),
        ]
    }
}

/// Probability of each part: its share times a guess of its albedo. All 0 if nothing is scattered.
fn chances<const N: usize>(parts: &[(f32, Bsdf<N>); 3], wo: Vec3) -> [f32; 3] {
    let shares = parts.each_ref().map(|(share, _)| *share);
    if shares.iter().filter(|&&share| share > 0.0).count() == 1 {
        return shares.map(|share| if share > 0.0 { 1.0 } else { 0.0 });
    }
    let expected = parts
        .each_ref()
        .map(|(share, part)| if *share > 0.0 { share * part.albedo_estimate(wo) } else { 0.0 });
    let sum: f32 = expected.iter().sum();
    if sum > 0.0 { expected.map(|x| x / sum) } else { [0.0; 3] }
}

/// The part that `u` falls on, and `u` stretched to [0, 1) again within it.
fn choose(chances: &[f32; 3], u: f32) -> Option<(usize, f32)> {
    let last = chances.iter().rposition(|&chance| chance > 0.0)?;
    let mut below = 0.0;
    for (i, &chance) in chances.iter().enumerate().take(last) {
        if u < below + chance {
            return Some((i, ((u - below) / chance).clamp(0.0, ONE_BELOW)));
        }
        below += chance;
    }
    Some((last, ((u - below) / chances[last]).clamp(0.0, ONE_BELOW)))
}

/// The largest number below 1.
const ONE_BELOW: f32 = 1.0 - 0.5 * f32::EPSILON;
