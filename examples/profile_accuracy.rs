//! How far the form of each profile is from photon Monte Carlo, as a renderer uses it: the table of `docs/profiles.md`.
//!
//! ```sh
//! cargo run --release --example profile_accuracy
//! ```
//!
//! The light enters from uniform surroundings. Every profile is scaled to the exact albedo, as it is in a render, so what is
//! compared is where the light leaves, not how much.

use std::sync::atomic::AtomicBool;

use alabaster::diffusion::{
    BetterDipole, DiffusionModel, Dipole, Fit, HalfSpace, NormalizedDiffusionModel, PhotonBeam,
    UniformlyLitDirectionalDipole,
};
use alabaster::medium::albedo_inversion::unreduced_share;
use alabaster::medium::{Entry, PlaneParallel};
use alabaster::slab::LayerError;
use alabaster::study::profile::comparison::{l1_error, noise};
use alabaster::study::profile::models::TabulatedModel;
use alabaster::study::profile::rings::Rings;
use alabaster::study::profile::truth::white_rings;
use alabaster::study::profile::{Effort, Watch};

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

const EFFORT: Effort = Effort { photons: 2_000_000, seed: 7 };

fn main() -> Result<(), LayerError> {
    println!(
        "| η | g | α' | dipole | better-dipole | directional-dipole | normalized-diffusion | photon-beam | tabulated | noise |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    let watch = Watch { advance: &|_| {}, stop: &AtomicBool::new(false) };
    for (eta, g) in MEDIA {
        let shares = ABSORBED_SHARES.map(|a| unreduced_share(a, g));
        let truths = white_rings(eta, g, Entry::Diffuse, &shares, EFFORT, watch)?;
        for ((reduced, share), truth) in ABSORBED_SHARES.iter().zip(shares).zip(&truths) {
            let medium = HalfSpace { sigma_a: share, sigma_s: 1.0 - share, g, eta };
            let percent = |share: f64| format!("{:.1} %", 100.0 * share);
            let cells = errors(&medium, truth).map(|error| error.map_or("–".into(), percent));
            println!(
                "| {eta} | {g} | {} | {} | {} |",
                1.0 - reduced,
                cells.join(" | "),
                percent(noise(truth))
            );
        }
    }
    Ok(())
}

/// Errors of the form of all profiles; none where the table does not reach.
fn errors(medium: &HalfSpace, truth: &Rings) -> [Option<f64>; 6] {
    let total = truth.total().value;
    let of = |model: &dyn DiffusionModel| {
        let rings = Rings::of_model(model);
        Some(l1_error(&rings.scaled(total / rings.total().value), truth))
    };
    let matched = PlaneParallel::new(1.0, 0.0);
    let albedo = matched.half_space(medium.absorbed_share_reduced()).albedo(Entry::Diffuse);
    let length = medium.mean_free_path_reduced();
    [
        of(&Dipole::new(medium)),
        of(&BetterDipole::new(medium)),
        of(&UniformlyLitDirectionalDipole::new(medium)),
        of(&NormalizedDiffusionModel::new(Fit::DiffuseTransmission, albedo, length)),
        of(&PhotonBeam::new(medium)),
        TabulatedModel::new(medium, Entry::Diffuse, total).ok().and_then(|model| of(&model)),
    ]
}
