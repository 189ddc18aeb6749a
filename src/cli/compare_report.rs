//! What a comparison of two pictures found: as JSON, and as a table for people.

use std::fmt::Write;

use serde_json::{Value, json};

use crate::study::image::Comparison;
use crate::study::image::flip::{Flip, PIXELS_PER_DEGREE};
use crate::study::image::heat_map::Scale;
use crate::study::image::metrics::ChannelMean;

/// The object printed by `compare --json`. What is unknown is `null`.
pub fn json(found: &Comparison, flip: Option<&Flip>, heat_map: Option<Scale>) -> Value {
    let largest = found.largest;
    json!({
        "pixels": found.pixels,
        "mse": found.mse,
        "relmse": found.relmse,
        "relmse_of_noise": found.relmse_of_noise,
        "mape": found.mape,
        "bias": values(&found.bias),
        "bias_stderr": errors(&found.bias),
        "bias_interval": intervals(&found.bias),
        "mean_a": values(&found.mean_a),
        "mean_a_stderr": errors(&found.mean_a),
        "mean_a_interval": intervals(&found.mean_a),
        "mean_b": values(&found.mean_b),
        "mean_b_stderr": errors(&found.mean_b),
        "mean_b_interval": intervals(&found.mean_b),
        "confidence": 0.95,
        "nonfinite_a": found.nonfinite_a,
        "nonfinite_b": found.nonfinite_b,
        "largest": {
            "difference": largest.difference,
            "x": largest.x,
            "y": largest.y,
            "a": largest.a,
            "b": largest.b,
        },
        "flip": flip.map(|flip| json!({
            "mean": flip.mean,
            "max": flip.max,
            "exposures": flip.exposures,
            "pixels_per_degree": PIXELS_PER_DEGREE,
        })),
        "heat_map": heat_map.map(|scale| json!({"from": scale.ends()[0], "to": scale.ends()[1]})),
    })
}

fn values(means: &[ChannelMean; 3]) -> [f64; 3] {
    means.map(|mean| mean.value)
}

fn errors(means: &[ChannelMean; 3]) -> [Option<f64>; 3] {
    means.map(|mean| mean.standard_error)
}

fn intervals(means: &[ChannelMean; 3]) -> [Option<[f64; 2]>; 3] {
    means.map(|mean| mean.half_interval().map(|half| [mean.value - half, mean.value + half]))
}

/// A table: a line for each channel, then the errors.
pub fn table(heading: &str, found: &Comparison, flip: Option<&Flip>) -> String {
    let mut text = format!("{heading}, {} pixels\n\n", found.pixels);
    let digits = digits(found);
    // Writing to a string does not fail.
    let _ = writeln!(
        text,
        "{:<7} {:<24} {:<24} {:<26} bias in % of B",
        "channel", "mean of A", "mean of B", "bias, A - B"
    );
    for (channel, name) in ["red", "green", "blue"].into_iter().enumerate() {
        let bias = found.bias[channel];
        let share = 100.0 / found.mean_b[channel].value;
        let relative = ChannelMean {
            value: bias.value * share,
            standard_error: bias.standard_error.map(|sigma| sigma * share.abs()),
        };
        let line = format!(
            "{name:<7} {:<24} {:<24} {:<26} {}",
            plain(found.mean_a[channel], digits),
            plain(found.mean_b[channel], digits),
            signed(bias, digits),
            if share.is_finite() { signed(relative, 2) } else { String::new() },
        );
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text.push('\n');
    errors_in_words(&mut text, found, flip);
    text.push_str(noise_in_words(found));
    text
}

fn errors_in_words(text: &mut String, found: &Comparison, flip: Option<&Flip>) {
    let of_noise = found
        .relmse_of_noise
        .map_or_else(String::new, |noise| format!("; noise alone makes up to {}", scientific(noise)));
    let _ = writeln!(text, "MSE     {:<10}  (W/(m² sr))²", scientific(found.mse));
    let _ =
        writeln!(text, "relMSE  {:<10}  mean of (a - b)²/(b² + 0.01){of_noise}", scientific(found.relmse));
    let _ = writeln!(text, "MAPE    {:<10.4}  mean of |a - b|/(|b| + 0.01)", found.mape);
    if let Some(flip) = flip {
        let [first, last] = flip.exposures;
        let _ = writeln!(
            text,
            "FLIP    {:<10.4}  mean of HDR-FLIP from {first:+.1} to {last:+.1} EV; at most {:.4}",
            flip.mean, flip.max
        );
    }
    let largest = found.largest;
    let pixel = |[r, g, b]: [f32; 3]| format!("{r:.4} {g:.4} {b:.4}");
    let _ = writeln!(
        text,
        "largest difference {:.4} at column {}, row {}: {} against {}",
        largest.difference,
        largest.x,
        largest.y,
        pixel(largest.a.0),
        pixel(largest.b.0),
    );
}

fn scientific(value: f64) -> String {
    format!("{value:.4e}")
}

fn noise_in_words(found: &Comparison) -> &'static str {
    let known = |means: &[ChannelMean; 3]| means.iter().all(|mean| mean.standard_error.is_some());
    match (known(&found.mean_a), known(&found.mean_b)) {
        (true, true) => "± holds 95 %, by the variance layers, if A and B have different seeds",
        (true, false) | (false, true) if found.relmse_of_noise.is_some() => {
            "± holds 95 %, by the variance layers; the picture without them counts as exact"
        }
        _ => {
            "The noise is unknown: it needs the layers that render --aov variance writes, of 2 samples or more"
        }
    }
}

/// Digits behind the point that give the largest mean five that count.
fn digits(found: &Comparison) -> usize {
    let means = found.mean_a.iter().chain(&found.mean_b);
    let largest = means.map(|mean| mean.value.abs()).fold(0.0, f64::max);
    if largest == 0.0 { 5 } else { (4.0 - largest.log10().floor()).clamp(0.0, 12.0) as usize }
}

fn plain(mean: ChannelMean, digits: usize) -> String {
    let half = mean.half_interval().map_or_else(String::new, |half| format!(" ± {half:.digits$}"));
    format!("{:.digits$}{half}", mean.value)
}

fn signed(mean: ChannelMean, digits: usize) -> String {
    let sign = if mean.value < 0.0 { "" } else { "+" };
    format!("{sign}{}", plain(mean, digits))
}
