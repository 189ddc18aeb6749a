//! `alabaster render`.

use std::env;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use clap::Args;

use super::backend::{RayWork, run_on};
use super::choice::{LayerChoice, SubsurfaceArgs, ViewChoice, finite, named, positive};
use super::console::{print_line, say};
use super::error::CliError;
use super::force::ForceArgs;
use super::plan;
use super::progress::Progress;
use super::report::{MadeBy, MethodOf, Report};
use super::stop::Stop;
use super::threads::ThreadArgs;
use crate::diffusion::ProfileKind;
use crate::film::accumulator::MAX_SAMPLES;
use crate::film::exr::Attribute;
use crate::film::layers::Channel;
use crate::film::output::{Format, check_writable, replace};
use crate::film::schedule::{Limits, Status};
use crate::film::{Film, exr, png};
use crate::raycast::{Backend, Geometry, RayCaster, RaycastError};
use crate::scene::{Light, Scene};
use crate::transport::{Counters, Renderer};

/// Samples of each part of the power balance: a few per cent of noise, for less than a second.
const POWER_SAMPLES: u64 = 1024;

/// Arguments of `render`.
#[derive(Args)]
pub struct RenderArgs {
    /// Scene to render: .toml, .glb or .gltf
    scene: PathBuf,
    /// Picture to write, .exr or .png; may be given several times
    #[arg(short, long, required = true, value_name = "FILE")]
    output: Vec<PathBuf>,
    /// Width in pixels [default: the scene's]
    #[arg(long)]
    width: Option<u32>,
    /// Height in pixels [default: the scene's]
    #[arg(long)]
    height: Option<u32>,
    /// Stop after so many samples per pixel [default: the scene's, unless --time or --error is given]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=MAX_SAMPLES))]
    spp: Option<u64>,
    /// Stop after so many seconds of rendering, at the earliest after one sample per pixel
    #[arg(long, value_name = "SECONDS", value_parser = positive)]
    time: Option<f64>,
    /// Stop when the estimated relative error (square root of relMSE) is at most this
    #[arg(long, value_name = "REL", value_parser = positive)]
    error: Option<f64>,
    #[command(flatten)]
    subsurface: SubsurfaceArgs,
    /// Let walks take isotropic scattering for anisotropic far from surfaces: faster, an approximation [default: the scene's]
    #[arg(long)]
    similarity: bool,
    #[command(flatten)]
    force: ForceArgs,
    /// What casts the rays
    #[arg(long, value_parser = named(Backend::NAMES), default_value = Backend::default().name())]
    backend: Backend,
    /// Seed of all random numbers: the same seed, scene and samples give the same bits
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    threads: ThreadArgs,
    /// Layers to write into .exr beside the colour
    #[arg(long, value_name = "LAYERS", value_delimiter = ',')]
    aov: Vec<LayerChoice>,
    /// How .png shows radiance
    #[arg(long, value_enum, default_value_t)]
    view: ViewChoice,
    /// Exposure of .png in EV: each one doubles
    #[arg(long, value_name = "EV", default_value_t = 0.0, value_parser = finite, allow_negative_numbers = true)]
    exposure: f32,
    /// Print nothing but warnings and errors
    #[arg(long)]
    quiet: bool,
    /// Print what was done as JSON on standard output
    #[arg(long)]
    json: bool,
}

/// Renders a scene and writes the pictures.
pub fn run(args: &RenderArgs) -> Result<(), CliError> {
    for path in &args.output {
        Format::of(path)?;
        check_writable(path)?;
    }
    args.threads.start()?;
    let scene = scene_with_overrides(args)?;
    run_on(args.backend, Render { args, scene })
}

struct Render<'a> {
    args: &'a RenderArgs,
    scene: Scene,
}

impl RayWork for Render<'_> {
    fn run<C: RayCaster>(self, build: impl Fn(&Geometry) -> Result<C, RaycastError>) -> Result<(), CliError> {
        let Self { args, scene } = self;
        let film = Film::new(scene.film.width, scene.film.height)?;
        let mut renderer = args.force.renderer(scene, args.seed, build)?;
        render_and_save(args, &mut renderer, film)
    }
}

fn scene_with_overrides(args: &RenderArgs) -> Result<Scene, CliError> {
    let mut scene = args.force.read_scene(&args.scene)?;
    scene.film.width = args.width.unwrap_or(scene.film.width);
    scene.film.height = args.height.unwrap_or(scene.film.height);
    args.subsurface.override_in(&mut scene.subsurface);
    scene.subsurface.similarity |= args.similarity;
    Ok(scene)
}

/// Backend, kernel, methods and profiles in use.
fn made_by<C: RayCaster>(args: &RenderArgs, renderer: &Renderer<C>) -> MadeBy {
    let method = renderer.scene().subsurface.method.name();
    let methods = renderer.plan().objects.iter().map(MethodOf::new).collect();
    let profiles = renderer.profiles().into_iter().map(ProfileKind::name).collect();
    let light_power = renderer.scene().lights.iter().filter_map(Light::power).sum();
    let (backend, kernel) = (args.backend.name(), renderer.kernel().name());
    MadeBy { backend, kernel, method, methods, profiles, light_power }
}

