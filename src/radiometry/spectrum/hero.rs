//! Hero wavelengths: a path that follows one wavelength and carries others along.
//!
//! One wavelength is drawn; the others stand at equal steps from it, around and around the visible range, so that
//! each is distributed as the first and together they leave no colour out (Wilkie, Nawaz, Droske, Weidlich and Hanika 2014, "Hero Wavelength
//! Spectral Sampling"). What a path does is decided by what all of them carry, or, where light is bent and they would part, by the first, the hero.

use std::sync::LazyLock;

use glam::DVec3;

use super::observer::{LUMINANCE_INTEGRAL, color_matching};
use super::{LONGEST, Rgb, SHORTEST, Spectrum};
use crate::radiometry::color::XYZ_TO_RGB;

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

/// tanh of the scaled wavelength at either end of the visible range: the integral of [`Distribution::Visible`] goes from one to the other.
static ENDS: LazyLock<[f64; 2]> =
    LazyLock::new(|| [SHORTEST, LONGEST].map(|nanometres| (INVERSE_WIDTH * (nanometres - MIDDLE)).tanh()));

impl Distribution {
    /// The wavelength (nm) that has the share `u` in [0, 1) of the others below it, and the density there, 1/nm.
    pub fn wavelength(self, u: f64) -> (f64, f64) {
        match self {
            Self::Uniform => (SHORTEST + u * (LONGEST - SHORTEST), 1.0 / (LONGEST - SHORTEST)),
            Self::Visible => {
                let [low, high] = *ENDS;
                let tanh = low + u * (high - low);
                // The inverse of tanh, faster than that of the library and as exact where nothing cancels.
                let inverse = 0.5 * ((1.0 + tanh) / (1.0 - tanh)).ln();
                let nanometres = (MIDDLE + inverse / INVERSE_WIDTH).clamp(SHORTEST, LONGEST);
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

    /// Linear Rec.709 of what a path brings, not clipped: an estimate of a colour that the film shows may be negative in a channel.
    pub fn rgb(&self, radiance: [f32; CARRIED]) -> Rgb {
        let xyz = self.xyz(radiance).map(f64::from);
        Spectrum((*XYZ_TO_RGB * DVec3::from(xyz)).as_vec3().to_array())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::quadrature::GaussLegendre;
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
}
