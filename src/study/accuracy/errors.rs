//! Errors of pictures against a reference that is itself noisy, without bias by that noise.
//!
//! The reference r is the mean of two independent halves, each of several parts, whose spread gives the variance v of
//! the half. For a picture a that is independent of them, E[(a − r₁)² − v₁] = E[(a − truth)²]. In the same way the mean ā
//! of K runs with sample variance s² gives the bias alone, E[(ā − r₁)² − v₁ − s²/K] = (E a − truth)². relMSE divides by
//! r² + 0.01. Were that the same r, a half that is too dark by chance would also weigh more, and the mean would be off by the noise
//! after all; so each half is weighted by the other one: ½ Σ_h ((a − r_h)² − v_h)/(r²_(other) + 0.01), averaged over
//! pixels and channels.

use crate::film::{Picture, RELATIVE_ERROR_OFFSET};

/// Pixels that are looked at together.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Name for people.
    pub name: String,
    /// Index into the scene's materials; `None` for what is not one material.
    pub material: Option<usize>,
    /// Indices of its pixels, row-major from the top.
    pub pixels: Vec<usize>,
}

impl Region {
    /// Mean over the region's pixels and channels of a value by index of [`channels`].
    pub fn mean(&self, value: impl Fn(usize) -> f64) -> f64 {
        let sum: f64 = self.pixels.iter().map(|&p| value(3 * p) + value(3 * p + 1) + value(3 * p + 2)).sum();
        sum / (3 * self.pixels.len().max(1)) as f64
    }
}

/// The channels of a picture one after another, pixel by pixel.
pub fn channels(picture: &Picture) -> Vec<f64> {
    picture.pixels.iter().flat_map(|pixel| pixel.0.map(f64::from)).collect()
}

/// The picture whose [`channels`] these are.
pub fn picture(width: u32, height: u32, values: &[f64]) -> Picture {
    let pixel = |rgb: &[f64]| crate::radiometry::Rgb::new(rgb[0] as f32, rgb[1] as f32, rgb[2] as f32);
    Picture { width, height, pixels: values.chunks_exact(3).map(pixel).collect() }
}

/// Two independent halves of a reference.
#[derive(Clone, Debug)]
pub struct Reference {
    /// What the parts of each half have in common.
    halves: [Moments; 2],
    /// 1/(r² + 0.01) by each half.
    weights: [Vec<f64>; 2],
    /// Mean of both.
    pub mean: Vec<f64>,
    /// Mean of both weights.
    pub weight: Vec<f64>,
}

impl Reference {
    /// Of parts by channel, which belong to the halves in turns: at least two each.
    pub fn new(parts: &[Vec<f64>]) -> Self {
        let halves = [0, 1].map(|half| Moments::of(parts.iter().skip(half).step_by(2)));
        let weights = [0, 1].map(|half: usize| -> Vec<f64> {
            halves[half].mean.iter().map(|r| 1.0 / (r * r + RELATIVE_ERROR_OFFSET)).collect()
        });
        let of_both = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| 0.5 * (a + b)).collect();
        let mean = of_both(&halves[0].mean, &halves[1].mean);
        let weight = of_both(&weights[0], &weights[1]);
        Self { halves, weights, mean, weight }
    }

    /// Weighted square of what `value` is off, less the noise of the reference.
    fn square(&self, i: usize, value: f64) -> f64 {
        let of_half = |half: usize| {
            let Moments { mean, .. } = &self.halves[half];
            ((value - mean[i]).powi(2) - self.halves[half].variance_of_mean(i)) * self.weights[1 - half][i]
        };
        0.5 * (of_half(0) + of_half(1))
    }

    /// Estimate of the variance of the mean of both halves.
    pub fn variance(&self, i: usize) -> f64 {
        0.25 * (self.halves[0].variance_of_mean(i) + self.halves[1].variance_of_mean(i))
    }

    /// What noise of the reference would add to relMSE.
    pub fn noise(&self, region: &Region) -> f64 {
        region.mean(|i| self.variance(i) * self.weight[i])
    }

    /// relMSE of a picture against the truth.
    pub fn relmse(&self, values: &[f64], region: &Region) -> f64 {
        region.mean(|i| self.square(i, values[i]))
    }

    /// Squared relative bias of what `runs` are runs of.
    pub fn bias_squared(&self, runs: &Moments, region: &Region) -> f64 {
        region.mean(|i| self.square(i, runs.mean[i]) - runs.variance_of_mean(i) * self.weight[i])
    }

    /// Standard error of [`Self::bias_squared`] by the noise of the reference, which all candidates share.
    ///
    /// With bias b, noise variance n of ā and v of a half of P parts, (b + δ − δ_h)² − v_h varies with δ_h by
    /// 4 (b² + n) v + 2 v² P/(P − 1) if noise is normal; the square of the estimate of v is v² (P + 1)/(P − 1) on average.
    /// As r_h is also in the weight w of the other half, the slope by δ_h is larger by 1 + b r w.
    pub fn error_of_bias_squared(&self, runs: &Moments, region: &Region) -> f64 {
        let variance = region.mean(|i| {
            let noise = runs.variance_of_mean(i);
            let bias = self.square(i, runs.mean[i]) / self.weight[i] - noise;
            let slope = 1.0 + (runs.mean[i] - self.mean[i]) * self.mean[i] * self.weight[i];
            let of_half = |half: usize| {
                let (v, parts) = (self.halves[half].variance_of_mean(i), self.halves[half].runs as f64);
                let squares = 2.0 * v * v * parts / (parts + 1.0);
                (4.0 * (bias + noise) * v * slope * slope + squares) * self.weights[1 - half][i].powi(2)
            };
            0.25 * (of_half(0) + of_half(1))
        });
        (variance.max(0.0) / (3 * region.pixels.len().max(1)) as f64).sqrt()
    }

    /// relMSE that the noise of one run makes.
    pub fn noise_of_run(&self, runs: &Moments, region: &Region) -> f64 {
        region.mean(|i| runs.variance[i] * self.weight[i])
    }
}

