//! The distance from a point to a body is right to rounding, and no triangle is nearer than it says.

mod triangles;

use alabaster::math::sampler::HashGenerator;
use alabaster::raycast::{DistanceQuery, Geometry, MeshInstance};
use glam::{Affine3A, DVec3, Quat, Vec3};
use triangles::{Mesh, backends, grid_point, placed, soup};

/// Distance from the origin to a triangle by the region it is nearest to (Ericson 2005, "Real-Time Collision Detection",
/// section 5.1.5), in double precision.
fn exact_distance([a, b, c]: [DVec3; 3]) -> f64 {
    let (ab, ac, bc) = (b - a, c - a, c - b);
    let (d1, d2) = (ab.dot(-a), ac.dot(-a));
    let (d3, d4) = (ab.dot(-b), ac.dot(-b));
    let (d5, d6) = (ab.dot(-c), ac.dot(-c));
    // n·(x × y) instead of d1 d4 − d3 d2 and so on: the same numbers with fewer digits lost.
    let normal = ab.cross(ac);
    let (vc, vb, va) = (normal.dot(a.cross(b)), normal.dot(c.cross(a)), normal.dot(b.cross(c)));
    let nearest = if d1 <= 0.0 && d2 <= 0.0 {
        a
    } else if d3 >= 0.0 && d4 <= d3 {
        b
    } else if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        a + ab * (d1 / (d1 - d3))
    } else if d6 >= 0.0 && d5 <= d6 {
        c
    } else if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        a + ac * (d2 / (d2 - d6))
    } else if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        b + bc * ((d4 - d3) / ((d4 - d3) + (d5 - d6)))
    } else {
        (a * va + b * vb + c * vc) / (va + vb + vc)
    };
    nearest.length()
}

/// The corners of a triangle of `mesh` placed by `transform`, seen from `point`.
fn seen_from(point: Vec3, mesh: &Mesh, transform: &Affine3A, primitive: usize) -> [DVec3; 3] {
    let place = |corner: Vec3| transform.as_daffine3().transform_point3(corner.as_dvec3());
    mesh.corners(primitive).map(|corner| place(corner) - point.as_dvec3())
}

/// Asserts that `distance` is what the documentation promises for triangles seen from the point.
fn assert_promise(
    name: &str,
    query: &DistanceQuery,
    distance: f32,
    triangles: &[[DVec3; 3]],
    random: &mut HashGenerator,
) {
    let distance = f64::from(distance);
    let exact = triangles.iter().map(|&corners| exact_distance(corners)).fold(f64::INFINITY, f64::min);
    assert!(distance <= exact, "{name}: {distance:e} is above {exact:e}");
    let kept = 1.0 - f64::from(query.tolerance);
    // What has been found is nearer than exact/kept.
    let (least, matters) = (f64::from(query.least), 1.0 - 1e-9);
    assert!(
        distance == 0.0 || exact >= least * kept * matters,
        "{name}: {distance:e} where {exact:e} is enough"
    );
    if distance == 0.0 && exact < least {
        return;
    }
    // What is left of the digits of a thin triangle, √ε of its reach, can make another one the nearest.
    let rounding = f64::from(f32::EPSILON);
    let reach_of = |corners: &[DVec3; 3]| corners.iter().map(|corner| corner.length()).fold(0.0, f64::max);
    let error_of = |corners: &[DVec3; 3]| f64::EPSILON.sqrt() * reach_of(corners);
    let near =
        triangles.iter().filter(|corners| kept * exact_distance(**corners) <= exact + error_of(corners));
    let reach = near.map(reach_of).fold(0.0, f64::max);
    // Four roundings and that of the result; half a one of the reach.
    let slack = 5.0 * rounding * exact + (0.5 * rounding + f64::EPSILON.sqrt()) * reach;
    assert!(distance >= kept * exact - slack, "{name}: {distance:e} is too far below {exact:e}, {slack:e}");

    // The same from the other side, without a formula: no point of any triangle is nearer.
    for [a, b, c] in triangles {
        let (u, v) = (f64::from(random.next_f32()), f64::from(random.next_f32()));
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        let inside = a + (b - a) * u + (c - a) * v;
        assert!(inside.length() >= distance, "{name}");
    }
}

