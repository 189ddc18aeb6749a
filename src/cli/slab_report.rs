//! What a slab simulation found: for machines as JSON, for people as a table.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::error::CliError;
use super::progress::{duration, quantity};
use super::slab_outputs::Finished;
use crate::slab::{Estimate, Source};

/// Totals of a run, per photon sent in; lengths in centimetres.
#[derive(Debug, Serialize)]
pub struct RunReport {
    specular: f64,
    specular_stderr: f64,
    diffuse_reflectance: Estimate,
    absorbed: Estimate,
    /// The unscattered beam included.
    transmitted: Estimate,
    unscattered_transmittance: Estimate,
    single_scattering_reflectance: Estimate,
    single_scattering_transmittance: Estimate,
    absorbed_by_layer: Vec<Estimate>,
    /// Specular, diffuse, absorbed, transmitted together.
    accounted: Estimate,
    collisions_per_photon: Estimate,
    /// Mean length of the way of light that left at the top; `null` if there was none.
    mean_reflected_path_cm: Option<f64>,
    /// The same at the bottom.
    mean_transmitted_path_cm: Option<f64>,
    /// Packets walked.
    pub photons: u64,
    /// Packets asked for: more, if the run was interrupted.
    pub photons_asked_for: u64,
    photons_per_second: f64,
    seconds: f64,
    threads: usize,
    seed: u64,
    source: String,
    outputs: Vec<PathBuf>,
}

impl RunReport {
    /// The report of a run written to `outputs`.
    pub fn new<'a>(finished: &Finished, outputs: impl Iterator<Item = &'a Path>) -> Self {
        let Finished { simulation, scattered, photons, seconds } = finished;
        let mean = |path: Estimate, share: Estimate| (share.value > 0.0).then(|| path.value / share.value);
        Self {
            specular: scattered.specular.value,
            specular_stderr: scattered.specular.standard_error,
            diffuse_reflectance: scattered.diffuse_reflectance,
            absorbed: scattered.absorbed,
            transmitted: scattered.transmitted,
            unscattered_transmittance: scattered.unscattered_transmittance,
            single_scattering_reflectance: scattered.single_scattering_reflectance,
            single_scattering_transmittance: scattered.single_scattering_transmittance,
            absorbed_by_layer: scattered.absorbed_by_layer.clone(),
            accounted: scattered.accounted,
            collisions_per_photon: scattered.collisions_per_photon,
            mean_reflected_path_cm: mean(scattered.reflected_path_length, scattered.diffuse_reflectance),
            mean_transmitted_path_cm: mean(scattered.transmitted_path_length, scattered.transmitted),
            photons: *photons,
            photons_asked_for: simulation.photons,
            photons_per_second: *photons as f64 / seconds.max(1e-9),
            seconds: *seconds,
            threads: rayon::current_num_threads(),
            seed: simulation.seed,
            source: match simulation.source {
                Source::Pencil { cosine } => format!("pencil beam, cosine {cosine}"),
                Source::Diffuse => "diffuse".into(),
            },
            outputs: outputs.map(Path::to_path_buf).collect(),
        }
    }

    /// As a table.
    pub fn table(&self, label: &str) -> String {
        let mut text = format!(
            "{label}: {} photons in {} ({}photons/s), {}, seed {}",
            self.photons,
            duration(self.seconds),
            quantity(self.photons_per_second),
            self.source,
            self.seed,
        );
        let specular = Estimate { value: self.specular, standard_error: self.specular_stderr };
        let mut row = |name: &str, estimate: Estimate| {
            let _ = write!(
                text,
                "\n  {name:<28} {} ± {}",
                number(estimate.value),
                number(estimate.standard_error)
            );
        };
        row("specular reflectance", specular);
        row("diffuse reflectance", self.diffuse_reflectance);
        row("  after one collision", self.single_scattering_reflectance);
        row("absorbed", self.absorbed);
        if self.absorbed_by_layer.len() > 1 {
            for (i, &absorbed) in self.absorbed_by_layer.iter().enumerate() {
                row(&format!("  in layer {}", i + 1), absorbed);
            }
        }
        row("transmitted", self.transmitted);
        row("  unscattered", self.unscattered_transmittance);
        row("  after one collision", self.single_scattering_transmittance);
        row("specular + diffuse + abs. + T", self.accounted);
        row("collisions per photon", self.collisions_per_photon);
        for (name, path) in [
            ("mean path, reflected", self.mean_reflected_path_cm),
            ("mean path, transmitted", self.mean_transmitted_path_cm),
        ] {
            if let Some(path) = path {
                let _ = write!(text, "\n  {name:<28} {} cm", number(path));
            }
        }
        for output in &self.outputs {
            let _ = write!(text, "\n  written to {}", output.display());
        }
        text
    }
}

/// The object that is printed.
#[derive(Serialize)]
struct Reports<'a> {
    runs: &'a [RunReport],
}

/// All runs as JSON.
pub fn reports_json(runs: &[RunReport]) -> Result<String, CliError> {
    serde_json::to_string(&Reports { runs })
        .map_err(|error| CliError::machine(format!("the report cannot be written as JSON: {error}")))
}

/// Seven decimals, or as many digits where these would say nothing.
fn number(x: f64) -> String {
    if x == 0.0 || (1e-5..1e6).contains(&x.abs()) { format!("{x:.7}") } else { format!("{x:.3e}") }
}
