//! The camera: pinhole or thin lens.

use glam::Vec3;

/// A perspective camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Centre of projection (of the lens), m.
    pub position: Vec3,
    /// Point in the middle of the picture, m.
    pub target: Vec3,
    /// Direction that is up in the picture; need not be orthogonal to the view.
    pub up: Vec3,
    /// Full vertical field of view, radians.
    pub vertical_fov: f32,
    /// Diameter of the lens, m; 0 is a pinhole.
    pub aperture: f32,
    /// Distance in focus along the view axis, m; `None`: at the target.
    pub focus_distance: Option<f32>,
}

impl Default for Camera {
    fn default() -> Self {
        Self {
            position: Vec3::new(0.0, 0.0, 4.0),
            target: Vec3::ZERO,
            up: Vec3::Y,
            vertical_fov: 40.0_f32.to_radians(),
            aperture: 0.0,
            focus_distance: None,
        }
    }
}
