//! The input of the diffusion models: a homogeneous half-space under a smooth dielectric boundary.

/// A homogeneous half-space of one wavelength, with a Henyey–Greenstein phase function.
///
/// Absorption and scattering are kept apart: 1 − albedo would lose its digits where a medium absorbs
/// little. [`HalfSpace::new`] refuses values that no medium has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    /// Absorption coefficient σ_a, 1/m.
    pub sigma_a: f64,
    /// Scattering coefficient σ_s, 1/m.
    pub sigma_s: f64,
    /// Mean cosine g of the phase function, in (−1, 1).
    pub g: f64,
    /// n_inside / n_outside.
    pub eta: f64,
}

/// A value that no half-space has, and what to give in its place.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum HalfSpaceError {
    /// An absorption or scattering coefficient is negative, infinite or not a number.
    #[error("{field} is {value}: give a finite coefficient of 0 or more, in 1/m")]
    Coefficient {
        /// `sigma_a` or `sigma_s`.
        field: &'static str,
        /// The value refused.
        value: f64,
    },
    /// The mean cosine is not inside (−1, 1).
    #[error(
        "g is {0}: give a mean cosine between -1 and 1, both excluded (0 scatters alike in all directions)"
    )]
    MeanCosine(f64),
    /// The relative index is not positive and finite.
    #[error("eta is {0}: give n_inside / n_outside, a finite number above 0 (1 for matched indices)")]
    Eta(f64),
    /// Nothing is absorbed and nothing scattered.
    #[error("sigma_a and sigma_s are both 0: light would never return; make at least one of them positive")]
    Vacuum,
}

impl HalfSpace {
    /// The half-space with these coefficients (1/m), mean cosine and relative index.
    ///
    /// # Errors
    /// Names the field that no medium can have, see [`HalfSpaceError`].
    pub fn new(sigma_a: f64, sigma_s: f64, g: f64, eta: f64) -> Result<Self, HalfSpaceError> {
        for (field, value) in [("sigma_a", sigma_a), ("sigma_s", sigma_s)] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(HalfSpaceError::Coefficient { field, value });
            }
        }
        // Each comparison is false for NaN.
        if !(g > -1.0 && g < 1.0) {
            return Err(HalfSpaceError::MeanCosine(g));
        }
        if !(eta > 0.0 && eta.is_finite()) {
            return Err(HalfSpaceError::Eta(eta));
        }
        if sigma_a + sigma_s == 0.0 {
            return Err(HalfSpaceError::Vacuum);
        }
        Ok(Self { sigma_a, sigma_s, g, eta })
    }

    /// Extinction coefficient σ_t = σ_a + σ_s, 1/m.
    pub fn sigma_t(&self) -> f64 {
        self.sigma_a + self.sigma_s
    }

    /// Reduced scattering coefficient σ_s' = σ_s (1 − g), 1/m: isotropic scattering that spreads light
    /// alike (van de Hulst 1980, similarity of order 1).
    pub fn sigma_s_reduced(&self) -> f64 {
        self.sigma_s * (1.0 - self.g)
    }

    /// Reduced extinction coefficient σ_t' = σ_a + σ_s', 1/m.
    pub fn sigma_t_reduced(&self) -> f64 {
        self.sigma_a + self.sigma_s_reduced()
    }

    /// Reduced mean free path 1/σ_t', m.
    pub fn mean_free_path_reduced(&self) -> f64 {
        1.0 / self.sigma_t_reduced()
    }

    /// Reduced single-scattering albedo α' = σ_s'/σ_t'.
    pub fn albedo_reduced(&self) -> f64 {
        self.sigma_s_reduced() / self.sigma_t_reduced()
    }

    /// The share absorbed at a collision of the reduced medium, 1 − α' = σ_a/σ_t', with its own digits.
    pub fn absorbed_share_reduced(&self) -> f64 {
        self.sigma_a / self.sigma_t_reduced()
    }

    /// Diffusion coefficient of classical diffusion theory, D = 1/(3σ_t'), m.
    pub fn diffusion_coefficient(&self) -> f64 {
        1.0 / (3.0 * self.sigma_t_reduced())
    }

    /// Diffusion coefficient of Grosjean's modified theory, D = (2σ_a + σ_s')/(3σ_t'²), m (d'Eon and
    /// Irving 2011).
    pub fn diffusion_coefficient_grosjean(&self) -> f64 {
        self.diffusion_coefficient() * (1.0 + self.absorbed_share_reduced())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reduced_coefficients() {
        let half_space = HalfSpace::new(2.0, 60.0, 0.9, 1.4).unwrap();
        // A few roundings.
        let close = |a: f64, b: f64| (a / b - 1.0).abs() < 8.0 * f64::EPSILON;
        assert!(close(half_space.sigma_s_reduced(), 6.0));
        assert!(close(half_space.mean_free_path_reduced(), 0.125));
        assert!(close(half_space.albedo_reduced(), 0.75));
        assert!(close(half_space.diffusion_coefficient_grosjean(), (2.0 * 2.0 + 6.0) / (3.0 * 64.0)));
    }

    #[test]
    fn absorption_keeps_its_digits_beside_much_scattering() {
        let half_space = HalfSpace::new(1e-20, 1.0, 0.0, 1.3).unwrap();
        assert_eq!(half_space.absorbed_share_reduced(), 1e-20);
    }

    #[test]
    fn impossible_values_are_refused_by_name() {
        let cases = [
            (HalfSpace::new(-1.0, 1.0, 0.0, 1.3), "sigma_a is -1"),
            (HalfSpace::new(1.0, f64::NAN, 0.0, 1.3), "sigma_s is NaN"),
            (HalfSpace::new(f64::INFINITY, 1.0, 0.0, 1.3), "sigma_a is inf"),
            (HalfSpace::new(1.0, 1.0, 1.0, 1.3), "g is 1"),
            (HalfSpace::new(1.0, 1.0, -1.5, 1.3), "g is -1.5"),
            (HalfSpace::new(1.0, 1.0, f64::NAN, 1.3), "g is NaN"),
            (HalfSpace::new(1.0, 1.0, 0.0, 0.0), "eta is 0"),
            (HalfSpace::new(1.0, 1.0, 0.0, f64::INFINITY), "eta is inf"),
            (HalfSpace::new(0.0, 0.0, 0.0, 1.3), "sigma_a and sigma_s are both 0"),
        ];
        for (result, expected) in cases {
            let message = result.unwrap_err().to_string();
            assert!(message.starts_with(expected), "{message}");
        }
    }
}
