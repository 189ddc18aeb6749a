//! The sum of a pixel's samples, exact in any order.
//!
//! Floating-point addition is not associative, so a sum of floats would depend on how the samples
//! were dealt out to threads, passes and machines. Here every sample is rounded once, to a multiple
//! of a fixed quantum, and from then on there are only integers: adding samples in any order and
//! merging parts in any grouping gives the same bits.
//!
//! Three bounds share the bits. A pixel holds 2³² samples of magnitude up to [`LARGEST`] = 2³⁶
//! W/(m² sr) (3000 times the disk of the sun), so
//!
//! - Σx, in quanta of 2⁻⁵⁸ (3.5·10⁻¹⁸), stays below 2^(36+32+58) = 2¹²⁶ and fits an `i128`. Samples
//!   above 2⁻³⁴ enter without any rounding, because an `f32` has 24 bits.
//! - x², in quanta of 2⁻⁵⁴, is at most 2^(72+54) = 2¹²⁶ and fits a `u128`; Σx² is below 2¹⁵⁸ and
//!   carries into 32 further bits. The quantum is that of a sample of 7·10⁻⁹: darker ones leave no
//!   trace in the variance, but do in the mean.

use crate::radiometry::Rgb;

/// Samples per pixel for which there is room, whatever their values.
pub const MAX_SAMPLES: u64 = 1 << 32;

/// Samples of larger magnitude are clamped to it and counted.
pub const LARGEST: f32 = (1_u64 << 36) as f32;

const QUANTA: f64 = (1_u64 << 58) as f64;
const SQUARE_QUANTA: f64 = (1_u64 << 54) as f64;
/// 2¹²⁸.
const CARRY: f64 = u128::MAX as f64;

/// What is known of one pixel: sums over its samples, as integers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Accumulator {
    /// Σx by channel, in units of 2⁻⁵⁸.
    sum: [i128; 3],
    /// Σx² by channel modulo 2¹²⁸, in units of 2⁻⁵⁴.
    squares: [u128; 3],
    /// How often `squares` went round.
    square_carries: [u32; 3],
    nonfinite: u32,
    clamped: u32,
    /// Bits of the largest channel of any sample: of numbers that are not negative these are in order.
    brightest: u32,
    taken: u64,
}

impl Accumulator {
    /// Adds one sample.
    ///
    /// A sample with a channel that is not finite adds nothing, is counted, and counts as taken: the
    /// picture then shows the light that is missing. (Leaving it out of the count as well would put
    /// the mean of the other samples in its place and so hide the loss.)
    pub fn add(&mut self, sample: Rgb) {
        self.taken += 1;
        if !sample.is_finite() {
            self.nonfinite += 1;
            return;
        }
        let inside = sample.map(|x| x.clamp(-LARGEST, LARGEST));
        self.clamped += u32::from(inside != sample);
        self.brightest = self.brightest.max(inside.max_component().max(0.0).to_bits());
        for channel in 0..3 {
            // A power of two times an f32, and the square of an f32, are exact in f64.
            let x = f64::from(inside[channel]);
            self.sum[channel] += (x * QUANTA).round_ties_even() as i128;
            self.add_squares(channel, (x * x * SQUARE_QUANTA).round_ties_even() as u128, 0);
        }
    }

    /// Adds the samples of `other`.
    pub fn merge(&mut self, other: &Self) {
        self.taken += other.taken;
        self.nonfinite += other.nonfinite;
        self.clamped += other.clamped;
        self.brightest = self.brightest.max(other.brightest);
        for channel in 0..3 {
            self.sum[channel] += other.sum[channel];
            self.add_squares(channel, other.squares[channel], other.square_carries[channel]);
        }
    }

    fn add_squares(&mut self, channel: usize, squares: u128, carries: u32) {
        let (total, carry) = self.squares[channel].overflowing_add(squares);
        self.squares[channel] = total;
        self.square_carries[channel] += carries + u32::from(carry);
    }

    /// Samples taken, those that were not finite included.
    pub fn taken(&self) -> u64 {
        self.taken
    }

    /// Samples that were not finite and added nothing.
    pub fn nonfinite(&self) -> u32 {
        self.nonfinite
    }

    /// Samples of which a channel was clamped to ±[`LARGEST`].
    pub fn clamped(&self) -> u32 {
        self.clamped
    }

    /// The largest channel of any sample, W/(m² sr); 0 if there are none.
    pub fn brightest(&self) -> f32 {
        f32::from_bits(self.brightest)
    }

    /// Mean of the samples, W/(m² sr); 0 if there are none.
    pub fn mean(&self) -> Rgb {
        Rgb::from_fn(|channel| self.channel_mean(channel) as f32)
    }

