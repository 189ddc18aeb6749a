//! Sampling where densities vanish, diverge or are measured on the wrong surface.

use alabaster::diffusion::{NormalizedDiffusion, Profile};
use alabaster::math::quadrature::GaussLegendre;
use alabaster::math::sampler::HashGenerator;
use alabaster::math::warp;
use alabaster::optics::phase::HenyeyGreenstein;
use alabaster::optics::{Boundary, Interface};
use alabaster::radiometry::Rgb;
use alabaster::scene::{Method, shape};
use alabaster::transport::RenderOptions;
use glam::Vec3;

use crate::common::backends::{Pictures, by, renderings};
use crate::common::bodies::{bodies, bubble};
use crate::common::bsdfs::{direction, rough_bsdfs};
use crate::common::probes::{caster, for_each_line};
use crate::common::scenes::{Statistics, furnace, white};
use crate::media::translucent;
use crate::record::{Figures, assert_fails, record};
use crate::table::{number, rows};

#[test]
fn radius_towards_zero() {
    let profile = NormalizedDiffusion { d: 1.0 };
    let (mut largest, mut golubev, mut sinh) = (0.0_f64, 0.0_f64, 0.0_f64);
    for row in rows("burley_sampling_vectors.csv") {
        let (xi, exact) = (number(&row[0]) as f32, number(&row[1]));
        let error = |x: f32| (f64::from(x) / exact - 1.0).abs();
        largest = largest.max(error(profile.sample_radius(xi)));
        golubev = golubev.max(error(golubev_inverse(xi)));
        sinh = sinh.max(error(sinh_inverse(xi)));
    }
    // A dozen roundings.
    let holds = |error: f64| error < 1e-6;
    assert!(holds(largest), "{largest}");
    assert_fails("Golubev's inverse", golubev, holds);
    assert_fails("the closed form by sinh", sinh, holds);

    // The innermost thousandth, by Kolmogorov's distance from its own distribution.
    const DRAWS: usize = 100_000;
    let mut random = HashGenerator::new(9);
    let mut radii: Vec<f32> = (0..DRAWS).map(|_| profile.sample_radius(1e-3 * random.next_f32())).collect();
    radii.sort_by(f32::total_cmp);
    let below = |r: f32| -(0.25 * (-f64::from(r)).exp_m1() + 0.75 * (-f64::from(r) / 3.0).exp_m1()) / 1e-3;
    let distance = |(i, r): (usize, &f32)| (below(*r) - (i as f64 + 0.5) / DRAWS as f64).abs();
    let statistic = radii.iter().enumerate().map(distance).fold(0.0, f64::max) * (DRAWS as f64).sqrt();
    assert!(statistic < 1.95, "{statistic}");
    // R/pdf at the centre: R itself is infinite there, R over its radial density 1/(2πr).
    assert_eq!(profile.sample_radius(0.0), 0.0);
    assert_fails("R/pdf at r = 0", profile.density(0.0) * 0.0, f32::is_finite);
    // Away from the diagonal, which belongs to two triangles.
    let plane = shape::quad(Vec3::new(0.3, 0.0, 0.1), Vec3::Z, Vec3::X);
    let (mut most, mut sum) = (0.0_f32, Statistics::default());
    for_each_line(&caster(&plane), &plane, Rgb::splat(1e-4), (Vec3::ZERO, Vec3::Y), 50_000, |found| {
        found.iter().for_each(|crossing| most = most.max(crossing.weight[0]));
        sum.add(found.iter().map(|crossing| f64::from(crossing.weight[0])).sum());
    });
    // Distances down to a millionth of a metre, to the rounding of the probe's parameter.
    assert!(
        most <= 1.0 + 1e-4 && (sum.mean() - 1.0).abs() < 3.0 * sum.standard_error() + 1e-4,
        "{most} {}",
        sum.mean()
    );
    record(
        "radius_towards_zero",
        format!(
            "{largest:.0e}; Golubev {golubev:.0e}, sinh {sinh:.0e}; Kolmogorov {statistic:.2}; ∫R dA − 1: {:+.0e}",
            sum.mean() - 1.0
        ),
    );
}

/// Golubev 2019.
fn golubev_inverse(xi: f32) -> f32 {
    let u = 1.0 - xi;
    let g = 1.0 + 4.0 * u * (2.0 * u + (1.0 + 4.0 * u * u).sqrt());
    3.0 * ((1.0 + g.powf(-1.0 / 3.0) + g.powf(1.0 / 3.0)) / (4.0 * u)).ln()
}

