//! Shapes as triangles: every ray caster sees the same ones.

use std::collections::HashMap;
use std::f64::consts::TAU;

use glam::{DVec3, Vec3};

use super::{Light, Mesh};

/// Subdivisions of spheres: 81,920 triangles with edges of about R/55. Their planes lie within
/// 8·10⁻⁵ R of the sphere, so a picture of 4,000 pixels across the sphere shows no polygon.
pub const SPHERE_LEVEL: u32 = 6;

/// Corners of disks: the area is off by (2π/512)²/6 = 2.5·10⁻⁵.
pub const DISK_CORNERS: u32 = 512;

/// A sphere as an icosahedron whose triangles were split in four `level` times, vertices on the
/// sphere, with exact vertex normals: 20·4^`level` triangles, closed and without seam.
pub fn sphere(center: Vec3, radius: f32, level: u32) -> Mesh {
    let (mut vertices, mut triangles) = icosahedron();
    for _ in 0..level {
        triangles = split(&mut vertices, &triangles);
    }
    let normals: Vec<Vec3> = vertices.iter().map(|v| v.as_vec3()).collect();
    Mesh {
        name: "sphere".into(),
        positions: normals.iter().map(|&n| center + n * radius).collect(),
        normals,
        triangles,
        ..Mesh::default()
    }
}

/// Vertices on the unit sphere and outward triangles.
fn icosahedron() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let vertices = [[1.0, golden], [-1.0, golden], [1.0, -golden], [-1.0, -golden]]
        .iter()
        .flat_map(|&[a, b]| [DVec3::new(a, b, 0.0), DVec3::new(0.0, a, b), DVec3::new(b, 0.0, a)])
        .map(DVec3::normalize)
        .collect::<Vec<_>>();
    // The faces are the triples of mutual neighbours; neighbours are 63.4° apart, the next 116.6°.
    let neighbours = |i: u32, j: u32| vertices[i as usize].dot(vertices[j as usize]) > 0.0;
    let mut triangles = Vec::with_capacity(20);
    for i in 0..12 {
        for j in (i + 1..12).filter(|&j| neighbours(i, j)) {
            for k in (j + 1..12).filter(|&k| neighbours(i, k) && neighbours(j, k)) {
                let [a, b, c] = [i, j, k].map(|v| vertices[v as usize]);
                let outward = (b - a).cross(c - a).dot(a) > 0.0;
                triangles.push(if outward { [i, j, k] } else { [i, k, j] });
            }
        }
    }
    (vertices, triangles)
}

/// Splits each triangle in four; new vertices lie on the unit sphere and are shared by neighbours.
fn split(vertices: &mut Vec<DVec3>, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut middles = HashMap::with_capacity(triangles.len() * 3 / 2);
    let mut middle = |i: u32, j: u32| {
        *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
            vertices.push((vertices[i as usize] + vertices[j as usize]).normalize());
            (vertices.len() - 1) as u32
        })
    };
    let mut out = Vec::with_capacity(triangles.len() * 4);
    for &[a, b, c] in triangles {
        let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
        out.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    out
}

/// An axis-aligned box with edges of lengths `size`; flat shaded, eight shared vertices.
pub fn cuboid(center: Vec3, size: Vec3) -> Mesh {
    let positions = (0..8)
        .map(|i| {
            let corner = Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) - 0.5;
            center + corner * size
        })
        .collect();
    // Corner i has bit 0 for +x, bit 1 for +y, bit 2 for +z; faces −x, +x, −y, +y, −z, +z.
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh { name: "box".into(), positions, triangles, ..Mesh::default() }
}

/// A parallelogram with corners `center` ± `half_u` ± `half_v`; its front is on the side of u×v.
pub fn quad(center: Vec3, half_u: Vec3, half_v: Vec3) -> Mesh {
    let positions = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(|(u, v)| center + half_u * u + half_v * v)
        .to_vec();
    Mesh { name: "quad".into(), positions, triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() }
}

