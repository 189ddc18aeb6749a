//! No BSDF gives back more power than it gets, from any direction; a clear one gives back all.

mod common;

use alabaster::math::quadrature::GaussLegendre;
use alabaster::math::sampler::HashGenerator;
use alabaster::optics::albedo::SchlickAlbedo;
use alabaster::optics::microfacet::SMOOTH_ALPHA;
use alabaster::optics::{
    Bsdf, Dielectric, Ggx, Metal, MetallicRoughness, Plastic, ThinDielectric, fresnel_conductor_schlick,
};
use alabaster::radiometry::Rgb;
use common::bsdfs::{direction, everything, gltf, rough_bsdfs};

const COSINES: [f32; 8] = [1.0, 0.7, 0.3, 0.1, 0.02, 0.001, -0.05, -0.8];
const ALPHAS: [f32; 8] = [0.0, SMOOTH_ALPHA, 0.003, 0.01, 0.04, 0.15, 0.4, 1.0];
const DRAWS: usize = 10_000;

/// Mean and standard error of the share of *power* scattered from cosine `cos`: weights without the
/// factor (n_o/n_i)² of radiance.
fn albedo(bsdf: &Bsdf, cos: f32, seed: u64) -> (f64, f64) {
    let mut random = HashGenerator::new(seed);
    let (mut sum, mut squares) = (0.0, 0.0);
    for i in 0..DRAWS {
        // Stratified in the choice of lobe.
        let choice = (i as f32 + random.next_f32()) / DRAWS as f32;
        let u = [random.next_f32(), random.next_f32(), choice.min(1.0 - f32::EPSILON)];
        let Some(sample) = bsdf.sample(direction(cos, 0.7), u) else { continue };
        let scale = if sample.crosses_boundary { squared_index_ratio(bsdf, cos) } else { 1.0 };
        let weight = f64::from(sample.weight.max_component() * scale);
        sum += weight;
        squares += weight * weight;
    }
    let mean = sum / DRAWS as f64;
    (mean, ((squares / DRAWS as f64 - mean * mean).max(0.0) / DRAWS as f64).sqrt())
}

/// (n_i/n_o)² of a transmission seen from cosine `cos`.
fn squared_index_ratio(bsdf: &Bsdf, cos: f32) -> f32 {
    let eta = match bsdf {
        Bsdf::Dielectric(dielectric) => dielectric.eta,
        Bsdf::MetallicRoughness(material) if material.diffuse_transmission == 0.0 => material.eta,
        _ => 1.0,
    };
    if cos < 0.0 { 1.0 / (eta * eta) } else { eta * eta }
}

fn white_bsdfs(alpha: f32) -> Vec<(String, Bsdf)> {
    let mut all = Vec::new();
    let white = Rgb::ONE;
    all.push(("metal".into(), Bsdf::Metal(Metal { reflectance_normal: white, alpha })));
    for eta in [1.0 / 1.5, 1.0, 1.000_001, 1.001, 1.33, 2.4] {
        all.push((format!("dielectric {eta}"), Bsdf::Dielectric(Dielectric { eta, alpha, tint: white })));
        all.push((format!("thin {eta}"), Bsdf::ThinDielectric(ThinDielectric { eta, alpha, tint: white })));
        for metallic in [0.0, 0.5] {
            for (thin, transmission, diffuse_transmission) in
                [(false, 0.0, 0.0), (false, 0.6, 0.0), (true, 0.3, 0.5), (true, 0.0, 1.0)]
            {
                let material = MetallicRoughness {
                    base_color: white,
                    diffuse_transmission_color: white,
                    metallic,
                    alpha,
                    eta,
                    transmission,
                    diffuse_transmission,
                    thin,
                };
                all.push((format!("{material:?}"), Bsdf::MetallicRoughness(material)));
            }
        }
    }
    for reflectance_normal in [0.0, 0.04, 0.3, 1.0] {
        let (reflectance, transmittance) = (Rgb::splat(0.75), Rgb::splat(0.25));
        let plastic = Plastic { reflectance_normal, alpha, reflectance, transmittance, thin: true };
        all.push((format!("plastic {reflectance_normal}"), Bsdf::Plastic(plastic)));
    }
    all
}

