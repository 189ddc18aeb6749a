//! What a study found, as JSON. Radiance is in W/(m² sr), times in seconds, errors as in relMSE.

use serde_json::{Value, json};

use super::advice::advice;
use super::crossover::Crossover;
use super::results::{CandidateResult, EffectResult, ErrorPart, RegionResult, Results};

/// The object in `summary.json`. At the top, methods are over the whole picture; in `regions` they are on each material.
pub fn json(results: &Results, complete: bool) -> Value {
    let regions = results.reported_regions().map(|r| {
        json!({
            "name": results.regions[r].name,
            "pixels": results.regions[r].pixels.len(),
            "relative_noise": results.reference.noise[r].sqrt(),
            "methods": methods(results, r),
        })
    });
    json!({
        "settings": results.plan.settings,
        "complete": complete,
        "reference": {
            "method": results.reference.candidate.method_name(),
            "profile": results.reference.candidate.profile_name(),
            "spp": results.reference.spp,
            "seconds": results.reference.seconds,
            "relative_noise": results.reference.noise[0].sqrt(),
            "collisions_per_sample": results.reference.collisions,
        },
        "methods": methods(results, 0),
        "regions": regions.collect::<Vec<_>>(),
        "errors": results.parts.iter().map(part).collect::<Vec<_>>(),
        "effects": results.effects.iter().map(effect).collect::<Vec<_>>(),
        "collisions": results.collisions,
        "warnings": results.warnings,
        "advice": advice(results),
        "confidence": 0.95,
    })
}

fn methods(results: &Results, region: usize) -> Vec<Value> {
    results.candidates.iter().map(|result| method(result, &result.by_region[region])).collect()
}

fn method(result: &CandidateResult, region: &RegionResult) -> Value {
    let curve = region.curve();
    let points = region.points.iter().map(|point| {
        json!({
            "seconds": point.seconds,
            "spp": point.spp,
            "relmse": point.relmse.value,
            "relmse_stderr": point.relmse.standard_error,
        })
    });
    let (crossover, seconds, interval) = crossover(region.crossover.as_ref());
    json!({
        "name": result.candidate.method_name(),
        "profile": result.candidate.profile_name(),
        "bias_squared": curve.bias_squared,
        "bias_squared_estimate": region.bias_squared,
        "variance_seconds": curve.variance_seconds,
        "variance_seconds_stderr": region.variance_seconds.standard_error,
        "efficiency": 1.0 / curve.variance_seconds,
        "crossover": crossover,
        "crossover_seconds": seconds,
        "crossover_interval": interval,
        "fitted": {"bias_squared": region.fitted[0], "variance_seconds": region.fitted[1]},
        "noise_falls_as": region.falls_as,
        "points": points.collect::<Vec<_>>(),
        "runs": result.runs,
        "setup_seconds": result.setup_seconds,
        "seconds_spread": result.unsteadiness,
        "tail_index": result.tail,
        "firefly_share": result.firefly_share,
        "nonfinite": result.nonfinite,
        "capped": result.capped,
    })
}

/// In a word, in seconds, and its interval; what is unbounded is `null`.
fn crossover(found: Option<&Crossover>) -> (Value, Option<f64>, Value) {
    match found {
        None => (Value::Null, None, Value::Null),
        Some(Crossover::Always) => (json!("always"), Some(0.0), Value::Null),
        Some(Crossover::Never { not_before }) => (json!("never"), None, json!([not_before, null])),
        // JSON has no infinity: it becomes null.
        Some(Crossover::At { seconds, interval }) => {
            (json!("at"), Some(*seconds), json!([interval.low, interval.high]))
        }
    }
}

fn part(part: &ErrorPart) -> Value {
    json!({
        "kind": part.kind.name(),
        "what": part.title,
        "mean_square": part.square,
    })
}

fn effect(found: &EffectResult) -> Value {
    let [with, without] = found.seconds;
    json!({
        "effect": found.effect.name(),
        "spp": found.spp,
        "seconds_with": with,
        "seconds_without": without,
        "seconds_saved": with - without,
        "error_mean_square": found.square,
        "bias": found.bias,
    })
}