/// A disk as a fan of [`DISK_CORNERS`] triangles; its front is on the side of the unit `normal`.
pub fn disk(center: Vec3, normal: Vec3, radius: f32) -> Mesh {
    let (u, v) = horizontal_frame(normal);
    let rim = (0..DISK_CORNERS).map(|i| {
        let (sin, cos) = (TAU * f64::from(i) / f64::from(DISK_CORNERS)).sin_cos();
        center + (u * cos as f32 + v * sin as f32) * radius
    });
    Mesh {
        name: "disk".into(),
        positions: std::iter::once(center).chain(rim).collect(),
        triangles: (0..DISK_CORNERS).map(|i| [0, 1 + i, 1 + (i + 1) % DISK_CORNERS]).collect(),
        ..Mesh::default()
    }
}

/// The visible surface of a light, its front the side that emits; `None` for lights without size.
pub fn light_mesh(light: &Light) -> Option<Mesh> {
    match *light {
        Light::Quad { center, half_u, half_v, .. } => Some(quad(center, half_u, half_v)),
        Light::Disk { center, normal, radius, .. } => Some(disk(center, normal, radius)),
        Light::Sphere { center, radius, .. } => Some(sphere(center, radius, SPHERE_LEVEL)),
        Light::Point { .. } | Light::Spot { .. } | Light::Directional { .. } => None,
    }
}

