//! `alabaster bench`.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Map, Value, json};

use super::bar::Bar;
use super::choice::SubsurfaceArgs;
use super::console::{print_line, warn};
use super::error::CliError;
use super::threads::ThreadArgs;
use crate::scene::read_scene;
use crate::study::race::Kind;
use crate::study::race::agreement::{Agreement, Disagreement};
use crate::study::race::contest::{ContestError, Contestant, Results, Settings, contest};
use crate::study::race::replay::Spread;
use crate::study::race::scene::ball;
use crate::transport::RenderOptions;

/// Arguments of `bench`.
#[derive(Args)]
pub struct BenchArgs {
    /// Scene that the rays come from: .toml, .glb or .gltf [default: a ball of marble of 1.3 million triangles]
    scene: Option<PathBuf>,
    /// Rays of each kind, at most
    #[arg(long, value_name = "N", default_value_t = 1 << 20, value_parser = clap::value_parser!(u32).range(1..))]
    rays: u32,
    /// Turns of each ray caster
    #[arg(long, value_name = "N", default_value_t = 7, value_parser = clap::value_parser!(u16).range(1..=1000))]
    rounds: u16,
    /// Rays of all kinds together whose hits are compared [default: those that are raced on]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    compare: u64,
    #[command(flatten)]
    subsurface: SubsurfaceArgs,
    /// Seed of all random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    threads: ThreadArgs,
    /// Print nothing but warnings and errors
    #[arg(long)]
    quiet: bool,
    /// Print what was measured as JSON on standard output
    #[arg(long)]
    json: bool,
}

impl From<ContestError> for CliError {
    fn from(error: ContestError) -> Self {
        match error {
            ContestError::Render(error) => error.into(),
            ContestError::Film(error) => error.into(),
        }
    }
}

/// Lets the ray casters of this build race on the rays of a scene.
pub fn run(args: &BenchArgs) -> Result<(), CliError> {
    args.threads.start()?;
    let mut scene = match &args.scene {
        Some(path) => read_scene(path)?,
        None => ball(),
    };
    warn(&scene.warnings);
    args.subsurface.override_in(&mut scene.subsurface);
    let settings = Settings {
        rays: args.rays as usize,
        rounds: args.rounds.into(),
        compared: args.compare,
        options: RenderOptions::of(&scene, args.seed),
    };
    let bar = Bar::start(args.quiet);
    let advance =
        |step: usize, steps: usize| bar.show(|| (step as f64 / steps as f64, format!("{step} of {steps}")));
    let results = contest(&scene, &settings, &advance);
    bar.finish();
    let results = results?;
    if args.json {
        return print_line(&as_json(&results).to_string());
    }
    if args.quiet { Ok(()) } else { print_line(&as_text(&results)) }
}

fn name(kind: Kind) -> &'static str {
    Kind::NAMES[kind as usize].0
}

fn as_json(results: &Results) -> Value {
    let others = &results.contestants[1..];
    let by_name = |value: &dyn Fn(&Contestant) -> Value| {
        others.iter().map(|c| (c.backend.name().to_string(), value(c))).collect::<Map<_, _>>()
    };
    // Of the hierarchy of this project, where there is another to compare it with.
    let own = &others[0];
    json!({
        "triangles": results.triangles,
        "rays": results.rays.iter().map(|(_, count)| count).sum::<usize>(),
        "threads": rayon::current_num_threads(),
        "samples": results.samples,
        "backends": results.contestants.iter()
            .map(|c| (c.backend.name().to_string(), backend_as_json(c)))
            .collect::<Map<_, _>>(),
        "compared_with": results.contestants[0].backend.name(),
        "ratio": ratios_as_json(own),
        "ratios": by_name(&ratios_as_json),
        "agreement": agreement_as_json(&own.agreement),
        "agreements": by_name(&|c| agreement_as_json(&c.agreement)),
    })
}

fn backend_as_json(contestant: &Contestant) -> Value {
    let speeds = |spread: &dyn Fn(&crate::study::race::contest::Speed) -> Spread| {
        contestant
            .speeds
            .iter()
            .map(|s| (name(s.kind).to_string(), spread_as_json(spread(s))))
            .collect::<Map<_, _>>()
    };
    let medians = contestant.speeds.iter().map(|s| (name(s.kind).to_string(), json!(s.one_thread.median)));
    json!({
        "build_seconds": contestant.build_time.as_secs_f64(),
        "bytes": contestant.bytes,
        "mrays_per_second": medians.collect::<Map<_, _>>(),
        "mrays_per_second_one_thread": speeds(&|s| s.one_thread),
        "mrays_per_second_all_threads": speeds(&|s| s.all_threads),
        "render_seconds": spread_as_json(contestant.render_seconds),
    })
}

