//! Boxes along the axes.

use glam::{Affine3A, Vec3A, Vec3Swizzles};

/// A box.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    pub low: Vec3A,
    pub high: Vec3A,
}

impl Bounds {
    pub const EMPTY: Self = Self { low: Vec3A::INFINITY, high: Vec3A::NEG_INFINITY };

    /// The box around points.
    pub fn around(points: impl IntoIterator<Item = Vec3A>) -> Self {
        let point = |point| Self { low: point, high: point };
        points.into_iter().map(point).fold(Self::EMPTY, Self::union)
    }

    #[inline]
    pub fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// The box around the image of this one; wider than that by more than the rounding of both ways.
    pub fn transformed(self, transform: &Affine3A) -> Self {
        let corner = |index: usize| {
            let pick = |axis: usize| if index >> axis & 1 == 0 { self.low[axis] } else { self.high[axis] };
            transform.transform_point3a(Vec3A::new(pick(0), pick(1), pick(2)))
        };
        let Self { low, high } = Self::around((0..8).map(corner));
        let margin = Vec3A::splat(16.0 * f32::EPSILON * low.abs().max(high.abs()).max_element());
        Self { low: low - margin, high: high + margin }
    }

    #[inline]
    pub fn half_area(self) -> f32 {
        let size = self.high - self.low;
        size.dot(size.yzx())
    }
}
