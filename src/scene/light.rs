//! Lights.

use glam::{Mat3, Vec3};

use crate::radiometry::Rgb;

/// A light. All are seen by the camera where they have a size.
#[derive(Clone, Debug, PartialEq)]
pub enum Light {
    /// A parallelogram that emits from the side its normal u×v points to; black and opaque behind.
    Quad {
        /// Centre, m.
        center: Vec3,
        /// Half of the first edge, m.
        half_u: Vec3,
        /// Half of the second edge, orthogonal to the first, m.
        half_v: Vec3,
        /// Emitted radiance, W/(m² sr).
        radiance: Rgb,
    },
    /// A disk that emits from the side of its normal; black and opaque behind.
    Disk {
        /// Centre, m.
        center: Vec3,
        /// Unit normal of the emitting side.
        normal: Vec3,
        /// Radius, m.
        radius: f32,
        /// Emitted radiance, W/(m² sr).
        radiance: Rgb,
    },
    /// A sphere that emits outwards.
    Sphere {
        /// Centre, m.
        center: Vec3,
        /// Radius, m.
        radius: f32,
        /// Emitted radiance, W/(m² sr).
        radiance: Rgb,
    },
    /// A point that emits alike in all directions.
    Point {
        /// Position, m.
        position: Vec3,
        /// Radiant intensity, W/sr.
        intensity: Rgb,
    },
    /// A point that emits into a cone.
    Spot {
        /// Position, m.
        position: Vec3,
        /// Unit axis of the cone.
        direction: Vec3,
        /// Radiant intensity on the axis, W/sr.
        intensity: Rgb,
        /// Half angle within which the intensity is full, radians.
        inner_angle: f32,
        /// Half angle beyond which there is none, radians.
        outer_angle: f32,
    },
    /// Parallel light from infinitely far away.
    Directional {
        /// Unit direction in which the light travels.
        direction: Vec3,
        /// Irradiance on a surface that faces the light, W/m².
        irradiance: Rgb,
    },
}

/// Light from infinitely far away in every direction.
#[derive(Clone, Debug, PartialEq)]
pub enum Environment {
    /// The same radiance from everywhere, W/(m² sr).
    Constant(Rgb),
    /// An equirectangular map: row 0 looks up (+y), the middle column looks down −z before `rotation`.
    Map {
        /// Width in pixels.
        width: usize,
        /// Height in pixels.
        height: usize,
        /// Row-major radiance, W/(m² sr), finite and not negative; scale already applied.
        radiance: Vec<Rgb>,
        /// World direction to map direction.
        rotation: Mat3,
    },
}
