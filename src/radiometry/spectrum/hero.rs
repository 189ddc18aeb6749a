//! Hero wavelengths: a path that follows one wavelength and carries others along.
//!
//! One wavelength is drawn; the others stand at equal steps from it, around and around the visible range, so that
//! each is distributed as the first and together they leave no colour out. Directions are drawn for the first, the
//! hero. The path is then one that each of the others could have drawn, and the balance heuristic over all
//! of them weights it (Wilkie, Nawaz, Droske, Weidlich and Hanika 2014, "Hero Wavelength Spectral Sampling").

use super::observer::{LUMINANCE_INTEGRAL, color_matching};
use super::{LONGEST, SHORTEST};

/// Wavelengths that a path carries.
pub const CARRIED: usize = 4;

/// The wavelengths of a path, nm; the first is the hero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeroWavelengths {
    /// The wavelengths, nm.
    pub nanometres: [f32; CARRIED],
    /// Density of each, 1/nm.
    pub density: [f32; CARRIED],
}

/// How wavelengths are distributed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distribution {
    /// Uniformly over the visible range.
    Uniform,
    /// By about what the eye sees of them: in proportion to sech²(0.0072 (λ − 538 nm)) (Radziszewski, Boryczko and Alda 2009,
    /// "An Improved Technique for Full Spectral Rendering").
    Visible,
}

/// Middle of [`Distribution::Visible`], nm, and its inverse width, 1/nm.
const MIDDLE: f64 = 538.0;
const INVERSE_WIDTH: f64 = 0.0072;

impl Distribution {
    /// The wavelength (nm) that has the share `u` in [0, 1) of the others below it, and the density there, 1/nm.
    pub fn wavelength(self, u: f64) -> (f64, f64) {
        match self {
            Self::Uniform => (SHORTEST + u * (LONGEST - SHORTEST), 1.0 / (LONGEST - SHORTEST)),
            Self::Visible => {
                let primitive = |nanometres: f64| (INVERSE_WIDTH * (nanometres - MIDDLE)).tanh();
                let (low, high) = (primitive(SHORTEST), primitive(LONGEST));
                let tanh = low + u * (high - low);
                let nanometres = (MIDDLE + tanh.atanh() / INVERSE_WIDTH).clamp(SHORTEST, LONGEST);
                // sech² = 1 − tanh².
                (nanometres, INVERSE_WIDTH * (1.0 - tanh) * (1.0 + tanh) / (high - low))
            }
        }
    }
}

impl HeroWavelengths {
    /// The wavelengths for the number `u` in [0, 1).
    pub fn sample(distribution: Distribution, u: f32) -> Self {
        let mut sampled = Self { nanometres: [0.0; CARRIED], density: [0.0; CARRIED] };
        for i in 0..CARRIED {
            let rotated = (f64::from(u) + i as f64 / CARRIED as f64).fract();
            let (nanometres, density) = distribution.wavelength(rotated);
            (sampled.nanometres[i], sampled.density[i]) = (nanometres as f32, density as f32);
        }
        sampled
    }

    /// Weight by the balance heuristic of what a path carries, at every wavelength alike, if it was drawn by the hero and what it
    /// carries is divided by the hero's density: that density over the mean of all. `densities` are those with which
    /// each wavelength would have drawn the path. 1 where no decision on the path depended on the wavelength.
    pub fn weight(densities: [f32; CARRIED]) -> f32 {
        let mean = densities.iter().sum::<f32>() / CARRIED as f32;
        if mean > 0.0 { densities[0] / mean } else { 0.0 }
    }

