//! Meshes that are broken, nested, coincident or bumpy.

use alabaster::math::quadrature::GaussLegendre;
use alabaster::math::sampler::HashGenerator;
use alabaster::radiometry::Rgb;
use alabaster::scene::{ColorInput, Instance, Material, Mesh, Method, Scene, Surface, shape};
use alabaster::transport::Renderer;
use glam::{Affine3A, DVec3, Vec3};

use crate::common::backends::{Films, Pictures, Rays, by, relative_difference, renderings};
use crate::common::scenes::{body, caster, furnace, join, white};
use crate::common::walks::Found;
use crate::lights::under_uneven_sky;
use crate::media::translucent;
use crate::record::{Figures, Largest, assert_fails, record};

/// `mesh` turned inside out.
fn inverted(mesh: Mesh) -> Mesh {
    let mut mesh = mesh;
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh.normals.iter_mut().for_each(|n| *n = -*n);
    mesh
}

/// The difference of two means in units of its standard error.
fn pull(a: &Found, b: &Found) -> f64 {
    (a.mean.mean() - b.mean.mean()) / a.mean.standard_error().hypot(b.mean.standard_error())
}

/// Side of a grid of cubes, each where its coordinates round differently.
const SIDE: i32 = 8;
const RAYS: u64 = 60_000;

/// The middle of a cube.
fn center(cube: i32) -> Vec3 {
    let mut random = HashGenerator::new(cube as u64);
    let [x, y, z] =
        [cube / (SIDE * SIDE), cube / SIDE % SIDE, cube % SIDE].map(|i| 3.0 * (i - SIDE / 2) as f32);
    Vec3::new(x, y, z) + Vec3::from([(); 3].map(|()| 0.2 * random.next_f32()))
}

/// Cubes made of `parts`, which lie at x and have a width; part i is of material i, or of the last.
fn cubes(parts: &[(f32, f32)], materials: &[Material]) -> Scene {
    let mut scene = furnace(Mesh::default(), Material::default());
    (scene.meshes, scene.instances, scene.materials) = (Vec::new(), Vec::new(), materials.to_vec());
    for cube in 0..SIDE.pow(3) {
        for (part, &(x, width)) in parts.iter().enumerate() {
            scene.instances.push(Instance {
                name: "part".into(),
                mesh: scene.meshes.len(),
                material: part.min(materials.len() - 1),
                transform: Affine3A::IDENTITY,
            });
            scene.meshes.push(shape::cuboid(center(cube) + Vec3::X * x, Vec3::new(width, 1.0, 1.0)));
        }
    }
    scene
}

/// A ray to the middle of some cube.
fn to_a_cube(sample: u64) -> (Vec3, Vec3) {
    let mut random = HashGenerator::new(1_000_000 + sample);
    let [x, y] = [(); 2].map(|()| 0.9 * (random.next_f32() - 0.5));
    let offset = Vec3::new(1.0, 0.8, 0.9);
    (center((sample % SIDE.pow(3) as u64) as i32) + offset, (Vec3::new(x, y, 0.0) - offset).normalize())
}

