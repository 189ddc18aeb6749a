//! The directions that a BSDF draws follow the density it states, and their weights are what it
//! evaluates to.

mod common;

use std::f64::consts::{PI, TAU};

use alabaster::math::quadrature::GaussLegendre;
use alabaster::math::sampler::HashGenerator;
use alabaster::optics::Bsdf;
use common::bsdfs::{direction, rough_bsdfs, sphere_integral};
use glam::Vec3;

const COSINES: [f32; 5] = [0.97, 0.6, 0.2, -0.35, -0.9];

/// Pearson's χ² of 100 000 draws against the integral of the density over each of 2×10×12 cells.
/// Draws that end on no side (microfacet sampling may) form a last cell.
#[test]
fn directions_follow_the_density() {
    for (name, bsdf) in rough_bsdfs() {
        for cos in COSINES {
            let wo = direction(cos, 0.3);
            let (observed, expected) = histogram(&bsdf, wo);
            let excess = chi_square_excess(&observed, &expected);
            // Normal quantile of probability 1e-5, for about 100 tests.
            assert!(excess < 4.3, "{name} from {cos}: {excess} standard deviations");
        }
    }
}

const DRAWS: usize = 100_000;
const POLAR: usize = 20;
const AZIMUTHAL: usize = 12;

fn histogram(bsdf: &Bsdf, wo: Vec3) -> (Vec<f64>, Vec<f64>) {
    let cells = POLAR * AZIMUTHAL;
    let mut random = HashGenerator::new(11);
    let mut observed = vec![0.0; cells + 1];
    for _ in 0..DRAWS {
        let u = [random.next_f32(), random.next_f32(), random.next_f32()];
        let cell = match bsdf.sample(wo, u) {
            Some(sample) if !sample.delta => cell_of(sample.direction),
            _ => cells,
        };
        observed[cell] += 1.0;
    }
    let rule = GaussLegendre::new(24);
    let mut expected: Vec<f64> = (0..cells)
        .map(|cell| {
            let (i, j) = ((cell / AZIMUTHAL) as f64, (cell % AZIMUTHAL) as f64);
            let z = |i: f64| 2.0 * i / POLAR as f64 - 1.0;
            let phi = |j: f64| TAU * j / AZIMUTHAL as f64 - PI;
            let density = |z: f64| {
                let at = |phi: f64| f64::from(bsdf.density(wo, from_polar(z, phi)));
                rule.integrate(phi(j), phi(j + 1.0), at)
            };
            DRAWS as f64 * rule.integrate(z(i), z(i + 1.0), density)
        })
        .collect();
    let found: f64 = expected.iter().sum();
    assert!(found <= DRAWS as f64 * (1.0 + 1e-3), "density integrates to {}", found / DRAWS as f64);
    expected.push((DRAWS as f64 - found).max(0.0));
    (observed, expected)
}

fn cell_of(w: Vec3) -> usize {
    let i = (((w.z + 1.0) / 2.0) * POLAR as f32).clamp(0.0, POLAR as f32 - 1.0) as usize;
    let phi = (f64::from(w.y).atan2(f64::from(w.x)) + PI) / TAU;
    i * AZIMUTHAL + ((phi * AZIMUTHAL as f64) as usize).min(AZIMUTHAL - 1)
}

fn from_polar(z: f64, phi: f64) -> Vec3 {
    let r = (1.0 - z * z).sqrt();
    Vec3::new((r * phi.cos()) as f32, (r * phi.sin()) as f32, z as f32)
}

/// χ² in standard deviations of the normal approximation of Wilson and Hilferty 1931; cells that
/// expect few are pooled.
fn chi_square_excess(observed: &[f64], expected: &[f64]) -> f64 {
    let (mut pooled_observed, mut pooled_expected) = (0.0, 0.0);
    let (mut statistic, mut cells) = (0.0, 0);
    for (&o, &e) in observed.iter().zip(expected) {
        if e < 10.0 {
            pooled_observed += o;
            pooled_expected += e;
        } else {
            statistic += (o - e).powi(2) / e;
            cells += 1;
        }
    }
    if pooled_expected > 0.0 {
        statistic += (pooled_observed - pooled_expected).powi(2) / pooled_expected.max(10.0);
        cells += 1;
    }
    let freedom = f64::from((cells - 1).max(1));
    let spread = 2.0 / (9.0 * freedom);
    ((statistic / freedom).cbrt() - (1.0 - spread)) / spread.sqrt()
}

#[test]
fn weight_is_value_over_density() {
    let mut random = HashGenerator::new(5);
    for (name, bsdf) in rough_bsdfs() {
        for cos in COSINES {
            let wo = direction(cos, -1.1);
            for _ in 0..2000 {
                let u = [random.next_f32(), random.next_f32(), random.next_f32()];
                let Some(sample) = bsdf.sample(wo, u) else { continue };
                assert!(sample.direction.is_normalized() && sample.weight.is_finite(), "{name} {sample:?}");
                assert_eq!(sample.transmitted, sample.direction.z * wo.z < 0.0, "{name} {sample:?}");
                assert!(sample.transmitted || !sample.crosses_boundary);
                if sample.delta {
                    continue;
                }
                let density = bsdf.density(wo, sample.direction);
                let value = bsdf.evaluate(wo, sample.direction);
                // The half vector of two directions known to an ulp ε is known to about 2ε/|wo + e·wi|:
                // relative to the lobe of width α ≥ 0.1 and for |e − 1| ≥ 0.3 that is 40·2·2ε/0.3.
                let tolerance = 300.0 * f32::EPSILON;
                assert!((sample.density / density - 1.0).abs() < tolerance, "{name} {sample:?} {density}");
                for c in 0..3 {
                    let error = (sample.weight[c] * density - value[c]).abs();
                    assert!(error <= 2.0 * tolerance * value[c], "{name} {sample:?} {value:?}");
                }
            }
        }
    }
}

/// The integral of the value is the expectation of the weight: two independent ways to the albedo.
#[test]
fn mean_weight_is_the_integral_of_the_value() {
    let mut random = HashGenerator::new(6);
    for (name, bsdf) in rough_bsdfs() {
        for cos in [0.8, -0.5] {
            let wo = direction(cos, 2.0);
            let integral = sphere_integral(|wi| f64::from(bsdf.evaluate(wo, wi)[0]));
            let (mut sum, mut squares) = (0.0, 0.0);
            for _ in 0..DRAWS {
                let u = [random.next_f32(), random.next_f32(), random.next_f32()];
                let weight = match bsdf.sample(wo, u) {
                    Some(sample) if !sample.delta => f64::from(sample.weight[0]),
                    _ => 0.0,
                };
                sum += weight;
                squares += weight * weight;
            }
            let mean = sum / DRAWS as f64;
            let sigma = ((squares / DRAWS as f64 - mean * mean).max(0.0) / DRAWS as f64).sqrt();
            // 4σ, and the quadrature (kinks at the horizon).
            assert!((mean - integral).abs() < 4.0 * sigma + 1e-4, "{name} {cos}: {mean} {integral} {sigma}");
        }
    }
}
