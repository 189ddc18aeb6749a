//! Dispersion: the index of refraction by wavelength.

use thiserror::Error;

use super::{LONGEST, SHORTEST};

/// Fraunhofer lines F (hydrogen), d (helium) and C (hydrogen), nm.
pub const FRAUNHOFER_LINES: [f64; 3] = [486.1327, 587.5618, 656.2725];

/// An index of refraction that depends on the wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Dispersion {
    /// n = A + B/λ² + C/λ⁴ with λ in nm (Cauchy 1830).
    Cauchy([f64; 3]),
    /// n² = 1 + Σ Bᵢ λ²/(λ² − Cᵢ) with λ in µm and Cᵢ in µm² (Sellmeier 1871).
    Sellmeier {
        /// Strengths Bᵢ.
        b: [f64; 3],
        /// Squared wavelengths of resonance Cᵢ, µm².
        c: [f64; 3],
    },
}

/// No glass has such a dispersion.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum DispersionError {
    /// An Abbe number not above 0.
    #[error("an Abbe number of {0}; it must be finite and above 0 (glasses have 20 to 90)")]
    Abbe(f64),
    /// An index not above 0, at the wavelength where it is found first.
    #[error("an index of refraction of {ior} at {nanometres} nm; it must be finite and above 0")]
    Ior {
        /// The index.
        ior: f64,
        /// Where.
        nanometres: f64,
    },
    /// A resonance where light is visible.
    #[error("a resonance at {nanometres} nm (C = {c} µm²): the index is infinite at a visible wavelength")]
    Resonance {
        /// The coefficient.
        c: f64,
        /// Its wavelength.
        nanometres: f64,
    },
}

impl Dispersion {
    /// The glass of index `ior` at the line d and of Abbe number V = (n_d − 1)/(n_F − n_C), by the first two terms of
    /// Cauchy's formula, as KHR_materials_dispersion has it.
    ///
    /// # Errors
    /// If the Abbe number or the index at a visible wavelength is not finite and above 0.
    pub fn from_abbe(ior: f64, abbe: f64) -> Result<Self, DispersionError> {
        if !(abbe > 0.0 && abbe.is_finite()) {
            return Err(DispersionError::Abbe(abbe));
        }
        let [f, d, c] = FRAUNHOFER_LINES.map(|line| 1.0 / (line * line));
        let b = (ior - 1.0) / (abbe * (f - c));
        Self::cauchy([ior - b * d, b, 0.0])
    }

    /// By the coefficients A, B (nm²) and C (nm⁴) of Cauchy's formula.
    ///
    /// # Errors
    /// If the index at a visible wavelength is not finite and above 0.
    pub fn cauchy(coefficients: [f64; 3]) -> Result<Self, DispersionError> {
        Self::Cauchy(coefficients).checked()
    }

    /// By the coefficients Bᵢ and Cᵢ (µm²) of Sellmeier's formula.
    ///
    /// # Errors
    /// If a resonance is visible, or the index at a visible wavelength is not finite and above 0.
    pub fn sellmeier(b: [f64; 3], c: [f64; 3]) -> Result<Self, DispersionError> {
        for (strength, squared) in b.into_iter().zip(c) {
            let nanometres = 1000.0 * squared.max(0.0).sqrt();
            if strength != 0.0 && (SHORTEST..=LONGEST).contains(&nanometres) {
                return Err(DispersionError::Resonance { c: squared, nanometres });
            }
        }
        Self::Sellmeier { b, c }.checked()
    }

    fn checked(self) -> Result<Self, DispersionError> {
        // Both formulas are smooth between resonances; a step of 1 nm sees where they cross 0.
        let range = 0..=(LONGEST - SHORTEST) as u32;
        for nanometres in range.map(|step| SHORTEST + f64::from(step)) {
            let ior = self.ior(nanometres);
            // In single precision, as it is rendered with.
            let single = ior as f32;
            if !(single > 0.0 && single.is_finite()) {
                return Err(DispersionError::Ior { ior, nanometres });
            }
        }
        Ok(self)
    }

    /// Index of refraction at a visible wavelength in nm.
    pub fn ior(&self, nanometres: f64) -> f64 {
        match self {
            Self::Cauchy([a, b, c]) => {
                let inverse = 1.0 / (nanometres * nanometres);
                a + (b + c * inverse) * inverse
            }
            Self::Sellmeier { b, c } => {
                let squared = (nanometres * 1e-3).powi(2);
                let terms = b.iter().zip(c).map(|(b, c)| b * squared / (squared - c));
                (1.0 + terms.sum::<f64>()).sqrt()
            }
        }
    }

    /// V = (n_d − 1)/(n_F − n_C): how little it disperses; infinite if not at all.
    pub fn abbe(&self) -> f64 {
        let [f, d, c] = FRAUNHOFER_LINES.map(|line| self.ior(line));
        (d - 1.0) / (f - c)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Schott N-BK7 (data sheet 517642.251).
    fn crown() -> Dispersion {
        let b = [1.039_612_12, 0.231_792_344, 1.010_469_45];
        let c = [0.006_000_698_67, 0.020_017_914_4, 103.560_653];
        Dispersion::sellmeier(b, c).unwrap()
    }

    #[test]
    fn sellmeier_gives_the_indices_of_the_data_sheet() {
        let published = [(486.1327, 1.52238), (587.5618, 1.51680), (656.2725, 1.51432)];
        for (nanometres, ior) in published {
            // To the five places there.
            assert!((crown().ior(nanometres) - ior).abs() < 6e-6, "{nanometres}");
        }
        assert!((crown().abbe() - 64.17).abs() < 5e-3, "{}", crown().abbe());
    }

    #[test]
    fn abbe_number_and_index_come_back() {
        for (ior, abbe) in [(1.5168, 64.17), (1.7, 30.0), (2.417, 55.3), (1.0, 40.0)] {
            let glass = Dispersion::from_abbe(ior, abbe).unwrap();
            assert!((glass.ior(FRAUNHOFER_LINES[1]) - ior).abs() < 4.0 * f64::EPSILON);
            if ior > 1.0 {
                // n_F − n_C is of order 10⁻², so that rounding in n is a hundred times as much of it.
                assert!((glass.abbe() / abbe - 1.0).abs() < 1e-12, "{}", glass.abbe());
            }
            // The formula that the extension quotes, in its own digits.
            for nanometres in [400.0, 500.0, 700.0] {
                let quoted = ior + (ior - 1.0) / abbe * (523_655.0 / (nanometres * nanometres) - 1.5168);
                assert!((glass.ior(nanometres) - quoted).abs() < 1e-5, "{nanometres}");
            }
        }
    }

    #[test]
    fn what_no_glass_has_is_refused() {
        for abbe in [0.0, -30.0, f64::NAN, f64::INFINITY] {
            let message = Dispersion::from_abbe(1.5, abbe).unwrap_err().to_string();
            assert!(message.contains("Abbe number"), "{message}");
        }
        assert!(matches!(Dispersion::from_abbe(-1.5, 30.0), Err(DispersionError::Ior { .. })));
        assert!(matches!(Dispersion::cauchy([f64::NAN, 0.0, 0.0]), Err(DispersionError::Ior { .. })));
        assert!(matches!(Dispersion::cauchy([1.5, -1e6, 0.0]), Err(DispersionError::Ior { .. })));
        let visible = Dispersion::sellmeier([1.0, 0.0, 0.0], [0.25, 0.0, 0.0]);
        assert_eq!(visible, Err(DispersionError::Resonance { c: 0.25, nanometres: 500.0 }));
    }
}
