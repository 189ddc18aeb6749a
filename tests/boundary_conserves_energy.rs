//! What a boundary does not reflect enters: the tabulated albedo is that of the sampled lobe, and the
//! exit lobe is normalised.

mod common;

use std::f64::consts::TAU;

use alabaster::math::quadrature::GaussLegendre;
use alabaster::math::sampler::HashGenerator;
use alabaster::optics::{Boundary, fresnel_dielectric, fresnel_moment};
use common::bsdfs::{direction, sphere_integral};

const ETAS: [f32; 8] = [1.0 / 1.5, 0.95, 1.0, 1.000_001, 1.05, 1.33, 1.5, 2.4];
const ALPHAS: [f32; 7] = [0.0, 1e-3, 0.01, 0.05, 0.2, 0.5, 1.0];

/// The stated error of the albedo table.
fn table_error(eta: f32, alpha: f32) -> f64 {
    match (eta < 1.0, alpha < 0.005) {
        _ if alpha == 0.0 => 1e-6,
        (false, false) => 5e-4,
        (false, true) => 2e-3,
        (true, false) => 5e-3,
        (true, true) => 5e-2,
    }
}

/// Mean and standard error of `draws` values.
fn estimate(draws: usize, mut draw: impl FnMut() -> f64) -> (f64, f64) {
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..draws {
        let value = draw();
        sum += value;
        squares += value * value;
    }
    let mean = sum / draws as f64;
    (mean, ((squares / draws as f64 - mean * mean).max(0.0) / draws as f64).sqrt())
}

#[test]
fn tabulated_albedo_is_that_of_the_sampled_reflection() {
    let mut random = HashGenerator::new(1);
    for eta in ETAS {
        for alpha in ALPHAS {
            let boundary = Boundary::new(eta, alpha);
            for mu in [1e-3, 0.013, 0.07, 0.15, 0.31, 0.5, 0.66, 0.745, 0.9, 0.99] {
                let (mean, sigma) = estimate(20_000, || {
                    let u = [random.next_f32(), random.next_f32()];
                    boundary.sample_reflection(direction(mu, 0.9), u).map_or(0.0, |s| f64::from(s.weight))
                });
                let error = (mean - f64::from(boundary.reflectance(mu))).abs();
                // 560 comparisons: 4σ.
                let allowed = 4.0 * sigma + table_error(eta, alpha);
                assert!(error <= allowed, "eta {eta} alpha {alpha} mu {mu}: {error} {sigma}");
            }
        }
    }
}

/// Light that is uniform over the hemisphere: what is reflected and what enters add up to all of it,
/// with no allowance but the noise.
#[test]
fn reflected_and_entering_light_add_up() {
    let mut random = HashGenerator::new(4);
    for (eta, alpha) in
        [(1.33, 0.01), (1.5, 0.05), (1.5, 0.3), (2.4, 1.0), (1.0 / 1.5, 0.01), (1.0 / 1.5, 0.3)]
    {
        let boundary = Boundary::new(eta, alpha);
        let (sum, sigma) = estimate(400_000, || {
            // Cosine-distributed.
            let mu = random.next_f32().sqrt().max(1e-6);
            let u = [random.next_f32(), random.next_f32()];
            let reflected = boundary.sample_reflection(direction(mu, 0.2), u).map_or(0.0, |s| s.weight);
            f64::from(reflected + boundary.transmittance(mu))
        });
        assert!((sum - 1.0).abs() < 4.0 * sigma, "eta {eta} alpha {alpha}: {sum} {sigma}");
    }
}

#[test]
fn exit_lobe_integrates_to_one() {
    let rule = GaussLegendre::new(64);
    for eta in ETAS {
        for alpha in ALPHAS {
            let boundary = Boundary::new(eta, alpha);
            // μ = t⁴ towards grazing; split at the kink of total reflection.
            let critical = f64::from((1.0 - eta * eta).max(0.0).sqrt());
            let lobe = |mu: f64| mu * f64::from(boundary.exit_lobe(mu as f32));
            let above = |t: f64| lobe(critical + (1.0 - critical) * t.powi(4)) * 4.0 * t.powi(3);
            let below = |t: f64| lobe(critical * (1.0 - t.powi(4))) * 4.0 * t.powi(3);
            let pieces = |f: &dyn Fn(f64) -> f64| -> f64 {
                (0..16).map(|i| rule.integrate(f64::from(i) / 16.0, f64::from(i + 1) / 16.0, f)).sum()
            };
            let integral = TAU * ((1.0 - critical) * pieces(&above) + critical * pieces(&below));
            assert!((integral - 1.0).abs() < 1e-5, "eta {eta} alpha {alpha}: {integral}");
        }
    }
}

