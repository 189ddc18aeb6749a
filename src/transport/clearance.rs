//! Free space in bodies: how far the nearest surface is at least, looked up in a grid instead of asked of a ray caster.
//!
//! Cells that a surface may pass through are marked, and the distance from the centre of each cell to the nearest marked one is kept. A distance
//! changes by no more than a point moves, so what is kept, less the way from the centre, is a lower bound for every point
//! of the cell. To look it up costs one load, where a ray or a query in a hierarchy takes a hundred times as long.
//!
//! All surfaces count that meet the bounding box of the body, not its own alone: in a sphere that touches none of them
//! there is one medium, whatever bodies are nested or overlap.

mod planes;

use glam::{UVec3, Vec3};

use self::planes::{Part, Plane, planes};
use super::substance::Substance;
use crate::math::distance_transform::squared_distances;
use crate::medium::Medium;
use crate::plan::solid::Flaw;
use crate::scene::{Method, Scene, Surface};

/// Cells along the longest side of a bounding box, at most. With more, bounds are closer, and fewer of them found in caches
/// (`benches/sphere_walk.rs`: nothing is won beyond this).
const MOST_CELLS: f32 = 128.0;

/// Cells of all grids together, four bytes each; planes come to less than that.
const BUDGET: f32 = (1 << 23) as f32;

/// The least edge of a cell in mean free paths: what is nearer than that is soon met.
const LEAST_EDGE: f32 = 0.5;

/// How many mean free paths the shortest side of a body's bounding box must have. In thinner bodies most flights end at the
/// surface, and nothing is won (`benches/sphere_walk.rs`: at 10 nothing yet, at 20 a tenth and more).
const LEAST_THICKNESS: f32 = 12.0;

/// How many mean free paths deep light must get. Where it gets less deep, filling the grid takes longer than it saves on a small picture
/// (`benches/sphere_walk.rs`: at 1.8, 8 to 12 % less the grid; at 5.8 a net gain).
const LEAST_DEPTH: f32 = 3.0;

/// Steps of a distance in an edge of a cell.
const RESOLUTION: f32 = 128.0;

/// Values of cells from which on they are indices of planes.
const PLANES: u32 = 1 << 16;

/// How often a triangle is halved at most, so that no coordinate can hold the program.
const MOST_HALVINGS: u32 = 64;

/// Roundings of a position that are allowed for.
const ROUNDINGS: f32 = 16.0;

/// Lower bounds of the distance to the nearest surface, from points in a bounding box.
pub struct Clearance {
    grid: Grid,
    /// Distances from the centres of the cells to a marked one, rounded down, in edges over [`RESOLUTION`]; from [`PLANES`] on
    /// instead the index of a plane.
    cells: Box<[u32]>,
    /// Of cells close to a surface.
    planes: Box<[Plane]>,
}

/// Cubic cells in a box.
struct Grid {
    low: Vec3,
    /// Edge of a cell, m.
    edge: f32,
    cells_per_length: f32,
    counts: UVec3,
    /// More than the rounding of a position, m.
    margin: f32,
}

impl Clearance {
    /// Of the points in the box from `low` to `high` (m) around one of `bodies` that have such a grid, from `triangles`, which had best be wound so that
    /// their normals point to where it will be asked. The body is filled with `medium`. None if no number of cells would do, or light gets no deeper than a cell or a few free paths.
    pub fn new(
        [low, high]: [Vec3; 2],
        medium: &Medium,
        bodies: usize,
        triangles: impl Iterator<Item = [Vec3; 3]>,
    ) -> Option<Self> {
        let grid = Grid::new(low, high, 1.0 / medium.sigma_t().min_component(), bodies)?;
        let depth = depth(medium);
        if grid.edge > depth || depth * medium.sigma_t().max_component() < LEAST_DEPTH {
            return None;
        }
        let counts = grid.counts.to_array().map(|count| count as usize);
        let mut marked = vec![false; counts.iter().product()];
        let (mut parts, mut slack) = (Vec::new(), grid.margin);
        for triangle in triangles {
            let rounding = grid.slack(triangle);
            slack = slack.max(rounding);
            grid.halve(triangle, rounding, 0.5, 0, &mut |part| grid.mark(part, rounding, &mut marked));
            grid.halve(triangle, rounding, planes::LONGEST, 0, &mut |part| parts.push(Part::new(part)));
        }
        let squares = squared_distances(&marked, counts);
        // Rounded down, that of the root included.
        let distance = |square: f32| {
            (square.sqrt() * (RESOLUTION * (1.0 - 2.0 * f32::EPSILON))).min(PLANES as f32 - 1.0) as u32
        };
        let mut cells: Box<[u32]> = squares.iter().map(|square| distance(*square)).collect();
        let near = planes(&grid, &squares, &parts, 2.0 * slack);
        for ((cell, _), index) in near.iter().zip(PLANES..) {
            cells[*cell as usize] = index;
        }
        Some(Self { grid, cells, planes: near.into_iter().map(|(_, plane)| plane).collect() })
    }

