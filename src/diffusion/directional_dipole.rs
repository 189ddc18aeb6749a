//! The directional dipole (Frisvad, Hachisuka and Kjeldsen 2014, "Directional Dipole Model for
//! Subsurface Scattering"): diffusion from a ray of light, which knows the direction of entry.
//!
//! Energy is not conserved: at normal incidence the total albedo is up to 1.3 for α' → 1, and far too
//! large for α' → 0, where the diffusive part does not vanish with the albedo.

use std::f64::consts::PI;

use glam::DVec3;

use super::integrate::total_energy;
use super::{BoundaryMoments, DiffusionModel, HalfSpace};
use crate::math::quadrature::GaussLegendre;
use crate::optics::fresnel::Interface;

/// The diffusive part S_d of the BSSRDF, and its profile at normal incidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionalDipole {
    moments: BoundaryMoments,
    /// D = 1/(3σ_t'), m.
    diffusion_coefficient: f64,
    /// σ_tr = √(σ_a/D), 1/m.
    sigma_tr: f64,
    /// d_e = 2.131 D/√α', m; infinite without scattering.
    extrapolation: f64,
    /// Height 2A d_e of the mirrored source, m.
    mirror_height: f64,
    /// 1/(3σ_t), m.
    smallest_distance: f64,
}

impl DirectionalDipole {
    /// The directional dipole of `half_space`.
    pub fn new(half_space: &HalfSpace) -> Self {
        Self::with_moments(half_space, BoundaryMoments::new(half_space.eta))
    }

    /// The directional dipole of `half_space`, the `moments` of whose boundary are known.
    pub(super) fn with_moments(half_space: &HalfSpace, moments: BoundaryMoments) -> Self {
        let diffusion_coefficient = half_space.diffusion_coefficient();
        let extrapolation = 2.131 * diffusion_coefficient / half_space.albedo_reduced().sqrt();
        Self {
            moments,
            diffusion_coefficient,
            sigma_tr: (half_space.sigma_a / diffusion_coefficient).sqrt(),
            extrapolation,
            mirror_height: 2.0 * moments.reflection_parameter() * extrapolation,
            smallest_distance: 1.0 / (3.0 * half_space.sigma_t()),
        }
    }

    /// σ_tr, 1/m.
    pub(super) fn sigma_tr(&self) -> f64 {
        self.sigma_tr
    }

    /// S_d, 1/(m² sr), of light that entered along the refracted unit direction `w12` (into the body)
    /// and leaves `offset` (m) away; `normal_in` and `normal_out` are the unit normals there, out of the
    /// body. The BSSRDF is T₁₂ S_d T₂₁, with the transmittances of both crossings. Negative values clamp
    /// to 0, as in the paper.
    pub fn diffusive_part(&self, offset: DVec3, w12: DVec3, normal_in: DVec3, normal_out: DVec3) -> f64 {
        if self.extrapolation == f64::INFINITY {
            return 0.0;
        }
        // The plane of the mirror holds the offset, so that the boundary condition is met at the exit.
        let tangent = normal_in.cross(offset);
        let normal = offset.cross(tangent).try_normalize().unwrap_or(normal_in);
        let mirrored_w12 = w12 - 2.0 * w12.dot(normal) * normal;
        let mirrored_offset = offset - self.mirror_height * normal;
        let distance = self.distance_to_ray(offset, w12, normal_out);
        let real = self.ray(offset, w12, distance, normal_out);
        let mirrored = self.ray(mirrored_offset, mirrored_w12, mirrored_offset.length(), normal_out);
        let difference = (real - mirrored) / (16.0 * PI * PI * self.moments.c_phi_outside);
        difference.max(0.0)
    }

    /// d_r: the distance to a ray of light whose closest point is kept a diffusion length away.
    fn distance_to_ray(&self, offset: DVec3, w12: DVec3, normal_out: DVec3) -> f64 {
        let (d, d_e) = (self.diffusion_coefficient, self.extrapolation);
        let (squared, mu) = (offset.length_squared(), -normal_out.dot(w12));
        if mu <= 0.0 {
            return (squared + self.smallest_distance * self.smallest_distance).sqrt();
        }
        let along = offset.dot(w12);
        // −cos β.
        let sideways = (squared - along * along).max(0.0).sqrt() / squared.sqrt().hypot(d_e);
        (squared + d * mu * (d * mu + 2.0 * d_e * sideways)).sqrt()
    }

