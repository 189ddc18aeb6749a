//! All-hits queries report every sheet that a probe segment crosses, each exactly once.

mod triangles;

use alabaster::math::sampler::HashGenerator;
use alabaster::raycast::{Geometry, Hit, MeshInstance, Ray, RayCaster};
use glam::{Affine3A, Vec3};
use triangles::{Mesh, backends, cross, grid_point, placed};

/// Parallel squares [−1, 1]² at z = 1, 2, …, `count`; square k consists of the triangles 2k and 2k + 1,
/// which share the diagonal x = y.
fn comb(count: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for sheet in 0..count {
        let z = (sheet + 1) as f32;
        let corner = |x: f32, y: f32| Vec3::new(x, y, z);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
        mesh.triangles.push([first, first + 1, first + 2]);
        mesh.triangles.push([first, first + 2, first + 3]);
    }
    mesh
}

/// Whether the parameter is the expected one, but for half a dozen roundings of numbers that are not larger: where it is exact
/// by division, it may not be by a reciprocal, of which each processor has its own estimate.
fn is_near(hit: &Hit, expected: f32) -> bool {
    (hit.t - expected).abs() <= 3.0 * f32::EPSILON * expected
}

fn all_hits(caster: &dyn RayCaster, ray: &Ray) -> Vec<Hit> {
    let mut hits = vec![Hit { t: 0.0, u: 0.0, v: 0.0, instance: 7, primitive: 7 }];
    caster.all_hits(ray, 0, &mut hits);
    hits.sort_by(|a, b| a.t.total_cmp(&b.t));
    hits
}

/// Casts slanted segments through the lower triangles of `sheets` sheets, in steps that make the sheets'
/// parameters known, and expects each sheet once, where it is.
fn assert_each_sheet_once(sheets: u32) {
    let mesh = comb(sheets);
    let alone = placed(&mesh, &[Affine3A::IDENTITY]);
    let instanced = placed(&mesh, &[Affine3A::IDENTITY, Affine3A::from_translation(100.0 * Vec3::X)]);
    for (name, caster) in alone.iter().chain(&instanced) {
        let mut random = HashGenerator::new(1);
        for _ in 0..100 {
            let (x, y) = (0.3 + 0.3 * random.next_f32(), -0.3 - 0.3 * random.next_f32());
            let slant = 0.3 / sheets as f32;
            let ray = Ray {
                origin: Vec3::new(x, y, 0.0),
                direction: Vec3::new(slant * random.next_f32(), -slant * random.next_f32(), 1.0),
                t_max: sheets as f32 + 0.5,
            };
            let hits = all_hits(caster.as_ref(), &ray);
            assert_eq!(hits.len(), sheets as usize, "{name}: {ray:?}");
            for (sheet, hit) in (0..).zip(&hits) {
                assert_eq!(hit.primitive, 2 * sheet, "{name}: {ray:?}");
                let crossing = cross(&ray, mesh.corners(hit.primitive as usize));
                assert!(crossing.agrees(hit), "{name}: {hit:?}, should be {crossing:?}");
            }
        }
    }
}

#[test]
fn each_of_64_sheets_is_found_once() {
    assert_each_sheet_once(64);
}

#[test]
fn each_of_1000_sheets_is_found_once() {
    assert_each_sheet_once(1000);
}

#[test]
fn a_segment_ends_at_its_end() {
    for (name, caster) in placed(&comb(64), &[Affine3A::IDENTITY]) {
        for sheets in 0..=64 {
            let ray =
                Ray { origin: Vec3::new(0.5, 0.0, 0.0), direction: Vec3::Z, t_max: sheets as f32 + 0.5 };
            assert_eq!(all_hits(caster.as_ref(), &ray).len(), sheets, "{name}");
        }
    }
}

/// The diagonal belongs to both triangles of a square: a segment through it may report either or both,
/// but must not slip through, nor report one of them twice.
#[test]
fn a_shared_edge_is_reported_once_or_for_both_triangles() {
    for (name, caster) in placed(&comb(64), &[Affine3A::IDENTITY]) {
        for step in -50..=50 {
            let diagonal = step as f32 / 64.0;
            let ray = Ray { origin: Vec3::new(diagonal, diagonal, 0.0), direction: Vec3::Z, t_max: 64.5 };
            let hits = all_hits(caster.as_ref(), &ray);
            for sheet in 0..64 {
                let on_sheet: Vec<_> = hits.iter().filter(|hit| hit.primitive / 2 == sheet).collect();
                assert!((1..=2).contains(&on_sheet.len()), "{name}: {diagonal}: {on_sheet:?}");
                assert!(on_sheet.len() < 2 || on_sheet[0].primitive != on_sheet[1].primitive, "{name}");
                assert!(on_sheet.iter().all(|hit| is_near(hit, (sheet + 1) as f32)), "{name}: {on_sheet:?}");
            }
        }
    }
}

#[test]
fn other_bodies_in_the_way_are_not_reported() {
    let (even, odd) = (comb(64), comb(64));
    let instances = [
        MeshInstance { mesh: 0, transform: Affine3A::IDENTITY, probed: true },
        MeshInstance { mesh: 1, transform: Affine3A::from_translation(0.5 * Vec3::Z), probed: true },
        MeshInstance { mesh: 1, transform: Affine3A::from_translation(0.75 * Vec3::Z), probed: false },
    ];
    let geometry = Geometry { meshes: &[even.view(), odd.view()], instances: &instances };
    let ray = Ray { origin: Vec3::new(0.5, 0.0, 0.0), direction: Vec3::Z, t_max: 70.0 };
    for (name, caster) in backends(&geometry) {
        for (instance, offset) in [(0, 0.0), (1, 0.5)] {
            let mut hits = vec![];
            caster.all_hits(&ray, instance, &mut hits);
            hits.sort_by(|a, b| a.t.total_cmp(&b.t));
            assert_eq!(hits.len(), 64, "{name}");
            assert!(hits.iter().all(|hit| hit.instance == instance), "{name}");
            for (sheet, hit) in hits.iter().enumerate() {
                assert!(is_near(hit, (sheet + 1) as f32 + offset), "{name}: {hit:?}");
            }
        }
    }
}

/// A line crosses a closed surface an even number of times.
#[test]
fn crossings_of_a_closed_surface_come_in_pairs() {
    let mut octahedron =
        Mesh { positions: vec![Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z], triangles: vec![] };
    for [x, y, z] in [[0, 1, 2], [0, 1, 5], [0, 4, 2], [0, 4, 5], [3, 1, 2], [3, 1, 5], [3, 4, 2], [3, 4, 5]]
    {
        octahedron.triangles.push([x, y, z]);
    }
    let mut random = HashGenerator::new(2);
    for (name, caster) in placed(&octahedron, &[Affine3A::IDENTITY]) {
        let mut pairs = 0;
        for _ in 0..20_000 {
            let mut jitter = || 1e-3 * Vec3::new(random.next_f32(), random.next_f32(), random.next_f32());
            let (shift, turn) = (jitter(), jitter());
            let direction = grid_point(&mut random).normalize_or(Vec3::X) + turn;
            let origin = grid_point(&mut random) + shift - 3.0 * direction;
            let hits = all_hits(caster.as_ref(), &Ray { origin, direction, t_max: 6.0 });
            assert_eq!(hits.len() % 2, 0, "{name}: {origin} {direction}: {hits:?}");
            pairs += hits.len() / 2;
        }
        // The octahedron fills more than a tenth of the cube that the lines pass through.
        assert!(pairs > 2_000, "{name}: {pairs}");
    }
}
