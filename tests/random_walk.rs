//! The random walk: energy, the exact laws of paths in a body, and thick flat bodies against transport theory.

mod common;

use std::f32::consts::TAU;
use std::fs;
use std::path::Path;

use alabaster::math::sampler::HashGenerator;
use alabaster::math::{Frame, warp};
use alabaster::optics::Boundary;
use alabaster::radiometry::Rgb;
use alabaster::scene::{
    ColorInput, Instance, Light, Material, Mesh, ScatteringInput, Scene, Surface, read_scene, shape,
};
use common::assets::assets;
use common::scenes::{furnace, join, white};
use common::walks::{Found, faceted, picture, plain_walker, trace, walker};
use glam::{Affine3A, Vec3};

/// The channels scatter differently, so that a path changes colour.
const CHANNELS: Rgb = Rgb::new(1.0, 0.8, 1.6);

fn translucent(ior: f32, roughness: f32, medium: ScatteringInput) -> Material {
    Material { surface: Surface::Translucent { ior, roughness, medium }, ..white(ior, roughness, Rgb::ONE) }
}

fn add(scene: &mut Scene, name: &str, mesh: Mesh, material: Material) {
    scene.instances.push(Instance {
        name: name.into(),
        mesh: scene.meshes.len(),
        material: scene.materials.len(),
        transform: Affine3A::IDENTITY,
    });
    scene.meshes.push(mesh);
    scene.materials.push(material);
}

/// Every channel, and their mean, shows radiance 1, to the rounding of some hundred factors, `systematic`, and 3σ; 4σ for
/// the channels, of which there are a hundred. Where all light is that of the surroundings, the mean over the
/// channels is the same for every path: its σ is that of rounding.
#[track_caller]
fn assert_vanishes(name: &str, found: &Found, systematic: f64) {
    let channels = found.radiance.iter().map(|channel| (channel, 4.0));
    for (statistics, allowed) in channels.chain([(&found.mean, 3.0)]) {
        let (mean, sigma) = (statistics.mean(), statistics.standard_error());
        println!("{name}: {mean:.5} ± {sigma:.5}, brightest {:.2}", statistics.max);
        assert!((mean - 1.0).abs() < allowed * sigma + 1e-5 + systematic, "{name}: {mean} ± {sigma}");
        assert!(sigma < 0.02, "{name}: σ {sigma}");
    }
    assert!(found.mean.standard_error() < 2e-3);
    assert_eq!((found.counters.capped_paths, found.counters.rejected), (0, 0), "{name}");
}

#[test]
fn bodies_that_absorb_nothing_vanish_in_uniform_light() {
    let sphere = shape::sphere(Vec3::ZERO, 1.0, 5);
    let slab = shape::cuboid(Vec3::ZERO, Vec3::new(2.0, 0.6, 1.2));
    for (shape, mesh) in [("sphere", sphere), ("box", slab)] {
        for ior in [1.0, 1.33, 1.5, 1.0 / 1.33] {
            for (roughness, sigma_t, g) in
                [(0.0, 5.0, 0.0), (0.5, 5.0, 0.0), (0.0, 30.0, 0.9), (0.8, 1.0, -0.5)]
            {
                let medium =
                    ScatteringInput::Coefficients { sigma_a: Rgb::ZERO, sigma_s: CHANNELS * sigma_t, g };
                let renderer = walker(furnace(mesh.clone(), translucent(ior, roughness, medium)));
                assert_eq!(renderer.warnings(), [""; 0]);
                let found = picture(&renderer, 12);
                assert_vanishes(&format!("{shape} η {ior:.2} roughness {roughness} g {g}"), &found, 0.0);
                // No channel carries more than all three did at the start.
                assert!(found.radiance.iter().all(|channel| channel.max < 3.0 + 1e-4));
            }
        }
    }
}

