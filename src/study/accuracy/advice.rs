//! What to use, in plain words.

use super::candidate::Candidate;
use super::crossover::error_of_crossover;
use super::model::Curve;
use super::results::{CandidateResult, Results};
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
        let choice = |found: &CandidateResult| Choice {
            candidate: found.candidate,
            curve: found.by_region[r].curve(),
            hidden_bias: found.by_region[r].hidden_bias_squared().sqrt(),
        };
        let choices: Vec<Choice> = results.candidates.iter().map(choice).collect();
        format!("{}: {}", results.regions[r].name, sentence(&choices))
    };
    regions.into_iter().map(of_region).collect()
}

/// What there is to choose from.
#[derive(Clone, Copy, Debug)]
pub struct Choice {
    /// The candidate.
    pub candidate: Candidate,
    /// Its relMSE over time.
    pub curve: Curve,
    /// The largest relative bias that it may have although none was found.
    pub hidden_bias: f64,
}

impl Choice {
    fn time(&self) -> f64 {
        self.curve.seconds_until(WANTED * WANTED).unwrap_or(f64::INFINITY)
    }
}

/// What to use for an error of [`WANTED`], and below which error the walk.
pub fn sentence(choices: &[Choice]) -> String {
    let best = choices.iter().min_by(|a, b| a.time().total_cmp(&b.time()));
    let Some(best) = best.filter(|best| best.time().is_finite()) else {
        return nothing_reaches(choices);
    };
    let mut text = format!(
        "for {} error on this object use {}: about {}",
        percent(WANTED),
        best.candidate.in_words(),
        seconds_in_words(best.time())
    );
    if let Some((other, error)) = walk_is_quicker_below(choices) {
        text.push_str(&match error {
            0.0 => "; no error was found below which the walk is quicker".into(),
            f64::INFINITY => "; it is the quickest for every error".into(),
            _ if best.candidate == Candidate::WALK => {
                format!("; above {} use {}", percent(error), other.in_words())
            }
            _ => format!("; below {} use the walk", percent(error)),
        });
    }
    if best.hidden_bias > WANTED {
        let hidden = percent(best.hidden_bias);
        text.push_str(&format!(
            " (a bias of up to {hidden} may be hidden in the noise: give the study more time)"
        ));
    }
    text
}

fn nothing_reaches(choices: &[Choice]) -> String {
    let least = choices.iter().min_by(|a, b| a.curve.bias_squared.total_cmp(&b.curve.bias_squared));
    let Some(least) = least else { return "nothing was studied".into() };
    format!(
        "none of the methods studied reaches {} error on this object; {} comes closest, with a bias of {}",
        percent(WANTED),
        least.candidate.in_words(),
        percent(least.curve.bias_squared.sqrt())
    )
}

/// The relative error below which the walk is quicker than all others, and which of them is overtaken last; `None` if
/// there is no walk, or nothing else.
fn walk_is_quicker_below(choices: &[Choice]) -> Option<(Candidate, f64)> {
    let walk = choices.iter().find(|choice| choice.candidate == Candidate::WALK)?;
    let others = choices.iter().filter(|choice| choice.candidate != Candidate::WALK);
    let errors = others.map(|other| (other.candidate, error_of_crossover(&other.curve, &walk.curve).sqrt()));
    errors.min_by(|(_, a), (_, b)| a.total_cmp(b))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn choice(candidate: Candidate, bias: f64, variance_seconds: f64) -> Choice {
        Choice { candidate, curve: Curve { bias_squared: bias * bias, variance_seconds }, hidden_bias: 0.0 }
    }

    #[test]
    fn the_cheapest_that_is_good_enough_is_named() {
        let tabulated = choice(Candidate::TABULATED, 0.006, 2e-4);
        let diffuse = choice(Candidate::DIFFUSE, 0.2, 1e-6);
        let walk = choice(Candidate::WALK, 0.0, 1e-3);
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
        let biased = choice(Candidate::TABULATED, 0.03, 2e-4);
        let walk = choice(Candidate::WALK, 0.0, 0.04);
        // It overtakes at 0.03/√(1 − 0.005).
        assert_eq!(
            sentence(&[biased, walk]),
            "for 1 % error on this object use the walk: about 6.7 min; above 3 % use bssrdf with the profile tabulated"
        );
        assert!(
            sentence(&[biased, choice(Candidate::WALK, 0.0, 1e-4)])
                .ends_with("it is the quickest for every error")
        );
    }

    #[test]
    fn a_bias_that_may_be_hidden_is_said() {
        let hidden = Choice { hidden_bias: 0.021, ..choice(Candidate::TABULATED, 0.0, 2e-4) };
        assert!(sentence(&[hidden]).ends_with(
            "about 2 s (a bias of up to 2.1 % may be hidden in the noise: give the study more time)"
        ));
        let known = Choice { hidden_bias: 0.009, ..hidden };
        assert!(sentence(&[known]).ends_with("about 2 s"));
    }

    #[test]
    fn what_was_not_found_is_said() {
        let unbiased = choice(Candidate::TABULATED, 0.0, 2e-4);
        let walk = choice(Candidate::WALK, 0.0, 0.04);
        assert!(sentence(&[unbiased, walk]).ends_with("no error was found below which the walk is quicker"));
        assert_eq!(
            sentence(&[choice(Candidate::DIFFUSE, 0.2, 1e-6)]),
            "none of the methods studied reaches 1 % error on this object; diffuse comes closest, with a bias of 20 %"
        );
    }
}
