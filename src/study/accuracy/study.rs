//! A study from beginning to end, or from where it was interrupted.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use thiserror::Error;

use super::candidate::Candidate;
use super::errors::{Reference, Region, channels};
use super::evaluate::{evaluate, reference};
use super::plan::{Plan, PlannedSeries, Rate, Role, Series, TooShort, deal_out, series};
use super::regions::{has_translucent, regions};
use super::rendering::make_ready;
use super::results::Results;
use super::settings::Settings;
use super::store::Store;
use crate::film::output::OutputError;
use crate::film::{FilmError, Picture};
use crate::raycast::{Geometry, RayCaster, RaycastError};
use crate::scene::Scene;
use crate::transport::{RenderError, Renderer};

/// Runs of one candidate that follow each other. Candidates take turns, so that what else the machine does falls on all of
/// them alike.
const RUNS_OF_A_TURN: usize = 4;

/// How long the speed of a method is measured: a share of the time, and seconds at most.
const SHARE_OF_PILOT: f64 = 1.0 / 400.0;
const LONGEST_PILOT: f64 = 0.4;

/// Why there is no study.
#[derive(Debug, Error)]
pub enum StudyError {
    /// All methods are the same on this scene.
    #[error(
        "there is nothing to compare: no object is of a translucent material, and the methods differ only there"
    )]
    NothingTranslucent,
    /// What is there is of another study.
    #[error("{}: there is a study with other settings: {differences}; choose another directory, or remove this one", directory.display())]
    OtherSettings {
        /// The directory.
        directory: PathBuf,
        /// What differs.
        differences: String,
    },
    /// The time is too short.
    #[error(transparent)]
    TooShort(#[from] TooShort),
    /// The scene cannot be rendered.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// There is no memory for a picture.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// A file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
}

/// Who looks on.
pub struct Watch<'a> {
    /// Told the share of this call's work that is done, and what is being done.
    pub show: &'a (dyn Fn(f64, &str) + Sync),
    /// True when the work is to end.
    pub stop: &'a AtomicBool,
}

impl Watch<'_> {
    fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// How a study ended.
pub enum Outcome {
    /// All was done.
    Complete(Results),
    /// It was stopped; what there is to say already, if there is.
    Interrupted(Option<Results>),
}

/// Renders what is not there yet, and evaluates all of it. `scene` has the size that is studied.
///
/// # Errors
/// See [`StudyError`].
pub fn study<C: RayCaster>(
    scene: &Scene,
    settings: &Settings,
    store: &Store,
    build: impl Fn(&Geometry) -> Result<C, RaycastError>,
    watch: &Watch,
) -> Result<Outcome, StudyError> {
    if !has_translucent(scene) {
        return Err(StudyError::NothingTranslucent);
    }
    let (regions, oddities) = look_at(scene, settings, &build)?;
    let work = Work { scene, settings, store, build: &build, watch, regions: &regions };
    let Some(plan) = work.plan()? else { return Ok(Outcome::Interrupted(None)) };
    let done = work.render(&plan)?;
    let results = evaluate(scene, &plan, store, &regions, &oddities);
    Ok(match results {
        Some(results) if done => Outcome::Complete(results),
        results => Outcome::Interrupted(results),
    })
}

/// The regions of the picture, and what is wrong with the scene.
fn look_at<C: RayCaster>(
    scene: &Scene,
    settings: &Settings,
    build: &impl Fn(&Geometry) -> Result<C, RaycastError>,
) -> Result<(Vec<Region>, Vec<String>), RenderError> {
    let options = settings.reference().options(scene);
    let renderer = Renderer::new(scene.clone(), options, build)?;
    Ok((regions(&renderer), renderer.warnings()))
}

struct Work<'a, B> {
    scene: &'a Scene,
    settings: &'a Settings,
    store: &'a Store,
    build: &'a B,
    watch: &'a Watch<'a>,
    regions: &'a [Region],
}

fn is_candidate(series: &Series) -> bool {
    matches!(series.role, Role::Candidate(_) | Role::AnyDirection)
}

/// Runs of a series, to be done one after another.
struct Turn {
    series: Series,
    planned: PlannedSeries,
    runs: Vec<usize>,
}

