//! What `alabaster profile` studies: material and models from the command line.

use std::ffi::OsStr;
use std::path::Path;

use clap::{Args, ValueEnum};

use super::error::CliError;
use crate::medium::Entry;
use crate::slab::read_mci;
use crate::study::profile::{Coefficients, Material, MaterialError, ModelChoice};

/// The medium of `profile`.
#[derive(Args)]
pub struct MediumArgs {
    /// Measured material (`alabaster materials` lists them), or an .mci file of one layer
    #[arg(value_name = "MATERIAL|FILE.mci")]
    material: Option<String>,
    /// Times as many scatterers and absorbers as measured
    #[arg(long, value_name = "X", allow_hyphen_values = true)]
    density: Option<f64>,
    /// Absorption coefficient, 1/m; one value, or three: red,green,blue
    #[arg(long, value_name = "LIST", value_delimiter = ',', allow_hyphen_values = true)]
    sigma_a: Vec<f64>,
    /// Scattering coefficient (not reduced), 1/m; one value or three
    #[arg(long, value_name = "LIST", value_delimiter = ',', allow_hyphen_values = true)]
    sigma_s: Vec<f64>,
    /// Share of the light that enters which is to leave again (for --entry); one value or three
    #[arg(long, value_name = "LIST", value_delimiter = ',', allow_hyphen_values = true)]
    albedo: Vec<f64>,
    /// Mean free path 1/sigma_t, m; one value or three
    #[arg(long, value_name = "LIST", value_delimiter = ',', allow_hyphen_values = true)]
    mean_free_path: Vec<f64>,
    /// Mean cosine of the phase function; one value or three [default: 0]
    #[arg(long, value_name = "LIST", value_delimiter = ',', allow_hyphen_values = true)]
    g: Vec<f64>,
    /// Index of refraction, over that outside; one value or three [default: the material's, or 1.5]
    #[arg(long, value_name = "LIST", value_delimiter = ',', allow_hyphen_values = true)]
    ior: Vec<f64>,
    /// How light enters
    #[arg(long, value_enum, default_value_t)]
    entry: EntryChoice,
}

/// How light enters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum EntryChoice {
    /// A pencil beam straight down
    #[default]
    Normal,
    /// Light from all sides alike, at a point
    Diffuse,
}

/// Index of refraction where none is given, as in scene files.
const USUAL_IOR: f64 = 1.5;

impl MediumArgs {
    /// How light enters.
    pub fn entry(&self) -> Entry {
        match self.entry {
            EntryChoice::Normal => Entry::Normal,
            EntryChoice::Diffuse => Entry::Diffuse,
        }
    }

    /// The only mean cosine.
    pub fn only_g(&self) -> Result<f64, CliError> {
        only("--g", &self.g, 0.0)
    }

    /// The only index.
    pub fn only_ior(&self) -> Result<f64, CliError> {
        only("--ior", &self.ior, USUAL_IOR)
    }

    /// Whether nothing is said of a material.
    pub fn names_nothing(&self) -> bool {
        self.material.is_none()
            && self.density.is_none()
            && [&self.sigma_a, &self.sigma_s, &self.albedo, &self.mean_free_path].iter().all(|v| v.is_empty())
    }

    /// The material that is meant.
    pub fn material(&self) -> Result<Material, CliError> {
        let coefficients = !self.sigma_a.is_empty() || !self.sigma_s.is_empty();
        let look = !self.albedo.is_empty() || !self.mean_free_path.is_empty();
        if self.density.is_some() && (self.material.is_none() || self.mci().is_some()) {
            return Err(CliError::input("--density goes with a measured material; leave it out"));
        }
        match (&self.material, coefficients, look) {
            (Some(name), false, false) => match self.mci() {
                Some(path) => self.of_file(path),
                None => {
                    let eta = (!self.ior.is_empty()).then_some(&*self.ior);
                    Material::measured(name, self.density.unwrap_or(1.0), &self.g_or_0(), eta).map_err(input)
                }
            },
            (None, true, false) => {
                both(("--sigma-a", &self.sigma_a), ("--sigma-s", &self.sigma_s))?;
                let coefficients = Coefficients {
                    sigma_a: self.sigma_a.clone(),
                    sigma_s: self.sigma_s.clone(),
                    g: self.g_or_0(),
                    eta: self.ior_or_usual(),
                };
                Material::of_coefficients("custom", &coefficients).map_err(input)
            }
            (None, false, true) => {
                both(("--albedo", &self.albedo), ("--mean-free-path", &self.mean_free_path))?;
                let (g, eta) = (self.g_or_0(), self.ior_or_usual());
                Material::of_albedo(&self.albedo, &self.mean_free_path, &g, &eta, self.entry()).map_err(input)
            }
            (None, false, false) => Err(CliError::input(
                "which material? Give the name of a measured one (`alabaster materials` lists them), an .mci file, \
                 --sigma-a and --sigma-s, or --albedo and --mean-free-path",
            )),
            _ => Err(CliError::input(
                "the material is given twice; give one of: a name or an .mci file, --sigma-a and --sigma-s, --albedo and \
                 --mean-free-path",
            )),
        }
    }

