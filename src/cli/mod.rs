//! Commands: parse, call, print. One file a command.

mod backend;
mod bar;
mod bench;
mod check;
mod check_report;
mod choice;
mod compare;
mod compare_report;
mod console;
mod error;
mod force;
mod materials;
mod photon_progress;
mod plan;
mod profile;
mod profile_input;
mod progress;
mod render;
mod report;
mod slab;
mod slab_outputs;
mod slab_report;
mod stop;
mod study;
mod threads;
mod tonemap;

use std::io::{self, IsTerminal};
use std::panic;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::{Parser, Subcommand};
use tracing_subscriber::EnvFilter;

use console::say;
use error::{CliError, Exit};

/// Renders translucent things by the physics of light: subsurface scattering with probe rays.
#[derive(Parser)]
#[command(name = "alabaster", version, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,

    /// Say more on standard error (-vv: still more); the variable RUST_LOG overrides it
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    verbose: u8,
}

#[derive(Subcommand)]
enum Command {
    /// Renders a scene (.toml, .glb or .gltf) to .exr and .png pictures
    Render(render::RenderArgs),
    /// Says which method each translucent object gets, and which errors are to be expected of it
    Plan(plan::PlanArgs),
    /// Checks the laws of scattering on every material, and what each order of scattering adds to the picture
    Check(check::CheckArgs),
    /// Makes a .png picture for people of an .exr
    Tonemap(tonemap::TonemapArgs),
    /// Compares a picture with a reference (both .exr): errors, bias with its noise, what an eye would see
    Compare(compare::CompareArgs),
    /// Walks photons through layers as an MCML input file (.mci) says: reflectance, transmittance, absorption
    Slab(slab::SlabArgs),
    /// Studies diffusion profiles: every model of R(r) beside photon Monte Carlo, as tables and pictures
    Profile(profile::ProfileArgs),
    /// Shows what accuracy costs in time: error against seconds for every method, as a report of one file
    Study(study::StudyArgs),
    /// Lets the ray casters race on the rays of a scene: speed, memory, and whether they agree
    Bench(bench::BenchArgs),
    /// Lists the measured materials with their sources
    Materials(materials::MaterialsArgs),
}

/// Runs the command line; returns the exit code promised in the guide.
pub fn main() -> ExitCode {
    report_panics_in_one_line();
    let outcome = panic::catch_unwind(|| {
        let cli = match Cli::try_parse() {
            Ok(cli) => cli,
            Err(message) => return print_usage(&message),
        };
        start_log(cli.verbose);
        match run(cli.command) {
            Ok(()) => Exit::Done,
            Err(error) => {
                error.print();
                error.exit()
            }
        }
    });
    outcome.unwrap_or(Exit::Machine).into()
}

fn run(command: Command) -> Result<(), CliError> {
    match command {
        Command::Render(args) => render::run(&args),
        Command::Plan(args) => plan::run(&args),
        Command::Check(args) => check::run(&args),
        Command::Tonemap(args) => tonemap::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Slab(args) => slab::run(&args),
        Command::Profile(args) => profile::run(&args),
        Command::Study(args) => study::run(&args),
        Command::Bench(args) => bench::run(&args),
        Command::Materials(args) => materials::run(&args),
    }
}

/// Help and version are asked for; anything else that the parser has to say is an error.
fn print_usage(message: &clap::Error) -> Exit {
    // Nothing can be said where the stream is closed.
    let _ = message.print();
    if message.use_stderr() { Exit::Input } else { Exit::Done }
}

/// A panic is a defect of the program. It is said once, without a backtrace, and ends in an exit code.
fn report_panics_in_one_line() {
    static REPORTED: AtomicBool = AtomicBool::new(false);
    panic::set_hook(Box::new(|panic| {
        if REPORTED.swap(true, Ordering::Relaxed) {
            return;
        }
        let payload = panic.payload();
        let formatted = payload.downcast_ref::<String>().map(String::as_str);
        let what = formatted.or(payload.downcast_ref::<&str>().copied()).unwrap_or("unknown");
        let place = panic.location().map(|place| format!(" ({place})")).unwrap_or_default();
        say(&format!("error: internal error, please report it: {what}{place}"));
    }));
}

fn start_log(verbose: u8) {
    let level = match verbose {
        0 => "warn",
        1 => "info",
        _ => "debug",
    };
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new(level));
    tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(io::stderr)
        .with_ansi(io::stderr().is_terminal())
        .without_time()
        .init();
}
