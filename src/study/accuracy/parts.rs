//! The error taken apart, and what effects are worth.

use super::candidate::Candidate;
use super::effects::Effect;
use super::errors::{Moments, Reference, Region, squared_difference};
use super::evaluate::{BODIES, Known, Runs};
use super::plan::{ANY_DIRECTION, Plan, RUNS_OF_EFFECT, Role, series};
use super::results::{CandidateResult, EffectResult, ErrorPart, PartKind, Results};
use super::store::Store;
use crate::scene::{ProfileChoice, Scene};
use crate::slab::Estimate;

/// Seconds after which the noise of candidates is shown.
pub const SAMPLING_SECONDS: f64 = 10.0;

impl Known {
    fn moments(&self, candidate: Candidate) -> Option<&Moments> {
        self.means.iter().find(|(known, _)| *known == candidate).map(|(_, moments)| moments)
    }

    /// Relative difference of each pixel, mean of the channels.
    fn map(&self, a: &[f64], b: &[f64]) -> Vec<f64> {
        let relative = |i: usize| (a[i] - b[i]) * self.truth.weight[i].sqrt();
        (0..a.len() / 3)
            .map(|p| (relative(3 * p) + relative(3 * p + 1) + relative(3 * p + 2)) / 3.0)
            .collect()
    }

    /// The error taken apart by exchanging one approximation after another; `seeds` runs of each are looked for.
    pub fn parts(&self, store: &Store, seeds: usize, bodies: &Region, results: &Results) -> Vec<ErrorPart> {
        let mut parts = Vec::new();
        let truth = results.reference.candidate;
        if let Some((exact, result)) =
            self.moments(Candidate::TABULATED).zip(results.of(Candidate::TABULATED))
            && truth != Candidate::TABULATED
        {
            parts.push(ErrorPart {
                kind: PartKind::Geometry,
                title: format!("{} − {}", Candidate::TABULATED.name(), truth.name()),
                square: result.by_region[BODIES].bias_squared,
                map: self.map(&exact.mean, &self.truth.mean),
            });
        }
        let exact = self.moments(Candidate::TABULATED);
        for (candidate, moments) in self.means.iter().filter(|(candidate, _)| is_model(*candidate)) {
            let Some(exact) = exact else { break };
            parts.push(ErrorPart {
                kind: PartKind::Profile,
                title: format!("{} − {}", candidate.name(), Candidate::TABULATED.name()),
                square: squared_difference(moments, exact, &self.truth.weight, bodies),
                map: self.map(&moments.mean, &exact.mean),
            });
        }
        let any_direction = Runs::load(store, ANY_DIRECTION, seeds);
        if let Some(directional) = self.moments(Candidate::DIRECTIONAL)
            && any_direction.records.len() >= 2
        {
            let without = any_direction.moments(None);
            parts.push(ErrorPart {
                kind: PartKind::Direction,
                title: format!("{} − the same for light from all sides", Candidate::DIRECTIONAL.name()),
                square: squared_difference(directional, &without, &self.truth.weight, bodies),
                map: self.map(&directional.mean, &without.mean),
            });
        }
        parts.extend(results.candidates.iter().map(|result| self.sampling(result, bodies)));
        parts
    }

    /// The standard deviation after [`SAMPLING_SECONDS`].
    fn sampling(&self, result: &CandidateResult, bodies: &Region) -> ErrorPart {
        let scale = result.seconds / SAMPLING_SECONDS;
        let square = |i: usize| result.variance[i] * scale * self.truth.weight[i];
        let pixels = 0..result.variance.len() / 3;
        let variance = result.by_region[BODIES].variance_seconds * (1.0 / SAMPLING_SECONDS);
        ErrorPart {
            kind: PartKind::Sampling,
            title: format!("{} after {SAMPLING_SECONDS:.0} s", result.candidate.name()),
            square: Estimate { value: bodies.mean(square), ..variance },
            map: pixels
                .map(|p| ((square(3 * p) + square(3 * p + 1) + square(3 * p + 2)) / 3.0).sqrt())
                .collect(),
        }
    }

    /// What the scene is without each effect that it has.
    pub fn effects(&self, scene: &Scene, store: &Store, bodies: &Region, plan: &Plan) -> Vec<EffectResult> {
        let all = series(scene, &plan.settings);
        let load = |wanted: Option<Effect>| {
            let found = all.iter().find(|series| series.role == Role::Effect(wanted))?;
            let runs = Runs::load(store, &found.name(), found.runs);
            (runs.records.len() == RUNS_OF_EFFECT).then_some(runs)
        };
        let Some(with) = load(None) else { return Vec::new() };
        let of_effect = |effect: Effect| {
            let without = load(Some(effect))?;
            let off = without.moments(None);
            let seconds = [&with, &without].map(|runs| runs.mean_record(None, |record| record.end().1));
            let square = Estimate {
                value: self.truth.bias_squared(&off, bodies),
                standard_error: self.truth.error_of_bias_squared(&off, bodies).hypot(noise_of_square(
                    &off,
                    &self.truth,
                    bodies,
                )),
            };
            let spp = without.records.first().map_or(0, |record| record.end().0);
            let bias = [0, 1, 2].map(|channel| self.bias_of_channel(&off, channel, bodies));
            Some(EffectResult { effect, spp, seconds, square, bias })
        };
        Effect::ALL.into_iter().filter_map(of_effect).collect()
    }

    /// Relative error of the mean of a channel.
    fn bias_of_channel(&self, off: &Moments, channel: usize, region: &Region) -> Estimate {
        let sum = |value: &dyn Fn(usize) -> f64| -> f64 {
            region.pixels.iter().map(|&p| value(3 * p + channel)).sum()
        };
        let mean = sum(&|i| self.truth.mean[i]);
        let variance = sum(&|i| off.variance_of_mean(i) + self.truth.variance(i));
        Estimate {
            value: sum(&|i| off.mean[i] - self.truth.mean[i]) / mean,
            standard_error: variance.sqrt() / mean.abs(),
        }
    }
}

fn is_model(candidate: Candidate) -> bool {
    candidate.profile_name().is_some() && candidate.profile != ProfileChoice::Tabulated
}

/// Standard error of B² by the noise of a few runs, as [`squared_difference`] has it.
fn noise_of_square(runs: &Moments, truth: &Reference, region: &Region) -> f64 {
    let variance = region.mean(|i| {
        let noise = runs.variance_of_mean(i);
        let square = ((runs.mean[i] - truth.mean[i]).powi(2) - noise - truth.variance(i)).max(0.0);
        (4.0 * square * noise + 2.0 * noise * noise) * truth.weight[i].powi(2)
    });
    (variance / (3 * region.pixels.len().max(1)) as f64).sqrt()
}
