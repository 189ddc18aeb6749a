//! Ray–triangle intersection without gaps along shared edges, after Woop, Benthin, Wald 2013, "Watertight
//! Ray/Triangle Intersection".

use glam::Vec3;

use super::Ray;

/// A ray prepared for [`WatertightRay::intersect`]: sheared so that it runs along its longest axis.
pub struct WatertightRay {
    /// Axes in the order that makes the longest of the direction the last.
    pub(super) axes: [usize; 3],
    /// Along these axes.
    pub(super) origin: Vec3,
    pub(super) shear: Vec3,
}

impl WatertightRay {
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        const AXES: [[usize; 3]; 3] = [[1, 2, 0], [2, 0, 1], [0, 1, 2]];
        let axes = AXES[ray.direction.abs().max_position()];
        let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
        let [x, y, z] = axes.map(|axis| direction[axis]);
        Self {
            axes,
            origin: Vec3::from(axes.map(|axis| origin[axis])),
            shear: Vec3::new(x / z, y / z, 1.0 / z),
        }
    }

    /// Parameter t in (0, `t_max`] and barycentric coordinates (u, v) of the second and third vertex. A ray
    /// through an edge meets all triangles of that edge.
    pub fn intersect(&self, corners: &[Vec3; 3], t_max: f32) -> Option<(f32, f32, f32)> {
        let [a, b, c] = corners.map(|corner| self.shear(corner));
        let weights = Vec3::new(side(c, b), side(a, c), side(b, a));
        if weights.min_element() < 0.0 && weights.max_element() > 0.0 {
            return None;
        }
        let determinant = weights.x + weights.y + weights.z;
        let t = self.shear.z * weights.dot(Vec3::new(a.z, b.z, c.z)) / determinant;
        // False for NaN as well, which a determinant of zero leads to.
        (t > 0.0 && t <= t_max && determinant != 0.0)
            .then(|| (t, weights.y / determinant, weights.z / determinant))
    }

    fn shear(&self, point: Vec3) -> Vec3 {
        let [x, y, z] = (Vec3::from(self.axes.map(|axis| point[axis])) - self.origin).to_array();
        Vec3::new(x - self.shear.x * z, y - self.shear.y * z, z)
    }
}

/// Twice the signed area that the ray's point spans with the edge from `p` to `q`. Its sign is exact where
/// it matters: products of two single-precision numbers are exact in double.
fn side(p: Vec3, q: Vec3) -> f32 {
    let single = p.x * q.y - p.y * q.x;
    if single != 0.0 {
        return single;
    }
    (f64::from(p.x) * f64::from(q.y) - f64::from(p.y) * f64::from(q.x)) as f32
}