#[test]
fn smooth_boundary_is_fresnel() {
    for eta in ETAS {
        let boundary = Boundary::new(eta, 0.0);
        let mean = 1.0 - 2.0 * fresnel_moment(f64::from(eta), 1);
        assert!((f64::from(boundary.mean_transmittance()) - mean).abs() < 1e-6);
        for mu in [1e-4, 0.2, 0.745, 1.0] {
            let fresnel = fresnel_dielectric(mu, eta);
            assert_eq!(boundary.reflectance(mu), fresnel.reflectance);
            assert_eq!(boundary.transmittance(mu), fresnel.transmittance);
        }
        let wo = direction(0.4, 1.0);
        let sample = boundary.sample_reflection(wo, [0.1, 0.2]).expect("a mirror always reflects");
        assert_eq!((sample.direction + wo).truncate().length(), 0.0);
        assert_eq!(boundary.evaluate_reflection(wo, sample.direction), 0.0);
        assert_eq!(boundary.reflection_density(wo, sample.direction), 0.0);
    }
    // 1 − 2C₁ as other renderers use it, to the digits of the multi-precision table.
    let known = [(1.33, 0.934_069_2), (1.5, 0.908_222)];
    for (eta, c) in known {
        assert!((Boundary::new(eta, 0.0).mean_transmittance() - c).abs() < 1e-6);
    }
}

/// The table stays a probability at every angle, also off its nodes.
#[test]
fn albedo_is_a_share() {
    for eta in ETAS {
        for alpha in ALPHAS {
            let boundary = Boundary::new(eta, alpha);
            for i in 0..=1000 {
                let mu = (i as f32 / 1000.0).powi(2);
                let (reflected, entering) = (boundary.reflectance(mu), boundary.transmittance(mu));
                assert!(
                    (0.0..=1.0).contains(&reflected) && (0.0..=1.0).contains(&entering),
                    "{eta} {alpha} {mu}"
                );
                assert!((reflected + entering - 1.0).abs() <= f32::EPSILON);
            }
        }
    }
}

/// Value, density and weight of the rough reflection describe one lobe.
#[test]
fn rough_reflection_is_consistent() {
    let mut random = HashGenerator::new(3);
    for (eta, alpha) in [(1.5, 0.15), (1.33, 0.6), (1.0 / 1.5, 0.3)] {
        let boundary = Boundary::new(eta, alpha);
        for mu in [0.9, 0.4, 0.1] {
            let wo = direction(mu, 0.4);
            let albedo = sphere_integral(|wi| f64::from(boundary.evaluate_reflection(wo, wi)));
            // The error of the table, and of quadrature over a kink (total reflection, horizon).
            let allowed = table_error(eta, alpha) + 1e-4;
            assert!((albedo - f64::from(boundary.reflectance(mu))).abs() < allowed, "{eta} {alpha} {mu}");
            let mut found = 0.0;
            for _ in 0..5000 {
                let u = [random.next_f32(), random.next_f32()];
                let Some(sample) = boundary.sample_reflection(wo, u) else { continue };
                found += 1.0 / 5000.0;
                let density = boundary.reflection_density(wo, sample.direction);
                let value = boundary.evaluate_reflection(wo, sample.direction);
                assert_eq!(density, sample.density);
                // The microfacet's cosine errs by an ulp or two, which total reflection magnifies.
                let tolerance = if eta < 1.0 { 1e-3 } else { 1e-5 };
                assert!(
                    (value - sample.weight * density).abs() <= tolerance * value,
                    "{eta} {alpha} {sample:?}"
                );
            }
            let integral = sphere_integral(|wi| f64::from(boundary.reflection_density(wo, wi)));
            // Binomial, 4σ.
            let sigma = (integral * (1.0 - integral).max(0.0) / 5000.0).sqrt();
            assert!((integral - found).abs() < 4.0 * sigma + 1e-4, "{eta} {alpha} {mu}: {integral} {found}");
        }
    }
}
