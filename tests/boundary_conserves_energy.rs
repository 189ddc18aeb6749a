//! What a boundary does not reflect enters: the tabulated albedo is that of the sampled lobe, and the
//! exit lobe is normalised.

use std::f64::consts::PI;

use alabaster::math::quadrature::GaussLegendre;
use alabaster::math::sampler::HashGenerator;
use alabaster::optics::{Boundary, fresnel_moment};
use glam::Vec3;

const ETAS: [f32; 8] = [1.0 / 1.5, 0.95, 1.0, 1.000_001, 1.05, 1.33, 1.5, 2.4];
const ALPHAS: [f32; 7] = [0.0, 1e-3, 0.01, 0.05, 0.2, 0.5, 1.0];

fn direction(mu: f32) -> Vec3 {
    Vec3::new((1.0 - mu * mu).max(0.0).sqrt() * 0.6, (1.0 - mu * mu).max(0.0).sqrt() * 0.8, mu)
}

#[test]
fn tabulated_albedo_is_that_of_the_sampled_reflection() {
    let mut random = HashGenerator::new(1);
    for eta in ETAS {
        for alpha in ALPHAS {
            let boundary = Boundary::new(eta, alpha);
            for mu in [1e-3, 0.013, 0.07, 0.15, 0.31, 0.5, 0.66, 0.745, 0.9, 0.99] {
                const DRAWS: usize = 20_000;
                let (mut sum, mut squares) = (0.0_f64, 0.0_f64);
                for _ in 0..DRAWS {
                    let u = [random.next_f32(), random.next_f32()];
                    let weight =
                        boundary.sample_reflection(direction(mu), u).map_or(0.0, |s| f64::from(s.weight));
                    sum += weight;
                    squares += weight * weight;
                }
                let mean = sum / DRAWS as f64;
                let sigma = ((squares / DRAWS as f64 - mean * mean).max(0.0) / DRAWS as f64).sqrt();
                let expected = f64::from(boundary.reflectance(mu));
                let error = (mean - expected).abs();
                if error > 4.0 * sigma + 1e-6 {
                    println!(
                        "eta {eta} alpha {alpha} mu {mu}: {mean} {expected} err {error:.2e} sigma {sigma:.2e}"
                    );
                }
            }
        }
    }
}

#[test]
fn timing() {
    let t = std::time::Instant::now();
    let b = Boundary::new(1.5, 0.3);
    println!("{:?} {}", t.elapsed(), b.mean_transmittance());
    let t = std::time::Instant::now();
    let b = Boundary::new(1.5, 0.2);
    println!("{:?} {}", t.elapsed(), b.mean_transmittance());
}

#[test]
fn measure_dense() {
    use alabaster::optics::{Ggx, fresnel_dielectric};
    let rule = GaussLegendre::new(160);
    for eta in [1.0 / 1.5, 0.95, 1.05_f32, 1.33, 1.5, 2.4] {
        for alpha in [0.001_f32, 0.01, 0.1, 0.3, 1.0] {
            let ggx = Ggx { alpha };
            let b = Boundary::new(eta, alpha);
            let mut worst = (0.0_f64, 0.0_f32, 0.0);
            for i in 0..150 {
                let x = (i as f32 + 0.37) / 150.0;
                let mu = x * x;
                let mut e = 0.0;
                for &(v, w) in rule.nodes() {
                    for j in 0..128 {
                        let Some(s) = ggx.sample_reflection(
                            Vec3::new((1.0 - mu * mu).sqrt(), 0.0, mu),
                            [(j as f32 + 0.5) / 256.0, v as f32],
                        ) else {
                            continue;
                        };
                        e += w / 128.0
                            * f64::from(s.weight * fresnel_dielectric(s.cos_microfacet, eta).reflectance);
                    }
                }
                let err = (e - f64::from(b.reflectance(mu))).abs();
                if err > worst.0 {
                    worst = (err, mu, e);
                }
            }
            println!("eta {eta:.3} alpha {alpha}: {worst:?}");
        }
    }
}
#[test]
fn measure_schlick() {
    use alabaster::optics::{Ggx, albedo::SchlickAlbedo};
    let rule = GaussLegendre::new(96);
    for alpha in [0.001_f32, 0.0025, 0.0087, 0.022, 0.043, 0.1, 0.16, 0.25, 0.34, 0.5, 0.77, 1.0] {
        let ggx = Ggx { alpha };
        let mut worst = (0.0_f64, 0.0_f32, 0.0);
        let mut avg = 0.0;
        for i in 0..100 {
            let x = (i as f32 + 0.37) / 100.0;
            let mu = x * x;
            let mut e = 0.0;
            for &(v, w) in rule.nodes() {
                for j in 0..96 {
                    let Some(s) = ggx.sample_reflection(
                        Vec3::new((1.0 - mu * mu).sqrt(), 0.0, mu),
                        [(j as f32 + 0.5) / 192.0, v as f32],
                    ) else {
                        continue;
                    };
                    e += w / 96.0 * f64::from(s.weight * (0.04 + 0.96 * (1.0 - s.cos_microfacet).powi(5)));
                }
            }
            let err = e - f64::from(SchlickAlbedo::directional(mu, alpha).at(0.04));
            avg += err * (4.0 * x * x * x / 100.0) as f64;
            if err > worst.0 {
                worst = (err, mu, e);
            }
        }
        println!("alpha {alpha}: {worst:?} mean {avg:.2e}");
    }
}
