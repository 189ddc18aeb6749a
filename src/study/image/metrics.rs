//! Errors between two pictures of one size.

use thiserror::Error;

use crate::film::{Picture, RELATIVE_ERROR_OFFSET};
use crate::radiometry::Rgb;

/// Offset in the denominator of MAPE, W/(m² sr): pixels darker than it count by their absolute error.
pub const MAPE_OFFSET: f64 = 0.01;

/// The normal distribution holds 95 % within so many σ of its mean.
pub const SIGMAS_OF_95_PERCENT: f64 = 1.959_964;

/// A picture, and what is known of its noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Radiance.
    pub picture: Picture,
    /// Variance of the mean by pixel and channel, (W/(m² sr))²; infinite where it is unknown.
    pub variance: Option<Vec<Rgb>>,
}

/// Why there is no comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum NothingToCompare {
    /// The pictures are of two sizes.
    #[error("the pictures are of two sizes, {a:?} and {b:?} pixels")]
    Size {
        /// Width and height of A.
        a: (u32, u32),
        /// Width and height of B.
        b: (u32, u32),
    },
    /// No pixel is left.
    #[error("no pixel is finite in both pictures: {a} of {pixels} are not in the first, {b} in the second")]
    NonFinite {
        /// Pixels in each.
        pixels: u64,
        /// Pixels of A that are not finite.
        a: u64,
        /// Pixels of B that are not finite.
        b: u64,
    },
}

/// How A differs from B. Radiance is in W/(m² sr); channels are red, green and blue.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Pixels compared: those finite in both.
    pub pixels: u64,
    /// Pixels of A with a channel that is not finite.
    pub nonfinite_a: u64,
    /// Pixels of B with a channel that is not finite.
    pub nonfinite_b: u64,
    /// Mean of (a − b)² over pixels and channels.
    pub mse: f64,
    /// Mean of (a − b)²/(b² + 0.01) over pixels and channels.
    pub relmse: f64,
    /// Mean of |a − b|/(|b| + 0.01) over pixels and channels.
    pub mape: f64,
    /// What `relmse` would be, in expectation, of two pictures whose truth is the same: the mean of
    /// (Var a + Var b)/(b² + 0.01). A picture without variance counts as exact; `None` if neither has any.
    pub relmse_of_noise: Option<f64>,
    /// Mean of A.
    pub mean_a: [ChannelMean; 3],
    /// Mean of B.
    pub mean_b: [ChannelMean; 3],
    /// Mean of A − B. Its error takes the noise of A and of B for independent, as that of two seeds is; a
    /// picture without variance counts as exact.
    pub bias: [ChannelMean; 3],
    /// Where a channel of A is farthest from B.
    pub largest: LargestDifference,
}

/// A mean over the pixels of a channel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ChannelMean {
    /// The mean.
    pub value: f64,
    /// Its standard error by the variances of the pixels; `None` if one is unknown.
    pub standard_error: Option<f64>,
}

impl ChannelMean {
    /// Half the length of the interval that holds the truth with 95 % confidence, by the central limit
    /// theorem over the pixels.
    pub fn half_interval(self) -> Option<f64> {
        self.standard_error.map(|sigma| SIGMAS_OF_95_PERCENT * sigma)
    }
}

/// The largest difference of a channel, and where it is in what was compared.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LargestDifference {
    /// |a − b| of that channel.
    pub difference: f64,
    /// Column from the left.
    pub x: u32,
    /// Row from the top.
    pub y: u32,
    /// The pixel in A.
    pub a: Rgb,
    /// The pixel in B.
    pub b: Rgb,
}

