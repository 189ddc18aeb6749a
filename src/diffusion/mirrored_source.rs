//! A point source below the boundary and its negative mirror image above: what every dipole sums.

use std::f64::consts::PI;

use glam::DVec3;

use super::{BoundaryMoments, HalfSpace};

/// Diffusion from a point source of unit power at some depth under a plane boundary.
///
/// The fluence of the source and of a negative one mirrored about the height z_b, where it must
/// vanish, is φ = (e^(−σ_tr d_r)/d_r − e^(−σ_tr d_v)/d_v)/(4πD). It leaves as the exitance
/// C_φ φ + C_E E, with E the flux −D ∂φ/∂z through the boundary (d'Eon and Irving 2011).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MirroredSource {
    /// Diffusion coefficient D, m.
    diffusion_coefficient: f64,
    /// Effective transport coefficient σ_tr = √(σ_a/D), 1/m.
    sigma_tr: f64,
    /// Height z_b = 2AD of the plane where the fluence vanishes, m.
    extrapolation: f64,
    /// C_φ.
    fluence_weight: f64,
    /// C_E.
    flux_weight: f64,
}

impl MirroredSource {
    /// Classical diffusion: the exitance is the net flux alone (Jensen et al. 2001).
    pub fn classical(half_space: &HalfSpace) -> Self {
        let reflection_parameter = BoundaryMoments::new(half_space.eta).classical_reflection_parameter();
        Self::new(half_space, half_space.diffusion_coefficient(), reflection_parameter, 0.0, 1.0)
    }

    /// Grosjean's diffusion coefficient and both terms of the exitance (d'Eon and Irving 2011).
    pub fn grosjean(half_space: &HalfSpace) -> Self {
        let moments = BoundaryMoments::new(half_space.eta);
        let coefficient = half_space.diffusion_coefficient_grosjean();
        Self::new(half_space, coefficient, moments.reflection_parameter(), moments.c_phi, moments.c_e)
    }

    fn new(
        half_space: &HalfSpace,
        diffusion_coefficient: f64,
        reflection_parameter: f64,
        fluence_weight: f64,
        flux_weight: f64,
    ) -> Self {
        Self {
            diffusion_coefficient,
            sigma_tr: (half_space.sigma_a / diffusion_coefficient).sqrt(),
            extrapolation: 2.0 * reflection_parameter * diffusion_coefficient,
            fluence_weight,
            flux_weight,
        }
    }

    /// Effective transport coefficient σ_tr, 1/m.
    pub fn sigma_tr(&self) -> f64 {
        self.sigma_tr
    }

    /// Exitance (1/m²) of the boundary at distance `radius` from the axis of a source at `depth`.
    /// Infinite where both are 0.
    pub fn exitance(&self, radius: f64, depth: f64) -> f64 {
        self.attenuated_exitance(radius.hypot(depth), depth, 0.0)
    }

    /// The same at `distance` from the source instead of from its axis, times e^(−`attenuation`).
    ///
    /// All terms are positive and nothing cancels: with Δ = d_v − d_r the two fluences differ by
    /// e^(−σ_tr d_r) (Δ/(d_r d_v) + (1 − e^(−σ_tr Δ))/d_v).
    #[inline]
    pub(super) fn attenuated_exitance(&self, distance: f64, depth: f64, attenuation: f64) -> f64 {
        let (s, lift) = (self.sigma_tr, depth + self.extrapolation);
        // d_v² − d_r² = (z + 2z_b)² − z².
        let excess = 4.0 * self.extrapolation * lift;
        let mirrored = (distance * distance + excess).sqrt();
        let delta = excess / (mirrored + distance);
        let lost = one_minus_exp(s * delta);
        let fluence = (delta / distance + lost) / mirrored;
        let flux_real = depth * (1.0 + s * distance) / distance.powi(3);
        let flux_mirrored =
            (lift + self.extrapolation) * (1.0 + s * mirrored) * (1.0 - lost) / mirrored.powi(3);
        let terms = self.fluence_weight / self.diffusion_coefficient * fluence
            + self.flux_weight * (flux_real + flux_mirrored);
        (-s * distance - attenuation).exp() * terms / (4.0 * PI)
    }

    /// Exitance (1/m²) through a surface element of unit `normal_out` at `offset` (m) from the point of
    /// entry, below which the source lies at `depth` along the unit `normal_in`. Both normals point out of
    /// the body; on a plane this is [`Self::exitance`]. Negative values, of elements that face the mirrored
    /// source, clamp to 0.
    pub fn exitance_between(&self, offset: DVec3, normal_in: DVec3, normal_out: DVec3, depth: f64) -> f64 {
        let from_real = offset + depth * normal_in;
        let from_mirrored = offset - (depth + 2.0 * self.extrapolation) * normal_in;
        let difference = self.point(from_real, normal_out) - self.point(from_mirrored, normal_out);
        difference.max(0.0) / (4.0 * PI)
    }

