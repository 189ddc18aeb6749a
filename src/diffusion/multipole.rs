//! The multipole of a slab (Donner and Jensen 2005, "Light Diffusion in Multi-Layered Translucent
//! Materials"): the dipole mirrored at both faces, over and over.

use std::f64::consts::PI;

use super::mirrored_source::one_minus_exp;
use super::{BoundaryMoments, DiffusionModel, HalfSpace};

/// A slab with the same boundary on both sides, lit at normal incidence on one.
///
/// With D = 1/(3σ_t'), ℓ = 1/σ_t', z_b = 2AD and period P = T + 2z_b, sources stand at z = 2iP + ℓ and
/// negative ones at z = 2iP − ℓ − 2z_b for all integers i, so that the fluence vanishes z_b outside
/// either face. Multiple scattering only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Multipole {
    /// α'.
    strength: f64,
    /// σ_tr, 1/m.
    sigma_tr: f64,
    /// Depth ℓ of the source, m.
    depth: f64,
    /// z_b, m.
    extrapolation: f64,
    /// Thickness T, m.
    thickness: f64,
}

/// A thickness for which the multipole does not hold.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MultipoleError {
    /// Not a positive finite length.
    #[error("thickness is {0}: give a finite thickness above 0, in m")]
    Thickness(f64),
    /// The source would stand outside of the slab.
    #[error(
        "thickness is {thickness} m, not more than the reduced mean free path of {mean_free_path} m: \
         diffusion does not hold in so thin a slab; give a thicker one, or trace it by Monte Carlo"
    )]
    Thin {
        /// The thickness refused, m.
        thickness: f64,
        /// 1/σ_t', m.
        mean_free_path: f64,
    },
}

/// Mirror images summed one by one on each side; an integral stands for the rest (see [`Multipole::sum`]).
const IMAGES: f64 = 64.0;

/// Optical distance at which images are too faint to count: e^−40 is 4·10⁻¹⁸.
const OPTICAL_REACH: f64 = 40.0;

/// Radius, in periods, beyond which the profile is lost to rounding: its slowest mode falls as
/// e^(−πr/P), to 10⁻¹⁵ here, while the images that cancel do not.
const RADIUS_REACH: f64 = 11.0;

impl Multipole {
    /// The multipole of a slab of `thickness` (m) cut from `half_space`.
    ///
    /// # Errors
    /// If the thickness is not positive and finite, or not more than a reduced mean free path.
    pub fn new(half_space: &HalfSpace, thickness: f64) -> Result<Self, MultipoleError> {
        let depth = half_space.mean_free_path_reduced();
        if !(thickness > 0.0 && thickness.is_finite()) {
            return Err(MultipoleError::Thickness(thickness));
        }
        if thickness <= depth {
            return Err(MultipoleError::Thin { thickness, mean_free_path: depth });
        }
        let reflection_parameter = BoundaryMoments::new(half_space.eta).classical_reflection_parameter();
        let diffusion_coefficient = half_space.diffusion_coefficient();
        Ok(Self {
            strength: half_space.albedo_reduced(),
            sigma_tr: (half_space.sigma_a / diffusion_coefficient).sqrt(),
            depth,
            extrapolation: 2.0 * reflection_parameter * diffusion_coefficient,
            thickness,
        })
    }

    /// T(r), 1/m² per unit flux that entered: what leaves the far face at `radius` (m) from the axis of
    /// the beam. Never negative.
    pub fn transmittance(&self, radius: f64) -> f64 {
        // Seen from the far face, the images stand as those of a source T − ℓ under it.
        self.sum(radius, self.thickness - self.depth)
    }

    /// ∫₀^∞ T(r) 2πr dr = α' cosh(σ_tr z_b) sinh(σ_tr(z_b + ℓ))/sinh(σ_tr P).
    pub fn total_transmittance(&self) -> f64 {
        self.total(self.extrapolation + self.depth)
    }

