//! Tangents for normal maps, where a mesh brings none (glTF 2.0, section 3.7.2.1).

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use crate::scene::Mesh;

/// Gives `mesh` tangents along texture coordinate set `set`, as MikkTSpace does (Mikkelsen 2008,
/// "Simulation of Wrinkled Surfaces Revisited"): at each vertex the mean of the u directions of the
/// triangles around, projected into the surface and weighted by their angles there. Vertices with the
/// same position, normal and coordinates count as one; a vertex around which the texture is mirrored
/// in part is split in two.
///
/// Nothing happens if the mesh lacks the coordinates.
pub(super) fn add_tangents(mesh: &mut Mesh, set: usize) {
    if mesh.texture_coordinates[set].is_empty() {
        return;
    }
    let directions: Vec<_> =
        mesh.triangles.iter().map(|corners| direction_of_u(mesh, set, corners)).collect();
    let mirrored = split_mirrored(mesh, &directions);
    let welded = weld(mesh, set, &mirrored);
    let mut sums = vec![DVec3::ZERO; mesh.positions.len()];
    for (corners, direction) in mesh.triangles.iter().zip(&directions) {
        let Some(UDirection { along, .. }) = direction else { continue };
        for i in 0..3 {
            let [at, next, last] = [0, 1, 2].map(|k| corners[(i + k) % 3] as usize);
            let project = projection(mesh, at);
            let edge = |to: usize| project((mesh.positions[to] - mesh.positions[at]).as_dvec3());
            sums[welded[at]] += project(*along) * edge(next).angle_between(edge(last));
        }
    }
    let tangent = |vertex: usize| {
        let sum = sums[welded[vertex]];
        let any = mesh.normals.get(vertex).map_or(Vec3::X, |n| n.any_orthonormal_vector());
        let unit = if sum.is_finite() { sum.as_vec3().normalize_or(any) } else { any };
        unit.extend(if mirrored[vertex] { -1.0 } else { 1.0 })
    };
    mesh.tangents = (0..mesh.positions.len()).map(tangent).collect();
}

/// Where the texture's u axis points on a triangle.
struct UDirection {
    along: DVec3,
    mirrored: bool,
}

/// `None` where the texture coordinates of the triangle are on a line.
fn direction_of_u(mesh: &Mesh, set: usize, corners: &[u32; 3]) -> Option<UDirection> {
    let [a, b, c] = corners.map(|i| mesh.positions[i as usize].as_dvec3());
    let [s, t, r] = corners.map(|i| mesh.texture_coordinates[set][i as usize].as_dvec2());
    let area = (t - s).perp_dot(r - s);
    // v grows downwards, so that a texture that is not mirrored has negative area.
    let along = ((b - a) * (r - s).y - (c - a) * (t - s).y) * area.signum();
    let along = along.try_normalize()?;
    (area != 0.0).then_some(UDirection { along, mirrored: area > 0.0 })
}

/// Projection into the plane of the vertex, to unit length or 0; without normals only the latter.
fn projection(mesh: &Mesh, vertex: usize) -> impl Fn(DVec3) -> DVec3 {
    let normal = mesh.normals.get(vertex).map_or(DVec3::ZERO, |n| n.as_dvec3());
    move |v| (v - normal * normal.dot(v)).normalize_or_zero()
}

/// Gives mirrored triangles vertices of their own where others use them; returns which vertices are
/// mirrored.
fn split_mirrored(mesh: &mut Mesh, directions: &[Option<UDirection>]) -> Vec<bool> {
    let is_mirrored = |direction: &Option<UDirection>| direction.as_ref().is_some_and(|d| d.mirrored);
    let mut plain = vec![false; mesh.positions.len()];
    for (corners, _) in mesh.triangles.iter().zip(directions).filter(|(_, d)| !is_mirrored(d)) {
        corners.iter().for_each(|&i| plain[i as usize] = true);
    }
    let mut mirrored = vec![false; mesh.positions.len()];
    let mut copies: HashMap<u32, u32> = HashMap::new();
    let mut triangles = std::mem::take(&mut mesh.triangles);
    for (corners, _) in triangles.iter_mut().zip(directions).filter(|(_, d)| is_mirrored(d)) {
        for corner in corners {
            if plain[*corner as usize] {
                *corner = *copies.entry(*corner).or_insert_with(|| copy_vertex(mesh, *corner as usize));
            }
            let vertex = *corner as usize;
            mirrored.resize(mesh.positions.len(), false);
            mirrored[vertex] = true;
        }
    }
    mesh.triangles = triangles;
    mirrored
}