/// Compares A with the reference B.
pub fn compare(a: &Estimate, b: &Estimate) -> Result<Comparison, NothingToCompare> {
    let size = |estimate: &Estimate| (estimate.picture.width, estimate.picture.height);
    if size(a) != size(b) {
        return Err(NothingToCompare::Size { a: size(a), b: size(b) });
    }
    let (all_a, all_b) = (&a.picture.pixels, &b.picture.pixels);
    let nonfinite = |pixels: &[Rgb]| pixels.iter().filter(|pixel| !pixel.is_finite()).count() as u64;
    let (nonfinite_a, nonfinite_b) = (nonfinite(all_a), nonfinite(all_b));
    let compared = indices(a, b);
    if compared.is_empty() {
        let pixels = all_a.len() as u64;
        return Err(NothingToCompare::NonFinite { pixels, a: nonfinite_a, b: nonfinite_b });
    }
    let mean = |term: fn(f64, f64) -> f64| {
        let of_pixel = |&i: &usize| sum_of_channels(all_a[i], all_b[i], term);
        compared.iter().map(of_pixel).sum::<f64>() / (3 * compared.len()) as f64
    };
    let (mean_a, mean_b) = (means(a, &compared), means(b, &compared));
    Ok(Comparison {
        pixels: compared.len() as u64,
        nonfinite_a,
        nonfinite_b,
        mse: mean(|a, b| (a - b).powi(2)),
        relmse: mean(relative_squared_error),
        mape: mean(|a, b| (a - b).abs() / (b.abs() + MAPE_OFFSET)),
        relmse_of_noise: relmse_of_noise(a, b, &compared),
        mean_a,
        mean_b,
        bias: bias(a, b, mean_a, mean_b),
        largest: largest_difference(a, b, &compared),
    })
}

/// (a − b)²/(b² + 0.01) of a channel.
pub fn relative_squared_error(a: f64, b: f64) -> f64 {
    (a - b).powi(2) / (b * b + RELATIVE_ERROR_OFFSET)
}

/// [`relative_squared_error`], the mean of the channels; `None` if one is not finite.
pub fn relative_squared_error_of_pixel(a: Rgb, b: Rgb) -> Option<f64> {
    (a.is_finite() && b.is_finite()).then(|| sum_of_channels(a, b, relative_squared_error) / 3.0)
}

fn sum_of_channels(a: Rgb, b: Rgb, term: impl Fn(f64, f64) -> f64) -> f64 {
    (0..3).map(|channel| term(f64::from(a[channel]), f64::from(b[channel]))).sum()
}

/// Indices of the pixels that are finite in both.
fn indices(a: &Estimate, b: &Estimate) -> Vec<usize> {
    let pairs = a.picture.pixels.iter().zip(&b.picture.pixels).enumerate();
    pairs.filter(|(_, (a, b))| a.is_finite() && b.is_finite()).map(|(i, _)| i).collect()
}

fn means(estimate: &Estimate, compared: &[usize]) -> [ChannelMean; 3] {
    let count = compared.len() as f64;
    [0, 1, 2].map(|channel| {
        let sum: f64 = compared.iter().map(|&i| f64::from(estimate.picture.pixels[i][channel])).sum();
        let variance = estimate
            .variance
            .as_ref()
            .and_then(|variance| compared.iter().map(|&i| known(variance[i][channel])).sum::<Option<f64>>());
        let standard_error = variance.map(|sum| sum.sqrt() / count);
        ChannelMean { value: sum / count, standard_error }
    })
}

/// A variance, if it is one.
fn known(variance: f32) -> Option<f64> {
    (variance.is_finite() && variance >= 0.0).then_some(f64::from(variance))
}

fn bias(a: &Estimate, b: &Estimate, mean_a: [ChannelMean; 3], mean_b: [ChannelMean; 3]) -> [ChannelMean; 3] {
    [0, 1, 2].map(|channel| {
        let (in_a, in_b) = (mean_a[channel], mean_b[channel]);
        let standard_error = match (&a.variance, &b.variance) {
            (Some(_), Some(_)) => in_a.standard_error.zip(in_b.standard_error).map(|(a, b)| a.hypot(b)),
            (Some(_), None) => in_a.standard_error,
            (None, _) => in_b.standard_error,
        };
        ChannelMean { value: in_a.value - in_b.value, standard_error }
    })
}

