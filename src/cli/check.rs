//! `alabaster check`.

use std::path::PathBuf;

use clap::Args;

use super::backend::{RayWork, run_on};
use super::check_report::{CheckReport, LightReport, MaterialReport, ProfileReport};
use super::choice::{SubsurfaceArgs, named, not_negative};
use super::console::print_line;
use super::error::CliError;
use super::force::ForceArgs;
use super::threads::ThreadArgs;
use crate::diffusion::{ModelKind, ProfileKind};
use crate::math::sampler::HashGenerator;
use crate::raycast::{Backend, Geometry, RayCaster, RaycastError};
use crate::scene::Scene;
use crate::study::laws::{SurfaceLaws, check_bssrdf, check_surface, neumann_orders};
use crate::transport::Renderer;

/// Points of a textured material that are looked at.
const POINTS: usize = 16;

/// Samples of each part of the power balance.
const POWER_SAMPLES: u64 = 20_000;

/// Standard errors by which a sum may miss what it should be: 1 in 16,000 by chance.
const SIGMAS: f64 = 4.0;

/// Arguments of `check`.
#[derive(Args)]
pub struct CheckArgs {
    /// Scene to check: .toml, .glb or .gltf
    scene: PathBuf,
    /// Width in pixels of the picture whose light is taken apart [default: 48, the height by the scene's]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=4096))]
    width: Option<u32>,
    /// Height in pixels of that picture
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=4096))]
    height: Option<u32>,
    /// Samples per pixel of that picture
    #[arg(long, value_name = "N", default_value_t = 32, value_parser = clap::value_parser!(u32).range(2..=65_536))]
    spp: u32,
    /// The highest order of the Neumann series that is told from those beyond
    #[arg(long, value_name = "K", default_value_t = 12, value_parser = clap::value_parser!(u32).range(..=1024))]
    orders: u32,
    /// Fail, with exit code 1, if some material breaks reciprocity by more than this share
    #[arg(long, value_name = "SHARE", value_parser = not_negative, allow_negative_numbers = true)]
    max_reciprocity_break: Option<f64>,
    #[command(flatten)]
    subsurface: SubsurfaceArgs,
    #[command(flatten)]
    force: ForceArgs,
    /// What casts the rays
    #[arg(long, value_parser = named(Backend::NAMES), default_value = Backend::default().name())]
    backend: Backend,
    /// Seed of all random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    threads: ThreadArgs,
    /// Print what was found as JSON
    #[arg(long)]
    json: bool,
}

/// Checks the materials of a scene, and takes its light apart.
pub fn run(args: &CheckArgs) -> Result<(), CliError> {
    args.threads.start()?;
    let mut scene = args.force.read_scene(&args.scene)?;
    args.subsurface.override_in(&mut scene.subsurface);
    let film = &mut scene.film;
    let scaled = |length: u32, by: u32, of: u32| {
        (u64::from(length) * u64::from(by) / u64::from(of.max(1))).clamp(1, 4096) as u32
    };
    (film.width, film.height) = match (args.width, args.height) {
        (Some(width), Some(height)) => (width, height),
        (None, Some(height)) => (scaled(height, film.width, film.height), height),
        (width, None) => {
            let width = width.unwrap_or(48);
            (width, scaled(width, film.height, film.width))
        }
    };
    run_on(args.backend, Check { args, scene })
}

struct Check<'a> {
    args: &'a CheckArgs,
    scene: Scene,
}

impl RayWork for Check<'_> {
    fn run<C: RayCaster>(self, build: impl Fn(&Geometry) -> Result<C, RaycastError>) -> Result<(), CliError> {
        let Self { args, scene } = self;
        let mut renderer = args.force.renderer(scene, args.seed, build)?;
        let count = renderer.scene().materials.len();
        let materials = (0..count).map(|index| material(&renderer, index)).collect();
        let lights = renderer.scene().lights.iter().map(LightReport::new).collect();
        let power = renderer.power_balance(POWER_SAMPLES);
        let orders = neumann_orders(&mut renderer, args.spp, args.orders, args.seed);
        let report = CheckReport { materials, lights, power, orders };
        print_line(&if args.json { report.json()? } else { report.text() })?;
        judge(args, &report, renderer.depth_limit().is_some())
    }
}

/// The laws of one material.
fn material<C: RayCaster>(renderer: &Renderer<C>, index: usize) -> MaterialReport {
    let material = &renderer.scene().materials[index];
    let mut random = HashGenerator::new(0);
    let points = if material.varies() { POINTS } else { 1 };
    let mut surface: Option<SurfaceLaws> = None;
    let mut has_bssrdf = false;
    for _ in 0..points {
        let boundaries = renderer.boundaries(index, [random.next_f32(), random.next_f32()].into());
        has_bssrdf |= boundaries.has_bssrdf;
        if let Some(lobes) = &boundaries.lobes {
            let found = check_surface(&boundaries, lobes);
            surface = Some(surface.map_or(found.clone(), |worst| worst.worse(found)));
        }
    }
    let bssrdf = if has_bssrdf { profiles(renderer, index) } else { Vec::new() };
    MaterialReport { name: material.name.clone(), kind: material.surface.kind(), surface, bssrdf }
}

/// The laws of the BSSRDF of a material under every profile that it can have.
fn profiles<C: RayCaster>(renderer: &Renderer<C>, index: usize) -> Vec<ProfileReport> {
    let in_use = renderer.profile_of(index);
    let kinds = [ProfileKind::Tabulated].into_iter().chain(ModelKind::ALL.map(ProfileKind::Model));
    let report = |kind: ProfileKind| {
        // A table does not cover every material: then there is no such profile of it.
        let bssrdf = renderer.plane_bssrdf(index, kind).ok()??;
        Some(ProfileReport {
            profile: kind.name(),
            in_use: in_use == Some(kind),
            laws: check_bssrdf(&bssrdf),
        })
    };
    kinds.filter_map(report).collect()
}

/// Fails where a law does not hold that has to.
fn judge(args: &CheckArgs, report: &CheckReport, is_cut: bool) -> Result<(), CliError> {
    let mut failed: Vec<String> = report.materials.iter().flat_map(MaterialReport::broken_laws).collect();
    if let Some(limit) = args.max_reciprocity_break {
        failed.extend(report.materials.iter().filter_map(|material| {
            let broken = material.reciprocity_break().filter(|&broken| broken > limit)?;
            let name = &material.name;
            Some(format!(
                "\"{name}\" breaks reciprocity by {broken:.2e}, above --max-reciprocity-break {limit:e}"
            ))
        }));
    }
    let sigmas = report.orders.sigmas();
    if sigmas > SIGMAS || sigmas.is_nan() {
        failed.push(format!("the Neumann orders miss the whole picture by {sigmas:.1} standard errors"));
    }
    // Paths that are cut on the way lose what they carry.
    if let (Ok(balance), false) = (&report.power, is_cut)
        && balance.sigmas() > SIGMAS
    {
        failed.push(format!("the power balance is open by {:.1} standard errors", balance.sigmas()));
    }
    if failed.is_empty() { Ok(()) } else { Err(CliError::Failed(failed.join("; "))) }
}
