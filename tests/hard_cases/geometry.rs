//! Meshes that are broken, nested, coincident or bumpy.

use alabaster::math::quadrature::GaussLegendre;
use alabaster::math::sampler::HashGenerator;
use alabaster::radiometry::Rgb;
use alabaster::scene::{ColorInput, Instance, Material, Mesh, Method, Surface, shape};
use glam::{Affine3A, DVec3, Vec3};

use crate::common::backends::{Films, Pictures, Rays, by, on_backends, relative_difference};
use crate::common::scenes::{body, furnace, join, white};
use crate::common::walks::{Found, walker};
use crate::lights::under_uneven_sky;
use crate::media::translucent;
use crate::record::{assert_fails, record};

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

/// Cubes in one piece, in two parts that overlap, and in two that touch, each where its coordinates round differently.
#[test]
fn surfaces_that_coincide() {
    const SIDE: i32 = 8;
    const RAYS: u64 = 60_000;
    let center = |cube: i32| {
        let mut random = HashGenerator::new(cube as u64);
        let [x, y, z] =
            [cube / (SIDE * SIDE), cube / SIDE % SIDE, cube % SIDE].map(|i| 3.0 * (i - SIDE / 2) as f32);
        Vec3::new(x, y, z) + Vec3::from([(); 3].map(|()| 0.2 * random.next_f32()))
    };
    let scene = |parts: &[(f32, f32)], sigma_a: Rgb| {
        let mut scene = furnace(Mesh::default(), translucent(1.0, sigma_a, Rgb::new(3.0, 4.0, 2.0), 0.0));
        (scene.meshes, scene.instances) = (Vec::new(), Vec::new());
        for (cube, (x, width)) in
            (0..SIDE.pow(3)).flat_map(|cube| parts.iter().map(move |part| (cube, *part)))
        {
            let transform = Affine3A::IDENTITY;
            scene.instances.push(Instance {
                name: "part".into(),
                mesh: scene.meshes.len(),
                material: 0,
                transform,
            });
            scene.meshes.push(shape::cuboid(center(cube) + Vec3::X * x, Vec3::new(width, 1.0, 1.0)));
        }
        scene
    };
    let ray = |sample: u64| {
        let mut random = HashGenerator::new(1_000_000 + sample);
        let [x, y] = [(); 2].map(|()| 0.9 * (random.next_f32() - 0.5));
        let offset = Vec3::new(1.0, 0.8, 0.9);
        (center((sample % SIDE.pow(3) as u64) as i32) + offset, (Vec3::new(x, y, 0.0) - offset).normalize())
    };
    let work = Rays(RAYS, ray);
    let absorbing = Rgb::new(0.3, 0.1, 0.6);
    let lit = |parts: &[(f32, f32)]| {
        on_backends(&under_uneven_sky(scene(parts, absorbing)), by(Method::Walk), &work)
    };
    let (whole, overlapping) = (lit(&[(0.0, 1.0)]), lit(&[(-0.2495, 0.501), (0.2495, 0.501)]));
    let touching = [(-0.25, 0.5), (0.25, 0.5)];
    let mut figure = String::new();
    for (((backend, whole), (_, overlapping)), (_, touching)) in
        whole.iter().zip(&overlapping).zip(&lit(&touching))
    {
        let difference = pull(overlapping, whole);
        assert!(difference.abs() < 3.0, "{backend}: {difference} σ");
        assert_eq!((overlapping.counters.rejected, touching.counters.rejected), (0, 0), "{backend}");
        // Along the seam the outer faces of the two parts lie in one plane.
        assert!(overlapping.counters.open_walks < RAYS / 200, "{}", overlapping.counters.open_walks);
        figure = format!(
            "parts that overlap by 10⁻³: {difference:+.1} σ; that touch: {:+.1} % of the flux, {:.0} % of the walks meet no surface and are told of",
            100.0 * (touching.mean.mean() / whole.mean.mean() - 1.0),
            100.0 * touching.counters.open_walks as f64 / RAYS as f64
        );
    }
    // What is lost of the medium between parts that touch makes no light.
    for (backend, found) in on_backends(&scene(&touching, Rgb::ZERO), by(Method::Walk), &work) {
        let (mean, sigma) = (found.mean.mean(), found.mean.standard_error());
        assert!((mean - 1.0).abs() < 3.0 * sigma + 1e-4, "{backend}: {mean} ± {sigma}");
        assert_eq!((found.counters.rejected, found.counters.capped_paths), (0, 0), "{backend}");
    }
    record("surfaces_that_coincide", figure);
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
    let mut farthest = 0.0_f64;
    for (name, material, method) in materials {
        for (backend, found) in on_backends(&furnace(bumped.clone(), material), by(method), &Pictures(32)) {
            let (mean, sigma) = (found.mean.mean(), found.mean.standard_error());
            assert!((mean - 1.0).abs() < 3.0 * sigma + 1e-4, "{name} {method:?} {backend}: {mean} ± {sigma}");
            assert_eq!(found.counters.rejected, 0, "{name}");
            farthest = farthest.max((mean - 1.0).abs());
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
    let pairs = on_backends(&shaded(smooth), by(Method::Bssrdf), &Pictures(64));
    let flats = on_backends(&shaded(flat), by(Method::Bssrdf), &Pictures(64));
    let mut bias = 0.0_f64;
    for ((_, smooth), (_, flat)) in pairs.iter().zip(&flats) {
        bias = bias.max((flat.mean.mean() / smooth.mean.mean() - 1.0).abs());
    }
    // Facets of 4° tilt normals by 2° at most, alike to all sides.
    assert!(bias < 5e-3, "{bias}");
    record(
        "bumped_normals",
        format!(
            "furnace {farthest:.0e}; lobe cut at 60° keeps {:.0} %; flat against smooth {:.2} %",
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
    let mut figure = String::new();
    for method in [Method::Bssrdf, Method::Walk] {
        let [whole, slivers] = [&sphere, &slivered].map(|mesh| {
            on_backends(&under_uneven_sky(furnace(mesh.clone(), material())), by(method), &Films(64))
        });
        for ((backend, (whole, _)), (_, (slivers, counters))) in whole.iter().zip(&slivers) {
            let (difference, noise) = relative_difference(slivers, whole);
            // Of 576 pixels and three channels, which are not independent.
            let allowed = 1.0 + 3.0 * (2.0 / 576.0_f64).sqrt();
            assert!(difference < allowed * noise, "{method:?} {backend}: {difference} {noise}");
            assert_eq!((slivers.tally().nonfinite, counters.rejected, counters.capped_paths), (0, 0, 0));
            figure = format!("difference {:.2} of what noise makes", difference / noise);
        }
    }
    record("slivers", format!("{figure}; {naive} normals would be no numbers"));
}

/// Bodies of no triangle, one triangle, one point.
#[test]
fn bodies_of_next_to_nothing() {
    let one =
        Mesh { positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y], triangles: vec![[0, 1, 2]], ..Mesh::default() };
    let point = Mesh { triangles: vec![[0, 0, 0]; 3], ..one.clone() };
    let line = Mesh { positions: vec![Vec3::ZERO, Vec3::X, Vec3::X * 0.5], ..one.clone() };
    let mut farthest = 0.0_f64;
    for (name, mesh) in [("nothing", Mesh::default()), ("triangle", one), ("point", point), ("line", line)] {
        for method in [Method::Auto, Method::Bssrdf, Method::Walk, Method::Diffuse] {
            for ior in [1.0, 1.5] {
                let scene = furnace(mesh.clone(), white(ior, 0.0, Rgb::new(1.0, 5.0, 25.0)));
                for (backend, found) in on_backends(&scene, by(method), &Pictures(8)) {
                    let (mean, sigma) = (found.mean.mean(), found.mean.standard_error());
                    assert!(
                        (mean - 1.0).abs() < 3.0 * sigma + 1e-4,
                        "{name} {method:?} {backend}: {mean} ± {sigma}"
                    );
                    assert_eq!(
                        (found.counters.capped_paths, found.counters.rejected),
                        (0, 0),
                        "{name} {method:?}"
                    );
                    farthest = farthest.max((mean - 1.0).abs());
                }
            }
        }
    }
    record("bodies_of_next_to_nothing", format!("furnace: {farthest:.0e}"));
}

/// The same picture, and walks say so.
#[test]
fn flipped_normals() {
    let sphere = shape::sphere(Vec3::ZERO, 1.0, 4);
    let scene = |mesh: Mesh| {
        under_uneven_sky(furnace(
            mesh,
            translucent(1.4, Rgb::new(0.1, 0.3, 0.6), Rgb::new(10.0, 12.0, 8.0), 0.0),
        ))
    };
    let flipped = scene(inverted(sphere.clone()));
    let warnings = walker(flipped.clone()).warnings();
    assert!(warnings.iter().any(|warning| warning.contains("inside out")), "{warnings:?}");
    let mut figure = String::new();
    for method in [Method::Bssrdf, Method::Walk] {
        let right = on_backends(&scene(sphere.clone()), by(method), &Pictures(64));
        let flipped = on_backends(&flipped, by(method), &Pictures(64));
        for ((backend, right), (_, flipped)) in right.iter().zip(&flipped) {
            let difference = pull(flipped, right);
            assert!(difference.abs() < 3.0, "{method:?} {backend}: {difference} σ");
            figure =
                format!("{:.4} against {:.4}: {difference:+.1} σ", flipped.mean.mean(), right.mean.mean());
        }
    }
    record("flipped_normals", figure);
}

/// A ball in a ball in a ball, ten deep, each of another medium.
#[test]
fn bodies_in_bodies() {
    let mut figure = String::new();
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
            for (backend, found) in on_backends(&scene, by(method), &Pictures(12)) {
                let (mean, sigma) = (found.mean.mean(), found.mean.standard_error());
                let name = format!("{depth} balls {method:?} {backend}");
                assert!(
                    (mean - 1.0).abs() < 1e-3 && (mean - 1.0).abs() < 3.0 * sigma + 1e-4,
                    "{name}: {mean} ± {sigma}"
                );
                assert_eq!(found.counters.capped_paths, 0, "{name}");
                figure = format!("{depth} deep: {mean:.5} ± {sigma:.5}");
            }
        }
    }
    record("bodies_in_bodies", figure);
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
    let mut figure = String::new();
    for (backend, found) in on_backends(&furnace(shell, material), by(Method::Walk), &Rays(PATHS, through)) {
        let (mean, sigma) = (found.mean.mean(), found.mean.standard_error().hypot(exact_sigma));
        // Facets are within 8·10⁻⁵ of the spheres: so many free paths, each of which absorbs a fifth.
        let holds = |mean: f64| (mean - exact).abs() < 3.0 * sigma + 8e-5 * 4.0;
        assert!(holds(mean), "{backend}: {mean} ± {sigma}, {exact}");
        assert_fails("the hollow filled", solid, holds);
        figure = format!("{mean:.4} ± {sigma:.4}, in double precision {exact:.4}; filled {solid:.4}");
    }
    record("hollow_in_the_same_mesh", figure);
}
