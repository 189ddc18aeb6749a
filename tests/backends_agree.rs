//! Embree and the pure-Rust backend see the same scene.
#![cfg(feature = "embree")]

mod triangles;

use alabaster::math::sampler::HashGenerator;
use alabaster::raycast::{Geometry, Hit, MeshInstance, Ray, RayCaster, bvh::BvhCaster, embree::EmbreeCaster};
use glam::{Affine3A, Quat, Vec3};
use triangles::{Mesh, grid_point, soup};

/// A bumpy closed surface: an octahedron, each face divided into 4^`levels` triangles.
fn bumpy_sphere(levels: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let bumpy = |p: Vec3| p.normalize() * (1.0 + 0.05 * (9.0 * p.x).sin() * (7.0 * p.y + p.z).cos());
    let mut faces = vec![];
    for signs in 0..8 {
        let sign = |bit: u32| if signs >> bit & 1 == 0 { 1.0 } else { -1.0 };
        faces.push([Vec3::X * sign(0), Vec3::Y * sign(1), Vec3::Z * sign(2)]);
    }
    for _ in 0..levels {
        let divide = |[a, b, c]: [Vec3; 3]| {
            let (ab, bc, ca) = ((a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0);
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        faces = faces.into_iter().flat_map(divide).collect();
    }
    faces.into_iter().for_each(|face| mesh.push(face.map(bumpy)));
    mesh
}

/// True if the hits are at the same place of the same triangle, or at the same place of an edge, where
/// either triangle is right.
///
/// The scene is 8 across: 20 roundings of such coordinates are 10⁻⁵, and that, on edges of 0.03, changes
/// barycentric coordinates by less than 10⁻³. Grazing hits, whose errors are larger, count as differing.
fn same(ray: &Ray, a: &Hit, b: &Hit) -> bool {
    a.instance == b.instance
        && (a.t - b.t).abs() * ray.direction.length() < 1e-5
        && (a.primitive != b.primitive || ((a.u - b.u).abs() < 1e-3 && (a.v - b.v).abs() < 1e-3))
}

#[test]
fn both_backends_see_the_same_scene() {
    let mut random = HashGenerator::new(5);
    let (sphere, clutter) = (bumpy_sphere(5), soup(100, &mut random));
    let place = |mesh, transform| MeshInstance { mesh, transform, probed: true };
    let turned = Affine3A::from_rotation_translation(Quat::from_rotation_y(0.7), Vec3::new(0.3, -2.5, 0.2));
    let squeezed = Affine3A::from_scale(Vec3::new(-0.5, 1.2, 0.8)) * turned;
    let instances = [place(0, turned), place(0, squeezed), place(1, Affine3A::from_scale(Vec3::splat(2.0)))];
    let geometry = Geometry { meshes: &[sphere.view(), clutter.view()], instances: &instances };
    let embree = EmbreeCaster::new(&geometry, 0).expect("builds");
    let bvh = BvhCaster::new(&geometry).expect("builds");
    assert!(embree.bytes() > 12 * sphere.triangles.len() && bvh.bytes() > 12 * sphere.triangles.len());

    let rays = 50_000;
    let (mut differing, mut total) = (0, 0);
    for _ in 0..rays {
        let origin = 4.0 * grid_point(&mut random);
        let ray = Ray { origin, direction: 3.0 * grid_point(&mut random) - origin, t_max: 2.0 };
        let (a, b) = (embree.closest(&ray), bvh.closest(&ray));
        let agree = match (&a, &b) {
            (Some(a), Some(b)) => same(&ray, a, b),
            (None, None) => true,
            _ => false,
        };
        differing += usize::from(!agree) + usize::from(embree.occluded(&ray) != bvh.occluded(&ray));
        total += usize::from(a.is_some());
        let (mut a, mut b) = (vec![], vec![]);
        for instance in 0..3 {
            embree.all_hits(&ray, instance, &mut a);
            bvh.all_hits(&ray, instance, &mut b);
            let agree = a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| same(&ray, a, b));
            differing += usize::from(!agree);
            total += a.len();
        }
    }
    // What may differ passes within 10⁻⁵ of an edge of the sphere's triangles (three strips of that width cover
    // 2·10⁻³ of a triangle) where the two tests round differently, or grazes; a tenth of that is allowed.
    assert!(total > rays, "{total}");
    assert!(differing * 5_000 < total, "{differing} of {total} differ");
}
