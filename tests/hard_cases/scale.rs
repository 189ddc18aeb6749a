//! The same scene elsewhere, larger, smaller, squeezed: single precision must not show.

use alabaster::film::Film;
use alabaster::math::robust::{interpolation_error, offset_from_surface};
use alabaster::math::sampler::HashGenerator;
use alabaster::radiometry::Rgb;
use alabaster::scene::{Camera, ColorMode, Instance, Light, Mesh, Method, Scene, shape};
use glam::{Affine3A, Quat, Vec3};

use crate::common::backends::{Films, Pictures, Rays, by, relative_difference, renderings, renderings_in};
use crate::common::scenes::furnace;
use crate::media::translucent;
use crate::record::{Figures, assert_fails, record};
use crate::table::{number, rows};

/// A ball on a slab, of different media, under a lamp.
fn still_life(scale: f32) -> Scene {
    let medium = |sigma_t: f32, ior: f32| {
        let albedo = Rgb::new(0.99, 0.9, 0.6);
        translucent(ior, (Rgb::ONE - albedo) * (sigma_t / scale), albedo * (sigma_t / scale), 0.0)
    };
    let mut scene = furnace(shape::sphere(Vec3::Y * 0.5 * scale, 0.5 * scale, 4), medium(10.0, 1.4));
    scene.meshes.push(shape::cuboid(Vec3::NEG_Y * 0.125 * scale, Vec3::new(2.0, 0.25, 2.0) * scale));
    let floor = Instance { name: "floor".into(), mesh: 1, material: 1, transform: Affine3A::IDENTITY };
    scene.instances.push(floor);
    scene.materials.push(medium(20.0, 1.0));
    scene.lights = vec![Light::Sphere {
        center: Vec3::new(1.0, 3.0, 1.5) * scale,
        radius: 0.75 * scale,
        radiance: Rgb::splat(4.0).into(),
    }];
    scene.camera.position *= scale;
    scene
}

/// All of a scene moved.
fn moved(mut scene: Scene, by: Vec3) -> Scene {
    scene.camera.position += by;
    scene.camera.target += by;
    for light in &mut scene.lights {
        if let Light::Sphere { center, .. } = light {
            *center += by;
        }
    }
    for instance in &mut scene.instances {
        instance.transform = Affine3A::from_translation(by) * instance.transform;
    }
    scene
}

const SAMPLES: u64 = 48;

/// Films of `scene` and of `other` by each method and backend: how much they differ over how much their noise makes them.
fn differences(scene: &Scene, other: &Scene) -> Vec<(String, f64)> {
    let mut all = Vec::new();
    for method in [Method::Bssrdf, Method::Walk] {
        let work = Films(SAMPLES);
        let pairs =
            renderings(scene, by(method), &work).into_iter().zip(renderings(other, by(method), &work));
        for ((setup, (a, _)), (_, (b, counters))) in pairs {
            assert_eq!((b.tally().nonfinite, counters.capped_paths), (0, 0));
            let (difference, noise) = relative_difference(&a, &b);
            all.push((format!("{method:?} {setup}"), difference / noise));
        }
    }
    all
}

/// Metres, kilometres, micrometres: the same numbers but for a power of ten.
#[test]
fn scales() {
    let at_home = still_life(1.0);
    let mut largest = 0.0_f64;
    for exponent in [-4, -2, 2, 4] {
        for (name, ratio) in differences(&at_home, &still_life(10.0_f32.powi(exponent))) {
            println!("10^{exponent} {name}: {ratio:.3}");
            assert!(ratio < 2.0, "10^{exponent} {name}: {ratio}");
            largest = largest.max(ratio);
        }
    }
    // A fixed distance off the surface, in a scene of the size of an insect's eye.
    let skipped = |offset: f32| 1.0 - (-10.0 * offset / 1e-4_f32).exp();
    assert_fails("an offset of 10⁻⁴ m", skipped(1e-4), |share| share < 1e-3);
    record("scales", format!("relMSE over that of noise, at most {largest:.2}"));
}

