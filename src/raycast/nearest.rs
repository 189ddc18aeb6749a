//! How far a point is from the nearest triangle: the search that every backend makes in its own hierarchy.

use glam::{Affine3A, DAffine3, DVec3, Vec3};
use nalgebra::Matrix3;

use super::DistanceQuery;

/// Between the world and the space of a mesh that is placed several times.
#[derive(Clone, Debug)]
pub(super) struct ObjectSpace {
    pub(super) to_object: DAffine3,
    to_world: DAffine3,
    /// By how much distances grow at most from the world to the object.
    growth: f64,
}

impl ObjectSpace {
    pub(super) fn new(transform: &Affine3A) -> Self {
        let to_world = transform.as_daffine3();
        let to_object = to_world.inverse();
        let linear = Matrix3::from_column_slice(&to_object.matrix3.to_cols_array());
        // Of a transform that cannot be inverted not finite: then nothing is left out of the search.
        let growth =
            if linear.iter().all(|x| x.is_finite()) { linear.singular_values().max() } else { f64::INFINITY };
        Self { to_object, to_world, growth }
    }
}

/// The search for the triangle nearest to a point.
///
/// Distances are computed in double precision from the vertices as they are, in the world. Hierarchies work in
/// single precision and in their own space; they are asked for everything within a radius that is rounded up.
pub(super) struct Nearest<'a> {
    point: DVec3,
    space: Option<&'a ObjectSpace>,
    /// One minus the tolerance, and its square.
    kept: f64,
    kept_squared: f64,
    /// Square of the distance below which it does not matter.
    least_squared: f64,
    /// Square of the distance to the nearest triangle so far, or of the limit.
    squared: f64,
    /// Square of the distance from the point to the farthest corner of that triangle.
    reach_squared: f64,
    /// Square of how far from the local point is searched.
    radius_squared: f32,
}

/// Relative rounding of single precision.
const ROUNDING: f64 = f32::EPSILON as f64;

impl<'a> Nearest<'a> {
    /// The search that `query` asks for, in triangles that lie in `space`; none means the world.
    pub(super) fn new(query: &DistanceQuery, space: Option<&'a ObjectSpace>) -> Self {
        // 0 for NaN too, and for a point that is none: then nothing is nearer.
        let limit = if query.point.is_finite() { f64::from(query.limit.max(0.0)) } else { 0.0 };
        let kept = 1.0 - f64::from(query.tolerance.clamp(0.0, 1.0));
        let least = f64::from(query.least.max(0.0));
        let mut search = Self {
            point: query.point.as_dvec3(),
            space,
            kept,
            kept_squared: kept * kept,
            least_squared: least * least,
            squared: limit * limit,
            reach_squared: 0.0,
            radius_squared: 0.0,
        };
        search.update_radius(limit);
        search
    }

    /// The point in the space of the triangles.
    pub(super) fn local_point(&self) -> Vec3 {
        let local = self.space.map_or(self.point, |space| space.to_object.transform_point3(self.point));
        local.as_vec3()
    }

    /// Square of the distance from the local point beyond which triangles need not be offered.
    pub(super) fn radius_squared(&self) -> f32 {
        self.radius_squared
    }

    /// Triangles farther than this from the local point need not be offered.
    #[cfg(feature = "embree")]
    pub(super) fn radius(&self) -> f32 {
        self.radius_squared.sqrt().next_up()
    }

    /// Makes the search reach as far as `radius` in the world.
    fn update_radius(&mut self, mut radius: f64) {
        if let Some(space) = self.space {
            // The local point is rounded, each coordinate by half a unit in the last place.
            let error = ROUNDING * f64::from(self.local_point().abs().max_element());
            radius = radius * space.growth + error;
        }
        // Eight roundings in the tests of a hierarchy's boxes, and that of the conversion.
        self.radius_squared = (radius * radius * (1.0 + 16.0 * ROUNDING)) as f32;
    }

    /// Looks at a triangle; true if it is nearer than all before, by more than the tolerance.
    pub(super) fn offer(&mut self, corners: [Vec3; 3]) -> bool {
        let corners = corners.map(|corner| {
            let corner = corner.as_dvec3();
            self.space.map_or(corner, |space| space.to_world.transform_point3(corner)) - self.point
        });
        // Most triangles that are offered are farther, which their boxes tell for a fraction of the work.
        let [a, b, c] = corners;
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let to_box = low.max(-high).max(DVec3::ZERO).length_squared();
        if to_box > self.kept_squared * self.squared {
            return false;
        }
        let squared = squared_distance(corners);
        // False for NaN.
        let nearer = squared < self.squared;
        if nearer {
            // At 0 the search ends.
            self.squared = if squared < self.least_squared { 0.0 } else { squared };
            self.reach_squared = corners.map(DVec3::length_squared).into_iter().fold(0.0, f64::max);
            self.update_radius(self.kept * self.squared.sqrt());
        }
        nearer
    }

    /// What the distance to the nearest triangle is at least.
    ///
    /// [`squared_distance`] is exact to √ε of the triangle's reach at worst, 1.5·10⁻⁸ (see there). What a hierarchy left out
    /// is farther than the radius. Four roundings of single precision off the distance, and half a one off the reach, cover
    /// both and the conversion of the result.
    pub(super) fn lower_bound(&self) -> f32 {
        let (distance, reach) = (self.squared.sqrt(), self.reach_squared.sqrt());
        if reach == 0.0 {
            // The limit.
            return distance as f32;
        }
        (self.kept * distance * (1.0 - 4.0 * ROUNDING) - 0.5 * ROUNDING * reach).max(0.0) as f32
    }
}

/// Square of the distance from the origin to a triangle.
///
/// It is the least of the distances to the three edges, or to the plane where the foot of the perpendicular is inside. The
/// edges are exact to rounding however thin the triangle, down to a point. Only the plane is ill-conditioned: in a triangle of length L and
/// height h, rounding moves the test of what is inside by εL/h times the reach D, which matters for at most h to the
/// distance; that is never more than √(εLD).
fn squared_distance([a, b, c]: [DVec3; 3]) -> f64 {
    let [ab, bc, ca] = [b - a, c - b, a - c];
    let normal = ca.cross(ab);
    let inside = |corner: DVec3, edge: DVec3| normal.dot(edge.cross(corner)) <= 0.0;
    if inside(a, ab) && inside(b, bc) && inside(c, ca) {
        let square = normal.length_squared();
        // A triangle without area has no plane.
        if square > 0.0 {
            let along = normal.dot(a);
            return along * along / square;
        }
    }
    to_segment(a, ab).min(to_segment(b, bc)).min(to_segment(c, ca))
}

/// Square of the distance from the origin to the segment from `start` along `edge`.
fn to_segment(start: DVec3, edge: DVec3) -> f64 {
    let square = edge.length_squared();
    let along = if square > 0.0 { (-start.dot(edge) / square).clamp(0.0, 1.0) } else { 0.0 };
    (start + edge * along).length_squared()
}