    fn channel_mean(&self, channel: usize) -> f64 {
        if self.taken == 0 { 0.0 } else { self.sum[channel] as f64 / QUANTA / self.taken as f64 }
    }

    /// Variance of the mean of one channel, (W/(m² sr))²: s²/n with the unbiased sample variance
    /// s² = (Σx² − n·mean²)/(n − 1). Infinite (unknown) for fewer than two samples.
    ///
    /// It takes the samples for independent. Those of a low-discrepancy sequence are spread more
    /// evenly, so that for smooth integrands the truth is smaller.
    pub fn variance_of_mean(&self, channel: usize) -> f64 {
        if self.taken < 2 {
            return f64::INFINITY;
        }
        let n = self.taken as f64;
        let squares = f64::from(self.square_carries[channel]) * CARRY + self.squares[channel] as f64;
        let mean = self.channel_mean(channel);
        // Rounding can leave a difference of equals just below 0.
        ((squares / SQUARE_QUANTA / n - mean * mean) / (n - 1.0)).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(samples: &[Rgb]) -> Accumulator {
        let mut accumulator = Accumulator::default();
        samples.iter().for_each(|&sample| accumulator.add(sample));
        accumulator
    }

    #[test]
    fn a_constant_is_its_own_mean_without_variance() {
        let pixel = of(&[Rgb::new(0.1, 3.0, 1e-3); 1000]);
        assert_eq!(pixel.mean(), Rgb::new(0.1, 3.0, 1e-3));
        for channel in 0..3 {
            // Cancellation leaves rounding of mean² (one f64 ulp or two), divided by n − 1, and the quantum.
            let x = f64::from(pixel.mean()[channel]);
            let rounding = (4.0 * f64::EPSILON * x * x + 1.0 / SQUARE_QUANTA) / 999.0;
            assert!(pixel.variance_of_mean(channel) <= rounding);
        }
    }

    #[test]
    fn squares_carry_over() {
        // 2¹²⁸ quanta are reached after 4 samples of 2³⁶: 4·2⁷²·2⁵⁴ = 2¹²⁸.
        let pixel = of(&[Rgb::splat(LARGEST), Rgb::splat(-LARGEST)].repeat(50));
        assert_eq!(pixel.square_carries, [25; 3]);
        assert_eq!(pixel.squares, [0; 3]);
        assert_eq!(pixel.mean(), Rgb::ZERO);
        let expected = f64::from(LARGEST).powi(2) / 99.0;
        assert!((pixel.variance_of_mean(0) / expected - 1.0).abs() < 4.0 * f64::EPSILON);
    }

    #[test]
    fn what_is_too_large_is_clamped_and_counted() {
        let pixel = of(&[Rgb::new(f32::MAX, 0.0, f32::MIN), Rgb::splat(LARGEST)]);
        assert_eq!((pixel.taken(), pixel.nonfinite(), pixel.clamped()), (2, 0, 1));
        assert_eq!(pixel.brightest(), LARGEST);
        assert_eq!(pixel.mean(), Rgb::new(LARGEST, LARGEST / 2.0, 0.0));
    }

    #[test]
    fn what_is_not_finite_adds_nothing_but_is_taken() {
        let pixel = of(&[Rgb::splat(2.0), Rgb::new(1.0, f32::NAN, 1.0), Rgb::new(f32::INFINITY, 0.0, 0.0)]);
        assert_eq!((pixel.taken(), pixel.nonfinite(), pixel.clamped()), (3, 2, 0));
        assert_eq!(pixel.brightest(), 2.0);
        assert_eq!(pixel.mean(), Rgb::splat(2.0 / 3.0));
    }

    #[test]
    fn there_is_room_for_the_most_samples_of_the_largest_value() {
        let mut pixel = of(&[Rgb::splat(-LARGEST)]);
        for _ in 0..MAX_SAMPLES.ilog2() {
            pixel.merge(&pixel.clone());
        }
        assert_eq!(pixel.taken(), MAX_SAMPLES);
        assert_eq!(pixel.mean(), Rgb::splat(-LARGEST));
        assert_eq!(pixel.variance_of_mean(0), 0.0);
    }

    #[test]
    fn unknown_variance_is_infinite() {
        assert_eq!(of(&[]).variance_of_mean(0), f64::INFINITY);
        assert_eq!(of(&[Rgb::ONE]).variance_of_mean(0), f64::INFINITY);
        // Two samples 0 and 1: s² = 1/2, of the mean 1/4.
        assert_eq!(of(&[Rgb::ZERO, Rgb::ONE]).variance_of_mean(0), 0.25);
    }
}
