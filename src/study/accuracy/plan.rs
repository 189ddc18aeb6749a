//! What is rendered, how often, and how the time is dealt out.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::candidate::Candidate;
use super::effects::Effect;
use super::settings::Settings;
use crate::scene::Scene;

/// Parts of each half of the reference: what an interruption can lose is one of them.
pub const PARTS_OF_HALF: usize = 4;
/// Runs with an effect off.
pub const RUNS_OF_EFFECT: usize = 2;
/// Runs of each form of the direction of entry: as many as of a candidate, but not more.
const MOST_RUNS_OF_DIRECTION: usize = 8;

/// Name of the reference in files.
pub const REFERENCE: &str = "reference";
/// Name of the directional dipole that does not know the direction of entry.
pub const ANY_DIRECTION: &str = "bssrdf-any-direction";

/// Shares of the time: of the reference, of what the effects cost; the rest is for the candidates.
const SHARE_OF_REFERENCE: f64 = 1.0 / 3.0;
const SHARE_OF_EFFECTS: f64 = 1.0 / 12.0;

/// How often the samples of a run are halved for the points of its curve.
const HALVINGS: u32 = 4;

/// What a series of runs is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The truth.
    Reference,
    /// A candidate.
    Candidate(Candidate),
    /// The directional dipole without the direction of entry.
    AnyDirection,
    /// The reference's method with an effect off; `None`: with all of them on.
    Effect(Option<Effect>),
}

/// Independent runs of the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Series {
    /// What for.
    pub role: Role,
    /// How light under the surface is computed.
    pub candidate: Candidate,
    /// How many runs.
    pub runs: usize,
}

impl Series {
    /// The name in files.
    pub fn name(&self) -> String {
        match self.role {
            Role::Reference => REFERENCE.into(),
            Role::Candidate(candidate) => candidate.name(),
            Role::AnyDirection => ANY_DIRECTION.into(),
            Role::Effect(None) => "all-effects".into(),
            Role::Effect(Some(effect)) => format!("without-{}", effect.name()),
        }
    }

    /// What is said while run `run` is being done.
    pub fn label(&self, run: usize) -> String {
        format!("{}, {} of {}", self.name(), run + 1, self.runs)
    }

    /// The seed of run `run`: no two runs of a study have the same, nor have those of other studies with seeds
    /// below 2²⁴.
    pub fn seed(&self, study: u64, run: usize) -> u64 {
        let tag = match self.role {
            Role::Reference => 0,
            Role::AnyDirection => 1,
            Role::Effect(None) => 2,
            Role::Effect(Some(effect)) => 3 + effect as u64,
            Role::Candidate(candidate) => 32 + candidate.index() as u64,
        };
        study.rotate_left(40) ^ (tag << 20) ^ run as u64
    }

    /// The fewest samples per pixel of a run that say something.
    fn fewest(&self) -> u64 {
        match self.role {
            Role::Reference => 4,
            _ => 2,
        }
    }

    fn share(&self) -> Share {
        match self.role {
            Role::Reference => Share::Reference,
            Role::Effect(_) => Share::Effects,
            _ => Share::Candidates,
        }
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Share {
    Reference,
    Candidates,
    Effects,
}

/// All series of a study of `scene`, the reference first.
pub fn series(scene: &Scene, settings: &Settings) -> Vec<Series> {
    let of = |role, candidate: Candidate, runs| Series { role, candidate, runs };
    let truth = settings.reference();
    let mut all = vec![of(Role::Reference, truth, 2 * PARTS_OF_HALF)];
    let candidates = settings.candidates().filter(|candidate| candidate.is_of_its_own_in(scene));
    all.extend(candidates.map(|c| of(Role::Candidate(c), c, settings.seeds)));
    if settings.candidates().any(|candidate| candidate == Candidate::DIRECTIONAL) {
        let runs = settings.seeds.min(MOST_RUNS_OF_DIRECTION);
        all.push(of(Role::AnyDirection, Candidate::DIRECTIONAL, runs));
    }
    let off: Vec<_> = Effect::ALL.into_iter().filter(|effect| effect.off(scene).is_some()).collect();
    all.push(of(Role::Effect(None), truth, RUNS_OF_EFFECT));
    all.extend(off.into_iter().map(|effect| {
        let candidate = if effect == Effect::Subsurface { Candidate::DIFFUSE } else { truth };
        of(Role::Effect(Some(effect)), candidate, RUNS_OF_EFFECT)
    }));
    all
}

/// What a series costs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rate {
    /// Seconds to make the renderer ready.
    pub setup_seconds: f64,
    /// Seconds for one sample of every pixel.
    pub seconds_per_sample: f64,
}

/// What was planned, kept so that an interrupted study goes on with the same.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// What was asked for.
    pub settings: Settings,
    /// By name of the series.
    pub series: BTreeMap<String, PlannedSeries>,
    /// What could not be rendered, and why.
    pub skipped: BTreeMap<String, String>,
}

/// The runs of a series.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlannedSeries {
    /// Samples per pixel at each point of a run, rising.
    pub levels: Vec<u64>,
    /// Seconds that a run is expected to take.
    pub seconds: f64,
}

/// The time is too short.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error(
    "--time {given} is too short: {least:.0} s are needed at least; give more time, fewer --seeds, fewer --methods or a smaller --width and --height"
)]
pub struct TooShort {
    /// Seconds there are.
    pub given: f64,
    /// The fewest.
    pub least: f64,
}

