//! What the tests of ray queries share: triangles, backends, and a reference in double precision.

#![allow(dead_code)] // Each test file uses its part.

use alabaster::math::sampler::HashGenerator;
use alabaster::raycast::{Geometry, Hit, MeshInstance, Ray, RayCaster, TriangleMesh};
use glam::{Affine3A, DVec3, Vec3};

/// Every backend that this build has, for `geometry`.
pub fn backends(geometry: &Geometry) -> Vec<(&'static str, Box<dyn RayCaster>)> {
    vec![
        #[cfg(feature = "embree")]
        ("embree", Box::new(alabaster::raycast::embree::EmbreeCaster::new(geometry, 0).expect("builds"))),
        ("bvh", Box::new(alabaster::raycast::bvh::BvhCaster::new(geometry).expect("builds"))),
        (
            "bvh, portable",
            Box::new(alabaster::raycast::bvh::BvhCaster::new(geometry).expect("builds").portable()),
        ),
        ("obvhs", Box::new(alabaster::raycast::obvhs::ObvhsCaster::new(geometry).expect("builds"))),
    ]
}

/// A mesh that owns its triangles.
#[derive(Clone, Default)]
pub struct Mesh {
    pub positions: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    pub fn view(&self) -> TriangleMesh<'_> {
        TriangleMesh { positions: &self.positions, triangles: &self.triangles }
    }

    pub fn push(&mut self, corners: [Vec3; 3]) {
        let first = self.positions.len() as u32;
        self.positions.extend(corners);
        self.triangles.push([first, first + 1, first + 2]);
    }

    pub fn corners(&self, primitive: usize) -> [Vec3; 3] {
        self.triangles[primitive].map(|index| self.positions[index as usize])
    }
}

/// Builds every backend for `mesh` placed by each of `transforms`, all probed.
pub fn placed(mesh: &Mesh, transforms: &[Affine3A]) -> Vec<(&'static str, Box<dyn RayCaster>)> {
    let place = |&transform: &Affine3A| MeshInstance { mesh: 0, transform, probed: true };
    let instances: Vec<_> = transforms.iter().map(place).collect();
    backends(&Geometry { meshes: &[mesh.view()], instances: &instances })
}

/// A point of the cube [−1, 1]³ whose coordinates are multiples of 2⁻¹⁰, so that scaling by powers of
/// two, integer translations and the like are exact.
pub fn grid_point(random: &mut HashGenerator) -> Vec3 {
    let mut coordinate = || (random.next_f32() * 2048.0).floor() / 1024.0 - 1.0;
    Vec3::new(coordinate(), coordinate(), coordinate())
}

/// Unconnected triangles in the cube [−1.5, 1.5]³.
pub fn soup(count: usize, random: &mut HashGenerator) -> Mesh {
    let mut mesh = Mesh::default();
    for _ in 0..count {
        let centre = grid_point(random);
        mesh.push([(); 3].map(|()| centre + 0.5 * grid_point(random)));
    }
    mesh
}

/// A ray through the soup; every second one a segment that ends inside.
pub fn soup_ray(random: &mut HashGenerator) -> Ray {
    let (origin, target) = (2.0 * grid_point(random), grid_point(random));
    let t_max = if random.next_f32() < 0.5 { 4.0 } else { 1.0 };
    Ray { origin, direction: target - origin, t_max }
}

/// What double precision says about a ray and a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Single precision must report the crossing.
    Hit,
    /// Single precision must not.
    Miss,
    /// Too close to an edge, to an end of the segment, or too grazing for single precision to tell.
    Unclear,
}

/// The crossing of a line with the plane of a triangle (Möller, Trumbore 1997) in double precision, with
/// bounds on the error of an intersector that works in single.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    pub t: f64,
    pub u: f64,
    pub v: f64,
    /// Bound on the error of a single-precision `u`, `v`.
    pub uv_error: f64,
    /// Bound on the error of a single-precision `t`.
    pub t_error: f64,
    pub verdict: Verdict,
}

