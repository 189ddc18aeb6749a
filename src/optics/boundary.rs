//! The boundary of a scattering body as the area integral sees it: light from outside is reflected
//! or *enters*, and what has scattered inside leaves through the same boundary.

use std::f32::consts::{PI, TAU};

use glam::Vec3;

use super::albedo::{CosineTable, directional_albedo};
use super::fresnel::{fresnel_dielectric, fresnel_moment};
use super::microfacet::{Ggx, is_smooth};
use crate::math::distribution::Discrete;
use crate::math::robust::safe_sqrt;

/// A dielectric boundary, smooth or GGX-rough, lit from outside.
///
/// The share that enters is what the reflection leaves, 1 − E(μ), with E the directional albedo of
/// the reflection lobe exactly as it is sampled. So no energy is made or lost at the boundary, whatever
/// the roughness: light that a single-scattering microfacet model drops is counted as entering.
///
/// All directions are local, unit, and point away from the surface; those with z ≤ 0 see nothing.
#[derive(Clone, Debug)]
pub struct Boundary {
    eta: f32,
    rough: Option<Rough>,
    mean_transmittance: f32,
    /// The exit lobe over bins of μ², in which a cosine lobe is uniform.
    exit: Discrete,
}

#[derive(Clone, Debug)]
struct Rough {
    ggx: Ggx,
    /// 1 − E(μ).
    transmittance: CosineTable,
}

/// A reflected direction drawn from [`Boundary::sample_reflection`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReflectionSample {
    /// Where the light comes from.
    pub direction: Vec3,
    /// Reflection · cos / density; its expectation, with nothing counted as 0, is E(μ).
    pub weight: f32,
    /// Density per solid angle; 0 for the mirror direction of a smooth boundary, which has none.
    pub density: f32,
}

/// Nodes of E over μ.
const NODES: usize = 64;

/// Bins of the table that draws from the exit lobe.
const EXIT_BINS: usize = 64;

impl Boundary {
    /// The boundary with relative index `eta` = n_inside / n_outside and GGX width `alpha`. A rough
    /// boundary tabulates E here (about 10 ms): make one per material, not per hit.
    ///
    /// The table is within 5e-4 of E for `alpha` ≥ 0.01 and `eta` ≥ 1. Where light is totally reflected
    /// from outside (`eta` < 1) it is within 5e-3, and below `alpha` = 0.01 within 5e-2 at μ < 0.002;
    /// its mean over the hemisphere is good to 1e-4 throughout.
    pub fn new(eta: f32, alpha: f32) -> Self {
        if is_smooth(alpha) {
            let mean_transmittance = (1.0 - 2.0 * fresnel_moment(f64::from(eta), 1)) as f32;
            return Self { eta, rough: None, mean_transmittance, exit: Discrete::default() }.with_exit();
        }
        let ggx = Ggx { alpha };
        let fresnel = |cos: f32| [f64::from(fresnel_dielectric(cos, eta).reflectance)];
        let critical = safe_sqrt((1.0 - eta) * (1.0 + eta));
        let [transmittance] = CosineTable::tabulate(NODES, critical, |mu| {
            directional_albedo(&ggx, mu, fresnel).map(|reflected| 1.0 - reflected)
        });
        let mean_transmittance = transmittance.hemispherical_mean() as f32;
        let rough = Some(Rough { ggx, transmittance });
        Self { eta, rough, mean_transmittance, exit: Discrete::default() }.with_exit()
    }

    fn with_exit(mut self) -> Self {
        // A floor, so that no direction the lobe reaches lies in a bin that is never drawn.
        let weight = |bin: usize| {
            let edge = |i: usize| self.transmittance((i as f32 / EXIT_BINS as f32).sqrt());
            let middle = self.transmittance(((bin as f32 + 0.5) / EXIT_BINS as f32).sqrt());
            (edge(bin) + 2.0 * middle + edge(bin + 1)).max(1e-3)
        };
        self.exit = Discrete::new((0..EXIT_BINS).map(weight));
        self
    }

    /// Relative index of refraction, n_inside / n_outside.
    pub fn eta(&self) -> f32 {
        self.eta
    }

    /// True if reflection is a mirror: its lobe is then left out of [`Self::evaluate_reflection`].
    pub fn is_smooth(&self) -> bool {
        self.rough.is_none()
    }