fn sinh_inverse(xi: f32) -> f32 {
    -3.0 * (2.0 * ((2.0 * (1.0 - xi)).asinh() / 3.0).sinh()).ln()
}

/// A density per radius put over a density per area of the disk, which a curved surface is not.
#[test]
fn density_on_curved_surfaces() {
    let sphere = shape::sphere(Vec3::ZERO, 1.0, 6);
    let pole = Vec3::new(0.3, 0.5, -0.7).normalize();
    let (mut farthest, mut gains) = (0.0_f64, Vec::new());
    // Scales whose profiles leave a sphere of radius 1 next to nothing up to nearly all.
    for d in [0.1, 0.3, 1.0, 2.0, 4.0] {
        let profile = NormalizedDiffusion { d };
        let exact = f64::from(profile.cumulative(2.0));
        let mut statistics = Statistics::default();
        // The longer the profile, the fewer lines that meet the sphere.
        let lines = if d < 2.0 { 800_000 } else { 6_000_000 };
        for_each_line(&caster(&sphere), &sphere, Rgb::splat(d), (pole, pole), lines, |found| {
            statistics.add(found.iter().map(|crossing| f64::from(crossing.weight[0])).sum());
        });
        let (ratio, sigma) = (statistics.mean() / exact, statistics.standard_error() / exact);
        // The icosphere's area is short of the sphere's by less than 10⁻⁴.
        let holds = |ratio: f64| (ratio - 1.0).abs() < 3.0 * sigma + 1e-4 && (ratio - 1.0).abs() < 2e-3;
        assert!(holds(ratio), "d {d}: {ratio} ± {sigma}");
        farthest = farthest.max((ratio - 1.0).abs());
        if (0.3..3.0).contains(&d) {
            // ∫ R(r) (r/r_disk) dA with r = 2 sin(θ/2), r_disk = sin θ.
            let naive = GaussLegendre::new(400).integrate(0.0, std::f64::consts::PI, |theta| {
                let (r, disk) = (2.0 * (0.5 * theta).sin(), theta.sin());
                std::f64::consts::TAU * disk * f64::from(profile.density(r as f32)) * r / disk
            });
            assert_fails("no factor r_disk/r", naive / exact, holds);
            gains.push(format!("{:+.0} %", 100.0 * (naive / exact - 1.0)));
        }
    }
    record(
        "density_on_curved_surfaces",
        format!("farthest {:.1} ‰; without the factor {}", 1e3 * farthest, gains.join(", ")),
    );
}

/// Numbers at the ends of [0, 1) and in the middle.
const ENDS: [f32; 5] = [0.0, 1.0 / 16_777_216.0, 0.5, 0.999, 1.0 - 1.0 / 16_777_216.0];