    /// X, Y, Z of what a path brings, `radiance` by wavelength in W/(m² sr nm): an unbiased estimate of that of all wavelengths, on
    /// the scale on which constant 1 has Y = 1.
    pub fn xyz(&self, radiance: [f32; CARRIED]) -> [f32; 3] {
        let mut sum = [0.0; 3];
        for ((nanometres, density), radiance) in self.nanometres.into_iter().zip(self.density).zip(radiance) {
            let scale = CARRIED as f64 * f64::from(density) * LUMINANCE_INTEGRAL;
            for (sum, matching) in sum.iter_mut().zip(color_matching(nanometres.into())) {
                *sum += matching * f64::from(radiance) / scale;
            }
        }
        sum.map(|component| component as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::quadrature::GaussLegendre;
    use crate::math::sampler::HashGenerator;
    use crate::radiometry::Wavelength;
    use crate::radiometry::spectrum::blackbody::Blackbody;
    use crate::radiometry::spectrum::observer;

    const BOTH: [Distribution; 2] = [Distribution::Uniform, Distribution::Visible];

    #[test]
    fn the_density_is_the_slope_of_the_distribution() {
        for distribution in BOTH {
            assert!((distribution.wavelength(0.0).0 - SHORTEST).abs() < 1e-9);
            assert!((distribution.wavelength(1.0).0 - LONGEST).abs() < 1e-9);
            for i in 1..100 {
                let (u, h) = (f64::from(i) / 100.0, 1e-6);
                let slope = (distribution.wavelength(u + h).0 - distribution.wavelength(u - h).0) / (2.0 * h);
                let product = slope * distribution.wavelength(u).1;
                // Central difference: h² times a third derivative of at most 10³ times the slope.
                assert!((product - 1.0).abs() < 1e-8, "{distribution:?} {u}: {product}");
            }
        }
    }

    #[test]
    fn four_wavelengths_stand_at_equal_steps() {
        let sampled = HeroWavelengths::sample(Distribution::Uniform, 0.6);
        let step = (LONGEST - SHORTEST) as f32 / 4.0;
        let mut sorted = sampled.nanometres;
        sorted.sort_by(f32::total_cmp);
        for pair in sorted.windows(2) {
            assert!((pair[1] - pair[0] - step).abs() < 1e-3, "{sorted:?}");
        }
        assert!((sampled.nanometres[0] - 642.0).abs() < 1e-3);
    }

    /// The mean over all draws is the integral, by whichever distribution.
    #[test]
    fn the_estimate_of_a_color_has_no_bias() {
        let lamp = Blackbody::new(2856.0).unwrap();
        let radiance = |nanometres: f64| {
            1e-3 * lamp.spectral_radiance(Wavelength::from_nanometres(nanometres).unwrap()).0
        };
        let expected = observer::xyz(radiance);
        let rule = GaussLegendre::new(8);
        for distribution in BOTH {
            let (mut mean, panels) = ([0.0; 3], 2000);
            for panel in 0..panels {
                for &(x, weight) in rule.nodes() {
                    let u = (f64::from(panel) + x) / f64::from(panels);
                    let sampled = HeroWavelengths::sample(distribution, u as f32);
                    let got = sampled.xyz(sampled.nanometres.map(|w| radiance(f64::from(w)) as f32));
                    for (mean, got) in mean.iter_mut().zip(got) {
                        *mean += weight * f64::from(got) / f64::from(panels);
                    }
                }
            }
            for (got, expected) in mean.into_iter().zip(expected) {
                // The reference is the trapezoidal rule in steps of 1 nm; here wavelengths have 24 bits.
                assert!((got / expected - 1.0).abs() < 1e-5, "{distribution:?}: {got} {expected}");
            }
        }
    }

    /// A filter that lets one wavelength of a path through with a probability that is its transmittance T(λ): drawn by the hero, the
    /// weighted mean is ∫ T f for every wavelength, and no weight exceeds their number.
    #[test]
    fn decisions_by_the_hero_leave_no_bias() {
        let transmittance = |w: f32| 0.02 + 0.98 * (-((w - 600.0) / 40.0).powi(2)).exp();
        let mut random = HashGenerator::new(3);
        let (mut sum, mut squares, draws) = (0.0_f64, 0.0_f64, 400_000);
        for _ in 0..draws {
            let sampled = HeroWavelengths::sample(Distribution::Uniform, random.next_f32());
            let densities = sampled.nanometres.map(transmittance);
            let mut value = 0.0;
            if random.next_f32() < densities[0] {
                let weight = HeroWavelengths::weight(densities);
                assert!(weight <= CARRIED as f32);
                // What each wavelength carries, T(λ)·1, over the density of the decision.
                value = f64::from(sampled.xyz(densities.map(|t| t / densities[0] * weight))[1]);
            }
            sum += value;
            squares += value * value;
        }
        let mean = sum / f64::from(draws);
        let sigma = ((squares / f64::from(draws) - mean * mean) / f64::from(draws)).sqrt();
        let expected = observer::xyz(|w| f64::from(transmittance(w as f32)))[1];
        assert!((mean - expected).abs() < 3.0 * sigma, "{mean} {expected} {sigma}");
        // Fine enough to see that a decision was weighted wrongly, which is a factor.
        assert!(sigma < 1e-2 * expected, "{sigma}");
    }
}
