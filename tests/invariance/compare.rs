//! Whether two pictures differ by more than noise.
//!
//! Each picture is rendered in [`BATCHES`] batches with seeds of their own. Means of batches are independent and close to normal, so the difference
//! of two pictures over its standard error, itself estimated from the batches, is one of Student's t with 2·16 − 2 = 30 degrees of
//! freedom. Two numbers are made of it for each channel:
//!
//! - t of the whole picture, which sees a little more or less light anywhere;
//! - the mean of t² over the 24 blocks of 4 × 4 pixels, which are independent: light that is elsewhere.
//!
//! A third number is relMSE between the pictures over that which noise makes, as in `docs/stability.md`. Where the noise is that of a few pixels, so is the
//! ratio: it is one of χ² over its degrees of freedom, of which there are (Σ n)²/Σ n² with n the noise of each pixel (Satterthwaite 1946).
//!
//! The limits are those that pictures of equal expectation pass with a probability of 10⁻⁶ (numerically: quantiles of |t| with 30 degrees of
//! freedom, and of the 24-fold convolution of t²; of χ² by the formula of Wilson and Hilferty 1931). With some 150 comparisons of seven numbers
//! each the suite gives a false alarm once in a thousand changes of its seeds, which are fixed.

use std::ops::Range;

use alabaster::radiometry::Rgb;
use alabaster::raycast::RayCaster;
use alabaster::transport::{Counters, Renderer};
use rayon::prelude::*;

/// Pixels of the pictures.
pub const WIDTH: u32 = 24;
pub const HEIGHT: u32 = 16;
/// Edge of a block, pixels.
const BLOCK: u32 = 4;
const BLOCKS: usize = (WIDTH / BLOCK * HEIGHT / BLOCK) as usize;

const BATCHES: usize = 16;

/// |t| of the whole picture, at 10⁻⁶.
const LARGEST_T: f64 = 6.12;
/// Mean of t² over the blocks, at 10⁻⁶; 30/28 is expected.
const LARGEST_MEAN_SQUARE: f64 = 3.69;
/// Of the normal distribution, at 10⁻⁶.
const LARGEST_NORMAL: f64 = 4.76;

/// Differences that rounding may make where there is no noise at all, of the mean of the picture.
const ROUNDING: f64 = 1e-5;

/// Pictures of one scene, from independent random numbers.
pub struct Batches(Vec<Vec<Rgb>>);

/// How two pictures differ.
#[derive(Debug)]
pub struct Difference {
    /// By channel: t of the whole picture.
    whole: [f64; 3],
    /// By channel: mean over blocks of t².
    blocks: [f64; 3],
    /// relMSE over that of noise.
    ratio: f64,
    /// What that may be.
    largest_ratio: f64,
}

/// Mean and squared standard error of the batches.
struct Estimate {
    mean: f64,
    variance: f64,
}

impl Batches {
    /// `samples` of each pixel in each batch. Batches of one `group` have the same seeds, those of two have none in common.
    pub fn new<C: RayCaster>(renderer: &mut Renderer<C>, group: u64, samples: u64) -> Self {
        let seeds: Range<u64> = group * BATCHES as u64..(group + 1) * BATCHES as u64;
        let batch = |seed: u64| {
            renderer.reseed(1000 + seed);
            (0..WIDTH * HEIGHT).into_par_iter().map(|pixel| mean(renderer, pixel, samples)).collect()
        };
        Self(seeds.map(batch).collect())
    }

    /// The same with channel `channels[c]` of the pictures where `c` was taken from: the inverse of an exchange.
    pub fn of_channels(mut self, channels: [usize; 3]) -> Self {
        for pixel in self.0.iter_mut().flatten() {
            let exchanged = *pixel;
            for (c, &from) in channels.iter().enumerate() {
                pixel.0[from] = exchanged[c];
            }
        }
        self
    }

    /// Of the mean over `pixels` of a channel.
    fn estimate(&self, pixels: &[usize], channel: usize) -> Estimate {
        let of_batch = |batch: &Vec<Rgb>| {
            pixels.iter().map(|&pixel| f64::from(batch[pixel][channel])).sum::<f64>() / pixels.len() as f64
        };
        let means: Vec<f64> = self.0.iter().map(of_batch).collect();
        let count = means.len() as f64;
        let mean = means.iter().sum::<f64>() / count;
        let squares: f64 = means.iter().map(|x| (x - mean).powi(2)).sum();
        Estimate { mean, variance: squares / (count * (count - 1.0)) }
    }