    /// A distance, m, within which there is no surface around `point`, which is in the box; 0 or less where none is
    /// known. It leaves room for the rounding of a point at that distance.
    pub fn around(&self, point: Vec3) -> f32 {
        let cell = self.grid.cell(point);
        let offset = point - self.grid.center(cell);
        let value = self.cells[self.grid.index(cell)];
        let distance = match value.checked_sub(PLANES) {
            None => value as f32 * (self.grid.edge / RESOLUTION) - offset.length(),
            Some(index) => self.planes[index as usize].around(offset, self.grid.edge),
        };
        distance - self.grid.margin
    }
}

impl Grid {
    fn new(low: Vec3, high: Vec3, free_path: f32, bodies: usize) -> Option<Self> {
        let size = high - low;
        let most = (BUDGET / bodies as f32).cbrt().floor().clamp(1.0, MOST_CELLS);
        let edge = (size.max_element() / most).max(LEAST_EDGE * free_path);
        if !(size.cmpgt(Vec3::ZERO).all() && edge > 0.0 && edge.is_finite()) {
            return None;
        }
        let cells_per_length = 1.0 / edge;
        Some(Self {
            low,
            edge,
            cells_per_length,
            counts: (size * cells_per_length)
                .ceil()
                .as_uvec3()
                .clamp(UVec3::ONE, UVec3::splat(MOST_CELLS as u32)),
            margin: ROUNDINGS * f32::EPSILON * low.abs().max(high.abs()).max_element(),
        })
    }

    /// The cell of `point`; the nearest along each axis if it is outside.
    fn cell(&self, point: Vec3) -> UVec3 {
        ((point - self.low) * self.cells_per_length).as_uvec3().min(self.counts - 1)
    }

    fn center(&self, cell: UVec3) -> Vec3 {
        self.low + (cell.as_vec3() + 0.5) * self.edge
    }

    fn index(&self, cell: UVec3) -> usize {
        ((cell.z * self.counts.y + cell.y) * self.counts.x + cell.x) as usize
    }

    /// More than the rounding of a point of `triangle` or in the box, m.
    fn slack(&self, triangle: [Vec3; 3]) -> f32 {
        let largest = triangle.map(|corner| corner.abs().max_element()).into_iter().fold(0.0, f32::max);
        self.margin.max(ROUNDINGS * f32::EPSILON * largest)
    }

    /// Calls `visit` with the parts of a triangle, those that are in the box within `slack`: halves of halves, until no edge is longer than
    /// `longest` edges of a cell.
    fn halve(
        &self,
        triangle: [Vec3; 3],
        slack: f32,
        longest: f32,
        halvings: u32,
        visit: &mut impl FnMut([Vec3; 3]),
    ) {
        let [a, b, c] = triangle;
        let (low, high) = (a.min(b).min(c) - slack, a.max(b).max(c) + slack);
        let end = self.low + self.counts.as_vec3() * self.edge;
        if high.cmplt(self.low).any() || low.cmpgt(end).any() {
            return;
        }
        let [ab, bc, ca] = [a.distance_squared(b), b.distance_squared(c), c.distance_squared(a)];
        let square = ab.max(bc).max(ca);
        if square <= (longest * self.edge).powi(2) || halvings >= MOST_HALVINGS {
            return visit(triangle);
        }
        // Begins with the longest edge.
        let [a, b, c] = if ab == square {
            [a, b, c]
        } else if bc == square {
            [b, c, a]
        } else {
            [c, a, b]
        };
        let middle = a.midpoint(b);
        self.halve([a, middle, c], slack, longest, halvings + 1, visit);
        self.halve([middle, b, c], slack, longest, halvings + 1, visit);
    }

    /// Marks the cells within `slack` of the box around a part of a triangle.
    fn mark(&self, [a, b, c]: [Vec3; 3], slack: f32, marked: &mut [bool]) {
        let (low, high) = (a.min(b).min(c) - slack, a.max(b).max(c) + slack);
        let (first, last) = (self.cell(low), self.cell(high));
        for z in first.z..=last.z {
            for y in first.y..=last.y {
                for x in first.x..=last.x {
                    marked[self.index(UVec3::new(x, y, z))] = true;
                }
            }
        }
    }
}

/// By instance: the instances that can have surfaces in it, if it is a body in which it is worth while to know how far they are. `bounds`
/// are the bounding boxes.
pub(super) fn surroundings(
    scene: &Scene,
    substances: &[Substance],
    methods: &[Option<Method>],
    bounds: &[(Vec3, Vec3)],
    flaws: &[(u32, Flaw)],
) -> Vec<Option<Box<[u32]>>> {
    let meets = |(a, b): (Vec3, Vec3), (low, high): (Vec3, Vec3)| a.cmple(high).all() && b.cmpge(low).all();
    (0..substances.len() as u32)
        .map(|instance| {
            let own = bounds[instance as usize];
            // Where the surface has holes, to be away from it is not to be inside.
            let sound = !flaws.iter().any(|&(flawed, flaw)| flawed == instance && flaw != Flaw::InsideOut);
            let walked = methods[instance as usize] == Some(Method::Walk);
            (sound && walked && is_thick(scene, substances[instance as usize], own))
                .then(|| (0..bounds.len() as u32).filter(|&i| meets(bounds[i as usize], own)).collect())
        })
        .collect()
}

