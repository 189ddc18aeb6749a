//! The zero-variance random walk out of a half-space: the eigenvalue of diffusion and the densities that it gives.
//!
//! Deep inside a half-space that scatters isotropically with albedo ω, what light brings out falls off as
//! e^(−z/ν0) with optical depth z and goes with direction as 1/(ν0 − µ), where µ is the cosine to the outward normal and ν0 ≥ 1 the
//! discrete eigenvalue of the transport equation, ω ν0 artanh(1/ν0) = 1 (Case & Zweifel 1967, "Linear Transport Theory").
//! A walk whose every choice is in proportion to what light brings out from there on has no variance; with this
//! asymptotic form (Dwivedi 1982, "A new importance biasing scheme for deep-penetration Monte Carlo") it draws
//!
//! - the direction with p(µ) = 1/((ν0 − µ) ln((ν0 + 1)/(ν0 − 1))), the azimuth uniformly;
//! - the flight with the stretched coefficient σ_t (1 − µ/ν0).
//!
//! Křivánek & d'Eon 2014, "A Zero-variance-based Sampling Scheme for Monte Carlo Subsurface Scattering", brought it to rendering; Meng,
//! Hanika & Dachsbacher 2016, "Improving the Dwivedi Sampling Scheme", turn the normal to where light may leave.
//!
//! The eigenvalue is taken from Křivánek & d'Eon's fit, 1/ν0² ≈ 1 − s with s = ω^(2.44294 − 0.0215813 ω + 0.578637/ω), right to
//! 10⁻⁴. The densities are exact for the ν0 so found, whatever it is. In terms of s they need no difference of numbers that are alike:
//! 1 − 1/ν0 = s/(1 + 1/ν0).

use std::f32::consts::TAU;

/// Albedos that modes are made for. Light in darker media leaves from so near the surface that the form of great depth, which looks
/// straight out, is worse than that of a brighter one; in brighter ones single precision no longer resolves that directions differ.
const ALBEDOS: [f64; 2] = [0.7, 0.9999];

/// What light brings out of the depth of a medium of one albedo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    /// 1/ν0: the rate of decay in free paths.
    decay: f32,
    /// 1 − 1/ν0.
    rest: f32,
    /// ln((ν0 + 1)/(ν0 − 1)).
    range: f32,
}

impl Mode {
    /// Of single-scattering `albedo`; outside of [0.7, 0.9999] that of the nearer end.
    pub fn new(albedo: f64) -> Self {
        // What is no number is not greater.
        let albedo = if albedo > ALBEDOS[0] { albedo.min(ALBEDOS[1]) } else { ALBEDOS[0] };
        let s = albedo.powf(2.442_94 - 0.021_581_3 * albedo + 0.578_637 / albedo);
        let decay = (1.0 - s).sqrt();
        let rest = s / (1.0 + decay);
        Self { decay: decay as f32, rest: rest as f32, range: ((1.0 + decay) / rest).ln() as f32 }
    }

    /// 1/ν0, in units of the extinction coefficient.
    pub fn decay(&self) -> f32 {
        self.decay
    }

    /// 1 − µ/ν0 for a direction of cosine µ to the outward normal: the coefficient of flights relative to σ_t, and the inverse of what
    /// light in this direction brings out, up to a factor.
    pub fn stretch(&self, cosine: f32) -> f32 {
        self.rest + self.decay * (1.0 - cosine).max(0.0)
    }

    /// Density per solid angle, 1/sr, of a direction of cosine µ to the outward normal.
    pub fn density(&self, cosine: f32) -> f32 {
        self.decay / (TAU * self.range * self.stretch(cosine))
    }

    /// The cosine below which the share `xi` of the directions is.
    pub fn sample(&self, xi: f32) -> f32 {
        // 1 − µ = (ν0 + 1) (e^(−rξ) − e^(−r)), r the range.
        let below_one = (1.0 + self.decay) / self.decay * ((-self.range * xi).exp() - (-self.range).exp());
        (1.0 - below_one).clamp(-1.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::quadrature::GaussLegendre;
    use crate::math::sampler::HashGenerator;
    use std::f64::consts::TAU;

    const TESTED: [f64; 6] = [0.7, 0.8, 0.9, 0.99, 0.999, 0.9999];

    #[test]
    fn the_eigenvalue_solves_its_equation() {
        for albedo in TESTED {
            let decay = f64::from(Mode::new(albedo).decay());
            // d/dν (ν artanh(1/ν)) = artanh(1/ν) − ν/(ν² − 1): what the fit's 10⁻⁴ do to the equation.
            let slope = (decay / (1.0 - decay * decay) - decay.atanh()) / decay;
            let left = albedo * decay.atanh() / decay;
            assert!((left - 1.0).abs() < 1e-4 * albedo * slope + 1e-6, "{albedo}: {left}");
        }
        // Case & Zweifel 1967: diffusion without absorption, 1/ν0² → 3(1 − ω)(1 − 2(1 − ω)/5…).
        let decay = f64::from(Mode::new(0.9999).decay());
        assert!((decay * decay / 3e-4 - 1.0).abs() < 1e-4, "{decay}");
        for (albedo, end) in [(-1.0, 0.7), (0.01, 0.7), (f64::NAN, 0.7), (1.0, 0.9999), (2.0, 0.9999)] {
            assert_eq!(Mode::new(albedo), Mode::new(end));
        }
    }

    #[test]
    fn densities_integrate_to_one() {
        let rule = GaussLegendre::new(400);
        for albedo in TESTED {
            let mode = Mode::new(albedo);
            let whole = rule.integrate(-1.0, 1.0, |mu| TAU * f64::from(mode.density(mu as f32)));
            // Roundings of single precision, those of 1 − µ at its peak 1/(1 − 1/ν0) times.
            assert!((whole - 1.0).abs() < 1e-5, "ω {albedo}: {whole}");
        }
    }

    /// The largest distance of an empirical distribution from `cumulative`, times the root of the count: beyond 1.95
    /// in one of a thousand cases (Kolmogorov).
    fn kolmogorov(mut draws: Vec<f64>, cumulative: impl Fn(f64) -> f64) -> f64 {
        draws.sort_by(f64::total_cmp);
        let count = draws.len() as f64;
        let distance = |(i, &x): (usize, &f64)| {
            let below = cumulative(x);
            (below - i as f64 / count).abs().max(((i + 1) as f64 / count - below).abs())
        };
        draws.iter().enumerate().map(distance).fold(0.0, f64::max) * count.sqrt()
    }

    #[test]
    fn samples_follow_their_densities() {
        let rule = GaussLegendre::new(60);
        let mut random = HashGenerator::new(7);
        for albedo in TESTED {
            let mode = Mode::new(albedo);
            let draws = (0..20_000).map(|_| f64::from(mode.sample(random.next_f32()))).collect();
            let statistic =
                kolmogorov(draws, |x| rule.integrate(-1.0, x, |mu| TAU * f64::from(mode.density(mu as f32))));
            assert!(statistic < 1.95, "ω {albedo}: {statistic}");
        }
    }
}
