//! How far the form of each profile is from photon Monte Carlo, as a renderer uses it: the table of `docs/profiles.md`.
//!
//! ```sh
//! cargo run --release --example profile_accuracy
//! ```
//!
//! The light enters from uniform surroundings. Every profile is scaled to the exact albedo, as it is in a render, so what is
//! compared is where the light leaves, not how much.

use std::sync::atomic::AtomicBool;

use alabaster::diffusion::integrate::{energy_between, total_energy};
use alabaster::diffusion::normalized_diffusion::{Fit, NormalizedDiffusionModel};
use alabaster::diffusion::{
    BetterDipole, DiffusionModel, Dipole, HalfSpace, PhotonBeam, Profile, UniformlyLitDirectionalDipole,
    tabulated,
};
use alabaster::medium::Entry;
use alabaster::medium::PlaneParallel;
use alabaster::slab::white::{RINGS, WhiteTally, ring_edge, white_walk};
use alabaster::slab::{Estimate, Source, estimate};

const MEDIA: [(f64, f64); 14] = [
    (1.0, 0.0),
    (1.33, 0.0),
    (1.5, 0.0),
    (1.9, 0.0),
    (1.0, 0.8),
    (1.33, 0.5),
    (1.33, 0.8),
    (1.33, 0.89),
    (1.5, 0.8),
    (0.75, 0.0),
    (0.75, 0.8),
    (2.5, 0.0),
    (1.4, -0.5),
    (1.4, 0.95),
];

const ABSORBED_SHARES: [f64; 5] = [0.001, 0.01, 0.1, 0.3, 0.6];

/// Radii between which errors are summed, in mean free paths.
const RADII: (f64, f64) = (1e-3, 100.0);

const PHOTONS: u64 = 2_000_000;

fn main() {
    println!(
        "| η | g | α' | dipole | better-dipole | directional-dipole | normalized-diffusion | photon-beam | tabulated | noise |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for (eta, g) in MEDIA {
        let shares = ABSORBED_SHARES.map(|a| a * (1.0 - g) / (1.0 - g * a));
        let walk = white_walk(eta, g, Source::Diffuse).expect("a valid half-space");
        let tally = || WhiteTally::new(eta, &shares);
        let outcome = estimate(&walk, PHOTONS, 7, tally, |_| {}, &AtomicBool::new(false));
        for (i, share) in shares.iter().enumerate() {
            let rings = Rings::new(&outcome.estimates[i * RINGS..(i + 1) * RINGS]);
            let errors = errors(&rings, *share, eta, g);
            let cells: Vec<String> = errors.iter().map(|e| format!("{:.1} %", 100.0 * e)).collect();
            println!(
                "| {eta} | {g} | {} | {} | {:.1} % |",
                1.0 - ABSORBED_SHARES[i],
                cells.join(" | "),
                100.0 * rings.noise
            );
        }
    }
}

/// Light of unit energy by ring.
struct Rings {
    /// Inner and outer radius, energy.
    rings: Vec<(f64, f64, f64)>,
    /// What noise adds to a sum of absolute differences in the mean: σ√(2/π) for each ring.
    noise: f64,
}

impl Rings {
    /// A twelfth of a decade each: pairs of those counted.
    fn new(counted: &[Estimate]) -> Self {
        let total: f64 = counted.iter().map(|e| e.value).sum();
        let first = (0..RINGS).find(|&i| ring_edge(i) > RADII.0 * 0.999).unwrap_or(0) + 1;
        let indices = (first..RINGS - 1).step_by(2).take_while(|&i| ring_edge(i) < RADII.1 * 1.001);
        let mut noise = 0.0;
        let rings = indices
            .map(|i| {
                noise += counted[i].standard_error.hypot(counted[i + 1].standard_error) / total;
                (ring_edge(i - 1), ring_edge(i + 1), (counted[i].value + counted[i + 1].value) / total)
            })
            .collect();
        Self { rings, noise: noise * (2.0 / std::f64::consts::PI).sqrt() }
    }

    /// Σ|model − truth|/Σ truth; `model` gives the share of its energy between two radii.
    fn error(&self, model: impl Fn(f64, f64) -> f64) -> f64 {
        let truth: f64 = self.rings.iter().map(|ring| ring.2).sum();
        self.rings.iter().map(|&(from, to, energy)| (model(from, to) - energy).abs()).sum::<f64>() / truth
    }
}

/// Errors of all profiles for the medium of extinction 1 that absorbs `share` of each collision.
fn errors(rings: &Rings, share: f64, eta: f64, g: f64) -> [f64; 6] {
    let half_space = HalfSpace::new(share, 1.0 - share, g, eta).expect("a valid half-space");
    let length = half_space.mean_free_path_reduced();
    let of = |model: &dyn DiffusionModel| {
        let total = total_energy(model, length);
        rings.error(|from, to| energy_between(model, from, to) / total)
    };
    let matched =
        PlaneParallel::new(1.0, 0.0).half_space(half_space.absorbed_share_reduced()).albedo(Entry::Diffuse);
    let table = tabulated::shape_table(Entry::Diffuse, eta, g);
    let shape = table.shape(half_space.absorbed_share_reduced() as f32, length as f32);
    [
        of(&Dipole::new(&half_space)),
        of(&BetterDipole::new(&half_space)),
        of(&UniformlyLitDirectionalDipole::new(&half_space)),
        of(&NormalizedDiffusionModel::new(Fit::DiffuseTransmission, matched, length)),
        of(&PhotonBeam::new(&half_space)),
        rings.error(|from, to| {
            f64::from(shape.cumulative(to as f32)) - f64::from(shape.cumulative(from as f32))
        }),
    ]
}