/// Every sampling routine at the corners of the unit square gives a weight that is a number, or says that there is no direction.
#[test]
fn vanishing_densities() {
    let corners = || ENDS.into_iter().flat_map(|u| ENDS.map(|v| [u, v]));
    let mut drawn = 0;
    for eta in [1.0 / 1.5, 1.0, 1.5, 2.4] {
        for alpha in [0.0, 1e-3, 0.3, 1.0] {
            let (boundary, interface) = (Boundary::new(eta, alpha), Interface::new(eta, alpha));
            for u in corners() {
                let out = boundary.sample_exit(u);
                let (lobe, density) = (boundary.exit_lobe(out.z) * out.z, boundary.exit_density(out.z));
                assert!(out.is_normalized() && lobe.is_finite() && density.is_finite() && density >= 0.0);
                // A density of nothing only where there is nothing.
                assert!(density > 0.0 || lobe == 0.0, "η {eta} α {alpha} {u:?}");
                drawn += 1;
                for cos in [1.0, 0.5, 1e-2, 1e-4, 1e-7] {
                    for side in [1.0, -1.0] {
                        let wo = direction(cos, 0.3) * side;
                        if let Some(sample) = boundary.sample_reflection(wo, u) {
                            assert!(
                                sample.weight.is_finite() && sample.weight >= 0.0 && sample.density >= 0.0
                            );
                        }
                        let mut numbers = u.into_iter().cycle();
                        if let Some(sample) = interface.sample::<3>(wo, || numbers.next().unwrap_or(0.5)) {
                            assert!(sample.weight.is_finite() && sample.direction.is_normalized());
                            assert!(
                                sample.delta || sample.density > 0.0,
                                "η {eta} α {alpha} cos {cos} {u:?}"
                            );
                        }
                        drawn += 2;
                    }
                }
            }
        }
    }
    for (name, bsdf) in rough_bsdfs() {
        for [u, v] in corners() {
            for (w, cos) in ENDS.into_iter().flat_map(|w| [1.0, 1e-3, 1e-7, -1e-7, -1.0].map(|cos| (w, cos)))
            {
                drawn += 1;
                let Some(sample) = bsdf.sample(direction(f32::abs(cos), 0.3) * f32::signum(cos), [u, v, w])
                else {
                    continue;
                };
                assert!(
                    sample.weight.is_finite() && sample.density.is_finite(),
                    "{name} cos {cos}: {sample:?}"
                );
                assert!(sample.density > 0.0 || sample.weight.is_black(), "{name} cos {cos}: {sample:?}");
            }
        }
    }
    for [u, v] in corners() {
        for g in [-0.999_999, 0.0, 0.5, 0.999_999] {
            let deflection = HenyeyGreenstein { g }.sample(f64::from(u));
            assert!(deflection.cos.abs() <= 1.0 && deflection.sin >= 0.0, "{deflection:?}");
        }
        assert!(NormalizedDiffusion { d: 1e-30 }.sample_radius(u).is_finite());
        assert!(warp::square_to_cosine_hemisphere(u, v).is_finite());
        drawn += 6;
    }
    // Lambert's f cosθ/pdf at the rim of the disk.
    let cos = warp::square_to_cosine_hemisphere(0.0, 0.5).z;
    let density = warp::cosine_hemisphere_density(cos);
    assert_fails("f cosθ over the density", cos / std::f32::consts::PI / density, f32::is_finite);

    // And in pictures: nothing is rejected for its density.
    let (mut samples, mut rejected) = (0.0, 0);
    for body in bodies().into_iter().filter(|body| body.sigma_t == 10.0).chain([bubble()]) {
        for (method, roughness) in [(Method::Bssrdf, 0.0), (Method::Bssrdf, 1.0), (Method::Walk, 0.02)] {
            if method == Method::Walk && body.name == "plane" {
                continue;
            }
            let scene =
                furnace(body.mesh.clone(), white(1.33, roughness, Rgb::new(1.0, 0.8, 1.6) * body.sigma_t));
            for (_, found) in renderings(&scene, by(method), &Pictures(16)) {
                samples += found.mean.count();
                rejected += found.counters.rejected;
            }
        }
    }
    assert_eq!(rejected, 0, "of {samples} samples");
    record(
        "vanishing_densities",
        format!("{drawn} draws at corners are numbers; {rejected} of {samples:.0} samples rejected"),
    );
}

/// Roulette plays with what a path is expected to bring: in a body that absorbs nothing it never plays, however long the walk.
#[test]
fn roulette_in_bright_media() {
    let mut figure = Figures::default();
    for absorbed in [0.0, 1e-3] {
        let sigma_t = Rgb::splat(20.0);
        let material = translucent(1.5, sigma_t * absorbed, sigma_t * (1.0 - absorbed), 0.0);
        let scene = furnace(shape::sphere(Vec3::ZERO, 1.0, 4), material);
        let options = RenderOptions { spheres: false, guiding: false, ..by(Method::Walk) };
        for (setup, found) in renderings(&scene, options, &Pictures(8)) {
            // Rounding of some thousand factors.
            let holds = |brightest: f64| brightest <= 1.0 + 1e-4;
            assert!(holds(found.mean.max), "{setup}: {}", found.mean.max);
            assert_eq!(found.counters.capped_paths, 0);
            // Survival capped at 0.95 at a throughput of 1, from the fifth collision.
            let naive = 0.95_f64.powf(4.0 - found.collisions.max);
            assert_fails("survival capped at 0.95", naive, holds);
            if absorbed == 0.0 {
                let (mean, sigma) = (found.mean.mean(), found.mean.standard_error());
                assert!((mean - 1.0).abs() < 3.0 * sigma + 1e-5, "{setup}: {mean} ± {sigma}");
                figure.keep(setup, format!(
                    "brightest sample 1 {:+.0e}, up to {:.0} collisions; with the cap .95^−n = {naive:.0e}",
                    found.mean.max - 1.0,
                    found.collisions.max
                ));
            }
        }
    }
    record("roulette_in_bright_media", figure.written());
}