/// Cubes in one piece, in two parts that overlap, and in two that touch: all the same.
#[test]
fn surfaces_that_coincide() {
    let work = Rays(RAYS, to_a_cube);
    let lit = |parts: &[(f32, f32)], ior: f32| {
        let material = translucent(ior, Rgb::new(0.3, 0.1, 0.6), Rgb::new(3.0, 4.0, 2.0), 0.0);
        renderings(&under_uneven_sky(cubes(parts, &[material])), by(Method::Walk), &work)
    };
    let mut figures = Vec::new();
    let (whole, touching) = ([(0.0, 1.0)], [(-0.25, 0.5), (0.25, 0.5)]);
    for (what, ior, parts) in [
        ("that overlap by 10⁻³", 1.0, [(-0.2495, 0.501), (0.2495, 0.501)]),
        ("that touch", 1.0, touching),
        ("that touch and refract", 1.4, touching),
    ] {
        for ((setup, whole), (_, parted)) in lit(&whole, ior).iter().zip(&lit(&parts, ior)) {
            let difference = pull(parted, whole);
            println!("{what} {setup}: {difference:+.2} σ, {:?}", parted.counters);
            assert!(difference.abs() < 3.0, "{what} {setup}: {difference} σ");
            assert_eq!((parted.counters.rejected, parted.counters.capped_paths), (0, 0), "{setup}");
            // Along the seam the outer faces of the two parts lie in one plane.
            let share = parted.counters.open_walks as f64 / parted.mean.count();
            assert!(share < 0.005, "{setup}: {share}");
            if let Some(mode) = setup.recorded() {
                figures.push(format!("{mode}, parts {what}: {difference:+.1} σ"));
            }
        }
    }
    // Of two indices, one boundary between them.
    let materials = [1.5, 1.2].map(|ior| translucent(ior, Rgb::ZERO, Rgb::new(3.0, 4.0, 2.0), 0.0));
    for (setup, found) in renderings(&cubes(&touching, &materials), by(Method::Walk), &work) {
        let (mean, sigma) = (found.mean.mean(), found.mean.standard_error());
        assert!((mean - 1.0).abs() < 3.0 * sigma + 1e-4, "{setup}: {mean} ± {sigma}");
        assert_eq!((found.counters.rejected, found.counters.capped_paths), (0, 0), "{setup}");
        let share = found.counters.open_walks as f64 / found.mean.count();
        assert!(share < 0.005, "{setup}: {share}");
    }
    record("surfaces_that_coincide", figures.join("; "));
}

/// Interpolated normals up to some 60° off.
#[test]
fn bumped_normals() {
    let smooth = shape::sphere(Vec3::ZERO, 1.0, 4);
    let mut random = HashGenerator::new(2);
    let mut bump = |normal: &Vec3| {
        let [x, y, z] = [(); 3].map(|()| 2.0 * random.next_f32() - 1.0);
        (*normal + 0.9 * Vec3::new(x, y, z)).normalize()
    };
    let bumped = Mesh { normals: smooth.normals.iter().map(&mut bump).collect(), ..smooth.clone() };
    let flat = Mesh { normals: vec![], ..smooth.clone() };
    let diffuse = Material {
        surface: Surface::Diffuse { reflectance: ColorInput::constant(Rgb::ONE) },
        emission: ColorInput::constant(Rgb::ZERO),
        ..Material::default()
    };
    let materials = [
        ("diffuse", diffuse, Method::Bssrdf),
        ("smooth", body(1.5, 0.0, 0.2), Method::Bssrdf),
        ("rough", body(1.5, 0.5, 0.2), Method::Bssrdf),
        ("matched", body(1.0, 0.0, 0.2), Method::Walk),
        ("smooth", body(1.5, 0.0, 0.2), Method::Walk),
    ];
    let mut farthest = Largest::default();
    for (name, material, method) in materials {
        for (setup, found) in renderings(&furnace(bumped.clone(), material), by(method), &Pictures(32)) {
            let (mean, sigma) = (found.mean.mean(), found.mean.standard_error());
            assert!((mean - 1.0).abs() < 3.0 * sigma + 1e-4, "{name} {method:?} {setup}: {mean} ± {sigma}");
            assert_eq!(found.counters.rejected, 0, "{name}");
            farthest.add(setup, (mean - 1.0).abs());
        }
    }
    // Lambert around a normal 60° off loses what goes below the surface: (1 − cos 60°)/2.
    let above = GaussLegendre::new(200).integrate(0.0, std::f64::consts::PI, |phi| {
        // Half of the lobe's disk, cut by the line where the surface is: an ellipse of half axis cos 60°.
        let edge: f64 = if phi.cos() < 0.0 {
            (0.25 / (0.25 * phi.sin().powi(2) + phi.cos().powi(2))).sqrt()
        } else {
            1.0
        };
        edge * edge / std::f64::consts::PI
    });
    assert_fails("a lobe cut at the surface", above, |mean| (mean - 1.0).abs() < 1e-3);

    let shaded = |mesh: Mesh| under_uneven_sky(furnace(mesh, body(1.0, 0.0, 0.1)));
    let pairs = renderings(&shaded(smooth), by(Method::Bssrdf), &Pictures(64));
    let flats = renderings(&shaded(flat), by(Method::Bssrdf), &Pictures(64));
    let mut bias = 0.0_f64;
    for ((_, smooth), (_, flat)) in pairs.iter().zip(&flats) {
        bias = bias.max((flat.mean.mean() / smooth.mean.mean() - 1.0).abs());
    }
    // Facets of 4° tilt normals by 2° at most, alike to all sides.
    assert!(bias < 5e-3, "{bias}");
    record(
        "bumped_normals",
        format!(
            "furnace {}; lobe cut at 60° keeps {:.0} %; flat against smooth {:.2} %",
            farthest.written(),
            100.0 * above,
            100.0 * bias
        ),
    );
}