/// The same where the light is drawn directly: from a shell around everything, from a ball inside the body, which is as much
/// brighter as light in the body is, and past a white block that casts shadows.
#[test]
fn light_drawn_directly_is_the_light_found() {
    for (ior, roughness) in [(1.0, 0.0), (1.5, 0.0), (1.5, 0.5), (1.0 / 1.33, 0.5)] {
        let medium = ScatteringInput::Coefficients { sigma_a: Rgb::ZERO, sigma_s: CHANNELS * 2.0, g: 0.5 };
        let sphere = shape::sphere(Vec3::ZERO, 0.8, 5);
        let mut scene = furnace(sphere, translucent(ior, roughness, medium));
        scene.environment = None;
        let black = |radiance: f32| Material {
            surface: Surface::Diffuse { reflectance: ColorInput::constant(Rgb::ZERO) },
            emission: ColorInput::constant(Rgb::splat(radiance)),
            ..Material::default()
        };
        let block = Material {
            surface: Surface::Diffuse { reflectance: ColorInput::constant(Rgb::ONE) },
            emission: ColorInput::constant(Rgb::ZERO),
            ..Material::default()
        };
        let mut shell = faceted(shape::sphere(Vec3::ZERO, 8.0, 4));
        shell.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        add(&mut scene, "shell", shell, black(1.0));
        add(&mut scene, "ball", faceted(shape::sphere(Vec3::X * 0.2, 0.3, 3)), black(ior * ior));
        add(&mut scene, "block", shape::cuboid(Vec3::new(-0.4, -1.2, 0.9), Vec3::new(1.0, 0.6, 0.5)), block);
        let found = picture(&walker(scene), 192);
        // The table of a rough boundary's shares is right to a thousandth.
        let systematic = if roughness > 0.0 { 1e-3 } else { 0.0 };
        assert_vanishes(&format!("η {ior:.2} roughness {roughness}, lit"), &found, systematic);
    }
}

fn volume(mesh: &Mesh) -> f64 {
    let corners = |t: &[u32; 3]| t.map(|v| mesh.positions[v as usize].as_dvec3());
    mesh.triangles.iter().map(corners).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

/// Rays of uniform light into a sphere of radius `radius` around `center`.
fn uniform_rays(center: Vec3, radius: f32) -> impl Fn(u64) -> (Vec3, Vec3) + Sync {
    move |sample| {
        let mut random = HashGenerator::new(sample);
        let z = 1.0 - 2.0 * random.next_f32();
        let (sin, cos) = (TAU * random.next_f32()).sin_cos();
        let r = (1.0 - z * z).max(0.0).sqrt();
        let inward = Vec3::new(r * cos, r * sin, z);
        let direction = warp::square_to_cosine_hemisphere(random.next_f32(), random.next_f32());
        (center - inward * radius, Frame::from_normal(inward).to_world(direction))
    }
}

/// Uniform light fills a body that absorbs nothing with n² times its radiance, whatever is scattered how. A photon sent into a
/// sphere of area S around it therefore has a path of n²·4V/S in the body, in the mean, and as many
/// collisions as that is free paths long. (For a convex body S can be its own surface: the sphere's photons
/// meet it in the ratio of the areas.) Reflections, total ones too, and re-entry into concave bodies are counted in.
fn check_path_length(name: &str, mesh: &Mesh, free_paths: f64, photons: u64) {
    let bounds = |(low, high): (Vec3, Vec3), p: &Vec3| (low.min(*p), high.max(*p));
    let (low, high) = mesh.positions.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), bounds);
    let center = 0.5 * (low + high);
    let radius = mesh.positions.iter().map(|p| p.distance(center)).fold(0.0, f32::max) * 1.0001;
    let area = 4.0 * std::f64::consts::PI * f64::from(radius).powi(2);
    let chord = 4.0 * volume(mesh) / area;
    for ior in [1.0, 1.5] {
        for g in [0.0, 0.9] {
            let sigma_s = (free_paths / chord) as f32;
            let medium =
                ScatteringInput::Coefficients { sigma_a: Rgb::ZERO, sigma_s: Rgb::splat(sigma_s), g };
            let renderer = plain_walker(furnace(mesh.clone(), translucent(ior, 0.0, medium)));
            let found = trace(&renderer, photons, uniform_rays(center, radius));
            let expected = f64::from(sigma_s) * f64::from(ior).powi(2) * chord;
            let (mean, sigma) = (found.collisions.mean(), found.collisions.standard_error());
            println!("{name} η {ior} g {g}: {mean:.4} ± {sigma:.4} collisions, exactly {expected:.4}");
            assert!(
                (mean - expected).abs() < 3.0 * sigma,
                "{name} η {ior} g {g}: {mean} ± {sigma}, {expected}"
            );
            assert!(sigma < 0.015 * expected);
            // Rounding lets one path in millions out where two faces meet.
            assert!(found.counters.capped_paths == 0 && found.counters.open_walks <= 1);
        }
    }
}

