//! How heavy the tail of the errors is: whether a variance that was measured can be believed.

use serde::Serialize;

/// Below this index the variance of a distribution is infinite.
pub const FINITE_VARIANCE: f64 = 2.0;

/// Share of the errors that make up the tail, and the fewest.
const TAIL: f64 = 1e-3;
const FEWEST: usize = 50;

/// The index α of a tail that falls as P(|e| > x) ∝ x^(−α).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TailIndex {
    /// The index; above 2 the variance is finite. That of a normal distribution grows with how far out one looks.
    pub index: f64,
    /// Its standard error.
    #[serde(rename = "stderr")]
    pub standard_error: f64,
}

impl TailIndex {
    /// True if the variance may well be infinite: what was measured says little about what comes.
    pub fn is_heavy(&self) -> bool {
        self.index < FINITE_VARIANCE
    }
}

/// The estimate of Hill 1975 from the largest thousandth of the squared errors, at least 50: 1/α is the mean of
/// ln(x_i/x_m) over the tail, x_m the largest error that is not in it. `None` if there are too few, or no noise.
pub fn tail_index(mut squared_errors: Vec<f64>) -> Option<TailIndex> {
    let count = ((TAIL * squared_errors.len() as f64) as usize).max(FEWEST);
    if squared_errors.len() <= 2 * count {
        return None;
    }
    let (above, &mut threshold, _) = squared_errors.select_nth_unstable_by(count, |a, b| b.total_cmp(a));
    if threshold <= 0.0 {
        return None;
    }
    // Half, as the logarithm of a square is twice that of the error.
    let mean = above.iter().map(|x| 0.5 * (x / threshold).ln()).sum::<f64>() / count as f64;
    let index = 1.0 / mean;
    index.is_finite().then(|| TailIndex { index, standard_error: index / (count as f64).sqrt() })
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, Normal, Pareto};
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::SeedableRng;

    use super::*;

    /// Of exact power laws the estimate is α ± α/√m.
    #[test]
    fn power_laws_are_recognised() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
        for alpha in [0.8, 1.5, 2.5, 5.0] {
            let law = Pareto::new(1.0, alpha).unwrap();
            let squares = (0..400_000).map(|_| f64::powi(law.sample(&mut random), 2)).collect();
            let found = tail_index(squares).unwrap();
            assert!((found.standard_error * 20.0 - found.index).abs() < 1e-12);
            assert!((found.index - alpha).abs() < 3.0 * found.standard_error, "{alpha}: {found:?}");
            assert_eq!(found.is_heavy(), alpha < 2.0);
        }
    }

    #[test]
    fn normal_noise_is_not_heavy_and_none_is_nothing() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(2);
        let normal = Normal::new(0.0, 1e-3).unwrap();
        let squares = (0..100_000).map(|_| f64::powi(normal.sample(&mut random), 2)).collect();
        assert!(!tail_index(squares).unwrap().is_heavy());
        assert_eq!(tail_index(vec![0.0; 10_000]), None);
        assert_eq!(tail_index(vec![1.0; 20]), None);
    }
}
