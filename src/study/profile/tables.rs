//! Results as CSV, a row for each thing that was found.

use std::fmt::Write;

use super::comparison::{BANDS, ChannelResult};
use super::rings::{COMPARED, Rings, inner_radius, middle_radius, outer_radius};

const MILLIMETRES: f64 = 1e3;

/// Profiles: light in each ring between 10⁻³ and 100 mean free paths, by Monte Carlo (`truth`) and by every model, per
/// unit flux that entered. R is the mean over the ring, `radius_mm` the geometric mean of its radii; what is
/// cumulative ends at the outer radius.
pub fn profiles(results: &[ChannelResult]) -> String {
    let mut csv = String::from(
        "channel,quantity,model,radius_from_mm,radius_to_mm,radius_mm,r_per_mm2,stderr_per_mm2,\
         radius_times_r_per_mm,cumulative,cumulative_stderr\n",
    );
    for result in results {
        let models = result.models.iter().map(|model| (model.choice.name(), &model.rings));
        for (name, rings) in [("truth", &result.truth)].into_iter().chain(models) {
            push_profile(&mut csv, result, name, rings);
        }
    }
    csv
}

fn push_profile(csv: &mut String, result: &ChannelResult, model: &str, rings: &Rings) {
    let unit = MILLIMETRES / result.channel.medium.sigma_t();
    for i in COMPARED {
        let [from, to, radius] = [inner_radius(i), outer_radius(i), middle_radius(i)].map(|r| r * unit);
        let density = rings.density(i) * (1.0 / (unit * unit));
        let inside = rings.inside[i];
        // Writing to a string does not fail.
        let _ = writeln!(
            csv,
            "{},{},{model},{from:.7e},{to:.7e},{radius:.7e},{:.7e},{:.3e},{:.7e},{:.8},{:.2e}",
            result.channel.name,
            result.quantity.name(),
            density.value,
            density.standard_error,
            radius * density.value,
            inside.value,
            inside.standard_error,
        );
    }
}

/// Errors: a row for each channel, quantity and model.
pub fn errors(results: &[ChannelResult]) -> String {
    let mut csv = String::from(
        "channel,quantity,model,albedo,truth_albedo,truth_stderr,exact_albedo,l1_error,l1_noise,\
         error_below_0.1_mfp,error_0.1_to_1_mfp,error_1_to_10_mfp,error_beyond_10_mfp,\
         seconds_per_evaluation,seconds_per_sample,sampling_error\n",
    );
    for result in results {
        let truth = result.truth.total();
        for model in &result.models {
            let bands: [String; BANDS.len()] =
                model.bands.map(|error| error.map_or_else(String::new, |e| format!("{e:.6}")));
            let _ = writeln!(
                csv,
                "{},{},{},{:.8},{:.8},{:.2e},{},{:.6},{:.6},{},{:.3e},{:.3e},{:.2e}",
                result.channel.name,
                result.quantity.name(),
                model.choice.name(),
                model.albedo,
                truth.value,
                truth.standard_error,
                result.exact_albedo.map_or_else(String::new, |a| format!("{a:.8}")),
                model.l1,
                result.noise,
                bands.join(","),
                model.cost.seconds_per_evaluation,
                model.cost.seconds_per_sample,
                model.cost.sampling_error,
            );
        }
    }
    csv
}
