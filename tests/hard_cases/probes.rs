//! Probe rays: edge-on sheets, many sheets, split sheets, and bodies much larger or smaller than a free path.

use alabaster::diffusion::{NormalizedDiffusion, Profile};
use alabaster::radiometry::Rgb;
use alabaster::scene::{Mesh, Method, Scene, shape};
use alabaster::transport::area_integral::Crossing;
use glam::Vec3;

use crate::common::backends::{Films, Pictures, Setup, by, relative_difference, renderings};
use crate::common::probes::{caster, for_each_line, lines_on_backends, normal_of};
use crate::common::scenes::{Statistics, furnace, join, white};
use crate::lights::under_uneven_sky;
use crate::media::translucent;
use crate::record::{Figures, Largest, assert_fails, record};

/// Around the edge of a thin box, where half of the sheets are met edge-on.
#[test]
fn tangent_probes() {
    let boxes = [Vec3::new(1.0, 1.0, 0.02), Vec3::ONE].map(|size| shape::cuboid(Vec3::ZERO, size));
    let sphere = shape::sphere(Vec3::ZERO, 1.0, 5);
    let (mut most, mut one_axis) = (0.0_f32, 0.0_f32);
    let places = [
        (&boxes[0], Vec3::new(0.499, 0.1, 0.01), Vec3::Z),
        (&boxes[1], Vec3::new(0.5, 0.499, 0.1), Vec3::X),
        (&sphere, Vec3::X, Vec3::X),
    ];
    for (mesh, position, normal) in places {
        for d in [0.01, 0.3, 3.0] {
            for_each_line(&caster(mesh), mesh, Rgb::splat(d), (position, normal), 20_000, |found| {
                for crossing in found {
                    most = most.max(crossing.weight[0]);
                    // By the probe along the normal alone the same point weighs R/(R |n·N|), if it is as far.
                    let naive = 1.0 / normal_of(mesh, &crossing.hit).dot(normal).abs().max(1e-12);
                    one_axis = one_axis.max(naive);
                }
            });
        }
    }
    // γ ≤ 1, R(r) ≤ R(r_a), both to rounding.
    let holds = |weight: f32| weight <= 1.0 + 1e-5;
    assert!(holds(most), "{most}");
    assert_fails("one axis alone", one_axis, holds);
    record(
        "tangent_probes",
        format!("largest weight of a crossing {most:.4}; along the normal alone {one_axis:.0e}"),
    );
}

#[test]
fn more_hits_than_a_buffer() {
    let (sheets, spacing, d) = (64, 0.05, 1.0);
    let sheet = |i: i32| shape::quad(Vec3::NEG_Y * (spacing * i as f32), Vec3::Z * 200.0, Vec3::X * 200.0);
    let comb = join((0..sheets).map(sheet));
    // ∫ over a plane at distance h: what lies beyond the radius h.
    let on_sheet = |i: i32| f64::from(1.0 - NormalizedDiffusion { d }.cumulative(spacing * i as f32));
    let exact: f64 = (0..sheets).map(on_sheet).sum();
    let weight = |crossing: &Crossing| f64::from(crossing.weight[0]);
    let place = (Vec3::ZERO, Vec3::Y);
    let gather = |(all, four): &mut (Statistics, Statistics), found: &[Crossing]| {
        all.add(found.iter().map(weight).sum());
        // What a buffer of four keeps.
        four.add(found.iter().take(4).map(weight).sum());
    };
    let mut figure = String::new();
    for (backend, (all, four)) in lines_on_backends(&comb, Rgb::splat(d), place, 100_000, gather) {
        let (mean, sigma) = (all.mean(), all.standard_error());
        let holds = |mean: f64| (mean - exact).abs() < 3.0 * sigma && sigma < 0.01 * exact;
        assert!(holds(mean), "{backend}: {mean} ± {sigma}, {exact}");
        assert_fails("four hits kept", four.mean(), holds);
        figure = format!("{mean:.3} ± {sigma:.3} of {exact:.3}; of four hits {:.3}", four.mean());
    }
    record("more_hits_than_a_buffer", figure);
}