/// How deep light gets, m: the diffusion length 1/√(3 σ_a σ_t') of the channel in which that is longest; at least a mean free path.
fn depth(medium: &Medium) -> f32 {
    let length = medium.sigma_a.zip(medium.sigma_t_reduced(), |a, t| 1.0 / (3.0 * a * t).sqrt());
    length.zip(medium.sigma_t(), |length, t| length.max(1.0 / t)).max_component()
}

/// True if a body of `substance` with this bounding box is many mean free paths thick, in all channels.
fn is_thick(scene: &Scene, substance: Substance, (low, high): (Vec3, Vec3)) -> bool {
    let Substance::Material(material) = substance else { return false };
    let Surface::Translucent { medium, .. } = &scene.materials[material].surface else { return false };
    (high - low).min_element() * medium.sigma_t().min_component() >= LEAST_THICKNESS
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sampler::HashGenerator;
    use crate::radiometry::Rgb;
    use crate::raycast::bvh::BvhCaster;
    use crate::raycast::{DistanceQuery, Geometry, MeshInstance, RayCaster, TriangleMesh};
    use crate::scene::shape;
    use glam::{Affine3A, Quat};

    /// A body with a turned box in it, off the origin.
    #[test]
    fn no_surface_is_nearer_and_little_is_given_away() {
        let outer = shape::sphere(Vec3::new(30.0, 0.0, 0.0), 1.0, 4);
        let mut inner = shape::cuboid(Vec3::new(30.3, 0.1, 0.0), Vec3::splat(0.4));
        inner.positions.iter_mut().for_each(|p| *p = Quat::from_rotation_x(0.7) * *p);
        let meshes = [&outer, &inner];
        let views =
            meshes.map(|mesh| TriangleMesh { positions: &mesh.positions, triangles: &mesh.triangles });
        let instances = [0, 1].map(|mesh| MeshInstance { mesh, transform: Affine3A::IDENTITY, probed: true });
        let caster = BvhCaster::new(&Geometry { meshes: &views, instances: &instances }).unwrap();
        let (low, high) = (Vec3::new(29.0, -1.0, -1.0), Vec3::new(31.0, 1.0, 1.0));
        let corners =
            meshes.into_iter().flat_map(|m| m.triangles.iter().map(|t| t.map(|v| m.positions[v as usize])));
        let clearance = Clearance::new([low, high], &medium(100.0), 1, corners).unwrap();
        let mut random = HashGenerator::new(1);
        // The diagonals of the marked cell, of half a cell that the box of a part of a triangle is larger, and of half a cell to the centre, there and back.
        let given_away = 2.5 * 3.0_f32.sqrt() * clearance.grid.edge;
        for _ in 0..20_000 {
            let point = low + Vec3::from_array([(); 3].map(|()| random.next_f32())) * (high - low);
            let exact = [0, 1]
                .map(|i| caster.distance_to_nearest(&DistanceQuery::exact(point), i))
                .into_iter()
                .fold(f32::INFINITY, f32::min);
            let bound = clearance.around(point);
            assert!(bound < exact, "{bound} {exact}");
            assert!(bound > exact - given_away, "{bound} {exact}");
        }
    }

    fn medium(sigma_s: f32) -> Medium {
        Medium { sigma_a: Rgb::ZERO, sigma_s: Rgb::splat(sigma_s), g: 0.0 }
    }

    #[test]
    fn boxes_without_volume_and_numbers_that_are_none_have_no_grid() {
        let at = |size: Vec3, medium: Medium| {
            Clearance::new([Vec3::ZERO, size], &medium, 1, [].into_iter()).is_some()
        };
        assert!(at(Vec3::ONE, medium(100.0)));
        assert!(!at(Vec3::new(1.0, 0.0, 1.0), medium(100.0)));
        assert!(!at(Vec3::new(1.0, f32::NAN, 1.0), medium(100.0)));
        assert!(!at(Vec3::ONE, medium(0.0)));
        assert!(!at(Vec3::splat(f32::INFINITY), medium(100.0)));
        // A cell is 10 free paths then, and light gets through one.
        assert!(!at(Vec3::ONE, Medium { sigma_a: Rgb::splat(1600.0), ..medium(1.0) }));
        assert!(Grid::new(Vec3::ZERO, Vec3::ONE, 0.01, 100_000).unwrap().counts.element_product() < 200);
    }
}