fn limits(args: &RenderArgs, scene: &Scene) -> Limits {
    let only_the_scene_limits = args.spp.is_none() && args.time.is_none() && args.error.is_none();
    Limits {
        samples: if only_the_scene_limits { Some(scene.render.spp.into()) } else { args.spp },
        seconds: args.time,
        relative_error: args.error,
    }
}

fn render_and_save<C: RayCaster>(
    args: &RenderArgs,
    renderer: &mut Renderer<C>,
    mut film: Film,
) -> Result<(), CliError> {
    let stop = Stop::on_signals()?;
    let limits = limits(args, renderer.scene());
    let (counters, seconds) = render(renderer, &mut film, limits, &stop, args.quiet);
    let mut report = Report::new(&film, &counters, seconds, made_by(args, renderer), &args.output);
    if report.samples == 0 && stop.interrupted() {
        return Err(CliError::Interrupted("there was nothing to save yet".into()));
    }
    let plan = plan::as_json(renderer.plan(), &renderer.scene().subsurface).to_string();
    save(args, &film, &report, plan)?;
    report.print_warnings();
    if args.json {
        if !stop.interrupted() {
            report.set_power(&renderer.power_balance(POWER_SAMPLES));
        }
        print_line(&report.json()?)?;
    } else if !args.quiet {
        say(&report.summary());
    }
    if stop.interrupted() {
        let saved = format!("what was done, {} samples per pixel or more, is saved", report.spp);
        return Err(CliError::Interrupted(saved));
    }
    Ok(())
}

/// Takes samples, pass after pass, until a limit is reached or a signal comes. What was counted, and
/// the seconds it took.
fn render<C: RayCaster>(
    renderer: &Renderer<C>,
    film: &mut Film,
    limits: Limits,
    stop: &Stop,
    quiet: bool,
) -> (Counters, f64) {
    let mut counters = Counters::default();
    tracing::info!("rendering {} × {} pixels", film.width(), film.height());
    let progress = Progress::start(limits, film.pixel_count(), quiet);
    let mut status = Status { samples: 0, seconds: 0.0, relative_error: f64::INFINITY };
    while let Some(pass) = limits.next_pass(&status) {
        // The first pass is done whatever it takes, so that every pixel has a sample.
        let deadline = limits.seconds.filter(|_| status.samples > 0).unwrap_or(f64::INFINITY);
        let counted = renderer.expose(film, status.samples..status.samples + pass, &stop.now, &|added| {
            progress.advance(added);
            if progress.seconds() >= deadline {
                stop.now.store(true, Ordering::Relaxed);
            }
        });
        counters.merge(&counted);
        if stop.now.load(Ordering::Relaxed) {
            break;
        }
        status = Status {
            samples: status.samples + pass,
            seconds: progress.seconds(),
            relative_error: film.relative_error(),
        };
        progress.set_relative_error(status.relative_error);
    }
    progress.finish();
    (counters, progress.seconds())
}

fn save(args: &RenderArgs, film: &Film, report: &Report, plan: String) -> Result<(), CliError> {
    let picture = film.picture();
    let layers = LayerChoice::layers(&args.aov);
    let channels: Vec<Channel> = layers.into_iter().flat_map(|layer| film.layer(layer)).collect();
    let attributes = attributes(args, report, plan)?;
    for path in &args.output {
        let format = Format::of(path)?;
        replace(path, |file| match format {
            Format::Exr => exr::write(file, &picture, &channels, &attributes),
            Format::Png => png::write(file, &picture, args.view.into(), args.exposure),
        })?;
    }
    Ok(())
}

/// What stands in the header of an .exr: everything needed to make the picture again.
fn attributes(args: &RenderArgs, report: &Report, plan: String) -> Result<Vec<Attribute>, CliError> {
    Ok(vec![
        ("alabaster.version", env!("CARGO_PKG_VERSION").into()),
        ("alabaster.commandLine", command_line()),
        ("alabaster.scene", file_name(&args.scene)),
        ("alabaster.seed", args.seed.to_string()),
        ("alabaster.plan", plan),
        ("alabaster.profiles", report.profiles.join(", ")),
        ("alabaster.spp", report.spp.to_string()),
        ("alabaster.seconds", report.seconds.to_string()),
        ("alabaster.nonfinite", report.nonfinite.to_string()),
        ("alabaster.report", report.json()?),
    ])
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The command line, arguments with blanks quoted.
fn command_line() -> String {
    let arguments = env::args_os().map(|argument| {
        let text = argument.to_string_lossy().into_owned();
        if text.is_empty() || text.contains(char::is_whitespace) { format!("{text:?}") } else { text }
    });
    arguments.collect::<Vec<_>>().join(" ")
}