/// A plane of triangles long and thin, which builders split.
#[test]
fn primitives_met_twice() {
    let mut strips = Mesh::default();
    let count = 200;
    for i in 0..count {
        let (low, high) = (i as f32 / count as f32 - 0.5, (i + 1) as f32 / count as f32 - 0.5);
        let first = strips.positions.len() as u32;
        // Slanted, so that their boxes overlap.
        let corner = |z: f32, x: f32| Vec3::new(20.0 * (x + 0.3 * z), 0.0, 20.0 * (z + 0.6 * x));
        strips.positions.extend([corner(low, -0.5), corner(high, -0.5), corner(high, 0.5), corner(low, 0.5)]);
        strips.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    let gather = |(sum, twice): &mut (Statistics, usize), found: &[Crossing]| {
        let mut hits: Vec<_> = found.iter().map(|x| (x.hit.primitive, x.hit.t.to_bits())).collect();
        hits.sort_unstable();
        *twice += hits.windows(2).filter(|pair| pair[0] == pair[1]).count();
        sum.add(found.iter().map(|x| f64::from(x.weight[0])).sum());
    };
    let mut figure = String::new();
    for (backend, (sum, twice)) in
        lines_on_backends(&strips, Rgb::splat(0.3), (Vec3::ZERO, Vec3::Y), 100_000, gather)
    {
        let (mean, sigma) = (sum.mean(), sum.standard_error());
        // Beyond the edge of the plane, 7 away, is e^−8.
        assert!((mean - 1.0).abs() < 3.0 * sigma + 4e-4, "{backend}: {mean} ± {sigma}");
        assert_eq!(twice, 0, "{backend}");
        figure = format!("none of 10⁵ lines met one twice; ∫R dA = {mean:.5} ± {sigma:.5}");
    }
    record("primitives_met_twice", figure);
}

/// A free path of 10⁻⁴ to 10⁴ bodies: even light stays even, and a walk in next to nothing is a clear body.
#[test]
fn free_path_longer_than_the_body() {
    let mesh = || shape::sphere(Vec3::ZERO, 1.0, 5);
    let (mut farthest, mut worst_planar) = (Largest::default(), 0.0_f64);
    for exponent in -4..=4 {
        let free_path = 10.0_f32.powi(exponent);
        let scene = furnace(mesh(), white(1.4, 0.0, Rgb::new(1.0, 0.8, 1.6) / free_path));
        for (setup, found) in renderings(&scene, by(Method::Bssrdf), &Pictures(8)) {
            let (mean, sigma) = (found.mean.mean(), found.mean.standard_error());
            let holds = |mean: f64| (mean - 1.0).abs() < 3.0 * sigma + 1e-5;
            assert!(holds(mean), "{free_path} {setup}: {mean} ± {sigma}");
            assert_eq!(found.counters.rejected, 0);
            farthest.add(setup, (mean - 1.0).abs());
            if exponent > 0 {
                // What the planar profile leaves on the sphere.
                let planar = f64::from(NormalizedDiffusion::from_albedo(1.0, free_path).cumulative(2.0));
                assert_fails("the planar profile", planar, holds);
                worst_planar = worst_planar.max(1.0 - planar);
            }
        }
    }
    // Snell alone.
    let clear = under_uneven_sky(furnace(mesh(), translucent(1.5, Rgb::splat(0.2), Rgb::ZERO, 0.0)));
    let thin = under_uneven_sky(furnace(mesh(), translucent(1.5, Rgb::splat(0.2), Rgb::splat(1e-5), 0.0)));
    let [clear, thin] = [clear, thin].map(|scene| renderings(&scene, by(Method::Walk), &Pictures(2048)));
    let mut change = Figures::default();
    for ((setup, clear), (_, thin)) in clear.iter().zip(&thin) {
        let sigma = clear.mean.standard_error().hypot(thin.mean.standard_error());
        let (relative, sigma) = (thin.mean.mean() / clear.mean.mean() - 1.0, sigma / clear.mean.mean());
        assert!(relative.abs() < 1e-3 + 3.0 * sigma, "{setup}: {relative} ± {sigma}");
        change.keep(*setup, format!("{:+.1} ± {:.1} ‰", 1e3 * relative, 1e3 * sigma));
    }
    record(
        "free_path_longer_than_the_body",
        format!(
            "furnace from 10⁻⁴ to 10⁴: {}; planar profile loses up to {:.0} %; walk against Snell: {}",
            farthest.written(),
            100.0 * worst_planar,
            change.written()
        ),
    );
}

/// The limit is that of light that leaves where it entered.
#[test]
fn free_path_shorter_than_an_ulp() {
    let material = |free_path: f32| {
        let sigma_t = Rgb::splat(1.0 / free_path);
        translucent(1.4, sigma_t * 1e-3, sigma_t * 0.999, 0.0)
    };
    let scene = |free_path| under_uneven_sky(furnace(shape::sphere(Vec3::ZERO, 1.0, 5), material(free_path)));
    let limit = renderings(&scene(1e-6), by(Method::Diffuse), &Films(64));
    let (mut largest, mut darkest) = (0.0_f64, f32::INFINITY);
    for free_path in [1e-5, 1e-7, 1e-9, 1e-12, 1e-20] {
        for (found, limit) in renderings(&scene(free_path), by(Method::Bssrdf), &Films(64)).iter().zip(&limit)
        {
            let ((setup, (film, counters)), (_, (limit, _))) = (found, limit);
            let mean = |film: &alabaster::film::Film| {
                film.rows().map(|p| f64::from(p.mean().mean())).sum::<f64>() / 576.0
            };
            let error = (mean(film) / mean(limit) - 1.0).abs();
            assert!(error < 1e-3, "{free_path} {setup}: {error}");
            let (difference, noise) = relative_difference(film, limit);
            assert!(difference < 2.0 * noise, "{free_path} {setup}: {difference} {noise}");
            assert_eq!((counters.rejected, film.tally().nonfinite), (0, 0));
            largest = largest.max(error);
            darkest = film.rows().map(|pixel| pixel.mean().luminance()).fold(darkest, f32::min);
        }
    }
    assert!(darkest > 0.05, "{darkest}");
    // The point found by a distance that rounding swallows is the point itself.
    assert_fails("x + r in single precision", 1.0_f32 + 1e-9, |x: f32| x > 1.0);
    record(
        "free_path_shorter_than_an_ulp",
        format!("against the limit {largest:.0e}; darkest pixel {darkest:.2}"),
    );
}

/// The same picture but for noise when one length changes by a factor of 1.8, over 12 decades.
#[test]
fn no_absolute_lengths() {
    const STEPS: i32 = 48;
    let scene = |free_path: f32| -> Scene {
        let sigma_t = Rgb::splat(1.0 / free_path);
        under_uneven_sky(furnace(
            shape::sphere(Vec3::ZERO, 1.0, 4),
            translucent(1.0, sigma_t * 0.02, sigma_t * 0.98, 0.0),
        ))
    };
    let mut figures = Vec::new();
    let means: Vec<Vec<(Setup, f64, f64)>> = (0..=STEPS)
        .map(|step| {
            let free_path = 10.0_f32.powf(-9.0 + 12.0 * step as f32 / STEPS as f32);
            let found = renderings(&scene(free_path), by(Method::Bssrdf), &Pictures(8));
            found
                .into_iter()
                .map(|(setup, found)| (setup, found.mean.mean(), found.mean.standard_error()))
                .collect()
        })
        .collect();
    for setup in 0..means[0].len() {
        let values: Vec<_> = means.iter().map(|found| found[setup]).collect();
        let (low, high) = values.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), v| (a.min(v.1), b.max(v.1)));
        // Of a profile no more than 0.4 of its energy moves per e-fold of its length: x p(x) ≤ 0.4.
        let most = 0.4 * 12.0 / f64::from(STEPS) * std::f64::consts::LN_10 * (high - low);
        let holds = |pair: (f64, f64), sigma: f64| (pair.1 - pair.0).abs() < most + 3.0 * sigma;
        let mut largest = 0.0_f64;
        for pair in values.windows(2) {
            let sigma = pair[0].2.hypot(pair[1].2);
            assert!(holds((pair[0].1, pair[1].1), sigma), "{:?}", pair);
            largest = largest.max((pair[1].1 / pair[0].1 - 1.0).abs());
        }
        // Lambert by 5 % below a radius of 10⁻⁸.
        let (below, above) = (0.05 * values[3].1, values[4].1);
        assert!(!holds((below, above), values[3].2), "the counter-example no longer is one");
        if let Some(mode) = values[0].0.recorded() {
            let all = 100.0 * (high / low - 1.0);
            figures.push(format!("{mode}: largest step {:.2} %, all in all {all:.1} %", 100.0 * largest));
        }
    }
    record("no_absolute_lengths", figures.join("; "));
}
