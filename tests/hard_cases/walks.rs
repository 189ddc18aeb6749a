//! Walks and paths that go on for long.

use alabaster::math::sampler::HashGenerator;
use alabaster::math::{Frame, warp};
use alabaster::optics::Boundary;
use alabaster::radiometry::Rgb;
use alabaster::scene::{Method, ProfileChoice, Scene, shape};
use alabaster::transport::RenderOptions;
use glam::Vec3;

use crate::common::backends::{Levels, Rays, by, renderings};
use crate::common::bodies::{Body, bodies, bubble};
use crate::common::probes::{caster, for_each_line};
use crate::common::scenes::{Statistics, furnace, options, white};
use crate::common::walks::faceted;
use crate::media::translucent;
use crate::record::{Figures, assert_fails, record};
use crate::table::{number, rows};

/// Uniform light on the unit sphere.
fn even_rays(sample: u64) -> (Vec3, Vec3) {
    let mut random = HashGenerator::new(sample);
    let [u, v] = [(); 2].map(|()| random.next_f32());
    let outward = warp::square_to_cone(u, v, 2.0);
    let inward = warp::square_to_cosine_hemisphere(random.next_f32(), random.next_f32());
    let direction = Frame::from_normal(-outward).to_world(inward);
    (outward * 1.0001 - direction * 0.01, direction)
}

/// Total reflection keeps light in a body that absorbs nothing: its mean path is n²·4V/S all the same.
#[test]
fn total_reflection_without_absorption() {
    const PATHS: u64 = 100_000;
    let sphere = faceted(shape::sphere(Vec3::ZERO, 1.0, 5));
    let volume: f64 = sphere
        .triangles
        .iter()
        .map(|t| t.map(|v| sphere.positions[v as usize].as_dvec3()))
        .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
        .sum();
    // Rays are sent from a sphere just outside: its area is that by which photons are counted.
    let area = 4.0 * std::f64::consts::PI * 1.0001_f64.powi(2);
    let mut figures = Vec::new();
    for row in rows("path_length_invariance.csv") {
        let [eta, sigma_s, g, expected] = [0, 1, 2, 3].map(|column| number(&row[column]));
        let exact = eta * eta * 4.0 * volume / area;
        // The table is that of the sphere, which the mesh fills to a thousandth.
        assert!((exact / expected - 1.0).abs() < 2e-3, "{exact} {expected}");
        let material = translucent(eta as f32, Rgb::ZERO, Rgb::splat(sigma_s as f32), g as f32);
        let options = RenderOptions { spheres: false, guiding: false, ..by(Method::Walk) };
        for (setup, found) in renderings(&furnace(sphere.clone(), material), options, &Rays(PATHS, even_rays))
        {
            let (mean, sigma) =
                (found.collisions.mean() / sigma_s, found.collisions.standard_error() / sigma_s);
            assert!(
                (mean - exact).abs() < 3.0 * sigma,
                "η {eta} σ_s {sigma_s} {setup}: {mean} ± {sigma}, {exact}"
            );
            assert_eq!(found.counters.capped_paths, 0);
            let radiance = found.mean.mean();
            let holds = |radiance: f64| (radiance - 1.0).abs() < 3.0 * found.mean.standard_error() + 1e-3;
            assert!(holds(radiance), "{radiance}");
            if sigma_s == 50.0 {
                // The same number of collisions, exponentially distributed at best, cut at 256: what is still under way is lost.
                let kept = 1.0 - (-256.0 / found.collisions.mean()).exp();
                assert_fails("a limit of 256 collisions", kept, holds);
            }
            if let Some(mode) = setup.recorded() {
                let off = (mean - exact) / sigma;
                figures.push(format!("{mode} η {eta} σ_s {sigma_s} g {g}: {off:+.1} σ"));
            }
        }
    }
    record("total_reflection_without_absorption", figures.join(", "));
}

/// The most that the weight of light can grow where it enters: S_w cosθ over the density of its table.
fn largest_entry_weight(boundary: &Boundary) -> f64 {
    let weight = |i: u32| {
        let mu = ((i as f32 + 0.5) / 1e4).sqrt();
        f64::from(boundary.exit_lobe(mu) * mu / boundary.exit_density(mu))
    };
    (0..10_000).map(weight).fold(1.0, f64::max)
}

