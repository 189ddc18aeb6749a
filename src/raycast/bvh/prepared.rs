//! Rays as the test of boxes wants them.

use glam::Vec3A;

use crate::raycast::Ray;

/// A ray for tests of boxes that misses none which the ray meets, whatever the rounding.
///
/// The wall that is n steps s from the corner c of a node is met at n·s/d + (c/d − o/d). What rounding does to that is at most 3 ε (|b| + |o|)/|d|, with
/// b the larger of wall and corner. Near walls are met that much earlier and more, far ones later, with b as large as any coordinate of the hierarchy.
#[derive(Clone, Copy)]
pub struct NodeRay {
    /// 1/d.
    pub inverse: Vec3A,
    /// −o/d for the walls that are met first, and last.
    pub offsets: [Vec3A; 2],
    /// The axes of which the upper wall is met first, by bits.
    negative: u32,
}

/// Walls are moved by so many ε of the coordinates. The test of triangles has roundings of its own, up to 3 ε, and a wall
/// lies beyond what is behind it only when rounded, to ½ ε.
const ROUNDINGS: f32 = 8.0;

/// A component is at least this part of the longest one, so that its reciprocal is finite.
const LEAST_COMPONENT: f32 = 1.0 / (1_u64 << 40) as f32;

impl NodeRay {
    /// `largest`: the largest coordinate of the hierarchy.
    #[inline(always)]
    pub fn new(ray: &Ray, largest: f32) -> Self {
        let (origin, direction) = (Vec3A::from(ray.origin), Vec3A::from(ray.direction));
        let least = direction.abs().max_element() * LEAST_COMPONENT;
        let direction = direction.abs().max(Vec3A::splat(least)).copysign(direction);
        let inverse = direction.recip();
        let offset = -origin * inverse;
        // In this order, the first product need not wait for the reciprocal.
        let slack = (origin.abs() + Vec3A::splat(largest)) * (ROUNDINGS * f32::EPSILON) * inverse.abs();
        let negative = direction.is_negative_bitmask();
        Self { inverse, offsets: [offset - slack, offset + slack], negative }
    }

    /// By axis: 1 if the upper wall is met first, or else 0.
    #[inline(always)]
    pub fn first(&self) -> [usize; 3] {
        [0, 1, 2].map(|axis| (self.negative >> axis & 1) as usize)
    }
}
