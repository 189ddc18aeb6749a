//! Errors of the models along a parameter: reduced albedo α', mean cosine g or index of refraction.

use std::fmt::Write;

use thiserror::Error;

use super::comparison::{ChannelResult, Settings, half_space};
use super::figures::style;
use super::material::Channel;
use super::truth::{Effort, Watch, white_rings};
use crate::diffusion::{HalfSpace, HalfSpaceError};
use crate::medium::albedo_inversion::unreduced_share;
use crate::slab::LayerError;
use crate::study::plot::{Axis, Line, Panel, PlotError, Style, svg};

/// What changes. Along g the reduced medium stays the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// Reduced single-scattering albedo α'.
    Albedo,
    /// Mean cosine g.
    MeanCosine,
    /// n_inside / n_outside.
    Index,
}

/// Values of a parameter, equidistant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweep {
    /// Which one.
    pub parameter: Parameter,
    /// First value.
    pub from: f64,
    /// Last value.
    pub to: f64,
    /// Number of values, 2 or more.
    pub count: usize,
}

/// Most values of a sweep.
const MOST: usize = 1000;

/// What is wrong with a sweep.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SweepError {
    /// Not of the form NAME=FROM:TO:COUNT.
    #[error(
        "`{0}` is no sweep; write albedo=0.5:1:11, g=0:0.9:10 or ior=1:2:11 (name, first, last and number of values)"
    )]
    Form(String),
    /// A value outside its range.
    #[error("{name} from {from} to {to}: values must be {range}")]
    Range {
        /// The parameter.
        name: &'static str,
        /// First value.
        from: f64,
        /// Last value.
        to: f64,
        /// What they may be.
        range: &'static str,
    },
    /// Too few or too many values.
    #[error("{0} values; give 2 to {MOST}")]
    Count(usize),
}

impl Parameter {
    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Albedo => "albedo",
            Self::MeanCosine => "g",
            Self::Index => "ior",
        }
    }

    fn label(self) -> &'static str {
        match self {
            Self::Albedo => "reduced single-scattering albedo α′",
            Self::MeanCosine => "mean cosine g",
            Self::Index => "index of refraction η",
        }
    }

    fn check(self, value: f64) -> Result<(), &'static str> {
        match self {
            Self::Albedo if !(value > 0.0 && value <= 1.0) => Err("above 0 and at most 1"),
            Self::MeanCosine if value.is_nan() || value.abs() >= 1.0 => {
                Err("between -1 and 1, both excluded")
            }
            Self::Index if !(value > 0.0 && value.is_finite()) => Err("above 0 and finite"),
            _ => Ok(()),
        }
    }
}

impl std::str::FromStr for Sweep {
    type Err = SweepError;

    /// From `NAME=FROM:TO:COUNT`.
    fn from_str(text: &str) -> Result<Self, SweepError> {
        let form = || SweepError::Form(text.into());
        let (name, values) = text.split_once('=').ok_or_else(form)?;
        let known = [Parameter::Albedo, Parameter::MeanCosine, Parameter::Index];
        let parameter = known.into_iter().find(|p| p.name() == name.trim()).ok_or_else(form)?;
        let &[from, to, count] = &*values.split(':').map(str::trim).collect::<Vec<_>>() else {
            return Err(form());
        };
        let number = |text: &str| text.parse::<f64>().map_err(|_| form());
        let (from, to) = (number(from)?, number(to)?);
        let count = count.parse::<usize>().map_err(|_| form())?;
        if !(2..=MOST).contains(&count) {
            return Err(SweepError::Count(count));
        }
        let range = |range| SweepError::Range { name: parameter.name(), from, to, range };
        parameter.check(from).and(parameter.check(to)).map_err(range)?;
        Ok(Self { parameter, from, to, count })
    }
}

impl Sweep {
    /// The values.
    pub fn values(&self) -> Vec<f64> {
        let last = (self.count - 1) as f64;
        (0..self.count).map(|i| self.from + (self.to - self.from) * (i as f64 / last)).collect()
    }

    /// Walks of photons that it takes: a single one serves all albedos.
    pub fn walks_needed(&self) -> u64 {
        match self.parameter {
            Parameter::Albedo => 1,
            Parameter::MeanCosine | Parameter::Index => self.count as u64,
        }
    }

    /// `base` with the parameter set to `value`, of reduced mean free path 1.
    fn medium(&self, base: &HalfSpace, value: f64) -> Result<HalfSpace, HalfSpaceError> {
        let (mut absorbed, mut g, mut eta) = (base.absorbed_share_reduced(), base.g, base.eta);
        match self.parameter {
            Parameter::Albedo => absorbed = 1.0 - value,
            Parameter::MeanCosine => g = value,
            Parameter::Index => eta = value,
        }
        HalfSpace::new(absorbed, (1.0 - absorbed) / (1.0 - g), g, eta)
    }
}

/// The models at one value of the parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepPoint {
    /// The value.
    pub value: f64,
    /// The comparison there.
    pub result: ChannelResult,
}

