//! Distances close to a surface: from a plane behind which all of the surface lies that is near a cell.
//!
//! If all that is near lies behind a plane, a point in front of it is at least as far from all of that as from the
//! plane. Where surfaces are smooth on the scale of a cell the plane touches them, and the bound is next to exact; the
//! distance to whole cells would give away up to two and a half diagonals of a cell, which is where most light is.

use glam::{UVec3, Vec3, Vec4};
use rayon::prelude::*;

use super::Grid;

/// How far around the centre of a cell surfaces count, in edges, along each axis.
pub const REACH: f32 = 2.5;

/// The longest edge of a part of a triangle, in edges of a cell: what counts for a cell is a part as a whole.
pub const LONGEST: f32 = 2.0;

/// Layers of cells that are worked on together.
const LAYERS: usize = 8;

/// No plane in the making.
const NONE: u32 = u32::MAX;

/// A plane behind which all surfaces near a cell lie.
#[derive(Clone, Copy)]
pub struct Plane {
    /// Unit normal, away from the surfaces.
    normal: Vec3,
    /// How far in front of it the centre of the cell is, m; may be negative.
    height: f32,
}

impl Plane {
    /// A distance within which there is no surface around the point `offset` from the centre of the cell, m.
    pub fn around(&self, offset: Vec3, edge: f32) -> f32 {
        let beyond = REACH * edge - offset.abs().max_element();
        (self.height + self.normal.dot(offset)).min(beyond)
    }
}

/// A part of a triangle.
pub struct Part {
    corners: [Vec3; 3],
    /// Normal, as long as twice the area.
    normal: Vec3,
    low: Vec3,
    high: Vec3,
}

impl Part {
    pub fn new(corners: [Vec3; 3]) -> Self {
        let [a, b, c] = corners;
        Self { corners, normal: (b - a).cross(c - a), low: a.min(b).min(c), high: a.max(b).max(c) }
    }
}

/// The planes of cells in which they tell more than `squares`, the squared distances of the cells from marked ones in edges:
/// by index of the cell, in rising order. `slack` (m) is more than the rounding of any point.
pub fn planes(grid: &Grid, squares: &[f32], parts: &[Part], slack: f32) -> Vec<(u32, Plane)> {
    let layers: Vec<_> = (0..grid.counts.z).step_by(LAYERS).collect();
    let slab = |first: u32| Slab::new(grid, squares, first).planes(squares, parts, slack);
    layers.into_par_iter().flat_map_iter(slab).collect()
}

/// Some layers of cells.
struct Slab<'a> {
    grid: &'a Grid,
    /// The first layer, and the one after the last.
    layers: [u32; 2],
    /// By cell: where its plane is in the making.
    places: Vec<u32>,
    /// The cells that are near enough to a surface.
    cells: Vec<UVec3>,
}

impl<'a> Slab<'a> {
    fn new(grid: &'a Grid, squares: &[f32], first: u32) -> Self {
        let last = (first + LAYERS as u32).min(grid.counts.z);
        let mut slab = Self { grid, layers: [first, last], places: Vec::new(), cells: Vec::new() };
        let [start, end] = slab.layers.map(|z| grid.index(UVec3::new(0, 0, z)));
        slab.places = vec![NONE; end - start];
        let [nx, ny, _] = grid.counts.to_array();
        for (index, place) in (start as u32..).zip(&mut slab.places) {
            if squares[index as usize] < REACH * REACH {
                *place = slab.cells.len() as u32;
                slab.cells.push(UVec3::new(index % nx, index / nx % ny, index / (nx * ny)));
            }
        }
        slab
    }

    fn planes(&self, squares: &[f32], parts: &[Part], slack: f32) -> Vec<(u32, Plane)> {
        let normals = self.normals(parts);
        let mut heights = vec![f32::INFINITY; normals.len()];
        for part in parts {
            self.each_near(part, |place, center| {
                let normal = normals[place];
                let height = |corner: Vec3| normal.dot(center - corner);
                let [a, b, c] = part.corners.map(height);
                heights[place] = heights[place].min(a.min(b).min(c));
            });
        }
        let edge = self.grid.edge;
        let plane = |((cell, normal), height): ((&UVec3, Vec3), f32)| {
            let height = height - slack;
            let index = self.grid.index(*cell);
            // In the best corner of the cell, and at its centre.
            let tells = normal != Vec3::ZERO
                && height + 0.5 * edge * normal.abs().element_sum() > 0.0
                && height > squares[index].sqrt() * edge - edge;
            tells.then_some((index as u32, Plane { normal, height }))
        };
        self.cells
            .iter()
            .zip(normals.iter().copied())
            .zip(heights.iter().copied())
            .filter_map(plane)
            .collect()
    }

    /// By place: the mean normal of what is near; zero if the cell lies behind it.
    fn normals(&self, parts: &[Part]) -> Vec<Vec3> {
        let mut sums = vec![Vec4::ZERO; self.cells.len()];
        for part in parts {
            self.each_near(part, |place, center| {
                sums[place] += part.normal.extend(part.normal.dot(center - part.corners[0]));
            });
        }
        let behind = -0.9 * self.grid.edge;
        let normal = |sum: Vec4| {
            let length = sum.truncate().length();
            if length > 0.0 && sum.w > behind * length { sum.truncate() / length } else { Vec3::ZERO }
        };
        sums.into_iter().map(normal).collect()
    }

    /// Calls `visit` with place and centre of each cell in whose reach `part` is.
    fn each_near(&self, part: &Part, mut visit: impl FnMut(usize, Vec3)) {
        let reach = REACH * self.grid.edge;
        let first = self.grid.cell(part.low - reach);
        let last = self.grid.cell(part.high + reach);
        let [start, end] = self.layers;
        let counts = self.grid.counts;
        for z in first.z.max(start)..(last.z + 1).min(end) {
            for y in first.y..=last.y {
                let row = ((z - start) * counts.y + y) * counts.x;
                for x in first.x..=last.x {
                    let place = self.places[(row + x) as usize];
                    if place != NONE {
                        visit(place as usize, self.grid.center(UVec3::new(x, y, z)));
                    }
                }
            }
        }
    }
}
