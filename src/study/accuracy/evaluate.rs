//! From the runs on the disk to figures.

use super::candidate::Candidate;
use super::collisions::expected;
use super::crossover::crossover;
use super::errors::{Moments, Reference, Region, channels, picture};
use super::jackknife::{SIGMAS, jackknife};
use super::model::{CurvePoint, fit};
use super::plan::{PARTS_OF_HALF, Plan, REFERENCE};
use super::results::{CandidateResult, MeanPoint, ReferenceResult, RegionResult, Results};
use super::store::{Record, Store};
use super::tail::{TailIndex, tail_index};
use crate::scene::Scene;
use crate::slab::Estimate;

/// Index of the region of all translucent bodies.
pub const BODIES: usize = 1;

/// Beyond so many σ the reference disagrees with what renders it.
const DISAGREES: f64 = 4.0;

/// A spread of the seconds of runs above this share is said.
const UNSTEADY: f64 = 0.2;

/// Runs of one kind.
pub struct Runs {
    /// What is known of each.
    pub records: Vec<Record>,
    /// The channels of the picture of each.
    pub values: Vec<Vec<f64>>,
}

impl Runs {
    /// Those of `count` runs that are done.
    pub fn load(store: &Store, name: &str, count: usize) -> Self {
        let runs = (0..count).filter_map(|run| store.run(name, run));
        let (records, values) = runs.map(|run| (run.record, channels(&run.picture))).unzip();
        Self { records, values }
    }

    /// Mean and variance, with one run left out.
    pub fn moments(&self, left_out: Option<usize>) -> Moments {
        let kept = self.values.iter().enumerate().filter(move |(k, _)| Some(*k) != left_out);
        Moments::of(kept.map(|(_, values)| values))
    }

    /// Mean of a value over the runs, with one left out.
    pub fn mean_record(&self, left_out: Option<usize>, value: impl Fn(&Record) -> f64) -> f64 {
        let kept = self.records.iter().enumerate().filter(|(k, _)| Some(*k) != left_out);
        let values: Vec<f64> = kept.map(|(_, record)| value(record)).collect();
        values.iter().sum::<f64>() / values.len().max(1) as f64
    }
}

/// What it took to make the reference.
#[derive(Clone, Copy, Debug, Default)]
pub struct Effort {
    spp: u64,
    seconds: f64,
    collisions: u64,
}

/// The reference; `None` while a part of it is missing.
pub fn reference(store: &Store) -> Option<(Reference, Effort)> {
    let parts = Runs::load(store, REFERENCE, 2 * PARTS_OF_HALF);
    if parts.records.len() < 2 * PARTS_OF_HALF {
        return None;
    }
    let mut effort = Effort::default();
    for record in &parts.records {
        let (spp, seconds) = record.end();
        effort.spp += spp;
        effort.seconds += seconds;
        effort.collisions += record.collisions;
    }
    Some((Reference::new(&parts.values), effort))
}

/// What can be said of the runs that are there, with `oddities` of the scene among the warnings; `None` if the reference, or any candidate, is missing.
pub fn evaluate(
    scene: &Scene,
    plan: &Plan,
    store: &Store,
    regions: &[Region],
    oddities: &[String],
) -> Option<Results> {
    let settings = &plan.settings;
    let (truth, effort) = reference(store)?;
    let (width, height) = (settings.width, settings.height);
    let mut results = Results {
        plan: plan.clone(),
        regions: regions.to_vec(),
        reference: ReferenceResult {
            candidate: settings.reference(),
            spp: effort.spp,
            seconds: effort.seconds,
            collisions: (settings.reference() == Candidate::WALK).then(|| {
                effort.collisions as f64 / (effort.spp as f64 * regions[BODIES].pixels.len() as f64)
            }),
            noise: regions.iter().map(|region| truth.noise(region)).collect(),
            picture: picture(width, height, &truth.mean),
            variance: (0..truth.mean.len()).map(|i| truth.variance(i)).collect(),
        },
        candidates: Vec::new(),
        parts: Vec::new(),
        effects: Vec::new(),
        collisions: expected(scene),
        warnings: Vec::new(),
    };
    let mut known = Known { truth, truth_by: settings.reference(), means: Vec::new() };
    for candidate in settings.candidates() {
        let runs = Runs::load(store, &candidate.name(), settings.seeds);
        if runs.records.len() >= 2 {
            let moments = runs.moments(None);
            results.candidates.push(known.candidate(candidate, &runs, &moments, regions, (width, height)));
            known.means.push((candidate, moments));
        }
    }
    if results.candidates.is_empty() {
        return None;
    }
    add_crossovers(&mut results);
    results.parts = known.parts(store, settings.seeds, &regions[BODIES], &results);
    results.effects = known.effects(scene, store, &regions[BODIES], plan);
    results.warnings = oddities.iter().cloned().chain(warnings(&results)).collect();
    Some(results)
}