    /// E(μ): share of the light at cosine `mu` that is reflected, in [0, 1].
    pub fn reflectance(&self, mu: f32) -> f32 {
        match &self.rough {
            None => fresnel_dielectric(mu.max(0.0), self.eta).reflectance,
            Some(rough) => 1.0 - rough.transmittance.evaluate(mu),
        }
    }

    /// 1 − E(μ): share that enters. For a smooth boundary its relative error stays at a few ulps
    /// towards grazing.
    pub fn transmittance(&self, mu: f32) -> f32 {
        match &self.rough {
            None => fresnel_dielectric(mu.max(0.0), self.eta).transmittance,
            Some(rough) => rough.transmittance.evaluate(mu),
        }
    }

    /// c = 2 ∫ (1 − E(μ)) μ dμ: share of uniform diffuse light that enters; 1 − 2C₁ if smooth.
    pub fn mean_transmittance(&self) -> f32 {
        self.mean_transmittance
    }

    /// S_w(μ) = (1 − E(μ)) / (cπ), 1/sr: how light that leaves a scattering body is distributed, with
    /// ∫ S_w μ dω = 1 (Pharr, Jakob, Humphreys 2016, eq. 11.7). 0 if the boundary lets nothing through.
    pub fn exit_lobe(&self, mu: f32) -> f32 {
        if mu <= 0.0 || self.mean_transmittance <= 0.0 {
            return 0.0;
        }
        self.transmittance(mu) / (self.mean_transmittance * PI)
    }

    /// Draws a direction almost in proportion to S_w cosθ; see [`Self::exit_density`].
    pub fn sample_exit(&self, u: [f32; 2]) -> Vec3 {
        let (bin, _, within) = self.exit.sample(u[0]).unwrap_or((0, 1.0, u[0]));
        let cos2 = (bin as f32 + within) / EXIT_BINS as f32;
        let (sin_phi, cos_phi) = (TAU * u[1]).sin_cos();
        let sin = (1.0 - cos2).max(0.0).sqrt();
        Vec3::new(sin * cos_phi, sin * sin_phi, cos2.sqrt())
    }

    /// Density of [`Self::sample_exit`] per solid angle at cosine `mu`.
    pub fn exit_density(&self, mu: f32) -> f32 {
        if mu <= 0.0 {
            return 0.0;
        }
        let bin = ((mu * mu * EXIT_BINS as f32) as usize).min(EXIT_BINS - 1);
        self.exit.probability(bin) * EXIT_BINS as f32 * mu / PI
    }

    /// Reflection of light from `wi` to `wo`, times cos_i, 1/sr; 0 for a smooth boundary.
    pub fn evaluate_reflection(&self, wo: Vec3, wi: Vec3) -> f32 {
        let Some(rough) = self.rough.as_ref().filter(|_| wo.z > 0.0 && wi.z > 0.0) else { return 0.0 };
        let (value, cos) = rough.ggx.reflection(wo, wi);
        value * fresnel_dielectric(cos, self.eta).reflectance
    }

    /// Density of [`Self::sample_reflection`] per solid angle; 0 for a smooth boundary.
    pub fn reflection_density(&self, wo: Vec3, wi: Vec3) -> f32 {
        let Some(rough) = self.rough.as_ref().filter(|_| wo.z > 0.0 && wi.z > 0.0) else { return 0.0 };
        rough.ggx.reflection_density(wo, wi)
    }

    /// Draws the direction from which light is reflected towards `wo`: the mirror direction if smooth,
    /// otherwise by a visible microfacet normal. Nothing if the draw ends below the horizon.
    pub fn sample_reflection(&self, wo: Vec3, u: [f32; 2]) -> Option<ReflectionSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let Some(rough) = &self.rough else {
            let direction = Vec3::new(-wo.x, -wo.y, wo.z);
            return Some(ReflectionSample { direction, weight: self.reflectance(wo.z), density: 0.0 });
        };
        let sample = rough.ggx.sample_reflection(wo, u)?;
        let reflectance = fresnel_dielectric(sample.cos_microfacet, self.eta).reflectance;
        Some(ReflectionSample {
            direction: sample.direction,
            weight: reflectance * sample.weight,
            density: rough.ggx.reflection_density(wo, sample.direction),
        })
    }
}
