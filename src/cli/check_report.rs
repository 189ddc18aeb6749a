//! What `alabaster check` found, as a table and as JSON.

use serde::Serialize;
use serde_json::{Value, json};

use super::error::CliError;
use crate::radiometry::{Irradiance, Radiance, RadiantFlux, RadiantIntensity, Rgb, Spectrum};
use crate::scene::Light;
use crate::scene::light::Emission;
use crate::study::laws::{BssrdfLaws, Orders, SurfaceLaws};
use crate::transport::{Power, PowerBalance, Unbalanced};

/// All that was found.
#[derive(Debug, Serialize)]
pub struct CheckReport {
    /// By material.
    pub materials: Vec<MaterialReport>,
    /// By light.
    pub lights: Vec<LightReport>,
    /// Where the power goes.
    #[serde(serialize_with = "serialize_power")]
    pub power: Result<PowerBalance, Unbalanced>,
    /// The light of the picture, order by order.
    pub orders: Orders,
}

/// A balance, or the reason why there is none, as JSON.
pub fn power_as_json(power: &Result<PowerBalance, Unbalanced>) -> Value {
    match power {
        Ok(balance) => json!({ "balance": balance, "sigmas": balance.sigmas(), "reason": null }),
        Err(reason) => json!({ "balance": null, "sigmas": null, "reason": reason.to_string() }),
    }
}

fn serialize_power<S: serde::Serializer>(
    power: &Result<PowerBalance, Unbalanced>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    power_as_json(power).serialize(serializer)
}

/// The laws of one material.
#[derive(Debug, Serialize)]
pub struct MaterialReport {
    /// Its name.
    pub name: String,
    /// Its kind in scene files.
    pub kind: &'static str,
    /// Of what scatters light where it is met, if anything does.
    pub surface: Option<SurfaceLaws>,
    /// Of light that leaves elsewhere, by profile.
    pub bssrdf: Vec<ProfileReport>,
}

/// The laws of a BSSRDF with one profile.
#[derive(Debug, Serialize)]
pub struct ProfileReport {
    /// Name of the profile.
    pub profile: &'static str,
    /// True if the scene is rendered with it.
    pub in_use: bool,
    /// What was found.
    #[serde(flatten)]
    pub laws: BssrdfLaws,
}

/// What a light emits.
#[derive(Debug, Serialize)]
pub struct LightReport {
    #[serde(rename = "type")]
    kind: &'static str,
    quantity: &'static str,
    unit: &'static str,
    emission: Rgb,
    /// The law of its spectrum, where it has more than a colour.
    #[serde(skip_serializing_if = "Option::is_none")]
    lamp: Option<String>,
    /// By channel; `null` for parallel light.
    power: Option<RadiantFlux<Rgb>>,
}

impl LightReport {
    /// Of `light`.
    pub fn new(light: &Light) -> Self {
        let (quantity, unit, emission) = match light.emission() {
            Emission::Radiance(Radiance(rgb)) => ("radiance", Radiance::UNIT, rgb),
            Emission::Intensity(RadiantIntensity(rgb)) => ("intensity", RadiantIntensity::UNIT, rgb),
            Emission::Irradiance(Irradiance(rgb)) => ("irradiance", Irradiance::UNIT, rgb),
        };
        let lamp = light.emitted().source.lamp().map(ToString::to_string);
        Self { kind: light.kind(), quantity, unit, emission, lamp, power: light.power() }
    }

    fn text(&self) -> String {
        let [r, g, b] = self.emission.0;
        let power = match self.power {
            Some(RadiantFlux(Spectrum([r, g, b]))) => {
                format!(", power {r:.4} {g:.4} {b:.4} {}", RadiantFlux::UNIT)
            }
            None => String::new(),
        };
        let lamp = self.lamp.as_ref().map_or(String::new(), |lamp| format!(", {lamp}"));
        format!("{}: {} {r} {g} {b} {}{power}{lamp}", self.kind, self.quantity, self.unit)
    }
}

impl MaterialReport {
    /// What does not hold and has to.
    pub fn broken_laws(&self) -> Vec<String> {
        let used = || self.bssrdf.iter().filter(|profile| profile.in_use);
        let surface = self.surface.as_ref();
        let negative =
            surface.is_some_and(|laws| !laws.is_non_negative()) || used().any(|p| p.laws.negative > 0);
        let gains =
            surface.is_some_and(|laws| !laws.conserves_energy) || used().any(|p| !p.laws.conserves_energy);
        let mut broken = Vec::new();
        if negative {
            broken.push(format!("\"{}\" has negative values", self.name));
        }
        if gains {
            broken.push(format!("\"{}\" gives back more light than it gets", self.name));
        }
        broken
    }

    /// By how much reciprocity breaks as the material is rendered, at most.
    pub fn reciprocity_break(&self) -> Option<f64> {
        let surface = self.surface.as_ref().and_then(|laws| laws.reciprocity_break);
        let used = self.bssrdf.iter().filter(|profile| profile.in_use);
        used.map(|profile| profile.laws.reciprocity_break).chain(surface).reduce(f64::max)
    }