    fn mci(&self) -> Option<&Path> {
        let path = Path::new(self.material.as_deref()?);
        path.extension()
            .and_then(OsStr::to_str)
            .filter(|ending| ending.eq_ignore_ascii_case("mci"))
            .map(|_| path)
    }

    fn of_file(&self, path: &Path) -> Result<Material, CliError> {
        if !self.g.is_empty() || !self.ior.is_empty() {
            return Err(CliError::input(format!(
                "{} has g and ior in it: leave out --g and --ior",
                path.display()
            )));
        }
        read_layer(path)
    }

    fn g_or_0(&self) -> Vec<f64> {
        if self.g.is_empty() { vec![0.0] } else { self.g.clone() }
    }

    fn ior_or_usual(&self) -> Vec<f64> {
        if self.ior.is_empty() { vec![USUAL_IOR] } else { self.ior.clone() }
    }
}

/// Metres in the unit of .mci files.
const CENTIMETRE: f64 = 1e-2;

/// The material of an .mci file of one run and one layer.
fn read_layer(path: &Path) -> Result<Material, CliError> {
    let wrong = |problem: String| CliError::input(format!("{}: {problem}", path.display()));
    let runs = read_mci(path).map_err(|error| wrong(error.to_string()))?;
    let run = match &*runs {
        [run] => run,
        [_, second, ..] => {
            let problem = format!("line {}: a second run begins; give a file of a single one", second.line);
            return Err(wrong(problem));
        }
        [] => return Err(wrong("there is no run in it".into())),
    };
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    Material::of_layer(&name, &run.stack, CENTIMETRE)
        .map_err(|error| wrong(format!("run on line {}: {error}", run.line)))
}

fn input(error: MaterialError) -> CliError {
    CliError::input(error)
}

fn both(first: (&str, &[f64]), second: (&str, &[f64])) -> Result<(), CliError> {
    match (first.1.is_empty(), second.1.is_empty()) {
        (false, true) => Err(CliError::input(format!("{} goes with {}; give both", first.0, second.0))),
        (true, false) => Err(CliError::input(format!("{} goes with {}; give both", second.0, first.0))),
        _ => Ok(()),
    }
}

fn only(name: &str, values: &[f64], usual: f64) -> Result<f64, CliError> {
    match values {
        [] => Ok(usual),
        [value] => Ok(*value),
        _ => Err(CliError::input(format!("{name}: a single value is wanted here"))),
    }
}

/// The models of `names`; none: the usual ones.
pub fn models(names: &[String]) -> Result<Option<Vec<ModelChoice>>, CliError> {
    if names.is_empty() {
        return Ok(None);
    }
    if names.iter().any(|name| name == "all") {
        return Ok(Some(ModelChoice::ALL.to_vec()));
    }
    let known = || {
        let names = ModelChoice::ALL.iter().map(|choice| choice.name());
        names.chain(["multipole", "all"]).collect::<Vec<_>>().join(", ")
    };
    let mut choices = Vec::new();
    for name in names {
        let choice = ModelChoice::from_name(name).ok_or_else(|| {
            CliError::input(format!("--models: there is no model `{name}`; there are: {}", known()))
        })?;
        if !choices.contains(&choice) {
            choices.push(choice);
        }
    }
    Ok(Some(choices))
}
