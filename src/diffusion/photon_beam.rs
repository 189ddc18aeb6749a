//! Photon beam diffusion (Habel et al. 2013, "Photon Beam Diffusion: A Hybrid Monte Carlo Method for
//! Subsurface Scattering"), for a beam at normal incidence.
//!
//! The refracted beam is a line of sources in place of the one of a dipole, and light that scattered
//! once is exact. Integrals along the beam are by Gauss–Legendre: the result has no noise. Energy is
//! not conserved: the two parts together exceed 1 by up to 6 % for η = 1 and α' → 1.

use std::f64::consts::TAU;
use std::sync::LazyLock;

use super::integrate::total_energy;
use super::mirrored_source::{MirroredSource, one_minus_exp};
use super::{DiffusionModel, HalfSpace};
use crate::math::quadrature::GaussLegendre;
use crate::optics::fresnel::Interface;
use crate::optics::phase::HenyeyGreenstein;

/// The whole model: multiple plus single scattering.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhotonBeam {
    /// Light scattered more than once.
    pub multiple: BeamMultipleScattering,
    /// Light scattered once.
    pub single: BeamSingleScattering,
}

impl PhotonBeam {
    /// Photon beam diffusion in `half_space`.
    pub fn new(half_space: &HalfSpace) -> Self {
        Self {
            multiple: BeamMultipleScattering::new(half_space),
            single: BeamSingleScattering::new(half_space),
        }
    }
}

impl DiffusionModel for PhotonBeam {
    fn reflectance(&self, radius: f64) -> f64 {
        self.multiple.reflectance(radius) + self.single.reflectance(radius)
    }

    fn albedo(&self) -> f64 {
        self.multiple.albedo() + self.single.albedo()
    }
}

/// Attenuation at which the beam is cut: e^−40 is 4·10⁻¹⁸.
const OPTICAL_REACH: f64 = 40.0;

/// Nodes on each half of the beam: relative error below 3·10⁻⁸ from 10⁻³ to 100 mean free paths, 2·10⁻⁵
/// down to 10⁻⁸.
const MULTIPLE_NODES: usize = 14;

/// Nodes along the beam: relative error below 2·10⁻⁹ from 10⁻³ to 100 mean free paths for |g| ≤ ½, 4·10⁻⁶
/// at g = −0.9, where light scattered back peaks at the normal.
const SINGLE_NODES: usize = 24;

/// Multiple scattering: the beam as a line of mirrored sources of strength α'² σ_t' e^(−σ_t' t), with
/// Habel's correction κ = 1 − e^(−2σ_t'(d_r + t)) for points near the beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamMultipleScattering {
    source: MirroredSource,
    /// σ_t', 1/m.
    sigma_t: f64,
    /// α'² σ_t', 1/m.
    strength: f64,
}

impl BeamMultipleScattering {
    /// Multiple scattering in `half_space`.
    pub fn new(half_space: &HalfSpace) -> Self {
        let sigma_t = half_space.sigma_t_reduced();
        Self {
            source: MirroredSource::grosjean(half_space),
            sigma_t,
            strength: half_space.albedo_reduced().powi(2) * sigma_t,
        }
    }

    /// R(r) with the rule `rule` on each half of the beam.
    ///
    /// t = r sinh u turns the distance √(r² + t²) into r cosh u and its sum with t into r e^u, and takes
    /// the peak near the entry out of the integrand, as equiangular sampling does: dt = d_r du.
    fn integrate(&self, radius: f64, rule: &GaussLegendre) -> f64 {
        let integrand = |u: f64| {
            let grown = radius * u.exp();
            let shrunk = radius * radius / grown;
            let (depth, distance) = (0.5 * (grown - shrunk), 0.5 * (grown + shrunk));
            let correction = one_minus_exp(2.0 * self.sigma_t * grown);
            correction * distance * self.source.attenuated_exitance(distance, depth, self.sigma_t * depth)
        };
        let end = (OPTICAL_REACH / (self.sigma_t * radius)).asinh();
        // The integrand changes at depth r, u ≈ 1, and at the mean free path, u ≈ −ln(σ_t' r).
        let middle = 0.5 * end;
        self.strength * (rule.integrate(0.0, middle, integrand) + rule.integrate(middle, end, integrand))
    }
}

