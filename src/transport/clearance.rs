//! Free space in bodies: how far the nearest surface is at least, asked of a grid instead of a ray caster.
//!
//! The distance to the nearest surface changes by no more than a point moves. What it is at the centre of a cell, less
//! the way from there, is therefore a lower bound for every point of the cell. A cell is filled the first time that a walk asks for it,
//! by whichever thread; its number does not depend on that. What is asked for most costs one load then, where a ray or a query
//! in the hierarchy takes a hundred times as long.
//!
//! All surfaces count that meet the bounding box of the body, not its own alone: in a sphere that touches none of them
//! there is one medium, whatever bodies are nested or overlap.

use std::sync::atomic::{AtomicU32, Ordering};

use glam::{UVec3, Vec3};

use super::solid::Flaw;
use super::substance::{Substance, is_walked};
use crate::raycast::{DistanceQuery, RayCaster};
use crate::scene::{Scene, Surface};

/// Cells along the longest side of a bounding box.
const CELLS: f32 = 64.0;

/// The least edge of a cell in mean free paths: what is nearer than that is soon met.
const LEAST_CELL: f32 = 0.25;

/// How many mean free paths the shortest side of a body's bounding box must have. In thinner bodies most flights end at the
/// surface, and nothing is won.
const LEAST_THICKNESS: f32 = 4.0;

/// A cell that is not filled.
const UNKNOWN: u32 = 0;

/// Low bits of a distance that are dropped: equally near triangles give distances that differ by roundings, and which of them is
/// found depends on how the hierarchy was built.
const DROPPED_BITS: u32 = 0xfff;

/// Lower bounds of the distance to the nearest surface, from points in a bounding box.
pub struct Clearance {
    low: Vec3,
    /// Edge of a cell, m.
    edge: f32,
    cells_per_length: f32,
    counts: UVec3,
    /// Distances from the centres of the cells in single precision, by bits.
    cells: Box<[AtomicU32]>,
    /// More than the rounding of a position, m.
    margin: f32,
    /// What has surfaces in the box.
    instances: Box<[u32]>,
}

impl Clearance {
    /// Of the points in the box from `low` to `high` (m), in which light flies `free_path` (m) between collisions,
    /// from the surfaces of `instances`. None if no number of cells would do.
    pub fn new(low: Vec3, high: Vec3, free_path: f32, instances: &[u32]) -> Option<Self> {
        let size = high - low;
        let edge = (size.max_element() / CELLS).max(LEAST_CELL * free_path);
        if !(size.min_element() > 0.0 && edge > 0.0 && edge.is_finite()) {
            return None;
        }
        let cells_per_length = 1.0 / edge;
        let counts = (size * cells_per_length).ceil().as_uvec3().max(UVec3::ONE);
        let total: usize = counts.to_array().into_iter().map(|count| count as usize).product();
        const ROUNDINGS: f32 = 16.0;
        Some(Self {
            low,
            edge,
            cells_per_length,
            counts,
            cells: (0..total).map(|_| AtomicU32::new(UNKNOWN)).collect(),
            margin: ROUNDINGS * f32::EPSILON * low.abs().max(high.abs()).max_element(),
            instances: instances.into(),
        })
    }

    /// A distance, m, within which there is no surface around `point`, which is in the box; 0 or less where none is
    /// known. It leaves room for the rounding of a point at that distance.
    pub fn around<C: RayCaster>(&self, point: Vec3, caster: &C) -> f32 {
        // Points outside, by rounding, belong to the next cell.
        let cell = ((point - self.low) * self.cells_per_length).as_uvec3().min(self.counts - 1);
        let center = self.low + (cell.as_vec3() + 0.5) * self.edge;
        let index = (cell.z * self.counts.y + cell.y) * self.counts.x + cell.x;
        let slot = &self.cells[index as usize];
        let bits = match slot.load(Ordering::Relaxed) {
            UNKNOWN => self.fill(slot, center, caster),
            known => known,
        };
        f32::from_bits(bits) - point.distance(center) - self.margin
    }

    /// Finds the distance from `center`. Two threads may do so at once: they find the same.
    #[cold]
    fn fill<C: RayCaster>(&self, slot: &AtomicU32, center: Vec3, caster: &C) -> u32 {
        // Where the surface is nearer than half an edge, points far from the centre learn nothing.
        let least = 0.5 * self.edge;
        let distance = self.instances.iter().fold(f32::MAX, |limit, &instance| {
            let query = DistanceQuery { point: center, limit, least, tolerance: 0.0 };
            caster.distance_to_nearest(&query, instance).min(limit)
        });
        let bits = (distance.to_bits() & !DROPPED_BITS).max(f32::MIN_POSITIVE.to_bits());
        slot.store(bits, Ordering::Relaxed);
        bits
    }
}