impl<C: RayCaster, B: Fn(&Geometry) -> Result<C, RaycastError>> Work<'_, B> {
    /// The plan of an earlier call, or a new one; `None` if it was stopped.
    fn plan(&self) -> Result<Option<Plan>, StudyError> {
        if let Some(plan) = self.store.plan() {
            let differences = self.settings.differences(&plan.settings);
            if differences.is_empty() {
                return Ok(Some(plan));
            }
            let differences = differences.join(", ");
            return Err(StudyError::OtherSettings { directory: self.store.path(""), differences });
        }
        let start = Instant::now();
        let all = series(self.scene, self.settings);
        let (mut able, mut rates, mut skipped) = (Vec::new(), Vec::new(), BTreeMap::new());
        // What the same method does elsewhere, it does at about the same speed.
        let mut known: Vec<(Candidate, Rate)> = Vec::new();
        for series in &all {
            let kind = series.candidate;
            let rate = match known.iter().find(|(other, _)| *other == kind) {
                Some((_, rate)) => Ok(Some(*rate)),
                None => self.rate(series),
            };
            match rate {
                Ok(Some(rate)) => {
                    known.push((kind, rate));
                    able.push(*series);
                    rates.push(rate);
                }
                Ok(None) => return Ok(None),
                // One profile may not be there for a material; others are.
                Err(StudyError::Render(problem)) if is_candidate(series) => {
                    skipped.insert(series.name(), problem.to_string());
                }
                Err(error) => return Err(error),
            }
        }
        let spent = start.elapsed().as_secs_f64();
        let planned = deal_out(&able, &rates, self.settings.time - spent)
            .map_err(|short| TooShort { given: self.settings.time, least: (short.least + spent).ceil() })?;
        let series = able.iter().map(Series::name).zip(planned).collect();
        let plan = Plan { settings: self.settings.clone(), series, skipped };
        self.store.keep_plan(&plan)?;
        Ok(Some(plan))
    }

    fn rate(&self, series: &Series) -> Result<Option<Rate>, StudyError> {
        (self.watch.show)(0.0, &format!("measuring the speed of {}", series.name()));
        let seconds = (self.settings.time * SHARE_OF_PILOT).min(LONGEST_PILOT);
        Ok(make_ready(series, self.scene, self.build)?.rate(seconds, self.watch.stop)?)
    }

    /// Renders what is missing; false if it was stopped.
    fn render(&self, plan: &Plan) -> Result<bool, StudyError> {
        let turns = self.turns(plan);
        let total: f64 = turns.iter().map(|turn| turn.runs.len() as f64 * turn.planned.seconds).sum();
        let done = Cell::new(0.0);
        let mut truth = None;
        for turn in turns {
            if truth.is_none() && turn.series.role != Role::Reference {
                truth = reference(self.store).map(|(reference, _)| reference);
            }
            if !self.take(&turn, truth.as_ref(), &done, total)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// What is missing: the reference; a turn of each candidate; what the effects cost; the other turns.
    fn turns(&self, plan: &Plan) -> Vec<Turn> {
        let all = series(self.scene, self.settings);
        let missing = |series: &Series, runs: std::ops::Range<usize>| {
            let planned = plan.series.get(&series.name())?.clone();
            let runs: Vec<usize> =
                runs.filter(|&run| self.store.run(&series.name(), run).is_none()).collect();
            (!runs.is_empty()).then_some(Turn { series: *series, planned, runs })
        };
        let turn_of_candidates = |turn: usize| {
            let first = turn * RUNS_OF_A_TURN;
            let range =
                move |series: &Series| first.min(series.runs)..(first + RUNS_OF_A_TURN).min(series.runs);
            all.iter()
                .filter(|series| is_candidate(series))
                .filter_map(move |s| missing(s, range(s)))
                .collect::<Vec<_>>()
        };
        let whole = |wanted: fn(Role) -> bool| {
            all.iter().filter(|s| wanted(s.role)).filter_map(|s| missing(s, 0..s.runs)).collect::<Vec<_>>()
        };
        let mut turns = whole(|role| role == Role::Reference);
        turns.extend(turn_of_candidates(0));
        turns.extend(whole(|role| matches!(role, Role::Effect(_))));
        (1..self.settings.seeds.div_ceil(RUNS_OF_A_TURN)).for_each(|n| turns.extend(turn_of_candidates(n)));
        turns
    }

    /// Does the runs of a turn and keeps them; false if it was stopped.
    fn take(
        &self,
        turn: &Turn,
        truth: Option<&Reference>,
        done: &Cell<f64>,
        total: f64,
    ) -> Result<bool, StudyError> {
        let mut ready = make_ready(&turn.series, self.scene, self.build)?;
        let wants_errors = matches!(turn.series.role, Role::Candidate(_));
        let judge = |picture: &Picture| match truth.filter(|_| wants_errors) {
            Some(truth) => {
                let values = channels(picture);
                self.regions.iter().map(|region| truth.relmse(&values, region)).collect()
            }
            None => Vec::new(),
        };
        for &run in &turn.runs {
            let (label, before) = (turn.series.label(run), done.get());
            let progress = |share: f64| {
                (self.watch.show)((before + share * turn.planned.seconds) / total, &label);
            };
            let seed = turn.series.seed(self.settings.seed, run);
            let found = ready.run(seed, &turn.planned.levels, judge, self.watch.stop, &progress)?;
            let Some(found) = found.filter(|_| !self.watch.stopped()) else { return Ok(false) };
            self.store.keep_run(&turn.series.name(), run, &found)?;
            done.set(before + turn.planned.seconds);
        }
        Ok(true)
    }
}
