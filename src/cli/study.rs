//! `alabaster study`.

use std::path::{Path, PathBuf};

use clap::Args;

use super::backend::{RayWork, run_on};
use super::bar::Bar;
use super::choice::positive;
use super::console::{print_line, say, warn};
use super::error::CliError;
use super::force::ForceArgs;
use super::progress::time_left;
use super::stop::Stop;
use super::threads::ThreadArgs;
use crate::film::layers::Channel;
use crate::film::output::replace;
use crate::film::{Picture, exr};
use crate::raycast::{Backend, Geometry, RayCaster, RaycastError};
use crate::scene::Scene;
use crate::study::accuracy::{
    Outcome, Results, Settings, Store, StudyError, Watch, affordable, candidates, digest, report, study,
    summary, tables,
};

/// Arguments of `study`.
#[derive(Args)]
pub struct StudyArgs {
    /// Scene to study: .toml, .glb or .gltf
    scene: PathBuf,
    /// Directory for the report, tables and pictures; a study that is there already is gone on with
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Seconds for all of it
    #[arg(long, value_name = "SECONDS", default_value_t = 600.0, value_parser = positive, allow_negative_numbers = true)]
    time: f64,
    /// Independent runs of each method
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u16).range(2..=256))]
    seeds: u16,
    /// Methods to compare, separated by commas: diffuse, walk, walk-similarity, bssrdf (with every profile) or names of profiles [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    methods: Vec<String>,
    /// What stands for the truth: walk, or the name of a profile
    #[arg(long, value_name = "NAME", default_value = "walk")]
    reference: String,
    /// Width in pixels [default: the scene's, less if it has more than 128 on the longer side]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    width: Option<u32>,
    /// Height in pixels [default: in proportion]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    height: Option<u32>,
    /// What casts the rays
    #[arg(long, value_parser = super::choice::named(Backend::NAMES), default_value = Backend::default().name())]
    backend: Backend,
    #[command(flatten)]
    force: ForceArgs,
    /// Seed of all random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    threads: ThreadArgs,
    /// Print nothing but warnings and errors
    #[arg(long)]
    quiet: bool,
    /// Print what was found as JSON on standard output
    #[arg(long)]
    json: bool,
}

impl From<StudyError> for CliError {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::Render(error) => error.into(),
            StudyError::Film(error) => error.into(),
            StudyError::Output(error) => error.into(),
            other => Self::input(other),
        }
    }
}

/// Studies a scene.
pub fn run(args: &StudyArgs) -> Result<(), CliError> {
    args.threads.start()?;
    let methods = candidates(&args.methods).map_err(CliError::input)?;
    let reference = candidates(std::slice::from_ref(&args.reference)).map_err(CliError::input)?;
    let [reference] = reference[..] else {
        return Err(CliError::input("--reference: give one profile, or walk"));
    };
    args.force.refuse_methods()?;
    let mut scene = args.force.read_scene(&args.scene)?;
    (scene.film.width, scene.film.height) = size(args, &scene);
    let settings = Settings {
        version: env!("CARGO_PKG_VERSION").into(),
        scene: digest(&scene),
        width: scene.film.width,
        height: scene.film.height,
        time: args.time,
        seeds: args.seeds.into(),
        methods: methods.iter().map(|candidate| candidate.name()).collect(),
        reference: reference.name(),
        seed: args.seed,
        backend: args.backend.name().into(),
        threads: rayon::current_num_threads(),
    };
    run_on(args.backend, Work { args, scene, settings })
}

/// The size that is asked for; where that is none, an affordable one.
fn size(args: &StudyArgs, scene: &Scene) -> (u32, u32) {
    let (width, height) = (scene.film.width, scene.film.height);
    let in_proportion = |side: u32, of: u32, other: u32| {
        (f64::from(side) * f64::from(other) / f64::from(of)).round().max(1.0) as u32
    };
    match (args.width, args.height) {
        (None, None) => affordable(width, height),
        (Some(given), None) => (given, in_proportion(given, width, height)),
        (None, Some(given)) => (in_proportion(given, height, width), given),
        (Some(width), Some(height)) => (width, height),
    }
}

struct Work<'a> {
    args: &'a StudyArgs,
    scene: Scene,
    settings: Settings,
}

impl RayWork for Work<'_> {
    fn run<C: RayCaster>(self, build: impl Fn(&Geometry) -> Result<C, RaycastError>) -> Result<(), CliError> {
        let Self { args, scene, settings } = self;
        let store = Store::open(&args.output)?;
        let stop = Stop::on_signals()?;
        let bar = Bar::start(args.quiet);
        tracing::info!("studying at {} × {} pixels", settings.width, settings.height);
        let show = |done: f64, label: &str| bar.show(|| (done, message(done, label, bar.seconds())));
        let watch = Watch { show: &show, stop: &stop.now };
        let outcome = study(&scene, &settings, &store, build, &watch);
        bar.finish();
        match outcome? {
            Outcome::Complete(results) => report_on(args, &scene, &results, &store, true),
            Outcome::Interrupted(Some(results)) => {
                report_on(args, &scene, &results, &store, false)?;
                Err(interrupted("what was done is kept and reported on"))
            }
            Outcome::Interrupted(None) => Err(interrupted("what was done is kept")),
        }
    }
}

fn interrupted(kept: &str) -> CliError {
    CliError::Interrupted(format!("{kept}; the same command goes on"))
}

fn message(done: f64, label: &str, seconds: f64) -> String {
    if done == 0.0 {
        return label.into();
    }
    format!("{:.0} %, {label}, {}", 100.0 * done, time_left(seconds, done))
}

/// Writes the report and all that belongs to it, and says what was found.
fn report_on(
    args: &StudyArgs,
    scene: &Scene,
    results: &Results,
    store: &Store,
    complete: bool,
) -> Result<(), CliError> {
    let json = summary::json(results, complete);
    let html = report::html(results, &title(args, scene), complete).map_err(CliError::machine)?;
    store.write("data.csv", tables::csv(results, store).as_bytes())?;
    store.write("summary.json", format!("{json:#}\n").as_bytes())?;
    let reference = &results.reference;
    write_picture(store, "reference.exr", &reference.picture, &reference.variance)?;
    for found in &results.candidates {
        let of_mean: Vec<f64> = found.variance.iter().map(|x| x / found.runs as f64).collect();
        write_picture(store, &format!("{}.exr", found.candidate.name()), &found.picture, &of_mean)?;
    }
    for (name, svg) in report::charts(results).map_err(CliError::machine)? {
        store.write(&name, svg.as_bytes())?;
    }
    store.write("report.html", html.as_bytes())?;
    warn(&results.warnings);
    if args.json {
        return print_line(&json.to_string());
    }
    if args.quiet {
        return Ok(());
    }
    print_line(&tables::text(results))?;
    say(&format!("the report: {}", store.path("report.html").display()));
    Ok(())
}

fn title(args: &StudyArgs, scene: &Scene) -> String {
    if scene.title.is_empty() { file_name(&args.scene) } else { scene.title.clone() }
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// A mean picture with its variance, as `render --aov variance` would write it.
fn write_picture(store: &Store, name: &str, picture: &Picture, variance: &[f64]) -> Result<(), CliError> {
    let channel = |name, channel: usize| Channel {
        name,
        values: variance.iter().skip(channel).step_by(3).map(|&x| x as f32).collect(),
    };
    let channels = [channel("variance.R", 0), channel("variance.G", 1), channel("variance.B", 2)];
    replace(&store.path(name), |file| exr::write(file, picture, &channels, &[]))?;
    Ok(())
}