    /// P: images of one source stand 2P apart, m.
    fn period(&self) -> f64 {
        self.thickness + 2.0 * self.extrapolation
    }

    /// Flux per area through a face at `radius` from the axis of a source `depth` below that face.
    ///
    /// After [`IMAGES`] pairs on each side the rest is their integral and one term of Euler–Maclaurin,
    /// Σ_{i>N} h(i) = ∫_{N+½}^∞ h + h'(N + ½)/24. The next term bounds the truncation: it falls as N⁻⁶,
    /// to 10⁻¹²/P² also without absorption, where the images alone would converge as N⁻².
    fn sum(&self, radius: f64, depth: f64) -> f64 {
        let period = self.period();
        if radius > RADIUS_REACH * period {
            return 0.0;
        }
        let lower = depth + 2.0 * self.extrapolation;
        // The four images at distance 2iP: sources above and below, and the negative ones.
        let four = |i: f64, term: &dyn Fn(f64) -> f64| {
            let center = 2.0 * i * period;
            term(center + depth) + term(center + lower) - term(center - depth) - term(center - lower)
        };
        let flux = |z: f64| self.flux(radius, z);
        let images = IMAGES.min((OPTICAL_REACH / (2.0 * self.sigma_tr * period)).ceil());
        let near: f64 = (1..=images as usize).map(|i| four(i as f64, &flux)).sum();
        let rest = four(images + 0.5, &|z| {
            self.flux_beyond(radius, z) / (2.0 * period) + 2.0 * period * self.flux_slope(radius, z) / 24.0
        });
        let total = flux(depth) + flux(lower) + near + rest;
        (self.strength / (4.0 * PI) * total).max(0.0)
    }

    /// 4π times the flux through the face of a source at depth `z`, z (1 + s d) e^(−s d)/d³.
    fn flux(&self, radius: f64, z: f64) -> f64 {
        let distance = radius.hypot(z);
        let argument = self.sigma_tr * distance;
        z * (1.0 + argument) * (-argument).exp() / distance.powi(3)
    }

    /// ∫_z^∞ of [`Self::flux`] over depths: e^(−s d)/d.
    fn flux_beyond(&self, radius: f64, z: f64) -> f64 {
        let distance = radius.hypot(z);
        (-self.sigma_tr * distance).exp() / distance
    }

    /// Derivative of [`Self::flux`] by depth.
    fn flux_slope(&self, radius: f64, z: f64) -> f64 {
        let distance = radius.hypot(z);
        let argument = self.sigma_tr * distance;
        let one_plus = 1.0 + argument;
        let cos = z / distance;
        let bracket = one_plus - cos * cos * (3.0 * one_plus + argument * argument);
        (-argument).exp() * bracket / distance.powi(3)
    }

    /// α' cosh(s z_b) sinh(s `height`)/sinh(s P), with all exponentials negative; the ratio of lengths
    /// for s = σ_tr → 0.
    fn total(&self, height: f64) -> f64 {
        let (s, period) = (self.sigma_tr, self.period());
        // (1 − e^(−2sx))/s, which tends to 2x.
        let rise = |x: f64| if s > 0.0 { one_minus_exp(2.0 * s * x) / s } else { 2.0 * x };
        let lift = s * self.extrapolation;
        let cosh_and_decay = (s * (height - period) + lift).exp() * 0.5 * (1.0 + (-2.0 * lift).exp());
        self.strength * cosh_and_decay * rise(height) / rise(period)
    }
}

impl DiffusionModel for Multipole {
    fn reflectance(&self, radius: f64) -> f64 {
        self.sum(radius, self.depth)
    }

