//! Bidirectional scattering distribution functions with their parameters resolved at a point.

use std::f32::consts::PI;

use glam::Vec3;

use super::dielectric::{Dielectric, ThinDielectric};
use super::metal::Metal;
use super::metallic_roughness::MetallicRoughness;
use super::plastic::Plastic;
use crate::math::warp::{cosine_hemisphere_density, square_to_cosine_hemisphere};
use crate::radiometry::Spectrum;

/// How a surface scatters.
///
/// The convention is that of paths traced from the camera: f(`wo`, `wi`) takes *radiance* arriving
/// from `wi` to radiance leaving along `wo`. Radiance per squared index is what refraction conserves,
/// so a transmission of light from a medium n_i to n_o carries the factor (n_o/n_i)² (Veach 1997,
/// section 5.2); entering and leaving a body cancel, and a clear body in a uniform environment
/// of radiance 1 shows radiance 1. Power is never created from any direction.
///
/// Opaque reflection acts alike on both sides of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bsdf<const N: usize = 3> {
    /// Lambert.
    Diffuse {
        /// Diffuse reflectance in [0, 1].
        reflectance: Spectrum<N>,
    },
    /// A conductor.
    Metal(Metal<N>),
    /// The interface of a clear body.
    Dielectric(Dielectric<N>),
    /// A thin clear wall.
    ThinDielectric(ThinDielectric<N>),
    /// A diffuse base under a dielectric coat.
    Plastic(Plastic<N>),
    /// glTF 2.0.
    MetallicRoughness(MetallicRoughness<N>),
}

/// A direction drawn from a [`Bsdf`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample<const N: usize = 3> {
    /// Where the light comes from; unit.
    pub direction: Vec3,
    /// f·|cos| / density, over every lobe that could have given this direction.
    pub weight: Spectrum<N>,
    /// Density per solid angle, equal to [`Bsdf::density`]; for a delta lobe its discrete probability.
    pub density: f32,
    /// True if the direction comes from a delta lobe, which no light sampling can find.
    pub delta: bool,
    /// True if the direction is on the other side of the surface than `wo`.
    pub transmitted: bool,
    /// True if the path goes on in the medium on the other side. False also for transmission through
    /// a thin wall, behind which the medium is the same.
    pub crosses_boundary: bool,
}

impl<const N: usize> BsdfSample<N> {
    /// A sample on the side of `wo`.
    pub(super) fn reflected(direction: Vec3, weight: Spectrum<N>, density: f32, delta: bool) -> Self {
        Self { direction, weight, density, delta, transmitted: false, crosses_boundary: false }
    }

    /// A sample on the other side, in another medium if `crosses_boundary`.
    pub(super) fn transmitted(
        direction: Vec3,
        weight: Spectrum<N>,
        density: f32,
        delta: bool,
        crosses_boundary: bool,
    ) -> Self {
        Self { direction, weight, density, delta, transmitted: true, crosses_boundary }
    }
}

impl BsdfSample<1> {
    /// The same in all of `N` channels.
    pub(super) fn splat<const N: usize>(self) -> BsdfSample<N> {
        let Self { direction, weight, density, delta, transmitted, crosses_boundary } = self;
        let weight = Spectrum::splat(weight[0]);
        BsdfSample { direction, weight, density, delta, transmitted, crosses_boundary }
    }
}

impl<const N: usize> Bsdf<N> {
    /// f(`wo`, `wi`)·|cos_i|, 1/sr; delta lobes are left out.
    pub fn evaluate(&self, wo: Vec3, wi: Vec3) -> Spectrum<N> {
        match self {
            Self::Diffuse { reflectance } if wo.z * wi.z > 0.0 => *reflectance * (wi.z.abs() / PI),
            Self::Diffuse { .. } => Spectrum::ZERO,
            Self::Metal(metal) => metal.evaluate(wo, wi),
            Self::Dielectric(dielectric) => dielectric.evaluate(wo, wi),
            Self::ThinDielectric(dielectric) => dielectric.evaluate(wo, wi),
            Self::Plastic(plastic) => plastic.evaluate(wo, wi),
            Self::MetallicRoughness(mixture) => mixture.evaluate(wo, wi),
        }
    }

