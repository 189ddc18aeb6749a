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
//! **Digits.** With t = artanh(1/ν0) the eigenvalue solves t/tanh t = 1/ω, and 1/ν0 = tanh t, ln((ν0 + 1)/(ν0 − 1)) = 2t,
//! 1 − 1/ν0 = 2/(e^(2t) + 1): none of them subtracts numbers that are alike.
//!
//! **Anisotropic scattering.** The deflection θ is left to the phase function; its azimuth is drawn in proportion to what
//! light brings out, 1/(ν0 − µ'), where µ' = cosθ µ + sinθ √(1 − µ²) cosφ. That is a density of the form
//! √(a² − b²)/(2π (a − b cosφ)), whose integral is elementary.

use std::f32::consts::TAU;

/// Albedos that modes are made for. Darker media's would look straight out only, and be of no use to light that scatters once;
/// of brighter ones single precision would no longer resolve that directions differ.
const ALBEDOS: [f64; 2] = [0.3, 0.9999];

/// Steps of Newton's method: from its start, below the root, it passes the root once, by little, and then doubles its digits.
const STEPS: usize = 8;

/// What light brings out of the depth of a medium of one albedo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    /// 1/ν0 = tanh t: the rate of decay in free paths.
    decay: f32,
    /// 1 − 1/ν0.
    rest: f32,
    /// 2t.
    range: f32,
}

impl Mode {
    /// Of single-scattering `albedo`; outside of [0.3, 0.9999] that of the nearer end.
    pub fn new(albedo: f64) -> Self {
        let t = eigenvalue(albedo.max(ALBEDOS[0]).min(ALBEDOS[1]));
        Self { decay: t.tanh() as f32, rest: (2.0 / ((2.0 * t).exp() + 1.0)) as f32, range: (2.0 * t) as f32 }
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
        // 1 − µ = (ν0 + 1) (e^(−2tξ) − e^(−2t)).
        let below_one = (1.0 + self.decay) / self.decay * ((-self.range * xi).exp() - (-self.range).exp());
        (1.0 - below_one).clamp(-1.0, 1.0)
    }

    /// Density of the azimuth of a deflection relative to a uniform one. Cosines: of the deflection, and to the outward normal
    /// before and after.
    pub fn azimuth_density(&self, deflection: f32, before: f32, after: f32) -> f32 {
        let [least, most] = self.stretches(deflection, before);
        (least * most).sqrt() / self.stretch(after)
    }

    /// Cosine and sine of an azimuth of a deflection around the direction before, 0 towards the outward normal.
    pub fn sample_azimuth(&self, deflection: f32, before: f32, xi: f32) -> [f32; 2] {
        let [least, most] = self.stretches(deflection, before);
        // tan(φ/2) = √((a − b)/(a + b)) tan(ψ/2), ψ uniform, without the tangent's pole.
        let (sin, cos) = (std::f32::consts::PI * (xi - 0.5)).sin_cos();
        let (y2, x2) = (least * sin * sin, most * cos * cos);
        let scale = 1.0 / (x2 + y2);
        [(x2 - y2) * scale, 2.0 * (least * most).sqrt() * sin * cos * scale]
    }

    /// The least and largest 1 − µ'/ν0 over all azimuths, (a ∓ b)/ν0.
    fn stretches(&self, deflection: f32, before: f32) -> [f32; 2] {
        let sines = ((1.0 - deflection * deflection) * (1.0 - before * before)).max(0.0).sqrt();
        let cosines = deflection * before;
        [self.stretch(cosines + sines), self.stretch(cosines - sines)]
    }
}

/// t = artanh(1/ν0), the root of t/tanh t = 1/`albedo`, which is in (0, 1).
fn eigenvalue(albedo: f64) -> f64 {
    let inverse = 1.0 / albedo;
    // Below the root, as t/tanh t < 1 + t²/3.
    let mut t = (3.0 * (1.0 - albedo) * inverse).sqrt().min(inverse);
    for _ in 0..STEPS {
        let (sinh, tanh) = (t.sinh(), t.tanh());
        t -= (t / tanh - inverse) / (1.0 / tanh - t / (sinh * sinh));
    }
    t
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::quadrature::GaussLegendre;
    use crate::math::sampler::HashGenerator;
    use std::f64::consts::{PI, TAU};

    const TESTED: [f64; 7] = [0.3, 0.5, 0.8, 0.9, 0.99, 0.999, 0.9999];

    #[test]
    fn the_eigenvalue_solves_its_equation() {
        for albedo in [0.01, 0.1].into_iter().chain(TESTED).chain([1.0 - 1e-6]) {
            let t = eigenvalue(albedo);
            // t/tanh t − 1 ≈ t²/3 loses the digits of 1 twice.
            assert!((albedo * t / t.tanh() - 1.0).abs() < 4.0 * f64::EPSILON, "{albedo}: {t}");
        }
        for albedo in [0.5, 0.9, 0.99] {
            let nu = 1.0 / f64::from(Mode::new(albedo).decay());
            // In the form of the textbooks, with the digits of single precision, which artanh loses 1/(ν0 − 1) times.
            let left = albedo * nu * (1.0 / nu).atanh();
            assert!((left - 1.0).abs() < 2e-7 * nu / (nu - 1.0), "{albedo}: {left}");
        }
        // Case & Zweifel 1967: diffusion without absorption, 1/ν0² → 3(1 − ω)(1 − 2(1 − ω)/5…).
        let decay = f64::from(Mode::new(0.9999).decay());
        assert!((decay * decay / 3e-4 - 1.0).abs() < 1e-4, "{decay}");
        for (albedo, end) in [(-1.0, 0.3), (0.01, 0.3), (f64::NAN, 0.3), (1.0, 0.9999), (2.0, 0.9999)] {
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
            for (deflection, before) in [(0.9, 0.3), (-0.2, -0.99), (0.5, 0.866)] {
                let whole = rule.integrate(0.0, PI, |phi| {
                    let after = after(deflection, before, phi.cos());
                    f64::from(mode.azimuth_density(deflection as f32, before as f32, after as f32)) / PI
                });
                assert!((whole - 1.0).abs() < 1e-5, "ω {albedo} at {deflection} {before}: {whole}");
            }
        }
    }

    fn after(deflection: f64, before: f64, azimuth: f64) -> f64 {
        deflection * before + ((1.0 - deflection * deflection) * (1.0 - before * before)).sqrt() * azimuth
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
            let (deflection, before) = (0.7_f64, -0.4_f64);
            let (mut draws, mut above) = (Vec::new(), 0_u32);
            for _ in 0..20_000 {
                let [cos, sin] =
                    mode.sample_azimuth(deflection as f32, before as f32, random.next_f32()).map(f64::from);
                assert!((cos * cos + sin * sin - 1.0).abs() < 1e-6);
                above += u32::from(sin > 0.0);
                draws.push(cos.clamp(-1.0, 1.0).acos());
            }
            let statistic = kolmogorov(draws, |x| {
                rule.integrate(0.0, x, |phi| {
                    let after = after(deflection, before, phi.cos());
                    f64::from(mode.azimuth_density(deflection as f32, before as f32, after as f32)) / PI
                })
            });
            assert!(statistic < 1.95, "ω {albedo}: azimuth {statistic}");
            // Both sides alike: 4σ.
            assert!((f64::from(above) - 10_000.0).abs() < 4.0 * 5000.0_f64.sqrt());
        }
    }
}