/// Ten thousand triangles without area, or with next to none, on the edges of a sphere's own.
#[test]
fn slivers() {
    let sphere = shape::sphere(Vec3::ZERO, 1.0, 5);
    let mut slivered = sphere.clone();
    let mut random = HashGenerator::new(4);
    for i in 0..10_000 {
        let triangle = sphere.triangles[(random.next_f32() * sphere.triangles.len() as f32) as usize];
        let [a, b] = [triangle[0], triangle[1]];
        let (p, q) = (sphere.positions[a as usize], sphere.positions[b as usize]);
        let across = p.cross(q).normalize();
        let middle = p.lerp(q, random.next_f32()) + across * [0.0, 1e-7, 1e-12][i % 3];
        let new = slivered.positions.len() as u32;
        slivered.positions.push(middle);
        slivered.normals.push(middle.normalize());
        slivered.triangles.push(if i % 2 == 0 { [a, b, new] } else { [b, a, new] });
    }
    let corners = |t: &[u32; 3]| t.map(|v| slivered.positions[v as usize]);
    let normal = |[a, b, c]: [Vec3; 3]| (b - a).cross(c - a).normalize();
    let naive = slivered.triangles.iter().filter(|t| !normal(corners(t)).is_finite()).count();
    assert_fails("normal of single-precision edges", naive, |count| count == 0);
    let material = || translucent(1.4, Rgb::new(0.1, 0.3, 0.6), Rgb::new(10.0, 12.0, 8.0), 0.0);
    let mut figure = Figures::default();
    for method in [Method::Bssrdf, Method::Walk] {
        let [whole, slivers] = [&sphere, &slivered].map(|mesh| {
            renderings(&under_uneven_sky(furnace(mesh.clone(), material())), by(method), &Films(64))
        });
        for ((setup, (whole, _)), (_, (slivers, counters))) in whole.iter().zip(&slivers) {
            let (difference, noise) = relative_difference(slivers, whole);
            // Of 576 pixels and three channels, which are not independent.
            let allowed = 1.0 + 3.0 * (2.0 / 576.0_f64).sqrt();
            assert!(difference < allowed * noise, "{method:?} {setup}: {difference} {noise}");
            assert_eq!((slivers.tally().nonfinite, counters.rejected, counters.capped_paths), (0, 0, 0));
            figure.keep(*setup, format!("difference {:.2} of what noise makes", difference / noise));
        }
    }
    record("slivers", format!("{}; {naive} normals would be no numbers", figure.written()));
}