/// Intersects `ray` with the triangle.
///
/// Intersectors in single precision take vertices relative to the origin (rounded once), multiply edges,
/// vertices and the direction into edge functions, and divide by the determinant. No more than 32
/// successive roundings, each at most 2⁻²⁴ of the largest product |edge|·|vertex|·|direction|, are in any
/// of their forms; hence the bounds.
pub fn cross(ray: &Ray, corners: [Vec3; 3]) -> Crossing {
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let [a, b, c] = corners.map(|corner| corner.as_dvec3() - origin);
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(ac);
    let determinant = normal.dot(direction);
    let t = normal.dot(a) / determinant;
    let volume = |p: DVec3, q: DVec3| p.cross(q).dot(direction) / determinant;
    let (u, v, w) = (volume(c, a), volume(a, b), volume(b, c));

    let edge = ab.length().max(ac.length()).max((c - b).length());
    let reach = a.length().max(b.length()).max(c.length());
    let roundings = 32.0 * f64::from(f32::EPSILON) / 2.0;
    let uv_error = roundings * edge * reach * direction.length() / determinant.abs();
    let t_error = roundings * edge * edge * reach / determinant.abs() + t.abs() * uv_error;

    let margin = (u.min(v).min(w) / uv_error).min(t / t_error).min((f64::from(ray.t_max) - t) / t_error);
    let verdict = match margin {
        margin if margin > 1.0 => Verdict::Hit,
        margin if margin < -1.0 => Verdict::Miss,
        _ => Verdict::Unclear,
    };
    Crossing { t, u, v, uv_error, t_error, verdict }
}

impl Crossing {
    /// True if `hit` is this crossing within the bounds.
    pub fn agrees(&self, hit: &Hit) -> bool {
        self.verdict != Verdict::Miss
            && (f64::from(hit.t) - self.t).abs() <= self.t_error
            && (f64::from(hit.u) - self.u).abs() <= self.uv_error
            && (f64::from(hit.v) - self.v).abs() <= self.uv_error
    }
}

/// Asserts that the three queries answer `ray` as double precision does. `expected` holds the crossings
/// with every triangle of every instance, by (instance, primitive).
pub fn assert_agreement(name: &str, caster: &dyn RayCaster, ray: &Ray, expected: &[Vec<Crossing>]) {
    let every = || expected.iter().flatten();
    let certain = || every().filter(|crossing| crossing.verdict == Verdict::Hit);
    let possible = every().any(|crossing| crossing.verdict != Verdict::Miss);
    let find = |hit: &Hit| &expected[hit.instance as usize][hit.primitive as usize];

    let closest = caster.closest(ray);
    match &closest {
        Some(hit) => {
            assert!(find(hit).agrees(hit), "{name}: {ray:?}: {hit:?}, should be {:?}", find(hit));
            let nearer = certain().find(|crossing| crossing.t + crossing.t_error < f64::from(hit.t));
            assert!(nearer.is_none(), "{name}: {ray:?}: {hit:?} is behind {nearer:?}");
        }
        None => assert_eq!(certain().count(), 0, "{name}: {ray:?}: missed"),
    }
    let occluded = caster.occluded(ray);
    assert!(!occluded || possible, "{name}: {ray:?}: occluded by nothing");
    assert!(occluded || certain().count() == 0, "{name}: {ray:?}: not occluded");

    let mut hits = vec![];
    for (instance, crossings) in expected.iter().enumerate() {
        caster.all_hits(ray, instance as u32, &mut hits);
        assert!(hits.iter().all(|hit| hit.instance as usize == instance && find(hit).agrees(hit)));
        let mut count = vec![0; crossings.len()];
        hits.iter().for_each(|hit| count[hit.primitive as usize] += 1);
        for (primitive, (crossing, count)) in crossings.iter().zip(count).enumerate() {
            assert!(count <= 1, "{name}: {ray:?}: triangle {primitive} reported {count} times");
            assert!(
                count == 1 || crossing.verdict != Verdict::Hit,
                "{name}: {ray:?}: {crossing:?} with triangle {primitive} not reported"
            );
        }
    }
}