/// What is needed to judge runs.
pub struct Known {
    /// The reference.
    pub truth: Reference,
    /// What rendered it.
    pub truth_by: Candidate,
    /// Mean and variance of the candidates so far.
    pub means: Vec<(Candidate, Moments)>,
}

impl Known {
    fn candidate(
        &self,
        candidate: Candidate,
        runs: &Runs,
        moments: &Moments,
        regions: &[Region],
        (width, height): (u32, u32),
    ) -> CandidateResult {
        let seconds = runs.mean_record(None, |record| record.end().1);
        let spread = jackknife(runs.records.len(), |left_out| {
            vec![runs.mean_record(left_out, |record| record.end().1)]
        })[0];
        let deviations = || {
            runs.values.iter().flat_map(|values| {
                (0..values.len()).map(|i| (values[i] - moments.mean[i]).powi(2) * self.truth.weight[i])
            })
        };
        CandidateResult {
            candidate,
            runs: runs.records.len(),
            setup_seconds: runs.mean_record(None, |record| record.setup_seconds),
            spp: runs.records.first().map_or(0, |record| record.end().0),
            seconds,
            unsteadiness: spread.standard_error * (runs.records.len() as f64).sqrt() / seconds,
            picture: picture(width, height, &moments.mean),
            variance: moments.variance.clone(),
            tail: tail_index(deviations().collect()),
            firefly_share: firefly_share(&moments.variance, &self.truth.weight),
            nonfinite: runs.records.iter().map(|record| record.nonfinite).sum(),
            capped: runs.records.iter().map(|record| record.capped).sum(),
            by_region: self.by_region(candidate == self.truth_by, runs, moments, regions),
        }
    }

    fn by_region(
        &self,
        is_truth: bool,
        runs: &Runs,
        moments: &Moments,
        regions: &[Region],
    ) -> Vec<RegionResult> {
        let levels = runs.records.iter().map(|record| record.points.len()).min().unwrap_or(0);
        // For each region: B², V, B² and V fitted, relMSE of each level.
        let width = 4 + levels;
        let figures = jackknife(runs.records.len(), |left_out| {
            let moments = runs.moments(left_out);
            let seconds = runs.mean_record(left_out, |record| record.end().1);
            regions
                .iter()
                .enumerate()
                .flat_map(|(r, region)| {
                    let points = mean_points(runs, left_out, r, levels);
                    let curve = fit(&points);
                    let mut values = vec![
                        self.truth.bias_squared(&moments, region),
                        self.truth.noise_of_run(&moments, region) * seconds,
                        curve.bias_squared,
                        curve.variance_seconds,
                    ];
                    values.extend(points.iter().map(|point| point.relmse));
                    values
                })
                .collect()
        });
        let of_region = |(r, region): (usize, &Region)| {
            let of = &figures[r * width..(r + 1) * width];
            let by_reference = self.truth.error_of_bias_squared(moments, region);
            let bias_squared = Estimate { standard_error: of[0].standard_error.hypot(by_reference), ..of[0] };
            let points = mean_points(runs, None, r, levels);
            let spp = |level: usize| runs.records[0].points[level].spp;
            let point = |(level, point): (usize, &CurvePoint)| MeanPoint {
                spp: spp(level),
                seconds: point.seconds,
                relmse: of[4 + level],
            };
            RegionResult {
                bias_squared,
                is_truth,
                variance_seconds: of[1],
                fitted: [of[2], of[3]],
                falls_as: falls_as(&points, bias_squared.value),
                points: points.iter().enumerate().map(point).collect(),
                crossover: None,
            }
        };
        regions.iter().enumerate().map(of_region).collect()
    }
}

