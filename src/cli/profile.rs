//! `alabaster profile`.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use super::choice::positive;
use super::console::{print_line, say};
use super::error::CliError;
use super::photon_progress::PhotonProgress;
use super::profile_input::{MediumArgs, models};
use super::stop::Stop;
use super::threads::ThreadArgs;
use crate::diffusion::HalfSpace;
use crate::film::output::replace;
use crate::study::numbers::significant;
use crate::study::profile::fit::{self, FitModel, in_words};
use crate::study::profile::{
    ChannelResult, Effort, FitProblem, FitResult, Material, MeasuredProfile, ModelChoice, Settings, Sweep,
    SweepPoint, Watch, compare, figures, lengths, summary, sweep, tables, truth,
};

/// Arguments of `profile`.
#[derive(Args)]
pub struct ProfileArgs {
    #[command(flatten)]
    medium: MediumArgs,
    /// Directory for tables and pictures; it is made if it is not there
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Models, separated by commas; `all` adds each fit of normalized diffusion [default: all the renderer has]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    models: Vec<String>,
    /// Photon packets of each Monte Carlo walk
    #[arg(long, value_name = "N", default_value_t = 4_000_000, value_parser = clap::value_parser!(u64).range(1..=1_000_000_000_000))]
    photons: u64,
    /// Fail, with exit code 1, if the L1 error of a model is larger than this share
    #[arg(long, value_name = "X", value_parser = positive, allow_negative_numbers = true)]
    max_error: Option<f64>,
    /// Report the light beyond this radius, m
    #[arg(long, value_name = "R", value_parser = positive, allow_negative_numbers = true)]
    cutoff: Option<f64>,
    /// Errors along a parameter: albedo (the reduced one), g or ior, as NAME=FROM:TO:COUNT
    #[arg(long, value_name = "SWEEP", conflicts_with = "fit")]
    sweep: Option<String>,
    /// Fit coefficients to a measured profile: CSV with columns such as radius_mm, reflectance_per_mm2, sigma
    #[arg(long, value_name = "CSV")]
    fit: Option<PathBuf>,
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

/// Files by name, to be written together.
type Files = Vec<(&'static str, String)>;

/// Compares, sweeps or fits, and writes what was found.
pub fn run(args: &ProfileArgs) -> Result<(), CliError> {
    args.threads.start()?;
    match (&args.fit, &args.sweep) {
        (Some(file), _) => run_fit(args, file),
        (None, Some(text)) => run_sweep(args, &text.parse().map_err(CliError::input)?),
        (None, None) => run_comparison(args),
    }
}

fn settings(args: &ProfileArgs) -> Result<Settings, CliError> {
    Ok(Settings {
        entry: args.medium.entry(),
        models: models(&args.models)?,
        effort: Effort { photons: args.photons, seed: args.seed },
    })
}

fn run_comparison(args: &ProfileArgs) -> Result<(), CliError> {
    let settings = settings(args)?;
    let material = args.medium.material()?;
    let body = check_models(&material, &settings)?;
    make_directory(&args.output)?;
    hint(&material);
    let walks = if material.thickness.is_some() { 1 } else { truth::walks_needed(&material.channels) };
    let stop = Stop::on_signals()?;
    tracing::info!("walking photons");
    let progress = PhotonProgress::start(walks.saturating_mul(args.photons), "Monte Carlo", args.quiet);
    let advance = |added| progress.advance(added);
    let watch = Watch { advance: &advance, stop: &stop.now };
    let results = compare(&material, &settings, watch).map_err(CliError::input)?;
    progress.bar.finish();
    let Some(results) = results else {
        return Err(CliError::Interrupted("there was nothing to save yet".into()));
    };
    let report = summary::json(&material, &settings, &results, args.cutoff);
    let mut files = vec![
        ("profile.csv", tables::profiles(&results)),
        ("errors.csv", tables::errors(&results)),
        ("profile.json", pretty(&report)),
    ];
    files.extend(figures::figures(&results).map_err(CliError::machine)?);
    let heading = format!("{}, {body}, {} entry", material.name, settings.entry.name());
    finish(args, &files, &report, &format!("{heading}\n{}", summary::table(&results, args.cutoff)))?;
    interrupted(&stop)?;
    check_errors(args, &results)
}

/// The body in words, if the models chosen are models of it.
fn check_models(material: &Material, settings: &Settings) -> Result<String, CliError> {
    let Some(thickness) = material.thickness else { return Ok("half-space".into()) };
    let others =
        |models: &Vec<ModelChoice>| models.iter().find(|&&choice| choice != ModelChoice::Multipole).copied();
    if let Some(choice) = settings.models.as_ref().and_then(others) {
        return Err(CliError::input(format!(
            "--models: {} is a model of a half-space, and {} is a slab {} mm thick; choose multipole, or make the layer thicker",
            choice.name(),
            material.name,
            significant(1e3 * thickness)
        )));
    }
    Ok(format!("slab {} mm thick", significant(1e3 * thickness)))
}

/// Lengths that are hardly meant are said before the work.
fn hint(material: &Material) {
    summary::notes(material).iter().for_each(|note| say(&format!("warning: {note}")));
}

fn check_errors(args: &ProfileArgs, results: &[ChannelResult]) -> Result<(), CliError> {
    let Some(limit) = args.max_error else { return Ok(()) };
    let too_large: Vec<String> = results
        .iter()
        .flat_map(|result| result.models.iter().map(move |model| (result, model)))
        // Also if it is not a number.
        .filter(|(_, model)| model.l1.partial_cmp(&limit).is_none_or(|order| order.is_gt()))
        .map(|(result, model)| {
            format!(
                "{} {:.4} ({} {})",
                model.choice.name(),
                model.l1,
                result.channel.name,
                result.quantity.name()
            )
        })
        .collect();
    if too_large.is_empty() {
        return Ok(());
    }
    Err(CliError::Failed(format!("L1 error above --max-error {limit}: {}", too_large.join(", "))))
}

/// The medium that a sweep starts from where none is given; its reduced mean free path does not matter.
fn usual_base(args: &ProfileArgs) -> Result<HalfSpace, CliError> {
    const REDUCED_ALBEDO: f64 = 0.9;
    let (g, eta) = (args.medium.only_g()?, args.medium.only_ior()?);
    HalfSpace::new(1.0 - REDUCED_ALBEDO, REDUCED_ALBEDO / (1.0 - g), g, eta).map_err(CliError::input)
}

fn run_sweep(args: &ProfileArgs, sweep: &Sweep) -> Result<(), CliError> {
    let settings = settings(args)?;
    let base = if args.medium.names_nothing() {
        usual_base(args)?
    } else {
        let material = args.medium.material()?;
        match (&*material.channels, material.thickness) {
            ([channel], None) => channel.medium,
            (_, Some(_)) => return Err(CliError::input("--sweep is of half-spaces; give a thicker layer")),
            _ => {
                return Err(CliError::input("--sweep is of one channel; give one value of each coefficient"));
            }
        }
    };
    make_directory(&args.output)?;
    let stop = Stop::on_signals()?;
    tracing::info!("walking photons");
    let progress =
        PhotonProgress::start(sweep.walks_needed().saturating_mul(args.photons), "Monte Carlo", args.quiet);
    let advance = |added| progress.advance(added);
    let points = sweep::run(sweep, &base, &settings, Watch { advance: &advance, stop: &stop.now })
        .map_err(CliError::input)?;
    progress.bar.finish();
    if points.is_empty() {
        return Err(CliError::Interrupted("there was nothing to save yet".into()));
    }
    let report = sweep_json(sweep, &points, &settings);
    let csv = sweep::csv(sweep, &points);
    let picture = sweep::figure(sweep, &points).map_err(CliError::machine)?;
    let files = vec![("sweep.csv", csv.clone()), ("sweep.json", pretty(&report)), ("sweep.svg", picture)];
    finish(args, &files, &report, csv.trim_end())?;
    interrupted(&stop)?;
    let results: Vec<ChannelResult> = points.into_iter().map(|point| point.result).collect();
    check_errors(args, &results)
}

fn sweep_json(sweep: &Sweep, points: &[SweepPoint], settings: &Settings) -> Value {
    let point = |point: &SweepPoint| {
        let truth = point.result.truth.total();
        let models = point.result.models.iter();
        let models = models
            .map(|model| json!({"name": model.choice.name(), "albedo": model.albedo, "l1_error": model.l1}));
        json!({
            "value": point.value,
            "truth": {"albedo": truth.value, "stderr": truth.standard_error, "exact_albedo": point.result.exact_albedo},
            "l1_noise": point.result.noise,
            "models": models.collect::<Vec<_>>(),
        })
    };
    json!({
        "parameter": sweep.parameter.name(),
        "entry": settings.entry.name(),
        "photons": settings.effort.photons,
        "seed": settings.effort.seed,
        "points": points.iter().map(point).collect::<Vec<_>>(),
    })
}

fn run_fit(args: &ProfileArgs, file: &Path) -> Result<(), CliError> {
    if !args.medium.names_nothing() {
        return Err(CliError::input(
            "--fit finds the material; of it, only --g, --ior and --entry can be given",
        ));
    }
    let wrong = |problem: String| CliError::input(format!("{}: {problem}", file.display()));
    let text = fs::read_to_string(file).map_err(|error| wrong(format!("cannot be read: {error}")))?;
    let measured = MeasuredProfile::from_csv(&text).map_err(|error| wrong(error.to_string()))?;
    let problem = fit_problem(args)?;
    let found = fit::fit(&problem, &measured).map_err(|error| wrong(error.to_string()))?;
    make_directory(&args.output)?;
    let report = fit_json(&problem, &found);
    let picture = fit::figure(&problem, &measured, &found).map_err(CliError::machine)?;
    let files =
        vec![("fit.json", pretty(&report)), ("fit.csv", fit_csv(&measured, &found)), ("fit.svg", picture)];
    finish(args, &files, &report, &fit_text(&problem, &found))
}

fn fit_problem(args: &ProfileArgs) -> Result<FitProblem, CliError> {
    let (entry, g, eta) = (args.medium.entry(), args.medium.only_g()?, args.medium.only_ior()?);
    // Refuses what no medium has.
    HalfSpace::new(0.0, 1.0, g, eta).map_err(CliError::input)?;
    let model = match models(&args.models)?.as_deref() {
        None | Some([ModelChoice::Tabulated]) => FitModel::Tabulated,
        Some([choice]) if choice.name() == FitModel::PhotonBeam.name() => FitModel::PhotonBeam,
        Some(_) => return Err(CliError::input("--fit takes --models tabulated or --models photon-beam")),
    };
    Ok(FitProblem { entry, eta, g, model })
}

fn fit_json(problem: &FitProblem, found: &FitResult) -> Value {
    let fitted = |f: fit::Fitted| json!({"value": f.value, "stderr": f.stderr});
    json!({
        "model": problem.model.name(),
        "entry": problem.entry.name(),
        "g": problem.g,
        "ior": problem.eta,
        "sigma_s_reduced": fitted(found.sigma_s_reduced),
        "sigma_a": fitted(found.sigma_a),
        "sigma_s": found.sigma_s_reduced.value / (1.0 - problem.g),
        "scale": found.scale.map(fitted),
        "correlation": found.correlation,
        "chi_squared": found.chi_squared,
        "degrees_of_freedom": found.degrees,
        "rms_log_residual": found.rms,
        "weighted": found.weighted,
        "units": "1/m",
    })
}

fn fit_csv(measured: &MeasuredProfile, found: &FitResult) -> String {
    let per_area = if measured.absolute { 1e-6 } else { 1.0 };
    let unit = if measured.absolute { "_per_mm2" } else { "" };
    let rows = measured.points.iter().zip(&found.curve).map(|(point, curve)| {
        format!("{:.7e},{:.7e},{:.7e}\n", 1e3 * point.radius, per_area * point.reflectance, per_area * curve)
    });
    format!("radius_mm,reflectance{unit},fitted{unit}\n{}", rows.collect::<String>())
}

fn fit_text(problem: &FitProblem, found: &FitResult) -> String {
    let scatter = format!("{:.2} % rms about the curve", 100.0 * found.rms);
    let quality = if found.weighted {
        format!("chi^2 {:.2} for {} degrees of freedom, {scatter}", found.chi_squared, found.degrees)
    } else {
        format!("{scatter}; standard errors are from this scatter, as the file gives no sigma")
    };
    let scale = found
        .scale
        .map_or_else(String::new, |scale| format!("\n  scale            {}", in_words(scale, 1.0)));
    let (scattering, absorption) = (found.sigma_s_reduced.value, found.sigma_a.value);
    let lengths = HalfSpace::new(absorption, scattering / (1.0 - problem.g), problem.g, problem.eta)
        .map_or_else(|_| String::new(), |medium| format!("\n  {}", lengths::mean_free_paths(&medium)));
    format!(
        "{} fitted, {} entry, g {}, ior {}:\n  reduced sigma_s  {} 1/m\n  sigma_a          {} 1/m{scale}\n  correlation {:+.3} of their logarithms; {quality}{lengths}",
        problem.model.name(),
        problem.entry.name(),
        problem.g,
        problem.eta,
        in_words(found.sigma_s_reduced, 1.0),
        in_words(found.sigma_a, 1.0),
        found.correlation,
    )
}

fn make_directory(path: &Path) -> Result<(), CliError> {
    fs::create_dir_all(path).map_err(|error| {
        CliError::machine(format!("{}: the directory cannot be made: {error}", path.display()))
    })
}

/// Writes the files, and says what was found.
fn finish(args: &ProfileArgs, files: &Files, report: &Value, text: &str) -> Result<(), CliError> {
    for (name, content) in files {
        replace(&args.output.join(name), |file| file.write_all(content.as_bytes()))?;
    }
    if args.json {
        return print_line(&report.to_string());
    }
    if args.quiet { Ok(()) } else { print_line(text) }
}

fn pretty(report: &Value) -> String {
    format!("{report:#}\n")
}

fn interrupted(stop: &Stop) -> Result<(), CliError> {
    if stop.interrupted() {
        return Err(CliError::Interrupted("what was done, with fewer photons, is saved".into()));
    }
    Ok(())
}
