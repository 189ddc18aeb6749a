//! What to use, in plain words.

use super::candidate::Candidate;
use super::crossover::error_of_crossover;
use super::model::Curve;
use super::results::Results;
use crate::study::numbers::{percent, seconds_in_words};

/// The relative error that the advice is for.
pub const WANTED: f64 = 0.01;

/// A sentence for each translucent material; for all bodies together where none is seen by enough pixels.
pub fn advice(results: &Results) -> Vec<String> {
    let mut regions: Vec<usize> =
        (0..results.regions.len()).filter(|&r| results.regions[r].material.is_some()).collect();
    if regions.is_empty() {
        regions.push(super::evaluate::BODIES);
    }
    let of_region = |r: usize| {
        let curves: Vec<(Candidate, Curve)> =
            results.candidates.iter().map(|found| (found.candidate, found.by_region[r].curve())).collect();
        format!("{}: {}", results.regions[r].name, sentence(&curves))
    };
    regions.into_iter().map(of_region).collect()
}

/// What to use for an error of [`WANTED`], and below which error the walk.
pub fn sentence(curves: &[(Candidate, Curve)]) -> String {
    let time = |curve: &Curve| curve.seconds_until(WANTED * WANTED).unwrap_or(f64::INFINITY);
    let best = curves.iter().min_by(|(_, a), (_, b)| time(a).total_cmp(&time(b)));
    let Some((candidate, curve)) = best.filter(|(_, curve)| time(curve).is_finite()) else {
        return nothing_reaches(curves);
    };
    let use_this = format!(
        "for {} error on this object use {}: about {}",
        percent(WANTED),
        candidate.in_words(),
        seconds_in_words(time(curve))
    );
    match walk_is_quicker_below(curves) {
        None => use_this,
        Some((_, error)) if error == 0.0 => {
            format!("{use_this}; no error was found below which the walk is quicker")
        }
        Some((_, error)) if error.is_infinite() => format!("{use_this}; it is the quickest for every error"),
        Some((other, error)) if *candidate == Candidate::WALK => {
            format!("{use_this}; above {} use {}", percent(error), other.in_words())
        }
        Some((_, error)) => format!("{use_this}; below {} use the walk", percent(error)),
    }
}

fn nothing_reaches(curves: &[(Candidate, Curve)]) -> String {
    let least = curves.iter().min_by(|(_, a), (_, b)| a.bias_squared.total_cmp(&b.bias_squared));
    let Some((candidate, curve)) = least else { return "nothing was studied".into() };
    format!(
        "none of the methods studied reaches {} error on this object; {} comes closest, with a bias of {}",
        percent(WANTED),
        candidate.in_words(),
        percent(curve.bias_squared.sqrt())
    )
}

/// The relative error below which the walk is quicker than all others, and which of them is overtaken last; `None` if
/// there is no walk, or nothing else.
fn walk_is_quicker_below(curves: &[(Candidate, Curve)]) -> Option<(Candidate, f64)> {
    let (_, walk) = curves.iter().find(|(candidate, _)| *candidate == Candidate::WALK)?;
    let others = curves.iter().filter(|(candidate, _)| *candidate != Candidate::WALK);
    let errors = others.map(|(candidate, curve)| (*candidate, error_of_crossover(curve, walk).sqrt()));
    errors.min_by(|(_, a), (_, b)| a.total_cmp(b))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(bias: f64, variance_seconds: f64) -> Curve {
        Curve { bias_squared: bias * bias, variance_seconds }
    }

    #[test]
    fn the_cheapest_that_is_good_enough_is_named() {
        let tabulated = (Candidate::TABULATED, curve(0.006, 2e-4));
        let diffuse = (Candidate::DIFFUSE, curve(0.2, 1e-6));
        let walk = (Candidate::WALK, curve(0.0, 1e-3));
        // 2e-4/(1e-4 − 3.6e-5) = 3.1 s against 10 s; the walk overtakes at √(1e-3·3.6e-5/8e-4) = 0.67 %.
        assert_eq!(
            sentence(&[diffuse, tabulated, walk]),
            "for 1 % error on this object use bssrdf with the profile tabulated: about 3.1 s; below 0.67 % use the walk"
        );
        assert_eq!(
            sentence(&[tabulated]),
            "for 1 % error on this object use bssrdf with the profile tabulated: about 3.1 s"
        );
    }

    #[test]
    fn the_walk_is_named_where_it_is_needed() {
        let biased = (Candidate::TABULATED, curve(0.03, 2e-4));
        let walk = (Candidate::WALK, curve(0.0, 0.04));
        // It overtakes at 0.03/√(1 − 0.005).
        assert_eq!(
            sentence(&[biased, walk]),
            "for 1 % error on this object use the walk: about 7 min; above 3 % use bssrdf with the profile tabulated"
        );
        assert!(
            sentence(&[biased, (Candidate::WALK, curve(0.0, 1e-4))])
                .ends_with("it is the quickest for every error")
        );
    }

    #[test]
    fn what_was_not_found_is_said() {
        let unbiased = (Candidate::TABULATED, curve(0.0, 2e-4));
        let walk = (Candidate::WALK, curve(0.0, 0.04));
        assert!(sentence(&[unbiased, walk]).ends_with("no error was found below which the walk is quicker"));
        assert_eq!(
            sentence(&[(Candidate::DIFFUSE, curve(0.2, 1e-6))]),
            "none of the methods studied reaches 1 % error on this object; diffuse comes closest, with a bias of 20 %"
        );
    }
}
