//! What a comparison found: as JSON, and as a table for people.

use std::fmt::Write;

use serde_json::{Value, json};

use super::comparison::{BANDS, BEYOND, ChannelResult, ModelResult, Quantity, Settings};
use super::lengths::{mean_free_paths, unit_hint};
use super::material::Material;
use super::rings::Rings;
use crate::diffusion::HalfSpace;
use crate::study::numbers::significant;

const MILLIMETRES: f64 = 1e3;

/// The comparison as JSON. At the top, models and truth are over all channels of the reflectance: albedos are means, times
/// too, and an L1 error is the largest of all. The same by channel, with more, is in `channels`. `cutoff` is in m.
pub fn json(
    material: &Material,
    settings: &Settings,
    results: &[ChannelResult],
    cutoff: Option<f64>,
) -> Value {
    let reflected: Vec<&ChannelResult> =
        results.iter().filter(|result| result.quantity == Quantity::Reflectance).collect();
    let over_channels = |f: &dyn Fn(&ChannelResult) -> f64| mean(reflected.iter().map(|result| f(result)));
    json!({
        "material": material.name,
        "entry": settings.entry.name(),
        "thickness_m": material.thickness,
        "photons": settings.effort.photons,
        "seed": settings.effort.seed,
        "units": {
            "coefficients": "1/m",
            "r": "1/mm^2 per unit flux that entered",
            "l1_error": "sum |model - truth| / sum truth over rings of 1/12 decade from 0.001 to 100 mean free paths",
        },
        "models": models_over_channels(&reflected),
        // Channels share their photons: the error of their mean may be as large as the mean of their errors.
        "truth": {
            "albedo": over_channels(&|result| result.truth.total().value),
            "stderr": over_channels(&|result| result.truth.total().standard_error),
        },
        "channels": results.iter().map(|result| channel_json(result, cutoff)).collect::<Vec<_>>(),
        "notes": notes(material),
    })
}

fn models_over_channels(results: &[&ChannelResult]) -> Vec<Value> {
    // A model may have nothing to say about some channels.
    let mut choices = Vec::new();
    for model in results.iter().flat_map(|result| &result.models) {
        if !choices.contains(&model.choice) {
            choices.push(model.choice);
        }
    }
    let summary = |&choice| {
        let all = results.iter().flat_map(|result| &result.models);
        let models: Vec<&ModelResult> = all.filter(|model| model.choice == choice).collect();
        let over = |f: &dyn Fn(&ModelResult) -> f64| mean(models.iter().map(|model| f(model)));
        json!({
            "name": choice.name(),
            "albedo": over(&|model| model.albedo),
            "l1_error": models.iter().map(|model| model.l1).fold(0.0, f64::max),
            "seconds_per_evaluation": over(&|model| model.cost.seconds_per_evaluation),
            "seconds_per_sample": over(&|model| model.cost.seconds_per_sample),
        })
    };
    choices.iter().map(summary).collect()
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len().max(1) as f64;
    values.sum::<f64>() / count
}

fn channel_json(result: &ChannelResult, cutoff: Option<f64>) -> Value {
    let medium = &result.channel.medium;
    let truth = result.truth.total();
    let model = |model: &ModelResult| {
        let bands: serde_json::Map<String, Value> =
            BANDS.iter().zip(model.bands).map(|((name, _), error)| ((*name).into(), json!(error))).collect();
        json!({
            "name": model.choice.name(),
            "albedo": model.albedo,
            "albedo_error": model.albedo - reference(result),
            "l1_error": model.l1,
            "error_by_band_mfp": bands,
            "energy_beyond": beyond(&model.rings, medium, cutoff),
            "seconds_per_evaluation": model.cost.seconds_per_evaluation,
            "seconds_per_sample": model.cost.seconds_per_sample,
            "sampling_error": model.cost.sampling_error,
        })
    };
    json!({
        "channel": result.channel.name,
        "quantity": result.quantity.name(),
        "sigma_a": medium.sigma_a,
        "sigma_s": medium.sigma_s,
        "g": medium.g,
        "ior": medium.eta,
        "mean_free_path_mm": MILLIMETRES / medium.sigma_t(),
        "reduced_mean_free_path_mm": MILLIMETRES * medium.mean_free_path_reduced(),
        "reduced_albedo": medium.albedo_reduced(),
        "truth": {
            "albedo": truth.value,
            "stderr": truth.standard_error,
            "exact_albedo": result.exact_albedo,
            "l1_noise": result.noise,
            "energy_beyond": beyond(&result.truth, medium, cutoff),
        },
        "models": result.models.iter().map(model).collect::<Vec<_>>(),
        "left_out": result
            .left_out
            .iter()
            .map(|(choice, reason)| json!({"name": choice.name(), "reason": reason.to_string()}))
            .collect::<Vec<_>>(),
    })
}

