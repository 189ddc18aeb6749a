//! Whether a mesh is the closed surface of a body with an inside, which a walk relies on.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use crate::scene::Mesh;

/// What is wrong with the mesh of a translucent body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flaw {
    /// The surface ends at so many edges.
    Open(usize),
    /// At so many edges the triangles on either side disagree on what is outside.
    Twisted(usize),
    /// All normals point inward.
    InsideOut,
    /// There is no inside.
    Flat,
}

impl Flaw {
    /// What to tell the user of the object `name`, and what is assumed.
    pub fn message(&self, name: &str) -> String {
        match self {
            Self::Open(edges) => format!(
                "object \"{name}\": its surface is open at {edges} edges; what scatters inside is taken to fill its \
                 bounding box behind the holes, and light to pass through them"
            ),
            Self::Twisted(edges) => format!(
                "object \"{name}\": triangles are wound against their neighbours at {edges} edges; light passes \
                 through those that face the wrong way"
            ),
            Self::InsideOut => format!(
                "object \"{name}\": its triangles are wound inside out; they are taken to face outward"
            ),
            Self::Flat => format!("object \"{name}\": it encloses no volume; nothing scatters in it"),
        }
    }
}

/// Volume over area times diameter below which single-precision coordinates cannot tell a body from a sheet.
const FLAT: f64 = 1e-7;

/// What is wrong with `mesh` as the surface of a body.
pub fn flaws(mesh: &Mesh) -> Vec<Flaw> {
    let volume = relative_volume(mesh);
    if volume.is_nan() || volume.abs() <= FLAT {
        return vec![Flaw::Flat];
    }
    let (open, twisted) = unpaired_edges(mesh);
    let found = [
        (open > 0).then_some(Flaw::Open(open)),
        (twisted > 0).then_some(Flaw::Twisted(twisted)),
        (volume < 0.0).then_some(Flaw::InsideOut),
    ];
    found.into_iter().flatten().collect()
}

/// True if `mesh` is closed and all its normals point inward. Most meshes are told by their volume alone, which is much less work than
/// [`flaws`].
pub fn is_inside_out(mesh: &Mesh) -> bool {
    relative_volume(mesh) < -FLAT && unpaired_edges(mesh) == (0, 0)
}

/// Volume over area times diameter of the bounding box, negative if the triangles face inward; NaN without area. Where the
/// surface is open, the cone to the middle of the box closes it.
fn relative_volume(mesh: &Mesh) -> f64 {
    let bounds = |(low, high): (Vec3, Vec3), p: &Vec3| (low.min(*p), high.max(*p));
    let (low, high) = mesh.positions.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), bounds);
    let middle = 0.5 * (low.as_dvec3() + high.as_dvec3());
    let (mut volume, mut area) = (0.0, 0.0);
    for triangle in &mesh.triangles {
        let [a, b, c]: [DVec3; 3] = triangle.map(|v| mesh.positions[v as usize].as_dvec3() - middle);
        let normal = (b - a).cross(c - a);
        volume += a.dot(normal) / 6.0;
        area += 0.5 * normal.length();
    }
    volume / (area * (high.as_dvec3() - low.as_dvec3()).length())
}

/// For each vertex a number, the same for all at one position.
pub(super) fn places(mesh: &Mesh) -> Vec<usize> {
    let mut places = HashMap::with_capacity(mesh.positions.len());
    let number = |p: &Vec3| {
        let next = places.len();
        // Adding 0 makes −0 the same as 0.
        *places.entry((*p + Vec3::ZERO).to_array().map(f32::to_bits)).or_insert(next)
    };
    mesh.positions.iter().map(number).collect()
}

/// The edges at which the surface ends, and those at which two triangles are wound against each other. Vertices at the
/// same position are one.
fn unpaired_edges(mesh: &Mesh) -> (usize, usize) {
    let vertices = places(mesh);
    // How often each edge is used, and in one direction more than in the other.
    let mut edges: HashMap<(usize, usize), (u32, i32)> = HashMap::with_capacity(mesh.triangles.len() * 3 / 2);
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| vertices[v as usize]);
        for (from, to) in [(a, b), (b, c), (c, a)] {
            if from != to {
                let edge = edges.entry((from.min(to), from.max(to))).or_default();
                edge.0 += 1;
                edge.1 += if from < to { 1 } else { -1 };
            }
        }
    }
    let (mut open, mut twisted) = (0, 0);
    for (uses, excess) in edges.into_values().filter(|&(_, excess)| excess != 0) {
        match (uses, excess) {
            (2, _) => twisted += 1,
            _ => open += 1,
        }
    }
    (open, twisted)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shape;

    fn cube() -> Mesh {
        shape::cuboid(Vec3::new(3.0, 0.0, -2.0), Vec3::ONE)
    }

    #[test]
    fn closed_surfaces_have_no_flaw() {
        for mesh in
            [cube(), shape::sphere(Vec3::Y, 1e-3, 4), shape::cuboid(Vec3::ZERO, Vec3::new(1.0, 1e-4, 1.0))]
        {
            assert_eq!(flaws(&mesh), []);
        }
    }

    #[test]
    fn each_flaw_is_found() {
        let mut open = cube();
        open.triangles.pop();
        assert_eq!(flaws(&open), [Flaw::Open(3)]);
        let mut twisted = cube();
        twisted.triangles[5].swap(0, 1);
        assert_eq!(flaws(&twisted), [Flaw::Twisted(3)]);
        let mut inside_out = cube();
        inside_out.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        assert_eq!(flaws(&inside_out), [Flaw::InsideOut]);
        assert!(is_inside_out(&inside_out) && !is_inside_out(&cube()));
        inside_out.triangles.pop();
        assert!(!is_inside_out(&inside_out), "an open surface has two sides");
        let sheet = shape::quad(Vec3::ZERO, Vec3::X, Vec3::Y);
        let folded = shape::cuboid(Vec3::ZERO, Vec3::new(1.0, 0.0, 1.0));
        for flat in [sheet, folded, Mesh::default()] {
            assert_eq!(flaws(&flat), [Flaw::Flat]);
        }
    }
}