fn spread_as_json(spread: Spread) -> Value {
    json!({ "median": spread.median, "deviation": spread.deviation })
}

fn ratios_as_json(contestant: &Contestant) -> Value {
    let mut ratios: Map<_, _> =
        contestant.speeds.iter().map(|s| (name(s.kind).to_string(), json!(s.ratio.median))).collect();
    ratios.insert("render".into(), json!(contestant.render_ratio.median));
    Value::Object(ratios)
}

fn agreement_as_json(agreement: &Agreement) -> Value {
    json!({
        "rays": agreement.rays,
        "identical": agreement.identical,
        "within_ulp": agreement.within_rounding,
        "missing": agreement.missing,
        "extra": agreement.extra,
        "unexplained": agreement.unexplained,
        "examples": agreement.examples.iter().map(example_as_json).collect::<Vec<_>>(),
    })
}

fn example_as_json(example: &Disagreement) -> Value {
    let hits = |hits: &[crate::raycast::Hit]| {
        hits.iter()
            .map(|h| json!({ "t": h.t, "instance": h.instance, "primitive": h.primitive }))
            .collect::<Vec<_>>()
    };
    json!({
        "kind": name(example.kind),
        "origin": example.ray.origin.to_array(),
        "direction": example.ray.direction.to_array(),
        "t_max": example.ray.t_max.is_finite().then_some(example.ray.t_max),
        "first": hits(&example.first),
        "second": hits(&example.second),
        "cause": example.cause.name(),
    })
}

/// Two tables: speeds, and what else there is to compare.
fn as_text(results: &Results) -> String {
    let first = results.contestants[0].backend.name();
    let mut lines = vec![format!(
        "{} triangles, {} threads; millions of rays a second on one thread, on all; ratio to {first}, ± half of the turns",
        results.triangles,
        rayon::current_num_threads()
    )];
    lines.push(format!(
        "{:8}{:>10}  {:8}{:>10}{:>10}{:>16}",
        "rays", "number", "backend", "one", "all", "ratio"
    ));
    for (index, (kind, count)) in results.rays.iter().enumerate() {
        for contestant in &results.contestants {
            let speed = &contestant.speeds[index];
            lines.push(format!(
                "{:8}{count:>10}  {:8}{:>10.2}{:>10.2}{:>10.3} ± {:.3}",
                name(*kind),
                contestant.backend.name(),
                speed.one_thread.median,
                speed.all_threads.median,
                speed.ratio.median,
                speed.ratio.deviation,
            ));
        }
    }
    lines.push(String::new());
    lines.push(format!(
        "{:8}{:>10}{:>12}{:>14}{:>16}   (rendering: {} samples, all threads)",
        "backend", "build, s", "memory, MB", "rendering, s", "ratio", results.samples
    ));
    for contestant in &results.contestants {
        lines.push(format!(
            "{:8}{:>10.2}{:>12.1}{:>14.3}{:>10.3} ± {:.3}",
            contestant.backend.name(),
            contestant.build_time.as_secs_f64(),
            contestant.bytes as f64 * 1e-6,
            contestant.render_seconds.median,
            contestant.render_ratio.median,
            contestant.render_ratio.deviation,
        ));
    }
    lines.push(String::new());
    for contestant in &results.contestants[1..] {
        let a = &contestant.agreement;
        lines.push(format!(
            "{} against {first}: of {} rays {} have the same hits to the bit, {} within rounding; {} lack one, {} have one more; {} for no cause that is known",
            contestant.backend.name(),
            a.rays,
            a.identical,
            a.within_rounding,
            a.missing,
            a.extra,
            a.unexplained
        ));
        lines.extend(a.examples.iter().map(example_as_text));
    }
    lines.join("\n")
}

fn example_as_text(example: &Disagreement) -> String {
    let hits = |hits: &[crate::raycast::Hit]| match hits {
        [] => "nothing".to_string(),
        hits => {
            let hit = |h: &crate::raycast::Hit| {
                format!("triangle {} of instance {} at t = {:e}", h.primitive, h.instance, h.t)
            };
            hits.iter().map(hit).collect::<Vec<_>>().join(", ")
        }
    };
    let Disagreement { kind, ray, first, second, cause } = example;
    format!(
        "  {} from {} along {}: {}; now {} ({})",
        name(*kind),
        ray.origin,
        ray.direction,
        hits(first),
        hits(second),
        cause.name()
    )
}
