//! `alabaster materials`.

use clap::Args;
use serde_json::json;

use super::console::print_line;
use super::error::CliError;
use crate::medium::presets::{MEASURED_MATERIALS, MeasuredMaterial};

/// Arguments of `materials`.
#[derive(Args)]
pub struct MaterialsArgs {
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Lists the measured materials.
pub fn run(args: &MaterialsArgs) -> Result<(), CliError> {
    if args.json {
        let list: Vec<_> = MEASURED_MATERIALS.iter().map(object).collect();
        return print_line(&json!(list).to_string());
    }
    let heading =
        format!("{:<28} {:<22} {:<28} {:<6} source", "name", "sigma_a [1/m]", "reduced sigma_s [1/m]", "ior");
    let rows = MEASURED_MATERIALS.iter().map(row);
    print_line(&[heading].into_iter().chain(rows).collect::<Vec<_>>().join("\n"))
}

fn object(material: &MeasuredMaterial) -> serde_json::Value {
    json!({
        "name": material.name,
        "sigma_a": material.sigma_a,
        "sigma_s_reduced": material.sigma_s_reduced,
        "ior": material.ior,
        "source": material.source,
    })
}

fn row(material: &MeasuredMaterial) -> String {
    let channels = |values: [f32; 3]| values.map(|x| format!("{x:.4}")).map(trim_zeros).join(" ");
    format!(
        "{:<28} {:<22} {:<28} {:<6} {}",
        material.name,
        channels(material.sigma_a.0),
        channels(material.sigma_s_reduced.0),
        material.ior,
        material.source,
    )
}

fn trim_zeros(number: String) -> String {
    number.trim_end_matches('0').trim_end_matches('.').to_owned()
}
