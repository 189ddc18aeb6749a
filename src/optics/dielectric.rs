//! Reflection and refraction at the interface of a clear body, and through a thin clear wall.

use glam::Vec3;

use super::bsdf::{BsdfSample, mirrored, to_side};
use super::fresnel::{fresnel_dielectric, reflect, refracted};
use super::microfacet::{Ggx, is_smooth};
use crate::radiometry::Spectrum;

/// A dielectric interface, smooth or with GGX microfacets (Walter et al. 2007), with Smith's
/// height-correlated G₂ in reflection and transmission alike (as pbrt-v4 does).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric<const N: usize = 3> {
    /// n_inside / n_outside.
    pub eta: f32,
    /// GGX width, roughness².
    pub alpha: f32,
    /// Factor on every transmission, in [0, 1].
    pub tint: Spectrum<N>,
}

/// Refraction spreads a lobe by about α·|eta − 1|, while two single-precision directions define the half
/// vector wo + eta·wi, of length |eta − 1|, to about 1e-7. Below this spread the density of the lobe
/// would be wrong by more than some 0.4 %, and the blur is too small to be seen: the interface is
/// treated as smooth, and eta = 1 passes light unchanged.
const SMALLEST_REFRACTION_SPREAD: f32 = 1e-4;

impl<const N: usize> Dielectric<N> {
    /// True if both lobes are delta lobes.
    pub fn is_smooth(&self) -> bool {
        is_smooth(self.alpha) || self.alpha * (self.eta - 1.0).abs() < SMALLEST_REFRACTION_SPREAD
    }

    /// f·|cos_i|, 1/sr, for radiance.
    pub fn evaluate(&self, wo: Vec3, wi: Vec3) -> Spectrum<N> {
        let Some(facet) = self.facet(wo, wi) else { return Spectrum::ZERO };
        let base = facet.distribution * self.ggx().shadowing_over_cos(wo.z.abs(), wi.z.abs());
        match facet.transmission {
            None => Spectrum::splat(0.25 * base * facet.share),
            Some(Transmission { cos_t, squared_contrast, .. }) => {
                self.tint * (base * facet.share * facet.cos_o * cos_t / squared_contrast)
            }
        }
    }

    /// Density of [`Self::sample`] per solid angle.
    pub fn density(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.facet(wo, wi).map_or(0.0, |facet| self.facet_density(wo, &facet))
    }

    /// Chooses a visible microfacet, then reflects or refracts at it in proportion to its Fresnel
    /// reflectance. Nothing if the result is on the wrong side of the surface.
    pub fn sample(&self, wo: Vec3, u: [f32; 3]) -> Option<BsdfSample<N>> {
        if wo.z == 0.0 {
            return None;
        }
        if self.is_smooth() {
            return Some(self.sample_smooth(wo, u[2]));
        }
        let upper = to_side(wo, wo.z);
        let m = self.ggx().sample_visible_normal(upper, [u[0], u[1]]);
        let cos_o = upper.dot(m);
        let fresnel = fresnel_dielectric(cos_o.copysign(wo.z), self.eta);
        let reflects = u[2] < fresnel.reflectance;
        let relative_eta = self.relative_eta(wo);
        let wi = if reflects {
            reflect(upper, m)
        } else {
            refracted(upper, m, relative_eta, cos_o, -fresnel.cos_t.abs())
        };
        if cos_o <= 0.0 || (wi.z > 0.0) != reflects || wi.z == 0.0 {
            return None;
        }
        let shadowing = self.ggx().shadowing_given_visible(upper.z, wi.z.abs());
        let distribution = self.ggx().distribution(m);
        let direction = to_side(wi, wo.z);
        if reflects {
            let facet = Facet { cos_o, distribution, share: fresnel.reflectance, transmission: None };
            let density = self.facet_density(upper, &facet);
            return Some(BsdfSample::reflected(direction, Spectrum::splat(shadowing), density, false));
        }
        let transmission = Transmission::new(cos_o, fresnel.cos_t.abs(), relative_eta);
        let facet =
            Facet { cos_o, distribution, share: fresnel.transmittance, transmission: Some(transmission) };
        let weight = self.tint * (shadowing / (relative_eta * relative_eta));
        Some(BsdfSample::transmitted(direction, weight, self.facet_density(upper, &facet), false, true))
    }

