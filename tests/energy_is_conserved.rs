//! White furnace: in uniform surroundings of radiance 1 a body that absorbs nothing must look exactly
//! like the background, whatever its shape, index, roughness or mean free path.

mod common;

use alabaster::optics::Boundary;
use alabaster::radiometry::Rgb;
use alabaster::scene::{ProfileChoice, Scene, read_scene};
use alabaster::transport::{Counters, Renderer};
use common::assets::assets;
use common::bodies::{bodies, bubble};
use common::scenes::{Caster, Statistics, furnace, in_furnace, renderer, renderer_with, white};

const INDICES: [f32; 4] = [1.0, 1.33, 1.5, 1.0 / 1.33];
const ROUGHNESSES: [f32; 2] = [0.0, 0.5];

/// The channels scatter differently, so that a path changes colour.
const CHANNELS: Rgb = Rgb::new(1.0, 0.8, 1.6);

const SAMPLES: u64 = 12;

/// The most by which a path's weight, in all channels together, can grow where it enters a body: the
/// lobe S_w cosθ over the density of its tabulated sampling. Everything else on a path keeps it.
fn largest_entry_weight(eta: f32, roughness: f32) -> f64 {
    let boundary = Boundary::new(eta, roughness * roughness);
    let weight = |i: u32| {
        let mu = ((i as f32 + 0.5) / 1e5).sqrt();
        f64::from(boundary.exit_lobe(mu) * mu / boundary.exit_density(mu))
    };
    // A thousandth for what lies between the cosines tried.
    1.001 * (0..100_000).map(weight).fold(1.0, f64::max)
}

/// [`SAMPLES`] samples of each pixel.
fn render(name: &str, renderer: &Renderer<Caster>) -> Statistics {
    let (width, height) = (renderer.scene().film.width, renderer.scene().film.height);
    let mut counters = Counters::default();
    let mut all = Statistics::default();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        for sample in 0..SAMPLES {
            let radiance = renderer.sample(x, y, sample, &mut counters);
            assert!(radiance.is_finite(), "{name}: not finite at ({x}, {y})");
            // The channels of a sample are not independent: their mean is one number.
            all.add(f64::from(radiance.mean()));
        }
    }
    assert_eq!(counters.capped_paths, 0, "{name}");
    all
}

/// Checks the mean of the samples, and the brightest.
fn check_samples(name: &str, all: &Statistics, systematic: f64, brightest: f64) {
    let (mean, sigma) = (all.mean(), all.standard_error());
    println!("{name}: {mean:.5} ± {sigma:.5}, brightest sample {:.3}", all.max);
    // Rounding of products along a path of some hundred factors leaves a few 1e-6.
    assert!((mean - 1.0).abs() < 3.0 * sigma + 1e-5 + systematic, "{name}: {mean} ± {sigma}");
    assert!(all.max < brightest, "{name}: a sample of {} where at most {brightest} can be", all.max);
}

fn check(name: &str, scene: Scene, brightest: f64) {
    check_samples(name, &render(name, &renderer(scene)), 0.0, brightest);
}

#[test]
fn bodies_that_absorb_nothing_vanish_in_uniform_light() {
    for eta in INDICES {
        for roughness in ROUGHNESSES {
            let weight = largest_entry_weight(eta, roughness);
            for body in bodies() {
                let name = format!("{}, σ_t {}, η {eta:.2}, roughness {roughness}", body.name, body.sigma_t);
                // Out of a convex body light goes away for good. Elsewhere it can enter again and again, but
                // hardly ever so close to the critical angle that it gains more than twice.
                let brightest = if body.is_convex { weight } else { weight * weight };
                check(&name, furnace(body.mesh, white(eta, roughness, CHANNELS * body.sigma_t)), brightest);
            }
        }
    }
}

#[test]
fn a_bubble_vanishes_in_uniform_light() {
    for roughness in ROUGHNESSES {
        let body = bubble();
        let name = format!("{}, σ_t {}, roughness {roughness}", body.name, body.sigma_t);
        check(
            &name,
            furnace(body.mesh, white(0.8, roughness, CHANNELS * body.sigma_t)),
            largest_entry_weight(0.8, roughness),
        );
    }
}

#[test]
fn a_scanned_skull_vanishes_in_uniform_light() {
    let Some(folder) = assets() else { return };
    let mut scene = read_scene(&folder.join("meshes/skull-100k.glb")).unwrap();
    (scene.film.width, scene.film.height) = (24, 24);
    let size = scene.camera.position.distance(scene.camera.target);
    for (eta, roughness) in INDICES.into_iter().zip([0.0, 0.5, 0.0, 0.5]) {
        let material = white(eta, roughness, CHANNELS * (100.0 / size));
        let brightest = largest_entry_weight(eta, roughness).powi(2);
        check(
            &format!("skull, η {eta:.2}, roughness {roughness}"),
            in_furnace(scene.clone(), material),
            brightest,
        );
    }
}

/// Energy is the business of the area integral: any profile keeps it.
#[test]
fn every_profile_keeps_energy() {
    let chosen = ["sphere, R = 1", "slab, 0.2 thick", "two slabs, gap 0.1"];
    let bodies: Vec<_> =
        bodies().into_iter().filter(|b| chosen.contains(&b.name) && b.sigma_t <= 10.0).collect();
    for (profile_name, profile) in ProfileChoice::NAMES {
        for (eta, roughness) in [(1.0, 0.0), (1.5, 0.5), (1.0 / 1.33, 0.0)] {
            let weight = largest_entry_weight(eta, roughness);
            for body in &bodies {
                let name = format!(
                    "{profile_name}: {}, σ_t {}, η {eta:.2}, roughness {roughness}",
                    body.name, body.sigma_t
                );
                let material = white(eta, roughness, CHANNELS * body.sigma_t);
                let all = render(&name, &renderer_with(furnace(body.mesh.clone(), material), profile));
                // The weights of directions have no such bound, and the mean 1 to within the error of their table.
                let (systematic, brightest) = match profile {
                    ProfileChoice::DirectionalDipole => (2e-4, f64::INFINITY),
                    _ => (0.0, if body.is_convex { weight } else { weight * weight }),
                };
                check_samples(&name, &all, systematic, brightest);
            }
        }
    }
}
