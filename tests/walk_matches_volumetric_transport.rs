//! The random walk against an independent volumetric path tracer: no bias, and errors no larger than their estimate.

mod common;

use common::volumetric::{compare_walk, read};

/// Samples per pixel, of 32 × 32 pixels, and what their pulls are like. The reference's ray offsets cost it up to 0.3 %.
fn check(name: &str, samples: u64) {
    let (comparison, pulls) = compare_walk(&read(name), samples);
    println!("{name}: {comparison:?}");
    for c in 0..3 {
        let (bias, sigma) = comparison.bias(c);
        println!("{name} channel {c}: {bias:.5} ± {sigma:.5}");
        assert!(bias.abs() < 3.0 * sigma + 0.003, "{name} channel {c}: {bias} ± {sigma}");
        assert!(bias.abs() < 0.005, "{name} channel {c}: {bias}");
    }
    let count = pulls.len() as f64;
    let mean = pulls.iter().sum::<f64>() / count;
    let sigma = (pulls.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / count).sqrt();
    let beyond = |limit: f64| pulls.iter().filter(|z| z.abs() > limit).count() as f64 / count;
    println!(
        "{name}: {count} pulls, mean {mean:.3}, σ {sigma:.3}, beyond 1, 2, 3: {:.4} {:.4} {:.4}",
        beyond(1.0),
        beyond(2.0),
        beyond(3.0)
    );
    assert!((0.9..=1.1).contains(&sigma), "{name}: σ of the pulls {sigma}");
}

#[test]
fn a_marble_sphere_is_right() {
    check("sphere_marble", 2048);
}

#[test]
fn an_index_matched_sphere_is_right() {
    check("sphere_indexmatched", 1024);
}

#[test]
fn a_thin_slab_lit_from_behind_is_right() {
    check("slab_thin", 1024);
}
