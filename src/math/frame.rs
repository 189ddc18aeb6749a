//! Orthonormal frames around a normal.

use glam::Vec3;

/// A right-handed orthonormal frame; `normal` is the local z axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Local x axis.
    pub tangent: Vec3,
    /// Local y axis.
    pub bitangent: Vec3,
    /// Local z axis.
    pub normal: Vec3,
}

impl Frame {
    /// The frame around unit vector `normal` whose tangents are continuous except where
    /// `normal.z` changes sign (Duff et al. 2017, "Building an Orthonormal Basis, Revisited", listing 3).
    pub fn from_normal(normal: Vec3) -> Self {
        let sign = 1.0_f32.copysign(normal.z);
        let a = -1.0 / (sign + normal.z);
        let b = normal.x * normal.y * a;
        Self {
            tangent: Vec3::new(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x),
            bitangent: Vec3::new(b, sign + normal.y * normal.y * a, -normal.y),
            normal,
        }
    }

    /// World to local coordinates.
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.tangent), v.dot(self.bitangent), v.dot(self.normal))
    }

    /// Local to world coordinates.
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        self.tangent * v.x + self.bitangent * v.y + self.normal * v.z
    }
}
