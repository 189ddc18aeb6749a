//! The tabulated profile follows photon Monte Carlo between the nodes of its table, to 1 % summed over rings.

use std::sync::atomic::AtomicBool;

use alabaster::diffusion::{Profile, tabulated};
use alabaster::medium::Entry;
use alabaster::slab::white::{RINGS, WhiteTally, ring_edge, white_walk};
use alabaster::slab::{Estimate, Source, estimate};

/// Rings of a twelfth of a decade between these radii, in mean free paths.
const RADII: (f64, f64) = (1e-3, 100.0);

/// A half-space of mean free path 1.
struct HalfSpace {
    entry: Entry,
    eta: f64,
    g: f64,
}

/// Σ|table − truth|/Σ truth over rings, both of unit energy, and what the noise of `truth` adds to it in the mean:
/// E|x| = σ√(2/π) for each ring.
fn l1_error(half_space: &HalfSpace, absorbed_share: f64, rings: &[Estimate]) -> (f64, f64) {
    let HalfSpace { entry, eta, g } = *half_space;
    let reduced = 1.0 - (1.0 - absorbed_share) * g;
    let table = tabulated::shape_table(entry, eta, g);
    let shape = table.shape((absorbed_share / reduced) as f32, (1.0 / reduced) as f32);
    let total: f64 = rings.iter().map(|e| e.value).sum();
    let (mut difference, mut noise, mut sum) = (0.0, 0.0, 0.0);
    // Pairs of rings, from the edge at RADII.0 on.
    let first = (0..RINGS).find(|&i| ring_edge(i) >= RADII.0 * 0.999).unwrap() + 1;
    for i in (first..).step_by(2).take_while(|&i| ring_edge(i) < RADII.1 * 1.001) {
        let (from, to) = (ring_edge(i - 1), ring_edge(i + 1));
        let truth = (rings[i].value + rings[i + 1].value) / total;
        let sigma = rings[i].standard_error.hypot(rings[i + 1].standard_error) / total;
        let model = f64::from(shape.cumulative(to as f32)) - f64::from(shape.cumulative(from as f32));
        difference += (model - truth).abs();
        noise += sigma * (2.0 / std::f64::consts::PI).sqrt();
        sum += truth;
    }
    (difference / sum, noise / sum)
}

fn truth(half_space: &HalfSpace, shares: &[f64], photons: u64) -> Vec<Vec<Estimate>> {
    let source = match half_space.entry {
        Entry::Normal => Source::Pencil { cosine: 1.0 },
        Entry::Diffuse => Source::Diffuse,
    };
    let walk = white_walk(half_space.eta, half_space.g, source).unwrap();
    let tally = || WhiteTally::new(half_space.eta, shares);
    let outcome = estimate(&walk, photons, 20_261, tally, |_| {}, &AtomicBool::new(false));
    outcome.estimates[..shares.len() * RINGS].chunks(RINGS).map(<[Estimate]>::to_vec).collect()
}

/// 1 − α', from white to nearly black.
const ABSORBED: [f64; 9] = [3e-5, 1e-3, 0.01, 0.1, 0.3, 0.5, 0.8, 0.93, 0.99];

/// Largest error where 1 − α' is at most a half. Darker media send next to nothing back, and what they send was walked less often.
const LARGEST_ERROR: f64 = 0.01;
const LARGEST_ERROR_OF_DARK: f64 = 0.04;

/// Compares between the nodes of η and g. What is measured is at most the error of the table and that of the walk together.
fn assert_follows(entry: Entry, media: &[(f64, f64)], photons: u64) {
    for &(eta, g) in media {
        let half_space = HalfSpace { entry, eta, g };
        let shares = ABSORBED.map(|a| a * (1.0 - g) / (1.0 - g * a));
        for ((absorbed, share), rings) in
            ABSORBED.iter().zip(shares).zip(truth(&half_space, &shares, photons))
        {
            let (error, noise) = l1_error(&half_space, share, &rings);
            println!("{entry:?} η {eta} g {g} 1 − α' {absorbed}: {error:.4}, of which noise {noise:.4}");
            let largest = if *absorbed <= 0.5 { LARGEST_ERROR } else { LARGEST_ERROR_OF_DARK };
            assert!(error <= largest + noise, "{entry:?} η {eta} g {g} 1 − α' {absorbed}: {error} ({noise})");
        }
    }
}

#[test]
fn diffuse_light_between_the_nodes() {
    assert_follows(
        Entry::Diffuse,
        &[(0.7, 0.0), (1.33, 0.0), (1.5, 0.3), (1.4, 0.75), (1.2, 0.87)],
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
        for eta in [0.65, 0.9, 1.0, 1.03, 1.1, 1.2, 1.33, 1.5, 1.8, 2.0] {
            for g in [0.0, 0.1, 0.25, 0.56, 0.75, 0.87] {
                assert_follows(entry, &[(eta, g)], 3_000_000);
            }
        }
    }
}