/// Deals `seconds` out to series that cost `rates`: to each run the fewest samples, and what is left by share.
///
/// # Errors
/// If there is not enough for the fewest.
pub fn deal_out(series: &[Series], rates: &[Rate], seconds: f64) -> Result<Vec<PlannedSeries>, TooShort> {
    let cost_of_fewest = |s: &Series, rate: &Rate| {
        s.runs as f64 * s.fewest() as f64 * rate.seconds_per_sample + rate.setup_seconds
    };
    let least: f64 = series.iter().zip(rates).map(|(s, rate)| cost_of_fewest(s, rate)).sum();
    if seconds < least {
        return Err(TooShort { given: seconds, least: least.ceil() });
    }
    let left = seconds - least;
    let runs = |share| series.iter().filter(|s| s.share() == share).map(|s| s.runs).sum::<usize>() as f64;
    // Effects are compared at equal samples.
    let effects = series.iter().zip(rates).filter(|(s, _)| s.share() == Share::Effects);
    let sample_of_effects: f64 = effects.map(|(s, rate)| s.runs as f64 * rate.seconds_per_sample).sum();
    let share_of_candidates = 1.0 - SHARE_OF_REFERENCE - SHARE_OF_EFFECTS;
    let planned = series.iter().zip(rates).map(|(s, rate)| {
        let per_sample = rate.seconds_per_sample;
        let more = match s.share() {
            Share::Reference => left * SHARE_OF_REFERENCE / runs(Share::Reference) / per_sample,
            Share::Candidates => left * share_of_candidates / runs(Share::Candidates) / per_sample,
            Share::Effects => left * SHARE_OF_EFFECTS / sample_of_effects,
        };
        let samples = s.fewest() + more as u64;
        let levels = match s.role {
            Role::Candidate(_) => levels(samples),
            _ => vec![samples],
        };
        PlannedSeries { levels, seconds: samples as f64 * per_sample }
    });
    Ok(planned.collect())
}

/// `samples` and its halves down to a sixteenth, rising; whole numbers above 0.
fn levels(samples: u64) -> Vec<u64> {
    let mut levels: Vec<u64> = (0..=HALVINGS).rev().map(|n| samples >> n).filter(|&n| n > 0).collect();
    levels.dedup();
    levels
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::radiometry::Rgb;
    use crate::scene::{Material, ScatteringInput, Surface};
    use crate::study::accuracy::settings::digest;

    fn settings(seeds: usize) -> Settings {
        Settings {
            version: String::new(),
            scene: digest(&Scene::default()),
            width: 8,
            height: 8,
            time: 60.0,
            seeds,
            methods: Candidate::ALL.iter().map(|candidate| candidate.name()).collect(),
            reference: Candidate::WALK.name(),
            seed: 3,
            backend: String::new(),
            threads: 1,
        }
    }

    /// One material, with every effect.
    fn scene() -> Scene {
        let medium = ScatteringInput::Coefficients {
            sigma_a: Rgb::new(1.0, 2.0, 3.0),
            sigma_s: Rgb::splat(10.0),
            g: 0.5,
        };
        let surface = Surface::Translucent { ior: 1.4, roughness: 0.5, medium };
        Scene { materials: vec![Material { surface, ..Material::default() }], ..Scene::default() }
    }

    #[test]
    fn no_two_runs_share_a_seed() {
        let all = series(&scene(), &settings(16));
        assert_eq!(all.len(), 1 + 9 + 1 + 1 + Effect::ALL.len());
        let seeds = |study| all.iter().flat_map(move |s| (0..s.runs).map(move |run| s.seed(study, run)));
        let mut found: Vec<u64> = [0, 1, 2, 1 << 20].into_iter().flat_map(seeds).collect();
        let count = found.len();
        found.sort_unstable();
        found.dedup();
        assert_eq!(found.len(), count);
    }

    #[test]
    fn the_time_is_used_and_not_exceeded() {
        let all = series(&scene(), &settings(4));
        let rates: Vec<Rate> = (0..all.len())
            .map(|i| Rate { setup_seconds: 0.1, seconds_per_sample: 1e-3 * (i + 1) as f64 })
            .collect();
        let planned = deal_out(&all, &rates, 100.0).unwrap();
        let spent = |share| -> f64 {
            let of = all.iter().zip(&planned).filter(|(s, _)| s.share() == share);
            of.map(|(s, planned)| s.runs as f64 * planned.seconds).sum()
        };
        let total = spent(Share::Reference) + spent(Share::Candidates) + spent(Share::Effects);
        assert!((95.0..100.0).contains(&total), "{total}");
        assert!((spent(Share::Reference) / 33.0 - 1.0).abs() < 0.03);
        let samples: Vec<_> = all.iter().zip(&planned).filter(|(s, _)| s.share() == Share::Effects).collect();
        assert_eq!(samples.len(), 1 + Effect::ALL.len());
        assert!(samples.windows(2).all(|pair| pair[0].1.levels == pair[1].1.levels));
        let short = deal_out(&all, &rates, 0.5).unwrap_err();
        assert!(short.least > 0.5 && deal_out(&all, &rates, short.least).is_ok());
    }

    #[test]
    fn similarity_is_studied_where_scattering_is_anisotropic() {
        let similar = |series: &Series| series.role == Role::Candidate(Candidate::SIMILAR_WALK);
        let count = |scene| series(&scene, &settings(16)).iter().filter(|series| similar(series)).count();
        assert_eq!((count(scene()), count(Scene::default())), (1, 0));
        assert!(series(&scene(), &settings(16)).iter().all(|s| s.candidate.similarity == similar(s)));
    }

    #[test]
    fn levels_are_halves() {
        assert_eq!(levels(160), [10, 20, 40, 80, 160]);
        assert_eq!(levels(6), [1, 3, 6]);
        assert_eq!(levels(2), [1, 2]);
    }
}