#[test]
fn far_from_the_origin() {
    let at_home = still_life(1.0);
    let mut largest = 0.0_f64;
    for distance in [1e3, 1e5, 1e6] {
        // A multiple of an ulp of coordinates there, as is all that is given as such: the camera at (1.5, 2.5, 4), the lamp at (1, 3, 1.5).
        let other = moved(at_home.clone(), Vec3::new(1.0, -1.0, 0.5) * distance);
        for (name, ratio) in differences(&at_home, &other) {
            println!("{distance} m {name}: {ratio:.3}");
            assert!(ratio < 2.0, "{distance} m {name}: {ratio}");
            largest = largest.max(ratio);
        }
    }
    // A thousandth of a metre, which is a hundredth of a free path there.
    assert_fails("coordinates of the world", 1e6_f32 + 1e-3, |x| x > 1e6);
    record("far_from_the_origin", format!("relMSE over that of noise, at most {largest:.2}"));
}

fn mean_of(film: &Film) -> f64 {
    film.rows().map(|pixel| f64::from(pixel.mean().mean())).sum::<f64>() / film.pixel_count() as f64
}

/// A ball squeezed, turned and mirrored by its placement, against the mesh that this makes; shared by two objects, so that it is not baked.
#[test]
fn squeezed_and_mirrored_instances() {
    let ball = shape::sphere(Vec3::ZERO, 1.0, 5);
    let material = || translucent(1.4, Rgb::new(0.1, 0.3, 0.6), Rgb::new(10.0, 12.0, 8.0), 0.0);
    let mut figures = Vec::new();
    for (name, scale) in [("squeezed", Vec3::new(1.2, 0.4, 0.8)), ("mirrored", Vec3::new(-1.2, 0.4, 0.8))] {
        let transform =
            Affine3A::from_scale_rotation_translation(scale, Quat::from_rotation_z(0.4), Vec3::ZERO);
        let normal = |n: Vec3| (transform.matrix3.inverse().transpose() * n).normalize();
        let mut baked = Mesh {
            positions: ball.positions.iter().map(|p| transform.transform_point3(*p)).collect(),
            normals: ball.normals.iter().map(|n| normal(*n)).collect(),
            ..ball.clone()
        };
        if scale.x < 0.0 {
            baked.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        let lit = |mesh: Mesh, transform: Affine3A| {
            let mut scene = crate::lights::under_uneven_sky(furnace(mesh, material()));
            scene.instances[0].transform = transform;
            // Out of sight, and of reach.
            let far = Affine3A::from_translation(Vec3::new(0.0, -300.0, 0.0)) * transform;
            scene.instances.push(Instance {
                name: "far".into(),
                transform: far,
                ..scene.instances[0].clone()
            });
            scene
        };
        let (instanced, meshed) = (lit(ball.clone(), transform), lit(baked, Affine3A::IDENTITY));
        let work = Pictures(64);
        for method in [Method::Bssrdf, Method::Walk] {
            let pairs = renderings(&instanced, by(method), &work).into_iter().zip(renderings(
                &meshed,
                by(method),
                &work,
            ));
            for ((setup, a), (_, b)) in pairs {
                let sigma = a.mean.standard_error().hypot(b.mean.standard_error());
                let pull = (a.mean.mean() - b.mean.mean()) / sigma;
                assert!(pull.abs() < 3.0, "{name} {method:?} {setup}: {pull} σ");
                if let Some(mode) = setup.recorded() {
                    figures.push(format!("{name}, {mode} by {}: {pull:+.1} σ", method.name()));
                }
            }
        }
    }
    // A normal that goes with the surface's points instead of against them.
    let matrix = glam::Mat3::from_diagonal(Vec3::new(1.2, 0.4, 0.8));
    let (n, along) = (Vec3::new(0.6, 0.8, 0.0), Vec3::new(0.8, -0.6, 0.0));
    let holds = |normal: Vec3| normal.normalize().dot((matrix * along).normalize()).abs() < 1e-6;
    assert!(holds(matrix.inverse().transpose() * n));
    assert_fails("normals by the matrix itself", matrix * n, holds);
    record("squeezed_and_mirrored_instances", figures.join("; "));
}

/// A flat body of 10³ to 10⁶ free paths: what comes back does not know how coarse coordinates are.
#[test]
fn ray_offset_against_the_free_path() {
    const PATHS: u64 = 150_000;
    let table = rows("halfspace_planar_albedo.csv");
    let mut figures = Vec::new();
    for (mode, ior, omegas) in [
        (ColorMode::Rgb, 1.0_f64, [0.8, 0.99, 0.995]),
        (ColorMode::Rgb, 1.5, [0.1, 0.7, 0.99]),
        (ColorMode::Spectral, 1.0, [0.995; 3]),
        (ColorMode::Spectral, 1.5, [0.99; 3]),
    ] {
        for sigma_t in [5e3_f32, 5e5] {
            let albedo = Rgb::from_fn(|c| omegas[c] as f32);
            let material = translucent(ior as f32, (Rgb::ONE - albedo) * sigma_t, albedo * sigma_t, 0.0);
            // At the height of the surface coordinates are some 0.7.
            let mesh = shape::cuboid(Vec3::new(0.1, 0.2, 0.3), Vec3::new(1.0, 1.0, 1.0));
            let down = |sample: u64| {
                let mut random = HashGenerator::new(sample);
                let [x, z] = [(); 2].map(|()| random.next_f32() - 0.5);
                (Vec3::new(0.1 + 0.5 * x, 2.0, 0.3 + 0.5 * z), Vec3::NEG_Y)
            };
            for (setup, found) in
                renderings_in(mode, &furnace(mesh, material), by(Method::Walk), &Rays(PATHS, down))
            {
                for (channel, omega) in found.parts(mode).iter().zip(omegas) {
                    let is_asked =
                        |row: &&Vec<String>| [0, 1, 2].map(|i| number(&row[i])) == [omega, 0.0, ior];
                    let exact = table.iter().find(is_asked).map(|row| number(&row[4])).unwrap();
                    let (mean, sigma) = (channel.mean(), channel.standard_error());
                    let error = mean / exact - 1.0;
                    println!("σ_t {sigma_t} η {ior} ω {omega} {setup}: {error:+.5} ± {:.5}", sigma / exact);
                    assert!(
                        error.abs() < 3e-3 + 3.0 * sigma / exact,
                        "σ_t {sigma_t} η {ior} ω {omega} {setup}: {error}"
                    );
                }
                if let (Some(mode_name), Some(channel)) = (setup.recorded(), found.parts(mode).last()) {
                    let is_asked =
                        |row: &&Vec<String>| [0, 1, 2].map(|i| number(&row[i])) == [omegas[2], 0.0, ior];
                    let exact = table.iter().find(is_asked).map(|row| number(&row[4])).unwrap();
                    figures.push(format!(
                        "{mode_name} σ_t {sigma_t:.0e} η {ior}: {:+.2} ± {:.2} %",
                        100.0 * (channel.mean() / exact - 1.0),
                        100.0 * channel.standard_error() / exact
                    ));
                }
            }
        }
    }
    // The share of the light whose first free path is stepped over.
    let corner = Vec3::new(0.6, 0.7, 0.8);
    let left = offset_from_surface(corner, interpolation_error(corner, corner, corner), Vec3::Y, Vec3::NEG_Y);
    let skipped = |offset: f32| 1.0 - (-5e5 * offset).exp();
    assert_fails("flights that begin at the offset", skipped(corner.y - left.y), |share| share < 3e-3);
    record("ray_offset_against_the_free_path", figures.join("; "));
}

/// A camera that sees a scene through next to no angle from far away, and one that sees nearly half of all directions.
#[test]
fn extreme_views() {
    let scene = still_life(1.0);
    let camera = |position: Vec3, degrees: f32| Camera {
        position,
        vertical_fov: degrees.to_radians(),
        ..scene.camera
    };
    let mut figure = Figures::default();
    for camera in [
        camera(Vec3::new(2e5, 3e5, 4e5), 1e-4),
        camera(Vec3::new(0.0, 3.0, 0.001), 179.9),
        camera(Vec3::Y * 5.0, 40.0),
    ] {
        let scene = Scene { camera, ..scene.clone() };
        for method in [Method::Bssrdf, Method::Walk] {
            for (setup, (film, counters)) in renderings(&scene, by(method), &Films(8)) {
                assert_eq!(
                    (film.tally().nonfinite, counters.rejected, counters.capped_paths),
                    (0, 0, 0),
                    "{setup}"
                );
                let mean = mean_of(&film);
                assert!(mean > 0.1 && mean < 4.0, "{setup}: {mean}");
                figure.keep(setup, format!("nothing rejected, mean {mean:.2}"));
            }
        }
    }
    record("extreme_views", figure.written());
}