    /// 4π times the exitance of one point source, `offset` away.
    fn point(&self, offset: DVec3, normal: DVec3) -> f64 {
        let distance = offset.length();
        let argument = self.sigma_tr * distance;
        let fluence = self.fluence_weight / (self.diffusion_coefficient * distance);
        let flux = self.flux_weight * offset.dot(normal) * (1.0 + argument) / distance.powi(3);
        (-argument).exp() * (fluence + flux)
    }

    /// Flux that leaves farther than `radius` from the axis of a source at `depth`, ∫_r^∞ R 2πr' dr', in
    /// closed form: ∫ z(1 + σ_tr d)e^(−σ_tr d)/d² dd = −z e^(−σ_tr d)/d, as r dr = d dd.
    pub fn exitance_beyond(&self, radius: f64, depth: f64) -> f64 {
        let s = self.sigma_tr;
        let mirrored_depth = depth + 2.0 * self.extrapolation;
        let (real, mirrored) = (radius.hypot(depth), radius.hypot(mirrored_depth));
        let delta = 4.0 * self.extrapolation * (depth + self.extrapolation) / (real + mirrored);
        // (1 − e^(−σ_tr Δ))/σ_tr, which tends to Δ.
        let argument = s * delta;
        let lost = one_minus_exp(argument);
        let fluence = if argument > 0.0 { delta * (lost / argument) } else { delta };
        let cos_real = if real > 0.0 { depth / real } else { 1.0 };
        let flux = cos_real + mirrored_depth / mirrored * (1.0 - lost);
        let fluence_weight = self.fluence_weight / self.diffusion_coefficient;
        0.5 * (-s * real).exp() * (fluence_weight * fluence + self.flux_weight * flux)
    }
}

/// 1 − e^(−x) for x ≥ 0, to 10⁻¹³ relative at any size of x and in half the time of `exp_m1`.
#[inline]
pub(super) fn one_minus_exp(x: f64) -> f64 {
    if x < 1e-2 {
        // The next term is x⁵/720.
        x * (1.0 - x / 2.0 * (1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0))))
    } else {
        1.0 - (-x).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sources(sigma_a: f64) -> [MirroredSource; 2] {
        let half_space = HalfSpace::new(sigma_a, 1.0, 0.0, 1.4).unwrap();
        [MirroredSource::classical(&half_space), MirroredSource::grosjean(&half_space)]
    }

    #[test]
    fn on_a_plane_the_form_in_space_is_the_radial_one() {
        for source in sources(0.3) {
            for radius in [0.01, 0.5, 3.0, 20.0] {
                let offset = DVec3::new(0.6 * radius, 0.0, -0.8 * radius);
                let between = source.exitance_between(offset, DVec3::Y, DVec3::Y, 0.7);
                // The form in space subtracts the fluences, of which (r/z_b)² is lost.
                let tolerance = 1e-14 * (1.0 + radius * radius);
                assert!((between / source.exitance(radius, 0.7) - 1.0).abs() < tolerance, "{radius}");
            }
        }
    }

    #[test]
    fn elements_that_face_away_receive_nothing_negative() {
        let [classical, _] = sources(0.3);
        let offset = DVec3::new(0.1, 0.0, 0.0);
        assert_eq!(classical.exitance_between(offset, DVec3::Z, -DVec3::Z, 0.7), 0.0);
    }

    #[test]
    fn absorption_tends_to_none_without_a_step() {
        let ([without_classical, without], [weak_classical, weak]) = (sources(0.0), sources(1e-20));
        for radius in [0.0, 0.3, 5.0, 1e4] {
            for (a, b) in [(&without, &weak), (&without_classical, &weak_classical)] {
                // σ_tr is 2·10⁻¹⁰: the relative change is at most σ_tr times a few lengths, and σ_tr r
                // squared in the exitance.
                let tolerance = 3e-9 + 1e-11 * radius;
                assert!((a.exitance(radius, 1.0) / b.exitance(radius, 1.0) - 1.0).abs() < tolerance);
                assert!((a.exitance_beyond(radius, 1.0) / b.exitance_beyond(radius, 1.0) - 1.0).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn one_minus_exp_keeps_its_digits() {
        for exponent in -40..=12 {
            let x = 10.0_f64.powf(0.25 * f64::from(exponent));
            assert!((one_minus_exp(x) / -(-x).exp_m1() - 1.0).abs() < 2e-13, "{x}");
        }
        assert_eq!(one_minus_exp(0.0), 0.0);
    }
}
