//! Empty, degenerate, broken and extreme geometry: an error or an answer, never a crash.

mod triangles;

use alabaster::math::sampler::HashGenerator;
use alabaster::raycast::{Geometry, Hit, MeshInstance, Ray, RayCaster, RaycastError, TriangleMesh};
use glam::{Affine3A, Vec3};
use triangles::{Mesh, backends, placed, soup, soup_ray};

const PROBED: MeshInstance = MeshInstance { mesh: 0, transform: Affine3A::IDENTITY, probed: true };

fn assert_nothing_is_hit(name: &str, caster: &dyn RayCaster, ray: &Ray) {
    let mut hits = vec![Hit { t: 0.0, u: 0.0, v: 0.0, instance: 0, primitive: 0 }];
    caster.all_hits(ray, 0, &mut hits);
    assert_eq!(hits, [], "{name}: {ray:?}");
    assert_eq!(caster.closest(ray), None, "{name}: {ray:?}");
    assert!(!caster.occluded(ray), "{name}: {ray:?}");
}

#[test]
fn empty_worlds_have_no_hits() {
    let ray = Ray { origin: Vec3::ZERO, direction: Vec3::Z, t_max: 1.0 };
    let nothing = TriangleMesh { positions: &[], triangles: &[] };
    let no_triangles = TriangleMesh { positions: &[Vec3::ONE], triangles: &[] };
    let geometries = [
        Geometry { meshes: &[], instances: &[] },
        Geometry { meshes: &[nothing], instances: &[] },
        Geometry { meshes: &[nothing], instances: &[PROBED] },
        Geometry { meshes: &[no_triangles], instances: &[PROBED, PROBED] },
    ];
    for geometry in &geometries {
        for (name, caster) in backends(geometry) {
            assert_nothing_is_hit(name, caster.as_ref(), &ray);
        }
    }
}

#[test]
fn indices_out_of_range_are_refused() {
    let positions = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let good = TriangleMesh { positions: &positions, triangles: &[[0, 1, 2]] };
    let bad = TriangleMesh { positions: &positions, triangles: &[[0, 1, 2], [0, 1, 3]] };
    let check = |meshes: &[TriangleMesh], mesh| {
        Geometry { meshes, instances: &[MeshInstance { mesh, ..PROBED }] }.validate()
    };
    assert!(check(&[good], 0).is_ok());
    assert!(matches!(check(&[good, bad], 0), Err(RaycastError::VertexIndex { mesh: 1, triangle: 1 })));
    assert!(matches!(check(&[good], 1), Err(RaycastError::MeshIndex { instance: 0 })));
    #[cfg(feature = "embree")]
    {
        let geometry = Geometry { meshes: &[bad], instances: &[PROBED] };
        let result = alabaster::raycast::embree::EmbreeCaster::new(&geometry, 0);
        assert!(matches!(result.err(), Some(RaycastError::VertexIndex { mesh: 0, triangle: 1 })));
    }
}

/// Triangles without area and positions that are no numbers are among good triangles, which are still
/// found.
#[test]
fn bad_triangles_do_not_hide_good_ones() {
    let mut mesh = Mesh::default();
    let not_a_number = Vec3::splat(f32::NAN);
    let infinite = Vec3::new(f32::INFINITY, 0.0, 1.0);
    for x in [0.0, 1.0, 2.0, 3.0] {
        let corner = |dx: f32, dy: f32| Vec3::new(x + dx, dy, 1.0);
        mesh.push([corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0)]);
        mesh.push([corner(0.0, 0.0); 3]);
        mesh.push([corner(0.0, 0.0), corner(0.5, 0.0), corner(1.0, 0.0)]);
        mesh.push([corner(0.0, 0.0), not_a_number, corner(1.0, 0.0)]);
        mesh.push([corner(0.0, 0.0), infinite, corner(1.0, 1.0)]);
    }
    for transforms in
        [&[Affine3A::IDENTITY][..], &[Affine3A::IDENTITY, Affine3A::from_translation(9.0 * Vec3::Y)]]
    {
        for (name, caster) in placed(&mesh, transforms) {
            for good in 0..4 {
                let origin = Vec3::new(good as f32 + 0.25, 0.25, 0.0);
                let hit = caster.closest(&Ray::new(origin, Vec3::Z)).expect("a good triangle is there");
                assert_eq!(hit.primitive, 5 * good, "{name}");
                // Half a dozen roundings, one of them that of a reciprocal.
                assert!((hit.t - 1.0).abs() <= 3.0 * f32::EPSILON, "{name}: {hit:?}");
                let mut hits = vec![];
                caster.all_hits(&Ray { origin, direction: Vec3::Z, t_max: 2.0 }, 0, &mut hits);
                assert_eq!(hits.len(), 1, "{name}: {hits:?}");
            }
        }
    }
}

/// Rays with non-finite numbers, without direction or without extent: no crash and no hit.
#[test]
fn bad_rays_hit_nothing() {
    let mut random = HashGenerator::new(3);
    let mesh = soup(200, &mut random);
    for (name, caster) in placed(&mesh, &[Affine3A::IDENTITY, Affine3A::from_translation(Vec3::X)]) {
        for _ in 0..100 {
            let ray = soup_ray(&mut random);
            for bad in [
                Ray { origin: ray.origin.with_x(f32::NAN), ..ray },
                Ray { direction: ray.direction.with_y(f32::NAN), ..ray },
                Ray { direction: Vec3::ZERO, ..ray },
                Ray { t_max: f32::NAN, ..ray },
                Ray { t_max: 0.0, ..ray },
                Ray { t_max: -1.0, ..ray },
            ] {
                assert_nothing_is_hit(name, caster.as_ref(), &bad);
            }
        }
    }
}

/// Many copies of one triangle, and triangles whose sizes span forty powers of two, make hierarchies as
/// deep as they get.
#[test]
fn hierarchies_of_pathological_meshes_are_traversed() {
    let corners = [Vec3::new(0.0, 0.0, 1.0), Vec3::new(1.0, 0.0, 1.0), Vec3::new(0.0, 1.0, 1.0)];
    let (mut copies, mut powers) = (Mesh::default(), Mesh::default());
    (0..20_000).for_each(|_| copies.push(corners));
    (-20..20).for_each(|power| powers.push(corners.map(|corner| corner * 2.0_f32.powi(power))));
    for mesh in [copies, powers] {
        for (name, caster) in placed(&mesh, &[Affine3A::IDENTITY]) {
            let ray = Ray { origin: Vec3::ZERO, direction: Vec3::new(0.25, 0.25, 1.0), t_max: 2e6 };
            let mut hits = vec![];
            caster.all_hits(&ray, 0, &mut hits);
            assert_eq!(hits.len(), mesh.triangles.len(), "{name}");
            assert!(caster.occluded(&ray) && caster.closest(&ray).is_some(), "{name}");
        }
    }
}
