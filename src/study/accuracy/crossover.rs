//! When the walk becomes the better buy.

use super::jackknife::{RatioInterval, ratio_interval};
use super::model::Curve;
use crate::slab::Estimate;

/// The time beyond which the walk has the smaller error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Crossover {
    /// From the beginning: it is not noisier in the same time.
    Always,
    /// After so many seconds.
    At {
        /// T* = (V_walk − V)/B².
        seconds: f64,
        /// It, with 95 % confidence.
        interval: RatioInterval,
    },
    /// No bias was found that it would not have.
    Never {
        /// The earliest that the errors of the figures leave open, s.
        not_before: f64,
    },
}

/// When the walk overtakes a model, by B² of the model and V of both, each with its standard error.
pub fn crossover(bias_squared: Estimate, variance: Estimate, of_walk: Estimate) -> Crossover {
    let ahead = Estimate {
        value: of_walk.value - variance.value,
        standard_error: of_walk.standard_error.hypot(variance.standard_error),
    };
    if ahead.value <= 0.0 {
        return Crossover::Always;
    }
    let interval = ratio_interval(ahead, bias_squared);
    if bias_squared.value <= 0.0 {
        return Crossover::Never { not_before: interval.low };
    }
    Crossover::At { seconds: ahead.value / bias_squared.value, interval }
}

/// The largest relMSE, if there is one, at which the walk is quicker than the model: V_walk B²/(V_walk − V), where both
/// take V_walk/relMSE.
pub fn error_of_crossover(model: &Curve, walk: &Curve) -> f64 {
    let ahead = walk.variance_seconds - model.variance_seconds;
    if ahead <= 0.0 {
        return f64::INFINITY;
    }
    walk.variance_seconds * model.bias_squared / ahead
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exact(value: f64) -> Estimate {
        Estimate { value, standard_error: 0.0 }
    }

    #[test]
    fn both_have_the_same_error_at_the_crossover() {
        let model = Curve { bias_squared: 4e-4, variance_seconds: 0.01 };
        let walk = Curve { bias_squared: 0.0, variance_seconds: 0.05 };
        let found = crossover(exact(4e-4), exact(0.01), exact(0.05));
        let Crossover::At { seconds, interval } = found else { panic!("{found:?}") };
        // A few roundings.
        assert!((seconds / 100.0 - 1.0).abs() < 1e-14);
        assert!((interval.low / 100.0 - 1.0).abs() < 1e-6 && (interval.high / 100.0 - 1.0).abs() < 1e-6);
        assert!((model.at(seconds) / walk.at(seconds) - 1.0).abs() < 1e-14);
        assert!((error_of_crossover(&model, &walk) / walk.at(seconds) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn signs_decide() {
        assert_eq!(crossover(exact(1e-3), exact(0.2), exact(0.1)), Crossover::Always);
        let no_bias = Estimate { value: -1e-6, standard_error: 1e-6 };
        let found = crossover(no_bias, exact(0.01), exact(0.03));
        let Crossover::Never { not_before } = found else { panic!("{found:?}") };
        assert!((not_before - 0.02 / (1.959_964 * 1e-6)).abs() < 1e-3 * not_before);
    }
}
