//! What a render did: for machines as JSON, for people in a line and warnings.

use std::path::PathBuf;

use serde::Serialize;
use serde_json::Value;

use super::check_report::power_as_json;
use super::console::say;
use super::error::CliError;
use super::progress::{duration, quantity};
use crate::film::Film;
use crate::film::accumulator::LARGEST;
use crate::plan::PlannedObject;
use crate::radiometry::{RadiantFlux, Rgb};
use crate::scene::Method;
use crate::transport::{Counters, PowerBalance, ProbeCounters, Unbalanced};

/// Objects of one method that are named one by one.
const MOST_NAMED: usize = 4;

/// The object printed by `render --json`.
#[derive(Debug, Serialize)]
pub struct Report {
    width: u32,
    height: u32,
    /// Seconds of rendering.
    pub seconds: f64,
    /// Samples of the pixel that has fewest.
    pub spp: u64,
    /// Samples over all pixels.
    pub samples: u64,
    samples_per_second: f64,
    threads: usize,
    backend: &'static str,
    kernel: &'static str,
    /// What was asked for.
    method: &'static str,
    methods: Vec<MethodOf>,
    /// Names of the diffusion profiles in use.
    pub profiles: Vec<&'static str>,
    /// Emitted by the lights that have a power of their own, by channel, W: not by parallel light, surroundings and materials that shine.
    light_power: RadiantFlux<Rgb>,
    /// Where the power goes; only on standard output, for it takes samples of its own.
    #[serde(skip_serializing_if = "Value::is_null")]
    power: Value,
    /// Samples that were not finite and added nothing.
    pub nonfinite: u64,
    clamped: u64,
    rejected: u64,
    capped_walks: u64,
    open_walks: u64,
    collisions: u64,
    sphere_steps: u64,
    probes: Probes,
    /// `null` while unknown.
    relative_error: Option<f64>,
    firefly_index: f64,
    /// The largest channel of any sample over the mean of the picture.
    brightest_over_mean: f64,
    outputs: Vec<PathBuf>,
}

#[derive(Debug, Serialize)]
struct Probes {
    cast: u64,
    missed: u64,
    hits: u64,
    overflowed: u64,
}

/// How light under the surface of an object was computed.
#[derive(Clone, Debug, Serialize)]
pub struct MethodOf {
    object: String,
    method: &'static str,
    /// `null` where it is not known.
    expected_error: Option<f64>,
}

impl MethodOf {
    /// Of an object as planned.
    pub fn new(planned: &PlannedObject) -> Self {
        Self {
            object: planned.object.clone(),
            method: planned.method.name(),
            expected_error: planned.expected.of(planned.method),
        }
    }
}

/// What rendered the picture, by the names that the command line has for it.
#[derive(Clone, Debug)]
pub struct MadeBy {
    /// What cast the rays.
    pub backend: &'static str,
    /// What took the samples.
    pub kernel: &'static str,
    /// How light under surfaces was to be computed.
    pub method: &'static str,
    /// How it was, by object.
    pub methods: Vec<MethodOf>,
    /// The diffusion profiles in use.
    pub profiles: Vec<&'static str>,
    /// What the lights emit.
    pub light_power: RadiantFlux<Rgb>,
}

impl Report {
    /// The report of a render that took `seconds` to bring `film` to where it is.
    pub fn new(film: &Film, counters: &Counters, seconds: f64, made_by: MadeBy, outputs: &[PathBuf]) -> Self {
        let tally = film.tally();
        let ProbeCounters { cast, missed, hits, overflowed, .. } = counters.probes;
        Self {
            width: film.width(),
            height: film.height(),
            seconds,
            spp: tally.fewest,
            samples: tally.taken,
            samples_per_second: tally.taken as f64 / seconds.max(1e-9),
            threads: rayon::current_num_threads(),
            backend: made_by.backend,
            kernel: made_by.kernel,
            method: made_by.method,
            methods: made_by.methods,
            profiles: made_by.profiles,
            light_power: made_by.light_power,
            power: Value::Null,
            nonfinite: tally.nonfinite,
            clamped: tally.clamped,
            rejected: counters.rejected,
            capped_walks: counters.capped_paths,
            open_walks: counters.open_walks,
            collisions: counters.collisions,
            sphere_steps: counters.sphere_steps,
            probes: Probes { cast, missed, hits, overflowed },
            relative_error: Some(film.relative_error()).filter(|error| error.is_finite()),
            firefly_index: film.firefly_index(),
            brightest_over_mean: film.brightest_over_mean(),
            outputs: outputs.to_vec(),
        }
    }

    /// Adds where the power goes.
    pub fn set_power(&mut self, power: &Result<PowerBalance, Unbalanced>) {
        self.power = power_as_json(power);
    }

    /// As JSON.
    pub fn json(&self) -> Result<String, CliError> {
        serde_json::to_string(self)
            .map_err(|error| CliError::machine(format!("the report cannot be written as JSON: {error}")))
    }

    /// The objects by the method that each got.
    fn methods_in_words(&self) -> String {
        let of = |(name, _): (&'static str, Method)| {
            let objects: Vec<&str> = self
                .methods
                .iter()
                .filter(|found| found.method == name)
                .map(|found| found.object.as_str())
                .collect();
            match objects[..] {
                [] => None,
                _ if objects.len() <= MOST_NAMED => Some(format!("{name}: {}", objects.join(", "))),
                _ => Some(format!("{name}: {} objects", objects.len())),
            }
        };
        Method::NAMES.into_iter().filter_map(of).collect::<Vec<_>>().join("; ")
    }

    /// In a line, and one for the methods where they were chosen.
    pub fn summary(&self) -> String {
        let error = self.relative_error.map_or("unknown".into(), |error| format!("{error:.4}"));
        let chosen = self.method == Method::Auto.name() && !self.methods.is_empty();
        let methods = if chosen { format!("\n{}", self.methods_in_words()) } else { String::new() };
        format!(
            "{} × {} pixels, {} spp in {} ({}samples/s), relative error {error}, brightest sample {:.0} × the mean{methods}",
            self.width,
            self.height,
            self.spp,
            duration(self.seconds),
            quantity(self.samples_per_second),
            self.brightest_over_mean,
        )
    }

    /// One line on standard error for each thing that makes the picture less than it should be.
    pub fn print_warnings(&self) {
        let warn = |count: u64, of: &str, what: String| {
            if count > 0 {
                say(&format!("warning: {count} {of} {what}"));
            }
        };
        let light = "the picture lacks their light";
        warn(self.nonfinite, "samples", format!("were not finite and were left black: {light}"));
        warn(self.clamped, "samples", format!("were above {LARGEST:e} W/(m² sr) and were cut: {light}"));
        warn(self.rejected, "directions", format!("could not be followed: {light}"));
        warn(self.capped_walks, "paths", format!("were cut by the limit on their length: {light}"));
        warn(
            self.open_walks,
            "walks",
            "left a body where it has no surface; they are taken to go straight on".into(),
        );
        warn(
            self.probes.overflowed,
            "area integrals",
            "found no point to leave by; their light leaves where it entered".into(),
        );
    }
}
