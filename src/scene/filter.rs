//! Reconstruction filters, applied by placing samples with the filter's own density
//! (Ernst, Stamminger, Greiner 2006, "Filter Importance Sampling"), so that every sample counts 1.

use std::f64::consts::TAU;
use std::sync::LazyLock;

use super::Filter;

/// Both tapered filters reach this far from the centre of the pixel, in pixels.
const RADIUS: f64 = 1.5;
const GAUSSIAN_SIGMA: f64 = 0.5;
/// Coefficients of the four-term window of least sidelobes (Harris 1978, table 1, −92 dB).
const BLACKMAN_HARRIS: [f64; 4] = [0.358_75, 0.488_29, 0.141_28, 0.011_68];
const CELLS: usize = 512;

static GAUSSIAN_TABLE: LazyLock<HalfTable> = LazyLock::new(|| HalfTable::new(gaussian));
static BLACKMAN_HARRIS_TABLE: LazyLock<HalfTable> = LazyLock::new(|| HalfTable::new(blackman_harris));

impl Filter {
    /// Offset in pixels from the centre of the pixel, distributed as the filter, from `u` uniform in
    /// the unit square. All filters are products over x and y.
    pub fn sample(self, u: [f32; 2]) -> [f32; 2] {
        match self {
            Filter::Box => u.map(|u| u - 0.5),
            Filter::Gaussian => u.map(|u| GAUSSIAN_TABLE.sample_symmetric(u)),
            Filter::BlackmanHarris => u.map(|u| BLACKMAN_HARRIS_TABLE.sample_symmetric(u)),
        }
    }
}

fn gaussian(x: f64) -> f64 {
    (-0.5 * (x / GAUSSIAN_SIGMA).powi(2)).exp()
}

fn blackman_harris(x: f64) -> f64 {
    let phase = TAU * x / (2.0 * RADIUS);
    (0..4).map(|k| BLACKMAN_HARRIS[k] * (k as f64 * phase).cos()).sum()
}

/// Cumulative distribution of |x| on a grid over [0, [`RADIUS`]], linear in between. With 512
/// cells of h = 0.003 pixel the distribution is off by at most h²/8 of the steepest density: 3·10⁻⁶.
struct HalfTable {
    cumulative: [f32; CELLS + 1],
}

impl HalfTable {
    fn new(density: fn(f64) -> f64) -> Self {
        let cell = RADIUS / CELLS as f64;
        let mut sums = [0.0_f64; CELLS + 1];
        for i in 0..CELLS {
            let x = i as f64 * cell;
            // Simpson's rule; both densities are smooth over thousands of cells.
            let mass = (density(x) + 4.0 * density(x + 0.5 * cell) + density(x + cell)) / 6.0;
            sums[i + 1] = sums[i] + mass;
        }
        Self { cumulative: sums.map(|sum| (sum / sums[CELLS]) as f32) }
    }

    /// The left half of [0, 1) goes to negative, the right half to positive x, growing with `u`.
    fn sample_symmetric(&self, u: f32) -> f32 {
        let signed = 2.0 * u - 1.0;
        self.invert(signed.abs()).copysign(signed)
    }