/// By instance: the instances that can have surfaces in it, if it is a body in which it is worth while to know how far they are. `bounds`
/// are the bounding boxes.
pub(super) fn surroundings(
    scene: &Scene,
    substances: &[Substance],
    bounds: &[(Vec3, Vec3)],
    flaws: &[(u32, Flaw)],
) -> Vec<Option<Box<[u32]>>> {
    let meets = |(a, b): (Vec3, Vec3), (low, high): (Vec3, Vec3)| a.cmple(high).all() && b.cmpge(low).all();
    (0..substances.len() as u32)
        .map(|instance| {
            let own = bounds[instance as usize];
            // Where the surface has holes, to be away from it is not to be inside.
            let sound = !flaws.iter().any(|&(flawed, flaw)| flawed == instance && flaw != Flaw::InsideOut);
            (sound && is_thick(scene, substances[instance as usize], own))
                .then(|| (0..bounds.len() as u32).filter(|&i| meets(bounds[i as usize], own)).collect())
        })
        .collect()
}

/// True if paths walk in `substance` and a body of it with this bounding box is many mean free paths thick, in all
/// channels.
fn is_thick(scene: &Scene, substance: Substance, (low, high): (Vec3, Vec3)) -> bool {
    if !is_walked(scene, substance) {
        return false;
    }
    free_path(scene, substance)
        .is_some_and(|free_path| (high - low).min_element() >= LEAST_THICKNESS * free_path)
}

/// The mean free path in `substance`, of the channel that has the longest, m; `None` if it does not scatter.
pub(super) fn free_path(scene: &Scene, substance: Substance) -> Option<f32> {
    let Substance::Material(material) = substance else { return None };
    match &scene.materials[material].surface {
        Surface::Translucent { medium, .. } => Some(1.0 / medium.sigma_t().min_component()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sampler::HashGenerator;
    use crate::raycast::bvh::BvhCaster;
    use crate::raycast::{Geometry, MeshInstance, TriangleMesh};
    use crate::scene::shape;
    use glam::Affine3A;

    /// A body with another in it, off the origin.
    #[test]
    fn no_surface_is_nearer_and_little_is_given_away() {
        let outer = shape::sphere(Vec3::new(30.0, 0.0, 0.0), 1.0, 4);
        let inner = shape::cuboid(Vec3::new(30.5, 0.0, 0.0), Vec3::splat(0.3));
        let meshes = [&outer, &inner]
            .map(|mesh| TriangleMesh { positions: &mesh.positions, triangles: &mesh.triangles });
        let instances =
            [0, 1].map(|mesh| MeshInstance { mesh, transform: Affine3A::IDENTITY, probed: true });
        let caster = BvhCaster::new(&Geometry { meshes: &meshes, instances: &instances }).unwrap();
        let (low, high) = (Vec3::new(29.0, -1.0, -1.0), Vec3::new(31.0, 1.0, 1.0));
        let clearance = Clearance::new(low, high, 0.01, &[0, 1]).unwrap();
        let mut random = HashGenerator::new(1);
        // Half the diagonal of a cell each way, and the 12 bits dropped.
        let given_away = 2.0 * 0.5 * 3.0_f32.sqrt() * clearance.edge + 1e-3;
        for _ in 0..20_000 {
            let point = low + Vec3::from_array([(); 3].map(|()| random.next_f32())) * (high - low);
            let exact = [0, 1]
                .map(|i| caster.distance_to_nearest(&DistanceQuery::exact(point), i))
                .into_iter()
                .fold(f32::INFINITY, f32::min);
            let bound = clearance.around(point, &caster);
            assert!(bound < exact, "{bound} {exact}");
            // Near the surface nothing is known.
            assert!(bound > exact - given_away || exact < given_away + 0.5 * clearance.edge, "{bound} {exact}");
        }
    }

    #[test]
    fn boxes_without_volume_and_numbers_that_are_none_have_no_grid() {
        let at = |size: Vec3, free_path| Clearance::new(Vec3::ZERO, size, free_path, &[]).is_some();
        assert!(at(Vec3::ONE, 0.01));
        assert!(!at(Vec3::new(1.0, 0.0, 1.0), 0.01));
        assert!(!at(Vec3::new(1.0, f32::NAN, 1.0), 0.01));
        assert!(!at(Vec3::ONE, f32::INFINITY));
        assert!(!at(Vec3::splat(f32::INFINITY), 0.01));
    }
}