/// Unit vectors u, v with u×v = `normal` (a unit vector), u horizontal (orthogonal to y). For a
/// vertical normal, give or take rounding (10⁻⁶), u is x, so that noise turns no light around.
pub fn horizontal_frame(normal: Vec3) -> (Vec3, Vec3) {
    let across = Vec3::Y.cross(normal);
    let vertical = across.length_squared() < 1e-12;
    let u = if vertical { (Vec3::X - normal * normal.x).normalize() } else { across.normalize() };
    let v = normal.cross(u);
    (u, v)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners(mesh: &Mesh, triangle: [u32; 3]) -> [DVec3; 3] {
        triangle.map(|i| mesh.positions[i as usize].as_dvec3())
    }

    fn area_vector(mesh: &Mesh) -> (DVec3, f64) {
        let vectors = mesh.triangles.iter().map(|&t| {
            let [a, b, c] = corners(mesh, t);
            0.5 * (b - a).cross(c - a)
        });
        vectors.fold((DVec3::ZERO, 0.0), |(sum, area), v| (sum + v, area + v.length()))
    }

    /// By the divergence theorem; positive if the triangles wind counter-clockwise seen from outside.
    fn volume(mesh: &Mesh) -> f64 {
        mesh.triangles.iter().map(|&t| corners(mesh, t)).map(|[a, b, c]| a.dot(b.cross(c))).sum::<f64>() / 6.0
    }

    /// Every directed edge has its opposite exactly once.
    fn is_closed(mesh: &Mesh) -> bool {
        let edges: Vec<_> = mesh.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
        let set: std::collections::HashSet<_> = edges.iter().copied().collect();
        set.len() == edges.len() && edges.iter().all(|&(a, b)| set.contains(&(b, a)))
    }

    #[test]
    fn sphere_is_closed_with_area_and_volume_between_inscribed_bounds() {
        for level in 0..=SPHERE_LEVEL {
            let mesh = sphere(Vec3::ZERO, 1.0, level);
            assert_eq!(mesh.triangles.len(), 20 * 4_usize.pow(level));
            assert!(is_closed(&mesh));
            // Each triangle's plane is at a distance d ≥ d_min from the centre. Seen from there a
            // piece dΩ has area r³/d dΩ and volume r³/3 dΩ with d ≤ r ≤ 1, so
            // d_min² ≤ A/4π ≤ 1/d_min and d_min³ ≤ V/(4π/3) ≤ 1, up to rounding of positions.
            let distance = mesh.triangles.iter().map(|&t| {
                let [a, b, c] = corners(&mesh, t);
                a.dot((b - a).cross(c - a).normalize())
            });
            let nearest = distance.fold(f64::INFINITY, f64::min);
            let rounding = 1.0 + 4.0 * f64::from(f32::EPSILON);
            let area = area_vector(&mesh).1 / (2.0 * TAU);
            let volume = volume(&mesh) / (2.0 * TAU / 3.0);
            assert!(nearest.powi(2) / rounding <= area && area <= rounding / nearest, "{level}: {area}");
            assert!(nearest.powi(3) / rounding <= volume && volume <= rounding, "{level}: {volume}");
            if level == SPHERE_LEVEL {
                assert!(1.0 - nearest < 8e-5, "{nearest}");
            }
        }
    }

    #[test]
    fn sphere_normals_are_exact_and_outward() {
        let center = Vec3::new(3.0, -2.0, 0.5);
        let mesh = sphere(center, 2.0, 3);
        for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
            // One rounding in the product, one in the sum, at coordinates below 8.
            assert!(((*p - center) / 2.0 - *n).abs().max_element() <= 4.0 * f32::EPSILON);
            assert!(n.is_normalized());
        }
        assert!(volume(&mesh) > 0.0);
    }

    #[test]
    fn box_has_its_area_and_volume() {
        let mesh = cuboid(Vec3::new(0.5, -1.0, 2.0), Vec3::new(1.0, 2.0, 4.0));
        assert!(is_closed(&mesh));
        // All coordinates are exact in binary.
        assert_eq!(volume(&mesh), 8.0);
        assert_eq!(area_vector(&mesh), (DVec3::ZERO, 28.0));
    }

    #[test]
    fn quad_and_disk_face_their_normal() {
        let half_u = Vec3::new(1.0, 0.0, 0.0);
        let (vector, area) = area_vector(&quad(Vec3::ONE, half_u, Vec3::new(0.0, 0.5, 0.0)));
        assert_eq!((vector, area), (DVec3::new(0.0, 0.0, 2.0), 2.0));

        for normal in [Vec3::Y, Vec3::NEG_Y, Vec3::X, Vec3::new(0.48, -0.6, 0.64)] {
            let (vector, area) = area_vector(&disk(Vec3::splat(0.3), normal, 0.25));
            // A regular polygon: A = n/2 sin(2π/n) r²; each of 513 vertices rounded at size 0.5.
            let corners = f64::from(DISK_CORNERS);
            let expected = 0.5 * corners * (TAU / corners).sin() * 0.0625;
            assert!((area - expected).abs() < 2.0 * TAU * 0.25 * 0.5 * f64::from(f32::EPSILON));
            assert!((1.0 - area / (0.5 * TAU * 0.0625)) < 2.6e-5);
            assert!(vector.normalize().dot(normal.as_dvec3()) > 1.0 - 8.0 * f64::from(f32::EPSILON));
        }
    }

    #[test]
    fn horizontal_frames_are_right_handed_and_level() {
        for normal in [Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::new(0.48, -0.6, 0.64), Vec3::new(1e-7, 1.0, 0.0)]
        {
            let (u, v) = horizontal_frame(normal);
            assert!(u.is_normalized() && v.is_normalized() && u.dot(v).abs() < 2.0 * f32::EPSILON);
            assert!(u.y.abs() <= 1e-6);
            assert!((u.cross(v) - normal).length() < 4.0 * f32::EPSILON);
        }
    }

    #[test]
    fn lights_with_a_size_have_a_surface() {
        let radiance = crate::radiometry::Rgb::ONE.into();
        let (center, radius) = (Vec3::ZERO, 1.0);
        let (half_u, half_v) = (Vec3::X, Vec3::Y);
        let facing = |light: &Light| light_mesh(light).map(|m| area_vector(&m).0.normalize_or_zero());
        assert_eq!(facing(&Light::Quad { center, half_u, half_v, radiance }), Some(DVec3::Z));
        assert_eq!(facing(&Light::Disk { center, normal: Vec3::Z, radius, radiance }), Some(DVec3::Z));
        assert!(light_mesh(&Light::Sphere { center, radius, radiance }).is_some_and(|m| volume(&m) > 4.18));
        assert!(light_mesh(&Light::Point { position: center, intensity: radiance }).is_none());
    }
}
