//! Fresnel's equations in single precision hold their digits where the textbook forms lose them.

use alabaster::math::sampler::HashGenerator;
use alabaster::optics::{fresnel_dielectric, fresnel_moment, refract};
use alabaster::scene::Method;
use glam::Vec3;

use crate::common::backends::{Pictures, by, renderings};
use crate::common::bodies::bubble;
use crate::common::scenes::{furnace, white};
use crate::record::{Figures, assert_fails, record};
use crate::table::{number, rows};
use alabaster::radiometry::Rgb;

const ANGLES: &str = "fresnel_angles.csv";
const MOMENTS: &str = "fresnel_moments.csv";
const NEAR_MATCHED: &str = "fresnel_near_matched_index.csv";

/// An exact cosine lies between two neighbours in single precision, and so must the exact
/// transmittance, which grows with the cosine; the margin of 1e-6 is eight ulps of the result.
#[test]
fn transmittance_brackets_the_exact_value_at_every_angle() {
    let mut tested = 0;
    for row in rows(ANGLES) {
        let (eta, side) = (row[0].parse::<f32>().expect("eta"), row[1].as_str());
        let cos = number(&row[2]).to_radians().cos();
        let rounded = cos.max(0.0) as f32;
        let sign = if side == "ext" { 1.0 } else { -1.0 };
        let exact = 1.0 - number(&row[3]);
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
fn grazing_incidence() {
    let (mut largest, mut by_subtraction) = (0.0_f64, 0.0_f64);
    for eta in [1.1_f32, 1.33, 1.5, 2.4] {
        for exponent in 0..=60 {
            let cos = 10.0_f32.powf(-0.1 * exponent as f32);
            let fresnel = fresnel_dielectric(cos, eta);
            assert!(fresnel.reflectance <= 1.0);
            let exact = textbook_transmittance(f64::from(cos), f64::from(eta));
            // `exact` itself cancels in double precision: 4 ulps of 1.
            let error = |x: f32| ((f64::from(x) - exact).abs() - 4.0 * f64::EPSILON) / exact;
            largest = largest.max(error(fresnel.transmittance));
            by_subtraction = by_subtraction.max(error(1.0 - fresnel.reflectance));
        }
    }
    // Rounding of the result and of the cosine's square in it.
    let holds = |error: f64| error <= 2.0 * f64::from(f32::EPSILON);
    assert!(holds(largest), "{largest}");
    assert_fails("1 − F by subtraction", by_subtraction, holds);
    record("grazing_incidence", format!("{largest:.0e}; by subtraction {by_subtraction:.0e}"));
}

/// 1 − F by amplitudes, in double precision.
fn textbook_transmittance(cos_i: f64, eta: f64) -> f64 {
    let cos_t = (1.0 - (1.0 - cos_i * cos_i) / (eta * eta)).sqrt();
    let s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    1.0 - 0.5 * (s * s + p * p)
}

#[test]
fn index_towards_one() {
    let (mut largest, mut textbook) = (0.0_f64, 0.0_f64);
    for row in rows(NEAR_MATCHED) {
        let (eta, cos) = (number(&row[0]) as f32, number(&row[1]) as f32);
        let exact = number(&row[2]);
        let error = |x: f64| (x / exact - 1.0).abs();
        largest = largest.max(error(f64::from(fresnel_dielectric(cos, eta).reflectance)));
        textbook = textbook.max(error(f64::from(textbook_reflectance(cos, eta))));
    }
    // Eight digits in the table, one ulp of the result.
    let holds = |error: f64| error < 2e-7;
    assert!(holds(largest), "{largest}");
    assert_fails("amplitudes in single precision", textbook, holds);
    let step = 2.0 * fresnel_moment(1.0 + 1e-6, 1);
    assert!(step < 1e-5 && fresnel_moment(1.0, 1) == 0.0);
    record(
        "index_towards_one",
        format!("{largest:.0e}; textbook {textbook:.0e}; diffuse reflectance at 1 + 10⁻⁶: {step:.0e}"),
    );
}

/// F by amplitudes, in single precision.
fn textbook_reflectance(cos_i: f32, eta: f32) -> f32 {
    let sin_t = (1.0 - cos_i * cos_i).max(0.0).sqrt() / eta;
    let cos_t = (1.0 - sin_t * sin_t).max(0.0).sqrt();
    let s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    0.5 * (s * s + p * p)
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
}

fn largest_energy_error() -> f32 {
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
    largest
}

/// The refracted cosine against 1 − sin²·eta², exact enough in double precision; in single precision
/// that expression has lost most of its digits.
#[test]
fn edge_of_total_reflection() {
    let energy = largest_energy_error();
    assert!(energy <= f32::EPSILON, "{energy}");
    let eta = 1.5_f32;
    let critical = (5.0_f32 / 9.0).sqrt();
    let (mut largest, mut textbook) = (0.0_f64, 0.0_f64);
    for steps in 1..=64 {
        let cos = f32::from_bits(critical.to_bits() + steps);
        let exact = (1.0 - (1.0 - f64::from(cos).powi(2)) * 2.25).sqrt();
        let error = |cos_t: f32| (f64::from(cos_t) / exact - 1.0).abs();
        largest = largest.max(error(fresnel_dielectric(-cos, eta).cos_t));
        // The textbook way in single precision: through the sine.
        let sin = (1.0 - cos * cos).sqrt();
        textbook = textbook.max(error((1.0 - (eta * sin).powi(2)).max(0.0).sqrt()));
    }
    // cos_t² is 3·cos·(1 ulp of cos) or more, known to 4 ulps of double precision.
    let holds = |error: f64| error < 1e-7;
    assert!(holds(largest), "{largest}");
    assert_fails("cosine through the sine", textbook, holds);
    record(
        "edge_of_total_reflection",
        format!("F + T: {energy:.0e}; cosine: {largest:.0e}; through the sine {:.0} %", 100.0 * textbook),
    );
}

#[test]
fn moments_match_multiprecision_quadrature() {
    for row in rows(MOMENTS) {
        let eta = number(&row[0]);
        for order in 0..4 {
            for (relative_eta, column) in [(eta, 1 + order), (1.0 / eta, 5 + order)] {
                let exact = number(&row[column]);
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

/// The reciprocity of moments also where no table reaches, and a picture.
#[test]
fn index_below_one() {
    let mut largest = 0.0_f64;
    for eta in [1.0 / 3.0, 1.0 / 1.5, 0.9999, 1.0 + 1e-6, 1.0 + 1e-4, 1.01, 1.33, 1.5, 2.5, 4.0] {
        let (outside, inside) = (2.0 * fresnel_moment(eta, 1), 2.0 * fresnel_moment(1.0 / eta, 1));
        largest = largest.max(((1.0 - inside) - (1.0 - outside) / (eta * eta)).abs());
    }
    assert!(largest < 1e-9, "{largest}");
    // Where a path at the critical angle begins, as single scattering in photon beam diffusion has it.
    let naive = |eta: f32| (eta * eta - 1.0).sqrt();
    assert_fails("√(η² − 1)", naive(1.0 / 1.5), |x: f32| x.is_finite());
    let mut figures = Figures::default();
    for method in [Method::Bssrdf, Method::Walk] {
        let scene = furnace(bubble().mesh, white(1.0 / 1.5, 0.0, Rgb::splat(10.0)));
        for (setup, found) in renderings(&scene, by(method), &Pictures(16)) {
            let (mean, sigma) = (found.mean.mean(), found.mean.standard_error());
            assert!((mean - 1.0).abs() < 3.0 * sigma + 1e-5, "{method:?} {setup}: {mean} ± {sigma}");
            figures.keep(setup, format!("furnace {mean:.5} ± {sigma:.5}"));
        }
    }
    record("index_below_one", format!("reciprocity {largest:.0e}; {}", figures.written()));
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
fn extreme_indices() {
    for eta in [0.0, 1e-30, 1e30, f32::INFINITY] {
        for cos in [-1.0, -0.5, -0.0, 0.0, 1e-30, 0.5, 1.0] {
            let fresnel = fresnel_dielectric(cos, eta);
            assert!((0.0..=1.0).contains(&fresnel.reflectance), "{eta} {cos} {fresnel:?}");
            assert!((0.0..=1.0).contains(&fresnel.transmittance), "{eta} {cos} {fresnel:?}");
        }
    }
    // Next to no light gets out again: paths are as long as they get.
    let mut figure = Figures::default();
    for method in [Method::Bssrdf, Method::Walk] {
        for eta in [6.0, 1.0 / 6.0] {
            let scene = furnace(bubble().mesh, white(eta, 0.0, Rgb::new(1.0, 0.8, 1.6)));
            for (setup, found) in renderings(&scene, by(method), &Pictures(4)) {
                let (mean, sigma) = (found.mean.mean(), found.mean.standard_error());
                assert!(
                    (mean - 1.0).abs() < 3.0 * sigma + 1e-4,
                    "{method:?} {setup} η {eta}: {mean} ± {sigma}"
                );
                assert_eq!((found.counters.capped_paths, found.counters.rejected), (0, 0));
                figure.keep(setup, format!("furnace at η = 1/6: {mean:.5} ± {sigma:.5}"));
            }
        }
    }
    record("extreme_indices", figure.written());
}
