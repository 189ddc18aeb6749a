//! The error of a picture as its rendering goes on: relMSE(T) = B² + V/T.
//!
//! B² is the bias, the error that no time removes; V, in seconds, is the noise that is left after a second.

/// A point of the curve: seconds, and relMSE.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// Seconds spent.
    pub seconds: f64,
    /// relMSE against the truth.
    pub relmse: f64,
}

/// A curve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Curve {
    /// B², at least 0.
    pub bias_squared: f64,
    /// V, seconds, at least 0.
    pub variance_seconds: f64,
}

impl Curve {
    /// relMSE after `seconds`.
    pub fn at(&self, seconds: f64) -> f64 {
        self.bias_squared + self.variance_seconds / seconds
    }

    /// Seconds until relMSE is `wanted`; `None`: never.
    pub fn seconds_until(&self, wanted: f64) -> Option<f64> {
        (wanted > self.bias_squared).then(|| self.variance_seconds / (wanted - self.bias_squared))
    }
}

/// The curve through `points`: least squares of the relative deviations, as each point is uncertain in proportion to
/// itself. Points that are not above 0 (a difference of noises can be) are left out.
pub fn fit(points: &[CurvePoint]) -> Curve {
    let mut sums = [0.0; 5];
    for point in points.iter().filter(|point| point.relmse > 0.0 && point.seconds > 0.0) {
        let (weight, x) = (point.relmse.powi(-2), 1.0 / point.seconds);
        let terms = [1.0, x, x * x, point.relmse, x * point.relmse];
        sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += weight * term);
    }
    let [one, x, xx, y, xy] = sums;
    let determinant = one * xx - x * x;
    let free = Curve {
        bias_squared: (y * xx - x * xy) / determinant,
        variance_seconds: (one * xy - x * y) / determinant,
    };
    if free.bias_squared >= 0.0 && free.variance_seconds >= 0.0 {
        return free;
    }
    // The least squares within the quadrant lie on the edge where the free one is beyond it.
    if free.variance_seconds < 0.0 {
        return Curve { bias_squared: positive(y / one), variance_seconds: 0.0 };
    }
    Curve { bias_squared: 0.0, variance_seconds: positive(xy / xx) }
}

/// `value`, or 0 where there was nothing to fit.
fn positive(value: f64) -> f64 {
    if value.is_finite() { value.max(0.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, Normal};
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::SeedableRng;

    use super::super::jackknife::jackknife;
    use super::*;

    const TIMES: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];

    fn points(value: impl FnMut(f64) -> f64) -> Vec<CurvePoint> {
        let mut value = value;
        TIMES.map(|seconds| CurvePoint { seconds, relmse: value(seconds) }).to_vec()
    }

    #[test]
    fn points_on_a_curve_give_the_curve() {
        for curve in [
            Curve { bias_squared: 1e-3, variance_seconds: 0.02 },
            Curve { bias_squared: 0.0, variance_seconds: 7.0 },
            Curve { bias_squared: 0.5, variance_seconds: 0.0 },
        ] {
            let found = fit(&points(|t| curve.at(t)));
            let scale = curve.at(1.0);
            // A condition number of the 2 × 2 system of about 10, and a dozen roundings.
            assert!((found.bias_squared - curve.bias_squared).abs() < 1e-13 * scale, "{found:?}");
            assert!((found.variance_seconds - curve.variance_seconds).abs() < 1e-13 * scale, "{found:?}");
        }
        assert_eq!(fit(&[]), Curve::default());
    }

    #[test]
    fn neither_number_is_negative() {
        assert_eq!(fit(&points(|t| 1.0 / (t * t))).bias_squared, 0.0);
        let rising = fit(&points(|t| t));
        assert!(rising.variance_seconds == 0.0 && rising.bias_squared > 0.0);
    }

    #[test]
    fn time_and_error_are_each_others_inverse() {
        let curve = Curve { bias_squared: 1e-4, variance_seconds: 0.5 };
        // A rounding or two of the difference, which is a tenth of its terms.
        assert!((curve.seconds_until(curve.at(100.0)).unwrap() / 100.0 - 1.0).abs() < 1e-14);
        assert_eq!(curve.seconds_until(1e-4), None);
    }

    /// Sixteen noisy runs, 200 times: the truth lies within 2σ by the jackknife in about 95 % of cases. At 16 runs the
    /// t distribution holds 93.6 % within 2σ; 3 standard deviations of a share of 200 are 5.2 %.
    #[test]
    fn truth_lies_within_the_errors_stated() {
        let truth = Curve { bias_squared: 2e-3, variance_seconds: 1e-2 };
        let noise = Normal::new(1.0, 0.1).unwrap();
        let mut random = Xoshiro256PlusPlus::seed_from_u64(9);
        let mut held = [0; 2];
        for _ in 0..200 {
            let runs: Vec<Vec<CurvePoint>> =
                (0..16).map(|_| points(|t| truth.at(t) * noise.sample(&mut random))).collect();
            let found = jackknife(16, |left_out| {
                let kept = || (0..16).filter(|&k| Some(k) != left_out).map(|k| &runs[k]);
                let count = kept().count() as f64;
                let mean: Vec<CurvePoint> = (0..TIMES.len())
                    .map(|i| CurvePoint {
                        seconds: TIMES[i],
                        relmse: kept().map(|run| run[i].relmse).sum::<f64>() / count,
                    })
                    .collect();
                let curve = fit(&mean);
                vec![curve.bias_squared, curve.variance_seconds]
            });
            for (i, expected) in [truth.bias_squared, truth.variance_seconds].into_iter().enumerate() {
                held[i] += usize::from((found[i].value - expected).abs() < 2.0 * found[i].standard_error);
            }
        }
        for held in held {
            let share = held as f64 / 200.0;
            assert!((share - 0.936).abs() < 0.052, "{share}");
        }
    }
}
