//! Probe rays: their weights add up to the area integral of the profile, on every geometry, and the
//! integrator draws entry points from it.

mod common;

use alabaster::diffusion::{NormalizedDiffusion, Profile};
use alabaster::math::SampleStream;
use alabaster::radiometry::Rgb;
use alabaster::raycast::Hit;
use alabaster::scene::{Mesh, shape};
use alabaster::transport::ProbeCounters;
use alabaster::transport::area_integral::AreaIntegral;
use alabaster::transport::spread::{Channels, Spread};
use common::probes::{caster, for_each_line, normal_of};
use common::scenes::{Statistics, join};
use glam::Vec3;

/// Mean over `draws` lines of Σ w_c f(hit), per channel.
fn integrate(
    mesh: &Mesh,
    d: Rgb,
    position: Vec3,
    normal: Vec3,
    draws: u32,
    f: impl Fn(&Hit) -> f32,
) -> [Statistics; 3] {
    let mut statistics: [Statistics; 3] = Default::default();
    for_each_line(&caster(mesh), mesh, d, (position, normal), draws, |found| {
        for (c, statistic) in statistics.iter_mut().enumerate() {
            statistic.add(found.iter().map(|x| f64::from(x.weight[c] * f(&x.hit))).sum());
        }
    });
    statistics
}

/// ∫ R over an infinite plane at distance `height` from the point: ∫_h^∞ R(r) 2πr dr.
fn energy_on_plane(d: f32, height: f32) -> f64 {
    f64::from(1.0 - NormalizedDiffusion { d }.cumulative(height))
}

#[test]
fn a_comb_of_64_sheets_is_found_whole() {
    let sheets = 64;
    let spacing = 0.05;
    let comb =
        join((0..sheets).map(|i| {
            shape::quad(Vec3::new(0.0, -spacing * i as f32, 0.0), Vec3::Z * 200.0, Vec3::X * 200.0)
        }));
    let d = Rgb::new(0.4, 1.0, 2.0);
    let [r, g, b] = integrate(&comb, d, Vec3::ZERO, Vec3::Y, 200_000, |_| 1.0);
    for (c, statistic) in [r, g, b].into_iter().enumerate() {
        let exact: f64 = (0..sheets).map(|i| energy_on_plane(d[c], spacing * i as f32)).sum();
        let (mean, sigma) = (statistic.mean(), statistic.standard_error());
        println!("channel {c}: {mean:.4} ± {sigma:.4}, exact {exact:.4}");
        assert!((mean - exact).abs() < 3.0 * sigma, "channel {c}: {mean} ± {sigma} against {exact}");
        assert!(sigma < 0.01 * exact);
    }
}

#[test]
fn each_sheet_of_the_comb_gets_its_own_share() {
    let spacing = 0.7;
    let comb =
        join((0..8).map(|i| {
            shape::quad(Vec3::new(0.0, -spacing * i as f32, 0.0), Vec3::Z * 200.0, Vec3::X * 200.0)
        }));
    for sheet in 0..8 {
        let only = |hit: &Hit| if hit.primitive / 2 == sheet { 1.0 } else { 0.0 };
        let [_, statistic, _] = integrate(&comb, Rgb::new(0.4, 1.0, 2.0), Vec3::ZERO, Vec3::Y, 100_000, only);
        let exact = energy_on_plane(1.0, spacing * sheet as f32);
        let (mean, sigma) = (statistic.mean(), statistic.standard_error());
        assert!((mean - exact).abs() < 3.0 * sigma, "sheet {sheet}: {mean} ± {sigma} against {exact}");
    }
}

/// On a sphere of radius 1 the area at chord r is that of the plane, 2πr dr, up to the chord 2.
#[test]
fn on_a_sphere_the_energy_is_that_within_its_diameter() {
    let sphere = shape::sphere(Vec3::ZERO, 1.0, 6);
    let pole = Vec3::new(0.3, 0.5, -0.7).normalize();
    for d in [0.02, 0.1, 0.3, 1.0, 3.0, 12.0] {
        let [_, statistic, _] = integrate(&sphere, Rgb::splat(d), pole, pole, 400_000, |_| 1.0);
        let exact = f64::from(NormalizedDiffusion { d }.cumulative(2.0));
        let (mean, sigma) = (statistic.mean(), statistic.standard_error());
        println!("d {d}: {:.5} ± {:.5} of exact", mean / exact, sigma / exact);
        // The icosphere's area is short of the sphere's by less than 1e-4.
        assert!((mean - exact).abs() < 3.0 * sigma + 1e-4 * exact, "d {d}: {mean} ± {sigma} against {exact}");
    }
}

/// The entry points that the integrator draws have the density R_c, on a plane: the weighted
/// distribution of their distances is the profile's in every channel.
#[test]
fn entry_points_on_a_plane_follow_the_profile() {
    let plane = shape::quad(Vec3::ZERO, Vec3::Z * 500.0, Vec3::X * 500.0);
    let caster = caster(&plane);
    let d = Rgb::new(0.5, 1.0, 3.0);
    let spread = Spread::new(d.0.map(|d| NormalizedDiffusion { d }), 1e3);
    let integral = AreaIntegral {
        caster: &caster,
        geometric_normal: |hit: &Hit| normal_of(&plane, hit),
        instance: 0,
        spread: &spread,
        channels: Channels::of(Rgb::ONE),
        position: Vec3::ZERO,
        position_error: 1e-6,
        normal: Vec3::Y,
    };
    let mut counters = ProbeCounters::default();
    for limit in [0.1_f32, 0.7, 2.0, 9.0, f32::INFINITY] {
        let mut statistics: [Statistics; 3] = Default::default();
        for sample in 0..100_000 {
            // A new pixel each time: independent numbers, so that the standard error holds.
            let stream = SampleStream::new(3, sample, 0);
            let entry = integral.sample(&stream, 3, &mut counters);
            let position = entry.hit.map_or(Vec3::ZERO, |hit| {
                let [a, b, c] = plane.triangles[hit.primitive as usize].map(|i| plane.positions[i as usize]);
                a + (b - a) * hit.u + (c - a) * hit.v
            });
            for (c, statistic) in statistics.iter_mut().enumerate() {
                statistic.add(if position.length() <= limit { f64::from(entry.weight[c]) } else { 0.0 });
                assert!(entry.weight[c] <= 3.001);
            }
        }
        for (c, statistic) in statistics.iter().enumerate() {
            let exact = if limit.is_finite() {
                f64::from(NormalizedDiffusion { d: d[c] }.cumulative(limit))
            } else {
                1.0
            };
            let (mean, sigma) = (statistic.mean(), statistic.standard_error());
            assert!(
                (mean - exact).abs() < 3.0 * sigma,
                "within {limit}, channel {c}: {mean} ± {sigma}, {exact}"
            );
        }
    }
    assert_eq!(counters.overflowed, 0);
}