/// Exact, and as a walk may ask, in a world of size `scale`.
fn queries(point: Vec3, scale: f32) -> [DistanceQuery; 3] {
    let exact = DistanceQuery::exact(point);
    let coarse = DistanceQuery { tolerance: 0.25, ..exact };
    [exact, coarse, DistanceQuery { least: 0.1 * scale, ..coarse }]
}

/// Triangles of every kind: whole, thin by up to 10⁻⁹ of their length, without area.
fn awkward(random: &mut HashGenerator) -> Mesh {
    let mut mesh = soup(150, random);
    for thickness in [1e-3, 1e-6, 1e-9, 0.0] {
        for _ in 0..25 {
            let [start, end, aside] = [(); 3].map(|()| 1.5 * grid_point(random));
            let along = random.next_f32();
            mesh.push([start, end, start.lerp(end, along) + aside * thickness]);
        }
    }
    let point = grid_point(random);
    mesh.push([point; 3]);
    mesh
}

/// Points around a mesh, and near or on its triangles.
fn points(mesh: &Mesh, random: &mut HashGenerator) -> Vec<Vec3> {
    let mut points = vec![];
    for i in 0..120 {
        let [a, b, c] = mesh.corners(i * mesh.triangles.len() / 120);
        let (u, v) = (0.5 * random.next_f32(), 0.5 * random.next_f32());
        let on = a + (b - a) * u + (c - a) * v;
        points.extend([a, on, on + 1e-5 * grid_point(random), grid_point(random), 4.0 * grid_point(random)]);
    }
    points
}

#[test]
fn distances_hold_at_every_scale_and_offset() {
    let mut random = HashGenerator::new(1);
    for scale in [1e-4_f32, 1.0, 1e4] {
        for offset in [0.0, 1e3] {
            let offset = Vec3::new(offset, -0.3 * offset, 0.1 * offset);
            let mut mesh = awkward(&mut random);
            let points = points(&mesh, &mut random);
            mesh.positions.iter_mut().for_each(|position| *position = (*position + offset) * scale);
            for (name, caster) in placed(&mesh, &[Affine3A::IDENTITY]) {
                for point in points.iter().map(|point| (*point + offset) * scale) {
                    let seen = |i| seen_from(point, &mesh, &Affine3A::IDENTITY, i);
                    let triangles: Vec<_> = (0..mesh.triangles.len()).map(seen).collect();
                    for query in queries(point, scale) {
                        let distance = caster.distance_to_nearest(&query, 0);
                        assert_promise(name, &query, distance, &triangles, &mut random);
                    }
                }
            }
        }
    }
}

/// A mesh that several instances share is measured in the world, also where they shear, stretch and mirror it.
#[test]
fn distances_are_those_of_the_world() {
    let mut random = HashGenerator::new(2);
    let mesh = awkward(&mut random);
    let turned = Affine3A::from_rotation_translation(Quat::from_rotation_y(0.7), Vec3::new(0.3, -2.5, 0.2));
    let transforms = [
        turned,
        Affine3A::from_scale(Vec3::splat(0.1)) * turned,
        Affine3A::from_scale(Vec3::new(-3.0, 0.05, 1.0)) * turned,
    ];
    for (name, caster) in placed(&mesh, &transforms) {
        for (instance, transform) in (0..).zip(&transforms) {
            for local in points(&mesh, &mut random) {
                let point = transform.transform_point3(local);
                let triangles: Vec<_> =
                    (0..mesh.triangles.len()).map(|i| seen_from(point, &mesh, transform, i)).collect();
                for query in queries(point, 1.0) {
                    let distance = caster.distance_to_nearest(&query, instance);
                    assert_promise(name, &query, distance, &triangles, &mut random);
                }
            }
        }
    }
}