    /// Share of the light at the visible microfacet that `u` draws from `wo` that leaves the surface after it, whichever
    /// way: the rest would meet another microfacet, which this model leaves out. For a rough interface.
    pub(super) fn share_kept(&self, wo: Vec3, u: [f32; 2]) -> f32 {
        let upper = to_side(wo, wo.z);
        let m = self.ggx().sample_visible_normal(upper, u);
        let cos_o = upper.dot(m);
        let fresnel = fresnel_dielectric(cos_o.copysign(wo.z), self.eta);
        let shadowing = |wi: f32| self.ggx().shadowing_given_visible(upper.z, wi.abs());
        let reflected = reflect(upper, m).z;
        let refracted = refracted(upper, m, self.relative_eta(wo), cos_o, -fresnel.cos_t.abs()).z;
        let mut kept = 0.0;
        if reflected > 0.0 {
            kept += fresnel.reflectance * shadowing(reflected);
        }
        if refracted < 0.0 {
            kept += fresnel.transmittance * shadowing(refracted);
        }
        if cos_o > 0.0 { kept } else { 0.0 }
    }

    fn sample_smooth(&self, wo: Vec3, u: f32) -> BsdfSample<N> {
        let fresnel = fresnel_dielectric(wo.z, self.eta);
        if u < fresnel.reflectance {
            return BsdfSample::reflected(mirrored(wo), Spectrum::ONE, fresnel.reflectance, true);
        }
        let relative_eta = self.relative_eta(wo);
        let direction = refracted(to_side(wo, wo.z), Vec3::Z, relative_eta, wo.z.abs(), -fresnel.cos_t.abs());
        let weight = self.tint / (relative_eta * relative_eta);
        BsdfSample::transmitted(to_side(direction, wo.z), weight, fresnel.transmittance, true, true)
    }

    /// The microfacet that takes `wi` to `wo`, if a rough interface has one.
    fn facet(&self, wo: Vec3, wi: Vec3) -> Option<Facet> {
        if self.is_smooth() || wo.z == 0.0 || wi.z == 0.0 {
            return None;
        }
        let (o, i) = (to_side(wo, wo.z), to_side(wi, wo.z));
        let reflects = i.z > 0.0;
        let relative_eta = self.relative_eta(wo);
        let half = if reflects { o + i } else { o + relative_eta * i };
        let m = half.normalize_or_zero() * 1.0_f32.copysign(half.z);
        let (cos_o, cos_i) = (o.dot(m), i.dot(m));
        // Back faces of microfacets are not seen.
        if cos_o <= 0.0 || (cos_i > 0.0) != reflects {
            return None;
        }
        let fresnel = fresnel_dielectric(cos_o.copysign(wo.z), self.eta);
        let share = if reflects { fresnel.reflectance } else { fresnel.transmittance };
        let transmission = (!reflects).then(|| Transmission::new(cos_o, -cos_i, relative_eta));
        Some(Facet { cos_o, distribution: self.ggx().distribution(m), share, transmission })
    }

    /// Density of visible normals, times the choice, times the Jacobian of reflection or refraction
    /// (Walter et al. 2007, eqs. 14 and 17).
    fn facet_density(&self, wo: Vec3, facet: &Facet) -> f32 {
        let visible = facet.distribution * self.ggx().masking(wo.z.abs()) / wo.z.abs() * facet.share;
        match facet.transmission {
            None => 0.25 * visible,
            Some(Transmission { cos_t, squared_contrast, squared_eta }) => {
                visible * facet.cos_o * cos_t * squared_eta / squared_contrast
            }
        }
    }

    /// n on the side of `wi` over n on the side of `wo`, for transmission.
    pub(super) fn relative_eta(&self, wo: Vec3) -> f32 {
        if wo.z < 0.0 { 1.0 / self.eta } else { self.eta }
    }

    fn ggx(&self) -> Ggx {
        Ggx { alpha: self.alpha }
    }
}

