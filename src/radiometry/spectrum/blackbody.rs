//! Thermal emission: Planck's law.

use thiserror::Error;

use crate::radiometry::photon::{BOLTZMANN, NANOMETRE, PLANCK, SPEED_OF_LIGHT, Wavelength};
use crate::radiometry::quantity::SpectralRadiance;

/// A body that absorbs all light, by its temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blackbody {
    /// hc/(kT), m.
    exponent: f64,
}

/// No body has such a temperature.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error("a temperature of {kelvin} K; it must be finite and above 0")]
pub struct TemperatureError {
    /// What was given.
    pub kelvin: f64,
}

impl Blackbody {
    /// The body of a temperature in K.
    ///
    /// # Errors
    /// If it is not finite and above 0.
    pub fn new(kelvin: f64) -> Result<Self, TemperatureError> {
        if kelvin > 0.0 && kelvin.is_finite() {
            Ok(Self::with_exponent(PLANCK * SPEED_OF_LIGHT / (BOLTZMANN * kelvin)))
        } else {
            Err(TemperatureError { kelvin })
        }
    }

    /// The body of hc/(kT) = `exponent`, m.
    pub(super) fn with_exponent(exponent: f64) -> Self {
        Self { exponent }
    }

    /// Radiance that it emits in vacuum, L_λ = 2hc²/λ⁵ / (e^{hc/(λkT)} − 1) (Planck 1901).
    pub fn spectral_radiance(&self, wavelength: Wavelength) -> SpectralRadiance {
        let per_metre = 2.0 * PLANCK * SPEED_OF_LIGHT.powi(2) * self.shape(wavelength.nanometres());
        SpectralRadiance(per_metre * NANOMETRE)
    }

    /// 1/λ⁵ / (e^{hc/(λkT)} − 1), 1/m⁵.
    pub(super) fn shape(&self, nanometres: f64) -> f64 {
        let metres = nanometres * NANOMETRE;
        1.0 / (metres.powi(5) * (self.exponent / metres).exp_m1())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::quadrature::GaussLegendre;
    use crate::radiometry::spectrum::observer::{chromaticity, xyz};
    use std::f64::consts::PI;

    fn radiance(kelvin: f64, nanometres: f64) -> f64 {
        let wavelength = Wavelength::from_nanometres(nanometres).unwrap();
        Blackbody::new(kelvin).unwrap().spectral_radiance(wavelength).0
    }

    #[test]
    fn radiance_is_planck_s() {
        // W/(m² sr m), by the exact constants of the SI in 30 digits.
        let rows = [
            (2856.0, 450.0, 88_707_305_612.010_07),
            (2856.0, 650.0, 442_190_083_357.283_6),
            (5000.0, 550.0, 12_713_014_681_424.332),
            (6504.0, 450.0, 47_656_746_755_161.93),
            (6504.0, 650.0, 35_319_976_877_232.6),
        ];
        for (kelvin, nanometres, expected) in rows {
            let got = radiance(kelvin, nanometres) * 1e9;
            // A relative rounding in the exponent of up to 12 is as much of the value, twelve times.
            assert!((got / expected - 1.0).abs() < 32.0 * f64::EPSILON, "{kelvin} {nanometres}: {got}");
        }
    }

    /// All of it is σT⁴/π, and the peak is at b/T.
    #[test]
    fn stefan_boltzmann_and_wien_follow() {
        let kelvin = 3000.0;
        let rule = GaussLegendre::new(64);
        // Over ln λ from 100 nm to 1 mm; what is left out is below 10⁻⁷ of it (Rayleigh–Jeans tail).
        let (from, to) = (100.0_f64.ln(), 1e6_f64.ln());
        let steps = 32;
        let total: f64 = (0..steps)
            .map(|i| {
                let at = |i: usize| from + (to - from) * i as f64 / steps as f64;
                rule.integrate(at(i), at(i + 1), |log| log.exp() * radiance(kelvin, log.exp()))
            })
            .sum();
        let expected = 5.670_374_419_184_431e-8 * kelvin.powi(4) / PI;
        assert!((total / expected - 1.0).abs() < 2e-7, "{total} {expected}");
        let peak = 2_897_771.955 / kelvin;
        assert!(radiance(kelvin, peak) > radiance(kelvin, 0.999 * peak));
        assert!(radiance(kelvin, peak) > radiance(kelvin, 1.001 * peak));
    }

    #[test]
    fn chromaticities_are_the_published_ones() {
        // The Planckian locus (Wyszecki and Stiles 1982, table 1(3.11)).
        let published = [
            (1000.0, [0.6527, 0.3445]),
            (2000.0, [0.5267, 0.4133]),
            (2856.0, [0.4476, 0.4074]),
            (4000.0, [0.3804, 0.3767]),
            (5000.0, [0.3451, 0.3516]),
            (6500.0, [0.3135, 0.3236]),
            (10_000.0, [0.2806, 0.2883]),
        ];
        for (kelvin, [x, y]) in published {
            let [got_x, got_y] = chromaticity(xyz(|nanometres| radiance(kelvin, nanometres)));
            assert!((got_x - x).abs() < 1e-3 && (got_y - y).abs() < 1e-3, "{kelvin}: {got_x} {got_y}");
        }
    }

    #[test]
    fn what_is_no_temperature_is_refused() {
        for kelvin in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let message = Blackbody::new(kelvin).unwrap_err().to_string();
            assert!(message.contains("above 0"), "{message}");
        }
        // So cold that nothing is visible: 0, not NaN.
        assert_eq!(radiance(1.0, 400.0), 0.0);
    }
}
