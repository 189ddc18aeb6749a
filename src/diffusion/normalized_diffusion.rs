//! Normalized diffusion (Christensen and Burley 2015, "Approximate Reflectance Profiles for
//! Efficient Subsurface Scattering").
//!
//! R(r) = (e^(−r/d) + e^(−r/3d)) / (8π d r): a mixture of two exponentials in r, a quarter of the
//! energy with scale d and three quarters with scale 3d.

use std::f32::consts::PI;

use super::{DiffusionModel, Profile};

/// The paper's three fits of the shape parameter d = ℓ/s(A) to Monte Carlo of an index-matched,
/// isotropically scattering half-space of albedo A. They differ in how light enters and in the length ℓ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fit {
    /// A beam at normal incidence; ℓ is the mean free path 1/σ_t' (equation 5).
    Searchlight,
    /// Diffuse transmission into the surface; ℓ is the mean free path 1/σ_t' (equation 6).
    DiffuseTransmission,
    /// ℓ is the diffuse mean free path on the surface, about 1/σ_tr (equation 8).
    DiffuseMeanFreePath,
}

impl Fit {
    /// s at albedo `albedo` in [0, 1].
    pub fn scale(self, albedo: f64) -> f64 {
        match self {
            Self::Searchlight => 1.85 - albedo + 7.0 * (albedo - 0.8).abs().powi(3),
            Self::DiffuseTransmission => 1.9 - albedo + 3.5 * (albedo - 0.8).powi(2),
            Self::DiffuseMeanFreePath => 3.5 + 100.0 * (albedo - 0.33).powi(4),
        }
    }

    /// d = ℓ/s, in the unit of `length`.
    pub fn shape_parameter(self, albedo: f64, length: f64) -> f64 {
        length / self.scale(albedo)
    }
}

/// The profile with shape parameter d.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalizedDiffusion {
    /// Shape parameter d, m; positive.
    pub d: f32,
}

impl NormalizedDiffusion {
    /// The profile of a medium with mean free path `mean_free_path` (1/σ_t', m) that reflects the
    /// share `albedo` of uniform light behind an index-matched boundary ([`Fit::DiffuseTransmission`]).
    pub fn from_albedo(albedo: f32, mean_free_path: f32) -> Self {
        let d = Fit::DiffuseTransmission.shape_parameter(f64::from(albedo), f64::from(mean_free_path));
        Self { d: d as f32 }
    }
}

/// Normalized diffusion times the albedo, in double precision: R_d as a [`DiffusionModel`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalizedDiffusionModel {
    albedo: f64,
    /// Shape parameter d, m.
    d: f64,
}

impl NormalizedDiffusionModel {
    /// The model of total albedo `albedo` in [0, 1], with d by `fit` for its `length`, m.
    pub fn new(fit: Fit, albedo: f64, length: f64) -> Self {
        Self { albedo, d: fit.shape_parameter(albedo, length) }
    }

    /// Energy farther than `radius`, A (e^(−r/d) + 3e^(−r/3d))/4.
    ///
    /// It is also the light through a body of thickness t = `radius` if the profile is taken at the
    /// distance in space, ∫₀^∞ R(√(r² + t²)) 2πr dr, as both integrals are the same.
    pub fn energy_beyond(&self, radius: f64) -> f64 {
        let slow = (-radius / (3.0 * self.d)).exp();
        0.25 * self.albedo * (slow.powi(3) + 3.0 * slow)
    }
}

impl DiffusionModel for NormalizedDiffusionModel {
    /// Infinite at r = 0, where the profile has a pole 1/r.
    fn reflectance(&self, radius: f64) -> f64 {
        if self.albedo == 0.0 {
            return 0.0;
        }
        let slow = (-radius / (3.0 * self.d)).exp();
        self.albedo * (slow.powi(3) + slow) / (8.0 * std::f64::consts::PI * self.d * radius)
    }

    fn albedo(&self) -> f64 {
        self.albedo
    }
}

impl Profile for NormalizedDiffusion {
    fn density(&self, radius: f32) -> f32 {
        // e^(−r/d) is the cube of e^(−r/3d).
        let slow = (-radius / (3.0 * self.d)).exp();
        (slow * slow * slow + slow) / (8.0 * PI * self.d * radius)
    }

    fn cumulative(&self, radius: f32) -> f32 {
        // 1 − e^(−x)/4 − 3e^(−x/3)/4 written without cancellation near 0.
        let x = radius / self.d;
        -0.25 * (-x).exp_m1() - 0.75 * (-x / 3.0).exp_m1()
    }

    fn sample_radius(&self, xi: f32) -> f32 {
        self.d * standard_quantile(xi)
    }

    fn radius_of_ratio(&self, radius: f32, ratio: f32) -> f32 {
        // R(r)/R(r₀) ≤ (r₀/r) e^(−(r−r₀)/3d): either factor alone bounds r.
        let by_pole = radius / ratio;
        let by_tail = radius - 3.0 * self.d * ratio.ln();
        by_pole.min(by_tail)
    }
}