/// A microfacet between two directions.
struct Facet {
    /// Cosine with `wo`, positive.
    cos_o: f32,
    /// D(m), 1/sr.
    distribution: f32,
    /// Share of the light that goes this way: F or 1 − F.
    share: f32,
    transmission: Option<Transmission>,
}

#[derive(Clone, Copy)]
struct Transmission {
    /// Cosine between the microfacet and the refracted direction, positive.
    cos_t: f32,
    /// (wo·m + e wi·m)², the denominator of Walter et al. 2007, eq. 21.
    squared_contrast: f32,
    /// e².
    squared_eta: f32,
}

impl Transmission {
    fn new(cos_o: f32, cos_t: f32, relative_eta: f32) -> Self {
        // cos_o − e cos_t = (1 − e²)/(cos_o + e cos_t), by Snell: nothing cancels as e → 1.
        let contrast = (relative_eta - 1.0) * (relative_eta + 1.0) / (cos_o + relative_eta * cos_t);
        Self { cos_t, squared_contrast: contrast * contrast, squared_eta: relative_eta * relative_eta }
    }
}

/// A thin clear wall: reflection as [`Dielectric`], transmission straight on, blurred by the same lobe
/// mirrored to the other side (KHR_materials_transmission). The medium is the same on both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinDielectric<const N: usize = 3> {
    /// n of the wall over n around it.
    pub eta: f32,
    /// GGX width, roughness².
    pub alpha: f32,
    /// Factor on every transmission, in [0, 1].
    pub tint: Spectrum<N>,
}

impl<const N: usize> ThinDielectric<N> {
    /// True if both lobes are delta lobes.
    pub fn is_smooth(&self) -> bool {
        is_smooth(self.alpha)
    }

    /// f·|cos_i|, 1/sr.
    pub fn evaluate(&self, wo: Vec3, wi: Vec3) -> Spectrum<N> {
        if self.is_smooth() || wo.z * wi.z == 0.0 {
            return Spectrum::ZERO;
        }
        let (value, cos) = self.ggx().reflection(to_side(wo, wo.z), to_side(wi, wi.z));
        let fresnel = fresnel_dielectric(cos, self.eta);
        if wo.z * wi.z > 0.0 {
            Spectrum::splat(value * fresnel.reflectance)
        } else {
            self.tint * (value * fresnel.transmittance)
        }
    }

    /// Density of [`Self::sample`] per solid angle.
    pub fn density(&self, wo: Vec3, wi: Vec3) -> f32 {
        if self.is_smooth() || wo.z * wi.z == 0.0 {
            return 0.0;
        }
        let (o, i) = (to_side(wo, wo.z), to_side(wi, wi.z));
        let fresnel = fresnel_dielectric(o.dot((o + i).normalize_or_zero()), self.eta);
        let share = if wo.z * wi.z > 0.0 { fresnel.reflectance } else { fresnel.transmittance };
        share * self.ggx().reflection_density(o, i)
    }

    /// Reflects at a visible microfacet, then mirrors the result to the other side with the
    /// probability of transmission.
    pub fn sample(&self, wo: Vec3, u: [f32; 3]) -> Option<BsdfSample<N>> {
        if wo.z == 0.0 {
            return None;
        }
        let upper = to_side(wo, wo.z);
        let (direction, cos, weight, density) = if self.is_smooth() {
            (mirrored(upper), upper.z, 1.0, 1.0)
        } else {
            let sample = self.ggx().sample_reflection(upper, [u[0], u[1]])?;
            let density = self.ggx().reflection_density(upper, sample.direction);
            (sample.direction, sample.cos_microfacet, sample.weight, density)
        };
        let fresnel = fresnel_dielectric(cos, self.eta);
        Some(if u[2] < fresnel.reflectance {
            let density = density * fresnel.reflectance;
            BsdfSample::reflected(
                to_side(direction, wo.z),
                Spectrum::splat(weight),
                density,
                self.is_smooth(),
            )
        } else {
            let density = density * fresnel.transmittance;
            let direction = to_side(direction, -wo.z);
            BsdfSample::transmitted(direction, self.tint * weight, density, self.is_smooth(), false)
        })
    }

    fn ggx(&self) -> Ggx {
        Ggx { alpha: self.alpha }
    }
}
