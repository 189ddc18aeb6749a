//! The area integral against an independent volumetric path tracer. A planar profile on a curved or thin
//! body is an approximation with a bias: its size is held here from both sides, so that a change of
//! the transport that moves it is seen, for better or worse.

mod common;

use alabaster::scene::ProfileChoice;
use common::volumetric::{Comparison, compare, read};

/// Samples per pixel, of 32 × 32 pixels.
const SAMPLES: u64 = 64;

fn measured(name: &str, profile: ProfileChoice) -> Comparison {
    let comparison = compare(&read(name), profile, SAMPLES);
    println!("{name}, {profile:?}: {comparison:?}");
    comparison
}

/// The bias of each channel's object mean is `expected` to 3σ of this render and 0.3 %: the accuracy
/// of the expectations and of the reference, whose ray offsets cost it up to that.
fn assert_bias(comparison: &Comparison, expected: [f64; 3]) {
    for (c, expected) in expected.into_iter().enumerate() {
        let (bias, sigma) = comparison.bias(c);
        assert!(
            (bias - expected).abs() < 3.0 * sigma + 0.003,
            "channel {c}: {bias} ± {sigma}, not {expected}"
        );
    }
}

/// Twenty mean free paths in radius, with a boundary.
#[test]
fn a_marble_sphere_is_a_tenth_too_dark() {
    let comparison = measured("sphere_marble", ProfileChoice::NormalizedDiffusion);
    assert_bias(&comparison, [-0.097, -0.118, -0.092]);
    assert!(comparison.relative_mse < 0.011);
}

/// Twenty mean free paths in radius, without boundary, which is what the profile was made for.
#[test]
fn an_index_matched_sphere_is_right_to_some_percent() {
    let comparison = measured("sphere_indexmatched", ProfileChoice::NormalizedDiffusion);
    assert_bias(&comparison, [0.005, -0.021, -0.011]);
    assert!(comparison.relative_mse < 0.014);
}

/// Three mean free paths thick and lit from behind: the profile of a half-space sends most of the
/// light back that the slab lets through.
#[test]
fn a_thin_slab_lets_too_little_light_through() {
    let comparison = measured("slab_thin", ProfileChoice::NormalizedDiffusion);
    assert_bias(&comparison, [-0.702; 3]);
    assert!(comparison.relative_mse < 0.48);
}