/// Mean and variance of independent runs, by channel.
#[derive(Clone, Debug)]
pub struct Moments {
    /// How many.
    pub runs: usize,
    /// Their mean.
    pub mean: Vec<f64>,
    /// Unbiased variance of one run.
    pub variance: Vec<f64>,
}

impl Moments {
    /// Of the channels of at least two pictures.
    pub fn of<'a>(pictures: impl Iterator<Item = &'a Vec<f64>> + Clone) -> Self {
        let runs = pictures.clone().count();
        let length = pictures.clone().next().map_or(0, Vec::len);
        let (mut mean, mut variance) = (vec![0.0; length], vec![0.0; length]);
        for values in pictures.clone() {
            mean.iter_mut().zip(values).for_each(|(sum, value)| *sum += value / runs as f64);
        }
        for values in pictures {
            for ((sum, value), mean) in variance.iter_mut().zip(values).zip(&mean) {
                *sum += (value - mean).powi(2) / (runs.max(2) - 1) as f64;
            }
        }
        Self { runs, mean, variance }
    }

    /// Variance of the mean of all runs.
    pub fn variance_of_mean(&self, i: usize) -> f64 {
        self.variance[i] / self.runs as f64
    }
}

/// The squared relative difference of what `a` and `b` are runs of, and its standard error by their noise: with
/// difference d and noise variance n, d² − n varies by 4 d² n + 2 n².
pub fn squared_difference(
    a: &Moments,
    b: &Moments,
    weight: &[f64],
    region: &Region,
) -> crate::slab::Estimate {
    let noise = |i: usize| a.variance_of_mean(i) + b.variance_of_mean(i);
    let square = |i: usize| (a.mean[i] - b.mean[i]).powi(2) - noise(i);
    let variance =
        region.mean(|i| (4.0 * square(i).max(0.0) * noise(i) + 2.0 * noise(i).powi(2)) * weight[i].powi(2));
    crate::slab::Estimate {
        value: region.mean(|i| square(i) * weight[i]),
        standard_error: (variance / (3 * region.pixels.len().max(1)) as f64).sqrt(),
    }
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, Normal};
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::SeedableRng;

    use super::super::jackknife::jackknife;
    use super::*;

    const PIXELS: usize = 1500;

    fn everything() -> Region {
        Region { name: "all".into(), material: None, pixels: (0..PIXELS).collect() }
    }

    /// Truth between 0.2 and 1.2; bias and noise in proportion to it, so that relative errors are about equal.
    fn truth(i: usize) -> f64 {
        0.2 + i as f64 / (3 * PIXELS) as f64
    }

    struct Synthetic {
        reference: Reference,
        runs: Vec<Vec<f64>>,
    }

    /// A reference of eight parts.
    fn synthetic(bias: f64, noise: f64, noise_of_half: f64, seed: u64) -> Synthetic {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut values = |bias: f64, sigma: f64| -> Vec<f64> {
            let normal = Normal::new(1.0 + bias, sigma).unwrap();
            (0..3 * PIXELS).map(|i| truth(i) * normal.sample(&mut random)).collect()
        };
        let parts: Vec<Vec<f64>> = (0..8).map(|_| values(0.0, 2.0 * noise_of_half)).collect();
        let reference = Reference::new(&parts);
        Synthetic { reference, runs: (0..16).map(|_| values(bias, noise)).collect() }
    }

    fn exact(square: f64) -> f64 {
        let term = |i: usize| truth(i).powi(2) * square / (truth(i).powi(2) + RELATIVE_ERROR_OFFSET);
        (0..3 * PIXELS).map(term).sum::<f64>() / (3 * PIXELS) as f64
    }

    /// B² is found within 3σ of its own standard error (by the runs and by the reference), though the noise of the
    /// mean, of the reference, or both, is much larger than it. Noise in the weights adds what is of the order
    /// of the reference's relMSE, 0.01 of B².
    #[test]
    fn bias_is_told_from_noise() {
        for (seed, bias, noise, half) in [
            (1, 0.1, 0.5, 0.05),
            (2, 0.02, 0.3, 0.05),
            (3, 0.0, 0.3, 0.1),
            (4, -0.05, 1.0, 0.1),
            (5, 0.3, 0.1, 0.1),
        ] {
            let Synthetic { reference, runs } = synthetic(bias, noise, half, seed);
            let region = everything();
            let found = jackknife(16, |left_out| {
                let kept = runs.iter().enumerate().filter(|(k, _)| Some(*k) != left_out).map(|(_, run)| run);
                vec![reference.bias_squared(&Moments::of(kept), &region)]
            })[0];
            let moments = Moments::of(runs.iter());
            let sigma = found.standard_error.hypot(reference.error_of_bias_squared(&moments, &region));
            let expected = exact(bias * bias);
            let weights = 3.0 * half * half * expected;
            assert!(
                (found.value - expected).abs() < 3.0 * sigma + weights,
                "{seed}: {found:?} ± {sigma}, {expected}"
            );
            // The test would notice: noise alone is larger than what is allowed.
            assert!(
                seed == 5
                    || exact(half * half / 2.0) > 3.0 * sigma
                    || exact(noise * noise / 16.0) > 3.0 * sigma
            );
        }
    }

    /// The spread of B² over 100 references is what is stated for one, within 3/√(2·99) of itself. Noise of 5 % in the weights
    /// changes it by second order.
    #[test]
    fn the_noise_of_the_reference_is_in_the_error() {
        let region = everything();
        let (mut values, mut stated) = (Vec::new(), 0.0);
        for seed in 0..100 {
            // Runs without noise: all the spread is the reference's.
            let Synthetic { reference, runs } = synthetic(0.1, 0.0, 0.05, 100 + seed);
            let moments = Moments::of(runs.iter());
            values.push(reference.bias_squared(&moments, &region));
            stated += reference.error_of_bias_squared(&moments, &region) / 100.0;
        }
        let mean = values.iter().sum::<f64>() / 100.0;
        let spread = (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 99.0).sqrt();
        assert!((spread / stated - 1.0).abs() < 3.0 / (2.0_f64 * 99.0).sqrt(), "{spread} {stated}");
    }

    /// relMSE is bias² and noise together; the noise of a reference is seen in its halves. Means of squares of
    /// 4500 normal numbers are uncertain by √(2/4500) = 2 %.
    #[test]
    fn noise_is_measured() {
        let Synthetic { reference, runs } = synthetic(0.1, 0.2, 0.05, 7);
        let region = everything();
        let close = |found: f64, expected: f64| (found / expected - 1.0).abs() < 0.063;
        assert!(close(reference.noise(&region), exact(0.05 * 0.05 / 2.0)));
        assert!(close(reference.noise_of_run(&Moments::of(runs.iter()), &region), exact(0.04)));
        assert!(close(reference.relmse(&runs[0], &region), exact(0.01 + 0.04)));
    }

    /// Within 3σ as stated.
    #[test]
    fn differences_of_candidates_are_told_from_noise() {
        let (a, b) = (synthetic(0.1, 0.2, 0.01, 8), synthetic(0.0, 0.3, 0.01, 9));
        let (a, b) = (Moments::of(a.runs.iter()), Moments::of(b.runs.iter()));
        let weight: Vec<f64> =
            (0..3 * PIXELS).map(|i| 1.0 / (truth(i).powi(2) + RELATIVE_ERROR_OFFSET)).collect();
        let found = squared_difference(&a, &b, &weight, &everything());
        assert!((found.value - exact(0.01)).abs() < 3.0 * found.standard_error, "{found:?}");
        assert!(found.standard_error < 0.1 * found.value);
    }

    #[test]
    fn pictures_survive_the_way_through_channels() {
        let pixels = (0..6).map(|i| crate::radiometry::Rgb::splat(i as f32 * 0.1)).collect();
        let whole = Picture { width: 3, height: 2, pixels };
        assert_eq!(picture(3, 2, &channels(&whole)), whole);
    }
}