#[test]
fn the_mean_path_in_a_body_depends_on_nothing_but_its_volume() {
    check_path_length("sphere", &faceted(shape::sphere(Vec3::new(3.0, 0.0, 0.0), 1.0, 4)), 3.0, 100_000);
    check_path_length("box", &shape::cuboid(Vec3::ZERO, Vec3::new(1.0, 0.6, 0.3)), 2.0, 200_000);
}

#[test]
fn the_mean_path_in_a_scanned_skull_depends_on_nothing_but_its_volume() {
    let Some(folder) = assets() else { return };
    let scene = read_scene(&folder.join("meshes/skull-100k.glb")).unwrap();
    check_path_length("skull", &faceted(scene.meshes[0].clone()), 1.0, 150_000);
}

/// A flat body many free paths wide and thick, its surface at y = 0.
fn thick_slab(material: Material) -> Scene {
    furnace(shape::cuboid(Vec3::new(0.0, -5.0, 0.0), Vec3::new(40.0, 10.0, 40.0)), material)
}

/// A row of the table of exact reflectances: ω, g, η, and the total reflectance at normal incidence.
fn reflectances() -> Vec<[f64; 4]> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/halfspace_planar_albedo.csv");
    let table = fs::read_to_string(path).unwrap();
    let rows = table.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    rows.map(|row| {
        let field = |i: usize| row.split(',').nth(i).unwrap().parse().unwrap();
        [field(0), field(1), field(2), field(4)]
    })
    .collect()
}

#[test]
fn a_thick_flat_body_reflects_what_transport_theory_says() {
    const PATHS: u64 = 2_000_000;
    let table = reflectances();
    let groups = [
        (0.0, 1.0, [0.8, 0.99, 0.995]),
        (0.5, 1.33, [0.3, 0.5, 0.8]),
        (0.9, 1.4, [0.3, 0.7, 0.9]),
        (0.0, 1.4, [0.7, 0.9, 0.95]),
        (0.0, 1.5, [0.1, 0.7, 0.99]),
        (0.75, 1.5, [0.1, 0.7, 0.9]),
    ];
    for (g, ior, albedos) in groups {
        let sigma_t = 25.0 / (1.0 - g);
        let albedo = Rgb::from_fn(|c| albedos[c] as f32);
        let medium = ScatteringInput::Coefficients {
            sigma_a: (Rgb::ONE - albedo) * sigma_t as f32,
            sigma_s: albedo * sigma_t as f32,
            g: g as f32,
        };
        let renderer = walker(thick_slab(translucent(ior as f32, 0.0, medium)));
        let found = trace(&renderer, PATHS, |_| (Vec3::new(1.3, 1.0, 0.4), Vec3::NEG_Y));
        for (c, channel) in found.radiance.iter().enumerate() {
            let is_asked = |row: &&[f64; 4]| row[..3] == [albedos[c], g, ior];
            let exact = table.iter().find(is_asked).expect("a row of the table")[3];
            let (mean, sigma) = (channel.mean(), channel.standard_error());
            println!("ω {} g {g} η {ior}: {mean:.5} ± {sigma:.5}, exactly {exact:.5}", albedos[c]);
            assert!((mean - exact).abs() < 3.0 * sigma, "{mean} ± {sigma}, not {exact}");
            assert!((mean - exact).abs() < 5e-4, "{mean}, not {exact}");
        }
    }
}

/// The medium is the one whose albedo, on a plane in even light, is that asked for.
#[test]
fn the_albedo_asked_for_is_the_albedo_walked() {
    let albedo = Rgb::new(0.8, 0.5, 0.1);
    let mean_free_path = Rgb::new(0.03, 0.02, 0.01);
    for (ior, g) in [(1.0, 0.0), (1.4, 0.5)] {
        let asked = ScatteringInput::Albedo { albedo: ColorInput::constant(albedo), mean_free_path, g };
        let renderer = walker(thick_slab(translucent(ior, 0.0, asked)));
        let found = trace(&renderer, 200_000, |sample| {
            let mut random = HashGenerator::new(sample);
            let up = warp::square_to_cosine_hemisphere(random.next_f32(), random.next_f32());
            let direction = -Frame::from_normal(Vec3::Y).to_world(up);
            (Vec3::new(1.3, 0.0, 0.4) - direction, direction)
        });
        let enters = f64::from(Boundary::new(ior, 0.0).mean_transmittance());
        for (c, channel) in found.radiance.iter().enumerate() {
            let exact = 1.0 - enters * (1.0 - f64::from(albedo[c]));
            let (mean, sigma) = (channel.mean(), channel.standard_error());
            println!("η {ior} g {g} channel {c}: {mean:.5} ± {sigma:.5}, exactly {exact:.5}");
            // The table that is inverted is right to 10⁻⁴.
            assert!((mean - exact).abs() < 3.0 * sigma + 1e-4, "{mean} ± {sigma}, not {exact}");
            assert!(sigma < 2e-3);
        }
    }
}