    /// 4C_φ(1/η)·4π² S'_d of a ray of light along `w`, `distance` being what enters for |`offset`|.
    fn ray(&self, offset: DVec3, w: DVec3, distance: f64, normal: DVec3) -> f64 {
        let (d, argument) = (self.diffusion_coefficient, self.sigma_tr * distance);
        let (along, squared) = (offset.dot(w), distance * distance);
        let one_plus = 1.0 + argument;
        let fluence = squared / d + 3.0 * one_plus * along;
        let spread = one_plus + 3.0 * d * (3.0 * one_plus + argument * argument) / squared * along;
        let flux = 3.0 * d * one_plus * w.dot(normal) - spread * offset.dot(normal);
        (-argument).exp() / (squared * distance) * (self.moments.c_phi * fluence - self.moments.c_e * flux)
    }

    /// Exitance per unit flux that entered a plane, from S_d: the light leaves alike in all directions
    /// below the boundary, so that ∫ T₂₁ cos dω = π 4C_φ(1/η).
    fn exitance(&self, diffusive_part: f64) -> f64 {
        4.0 * PI * self.moments.c_phi_outside * diffusive_part
    }

    /// The length on which the profile changes, m.
    fn length(&self) -> f64 {
        3.0 * self.diffusion_coefficient
    }
}

/// At normal incidence on a plane.
impl DiffusionModel for DirectionalDipole {
    fn reflectance(&self, radius: f64) -> f64 {
        self.exitance(self.diffusive_part(radius * DVec3::X, -DVec3::Z, DVec3::Z, DVec3::Z))
    }

    /// By quadrature over radii.
    fn albedo(&self) -> f64 {
        total_energy(self, self.length())
    }
}

/// The mean of the directional dipole over the directions of light that enters a plane from uniform
/// surroundings: a radial profile for points lit from all sides.
#[derive(Clone, Debug)]
pub struct UniformlyLitDirectionalDipole {
    dipole: DirectionalDipole,
    /// Refracted directions, with weights that sum to 1.
    directions: Vec<(DVec3, f64)>,
}

/// Polar angles, and azimuths on half of the circle (the other half mirrors it).
const POLAR: usize = 16;
const AZIMUTHS: usize = 16;

impl UniformlyLitDirectionalDipole {
    /// The mean profile of `half_space`.
    pub fn new(half_space: &HalfSpace) -> Self {
        let mut directions = refracted_uniform_light(half_space.eta);
        let total: f64 = directions.iter().map(|(_, weight)| weight).sum();
        directions.iter_mut().for_each(|(_, weight)| *weight /= total);
        Self { dipole: DirectionalDipole::new(half_space), directions }
    }
}

/// Directions below the boundary of light from uniform surroundings, with weights.
///
/// Radiance over n² passes a boundary unchanged but for the transmittance, which is the same both ways:
/// below, the flux is distributed as T₂₁(μ) μ dμ over all μ that are not totally reflected.
fn refracted_uniform_light(eta: f64) -> Vec<(DVec3, f64)> {
    let critical = ((1.0 - 1.0 / eta) * (1.0 + 1.0 / eta)).max(0.0).sqrt();
    let rule = GaussLegendre::new(POLAR);
    let mut directions = Vec::with_capacity(POLAR * AZIMUTHS);
    for &(x, node_weight) in rule.nodes() {
        // As in the Fresnel moments, x² takes out the square root at the critical angle.
        let mu = critical + (1.0 - critical) * x * x;
        let weight = node_weight * x * mu * Interface::new(mu, 1.0 / eta).transmittance;
        let sin = ((1.0 - mu) * (1.0 + mu)).sqrt();
        for i in 0..AZIMUTHS {
            // The midpoint rule is the best one for a smooth periodic function.
            let (sin_azimuth, cos_azimuth) = (PI * (i as f64 + 0.5) / AZIMUTHS as f64).sin_cos();
            directions.push((DVec3::new(sin * cos_azimuth, sin * sin_azimuth, -mu), weight));
        }
    }
    directions
}

