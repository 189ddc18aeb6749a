//! Makes even triangles of a wanted number from the slivers of marching tetrahedra: collapse of
//! short edges, Delaunay flips and tangential smoothing by turns (Botsch and Kobbelt 2004), edge
//! lengths by curvature (Dunyach et al. 2013), every vertex put back onto the distance field.

use glam::DVec3;
use rayon::prelude::*;

use super::distance::{Field, project};
use super::polygonise::Surface;

/// A surface with its unit normal at each vertex.
#[derive(Clone, Debug, Default)]
pub struct Shaded {
    /// Positions and triangles.
    pub surface: Surface,
    /// Unit normals, outward.
    pub normals: Vec<DVec3>,
}

/// How fine the surface becomes, in the length unit of the field.
#[derive(Clone, Copy, Debug)]
pub struct Fineness {
    /// Deviation of a triangle from the true surface.
    pub deviation: f64,
    /// Shortest wanted edge.
    pub shortest: f64,
    /// Longest wanted edge.
    pub longest: f64,
}

/// A closed manifold under local changes. Removed triangles are left empty.
struct Mesh {
    positions: Vec<DVec3>,
    normals: Vec<DVec3>,
    wanted: Vec<f64>,
    triangles: Vec<Option<[u32; 3]>>,
    /// Triangles at each vertex; none: the vertex is removed.
    around: Vec<Vec<u32>>,
}

/// The surface of `field` again, with better and fewer triangles.
pub fn remesh(surface: Surface, field: &Field, fineness: Fineness) -> Shaded {
    let mut mesh = Mesh::new(surface);
    for _ in 0..6 {
        mesh.settle(field, fineness.shortest);
        mesh.set_wanted_lengths(fineness);
        mesh.collapse_short_edges();
        mesh.flip_edges();
        mesh.smooth();
    }
    mesh.settle(field, fineness.shortest);
    mesh.flip_edges();
    mesh.unfold();
    mesh.compact()
}

