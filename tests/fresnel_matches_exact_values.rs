//! Fresnel's equations in single precision hold their digits where the textbook forms lose them.

use alabaster::math::sampler::HashGenerator;
use alabaster::optics::{fresnel_dielectric, fresnel_moment, refract};
use glam::Vec3;

/// Rows of a CSV file in tests/data, without comments and the header.
fn rows(text: &'static str) -> impl Iterator<Item = Vec<&'static str>> {
    text.lines().filter(|line| !line.starts_with('#')).skip(1).map(|line| line.split(',').collect())
}

fn number(text: &str) -> f64 {
    text.parse().expect("a number in tests/data")
}

const ANGLES: &str = include_str!("data/fresnel_angles.csv");
const MOMENTS: &str = include_str!("data/fresnel_moments.csv");
const NEAR_MATCHED: &str = include_str!("data/fresnel_near_matched_index.csv");

/// An exact cosine lies between two neighbours in single precision, and so must the exact
/// transmittance, which grows with the cosine; the margin of 1e-6 is eight ulps of the result.
#[test]
fn transmittance_brackets_the_exact_value_at_every_angle() {
    let mut tested = 0;
    for row in rows(ANGLES) {
        let (eta, side) = (row[0].parse::<f32>().expect("eta"), row[1]);
        let cos = number(row[2]).to_radians().cos();
        let rounded = cos.max(0.0) as f32;
        let sign = if side == "ext" { 1.0 } else { -1.0 };
        let exact = 1.0 - number(row[3]);
        let at = |cos: f32| f64::from(fresnel_dielectric(sign * cos, eta).transmittance);
        let (low, high) = (at(rounded.next_down().max(0.0)), at(rounded.next_up()));
        // The table itself has 12 decimals of F, and eta is rounded to single precision.
        let margin = 1e-6 * exact + 1e-11;
        assert!(low - margin <= exact && exact <= high + margin, "{row:?}: {low} {exact} {high}");
        // Away from the critical angle, where a cosine in single precision determines the result:
        let sensitive = (high - low) > 1e-6 * exact;
        if !sensitive && cos >= 1e-4 {
            assert!((at(rounded) - exact).abs() <= 1e-5 * exact + 1e-11, "{row:?}");
            tested += 1;
        }
    }
    assert!(tested >= 80, "{tested}");
}

/// `1 − F` computed by subtraction has no digits left here: half an ulp of 1 is 6e-8.
#[test]
fn transmittance_towards_grazing_keeps_its_digits() {
    for eta in [1.1_f32, 1.33, 1.5, 2.4] {
        for exponent in 0..=60 {
            let cos = 10.0_f32.powf(-0.1 * exponent as f32);
            let transmittance = f64::from(fresnel_dielectric(cos, eta).transmittance);
            let exact = textbook_transmittance(f64::from(cos), f64::from(eta));
            // `exact` itself cancels in double precision: 4 ulps of 1.
            let error = (transmittance - exact).abs() - 4.0 * f64::EPSILON;
            assert!(error <= 2.0 * f64::from(f32::EPSILON) * exact, "eta {eta} cos {cos}");
        }
    }
    let by_subtraction = 1.0 - fresnel_dielectric(1e-6, 1.5).reflectance;
    let kept = fresnel_dielectric(1e-6, 1.5).transmittance;
    assert!((by_subtraction / kept - 1.0).abs() > 1e-3, "the counterexample no longer is one");
}

/// 1 − F by amplitudes, in double precision.
fn textbook_transmittance(cos_i: f64, eta: f64) -> f64 {
    let cos_t = (1.0 - (1.0 - cos_i * cos_i) / (eta * eta)).sqrt();
    let s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    1.0 - 0.5 * (s * s + p * p)
}

#[test]
fn reflectance_near_matched_index_keeps_its_digits() {
    let mut textbook_fails = 0;
    for row in rows(NEAR_MATCHED) {
        let (eta, cos) = (row[0].parse::<f32>().expect("eta"), row[1].parse::<f32>().expect("cos"));
        let (exact, textbook) = (number(row[2]), number(row[3]));
        let reflectance = f64::from(fresnel_dielectric(cos, eta).reflectance);
        // Eight digits in the table, one ulp of the result.
        assert!((reflectance / exact - 1.0).abs() < 2e-7, "{row:?}: {reflectance}");
        textbook_fails += usize::from((textbook / exact - 1.0).abs() > 1e-4);
    }
    assert!(textbook_fails >= 5, "the counterexamples no longer are any");
}

#[test]
fn matched_index_is_no_interface() {
    for cos in [-1.0, -0.3, -1e-7, 0.0, 1e-20, 0.5, 1.0] {
        let fresnel = fresnel_dielectric(cos, 1.0);
        assert_eq!((fresnel.reflectance, fresnel.transmittance, fresnel.cos_t), (0.0, 1.0, -cos));
    }
    // Continuous into it.
    let next = 1.0 + f32::EPSILON;
    assert!(fresnel_dielectric(0.5, next).reflectance < 1e-13);
    let moment = |eta: f64| fresnel_moment(eta, 1);
    assert!(moment(1.0) == 0.0 && moment(1.0 + 1e-6) < 1e-5 && moment(1.0 - 1e-6) < 1e-5);
}

#[test]
fn energy_closes_on_both_sides_of_the_critical_angle() {
    let mut largest = 0.0_f32;
    for eta in [1.0001_f32, 1.33, 1.5, 2.4] {
        let critical = (1.0 - 1.0 / (eta * eta)).sqrt();
        for (from, to) in [(0.0, 1.0), (critical * (1.0 - 1e-5), critical * (1.0 + 1e-5))] {
            for i in 0..=125_000 {
                let cos = (from + (to - from) * i as f32 / 125_000.0).min(1.0);
                for (cos, eta) in [(-cos, eta), (cos, 1.0 / eta)] {
                    let fresnel = fresnel_dielectric(cos, eta);
                    let in_range = (0.0..=1.0).contains(&fresnel.reflectance)
                        && (0.0..=1.0).contains(&fresnel.transmittance);
                    assert!(in_range, "{cos} {eta} {fresnel:?}");
                    largest = largest.max((fresnel.reflectance + fresnel.transmittance - 1.0).abs());
                }
            }
        }
    }
    assert!(largest <= f32::EPSILON, "{largest}");
}

/// The refracted cosine against 1 − sin²·eta², exact enough in double precision; in single precision
/// that expression has lost most of its digits.
#[test]
fn refracted_cosine_holds_up_to_the_critical_angle() {
    let eta = 1.5_f32;
    let critical = (5.0_f32 / 9.0).sqrt();
    let mut single_precision_error = 0.0_f64;
    for steps in 1..=64 {
        let cos = f32::from_bits(critical.to_bits() + steps);
        let exact = (1.0 - (1.0 - f64::from(cos).powi(2)) * 2.25).sqrt();
        let cos_t = f64::from(fresnel_dielectric(-cos, eta).cos_t);
        // cos_t² is 3·cos·(1 ulp of cos) or more, known to 4 ulps of double precision.
        assert!((cos_t / exact - 1.0).abs() < 1e-7, "{steps}: {cos_t} {exact}");
        // The textbook way in single precision: through the sine.
        let sin = (1.0 - cos * cos).sqrt();
        let single = f64::from((1.0 - (eta * sin).powi(2)).max(0.0).sqrt());
        single_precision_error = single_precision_error.max((single / exact - 1.0).abs());
    }
    assert!(single_precision_error > 0.01, "the counterexample no longer is one");
}

#[test]
fn moments_match_multiprecision_quadrature() {
    for row in rows(MOMENTS) {
        let eta = number(row[0]);
        for order in 0..4 {
            for (relative_eta, column) in [(eta, 1 + order), (1.0 / eta, 5 + order)] {
                let exact = number(row[column]);
                let moment = fresnel_moment(relative_eta, order as u32);
                // The table has 12 digits.
                assert!(
                    (moment / exact - 1.0).abs() < 1e-11,
                    "eta {relative_eta} C{order}: {moment} {exact}"
                );
            }
        }
        let (outside, inside) = (2.0 * fresnel_moment(eta, 1), 2.0 * fresnel_moment(1.0 / eta, 1));
        assert!(((1.0 - inside) - (1.0 - outside) / (eta * eta)).abs() < 1e-12);
    }
}

/// The reciprocity of moments also where no table reaches, including bubbles.
#[test]
fn moments_of_the_two_sides_are_reciprocal() {
    for eta in [1.0 / 3.0, 1.0 / 1.5, 0.9999, 1.0 + 1e-6, 1.0 + 1e-4, 1.01, 1.33, 1.5, 2.5, 4.0] {
        let (outside, inside) = (2.0 * fresnel_moment(eta, 1), 2.0 * fresnel_moment(1.0 / eta, 1));
        assert!(((1.0 - inside) - (1.0 - outside) / (eta * eta)).abs() < 1e-9, "{eta}");
    }
}

#[test]
fn refraction_obeys_snell_and_reverses() {
    let mut random = HashGenerator::new(7);
    for _ in 0..10_000 {
        let mut signed = || 2.0 * random.next_f32() - 1.0;
        let w = Vec3::new(signed(), signed(), signed()).normalize();
        let eta = 1.0 + 0.6 * signed();
        let Some(t) = refract(w, Vec3::Z, eta) else {
            let relative_eta = if w.z < 0.0 { 1.0 / eta } else { eta };
            assert!(w.truncate().length() >= relative_eta * (1.0 - 4.0 * f32::EPSILON));
            continue;
        };
        assert!(t.z * w.z < 0.0 && t.is_normalized());
        let ratio = if w.z < 0.0 { eta } else { 1.0 / eta };
        // Opposite tangential parts, in the ratio of indices; a few roundings of numbers up to 1.
        assert!((t.truncate() + ratio * w.truncate()).length() < 8.0 * f32::EPSILON);
        if let Some(back) = refract(t, Vec3::Z, eta) {
            assert!((back.truncate() - w.truncate()).length() < 16.0 * f32::EPSILON * (1.0 + 1.0 / ratio));
        }
    }
}

#[test]
fn degenerate_indices_stay_finite() {
    for eta in [0.0, 1e-30, 1e30, f32::INFINITY] {
        for cos in [-1.0, -0.5, -0.0, 0.0, 1e-30, 0.5, 1.0] {
            let fresnel = fresnel_dielectric(cos, eta);
            assert!((0.0..=1.0).contains(&fresnel.reflectance), "{eta} {cos} {fresnel:?}");
            assert!((0.0..=1.0).contains(&fresnel.transmittance), "{eta} {cos} {fresnel:?}");
        }
    }
}