    fn rows(&self) -> Vec<[String; 5]> {
        let yes_or_no = |holds: bool| if holds { "yes" } else { "NO" }.to_string();
        let share =
            |broken: f64| if broken < 1e-5 { "holds".into() } else { format!("broken by {broken:.1e}") };
        let surface = self.surface.iter().map(|laws| {
            [
                format!("{} ({})", self.name, self.kind),
                yes_or_no(laws.is_non_negative()),
                yes_or_no(laws.conserves_energy),
                format!("{:.4}", laws.largest_albedo),
                match laws.reciprocity_break {
                    None => "nothing to compare".into(),
                    Some(_) if laws.is_reciprocal() => "holds".into(),
                    Some(broken) => share(broken),
                },
            ]
        });
        let bssrdf = self.bssrdf.iter().map(|profile| {
            let used = if profile.in_use { ", in use" } else { "" };
            [
                format!("{} (bssrdf, {}{used})", self.name, profile.profile),
                yes_or_no(profile.laws.negative == 0),
                yes_or_no(profile.laws.conserves_energy),
                format!("{:.4}", profile.laws.largest_albedo),
                share(profile.laws.reciprocity_break),
            ]
        });
        surface.chain(bssrdf).collect()
    }
}

impl CheckReport {
    /// As JSON.
    pub fn json(&self) -> Result<String, CliError> {
        serde_json::to_string(self)
            .map_err(|error| CliError::machine(format!("the report cannot be written as JSON: {error}")))
    }

    /// As tables.
    pub fn text(&self) -> String {
        let lights: Vec<String> = self.lights.iter().map(LightReport::text).collect();
        let power = match &self.power {
            Ok(balance) => power_as_text(balance),
            Err(reason) => format!("no power balance: {reason}"),
        };
        let parts = [self.materials_as_text(), lights.join("\n"), power, self.orders_as_text()];
        parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("\n\n")
    }

    fn materials_as_text(&self) -> String {
        let heading = ["material", "not negative", "conserves energy", "largest albedo", "reciprocity"]
            .map(String::from);
        let rows: Vec<_> =
            [heading].into_iter().chain(self.materials.iter().flat_map(MaterialReport::rows)).collect();
        let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
        let widths = [0, 1, 2, 3, 4].map(width);
        let line = |row: &[String; 5]| {
            let cells = row.iter().zip(widths).map(|(cell, width)| format!("{cell:width$}"));
            cells.collect::<Vec<_>>().join("  ").trim_end().to_string()
        };
        rows.iter().map(line).collect::<Vec<_>>().join("\n")
    }

    fn orders_as_text(&self) -> String {
        let Orders { orders, beyond, sum, whole, spp } = &self.orders;
        let percent = |share: f64| format!("{:.3} %", 100.0 * share);
        let beyond_share = if sum.value > 0.0 { beyond.value / sum.value } else { 0.0 };
        // Orders after the last that adds something are not there.
        let last = orders.iter().rposition(|term| term.radiance.value != 0.0).map_or(0, |last| last + 1);
        let shown = if beyond.value == 0.0 { &orders[..last] } else { &orders[..] };
        let rows = shown.iter().map(|term| {
            format!(
                "{:>6}  {:>12.5e} ± {:.1e}  {:>9}  {:>9}",
                term.order,
                term.radiance.value,
                term.radiance.stderr,
                percent(term.share),
                percent(term.lost_if_cut)
            )
        });
        let heading = format!("{:>6}  {:>22}  {:>9}  {:>9}", "order", "adds, W/(m² sr)", "share", "cut here");
        let rest = format!(
            "{:>6}  {:>12.5e} ± {:.1e}  {:>9}",
            "beyond",
            beyond.value,
            beyond.stderr,
            percent(beyond_share)
        );
        let sums = format!(
            "sum of all orders {:.5e} ± {:.1e}; the whole picture by other samples ({spp} per pixel) {:.5e} ± {:.1e}: {:.1} σ apart",
            sum.value,
            sum.stderr,
            whole.value,
            whole.stderr,
            self.orders.sigmas()
        );
        [heading].into_iter().chain(rows).chain([rest, sums]).collect::<Vec<_>>().join("\n")
    }
}

/// A line for each term, channels averaged.
fn power_as_text(balance: &PowerBalance) -> String {
    let PowerBalance { emitted, entered, absorbed, escaped, scattered_out, residual } = balance;
    let line = |name: &str, power: &Power| {
        let mean = |by_channel: [f64; 3]| by_channel.iter().sum::<f64>() / 3.0;
        format!("{name:>13}  {:>12.5} ± {:.5} W", mean(power.value), mean(power.stderr))
    };
    let terms = [
        ("emitted", emitted),
        ("entered", entered),
        ("absorbed", absorbed),
        ("escaped", escaped),
        ("scattered out", scattered_out),
        ("residual", residual),
    ];
    let lines = terms.map(|(name, power)| line(name, power)).join("\n");
    format!("{lines} ({:.1} σ)", balance.sigmas())
}
