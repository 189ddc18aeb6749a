//! The tabulated profile follows photon Monte Carlo between the nodes of its table, to 1 % summed over rings.

use std::sync::atomic::AtomicBool;

use alabaster::diffusion::HalfSpace;
use alabaster::medium::albedo_inversion::unreduced_share;
use alabaster::medium::{Entry, PlaneParallel};
use alabaster::study::profile::comparison::{l1_error, noise};
use alabaster::study::profile::models::TabulatedModel;
use alabaster::study::profile::rings::Rings;
use alabaster::study::profile::truth::white_rings;
use alabaster::study::profile::{Effort, Watch};

/// 1 − α', from white to nearly black.
const ABSORBED: [f64; 9] = [3e-5, 1e-3, 0.01, 0.1, 0.3, 0.5, 0.8, 0.93, 0.99];

/// Largest error, summed over rings.
const LARGEST_ERROR: f64 = 0.01;

/// Compares between the nodes of η and g. What is measured is at most the error of the table and that of the walk together.
fn assert_follows(entry: Entry, media: &[(f64, f64)], photons: u64) {
    let watch = Watch { advance: &|_| {}, stop: &AtomicBool::new(false) };
    for &(eta, g) in media {
        let shares = ABSORBED.map(|a| unreduced_share(a, g));
        let truths = white_rings(eta, g, entry, &shares, Effort { photons, seed: 20_261 }, watch).unwrap();
        assert_eq!(truths.len(), ABSORBED.len());
        for ((absorbed, share), truth) in ABSORBED.iter().zip(shares).zip(&truths) {
            let medium = HalfSpace::new(share, 1.0 - share, g, eta).unwrap();
            // Of the exact energy: the walk's own is uncertain by what comes out far away, where few packets are.
            let albedo = PlaneParallel::new(eta, g).half_space(share).albedo(entry);
            let model = TabulatedModel::new(&medium, entry, albedo).unwrap();
            let (error, noise) = (l1_error(&Rings::of_model(&model), truth), noise(truth));
            println!("{entry:?} η {eta} g {g} 1 − α' {absorbed}: {error:.4}, of which noise {noise:.4}");
            assert!(
                error <= LARGEST_ERROR + noise,
                "{entry:?} η {eta} g {g} 1 − α' {absorbed}: {error} ({noise})"
            );
        }
    }
}

#[test]
fn diffuse_light_between_the_nodes() {
    assert_follows(
        Entry::Diffuse,
        &[(0.7, 0.0), (1.33, 0.0), (1.5, 0.3), (1.4, 0.75), (1.03, 0.87), (1.2, 0.87)],
        1_000_000,
    );
}

#[test]
fn a_pencil_beam_between_the_nodes() {
    assert_follows(Entry::Normal, &[(0.9, 0.2), (1.03, 0.0), (1.5, 0.0), (1.33, 0.56)], 1_000_000);
}

#[test]
#[ignore = "ten minutes"]
fn everything_between_the_nodes() {
    for entry in [Entry::Normal, Entry::Diffuse] {
        for eta in [0.65, 0.9, 1.0, 1.015, 1.03, 1.1, 1.2, 1.33, 1.5, 1.8, 2.0] {
            for g in [0.0, 0.1, 0.25, 0.56, 0.75, 0.87] {
                assert_follows(entry, &[(eta, g)], 3_000_000);
            }
        }
    }
}