    /// ∫₀^∞ R(r) 2πr dr = α' cosh(σ_tr z_b) sinh(σ_tr(T + z_b − ℓ))/sinh(σ_tr P).
    fn albedo(&self) -> f64 {
        self.total(self.thickness + self.extrapolation - self.depth)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diffusion::Dipole;
    use crate::diffusion::integrate::total_energy;

    /// Transmittance as a model of its own, to be integrated.
    struct FarFace(Multipole);

    impl DiffusionModel for FarFace {
        fn reflectance(&self, radius: f64) -> f64 {
            self.0.transmittance(radius)
        }

        fn albedo(&self) -> f64 {
            self.0.total_transmittance()
        }
    }

    fn slab(sigma_a: f64, thickness: f64) -> Multipole {
        Multipole::new(&HalfSpace::new(sigma_a, 1.0, 0.0, 1.4).unwrap(), thickness).unwrap()
    }

    #[test]
    fn closed_totals_are_the_integrals() {
        for (sigma_a, thickness) in [(0.0, 1.5), (0.0, 20.0), (1e-9, 3.0), (0.01, 5.0), (0.5, 4.0)] {
            let slab = slab(sigma_a, thickness);
            for model in [&slab as &dyn DiffusionModel, &FarFace(slab)] {
                // The truncation of the sum, 10⁻¹²/P², over a disk of eleven periods.
                let error = total_energy(model, 1.0) - model.albedo();
                assert!(error.abs() < 4e-10, "{sigma_a} {thickness}: {error}");
            }
        }
    }

    #[test]
    fn without_absorption_what_does_not_return_passes() {
        for thickness in [1.1, 4.0, 1000.0] {
            for sigma_a in [0.0, 1e-30] {
                let slab = slab(sigma_a, thickness);
                // A dozen roundings; an absorption of 10⁻³⁰ over 10⁶ scatterings cannot be seen.
                let sum = slab.albedo() + slab.total_transmittance();
                assert!((sum - 1.0).abs() < 12.0 * f64::EPSILON, "{thickness}: {sum}");
            }
        }
    }

    #[test]
    fn truncated_sum_is_the_long_one() {
        for (sigma_a, thickness) in [(0.0, 1.5), (1e-5, 3.0), (0.05, 2.0)] {
            let slab = slab(sigma_a, thickness);
            let period = slab.period();
            let source = slab.depth;
            let mirrored = source + 2.0 * slab.extrapolation;
            for radius in [0.0, 0.1, 1.0, 2.0 * period] {
                let long: f64 = (-200_000..=200_000)
                    .map(|i| {
                        let center = 2.0 * f64::from(i) * period;
                        slab.flux(radius, center + source) - slab.flux(radius, center - mirrored)
                    })
                    .sum();
                let long = slab.strength * long / (4.0 * PI);
                // The long sum itself stops at 200,000 images: their fluxes fall as i⁻³.
                let error = slab.reflectance(radius) - long;
                assert!(error.abs() < 2e-12, "{sigma_a} {thickness} {radius}: {error}");
            }
        }
    }

    #[test]
    fn a_thick_slab_is_a_half_space() {
        let half_space = HalfSpace::new(0.1, 1.0, 0.0, 1.4).unwrap();
        let (slab, dipole) = (Multipole::new(&half_space, 80.0).unwrap(), Dipole::new(&half_space));
        // e^(−2 σ_tr T) is below 10⁻³⁹.
        assert!((slab.albedo() / dipole.albedo() - 1.0).abs() < 1e-14);
        for radius in [0.0, 0.5, 10.0] {
            assert!((slab.reflectance(radius) / dipole.reflectance(radius) - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn slabs_too_thin_for_diffusion_are_refused() {
        let half_space = HalfSpace::new(0.1, 1.9, 0.0, 1.4).unwrap();
        for thickness in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(Multipole::new(&half_space, thickness), Err(MultipoleError::Thickness(_))));
        }
        let message = Multipole::new(&half_space, 0.4).unwrap_err().to_string();
        assert!(message.starts_with("thickness is 0.4 m") && message.contains("0.5 m"), "{message}");
    }
}
