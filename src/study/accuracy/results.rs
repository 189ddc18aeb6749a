//! What a study found.

use super::candidate::Candidate;
use super::collisions::ExpectedCollisions;
use super::crossover::Crossover;
use super::effects::Effect;
use super::errors::Region;
use super::jackknife::SIGMAS;
use super::model::Curve;
use super::plan::Plan;
use super::tail::TailIndex;
use crate::film::Picture;
use crate::slab::Estimate;

/// All that was found. Errors are relative to the reference in the way of relMSE; a region's index is that in `regions`.
pub struct Results {
    /// What was planned.
    pub plan: Plan,
    /// The whole picture, all translucent bodies, each translucent material.
    pub regions: Vec<Region>,
    /// The reference.
    pub reference: ReferenceResult,
    /// The candidates of which there are two runs at least.
    pub candidates: Vec<CandidateResult>,
    /// The error taken apart.
    pub parts: Vec<ErrorPart>,
    /// What the effects cost, and what they are worth.
    pub effects: Vec<EffectResult>,
    /// Collisions that the walk is expected to have.
    pub collisions: Vec<ExpectedCollisions>,
    /// What stands between these figures and the truth, in sentences.
    pub warnings: Vec<String>,
}

/// The reference.
pub struct ReferenceResult {
    /// What rendered it.
    pub candidate: Candidate,
    /// Samples per pixel, of both halves together.
    pub spp: u64,
    /// Seconds for both halves.
    pub seconds: f64,
    /// relMSE of its own noise, by region.
    pub noise: Vec<f64>,
    /// Collisions in all its samples, over samples of pixels that show a translucent body; `None` if it does not walk.
    pub collisions: Option<f64>,
    /// Its mean.
    pub picture: Picture,
    /// Variance of its mean.
    pub variance: Vec<f64>,
}

/// A candidate.
pub struct CandidateResult {
    /// Which.
    pub candidate: Candidate,
    /// Runs.
    pub runs: usize,
    /// Mean seconds to make the renderer ready.
    pub setup_seconds: f64,
    /// Samples per pixel of a run.
    pub spp: u64,
    /// Mean seconds of a run.
    pub seconds: f64,
    /// Standard deviation of the seconds of runs, relative to them.
    pub unsteadiness: f64,
    /// Mean of all runs.
    pub picture: Picture,
    /// Variance of one run, by channel.
    pub variance: Vec<f64>,
    /// The tail of the noise.
    pub tail: Option<TailIndex>,
    /// Share of the noise that stands in its noisiest thousandth.
    pub firefly_share: f64,
    /// Samples that were not finite, in all runs.
    pub nonfinite: u64,
    /// Paths cut by a limit on their length, in all runs.
    pub capped: u64,
    /// By region.
    pub by_region: Vec<RegionResult>,
}

/// A candidate in a region.
pub struct RegionResult {
    /// B²: unbiased, so that it may be below 0 by noise.
    pub bias_squared: Estimate,
    /// True of what renders the reference: its B² is 0, and what was found is a check.
    pub is_truth: bool,
    /// V, s.
    pub variance_seconds: Estimate,
    /// B² and V by a fit to the points, as a check.
    pub fitted: [Estimate; 2],
    /// Exponent with which the noise falls in time: 1 where samples are independent.
    pub falls_as: f64,
    /// Mean over the runs, as samples were added.
    pub points: Vec<MeanPoint>,
    /// When the walk overtakes it; `None` for the walk, and where that was not studied.
    pub crossover: Option<Crossover>,
}

impl RegionResult {
    /// relMSE over time, by the figures. A bias that is not told from 0 with 95 % confidence is taken for none.
    pub fn curve(&self) -> Curve {
        let found = self.bias_squared.value > SIGMAS * self.bias_squared.standard_error;
        Curve {
            bias_squared: if found && !self.is_truth { self.bias_squared.value } else { 0.0 },
            variance_seconds: self.variance_seconds.value.max(0.0),
        }
    }

    /// The largest relMSE that a bias which was not told from 0 may have; 0 where there is none, or it was found.
    pub fn hidden_bias_squared(&self) -> f64 {
        if self.is_truth || self.curve().bias_squared > 0.0 {
            return 0.0;
        }
        self.bias_squared.value.max(0.0) + SIGMAS * self.bias_squared.standard_error
    }
}

/// A point of a candidate's curve.
#[derive(Clone, Copy, Debug)]
pub struct MeanPoint {
    /// Samples per pixel.
    pub spp: u64,
    /// Mean seconds.
    pub seconds: f64,
    /// Mean relMSE and its standard error.
    pub relmse: Estimate,
}

/// A part of the error: what exchanging one approximation changes.
pub struct ErrorPart {
    /// Which kind.
    pub kind: PartKind,
    /// What is compared with what.
    pub title: String,
    /// Mean square of the relative difference on translucent bodies, less that of noise.
    pub square: Estimate,
    /// Relative difference of each pixel, mean of the channels; for [`PartKind::Sampling`] the standard deviation.
    pub map: Vec<f64>,
}

/// Kinds of error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PartKind {
    /// A body is not a plane.
    Geometry,
    /// A model is not the exact profile on a plane.
    Profile,
    /// The profile depends on the direction of entry.
    Direction,
    /// Noise.
    Sampling,
}

impl PartKind {
    /// The name in outputs.
    pub fn name(self) -> &'static str {
        match self {
            Self::Geometry => "geometry",
            Self::Profile => "profile",
            Self::Direction => "direction",
            Self::Sampling => "sampling",
        }
    }
}

/// The scene without an effect.
pub struct EffectResult {
    /// The effect that is off.
    pub effect: Effect,
    /// Samples per pixel.
    pub spp: u64,
    /// Seconds with it, and without it.
    pub seconds: [f64; 2],
    /// Mean square of the relative error on translucent bodies, less that of noise.
    pub square: Estimate,
    /// Relative error of the mean of each channel there.
    pub bias: [Estimate; 3],
}

impl Results {
    /// The result of a candidate.
    pub fn of(&self, candidate: Candidate) -> Option<&CandidateResult> {
        self.candidates.iter().find(|result| result.candidate == candidate)
    }

    /// Regions to report: the whole picture, and each translucent material.
    pub fn reported_regions(&self) -> impl Iterator<Item = usize> {
        (0..self.regions.len()).filter(|&i| i == 0 || self.regions[i].material.is_some())
    }
}