/// Appends a copy of a vertex; returns its index.
fn copy_vertex(mesh: &mut Mesh, vertex: usize) -> u32 {
    fn copy<T: Copy>(attributes: &mut Vec<T>, vertex: usize) {
        if let Some(&value) = attributes.get(vertex) {
            attributes.push(value);
        }
    }
    copy(&mut mesh.positions, vertex);
    copy(&mut mesh.normals, vertex);
    mesh.texture_coordinates.iter_mut().for_each(|coordinates| copy(coordinates, vertex));
    copy(&mut mesh.colors, vertex);
    (mesh.positions.len() - 1) as u32
}

/// For each vertex the first that has the same position, normal, coordinates and handedness.
fn weld(mesh: &Mesh, set: usize, mirrored: &[bool]) -> Vec<usize> {
    let mut first = HashMap::new();
    let key = |vertex: usize| {
        let bits = |v: Vec3| v.to_array().map(f32::to_bits);
        let normal = mesh.normals.get(vertex).copied().unwrap_or_default();
        let coordinates = mesh.texture_coordinates[set][vertex].to_array().map(f32::to_bits);
        (bits(mesh.positions[vertex]), bits(normal), coordinates, mirrored[vertex])
    };
    (0..mesh.positions.len()).map(|vertex| *first.entry(key(vertex)).or_insert(vertex)).collect()
}

#[cfg(test)]
mod tests {
    use glam::{Vec2, Vec4};

    use super::*;

    /// A unit square in the plane z = 0 whose texture stands upright, with u in x.
    fn square() -> Mesh {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        Mesh {
            positions: corners.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec(),
            normals: vec![Vec3::Z; 4],
            texture_coordinates: [corners.map(|[x, y]| Vec2::new(x, 1.0 - y)).to_vec(), Vec::new()],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        }
    }

    #[test]
    fn an_upright_texture_has_its_tangent_to_the_right() {
        let mut mesh = square();
        add_tangents(&mut mesh, 0);
        assert_eq!(mesh.tangents, [Vec4::new(1.0, 0.0, 0.0, 1.0); 4]);
        assert_eq!(mesh.positions.len(), 4);
    }

    #[test]
    fn a_texture_mirrored_in_part_splits_the_vertices_between() {
        let mut mesh = square();
        // The second triangle sees the texture folded back along the diagonal x = y.
        mesh.texture_coordinates[0][3] = Vec2::new(1.0, 1.0);
        add_tangents(&mut mesh, 0);
        assert_eq!(mesh.positions.len(), 6);
        assert_eq!(mesh.triangles, [[0, 1, 2], [4, 5, 3]]);
        assert_eq!(mesh.tangents[1], Vec4::new(1.0, 0.0, 0.0, 1.0));
        // u grows with y there: from (0, 0) with u = 0 to (0, 1) with u = 1.
        let expected = Vec4::new(0.0, 1.0, 0.0, -1.0);
        assert_eq!([3, 4, 5].map(|i| mesh.tangents[i]), [expected; 3]);
    }

    #[test]
    fn equal_vertices_share_their_tangent() {
        // Two triangles bent along an edge whose vertices are there twice.
        let mut mesh = square();
        mesh.positions[3].z = 1.0;
        let (normal, shared) = (Vec3::new(0.0, 0.6, 0.8), [0, 2]);
        shared.iter().for_each(|&i| mesh.normals[i] = normal);
        let mut split = mesh.clone();
        for vertex in shared {
            copy_vertex(&mut split, vertex);
        }
        split.triangles[1] = [4, 5, 3];
        add_tangents(&mut mesh, 0);
        add_tangents(&mut split, 0);
        assert_eq!([0, 2].map(|i| mesh.tangents[i]), [4, 5].map(|i| split.tangents[i]));
        assert!(mesh.tangents[0].truncate().dot(normal).abs() < 4.0 * f32::EPSILON);
    }

    #[test]
    fn coordinates_that_mean_nothing_still_give_unit_tangents() {
        let mut mesh = square();
        mesh.texture_coordinates[0] = vec![Vec2::splat(0.25); 4];
        add_tangents(&mut mesh, 0);
        assert!(
            mesh.tangents.iter().all(|t| t.truncate().is_normalized() && t.truncate().dot(Vec3::Z) == 0.0)
        );
        let mut bare = square();
        add_tangents(&mut bare, 1);
        assert!(bare.tangents.is_empty());
    }
}
