//! `alabaster plan`.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::choice::SubsurfaceArgs;
use super::console::print_line;
use super::error::CliError;
use super::force::ForceArgs;
use crate::plan::effects::Effect;
use crate::plan::{Plan, PlannedObject, Request};
use crate::scene::error::printable;
use crate::scene::{Method, SubsurfaceSettings};

/// Arguments of `plan`.
#[derive(Args)]
pub struct PlanArgs {
    /// Scene to plan: .toml, .glb or .gltf
    scene: PathBuf,
    /// Height of the picture in pixels, on which it depends how much a pixel shows [default: the scene's]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    height: Option<u32>,
    #[command(flatten)]
    subsurface: SubsurfaceArgs,
    #[command(flatten)]
    force: ForceArgs,
    /// Print the plan as JSON
    #[arg(long)]
    json: bool,
}

/// Says what rendering the scene would do.
pub fn run(args: &PlanArgs) -> Result<(), CliError> {
    let forces = args.force.forces()?;
    let mut scene = args.force.read_scene(&args.scene)?;
    scene.film.height = args.height.unwrap_or(scene.film.height);
    args.subsurface.override_in(&mut scene.subsurface);
    let request = Request { forces, ..Request::from(&scene.subsurface) };
    let plan = Plan::prepare(&mut scene, &request)?;
    if args.json {
        return print_line(&as_json(&plan, &scene.subsurface).to_string());
    }
    let kernel = format!("kernel: {}", plan.kernel.name());
    let parts = [objects_as_text(&plan), dropped_as_text(&plan), effects_as_text(&plan.effects), kernel];
    let parts: Vec<String> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    print_line(&printable(&parts.join("\n\n")))
}

/// What is to be done, and what is left out.
pub fn as_json(plan: &Plan, settings: &SubsurfaceSettings) -> Value {
    let effects: Vec<_> = plan
        .effects
        .iter()
        .map(|effect| json!({ "name": effect.kind.name(), "on": effect.on, "reason": effect.reason }))
        .collect();
    json!({
        "method": settings.method.name(),
        "accuracy": f64::from(settings.accuracy),
        "effects": effects,
        "kernel": plan.kernel.name(),
        "dropped": plan.objects.iter().filter_map(dropped).map(|dropped| dropped.as_json()).collect::<Vec<_>>(),
        "objects": plan.objects.iter().map(object_as_json).collect::<Vec<_>>(),
    })
}

/// What is left out of the transport in an object because the error that makes is bounded.
struct Dropped<'a> {
    /// What is left out.
    name: &'static str,
    /// Relative error to be expected of that; `None` where it is not known.
    bound: Option<f64>,
    object: &'a PlannedObject,
    /// What puts it back in.
    switch: &'static str,
}

/// What the method of an object leaves out: the way under the surface, where it ends within what a pixel shows or the surface is all that is
/// asked for, or the shape of the body.
fn dropped(planned: &PlannedObject) -> Option<Dropped<'_>> {
    let (name, switch) = match planned.method {
        Method::Diffuse => ("distance between entry and exit", "area-integral=on"),
        Method::Bssrdf => ("shape of the body under the surface", "random-walk=on"),
        // Exact: what is dropped is the half-space that stands for the body elsewhere.
        Method::Walk | Method::Auto => return None,
    };
    Some(Dropped { name, bound: planned.expected.of(planned.method), object: planned, switch })
}

impl Dropped<'_> {
    fn as_json(&self) -> Value {
        json!({
            "name": self.name,
            "object": self.object.object,
            "bound": self.bound,
            "reason": self.object.reason,
            "switch": format!("--force {}", self.switch),
        })
    }

    fn as_text(&self) -> String {
        let bound = match self.bound {
            Some(bound) => format!("expected error {:.1} %", 100.0 * bound),
            None => "error not known".into(),
        };
        let [r, g, b] = self.object.exit_distance.map(|distance| significant(1000.0 * distance));
        format!(
            "dropped: {} in {}: {bound}; light comes out {r} {g} {b} mm from where it went in, a pixel shows {} mm; \
             --force {} keeps it",
            self.name,
            self.object.object,
            significant(1000.0 * self.object.pixel_footprint),
            self.switch,
        )
    }
}

fn dropped_as_text(plan: &Plan) -> String {
    plan.objects.iter().filter_map(dropped).map(|dropped| dropped.as_text()).collect::<Vec<_>>().join("\n")
}

fn object_as_json(planned: &PlannedObject) -> Value {
    json!({
        "object": planned.object,
        "material": planned.material,
        "method": planned.method.name(),
        "reason": planned.reason,
        "expected_error": {
            "diffuse": planned.expected.diffuse,
            "bssrdf": planned.expected.bssrdf,
            "walk": planned.expected.walk.ok(),
        },
        "thickness": planned.thickness,
        "absorbed": planned.absorbed,
        "exit_distance": planned.exit_distance,
        "mean_chord": planned.body.mean_chord(),
        "curvature": planned.body.curvature,
        "volume": planned.body.volume,
        "area": planned.body.area,
        "pixel_footprint": planned.pixel_footprint,
    })
}

/// A table of the objects, and the reason for each below.
fn objects_as_text(plan: &Plan) -> String {
    if plan.objects.is_empty() {
        return "no object is translucent".into();
    }
    let width = plan.objects.iter().map(|object| object.object.chars().count()).max().unwrap_or(0).max(6);
    let heading = format!(
        "{:width$}  {:7}  {:>7}  {:>7}  {:>7}  {:>23}  {:>9}",
        "object", "method", "diffuse", "bssrdf", "walk", "thickness in free paths", "pixel, mm"
    );
    let row = |planned: &PlannedObject| {
        let error = |method| match planned.expected.of(method) {
            Some(error) => format!("{:.1} %", 100.0 * error),
            None => "?".into(),
        };
        format!(
            "{:width$}  {:7}  {:>7}  {:>7}  {:>7}  {:>23}  {:>9}\n{:width$}  {}",
            planned.object,
            planned.method.name(),
            error(Method::Diffuse),
            error(Method::Bssrdf),
            error(Method::Walk),
            planned.thickness.map(significant).join(" "),
            significant(1000.0 * planned.pixel_footprint),
            "",
            planned.reason,
        )
    };
    let rows = plan.objects.iter().map(row);
    [heading].into_iter().chain(rows).collect::<Vec<_>>().join("\n")
}

/// A line for each effect, by the name that `--force` knows: those that are on first.
fn effects_as_text(effects: &[Effect]) -> String {
    let width = effects.iter().map(|effect| effect.kind.name().len()).max().unwrap_or(0);
    let line = |effect: &Effect| {
        let state = if effect.on { "on" } else { "off" };
        format!("{:width$}  {state:3}  {}", effect.kind.word(), effect.reason)
    };
    let (on, off): (Vec<_>, Vec<_>) = effects.iter().partition(|effect| effect.on);
    [format!("{:width$}", "effect")]
        .into_iter()
        .chain(on.into_iter().chain(off).map(line))
        .collect::<Vec<_>>()
        .join("\n")
}

/// Three significant digits.
fn significant(x: f64) -> String {
    match x.abs() {
        size if (0.01..10.0).contains(&size) => format!("{x:.2}"),
        size if (10.0..100.0).contains(&size) => format!("{x:.1}"),
        size if (100.0..100_000.0).contains(&size) => format!("{x:.0}"),
        0.0 => "0".into(),
        _ => format!("{x:.1e}"),
    }
}
