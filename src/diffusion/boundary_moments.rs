//! What the diffusion models need to know of a smooth boundary: moments of its Fresnel reflectance.

use crate::optics::fresnel::fresnel_moment;

/// Weights and reflection parameters of a smooth dielectric boundary, from the moments
/// C_k = ∫₀¹ F(μ) μᵏ dμ of its reflectance for light from inside.
///
/// The moments are integrated, not taken from the usual polynomial fits: the fit to C₂ is negative
/// near η = 1, where C₂ vanishes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundaryMoments {
    /// C_φ = (1 − 2C₁)/4: exitance per fluence just below the boundary (d'Eon and Irving 2011).
    pub c_phi: f64,
    /// C_E = (1 − 3C₂)/2: exitance per net flux through the boundary (the same equation).
    pub c_e: f64,
    /// C_φ of the boundary seen from outside, (1 − 2C₁(1/η))/4: four times this is the share of uniform
    /// light that enters.
    pub c_phi_outside: f64,
}

impl BoundaryMoments {
    /// The boundary of relative index `eta` = n_inside/n_outside, positive.
    pub fn new(eta: f64) -> Self {
        // Uniform light in equilibrium passes both ways alike, 1 − 2C₁(inside) = (1 − 2C₁(outside))/η²:
        // taken from the side that reflects less, neither loses digits.
        let (inside, outside) = if eta >= 1.0 {
            let outside = 1.0 - 2.0 * fresnel_moment(eta, 1);
            (outside / (eta * eta), outside)
        } else {
            let inside = 1.0 - 2.0 * fresnel_moment(1.0 / eta, 1);
            (inside, inside * eta * eta)
        };
        Self {
            c_phi: 0.25 * inside,
            c_e: 0.5 * (1.0 - 3.0 * fresnel_moment(1.0 / eta, 2)),
            c_phi_outside: 0.25 * outside,
        }
    }

    /// A = (1 + F_dr)/(1 − F_dr) with the diffuse internal reflectance F_dr = 2C₁: the boundary of
    /// classical diffusion (Jensen et al. 2001, section 2.1), where the fluence vanishes at −2AD.
    pub fn classical_reflection_parameter(&self) -> f64 {
        (2.0 - 4.0 * self.c_phi) / (4.0 * self.c_phi)
    }

    /// A = (1 + 3C₂)/(1 − 2C₁) = (1 − C_E)/(2C_φ): the boundary that also balances the flux
    /// (d'Eon and Irving 2011).
    pub fn reflection_parameter(&self) -> f64 {
        (1.0 - self.c_e) / (2.0 * self.c_phi)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matched_indices_reflect_nothing() {
        let moments = BoundaryMoments::new(1.0);
        assert_eq!(moments, BoundaryMoments { c_phi: 0.25, c_e: 0.5, c_phi_outside: 0.25 });
        assert_eq!(moments.classical_reflection_parameter(), 1.0);
        assert_eq!(moments.reflection_parameter(), 1.0);
    }

    #[test]
    fn swapping_the_sides_swaps_the_weights() {
        for eta in [1.0001, 1.05, 1.5, 2.5] {
            let (dense, bubble) = (BoundaryMoments::new(eta), BoundaryMoments::new(1.0 / eta));
            // 1/η is rounded, and the quadrature is good to 1e-14.
            assert!((dense.c_phi / bubble.c_phi_outside - 1.0).abs() < 1e-13, "eta {eta}");
            assert!((dense.c_phi_outside / bubble.c_phi - 1.0).abs() < 1e-13, "eta {eta}");
        }
    }

    #[test]
    fn exact_reflection_parameters() {
        // C₁ and C₂ of light from inside, with 12 digits from a 40-digit quadrature.
        for line in include_str!("../../tests/data/fresnel_moments.csv").lines().skip(2) {
            let row: Vec<f64> = line.split(',').map(|number| number.parse().unwrap()).collect();
            let (eta, c1, c2) = (row[0], row[6], row[7]);
            let moments = BoundaryMoments::new(eta);
            let classical = (1.0 + 2.0 * c1) / (1.0 - 2.0 * c1);
            let full = (1.0 + 3.0 * c2) / (1.0 - 2.0 * c1);
            // Twelve digits of C₁ and C₂, magnified by 1/(1 − 2C₁)² < 50 for the indices listed.
            assert!((moments.classical_reflection_parameter() / classical - 1.0).abs() < 1e-10, "{line}");
            assert!((moments.reflection_parameter() / full - 1.0).abs() < 1e-10, "{line}");
        }
    }
}
