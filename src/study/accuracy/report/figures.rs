//! Charts of a study.

use std::ops::Range;

use super::super::jackknife::SIGMAS;
use super::super::results::{CandidateResult, Results};
use crate::study::plot::{Axis, Dot, Dots, Line, Panel};

/// Points of a curve.
const STEPS: usize = 120;
/// Errors that charts show at most, and at least, %.
const ERRORS: Range<f64> = 0.01..3000.0;
/// Charts go on so many times as long as the longest run took: what comes later follows from B² and V.
const BEYOND: f64 = 100.0;

/// Error over time, a line for each candidate, dots where it was measured.
pub fn error_over_time(results: &Results, region: usize) -> Panel {
    let times = range_of_times(results, region);
    let lines = results.candidates.iter().map(|result| {
        let curve = result.by_region[region].curve();
        line(result, logarithmic(&times).map(|t| (t, 100.0 * curve.at(t).sqrt())).collect())
    });
    let lines: Vec<Line> = lines.collect();
    let dots: Vec<Dots> = results.candidates.iter().map(|result| dots(result, region)).collect();
    let shown = lines.iter().flat_map(|line| line.points.iter().map(|point| point.1));
    let shown = shown.chain(dots.iter().flat_map(|dots| dots.points.iter().map(|dot| dot.y)));
    Panel {
        title: results.regions[region].name.clone(),
        x: Axis { label: "time T [s]".into(), range: times, log: true },
        y: Axis { label: "relative error √relMSE [%]".into(), range: extent(shown, &ERRORS), log: true },
        lines,
        dots,
    }
}

/// The time that an error takes, up to three times the largest bias.
pub fn time_over_error(results: &Results, region: usize) -> Panel {
    let biases = results.candidates.iter().map(|result| result.by_region[region].curve().bias_squared);
    let errors = 0.1..(300.0 * biases.fold(0.0, f64::max).sqrt()).clamp(20.0, ERRORS.end);
    let lines = results.candidates.iter().map(|result| {
        let curve = result.by_region[region].curve();
        let points = logarithmic(&errors).filter_map(|error| {
            let seconds = curve.seconds_until((0.01 * error).powi(2))?;
            Some((error, seconds))
        });
        line(result, points.collect())
    });
    let lines: Vec<Line> = lines.collect();
    let times = lines.iter().flat_map(|line| line.points.iter().map(|point| point.1));
    Panel {
        title: results.regions[region].name.clone(),
        x: Axis { label: "relative error wanted √relMSE [%]".into(), range: errors, log: true },
        y: Axis { label: "time needed [s]".into(), range: extent(times, &(1e-3..1e5)), log: true },
        lines,
        dots: Vec::new(),
    }
}

fn line(result: &CandidateResult, points: Vec<(f64, f64)>) -> Line {
    Line { name: result.candidate.name(), style: result.candidate.style(), points }
}

fn dots(result: &CandidateResult, region: usize) -> Dots {
    let dot = |point: &super::super::results::MeanPoint| {
        let error = point.relmse.value.max(0.0).sqrt();
        Dot {
            x: point.seconds,
            y: 100.0 * error,
            error: 100.0 * SIGMAS * 0.5 * point.relmse.standard_error / error,
        }
    };
    Dots {
        name: String::new(),
        color: result.candidate.style().color,
        points: result.by_region[region].points.iter().map(dot).collect(),
    }
}

fn range_of_times(results: &Results, region: usize) -> Range<f64> {
    let points = results.candidates.iter().flat_map(|result| &result.by_region[region].points);
    let times = points.map(|point| point.seconds);
    let Range { start, end } = extent(times, &(1e-6..1e9));
    start..BEYOND * end
}

/// Values spread evenly over the logarithm of `range`.
fn logarithmic(range: &Range<f64>) -> impl Iterator<Item = f64> + use<> {
    let (start, ratio) = (range.start, range.end / range.start);
    (0..=STEPS).map(move |i| start * ratio.powf(i as f64 / STEPS as f64))
}

/// A range that holds the values, with some space, within `limits`.
fn extent(values: impl Iterator<Item = f64>, limits: &Range<f64>) -> Range<f64> {
    let inside = values.filter(|x| *x > 0.0 && x.is_finite());
    let (low, high) = inside.fold((f64::INFINITY, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
    if low > high {
        return limits.clone();
    }
    let low = (0.7 * low).clamp(limits.start, 0.5 * limits.end);
    low..(1.4 * high).clamp(2.0 * low, limits.end.max(2.0 * low))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_never_empty() {
        for values in [vec![], vec![0.0, -1.0], vec![1e300], vec![1e-300], vec![1.0, f64::NAN, 5.0]] {
            let range = extent(values.into_iter(), &ERRORS);
            assert!(range.end >= 1.9 * range.start && range.start >= ERRORS.start, "{range:?}");
        }
    }
}