/// Bodies of no triangle, one triangle, one point.
#[test]
fn bodies_of_next_to_nothing() {
    let one =
        Mesh { positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y], triangles: vec![[0, 1, 2]], ..Mesh::default() };
    let point = Mesh { triangles: vec![[0, 0, 0]; 3], ..one.clone() };
    let line = Mesh { positions: vec![Vec3::ZERO, Vec3::X, Vec3::X * 0.5], ..one.clone() };
    let mut farthest = Largest::default();
    for (name, mesh) in [("nothing", Mesh::default()), ("triangle", one), ("point", point), ("line", line)] {
        for method in [Method::Auto, Method::Bssrdf, Method::Walk, Method::Diffuse] {
            for ior in [1.0, 1.5] {
                let scene = furnace(mesh.clone(), white(ior, 0.0, Rgb::new(1.0, 5.0, 25.0)));
                for (setup, found) in renderings(&scene, by(method), &Pictures(8)) {
                    let (mean, sigma) = (found.mean.mean(), found.mean.standard_error());
                    assert!(
                        (mean - 1.0).abs() < 3.0 * sigma + 1e-4,
                        "{name} {method:?} {setup}: {mean} ± {sigma}"
                    );
                    assert_eq!(
                        (found.counters.capped_paths, found.counters.rejected),
                        (0, 0),
                        "{name} {method:?}"
                    );
                    farthest.add(setup, (mean - 1.0).abs());
                }
            }
        }
    }
    record("bodies_of_next_to_nothing", format!("furnace: {}", farthest.written()));
}

/// The same picture, and a warning, whether the triangles are wound the wrong way, their normals turned, or both.
#[test]
fn flipped_normals() {
    let sphere = shape::sphere(Vec3::ZERO, 1.0, 4);
    let flipped = inverted(sphere.clone());
    let wound = Mesh { normals: sphere.normals.clone(), ..flipped.clone() };
    let turned = Mesh { normals: flipped.normals.clone(), ..sphere.clone() };
    let scene = |mesh: &Mesh| {
        under_uneven_sky(furnace(
            mesh.clone(),
            translucent(1.4, Rgb::new(0.1, 0.3, 0.6), Rgb::new(10.0, 12.0, 8.0), 0.0),
        ))
    };
    let mut figures = Vec::new();
    for method in [Method::Bssrdf, Method::Walk] {
        let right = renderings(&scene(&sphere), by(method), &Films(32));
        for (name, mesh, is_told) in
            [("flipped", &flipped, true), ("wound", &wound, true), ("turned", &turned, false)]
        {
            let warnings = Renderer::new(scene(mesh), by(method), caster).unwrap().warnings();
            let tells = warnings.iter().any(|warning| warning.contains("inside out"));
            assert_eq!(tells, is_told, "{name} {method:?}: {warnings:?}");
            let flipped = renderings(&scene(mesh), by(method), &Films(32));
            for ((setup, (right, _)), (_, (flipped, counters))) in right.iter().zip(&flipped) {
                let (difference, noise) = relative_difference(flipped, right);
                let ratio = difference / noise;
                println!("{name} {method:?} {setup}: {ratio}");
                assert!(ratio < 2.0, "{name} {method:?} {setup}: {ratio}");
                assert_eq!((flipped.tally().nonfinite, counters.capped_paths), (0, 0));
                if let (Some(mode), "flipped") = (setup.recorded(), name) {
                    figures.push(format!("{mode} by {}: {ratio:.2}", method.name()));
                }
            }
        }
    }
    record("flipped_normals", format!("relMSE over that of noise, {}", figures.join(", ")));
}

/// A ball in a ball in a ball, ten deep, each of another medium.
#[test]
fn bodies_in_bodies() {
    let mut figure = Figures::default();
    for (depth, ior) in [(2, 1.5), (3, 1.2), (10, 1.0)] {
        let mut scene = furnace(Mesh::default(), white(1.0, 0.0, Rgb::ONE));
        scene.meshes.clear();
        scene.instances.clear();
        scene.materials.clear();
        for level in 0..depth {
            let radius = 1.0 - 0.8 * level as f32 / depth as f32;
            let index = 1.0 + (ior - 1.0) * (1 + level % 2) as f32;
            scene.meshes.push(shape::sphere(Vec3::ZERO, radius, 4));
            scene.materials.push(white(index, 0.0, Rgb::new(2.0, 3.0, 1.0) * (1 + level) as f32));
            let name = format!("ball {level}");
            scene.instances.push(Instance {
                name,
                mesh: level,
                material: level,
                transform: Affine3A::IDENTITY,
            });
        }
        for method in [Method::Walk, Method::Bssrdf] {
            for (setup, found) in renderings(&scene, by(method), &Pictures(12)) {
                let (mean, sigma) = (found.mean.mean(), found.mean.standard_error());
                let name = format!("{depth} balls {method:?} {setup}");
                assert!(
                    (mean - 1.0).abs() < f64::max(1e-3, 3.0 * sigma)
                        && (mean - 1.0).abs() < 3.0 * sigma + 1e-4,
                    "{name}: {mean} ± {sigma}"
                );
                assert_eq!(found.counters.capped_paths, 0, "{name}");
                figure.keep(setup, format!("{depth} deep: {mean:.5} ± {sigma:.5}"));
            }
        }
    }
    record("bodies_in_bodies", figure.written());
}