fn area_vector([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

impl Mesh {
    fn new(surface: Surface) -> Self {
        let count = surface.positions.len();
        let mut around = vec![Vec::new(); count];
        for (t, triangle) in surface.triangles.iter().enumerate() {
            triangle.iter().for_each(|&v| around[v as usize].push(t as u32));
        }
        Self {
            positions: surface.positions,
            normals: vec![DVec3::ZERO; count],
            wanted: vec![0.0; count],
            triangles: surface.triangles.into_iter().map(Some).collect(),
            around,
        }
    }

    /// Puts every vertex onto the surface and takes the normal from the field.
    fn settle(&mut self, field: &Field, reach: f64) {
        let live = |v: usize| !self.around[v].is_empty();
        let settled: Vec<(DVec3, DVec3)> = (0..self.positions.len())
            .into_par_iter()
            .map(|v| {
                if !live(v) {
                    return (self.positions[v], DVec3::ZERO);
                }
                project(field, self.positions[v], reach)
            })
            .collect();
        (self.positions, self.normals) = settled.into_iter().unzip();
    }

    /// Live triangles around a vertex, each with the vertex first.
    fn fan(&self, v: u32) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.around[v as usize].iter().filter_map(|&t| self.triangles[t as usize]).map(move |[a, b, c]| {
            match v {
                _ if v == a => [a, b, c],
                _ if v == b => [b, c, a],
                _ => [c, a, b],
            }
        })
    }

    /// Neighbours of a vertex; on a closed manifold each is met once.
    fn neighbours(&self, v: u32) -> impl Iterator<Item = u32> + '_ {
        self.fan(v).map(|[_, b, _]| b)
    }

    fn distance(&self, a: u32, b: u32) -> f64 {
        self.positions[a as usize].distance(self.positions[b as usize])
    }

    /// Edge lengths that keep the wanted deviation where the normal turns as it does, and that do
    /// not change abruptly from vertex to vertex.
    fn set_wanted_lengths(&mut self, fineness: Fineness) {
        let count = self.positions.len() as u32;
        let from_curvature = |v: u32| {
            let curvature = self
                .neighbours(v)
                .map(|n| {
                    let turn = (self.normals[v as usize] - self.normals[n as usize]).length();
                    turn / self.distance(v, n).max(0.3 * fineness.shortest)
                })
                .fold(1e-9, f64::max);
            (6.0 * fineness.deviation / curvature).sqrt().clamp(fineness.shortest, fineness.longest)
        };
        self.wanted = (0..count).map(from_curvature).collect();
        for _ in 0..4 {
            for v in 0..count {
                let graded = self
                    .neighbours(v)
                    .map(|n| self.wanted[n as usize] + 0.4 * self.distance(v, n))
                    .fold(self.wanted[v as usize], f64::min);
                self.wanted[v as usize] = graded;
            }
        }
    }

    fn collapse_short_edges(&mut self) {
        for a in 0..self.positions.len() as u32 {
            let mut tries = 0;
            // A vertex that swallowed a neighbour may swallow the next.
            while tries < 8 {
                tries += 1;
                let shortest = self
                    .neighbours(a)
                    .map(|b| (self.distance(a, b), b))
                    .filter(|&(d, b)| d < 0.8 * self.wanted[a as usize].min(self.wanted[b as usize]))
                    .min_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
                match shortest {
                    Some((_, b)) if self.collapse(a, b) => {}
                    _ => break,
                }
            }
        }
    }

    /// Joins `b` into `a` at their midpoint where the surface stays a manifold of good triangles.
    fn collapse(&mut self, a: u32, b: u32) -> bool {
        let near_b: Vec<u32> = self.neighbours(b).collect();
        let shared: Vec<u32> = self.neighbours(a).filter(|n| near_b.contains(n)).collect();
        let link_is_fine = shared.len() == 2 && shared.iter().all(|&n| self.around[n as usize].len() > 4);
        if !link_is_fine {
            return false;
        }
        let middle = self.positions[a as usize].midpoint(self.positions[b as usize]);
        let wanted = self.wanted[a as usize].min(self.wanted[b as usize]);
        let stays_good = |v: u32, other: u32| {
            self.fan(v).filter(|t| !t.contains(&other)).all(|[_, n, m]| {
                let [p, n, m] = [v, n, m].map(|i| self.positions[i as usize]);
                let (before, after) = (area_vector([p, n, m]), area_vector([middle, n, m]));
                let turned = before.normalize_or_zero().dot(after.normalize_or_zero());
                let longest = middle.distance(n).max(middle.distance(m)).max(n.distance(m));
                // Slivers may turn in any way as long as what comes of them is no sliver.
                let sliver = before.length() < 0.1 * longest * longest;
                let sound = after.length() > 0.1 * longest * longest;
                middle.distance(n) < 1.4 * wanted && (turned > 0.7 || sliver) && (sound || sliver)
            })
        };
        // The surface must not fold: new triangles agree with the normals of the field.
        let normal = self.normals[a as usize] + self.normals[b as usize];
        let unfolded = |v: u32, other: u32| {
            self.fan(v).filter(|t| !t.contains(&other)).all(|[_, n, m]| {
                let [n, m] = [n, m].map(|i| self.positions[i as usize]);
                area_vector([middle, n, m]).dot(normal) > 0.0
            })
        };
        if !(stays_good(a, b) && stays_good(b, a) && unfolded(a, b) && unfolded(b, a)) {
            return false;
        }
        self.positions[a as usize] = middle;
        self.normals[a as usize] = normal.normalize_or_zero();
        self.wanted[a as usize] = wanted;
        for t in std::mem::take(&mut self.around[b as usize]) {
            let Some(mut triangle) = self.triangles[t as usize] else { continue };
            if triangle.contains(&a) {
                self.remove(t, triangle);
            } else {
                triangle.iter_mut().filter(|v| **v == b).for_each(|v| *v = a);
                self.triangles[t as usize] = Some(triangle);
                self.around[a as usize].push(t);
            }
        }
        true
    }

    fn remove(&mut self, t: u32, triangle: [u32; 3]) {
        self.triangles[t as usize] = None;
        for v in triangle {
            self.around[v as usize].retain(|&other| other != t);
        }
    }

    /// Flips edges until nearly Delaunay.
    fn flip_edges(&mut self) {
        for _ in 0..3 {
            for t in 0..self.triangles.len() as u32 {
                for corner in 0..3 {
                    let Some(triangle) = self.triangles[t as usize] else { continue };
                    self.flip(t, [0, 1, 2].map(|i| triangle[(corner + i) % 3]));
                }
            }
        }
    }

    /// Flips the edge a–b of triangle (a, b, c) if the angles opposite to it exceed 180° together.
    fn flip(&mut self, t: u32, [a, b, c]: [u32; 3]) {
        let other = self.around[a as usize]
            .iter()
            .copied()
            .find(|&o| o != t && self.triangles[o as usize].is_some_and(|triangle| triangle.contains(&b)));
        let Some(other) = other else { return };
        let Some(d) = self.triangles[other as usize].and_then(|o| o.into_iter().find(|&v| v != a && v != b))
        else {
            return;
        };
        let [pa, pb, pc, pd] = [a, b, c, d].map(|v| self.positions[v as usize]);
        let cotangent = |apex: DVec3| {
            let (u, v) = (pa - apex, pb - apex);
            u.dot(v) / u.cross(v).length().max(1e-12)
        };
        let crowded = |v: u32| self.around[v as usize].len() <= 4;
        if cotangent(pc) + cotangent(pd) > -1e-3
            || crowded(a)
            || crowded(b)
            || self.neighbours(c).any(|n| n == d)
        {
            return;
        }
        let before = area_vector([pa, pb, pc]) + area_vector([pb, pa, pd]);
        let after = [area_vector([pc, pd, pb]), area_vector([pd, pc, pa])];
        // Flat enough that the flip hardly moves the surface.
        if after.iter().any(|n| n.normalize_or_zero().dot(before.normalize_or_zero()) < 0.8) {
            return;
        }
        self.triangles[t as usize] = Some([c, d, b]);
        self.triangles[other as usize] = Some([d, c, a]);
        self.around[a as usize].retain(|&o| o != t);
        self.around[b as usize].retain(|&o| o != other);
        self.around[d as usize].push(t);
        self.around[c as usize].push(other);
    }

    /// Moves each vertex along the surface towards the middle of its neighbours.
    fn smooth(&mut self) {
        for v in 0..self.positions.len() as u32 {
            let count = self.around[v as usize].len();
            if count == 0 {
                continue;
            }
            let position = self.positions[v as usize];
            let normal = self.normals[v as usize];
            let middle = self.neighbours(v).map(|n| self.positions[n as usize]).sum::<DVec3>() / count as f64;
            let moved = position + 0.6 * (middle - position).reject_from_normalized(normal);
            let unfolded = self.fan(v).all(|[_, n, m]| {
                area_vector([moved, self.positions[n as usize], self.positions[m as usize]]).dot(normal) > 0.0
            });
            if unfolded {
                self.positions[v as usize] = moved;
            }
        }
    }

    /// In narrow creases the field's gradient may lean over a triangle: the mean of the triangles'
    /// own normals stands in there; and where even that leans over one, the surface is folded and
    /// its vertices are drawn together until it is not.
    fn unfold(&mut self) {
        for _ in 0..128 {
            let mut folded = Vec::new();
            for v in 0..self.positions.len() as u32 {
                if self.leans(v) {
                    let planes = self.fan(v).map(|t| self.plane(t));
                    self.normals[v as usize] = planes.sum::<DVec3>().normalize_or_zero();
                    if self.leans(v) {
                        folded.push(v);
                    }
                }
            }
            if folded.is_empty() {
                return;
            }
            for v in folded {
                let nearby: Vec<u32> = self.neighbours(v).chain([v]).collect();
                for n in nearby {
                    let count = self.around[n as usize].len() as f64;
                    let middle =
                        self.neighbours(n).map(|m| self.positions[m as usize]).sum::<DVec3>() / count;
                    self.positions[n as usize] = self.positions[n as usize].midpoint(middle);
                }
            }
        }
    }

    /// Unit normal of a triangle.
    fn plane(&self, triangle: [u32; 3]) -> DVec3 {
        area_vector(triangle.map(|v| self.positions[v as usize])).normalize_or_zero()
    }

    /// True if the normal at `v` is more than 84° from that of a triangle around it.
    fn leans(&self, v: u32) -> bool {
        self.fan(v).any(|t| self.plane(t).dot(self.normals[v as usize]) < 0.1)
    }

    /// Live vertices and triangles alone.
    fn compact(self) -> Shaded {
        let mut renamed = vec![u32::MAX; self.positions.len()];
        let mut surface = Surface::default();
        let mut normals = Vec::new();
        for triangle in self.triangles.into_iter().flatten() {
            surface.triangles.push(triangle.map(|v| {
                let name = &mut renamed[v as usize];
                if *name == u32::MAX {
                    *name = surface.positions.len() as u32;
                    surface.positions.push(self.positions[v as usize]);
                    normals.push(self.normals[v as usize]);
                }
                *name
            }));
        }
        Shaded { surface, normals }
    }
}