    fn invert(&self, u: f32) -> f32 {
        let above = self.cumulative.partition_point(|&c| c <= u).clamp(1, CELLS);
        let (low, high) = (self.cumulative[above - 1], self.cumulative[above]);
        let fraction = if high > low { ((u - low) / (high - low)).min(1.0) } else { 1.0 };
        ((above - 1) as f32 + fraction) * (RADIUS / CELLS as f64) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distribution function of the window, integrated term by term.
    fn blackman_harris_cdf(x: f64) -> f64 {
        let width = 2.0 * RADIUS;
        let sines: f64 = (1..4)
            .map(|k| {
                let frequency = TAU * k as f64 / width;
                BLACKMAN_HARRIS[k] / (BLACKMAN_HARRIS[0] * width * frequency) * (frequency * x).sin()
            })
            .sum();
        0.5 + x / width + sines
    }

    /// Distribution function of the cut Gaussian by the Maclaurin series of the error function,
    /// which converges to double precision for arguments up to 1.5/(0.5·√2) = 2.1 in 60 terms.
    fn gaussian_cdf(x: f64) -> f64 {
        let half_mass = |x: f64| {
            let z = x / (GAUSSIAN_SIGMA * std::f64::consts::SQRT_2);
            let (mut term, mut sum) = (z, z);
            for n in 1..60 {
                term *= -z * z / f64::from(n);
                sum += term / f64::from(2 * n + 1);
            }
            sum
        };
        0.5 + 0.5 * half_mass(x) / half_mass(RADIUS)
    }

    #[test]
    fn samples_are_distributed_as_the_filter() {
        // Kolmogorov–Smirnov distance of 20,000 stratified samples: half a stratum, the table's
        // 3e-6, and rounding of u and x to f32 (the density is at most 1 per pixel).
        let n = 20_000;
        let bound = 0.5 / f64::from(n) + 3e-6 + 4.0 * f64::from(f32::EPSILON);
        for (filter, cdf) in [
            (Filter::Gaussian, gaussian_cdf as fn(f64) -> f64),
            (Filter::BlackmanHarris, blackman_harris_cdf),
        ] {
            for i in 0..n {
                let u = (f64::from(i) + 0.5) / f64::from(n);
                let [x, y] = filter.sample([u as f32, 0.25]);
                let distance = (cdf(f64::from(x)) - u).abs();
                assert!(distance <= bound, "{filter:?} at u = {u}: {distance:e}");
                assert!((cdf(f64::from(y)) - 0.25).abs() <= bound);
            }
        }
    }

    #[test]
    fn moments_are_those_of_the_filter() {
        // Variance of the window: ∫x²w/∫w = W²(1/12 + Σ (−1)ᵏ a_k/(2π²k² a_0)).
        let pi2 = (0.5 * TAU).powi(2);
        let window: f64 = (1..4_i32)
            .map(|k| {
                let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
                sign * BLACKMAN_HARRIS[k as usize] / (2.0 * pi2 * f64::from(k * k) * BLACKMAN_HARRIS[0])
            })
            .sum();
        // Variance of a Gaussian cut at c = 3σ: σ²(1 − 2cφ(c)/(2Φ(c) − 1)), with 2Φ(3) − 1 = 0.9973002.
        let cut = 6.0 * (-4.5_f64).exp() / TAU.sqrt() / 0.997_300_203_936_74;
        let expected = [
            (Filter::Box, 1.0 / 12.0),
            (Filter::Gaussian, GAUSSIAN_SIGMA.powi(2) * (1.0 - cut)),
            (Filter::BlackmanHarris, 9.0 * (1.0 / 12.0 + window)),
        ];
        let n = 20_000;
        for (filter, variance) in expected {
            let samples = (0..n)
                .map(|i| f64::from(filter.sample([(i as f32 + 0.5) / n as f32, 0.0])[0]))
                .collect::<Vec<_>>();
            let mean = samples.iter().sum::<f64>() / f64::from(n);
            let second = samples.iter().map(|x| x * x).sum::<f64>() / f64::from(n);
            // The quantile function is bounded by 1.5 and monotone, so the midpoint rule is off by
            // at most its range over n, in x and (range 2·1.5²) in x².
            assert!(mean.abs() <= 3.0 / f64::from(n), "{filter:?} mean {mean}");
            assert!((second - variance).abs() <= 4.5 / f64::from(n), "{filter:?} {second} {variance}");
        }
    }

    #[test]
    fn samples_stay_inside_the_filter() {
        let last = 1.0_f32.next_down();
        for (filter, radius) in [(Filter::Box, 0.5), (Filter::Gaussian, 1.5), (Filter::BlackmanHarris, 1.5)] {
            for u in [0.0, 1e-30, 0.25, 0.5_f32.next_down(), 0.5, 0.75, last] {
                for x in filter.sample([u, last]) {
                    assert!(x.abs() <= radius, "{filter:?} at {u}: {x}");
                }
            }
        }
    }
}
