//! Standard errors by leaving out one run after another, and intervals of ratios.

use crate::slab::Estimate;

/// The normal distribution holds 95 % within so many σ of its mean.
pub use crate::study::image::metrics::SIGMAS_OF_95_PERCENT as SIGMAS;

/// Numbers computed from `count` independent runs, with the standard errors of the jackknife (Tukey 1958):
/// σ² = (n−1)/n Σ_k (x_(k) − mean of the x_(k))², where x_(k) lacks run k. `compute` is told which run to leave
/// out. With fewer than two runs the error is infinite.
pub fn jackknife(count: usize, compute: impl Fn(Option<usize>) -> Vec<f64>) -> Vec<Estimate> {
    let values = compute(None);
    let n = count as f64;
    let without: Vec<Vec<f64>> =
        if count < 2 { Vec::new() } else { (0..count).map(|k| compute(Some(k))).collect() };
    let error = |i: usize| {
        if without.is_empty() {
            return f64::INFINITY;
        }
        let mean = without.iter().map(|values| values[i]).sum::<f64>() / n;
        let spread: f64 = without.iter().map(|values| (values[i] - mean).powi(2)).sum();
        (spread * (n - 1.0) / n).sqrt()
    };
    values.iter().enumerate().map(|(i, &value)| Estimate { value, standard_error: error(i) }).collect()
}

/// What is known of a ratio of two uncertain numbers, the lower one of which cannot be negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RatioInterval {
    /// Lower end, at least 0.
    pub low: f64,
    /// Upper end; infinite where the lower number may be 0.
    pub high: f64,
}

/// The ratios a/b, b ≥ 0, that are within 95 % confidence: those t for which a − t b is within [`SIGMAS`] of 0 (Fieller
/// 1954), a and b being independent and normal.
pub fn ratio_interval(a: Estimate, b: Estimate) -> RatioInterval {
    let variance = |x: Estimate| (SIGMAS * x.standard_error).powi(2);
    // (b² − z²σ_b²) t² − 2ab t + (a² − z²σ_a²) ≤ 0.
    let quadratic = b.value.powi(2) - variance(b);
    let constant = a.value.powi(2) - variance(a);
    let half = a.value * b.value;
    let discriminant = half * half - quadratic * constant;
    if quadratic > 0.0 && b.value > 0.0 {
        let root = discriminant.max(0.0).sqrt();
        let ends = [(half - root) / quadratic, (half + root) / quadratic];
        return RatioInterval { low: ends[0].max(0.0), high: ends[1].max(0.0) };
    }
    // b may be 0, so the ratio may be as large as one likes. Its lower end is where a line of slope b + zσ_b begins.
    let low = (a.value - SIGMAS * a.standard_error) / (b.value.max(0.0) + SIGMAS * b.standard_error);
    RatioInterval { low: if low.is_finite() { low.max(0.0) } else { 0.0 }, high: f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, Normal};
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::SeedableRng;

    use super::*;

    /// For a mean the jackknife is the textbook's standard error.
    #[test]
    fn of_a_mean_it_is_the_standard_error() {
        let data = [1.0, 4.0, 2.0, 7.0, 3.5];
        let mean = |left_out: Option<usize>| {
            let kept: Vec<f64> = (0..5).filter(|&i| Some(i) != left_out).map(|i| data[i]).collect();
            vec![kept.iter().sum::<f64>() / kept.len() as f64]
        };
        let found = jackknife(5, mean)[0];
        let variance = data.iter().map(|x| (x - 3.5_f64).powi(2)).sum::<f64>() / 4.0;
        // A dozen roundings.
        assert!((found.value - 3.5).abs() < 1e-14);
        assert!((found.standard_error - (variance / 5.0).sqrt()).abs() < 1e-14);
        assert_eq!(jackknife(1, |_| vec![2.0])[0].standard_error, f64::INFINITY);
    }

    /// The interval holds the true ratio in 95 % of 4000 cases, ±3 √(0.95·0.05/4000) = ±1.0 %.
    #[test]
    fn intervals_hold_what_they_say() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(5);
        let (a, b, sigma_a, sigma_b) = (3.0, 2.0, 0.4, 0.3);
        let (draw_a, draw_b) = (Normal::new(a, sigma_a).unwrap(), Normal::new(b, sigma_b).unwrap());
        let held = (0..4000).filter(|_| {
            let measured = |value, standard_error| Estimate { value, standard_error };
            let interval = ratio_interval(
                measured(draw_a.sample(&mut random), sigma_a),
                measured(draw_b.sample(&mut random), sigma_b),
            );
            (interval.low..=interval.high).contains(&(a / b))
        });
        let share = held.count() as f64 / 4000.0;
        assert!((share - 0.95).abs() < 0.010_4, "{share}");
    }

    #[test]
    fn a_denominator_that_may_be_zero_leaves_the_ratio_open() {
        let measured = |value, standard_error| Estimate { value, standard_error };
        let open = ratio_interval(measured(4.0, 0.5), measured(0.1, 0.1));
        assert_eq!(open.high, f64::INFINITY);
        assert!((open.low - (4.0 - SIGMAS * 0.5) / (0.1 + SIGMAS * 0.1)).abs() < 1e-12);
        assert_eq!(ratio_interval(measured(-4.0, 0.5), measured(0.0, 0.0)).low, 0.0);
    }
}