#[test]
fn white_furnace_never_exceeds_one() {
    for alpha in ALPHAS {
        for (name, bsdf) in white_bsdfs(alpha) {
            for cos in COSINES {
                let (mean, sigma) = albedo(&bsdf, cos, 3);
                // 5σ for 10⁴ comparisons, and the sum of 10⁴ rounded weights.
                assert!(mean <= 1.0 + 5.0 * sigma + 1e-6, "{name} alpha {alpha} cos {cos}: {mean} {sigma}");
            }
        }
    }
}

/// What a white base under a smooth coat must do, and what a rough one nearly does.
#[test]
fn white_plastic_reflects_everything() {
    for (alpha, allowed_loss) in [(0.0, 1e-6), (0.01, 2e-3), (0.3, 2e-3), (1.0, 2e-3)] {
        let plastic = Plastic {
            reflectance_normal: 0.04,
            alpha,
            reflectance: Rgb::ONE,
            transmittance: Rgb::ZERO,
            thin: false,
        };
        for cos in [1.0, 0.7, 0.3] {
            let (mean, sigma) = albedo(&Bsdf::Plastic(plastic), cos, 9);
            assert!((1.0 - mean).abs() <= allowed_loss + 4.0 * sigma, "alpha {alpha} cos {cos}: {mean}");
        }
    }
}

/// The smooth interface by its two lobes: no draw is lost, and the weights are exact.
#[test]
fn smooth_dielectric_scatters_all_the_light() {
    for eta in [1.0 / 1.5, 1.0, 1.000_001, 1.33, 1.5, 2.4] {
        let bsdf = Bsdf::Dielectric(Dielectric { eta, alpha: 0.0, tint: Rgb::ONE });
        for cos in [1.0, 0.7, 0.3, 0.1, 1e-3, 1e-6, -1e-6, -0.05, -0.4, -0.8] {
            let wo = direction(cos, 0.7);
            let reflected = bsdf.sample(wo, [0.5, 0.5, 0.0]).expect("smooth interfaces always scatter");
            let other = bsdf.sample(wo, [0.5, 0.5, 1.0 - 0.5 * f32::EPSILON]);
            let other = other.expect("smooth interfaces always scatter");
            let parts = if reflected.transmitted == other.transmitted {
                vec![reflected]
            } else {
                vec![reflected, other]
            };
            let power = |sample: &alabaster::optics::BsdfSample| {
                let scale = if sample.transmitted { squared_index_ratio(&bsdf, cos) } else { 1.0 };
                sample.weight[0] * scale * sample.density
            };
            let sum: f32 = parts.iter().map(power).sum();
            assert!((sum - 1.0).abs() < 1e-6, "eta {eta} cos {cos}: {sum}");
        }
    }
}

/// A closed body of clear glass in a uniform environment of radiance 1: a path that goes in comes out
/// with the factors of radiance cancelled, so every path brings exactly 1.
#[test]
fn closed_glass_body_is_invisible_in_a_furnace() {
    let mut random = HashGenerator::new(2);
    for eta in [1.0 / 1.5, 1.33, 2.4] {
        let bsdf = Bsdf::Dielectric(Dielectric { eta, alpha: 0.0, tint: Rgb::ONE });
        for _ in 0..2000 {
            // A parallel plate: the cosine inside repeats at every bounce.
            let mut wo = direction(0.05 + 0.95 * random.next_f32(), 0.0);
            let (mut throughput, mut inside) = (1.0_f32, false);
            for _ in 0..1000 {
                let u = [random.next_f32(), random.next_f32(), random.next_f32()];
                let sample = bsdf.sample(wo, u).expect("smooth interfaces always scatter");
                throughput *= sample.weight[0];
                inside ^= sample.crosses_boundary;
                if !inside {
                    break;
                }
                // The opposite face, seen in its own frame, in which outside is +z again.
                wo = -sample.direction;
                wo.z = -wo.z.abs();
            }
            assert!(!inside && (throughput - 1.0).abs() < 1e-6, "{eta}: {throughput}");
        }
    }
}