    /// Density of [`Self::sample`] per solid angle of `wi`; delta lobes are left out. Where microfacet
    /// sampling can end on the wrong side of the surface, it integrates to less than 1 by as much.
    pub fn density(&self, wo: Vec3, wi: Vec3) -> f32 {
        match self {
            Self::Diffuse { .. } if wo.z * wi.z > 0.0 => cosine_hemisphere_density(wi.z.abs()),
            Self::Diffuse { .. } => 0.0,
            Self::Metal(metal) => metal.density(wo, wi),
            Self::Dielectric(dielectric) => dielectric.density(wo, wi),
            Self::ThinDielectric(dielectric) => dielectric.density(wo, wi),
            Self::Plastic(plastic) => plastic.density(wo, wi),
            Self::MetallicRoughness(mixture) => mixture.density(wo, wi),
        }
    }

    /// Draws where the light that leaves along `wo` comes from; `u[2]` chooses among lobes. Nothing
    /// means that this draw carries no light.
    pub fn sample(&self, wo: Vec3, u: [f32; 3]) -> Option<BsdfSample<N>> {
        match self {
            Self::Diffuse { reflectance } => sample_diffuse(*reflectance, wo, [u[0], u[1]]),
            Self::Metal(metal) => metal.sample(wo, [u[0], u[1]]),
            Self::Dielectric(dielectric) => dielectric.sample(wo, u),
            Self::ThinDielectric(dielectric) => dielectric.sample(wo, u),
            Self::Plastic(plastic) => plastic.sample(wo, u),
            Self::MetallicRoughness(mixture) => mixture.sample(wo, u),
        }
    }

    /// True if every lobe is a delta lobe, so that light sampling is of no use.
    pub fn is_delta_only(&self) -> bool {
        match self {
            Self::Diffuse { .. } => false,
            Self::Metal(metal) => metal.is_smooth(),
            Self::Dielectric(dielectric) => dielectric.is_smooth(),
            Self::ThinDielectric(dielectric) => dielectric.is_smooth(),
            Self::Plastic(plastic) => plastic.is_delta_only(),
            Self::MetallicRoughness(mixture) => mixture.is_delta_only(),
        }
    }

    /// True if light can come from the other side of the surface.
    pub fn transmits(&self) -> bool {
        match self {
            Self::Diffuse { .. } | Self::Metal(_) => false,
            Self::Dielectric(_) | Self::ThinDielectric(_) => true,
            Self::Plastic(plastic) => !plastic.transmittance.is_black(),
            Self::MetallicRoughness(m) => {
                m.metallic < 1.0 && (m.transmission > 0.0 || m.diffuse_transmission > 0.0)
            }
        }
    }

    /// A cheap guess of the largest share of light scattered towards `wo`, by which mixtures choose
    /// among their parts. Zero only where nothing is scattered.
    pub(super) fn albedo_estimate(&self, wo: Vec3) -> f32 {
        match self {
            Self::Diffuse { reflectance } => reflectance.max_component(),
            Self::Metal(metal) => metal.albedo_estimate(wo),
            Self::Plastic(plastic) => plastic.albedo_estimate(wo),
            Self::Dielectric(_) | Self::ThinDielectric(_) | Self::MetallicRoughness(_) => 1.0,
        }
    }
}

fn sample_diffuse<const N: usize>(reflectance: Spectrum<N>, wo: Vec3, u: [f32; 2]) -> Option<BsdfSample<N>> {
    let wi = square_to_cosine_hemisphere(u[0], u[1]);
    let density = cosine_hemisphere_density(wi.z);
    (density > 0.0 && wo.z != 0.0)
        .then(|| BsdfSample::reflected(to_side(wi, wo.z), reflectance, density, false))
}

/// `w`, mirrored to the −z side if `side` is negative. Its own inverse.
pub(super) fn to_side(w: Vec3, side: f32) -> Vec3 {
    if side < 0.0 { Vec3::new(w.x, w.y, -w.z) } else { w }
}

/// The mirror image of `wo` at the surface.
pub(super) fn mirrored(wo: Vec3) -> Vec3 {
    Vec3::new(-wo.x, -wo.y, wo.z)
}