fn relmse_of_noise(a: &Estimate, b: &Estimate, compared: &[usize]) -> Option<f64> {
    if a.variance.is_none() && b.variance.is_none() {
        return None;
    }
    let variance = |estimate: &Estimate, i: usize, channel: usize| {
        estimate.variance.as_ref().map_or(Some(0.0), |variance| known(variance[i][channel]))
    };
    let term = |i: usize, channel: usize| {
        let reference = f64::from(b.picture.pixels[i][channel]);
        let sum = variance(a, i, channel)? + variance(b, i, channel)?;
        Some(sum / (reference * reference + RELATIVE_ERROR_OFFSET))
    };
    let terms = compared.iter().flat_map(|&i| [0, 1, 2].map(|channel| term(i, channel)));
    Some(terms.sum::<Option<f64>>()? / (3 * compared.len()) as f64)
}

fn largest_difference(a: &Estimate, b: &Estimate, compared: &[usize]) -> LargestDifference {
    let width = a.picture.width as usize;
    compared.iter().fold(LargestDifference::default(), |largest, &i| {
        let (a, b) = (a.picture.pixels[i], b.picture.pixels[i]);
        let difference =
            [0, 1, 2].map(|c| (f64::from(a[c]) - f64::from(b[c])).abs()).into_iter().fold(0.0, f64::max);
        // The first pixel stands for the largest difference also where that is 0.
        if difference > largest.difference || i == compared[0] {
            LargestDifference { difference, x: (i % width) as u32, y: (i / width) as u32, a, b }
        } else {
            largest
        }
    })
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, Normal};
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::SeedableRng;

    use super::*;

    fn estimate(width: u32, pixels: &[Rgb], variance: Option<Vec<Rgb>>) -> Estimate {
        let height = pixels.len() as u32 / width;
        Estimate { picture: Picture { width, height, pixels: pixels.to_vec() }, variance }
    }

    /// Two pixels by hand: differences (0.5, 0, 0) from (1, 2, 0), and (0, −0.1, 0.3) from (0, 0.1, 0.3).
    #[test]
    fn metrics_are_those_of_their_formulas() {
        let b = estimate(1, &[Rgb::new(1.0, 2.0, 0.0), Rgb::new(0.0, 0.1, 0.3)], None);
        let a = estimate(1, &[Rgb::new(1.5, 2.0, 0.0), Rgb::new(0.0, 0.0, 0.6)], None);
        let found = compare(&a, &b).unwrap();
        // 0.1, 0.3 and 0.6 are rounded to 24 bits; squares and quotients double that a few times.
        let close =
            |value: f64, expected: f64| (value / expected - 1.0).abs() < 8.0 * f64::from(f32::EPSILON);
        assert!(close(found.mse, (0.25 + 0.01 + 0.09) / 6.0));
        assert!(close(found.relmse, (0.25 / 1.01 + 0.01 / 0.02 + 0.09 / 0.10) / 6.0));
        assert!(close(found.mape, (0.5 / 1.01 + 0.1 / 0.11 + 0.3 / 0.31) / 6.0));
        assert!(close(found.mean_a[0].value, 0.75) && close(found.mean_b[2].value, 0.15));
        assert!(close(found.bias[0].value, 0.25) && close(found.bias[1].value, -0.05));
        assert!(close(found.bias[2].value, 0.15));
        let LargestDifference { difference, x, y, a, b } = found.largest;
        assert_eq!((difference, x, y, a[0], b[0]), (0.5, 0, 0, 1.5, 1.0));
        assert_eq!((found.pixels, found.relmse_of_noise, found.bias[0].standard_error), (2, None, None));
    }

    #[test]
    fn equal_pictures_have_no_error() {
        let a = estimate(2, &[Rgb::new(f32::MAX, 0.0, -1.0); 4], None);
        let found = compare(&a, &a).unwrap();
        assert_eq!((found.mse, found.relmse, found.mape), (0.0, 0.0, 0.0));
        assert_eq!(found.bias, [ChannelMean::default(); 3]);
        assert_eq!((found.largest.difference, found.largest.a), (0.0, a.picture.pixels[0]));
    }

    #[test]
    fn what_is_not_finite_is_counted_and_left_out() {
        let (one, two) = (Rgb::ONE, Rgb::splat(2.0));
        let a = estimate(4, &[two, Rgb::new(1.0, f32::NAN, 1.0), one, one], None);
        let b = estimate(4, &[one, one, Rgb::splat(f32::INFINITY), Rgb::splat(f32::NEG_INFINITY)], None);
        let found = compare(&a, &b).unwrap();
        assert_eq!((found.pixels, found.nonfinite_a, found.nonfinite_b), (1, 1, 2));
        assert_eq!((found.mse, found.mean_a[1].value, found.mean_b[1].value), (1.0, 2.0, 1.0));
        let nothing = estimate(4, &[Rgb::splat(f32::NAN); 4], None);
        let expected = NothingToCompare::NonFinite { pixels: 4, a: 4, b: 2 };
        assert_eq!(compare(&nothing, &b).unwrap_err(), expected);
        let narrow = estimate(2, &b.picture.pixels, None);
        assert_eq!(compare(&a, &narrow).unwrap_err(), NothingToCompare::Size { a: (4, 1), b: (2, 2) });
    }

    #[test]
    fn errors_of_means_come_from_the_variances() {
        let (pixels, variance) = ([Rgb::ONE; 4], |value| Some(vec![Rgb::new(value, 4.0, f32::INFINITY); 4]));
        let (a, b) = (estimate(2, &pixels, variance(9.0)), estimate(2, &pixels, variance(16.0)));
        let found = compare(&a, &b).unwrap();
        // √(4·9)/4, √(4·16)/4, and both.
        assert_eq!(found.mean_a.map(|mean| mean.standard_error), [Some(1.5), Some(1.0), None]);
        assert_eq!(found.mean_b[0].standard_error, Some(2.0));
        assert_eq!(found.bias.map(|bias| bias.standard_error), [Some(2.5), Some(2.0_f64.sqrt()), None]);
        assert_eq!(found.relmse_of_noise, None);
        // A reference without variance is exact; what is left out may have any variance.
        let mut pixels = pixels.to_vec();
        pixels[3] = Rgb::splat(f32::NAN);
        let mut variance = vec![Rgb::splat(9.0); 4];
        variance[3] = Rgb::splat(f32::NAN);
        let exact = estimate(2, &[Rgb::ONE; 4], None);
        let found = compare(&estimate(2, &pixels, Some(variance)), &exact).unwrap();
        assert_eq!(found.bias[0].standard_error, Some(27.0_f64.sqrt() / 3.0));
        assert!((found.relmse_of_noise.unwrap() * 1.01 / 9.0 - 1.0).abs() < 4.0 * f64::EPSILON);
        assert_eq!(found.mean_b[0].standard_error, None);
    }

    /// A difference that is normal with the variance stated: relMSE is as large as foretold. The square of a
    /// normal variable has variance 2σ⁴, so with equal terms relMSE is uncertain by √(2/n) of itself.
    #[test]
    fn noise_is_foretold() {
        const SIDE: u32 = 100;
        let mut random = Xoshiro256PlusPlus::seed_from_u64(3);
        let (sigma_a, sigma_b) = (0.01, 0.02);
        let mut noisy = |sigma: f64| -> Vec<Rgb> {
            let normal = Normal::new(0.5, sigma).unwrap();
            let mut channel = |_| normal.sample(&mut random) as f32;
            (0..SIDE * SIDE).map(|_| Rgb::from_fn(&mut channel)).collect()
        };
        let (a, b) = (noisy(sigma_a), noisy(sigma_b));
        let variance = |sigma: f64| Some(vec![Rgb::splat((sigma * sigma) as f32); a.len()]);
        let found = compare(&estimate(SIDE, &a, variance(sigma_a)), &estimate(SIDE, &b, variance(sigma_b)));
        let found = found.unwrap();
        let terms = f64::from(3 * SIDE * SIDE);
        assert!((found.relmse / found.relmse_of_noise.unwrap() - 1.0).abs() < 3.0 * (2.0 / terms).sqrt());
        for bias in found.bias {
            assert!(bias.value.abs() < 3.0 * bias.standard_error.unwrap());
            assert!(bias.half_interval() > bias.standard_error);
        }
    }
}