/// Only the instance that was asked about counts, and only what is within the limit.
#[test]
fn the_limit_and_the_instance_restrict_the_search() {
    let mut mesh = Mesh::default();
    mesh.push([Vec3::ZERO, Vec3::X, Vec3::Y]);
    let above = |z: f32| Affine3A::from_translation(z * Vec3::Z);
    let point = Vec3::new(0.25, 0.25, 4.0);
    let exact = DistanceQuery::exact(point);
    for (name, caster) in placed(&mesh, &[above(0.0), above(3.5)]) {
        for (instance, expected) in [(0, 4.0), (1, 0.5)] {
            let distance = caster.distance_to_nearest(&exact, instance);
            assert!(distance <= expected && distance > expected * (1.0 - 1e-6), "{name}: {distance}");
            let limited = DistanceQuery { limit: 0.25, ..exact };
            assert_eq!(caster.distance_to_nearest(&limited, instance), 0.25, "{name}");
            let more = DistanceQuery { least: 4.5, ..exact };
            assert_eq!(caster.distance_to_nearest(&more, instance), 0.0, "{name}");
        }
        let seven = DistanceQuery { limit: 7.0, ..exact };
        assert_eq!(caster.distance_to_nearest(&seven, 2), 7.0, "{name}: no such instance");
        for nothing in [0.0, -1.0, f32::NAN] {
            let query = DistanceQuery { limit: nothing, ..exact };
            assert_eq!(caster.distance_to_nearest(&query, 0), 0.0, "{name}");
        }
        for bad in [f32::NAN, f32::INFINITY] {
            let query = DistanceQuery { point: point.with_y(bad), ..exact };
            assert_eq!(caster.distance_to_nearest(&query, 0), 0.0, "{name}");
        }
    }
    let empty = MeshInstance { mesh: 0, transform: Affine3A::IDENTITY, probed: true };
    let mesh = Mesh::default();
    let geometry = Geometry { meshes: &[mesh.view()], instances: &[empty] };
    for (name, caster) in backends(&geometry) {
        assert_eq!(caster.distance_to_nearest(&exact, 0), f32::INFINITY, "{name}: nothing there");
    }
}

/// Triangles that are no triangles are no obstacle, and hierarchies as deep as they get are searched.
#[test]
fn broken_and_pathological_meshes_are_searched() {
    let corners = [Vec3::new(0.0, 0.0, 1.0), Vec3::new(1.0, 0.0, 1.0), Vec3::new(0.0, 1.0, 1.0)];
    let (mut copies, mut powers, mut broken) = (Mesh::default(), Mesh::default(), Mesh::default());
    (0..20_000).for_each(|_| copies.push(corners));
    (-20..20).for_each(|power| powers.push(corners.map(|corner| corner * 2.0_f32.powi(power))));
    for bad in [f32::NAN, f32::INFINITY] {
        broken.push([corners[0], corners[1], Vec3::splat(bad)]);
    }
    broken.push(corners);
    let nearest_power = 2.0_f32.powi(-20);
    for (mesh, exact) in [(copies, 1.0), (powers, nearest_power), (broken, 1.0)] {
        for (name, caster) in placed(&mesh, &[Affine3A::IDENTITY]) {
            let distance = caster.distance_to_nearest(&DistanceQuery::exact(Vec3::ZERO), 0);
            assert!(distance <= exact && distance > exact * (1.0 - 1e-6), "{name}: {distance}, not {exact}");
        }
    }
}

/// On a sphere of many triangles the distance is known.
#[test]
fn distances_inside_a_sphere_are_those_to_its_surface() {
    let mut mesh = Mesh::default();
    let sphere = alabaster::scene::shape::sphere(Vec3::ZERO, 1.0, 5);
    mesh.positions = sphere.positions;
    mesh.triangles = sphere.triangles;
    let mut random = HashGenerator::new(3);
    // The middle of an edge of length l is l²/8 below the sphere, the middle of a triangle at most l²/6.
    let longest = mesh
        .triangles
        .iter()
        .map(|&[i, j, _]| mesh.positions[i as usize].distance(mesh.positions[j as usize]));
    let sagitta = longest.fold(0.0, f32::max).powi(2) / 6.0;
    for (name, caster) in placed(&mesh, &[Affine3A::IDENTITY]) {
        for _ in 0..2000 {
            let point = 0.57 * grid_point(&mut random);
            let distance = caster.distance_to_nearest(&DistanceQuery::exact(point), 0);
            let exact = 1.0 - point.length();
            assert!(
                (exact - 1.5 * sagitta..=exact + 1e-6).contains(&distance),
                "{name}: {distance}, {exact}"
            );
        }
    }
}