impl DiffusionModel for BeamMultipleScattering {
    /// Infinite at r = 0, where the integral has a logarithmic pole.
    fn reflectance(&self, radius: f64) -> f64 {
        static RULE: LazyLock<GaussLegendre> = LazyLock::new(|| GaussLegendre::new(MULTIPLE_NODES));
        if self.strength == 0.0 {
            return 0.0;
        }
        if radius <= 0.0 {
            return f64::INFINITY;
        }
        self.integrate(radius, &RULE)
    }

    /// By quadrature over radii, as κ leaves no closed form: about a millisecond.
    fn albedo(&self) -> f64 {
        total_energy(self, 1.0 / self.sigma_t)
    }
}

/// Single scattering, exact: light that leaves the beam at depth t straight towards the boundary,
/// R(r) = ∫ σ_s e^(−σ_t(t+d)) p(−cos_o) (1 − F(cos_o)) cos_o/d² dt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamSingleScattering {
    half_space: HalfSpace,
    /// The first u = asinh(t/r) from which light is not totally reflected.
    first: f64,
}

impl BeamSingleScattering {
    /// Single scattering in `half_space`.
    pub fn new(half_space: &HalfSpace) -> Self {
        let eta = half_space.eta;
        // t_crit = r √(η² − 1); no angle is totally reflected for η ≤ 1.
        let contrast = (eta - 1.0) * (eta + 1.0);
        Self { half_space: *half_space, first: contrast.max(0.0).sqrt().asinh() }
    }

    /// R(r) with the rule `rule` along the beam.
    ///
    /// With t = r sinh u one has t + d = r e^u, cos_o = tanh u and dt/d² = du/(r cosh u); then
    /// u = u₀ + (u₁ − u₀)x² takes out the square root with which light leaves total reflection.
    fn integrate(&self, radius: f64, rule: &GaussLegendre) -> f64 {
        let extinction = self.half_space.sigma_t() * radius;
        let start = self.first.exp();
        // 1/cosh u ends the integral near the entry, attenuation far from it.
        let span = (OPTICAL_REACH / (extinction * start)).ln_1p().min(OPTICAL_REACH);
        let integral = rule.integrate(0.0, 1.0, |x| {
            let grown = start * (span * x * x).exp();
            let (sinh, cosh) = (0.5 * (grown - 1.0 / grown), 0.5 * (grown + 1.0 / grown));
            x * (-extinction * grown).exp() * self.towards_boundary(sinh / cosh) / cosh
        });
        self.half_space.sigma_s / radius * 2.0 * span * integral
    }

    /// Share per solid angle of light scattered up at `cos` to the normal that leaves, times `cos`.
    fn towards_boundary(&self, cos: f64) -> f64 {
        let transmittance = Interface::new(cos, 1.0 / self.half_space.eta).transmittance;
        HenyeyGreenstein { g: self.half_space.g }.density(-cos) * transmittance * cos
    }
}

impl DiffusionModel for BeamSingleScattering {
    /// Infinite at r = 0, where the profile has a pole 1/r.
    fn reflectance(&self, radius: f64) -> f64 {
        static RULE: LazyLock<GaussLegendre> = LazyLock::new(|| GaussLegendre::new(SINGLE_NODES));
        if self.half_space.sigma_s == 0.0 {
            return 0.0;
        }
        if radius <= 0.0 {
            return f64::INFINITY;
        }
        self.integrate(radius, &RULE)
    }

