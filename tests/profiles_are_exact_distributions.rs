//! Every profile that the renderer can take is a probability distribution in single precision too: sampling inverts the
//! cumulative distribution, whose derivative is the density, which falls.

use alabaster::diffusion::{
    BetterDipole, DiffusionModel, Dipole, HalfSpace, NormalizedDiffusion, PhotonBeam, Profile, ShapeTable,
    UniformlyLitDirectionalDipole, integrate, tabulated,
};
use alabaster::math::quadrature::GaussLegendre;
use alabaster::math::sampler::HashGenerator;
use alabaster::medium::Entry;

const BOUNDARIES: [(f64, f64); 3] = [(1.0, 0.0), (1.5, 0.6), (0.75, 0.0)];
/// 1 − α', on rows of the tables, between them, and at both ends.
const ABSORBED: [f32; 7] = [0.0, 1e-6, 1e-3, 0.04, 0.37, 0.9, 1.0];
/// m.
const MEAN_FREE_PATH: f32 = 0.003;

fn tables_of_models(eta: f64, g: f64) -> [(&'static str, ShapeTable); 4] {
    [
        ("dipole", ShapeTable::of_model(eta, g, Dipole::new).unwrap()),
        ("better dipole", ShapeTable::of_model(eta, g, BetterDipole::new).unwrap()),
        ("directional dipole", ShapeTable::of_model(eta, g, UniformlyLitDirectionalDipole::new).unwrap()),
        ("photon beam", ShapeTable::of_model(eta, g, PhotonBeam::new).unwrap()),
    ]
}

/// Calls `check` with each profile in every medium, its name, and its scale in m.
fn for_each_profile(check: impl Fn(&str, &dyn Profile, f32)) {
    for d in [1e-6, 0.7] {
        check("normalized diffusion", &NormalizedDiffusion { d }, d);
    }
    for (eta, g) in BOUNDARIES {
        for (name, table) in tables_of_models(eta, g) {
            for_each_albedo(name, &table, (eta, g), &check);
        }
        for_each_albedo("tabulated", &tabulated::shape_table(Entry::Diffuse, eta, g), (eta, g), &check);
    }
}

fn for_each_albedo(
    name: &str,
    table: &ShapeTable,
    (eta, g): (f64, f64),
    check: impl Fn(&str, &dyn Profile, f32),
) {
    for absorbed in ABSORBED {
        let context = format!("{name}, η {eta}, g {g}, 1 − α' {absorbed:e}");
        check(&context, &table.shape(absorbed, MEAN_FREE_PATH), MEAN_FREE_PATH);
    }
}

#[test]
fn sampling_inverts_the_cumulative_distribution() {
    for_each_profile(|name, profile, _| {
        for i in 0..2000 {
            let small = 10.0_f32.powf(-7.0 * (i as f32 + 0.5) / 2000.0);
            for xi in [small, 1.0 - small.max(1e-6)] {
                let radius = profile.sample_radius(xi);
                let back = profile.cumulative(radius);
                // ln r is known to 2.2e-6: two positions among up to 64 knots, to half an ulp each of 2⁻¹⁸ of a knot's 0.38, two
                // logarithms and an exponential of up to 7. So is F, times its slope, and the logit to 2e-6, a few
                // roundings of up to 16.
                let slope = profile.density(radius) * std::f32::consts::TAU * radius * radius;
                let tolerance = 2.2e-6 * slope + 2e-6 * xi * (1.0 - xi) + 2.0 * f32::EPSILON * xi;
                assert!((back - xi).abs() <= tolerance, "{name}: ξ {xi:e} gives {radius:e}, back {back:e}");
            }
        }
        assert!(profile.sample_radius(0.0) >= 0.0);
        assert!(profile.sample_radius(1.0 - f32::EPSILON / 2.0).is_finite());
    });
}

#[test]
fn density_is_the_derivative_of_the_cumulative_distribution() {
    let rule = GaussLegendre::new(8);
    for_each_profile(|name, profile, scale| {
        // Intervals of a twelfth of a decade, so that knots are at their ends.
        for i in -48..36 {
            let [from, to] = [i, i + 1].map(|i| f64::from(scale) * 10.0_f64.powf(f64::from(i) / 12.0));
            let expected =
                f64::from(profile.cumulative(to as f32)) - f64::from(profile.cumulative(from as f32));
            let integral = rule.integrate(from.ln(), to.ln(), |log_radius| {
                let radius = log_radius.exp();
                f64::from(profile.density(radius as f32)) * std::f64::consts::TAU * radius * radius
            });
            // F is rounded to half an ulp of at most 1 after some roundings of its own. In the density, some roundings of a logit of up to
            // 90, magnified by it.
            let tolerance =
                4.0 * f64::from(f32::EPSILON) * f64::from(profile.cumulative(to as f32)) + 2e-5 * integral;
            assert!(
                (integral - expected).abs() < tolerance,
                "{name} at {from:e}: {integral:e}, {expected:e}"
            );
        }
    });
}

#[test]
fn sampled_radii_pass_kolmogorov_smirnov() {
    let n = 20_000;
    for_each_profile(|name, profile, _| {
        let mut generator = HashGenerator::new(7);
        let mut shares: Vec<f32> =
            (0..n).map(|_| profile.cumulative(profile.sample_radius(generator.next_f32()))).collect();
        shares.sort_by(f32::total_cmp);
        let ranks = shares.iter().enumerate();
        let distance =
            ranks.map(|(i, share)| (share - (i as f32 + 0.5) / n as f32).abs()).fold(0.0, f32::max);
        // Kolmogorov's distribution: 2.3/√n is exceeded by chance five times in 10⁵, in a hundred sets five in 10³.
        assert!(distance < 2.3 / (n as f32).sqrt(), "{name}: {distance}");
    });
}

#[test]
fn profiles_fall() {
    for_each_profile(|name, profile, scale| {
        let mut last = f32::INFINITY;
        for i in -4000..2500 {
            let density = profile.density(scale * 10.0_f32.powf(i as f32 / 1000.0));
            // Some roundings, of a logit of up to 90 too; below the smallest normal number all digits go.
            assert!(
                density <= last * 1.00002 + f32::MIN_POSITIVE,
                "{name} at 10^{}: {density:e} after {last:e}",
                i as f32 / 1000.0
            );
            last = density;
        }
    });
}

#[test]
fn density_beyond_the_bound_stays_below_the_ratio() {
    for_each_profile(|name, profile, scale| {
        for i in -20..18 {
            let radius = scale * 10.0_f32.powf(i as f32 / 5.0 + 0.03);
            let start = profile.density(radius);
            if start < 1e-25 {
                // No light goes there, and 10⁻⁷ of it would be below the normal numbers.
                continue;
            }
            for ratio in [1.0, 0.9, 0.05, 1e-3, 1e-7] {
                let bound = profile.radius_of_ratio(radius, ratio);
                assert!(bound >= radius * 0.99999, "{name}: {bound:e} from {radius:e}");
                for step in 0..60 {
                    let beyond = bound * 10.0_f32.powf(step as f32 / 20.0);
                    let density = profile.density(beyond);
                    assert!(
                        density <= ratio * start * 1.0001,
                        "{name}: {ratio} from {radius:e} by {bound:e}, at {beyond:e} {}",
                        density / start
                    );
                }
            }
        }
    });
}

/// Where the profile is tabulated the bound is the next knot at most.
#[test]
fn the_bound_is_tight() {
    let table = ShapeTable::of_model(1.5, 0.0, PhotonBeam::new).unwrap();
    for absorbed in ABSORBED {
        let shape = table.shape(absorbed, 1.0);
        for i in -19..12 {
            let radius = 10.0_f32.powf(i as f32 / 7.0);
            for ratio in [0.9, 0.05, 1e-3, 1e-7] {
                let bound = shape.radius_of_ratio(radius, ratio);
                if bound < 999.0 && shape.density(radius) > 0.0 {
                    let nearer = (bound / 1.4679).max(radius);
                    let density = shape.density(nearer);
                    assert!(
                        density >= ratio * shape.density(radius) * 0.9999,
                        "{absorbed} {radius} {ratio}: {bound}"
                    );
                }
            }
        }
    }
}

/// Largest Σ|table − model|/Σ model over rings of a twelfth of a decade, both of unit energy.
fn largest_l1_error<M: DiffusionModel>(eta: f64, g: f64, model: impl Fn(&HalfSpace) -> M + Sync) -> f64 {
    let table = ShapeTable::of_model(eta, g, &model).unwrap();
    let l1_error = |absorbed: f64| {
        let half_space = HalfSpace::new(absorbed, (1.0 - absorbed) / (1.0 - g), g, eta).unwrap();
        let (model, shape) = (model(&half_space), table.shape(absorbed as f32, 1.0));
        let total = model.albedo();
        let ring = |i: i32| {
            let [from, to] = [i, i + 1].map(|i| 10.0_f64.powf(f64::from(i) / 12.0));
            let truth = integrate::energy_between(&model, from, to) / total;
            let tabulated = f64::from(shape.cumulative(to as f32)) - f64::from(shape.cumulative(from as f32));
            (tabulated - truth).abs()
        };
        (-36..36).map(ring).sum::<f64>()
    };
    // Half way between rows of √(1 − α') = i/40, where the blend is worst, and on one.
    [0.5, 1.5, 2.5, 5.5, 10.0, 20.5, 33.5, 38.5, 39.5]
        .map(|i: f64| l1_error((i / 40.0).powi(2)))
        .into_iter()
        .fold(0.0, f64::max)
}

#[test]
fn tables_follow_the_models() {
    for (eta, g, bound) in [(1.0, 0.0, 1e-3), (1.5, 0.0, 4e-3), (1.33, 0.8, 1.5e-2), (2.4, -0.5, 1e-2)] {
        for (name, error) in [
            ("dipole", largest_l1_error(eta, g, Dipole::new)),
            ("better dipole", largest_l1_error(eta, g, BetterDipole::new)),
            ("directional dipole", largest_l1_error(eta, g, UniformlyLitDirectionalDipole::new)),
            ("photon beam", largest_l1_error(eta, g, PhotonBeam::new)),
        ] {
            println!("{name}, η {eta}, g {g}: {error:.1e}");
            // Measured, where the rows are farthest from a straight line between them; the models themselves are
            // several percent off the truth.
            assert!(error < bound, "{name}, η {eta}, g {g}: {error}");
        }
    }
}