/// Why a sweep cannot be made.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SweepFailure {
    /// A medium on the way cannot be.
    #[error(transparent)]
    Medium(#[from] HalfSpaceError),
    /// The Monte Carlo refuses it.
    #[error(transparent)]
    Layer(#[from] LayerError),
}

/// Compares the models with Monte Carlo at every value of `sweep`, starting from `base`. If it was stopped, at those
/// that are done.
///
/// # Errors
/// If a medium on the way cannot be.
pub fn run(
    sweep: &Sweep,
    base: &HalfSpace,
    settings: &Settings,
    watch: Watch,
) -> Result<Vec<SweepPoint>, SweepFailure> {
    let values = sweep.values();
    let media: Vec<HalfSpace> =
        values.iter().map(|&value| sweep.medium(base, value)).collect::<Result<_, _>>()?;
    // Albedos share one walk; other parameters take a walk for each value.
    let share = |medium: &HalfSpace| unreduced_share(medium.absorbed_share_reduced(), medium.g);
    let group = if sweep.parameter == Parameter::Albedo { media.len() } else { 1 };
    let mut points = Vec::new();
    for (media, values) in media.chunks(group).zip(values.chunks(group)) {
        let Effort { photons, seed } = settings.effort;
        // Each walk has photons of its own.
        let effort = Effort { photons, seed: seed.wrapping_add(points.len() as u64) };
        let shares: Vec<f64> = media.iter().map(share).collect();
        let truths = white_rings(media[0].eta, media[0].g, settings.entry, &shares, effort, watch)?;
        for ((&medium, &value), truth) in media.iter().zip(values).zip(truths) {
            let channel = Channel { name: "all", medium };
            points.push(SweepPoint { value, result: half_space(&channel, truth, settings) });
        }
    }
    Ok(points)
}

/// A row for each value and model.
pub fn csv(sweep: &Sweep, points: &[SweepPoint]) -> String {
    let mut csv = format!(
        "{},model,albedo,exact_albedo,albedo_error,truth_albedo,truth_stderr,l1_error,l1_noise\n",
        sweep.parameter.name()
    );
    for SweepPoint { value, result } in points {
        let truth = result.truth.total();
        let reference = result.exact_albedo.unwrap_or(truth.value);
        for model in &result.models {
            // Writing to a string does not fail.
            let _ = writeln!(
                csv,
                "{value},{},{:.8},{reference:.8},{:.8},{:.8},{:.2e},{:.6},{:.6}",
                model.choice.name(),
                model.albedo,
                model.albedo - reference,
                truth.value,
                truth.standard_error,
                model.l1,
                result.noise,
            );
        }
    }
    csv
}

/// Error of the total albedo and L1 error against the parameter.
///
/// # Errors
/// If it cannot be drawn.
pub fn figure(sweep: &Sweep, points: &[SweepPoint]) -> Result<String, PlotError> {
    let albedo_error = |result: &ChannelResult, albedo: f64| {
        albedo - result.exact_albedo.unwrap_or(result.truth.total().value)
    };
    let mut names = Vec::new();
    for model in points.iter().flat_map(|point| &point.result.models) {
        if !names.contains(&model.choice) {
            names.push(model.choice);
        }
    }
    let lines = |value: &dyn Fn(&ChannelResult, &super::ModelResult) -> f64| -> Vec<Line> {
        let line = |&choice| {
            let at = |point: &SweepPoint| {
                let model = point.result.models.iter().find(|model| model.choice == choice);
                (point.value, model.map_or(f64::NAN, |model| value(&point.result, model)))
            };
            Line {
                name: super::ModelChoice::name(choice).into(),
                style: style(choice),
                points: points.iter().map(at).collect(),
            }
        };
        names.iter().map(line).collect()
    };
    let x = || Axis {
        label: sweep.parameter.label().into(),
        range: sweep.from.min(sweep.to)..sweep.from.max(sweep.to),
        log: false,
    };
    let errors = lines(&|result, model| albedo_error(result, model.albedo));
    let mut l1 = lines(&|_, model| 100.0 * model.l1);
    l1.push(Line {
        name: "noise of Monte Carlo".into(),
        style: Style { color: [0xaa, 0xaa, 0xaa], dashes: "2 2" },
        points: points.iter().map(|point| (point.value, 100.0 * point.result.noise)).collect(),
    });
    let panel =
        |title: &str, y: Axis, lines| Panel { title: title.into(), x: x(), y, lines, dots: Vec::new() };
    let (low, high) = extent(&errors);
    let albedo_axis =
        Axis {
            label: "model − exact".into(), range: low.min(-0.01) * 1.1..high.max(0.01) * 1.1, log: false
        };
    let (low, high) = extent(&l1);
    let l1_axis =
        Axis { label: "L1 error [%]".into(), range: 0.7 * low.max(1e-3)..1.5 * high.max(1e-2), log: true };
    svg(&[
        panel("error of the total albedo", albedo_axis, errors),
        panel("L1 error of the profile", l1_axis, l1),
    ])
}

/// Smallest and largest value of all lines.
fn extent(lines: &[Line]) -> (f64, f64) {
    let values = lines.iter().flat_map(|line| &line.points).map(|point| point.1).filter(|y| y.is_finite());
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y)))
}
