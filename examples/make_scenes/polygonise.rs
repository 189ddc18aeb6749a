//! Marching tetrahedra: a closed, outward-oriented manifold from a signed distance field.
//!
//! Each cube of a regular lattice is cut into the six tetrahedra of Kuhn's subdivision, which fit
//! together from cube to cube, so the surface has neither cracks nor edges of more than two
//! triangles, whatever the field (Doi and Koide 1991). The triangles are uneven; `remesh` mends that.

use std::collections::HashMap;

use glam::{DVec3, IVec3};
use rayon::prelude::*;

use super::distance::Field;

/// Vertices and triangles, counter-clockwise seen from outside.
#[derive(Clone, Debug, Default)]
pub struct Surface {
    /// Vertex positions.
    pub positions: Vec<DVec3>,
    /// Vertex indices.
    pub triangles: Vec<[u32; 3]>,
}

/// Cubes to the side of a block that is skipped when the surface cannot pass through it.
const BLOCK: i32 = 4;

/// Corners of the six tetrahedra, as bit masks of x = 1, y = 2, z = 4; each positively oriented.
const TETRAHEDRA: [[usize; 4]; 6] =
    [[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]];

/// Surface of `field` within the box from `low` to `high`, on a lattice of cubes of side `cell`.
/// The surface must lie inside the box, or it is left open.
pub fn polygonise(field: &Field, low: DVec3, high: DVec3, cell: f64) -> Surface {
    let blocks = ((high - low) / (cell * f64::from(BLOCK))).ceil().as_ivec3();
    let order: Vec<IVec3> = (0..blocks.z)
        .flat_map(|z| (0..blocks.y).flat_map(move |y| (0..blocks.x).map(move |x| IVec3::new(x, y, z))))
        .collect();
    let soups: Vec<_> = order.par_iter().map(|&block| march_block(field, low, cell, block)).collect();
    weld(soups.into_iter().flatten())
}

/// A vertex of the surface: the lattice edge it lies on, and where.
type EdgeVertex = ([IVec3; 2], DVec3);

/// Triangles of one block of cubes.
fn march_block(field: &Field, low: DVec3, cell: f64, block: IVec3) -> Vec<[EdgeVertex; 3]> {
    let side = cell * f64::from(BLOCK);
    let center = low + (block.as_dvec3() + 0.5) * side;
    // Half the diagonal, with slack for fields that are not exact distances.
    if field(center).abs() > 1.6 * 0.867 * side {
        return Vec::new();
    }
    let place = |lattice: IVec3| low + lattice.as_dvec3() * cell;
    let first = block * BLOCK;
    let row = BLOCK + 1;
    let index = |v: IVec3| ((v.z * row + v.y) * row + v.x) as usize;
    let values: Vec<f64> = (0..row * row * row)
        .map(|i| field(place(first + IVec3::new(i % row, i / row % row, i / (row * row)))))
        .collect();

    let mut triangles = Vec::new();
    for i in 0..BLOCK * BLOCK * BLOCK {
        let cube = IVec3::new(i % BLOCK, i / BLOCK % BLOCK, i / (BLOCK * BLOCK));
        let corner = |mask: usize| cube + IVec3::new(mask as i32 & 1, mask as i32 >> 1 & 1, mask as i32 >> 2);
        for tetrahedron in TETRAHEDRA {
            let corners = tetrahedron.map(corner);
            let value = corners.map(|c| values[index(c)]);
            let vertex = |a: usize, b: usize| -> EdgeVertex {
                // From the smaller corner, so that all tetrahedra around an edge agree to the bit.
                let swap = index(corners[a]) > index(corners[b]);
                let (a, b) = if swap { (b, a) } else { (a, b) };
                let (from, to) = (first + corners[a], first + corners[b]);
                let t = (value[a] / (value[a] - value[b])).clamp(0.02, 0.98);
                ([from, to], place(from).lerp(place(to), t))
            };
            march_tetrahedron(value.map(|v| v < 0.0), vertex, &mut triangles);
        }
    }
    triangles
}

/// Triangles that part the inner from the outer corners of one positively oriented tetrahedron.
fn march_tetrahedron(
    inside: [bool; 4],
    vertex: impl Fn(usize, usize) -> EdgeVertex,
    triangles: &mut Vec<[EdgeVertex; 3]>,
) {
    let inner: Vec<usize> = (0..4).filter(|&i| inside[i]).collect();
    let outer: Vec<usize> = (0..4).filter(|&i| !inside[i]).collect();
    // Inner corners first: an even permutation keeps the orientation, an odd one reverses it.
    let permutation: Vec<usize> = inner.iter().chain(&outer).copied().collect();
    let odd =
        (0..4).flat_map(|i| (0..i).map(move |j| (j, i))).filter(|&(j, i)| permutation[j] > permutation[i]);
    let reversed = odd.count() % 2 == 1;
    let mut push = |t: [EdgeVertex; 3]| triangles.push(if reversed { [t[0], t[2], t[1]] } else { t });
    match (inner.as_slice(), outer.as_slice()) {
        (&[a], &[b, c, d]) => push([vertex(a, b), vertex(a, c), vertex(a, d)]),
        (&[a, b, c], &[d]) => push([vertex(a, d), vertex(b, d), vertex(c, d)]),
        (&[a, b], &[c, d]) => {
            push([vertex(a, c), vertex(a, d), vertex(b, d)]);
            push([vertex(a, c), vertex(b, d), vertex(b, c)]);
        }
        _ => {}
    }
}

/// Joins the vertices that lie on the same lattice edge.
fn weld(soup: impl Iterator<Item = [EdgeVertex; 3]>) -> Surface {
    let mut known: HashMap<[IVec3; 2], u32> = HashMap::new();
    let mut surface = Surface::default();
    for triangle in soup {
        let indices = triangle.map(|(edge, position)| {
            *known.entry(edge).or_insert_with(|| {
                surface.positions.push(position);
                surface.positions.len() as u32 - 1
            })
        });
        surface.triangles.push(indices);
    }
    surface
}