/// The table of white furnaces at a depth of 100: mean at most 1, no bright pixel.
fn check_furnaces(bodies: &[Body], profiles: &[(&str, RenderOptions)], samples: u64) -> String {
    let (mut largest, mut brightest, mut lowest) = (0.0_f64, 0.0_f64, 1.0_f64);
    for body in bodies {
        for (name, options) in profiles {
            let material = white(1.33, 0.0, Rgb::splat(body.sigma_t));
            let mut scene = furnace(body.mesh.clone(), material);
            (scene.film.width, scene.film.height) = (12, 12);
            // Directions of entry weigh differently there, which is noise that the others do not have.
            let samples = if *name == "directional-dipole" { 4 * samples } else { samples };
            for (setup, (film, _)) in renderings(&scene, *options, &Levels(samples)) {
                let mut means = Statistics::default();
                let mut sigma = 0.0;
                for pixel in film.rows() {
                    means.add(pixel.mean()[0].into());
                    sigma += pixel.variance_of_mean(0);
                }
                let (mean, sigma) = (means.mean(), sigma.sqrt() / film.pixel_count() as f64);
                let what = format!("{} σ_t {} {name} {setup}", body.name, body.sigma_t);
                println!("{what}: {mean:.5} ± {sigma:.5}, brightest pixel {:.4}", means.max);
                assert!(mean <= 1.0 + 3.0 * sigma + 1e-5, "{what}: {mean} ± {sigma}");
                assert!(means.max <= 1.05, "{what}: {}", means.max);
                assert_eq!(film.tally().nonfinite, 0, "{what}");
                largest = largest.max(mean);
                lowest = lowest.min(mean);
                brightest = brightest.max(means.max);
            }
        }
    }
    format!("means from {lowest:.4} to {largest:.5}, brightest pixel {brightest:.3}")
}

/// Every profile by its name, and what the program chooses.
fn methods() -> Vec<(&'static str, RenderOptions)> {
    let at_depth = |options: RenderOptions| RenderOptions { max_depth: 100, ..options };
    let by_profile = |(name, profile)| (name, at_depth(RenderOptions { profile, ..options() }));
    let mut all: Vec<_> = ProfileChoice::NAMES.into_iter().map(by_profile).collect();
    all.push(("method auto", at_depth(by(Method::Auto))));
    all
}

#[test]
fn gain_at_every_bounce() {
    let hardest: Vec<Body> = bodies().into_iter().filter(|body| !body.is_convex).chain([bubble()]).collect();
    let chosen: Vec<_> = methods()
        .into_iter()
        .filter(|(name, _)| {
            ["auto", "directional-dipole", "normalized-diffusion", "method auto"].contains(name)
        })
        .collect();
    let figure = check_furnaces(&hardest, &chosen, 256);

    // Between two slabs the planar profile counts what the other faces hold on top: M a bounce, and M^n in the end.
    let body = bodies().into_iter().find(|body| body.name.starts_with("two slabs")).unwrap();
    let d = alabaster::diffusion::NormalizedDiffusion::from_albedo(1.0, 1.0 / body.sigma_t).d;
    let mut gain = Statistics::default();
    let place = (Vec3::new(0.1, -0.05, 0.2), Vec3::Y);
    for_each_line(&caster(&body.mesh), &body.mesh, Rgb::splat(d), place, 100_000, |found| {
        gain.add(found.iter().map(|crossing| f64::from(crossing.weight[0])).sum());
    });
    assert_fails("the area integral as it stands", gain.mean(), |mean| {
        mean <= 1.0 + 3.0 * gain.standard_error()
    });
    let entry = largest_entry_weight(&Boundary::new(1.33, 0.0));
    record(
        "gain_at_every_bounce",
        format!(
            "{figure}; as it stands the integral is {:.2} per bounce; entry weights up to {entry:.2}",
            gain.mean()
        ),
    );
}

/// All bodies and all profiles.
#[test]
#[ignore = "minutes: every body, profile and backend"]
fn gain_at_every_bounce_of_every_profile() {
    let all: Vec<Body> = bodies().into_iter().chain([bubble()]).collect();
    println!("{}", check_furnaces(&all, &methods(), 256));
}

/// Light that has all but been absorbed, in a body that it leaves only after thousands of collisions.
#[test]
fn long_walks_in_dark_media() {
    let mut figure = Figures::default();
    for g in [0.0, 0.95, -0.9] {
        let material = translucent(1.5, Rgb::new(1e-3, 1.0, 1e4), Rgb::splat(300.0), g);
        let scene: Scene = furnace(shape::sphere(Vec3::ZERO, 1.0, 4), material);
        for (setup, found) in renderings(&scene, by(Method::Walk), &Rays(2_000, even_rays)) {
            for channel in found.parts(setup.mode) {
                let (mean, sigma) = (channel.mean(), channel.standard_error());
                assert!(mean > 0.0 && mean < 1.0 + 3.0 * sigma, "g {g} {setup}: {mean}");
            }
            assert_eq!((found.counters.capped_paths, found.counters.rejected), (0, 0), "g {g} {setup}");
            figure.keep(setup, format!("up to {:.0e} collisions a path, none cut", found.collisions.max));
        }
    }
    record("long_walks_in_dark_media", figure.written());
}
