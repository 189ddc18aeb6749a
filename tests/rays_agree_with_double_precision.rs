//! Every ray query answers as a brute-force search in double precision does.

mod triangles;

use alabaster::math::sampler::HashGenerator;
use alabaster::raycast::Ray;
use glam::{Affine3A, Mat3A, Vec3, Vec3A};
use triangles::{Crossing, Mesh, Verdict, assert_agreement, cross, placed, soup, soup_ray};

/// Mirrored, sheared and unevenly scaled placements, whose products with grid points are exact in
/// single precision. The first is the identity.
fn transforms() -> Vec<Affine3A> {
    let linear = |x, y, z| Mat3A::from_cols(Vec3A::from_array(x), Vec3A::from_array(y), Vec3A::from_array(z));
    let matrices = [
        Mat3A::IDENTITY,
        linear([-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
        linear([1.0, 0.0, 0.0], [0.5, 1.0, 0.0], [0.0, 0.25, 1.0]),
        linear([0.25, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]),
        linear([0.0, 0.0, -2.0], [0.5, 0.0, 0.0], [0.0, 1.0, 0.5]),
    ];
    let shifts = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, -1.0, 0.0), Vec3::new(0.0, 0.5, 1.0), -Vec3::Z];
    matrices
        .into_iter()
        .zip(shifts)
        .map(|(matrix, shift)| Affine3A { matrix3: matrix, translation: shift.into() })
        .collect()
}

/// The crossings of `ray` with the triangles of `mesh` placed by `transform`. Parameter and barycentric
/// coordinates are the same in both spaces; the error is that of the worse one.
fn crossings(ray: &Ray, mesh: &Mesh, transform: &Affine3A) -> Vec<Crossing> {
    let inverse = transform.inverse();
    let local = Ray {
        origin: inverse.transform_point3(ray.origin),
        direction: inverse.transform_vector3(ray.direction),
        t_max: ray.t_max,
    };
    let crossing = |primitive| {
        let corners = mesh.corners(primitive);
        let inside = cross(&local, corners);
        let outside = cross(ray, corners.map(|corner| transform.transform_point3(corner)));
        if inside.uv_error + inside.t_error > outside.uv_error + outside.t_error { inside } else { outside }
    };
    (0..mesh.triangles.len()).map(crossing).collect()
}

/// Compares all queries on `rays` rays, and makes sure that the comparison is not empty.
fn compare(mesh: &Mesh, transforms: &[Affine3A], rays: &[Ray]) {
    let casters = placed(mesh, transforms);
    let (mut hits, mut unclear, mut total) = (0, 0, 0);
    for ray in rays {
        let expected: Vec<_> = transforms.iter().map(|transform| crossings(ray, mesh, transform)).collect();
        for (name, caster) in &casters {
            assert_agreement(name, caster.as_ref(), ray, &expected);
        }
        let count =
            |verdict| expected.iter().flatten().filter(|crossing| crossing.verdict == verdict).count();
        hits += count(Verdict::Hit);
        unclear += count(Verdict::Unclear);
        total += mesh.triangles.len() * transforms.len();
    }
    assert!(hits > rays.len(), "{hits} hits are too few to say anything");
    assert!(unclear * 1000 < total, "{unclear} of {total} unclear");
}

#[test]
fn baked_soup() {
    for seed in 0..4 {
        let mut random = HashGenerator::new(seed);
        let mesh = soup(300, &mut random);
        let rays: Vec<_> = (0..500).map(|_| soup_ray(&mut random)).collect();
        compare(&mesh, &[Affine3A::IDENTITY], &rays);
    }
}

#[test]
fn baked_under_every_transform() {
    let mut random = HashGenerator::new(10);
    let mesh = soup(300, &mut random);
    let rays: Vec<_> = (0..500).map(|_| soup_ray(&mut random)).collect();
    for transform in transforms() {
        compare(&mesh, &[transform], &rays);
    }
}

#[test]
fn instanced_under_every_transform() {
    let mut random = HashGenerator::new(11);
    let mesh = soup(100, &mut random);
    let rays: Vec<_> = (0..1000).map(|_| soup_ray(&mut random)).collect();
    compare(&mesh, &transforms(), &rays);
}

/// Powers of two scale every intermediate result of the reference and of an intersector alike.
#[test]
fn large_and_small_worlds() {
    for exponent in [-20, 20, 40] {
        let scale = 2.0_f32.powi(exponent);
        let mut random = HashGenerator::new(12);
        let mut mesh = soup(300, &mut random);
        mesh.positions.iter_mut().for_each(|position| *position *= scale);
        let scaled = |ray: Ray| Ray { origin: ray.origin * scale, direction: ray.direction * scale, ..ray };
        let rays: Vec<_> = (0..500).map(|_| scaled(soup_ray(&mut random))).collect();
        compare(&mesh, &[Affine3A::IDENTITY], &rays);
    }
}