/// What comes back along a ray through the middle of a sphere with a hollow, in even light, in double precision: the shape is a
/// formula, there is no mesh and no offset.
fn exact_shell(hollow: f64, sigma_t: f64, albedo: f64, paths: u64) -> (f64, f64) {
    let mut random = HashGenerator::new(77);
    let mut statistics = crate::common::scenes::Statistics::default();
    let crossing = |p: DVec3, w: DVec3, radius: f64| {
        let (b, c) = (p.dot(w), p.length_squared() - radius * radius);
        let root = (b * b - c).max(0.0).sqrt();
        (b * b > c).then_some((-b - root, -b + root))
    };
    for _ in 0..paths {
        let (mut p, mut w, mut weight) = (DVec3::X, DVec3::NEG_X, 1.0);
        loop {
            let (_, out) = crossing(p, w, 1.0).unwrap_or((0.0, 0.0));
            let mut left = f64::from(random.next_exponential()) / sigma_t;
            if let Some((near, far)) = crossing(p, w, hollow).filter(|(near, _)| *near > 0.0)
                && left > near
            {
                // Nothing scatters in the hollow.
                left += far - near;
            }
            if left >= out {
                break;
            }
            p += w * left;
            weight *= albedo;
            let z = 2.0 * f64::from(random.next_f32()) - 1.0;
            let (sin, cos) = (std::f64::consts::TAU * f64::from(random.next_f32())).sin_cos();
            let r = (1.0 - z * z).sqrt();
            w = DVec3::new(r * cos, r * sin, z);
        }
        statistics.add(weight);
    }
    (statistics.mean(), statistics.standard_error())
}

#[test]
fn hollow_in_the_same_mesh() {
    const PATHS: u64 = 400_000;
    let (sigma_t, albedo, hollow) = (4.0, 0.8, 0.6);
    let shell = join([shape::sphere(Vec3::ZERO, 1.0, 6), inverted(shape::sphere(Vec3::ZERO, hollow, 6))]);
    let material = translucent(1.0, Rgb::splat(sigma_t * (1.0 - albedo)), Rgb::splat(sigma_t * albedo), 0.0);
    let (exact, exact_sigma) = exact_shell(hollow.into(), sigma_t.into(), albedo.into(), PATHS);
    let (solid, _) = exact_shell(1e-9, sigma_t.into(), albedo.into(), PATHS);
    let through = |_: u64| (Vec3::X * 3.0, Vec3::NEG_X);
    let mut figure = Figures::default();
    for (setup, found) in renderings(&furnace(shell, material), by(Method::Walk), &Rays(PATHS, through)) {
        let (mean, sigma) = (found.mean.mean(), found.mean.standard_error().hypot(exact_sigma));
        // Facets are within 8·10⁻⁵ of the spheres: so many free paths, each of which absorbs a fifth.
        let holds = |mean: f64| (mean - exact).abs() < 3.0 * sigma + 8e-5 * 4.0;
        assert!(holds(mean), "{setup}: {mean} ± {sigma}, {exact}");
        assert_fails("the hollow filled", solid, holds);
        figure.keep(
            setup,
            format!("{mean:.4} ± {sigma:.4}, in double precision {exact:.4}; filled {solid:.4}"),
        );
    }
    record("hollow_in_the_same_mesh", figure.written());
}