fn mean_points(runs: &Runs, left_out: Option<usize>, region: usize, levels: usize) -> Vec<CurvePoint> {
    let point = |level: usize| CurvePoint {
        seconds: runs.mean_record(left_out, |record| record.points[level].seconds),
        relmse: runs.mean_record(left_out, |record| {
            record.points[level].relmse.get(region).copied().unwrap_or(f64::NAN)
        }),
    };
    (0..levels).map(point).collect()
}

/// The exponent with which relMSE less the bias falls from the first point to the last; NaN where the bias hides it.
fn falls_as(points: &[CurvePoint], bias_squared: f64) -> f64 {
    let [Some(first), Some(last)] = [points.first(), points.last()] else { return f64::NAN };
    let noise = |point: &CurvePoint| point.relmse - bias_squared.max(0.0);
    (noise(first) / noise(last)).ln() / (last.seconds / first.seconds).ln()
}

fn firefly_share(variance: &[f64], weight: &[f64]) -> f64 {
    let mut terms: Vec<f64> = variance.iter().zip(weight).map(|(v, w)| v * w).collect();
    let total: f64 = terms.iter().sum();
    if terms.is_empty() || total <= 0.0 {
        return 0.0;
    }
    let noisiest = terms.len().div_ceil(1000);
    terms.select_nth_unstable_by(noisiest - 1, |a, b| b.total_cmp(a));
    terms[..noisiest].iter().sum::<f64>() / total
}

fn add_crossovers(results: &mut Results) {
    let Some(walk) = results.of(Candidate::WALK) else { return };
    let of_walk: Vec<Estimate> = walk.by_region.iter().map(|region| region.variance_seconds).collect();
    for result in results.candidates.iter_mut().filter(|result| result.candidate != Candidate::WALK) {
        for (region, of_walk) in result.by_region.iter_mut().zip(&of_walk) {
            region.crossover = Some(crossover(region.bias_squared, region.variance_seconds, *of_walk));
        }
    }
}

fn warnings(results: &Results) -> Vec<String> {
    let skipped = results.plan.skipped.iter();
    let mut warnings: Vec<String> =
        skipped.map(|(name, reason)| format!("{name} is not in the study: {reason}")).collect();
    let seeds = results.plan.settings.seeds;
    warnings.extend(results.candidates.iter().flat_map(|result| warnings_of(result, seeds)));
    warnings.extend(unsteadiness(&results.candidates));
    if results.reference.candidate != Candidate::WALK {
        warnings.push(format!(
            "the reference is {}, not the random walk: errors are differences from it, not from the truth",
            results.reference.candidate.name()
        ));
    }
    warnings
}

fn warnings_of(result: &CandidateResult, seeds: usize) -> Vec<String> {
    let check = result.by_region[0].bias_squared;
    let disagreement = (check.value / check.standard_error).abs();
    let found = [
        result.tail.filter(TailIndex::is_heavy).map(|tail| {
            format!(
                "the tail of its noise has the index {:.1} ± {:.1}, below 2: rare bright samples decide, and its variance, and all that follows from it, is not to be trusted",
                tail.index,
                SIGMAS * tail.standard_error
            )
        }),
        (result.by_region[0].is_truth && disagreement > DISAGREES).then(|| {
            format!(
                "its runs and the reference, which are rendered alike, differ by more than their noise explains, {disagreement:.1} σ: some light is found so seldom that more time is needed"
            )
        }),
        (result.runs < seeds).then(|| format!("{} of {seeds} runs are done", result.runs)),
        (result.nonfinite > 0)
            .then(|| format!("{} samples were not finite and were left black", result.nonfinite)),
        (result.capped > 0)
            .then(|| format!("{} paths were cut by the limit on their length", result.capped)),
    ];
    let name = result.candidate.name();
    found.into_iter().flatten().map(|warning| format!("{name}: {warning}")).collect()
}

fn unsteadiness(candidates: &[CandidateResult]) -> Option<String> {
    let unsteady: Vec<&CandidateResult> =
        candidates.iter().filter(|result| result.unsteadiness > UNSTEADY).collect();
    let most = unsteady.iter().map(|result| result.unsteadiness).fold(0.0, f64::max);
    let names: Vec<String> = unsteady.iter().map(|result| result.candidate.name()).collect();
    (!names.is_empty()).then(|| {
        format!(
            "the same work took times that differ by up to {:.0} % (one σ): the machine was busy with other things ({})",
            100.0 * most,
            names.join(", ")
        )
    })
}
