//! `alabaster slab`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::choice::cosine;
use super::console::print_line;
use super::error::CliError;
use super::photon_progress::PhotonProgress;
use super::slab_outputs::{Finished, Outputs};
use super::slab_report::{RunReport, reports_json};
use super::stop::Stop;
use super::threads::ThreadArgs;
use crate::slab::mci::MAX_PHOTONS;
use crate::slab::{MciRun, Simulation, Source, read_mci};

/// Arguments of `slab`.
#[derive(Args)]
pub struct SlabArgs {
    /// Input file of MCML, .mci
    pub input: PathBuf,
    /// File to write, .mco, .csv or .json; may be given several times [default: the .mco files that the input
    /// names, beside it]. If the input has several runs, .mco and .csv are numbered: out-1.mco, out-2.mco
    #[arg(short, long, value_name = "FILE")]
    pub output: Vec<PathBuf>,
    /// Photon packets of each run [default: what the input says]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=MAX_PHOTONS))]
    photons: Option<u64>,
    /// How light enters
    #[arg(long, value_enum, default_value_t)]
    source: SourceChoice,
    /// Cosine of the angle between the pencil beam and the normal, outside [default: 1]
    #[arg(long, value_name = "MU", value_parser = cosine)]
    cosine: Option<f64>,
    /// Seed of the first run's random numbers; each run after it takes the next one
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    threads: ThreadArgs,
    /// Print nothing but warnings and errors
    #[arg(long)]
    quiet: bool,
    /// Print the totals as JSON on standard output
    #[arg(long)]
    json: bool,
}

/// How light enters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum SourceChoice {
    /// A pencil beam
    #[default]
    Pencil,
    /// Light from all sides of the upper hemisphere alike, at a point
    Diffuse,
}

/// Simulates the runs of an input file, one after the other, and writes what came of each.
pub fn run(args: &SlabArgs) -> Result<(), CliError> {
    let source = source(args)?;
    let runs = read_mci(&args.input)
        .map_err(|error| CliError::input(format!("{}: {error}", args.input.display())))?;
    let outputs = Outputs::plan(&args.input, &args.output, &runs)?;
    args.threads.start()?;
    let stop = Stop::on_signals()?;
    let mut reports = Vec::new();
    for (i, run) in runs.iter().enumerate() {
        let label = format!("run {} of {}", i + 1, runs.len());
        let Some(finished) = simulate(args, run, source, i as u64, &label, &stop) else { break };
        outputs.write_run(i, run, &finished)?;
        let report = RunReport::new(&finished, outputs.of_run(i));
        if !args.quiet && !args.json {
            print_line(&report.table(&label))?;
        }
        reports.push(report);
        if stop.interrupted() {
            break;
        }
    }
    if !reports.is_empty() {
        let json = reports_json(&reports)?;
        outputs.write_summaries(&json)?;
        if args.json {
            print_line(&json)?;
        }
    }
    if stop.interrupted() { Err(interrupted(&reports, runs.len())) } else { Ok(()) }
}

fn source(args: &SlabArgs) -> Result<Source, CliError> {
    match (args.source, args.cosine) {
        (SourceChoice::Pencil, cosine) => Ok(Source::Pencil { cosine: cosine.unwrap_or(1.0) }),
        (SourceChoice::Diffuse, None) => Ok(Source::Diffuse),
        (SourceChoice::Diffuse, Some(_)) => Err(CliError::input(
            "--cosine is the direction of a pencil beam; leave it out, or choose --source pencil",
        )),
    }
}

/// Simulates a run; nothing if it was interrupted before there was anything.
fn simulate(
    args: &SlabArgs,
    run: &MciRun,
    source: Source,
    number: u64,
    label: &str,
    stop: &Stop,
) -> Option<Finished> {
    let simulation = Simulation {
        stack: run.stack.clone(),
        source,
        grid: run.grid,
        photons: args.photons.unwrap_or(run.photons),
        // Runs of the same layers are to be independent of each other.
        seed: args.seed.wrapping_add(number),
    };
    tracing::info!("{label}: {} photons", simulation.photons);
    let progress = PhotonProgress::start(simulation.photons, label, args.quiet);
    let (scattered, photons) = simulation.run(|added| progress.advance(added), &stop.now);
    progress.bar.finish();
    let seconds = progress.bar.seconds();
    (photons > 0).then_some(Finished { simulation, scattered, photons, seconds })
}

fn interrupted(reports: &[RunReport], runs: usize) -> CliError {
    CliError::Interrupted(match reports.last() {
        None => "there was nothing to save yet".into(),
        Some(last) => format!(
            "what was done is saved: {} of {runs} runs, {} of {} photons of the last of them",
            reports.len(),
            last.photons,
            last.photons_asked_for
        ),
    })
}