    /// 2π ω ∫ p(−μ) (1 − F(μ)) μ/(1 + μ) dμ: a beam lost at depth t loses e^(−σ_t t/μ) more on the way out.
    fn albedo(&self) -> f64 {
        let critical = self.first.tanh();
        let span = 1.0 - critical;
        let integral = GaussLegendre::new(4 * SINGLE_NODES).integrate(0.0, 1.0, |x| {
            let mu = critical + span * x * x;
            2.0 * span * x * self.towards_boundary(mu) / (1.0 + mu)
        });
        TAU * self.half_space.sigma_s / self.half_space.sigma_t() * integral
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diffusion::integrate::energy_between;

    fn media() -> [HalfSpace; 6] {
        [
            HalfSpace::new(0.1, 0.9, 0.0, 1.5),
            HalfSpace::new(0.0, 1.0, 0.0, 1.33),
            HalfSpace::new(0.5, 0.5, 0.0, 1.0),
            HalfSpace::new(1e-3, 1.0, 0.0, 1.001),
            HalfSpace::new(0.1, 0.9, 0.5, 0.75),
            HalfSpace::new(0.1, 0.5, -0.9, 1.33),
        ]
        .map(Result::unwrap)
    }

    #[test]
    fn quadrature_error_is_as_stated() {
        let fine = GaussLegendre::new(200);
        for half_space in media() {
            let PhotonBeam { multiple, single } = PhotonBeam::new(&half_space);
            let single_bound = if half_space.g < -0.5 { 4e-6 } else { 2e-9 };
            for i in -80..=20 {
                let paths = 10.0_f64.powf(0.1 * f64::from(i));
                let radius = paths * half_space.mean_free_path_reduced();
                let multiple_error = multiple.reflectance(radius) / multiple.integrate(radius, &fine) - 1.0;
                let radius = paths / half_space.sigma_t();
                let single_error = single.reflectance(radius) / single.integrate(radius, &fine) - 1.0;
                let near = i < -30;
                assert!(
                    multiple_error.abs() < if near { 2e-5 } else { 3e-8 },
                    "{half_space:?} {paths}: {multiple_error}"
                );
                assert!(near || single_error.abs() < single_bound, "{half_space:?} {paths}: {single_error}");
            }
        }
    }

    #[test]
    fn single_scattering_adds_up_to_its_closed_form() {
        for half_space in media() {
            let single = BeamSingleScattering::new(&half_space);
            let sum = total_energy(&single, 1.0 / half_space.sigma_t());
            // The error per radius; below 10⁻³ mean free paths lies a thousandth of the energy.
            let tolerance = if half_space.g < -0.5 { 1e-5 } else { 1e-8 };
            assert!((sum / single.albedo() - 1.0).abs() < tolerance, "{half_space:?}: {sum}");
        }
    }

    /// The same double integral in the other order and in other variables: depth outside, and inside
    /// the distance d to the source, r dr = d dd.
    #[test]
    fn multiple_scattering_adds_up_in_either_order() {
        let half_space = HalfSpace::new(0.1, 0.9, 0.0, 1.5).unwrap();
        let multiple = BeamMultipleScattering::new(&half_space);
        let rule = GaussLegendre::new(16);
        // Panels of one e-fold in the depth and in the distance beyond it.
        let panels = |from: i32, to: i32, f: &dyn Fn(f64) -> f64| -> f64 {
            (from..to)
                .map(|i| {
                    rule.integrate(f64::from(i), f64::from(i + 1), |log| {
                        let x = log.exp();
                        x * f(x)
                    })
                })
                .sum()
        };
        let by_depth = panels(-24, 4, &|t| {
            let inner = panels(-30, 6, &|beyond| {
                let distance = t + beyond;
                let kappa = 1.0 - (-2.0 * multiple.sigma_t * (distance + t)).exp();
                let radius = (beyond * (distance + t)).sqrt();
                TAU * distance * kappa * multiple.source.exitance(radius, t)
            });
            multiple.strength * (-multiple.sigma_t * t).exp() * inner
        });
        // What lies above e^−24 of a mean free path, and the error per radius.
        assert!((by_depth / multiple.albedo() - 1.0).abs() < 3e-8, "{by_depth} {}", multiple.albedo());
    }

    #[test]
    fn matched_isotropic_single_scattering_is_known() {
        // 2π (ω/4π) ∫ μ/(1 + μ) dμ = ω (1 − ln 2)/2.
        let half_space = HalfSpace::new(0.1, 0.9, 0.0, 1.0).unwrap();
        let exact = 0.45 * (1.0 - std::f64::consts::LN_2);
        assert!((BeamSingleScattering::new(&half_space).albedo() / exact - 1.0).abs() < 1e-14);
    }

    #[test]
    fn index_one_is_no_step() {
        let at = |eta: f64| PhotonBeam::new(&HalfSpace::new(0.1, 0.9, 0.0, eta).unwrap());
        for radius in [0.01, 1.0, 10.0] {
            let matched = at(1.0).reflectance(radius);
            for eta in [1.0 - 1e-9, 1.0 + 1e-9] {
                // Fresnel's reflectance is felt below a cosine of about √(2·10⁻⁹).
                assert!((at(eta).reflectance(radius) / matched - 1.0).abs() < 1e-7, "{eta} {radius}");
            }
        }
    }

    #[test]
    fn energy_falls_off_with_radius() {
        let model = PhotonBeam::new(&media()[4]);
        let inner = energy_between(&model, 0.0, 1.0);
        let outer = energy_between(&model, 1.0, 1e4);
        assert!((inner + outer - model.albedo()).abs() < 1e-7 * model.albedo());
    }
}