    /// How `self` differs from `other`.
    pub fn compare(&self, other: &Self) -> Difference {
        let all: Vec<usize> = (0..(WIDTH * HEIGHT) as usize).collect();
        let channels = [0, 1, 2];
        let t = |pixels: &[usize], c: usize| {
            let (a, b) = (self.estimate(pixels, c), other.estimate(pixels, c));
            let rounding = ROUNDING * a.mean.abs().max(b.mean.abs());
            let difference = ((a.mean - b.mean).abs() - rounding).max(0.0);
            if difference == 0.0 { 0.0 } else { difference / (a.variance + b.variance).sqrt() }
        };
        let blocks: Vec<Vec<usize>> = (0..BLOCKS)
            .map(|block| all.iter().copied().filter(|&p| block_of(p) == block).collect())
            .collect();
        let (mut difference, mut noise, mut squares) = (0.0, 0.0, 0.0);
        for pixel in 0..all.len() {
            let before: f64 = noise;
            for c in channels {
                let (a, b) = (self.estimate(&[pixel], c), other.estimate(&[pixel], c));
                let scale = 0.5 * (a.mean.powi(2) + b.mean.powi(2)) + 0.01;
                difference += (a.mean - b.mean).powi(2) / scale;
                noise += (a.variance + b.variance) / scale;
            }
            squares += (noise - before).powi(2);
        }
        Difference {
            whole: channels.map(|c| t(&all, c)),
            blocks: channels
                .map(|c| blocks.iter().map(|block| t(block, c).powi(2)).sum::<f64>() / BLOCKS as f64),
            ratio: if difference <= ROUNDING * ROUNDING { 0.0 } else { difference / noise },
            largest_ratio: largest_ratio(noise * noise / squares),
        }
    }
}

/// χ² over its degrees of `freedom`, at 10⁻⁶. No number without noise, where only 0 passes.
fn largest_ratio(freedom: f64) -> f64 {
    let spread = 2.0 / (9.0 * freedom);
    (1.0 - spread + LARGEST_NORMAL * spread.sqrt()).powi(3)
}

/// Which block a pixel is in.
fn block_of(pixel: usize) -> usize {
    let (x, y) = (pixel as u32 % WIDTH, pixel as u32 / WIDTH);
    (y / BLOCK * (WIDTH / BLOCK) + x / BLOCK) as usize
}

fn mean<C: RayCaster>(renderer: &Renderer<C>, pixel: u32, samples: u64) -> Rgb {
    let mut counters = Counters::default();
    let mut sum = Rgb::ZERO;
    for sample in 0..samples {
        let radiance = renderer.sample(pixel % WIDTH, pixel / WIDTH, sample, &mut counters);
        assert!(radiance.is_finite());
        sum += radiance;
    }
    sum / samples as f32
}

impl Difference {
    /// What is wrong, if it is more than noise.
    pub fn verdict(&self) -> Result<(), String> {
        let holds = self.whole.iter().all(|t| *t < LARGEST_T)
            && self.blocks.iter().all(|square| *square < LARGEST_MEAN_SQUARE)
            && (self.ratio < self.largest_ratio || self.ratio == 0.0);
        if holds { Ok(()) } else { Err(format!("{self:?}")) }
    }
}

/// Noise of a known spread passes, and what is a few of its standard errors off does not.
#[test]
fn limits_tell_bias_from_noise() {
    let mut random = alabaster::math::sampler::HashGenerator::new(7);
    let mut noisy = |mean: f32| {
        let mut picture =
            || (0..WIDTH * HEIGHT).map(|_| Rgb::from_fn(|_| mean * random.next_exponential())).collect();
        Batches((0..BATCHES).map(|_| picture()).collect())
    };
    for _ in 0..50 {
        let difference = noisy(1.0).compare(&noisy(1.0));
        assert!(difference.verdict().is_ok(), "{difference:?}");
    }
    // The standard error of the difference is √(2/(16·384)) = 1.8 %.
    assert!(noisy(1.0).compare(&noisy(1.18)).verdict().is_err());
    // Light that has moved by a block leaves the whole as it was.
    let (bright, dark) = (noisy(1.5), noisy(0.5));
    let striped = |first: &Batches, second: &Batches| {
        let pick = |(a, b): (&Vec<Rgb>, &Vec<Rgb>)| {
            (0..a.len()).map(|p| if block_of(p).is_multiple_of(2) { a[p] } else { b[p] }).collect()
        };
        Batches(first.0.iter().zip(&second.0).map(pick).collect())
    };
    let difference = striped(&bright, &dark).compare(&striped(&dark, &bright));
    assert!(
        difference.whole.iter().all(|t| *t < LARGEST_T) && difference.verdict().is_err(),
        "{difference:?}"
    );
}