/// The radius, in units of d, within which the share `xi` of the energy lies.
///
/// With z = 1 − e^(−x/3) the cumulative distribution is the cubic z³ − 3z² + 6z = 4ξ. Near the centre
/// it is solved by Newton's iteration for z itself, which keeps all digits as ξ → 0; in the tail by
/// the closed form for y = 1 − z, y³ + 3y = 4(1 − ξ), y = 2 sinh(asinh(2(1 − ξ))/3).
fn standard_quantile(xi: f32) -> f32 {
    if xi < 0.5 {
        let mut z = xi * (2.0 / 3.0);
        for _ in 0..4 {
            let value = z * (z * (z - 3.0) + 6.0) - 4.0 * xi;
            let slope = 3.0 * z * (z - 2.0) + 6.0;
            z -= value / slope;
        }
        -3.0 * (-z).ln_1p()
    } else {
        // The largest float below 1 bounds the tail: beyond it lies 6·10⁻⁸ of the energy, spread over it.
        let rest = (1.0 - xi).max(f32::EPSILON / 4.0);
        let y = 2.0 * ((2.0 * rest).asinh() / 3.0).sinh();
        -3.0 * y.ln()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::quadrature::GaussLegendre;
    use crate::math::sampler::HashGenerator;

    /// (ξ, exact x) computed with 30 digits.
    const QUANTILES: [(f32, f64); 3] =
        [(1e-7, 2.000_000_156_705_5e-7), (1e-6, 2.000_001_328_284_8e-6), (1e-5, 2.000_013_282_912_1e-5)];

    #[test]
    fn quantile_inverts_the_cumulative_distribution_at_every_scale() {
        let profile = NormalizedDiffusion { d: 1.0 };
        for i in 0..4000 {
            let xi = 10.0_f32.powf(-7.0 * (i as f32 + 0.5) / 4000.0);
            let back = profile.cumulative(profile.sample_radius(xi));
            // A dozen roundings, each half an ulp, of the smaller of ξ and 1 − ξ's image: 1e-6 relative.
            assert!((back - xi).abs() < 1e-6 * xi, "xi {xi}: {back}");
        }
        for (xi, exact) in &QUANTILES {
            let x = f64::from(profile.sample_radius(*xi));
            assert!((x / exact - 1.0).abs() < 1e-6, "xi {xi}: {x} against {exact}");
        }
    }

    #[test]
    fn density_is_the_derivative_of_the_cumulative_distribution() {
        let profile = NormalizedDiffusion { d: 0.7 };
        for r in [0.01_f32, 0.3, 2.0, 9.0] {
            let integral = GaussLegendre::new(32).integrate(0.0, f64::from(r), |x| {
                f64::from(profile.density(x as f32)) * std::f64::consts::TAU * x
            });
            let cumulative = f64::from(profile.cumulative(r));
            assert!((integral / cumulative - 1.0).abs() < 2e-6, "r {r}: {integral} against {cumulative}");
        }
    }

    #[test]
    fn sampled_radii_pass_kolmogorov_smirnov() {
        let profile = NormalizedDiffusion { d: 0.003 };
        let mut generator = HashGenerator::new(7);
        let n = 100_000;
        let mut radii: Vec<f32> = (0..n).map(|_| profile.sample_radius(generator.next_f32())).collect();
        radii.sort_by(f32::total_cmp);
        let distance = radii
            .iter()
            .enumerate()
            .map(|(i, r)| (f64::from(profile.cumulative(*r)) - (i as f64 + 0.5) / n as f64).abs())
            .fold(0.0, f64::max);
        // Kolmogorov's distribution: 1.95/√n is exceeded once in a thousand sets.
        assert!(distance < 1.95 / f64::from(n).sqrt(), "{distance}");
    }

    #[test]
    fn density_beyond_the_bound_is_below_the_ratio() {
        let profile = NormalizedDiffusion { d: 0.2 };
        for radius in [1e-4, 0.01, 0.2, 3.0] {
            for ratio in [0.5, 0.05, 1e-4, 1e-9] {
                let bound = profile.radius_of_ratio(radius, ratio);
                // Up to rounding of the exponent.
                assert!(profile.density(bound) <= ratio * profile.density(radius) * 1.0001);
            }
        }
    }

    #[test]
    fn double_precision_is_the_same_profile() {
        let albedo = 0.6_f32;
        let single = NormalizedDiffusion::from_albedo(albedo, 0.003);
        let double = NormalizedDiffusionModel { albedo: f64::from(albedo), d: f64::from(single.d) };
        for r in [1e-5_f32, 1e-3, 0.01] {
            let expected = double.reflectance(f64::from(r)) / f64::from(albedo);
            // e^−x in single precision to x/2 ulps and its cube, for x up to 3.
            assert!((f64::from(single.density(r)) / expected - 1.0).abs() < 1e-6, "{r}");
            let cumulative = 1.0 - double.energy_beyond(f64::from(r)) / f64::from(albedo);
            assert!((f64::from(single.cumulative(r)) / cumulative - 1.0).abs() < 1e-6, "{r}");
        }
    }

    #[test]
    fn light_through_a_thickness_is_the_integral_over_the_far_side() {
        let model = NormalizedDiffusionModel::new(Fit::DiffuseMeanFreePath, 0.7, 1.0);
        let rule = GaussLegendre::new(32);
        for thickness in [0.05, 0.3, 1.0] {
            let through: f64 = (-12..6)
                .map(|i| {
                    rule.integrate(f64::from(i), f64::from(i + 1), |log_radius| {
                        let radius = log_radius.exp();
                        model.reflectance(radius.hypot(thickness)) * std::f64::consts::TAU * radius * radius
                    })
                })
                .sum();
            // Radii below e^−12 hold about r²/t² of it.
            assert!((through / model.energy_beyond(thickness) - 1.0).abs() < 1e-7, "{thickness}");
        }
    }
}
