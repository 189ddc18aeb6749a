//! Media of scenes from tables by wavelength.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use super::{ScatteringInput, SceneError};
use crate::radiometry::spectrum::channels::channel_means;
use crate::radiometry::spectrum::medium_table::MediumTable;
use crate::radiometry::spectrum::{LONGEST, SHORTEST};

/// The wavelength whose mean cosine and index of refraction stand for all others, nm.
const TYPICAL: f64 = 550.0;

/// How far mean cosines may be apart over a table before that is worth a warning.
const G_RANGE: f64 = 0.02;
/// The same of indices of refraction.
const IOR_RANGE: f64 = 0.01;

/// A medium read from a table.
#[derive(Debug)]
pub struct TabulatedMedium {
    /// Its coefficients.
    pub medium: ScatteringInput,
    /// Index of refraction at 550 nm, where the table has one.
    pub ior: Option<f32>,
    /// What is taken for constant and is not, each completing "material …: ".
    pub warnings: Vec<String>,
}

/// Reads a medium from the table in `file`. `g` is the mean cosine, where the table has none.
///
/// A body has one mean cosine g and one index, those at 550 nm. Reduced scattering μ_s' is kept at every wavelength, so that μ_s is
/// μ_s'/(1 − g).
///
/// # Errors
/// If there is no such file or table, or both the table and `g` say what the mean cosine is.
pub fn read_medium(file: &Path, g: Option<f32>) -> Result<TabulatedMedium, SceneError> {
    let table = read_table(file, g)?;
    let refused = |problem: &str| Err(SceneError::file(file, problem));
    let typical = table.at(TYPICAL);
    let (g, ior) = (typical.g as f32, typical.ior.map(|ior| ior as f32));
    // Both are within bounds in double precision.
    if g.abs() >= 1.0 || ior.is_some_and(|ior| !(ior > 0.0 && ior.is_finite())) {
        return refused("g or n at 550 nm is at the end of what single precision can tell");
    }
    let at = |nanometres: f64| table.similar(nanometres, f64::from(g));
    let visible = (SHORTEST as u32..=LONGEST as u32).map(|nanometres| at(f64::from(nanometres)));
    if !visible.map(|medium| (medium.mu_a + medium.mu_s) as f32).all(f32::is_finite) {
        return refused("coefficients are larger than can be computed; are their units right?");
    }
    let sigma_a = channel_means(|nanometres| at(nanometres).mu_a);
    let sigma_s = channel_means(|nanometres| at(nanometres).mu_s);
    let warnings = warnings(&table, file, sigma_s.is_black());
    let medium = ScatteringInput::Spectral { sigma_a, sigma_s, g, table: Arc::new(table) };
    Ok(TabulatedMedium { medium, ior, warnings })
}

fn read_table(file: &Path, g: Option<f32>) -> Result<MediumTable, SceneError> {
    let text = fs::read_to_string(file).map_err(|error| SceneError::file(file, error.to_string()))?;
    let mut table = MediumTable::parse(&text)
        .map_err(|error| SceneError::at(file, format!("line {}", error.line), error.problem.to_string()))?;
    if let Some(g) = g {
        if table.has_mean_cosine() {
            let problem = "the table has a column g, and the material has a `g`; leave one of them out";
            return Err(SceneError::file(file, problem));
        }
        table.set_mean_cosine(f64::from(g));
    }
    Ok(table)
}

fn warnings(table: &MediumTable, file: &Path, is_clear: bool) -> Vec<String> {
    let typical = table.at(TYPICAL);
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let varies = |[low, high]: [f64; 2], limit: f64, what: &str, taken: f64| {
        (high - low > limit).then(|| {
            format!("{what} of {name} goes from {low} to {high}; {taken:.4}, that at {TYPICAL} nm, stands for all wavelengths")
        })
    };
    let all = [
        varies(table.mean_cosines(), G_RANGE, "g", typical.g).map(|said| said + ", reduced scattering kept"),
        table.indices().zip(typical.ior).and_then(|(range, ior)| varies(range, IOR_RANGE, "n", ior)),
        is_clear.then(|| {
            format!(
                "nothing scatters in {name}: it is taken for clear, absorbing as red, green and blue see it"
            )
        }),
    ];
    all.into_iter().flatten().collect()
}