impl DiffusionModel for UniformlyLitDirectionalDipole {
    fn reflectance(&self, radius: f64) -> f64 {
        let offset = radius * DVec3::X;
        let mean: f64 = self
            .directions
            .iter()
            .map(|&(w12, weight)| weight * self.dipole.diffusive_part(offset, w12, DVec3::Z, DVec3::Z))
            .sum();
        self.dipole.exitance(mean)
    }

    /// By quadrature over radii.
    fn albedo(&self) -> f64 {
        total_energy(self, self.dipole.length())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refracted_directions_carry_what_enters() {
        for eta in [0.75, 1.0, 1.4] {
            let critical = (1.0_f64 - 1.0 / (eta * eta)).max(0.0).sqrt();
            let sum: f64 = refracted_uniform_light(eta).iter().map(|(_, weight)| weight).sum();
            let flux = 2.0 * (1.0 - critical) * sum / AZIMUTHS as f64;
            // ∫ (1 − F) μ dμ = ½ − C₁ = 2C_φ. Sixteen nodes resolve the reflectance of η < 1 near
            // grazing to five digits, the others better.
            assert!((flux / (2.0 * BoundaryMoments::new(eta).c_phi) - 1.0).abs() < 1e-5, "{eta}: {flux}");
        }
    }

    #[test]
    fn turning_everything_changes_nothing() {
        let dipole = DirectionalDipole::new(&HalfSpace::new(0.1, 2.0, 0.3, 1.4).unwrap());
        let (offset, w12) = (DVec3::new(0.7, -0.4, 0.2), DVec3::new(0.3, 0.2, -0.9).normalize());
        let (normal_in, normal_out) = (DVec3::Z, DVec3::new(0.1, 0.2, 1.0).normalize());
        let value = dipole.diffusive_part(offset, w12, normal_in, normal_out);
        let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 1.1, -2.0);
        let turned = dipole.diffusive_part(turn * offset, turn * w12, turn * normal_in, turn * normal_out);
        assert!(value > 0.0);
        // Two dozen roundings, of terms that partly cancel.
        assert!((turned / value - 1.0).abs() < 1e-13, "{value} {turned}");
    }

    #[test]
    fn light_that_leans_spreads_where_it_leans() {
        let dipole = DirectionalDipole::new(&HalfSpace::new(0.1, 2.0, 0.0, 1.0).unwrap());
        let w12 = DVec3::new(0.6, 0.0, -0.8);
        let at = |x: f64| dipole.diffusive_part(x * DVec3::X, w12, DVec3::Z, DVec3::Z);
        assert!(at(0.5) > 1.5 * at(-0.5));
    }

    #[test]
    fn mean_over_directions_stays_among_them() {
        let half_space = HalfSpace::new(0.05, 1.0, 0.0, 1.4).unwrap();
        let mean = UniformlyLitDirectionalDipole::new(&half_space);
        for radius in [0.1, 1.0, 5.0] {
            let each = mean.directions.iter().map(|&(w12, _)| {
                let part = mean.dipole.diffusive_part(radius * DVec3::X, w12, DVec3::Z, DVec3::Z);
                mean.dipole.exitance(part)
            });
            let (low, high) = each.fold((f64::INFINITY, 0.0_f64), |(l, h), x| (l.min(x), h.max(x)));
            let value = mean.reflectance(radius);
            assert!(low < value && value < high, "{radius}: {low} {value} {high}");
        }
    }

    #[test]
    fn without_scattering_nothing_returns() {
        let half_space = HalfSpace::new(1.0, 0.0, 0.0, 1.4).unwrap();
        assert_eq!(DirectionalDipole::new(&half_space).reflectance(0.3), 0.0);
        assert_eq!(UniformlyLitDirectionalDipole::new(&half_space).albedo(), 0.0);
    }
}