/// The bound that keeps plastic below 1, against quadrature six times finer.
#[test]
fn coat_albedo_table_is_within_its_stated_error() {
    for alpha in [SMOOTH_ALPHA, 0.0023, 0.0087, 0.021, 0.043, 0.11, 0.3, 0.77, 1.0] {
        for i in 0..40 {
            let x = (i as f32 + 0.37) / 40.0;
            let mu = x * x;
            for f0 in [0.0, 0.04, 0.5, 1.0] {
                let fine = fine_albedo(&Ggx { alpha }, mu, f0);
                let table = f64::from(SchlickAlbedo::directional(mu, alpha).at(f0));
                let bound = f64::from(SchlickAlbedo::relative_error(mu, alpha)) * (1.0 - table);
                assert!(fine - table <= bound, "alpha {alpha} mu {mu} f0 {f0}: {fine} {table} {bound}");
            }
        }
    }
}

/// Directional albedo under Schlick's Fresnel factor by 96 × 96 visible microfacets.
fn fine_albedo(ggx: &Ggx, mu: f32, f0: f32) -> f64 {
    const AZIMUTHS: usize = 96;
    let mut sum = 0.0;
    for &(v, weight) in GaussLegendre::new(96).nodes() {
        for j in 0..AZIMUTHS {
            let u = [(j as f32 + 0.5) / (2 * AZIMUTHS) as f32, v as f32];
            let Some(sample) = ggx.sample_reflection(direction(mu, 0.0), u) else { continue };
            let fresnel = fresnel_conductor_schlick(Rgb::splat(f0), sample.cos_microfacet)[0];
            sum += weight / AZIMUTHS as f64 * f64::from(sample.weight * fresnel);
        }
    }
    sum
}

/// Reciprocity, f(o, i)·n_i² = f(i, o)·n_o² (Veach 1997, eq. 5.14), in single precision.
#[test]
fn swapping_the_directions_gives_the_same_value() {
    let mut random = HashGenerator::new(8);
    let mut compared = 0;
    for (name, bsdf) in rough_bsdfs() {
        // Diffuse transmission has no index: its parts obey the law without the factor.
        if matches!(bsdf, Bsdf::MetallicRoughness(material) if material == everything(false)) {
            continue;
        }
        for _ in 0..4000 {
            let mut draw = || direction(2.0 * random.next_f32() - 1.0, 6.0 * random.next_f32());
            let (a, b) = (draw(), draw());
            let crosses = a.z * b.z < 0.0 && matches!(bsdf, Bsdf::Dielectric(_));
            let factor = if crosses { squared_index_ratio(&bsdf, a.z) } else { 1.0 };
            for c in 0..3 {
                let there = bsdf.evaluate(a, b)[c] / b.z.abs() * factor;
                let back = bsdf.evaluate(b, a)[c] / a.z.abs();
                // Half vectors from two orders of summation, as in the test of weights.
                let error = (there - back).abs() / there.max(back).max(1e-3);
                assert!(error < 300.0 * f32::EPSILON, "{name} {a} {b}: {there} {back}");
                compared += usize::from(there > 0.0);
            }
        }
    }
    assert!(compared > 50_000, "{compared}");
}

#[test]
fn lobes_are_reported_as_what_they_are() {
    let smooth =
        |material: MetallicRoughness| Bsdf::MetallicRoughness(MetallicRoughness { alpha: 0.0, ..material });
    assert!(smooth(MetallicRoughness { metallic: 1.0, ..gltf() }).is_delta_only());
    assert!(smooth(MetallicRoughness { transmission: 1.0, ..gltf() }).is_delta_only());
    assert!(!smooth(gltf()).is_delta_only());
    assert!(!Bsdf::MetallicRoughness(MetallicRoughness { metallic: 1.0, ..gltf() }).is_delta_only());
    let wo = direction(0.6, 0.0);
    for (name, bsdf) in rough_bsdfs() {
        assert!(!bsdf.is_delta_only(), "{name}");
        // Along the surface nothing is scattered, and nothing is undefined.
        let along = direction(0.0, 1.0);
        assert!(bsdf.evaluate(wo, along).is_black() && bsdf.sample(along, [0.3; 3]).is_none(), "{name}");
        assert!(bsdf.evaluate(along, wo).is_finite() && bsdf.density(along, wo).is_finite(), "{name}");
    }
    let thin = MetallicRoughness { transmission: 1.0, base_color: Rgb::ONE, thin: true, ..gltf() };
    let through = smooth(thin).sample(wo, [0.3, 0.3, 0.9]).expect("a clear wall transmits");
    assert!(through.transmitted && !through.crosses_boundary && through.delta);
    assert!((through.direction + wo).length() < 4.0 * f32::EPSILON);
}