/// What the total albedo of a model is compared with.
fn reference(result: &ChannelResult) -> f64 {
    result.exact_albedo.unwrap_or(result.truth.total().value)
}

/// Radii of interest, mm, and the light beyond them.
fn beyond(rings: &Rings, medium: &HalfSpace, cutoff: Option<f64>) -> Vec<Value> {
    cutoffs(medium, cutoff)
        .map(|paths| {
            json!({"radius_mm": MILLIMETRES * paths / medium.sigma_t(), "radius_mfp": paths, "energy": rings.beyond(paths)})
        })
        .collect()
}

/// In mean free paths; that of the user, in m, first.
fn cutoffs(medium: &HalfSpace, cutoff: Option<f64>) -> impl Iterator<Item = f64> {
    cutoff.map(|radius| radius * medium.sigma_t()).into_iter().chain(BEYOND)
}

/// What the reader ought to know: notes, and lengths that are hardly meant.
pub fn notes(material: &Material) -> Vec<String> {
    let doubtful = material.channels.iter().filter(|_| !material.measured);
    let hints = doubtful.filter_map(|channel| {
        unit_hint(&channel.medium).map(|hint| format!("channel {}: {hint}", channel.name))
    });
    material.notes.iter().cloned().chain(hints).collect()
}

/// The comparison as a table for each channel.
pub fn table(results: &[ChannelResult], cutoff: Option<f64>) -> String {
    let mut text = String::new();
    for result in results {
        push_channel(&mut text, result, cutoff);
    }
    text.trim_end().into()
}

fn push_channel(text: &mut String, result: &ChannelResult, cutoff: Option<f64>) {
    let medium = &result.channel.medium;
    let truth = result.truth.total();
    let exact = result.exact_albedo.map_or_else(String::new, |albedo| format!(", exact {albedo:.5}"));
    // Writing to a string does not fail.
    let _ = writeln!(
        text,
        "{}, {}: {}, reduced albedo {:.5}, g {}, ior {}",
        result.channel.name,
        result.quantity.name(),
        mean_free_paths(medium),
        medium.albedo_reduced(),
        significant(medium.g),
        significant(medium.eta),
    );
    let _ = writeln!(
        text,
        "  Monte Carlo: albedo {:.5} ± {:.5}{exact}; its noise adds {:.2} % or less to an L1 error",
        truth.value,
        truth.standard_error,
        100.0 * result.noise
    );
    let cut = cutoffs(medium, cutoff).next().unwrap_or(BEYOND[0]);
    let beyond = format!(">{} mm", significant(MILLIMETRES * cut / medium.sigma_t()));
    let _ = writeln!(
        text,
        "  {:<32} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>11} {:>8} {:>9}",
        "model",
        "albedo",
        "error",
        "L1 %",
        "r<0.1 %",
        "0.1-1 %",
        "1-10 %",
        ">10 %",
        beyond,
        "µs/eval",
        "µs/sample"
    );
    let _ = writeln!(
        text,
        "  {:<32} {:>8.5} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>11.5}",
        "Monte Carlo",
        truth.value,
        "",
        "",
        "",
        "",
        "",
        "",
        result.truth.beyond(cut)
    );
    for model in &result.models {
        let bands: Vec<String> = model.bands.iter().map(|error| percent(*error)).collect();
        let _ = writeln!(
            text,
            "  {:<32} {:>8.5} {:>+8.5} {:>8.2} {:>8} {:>8} {:>8} {:>8} {:>11.5} {:>8.3} {:>9.3}",
            model.choice.name(),
            model.albedo,
            model.albedo - reference(result),
            100.0 * model.l1,
            bands[0],
            bands[1],
            bands[2],
            bands[3],
            model.rings.beyond(cut),
            1e6 * model.cost.seconds_per_evaluation,
            1e6 * model.cost.seconds_per_sample,
        );
    }
    for (choice, reason) in &result.left_out {
        let _ = writeln!(text, "  {:<32} left out: {reason}", choice.name());
    }
    text.push('\n');
}

fn percent(error: Option<f64>) -> String {
    error.map_or_else(|| "-".into(), |error| format!("{:+.1}", 100.0 * error))
}