/// Whatever is wrong with a mesh, light is neither made nor lost in it, and the user is told what is assumed.
#[test]
fn broken_bodies_are_told_of_and_make_no_light() {
    let sphere = shape::sphere(Vec3::ZERO, 1.0, 4);
    let edit = |change: fn(&mut Vec<[u32; 3]>)| {
        let mut mesh = sphere.clone();
        change(&mut mesh.triangles);
        mesh
    };
    let overlapping = [Vec3::X, Vec3::NEG_X].map(|x| shape::sphere(x * 0.4, 0.8, 4));
    let cases = [
        ("object \"body\": its surface is open at", edit(|t| t.truncate(1000))),
        ("object \"body\": its surface is open at", edit(|t| drop(t.drain(10..30)))),
        ("inside out", edit(|t| t.iter_mut().for_each(|t| t.swap(0, 1)))),
        ("wound against their neighbours", edit(|t| t[..200].iter_mut().for_each(|t| t.swap(0, 1)))),
        ("encloses no volume", shape::quad(Vec3::ZERO, Vec3::X, Vec3::Y)),
        ("encloses no volume", shape::cuboid(Vec3::ZERO, Vec3::new(2.0, 0.0, 2.0))),
        ("", join(overlapping)),
    ];
    for (told, mesh) in cases {
        for (ior, roughness) in [(1.0, 0.0), (1.5, 0.0), (1.0 / 1.33, 0.5)] {
            let renderer = walker(furnace(mesh.clone(), white(ior, roughness, CHANNELS * 3.0)));
            match told {
                "" => assert_eq!(renderer.warnings(), [""; 0]),
                told => assert!(renderer.warnings()[0].contains(told), "{:?}", renderer.warnings()),
            }
            assert_vanishes(&format!("{told} η {ior:.2}"), &picture(&renderer, 12), 0.0);
        }
    }
}

#[test]
fn a_body_in_a_body_of_the_same_material_is_one_with_it() {
    let medium = || ScatteringInput::Coefficients {
        sigma_a: Rgb::new(0.1, 0.3, 1.0),
        sigma_s: CHANNELS * 3.0,
        g: 0.3,
    };
    let scene = furnace(shape::sphere(Vec3::ZERO, 1.0, 4), translucent(1.4, 0.0, medium()));
    let mut nested = scene.clone();
    nested.meshes.push(shape::sphere(Vec3::Y * 0.2, 0.6, 4));
    nested.instances.push(Instance { name: "inner".into(), mesh: 1, ..nested.instances[0].clone() });
    let nested = walker(nested);
    assert!(
        nested.warnings()[0].contains("\"inner\" lies inside object \"body\""),
        "{:?}",
        nested.warnings()
    );
    let [alone, nested] = [walker(scene), nested].map(|renderer| picture(&renderer, 32));
    for (a, b) in alone.radiance.iter().zip(&nested.radiance) {
        let sigma = a.standard_error().hypot(b.standard_error());
        println!("{:.4} {:.4} ± {sigma:.4}", a.mean(), b.mean());
        assert!((a.mean() - b.mean()).abs() < 3.0 * sigma);
        assert!(sigma < 0.01);
    }
}

#[test]
fn lights_that_walks_cannot_find_are_told_of() {
    let with_light = |ior, roughness| {
        let mut scene = furnace(shape::sphere(Vec3::ZERO, 1.0, 3), white(ior, roughness, Rgb::ONE));
        scene.lights = vec![Light::Point { position: Vec3::Y * 3.0, intensity: Rgb::ONE.into() }];
        walker(scene).warnings()
    };
    assert!(with_light(1.5, 0.0)[0].contains("material \"white\": walks cannot find lights without size"));
    assert!(with_light(1.0, 0.0).is_empty() && with_light(1.5, 0.3).is_empty());
}
