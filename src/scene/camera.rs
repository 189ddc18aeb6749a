//! The camera: pinhole or thin lens.

use glam::{Vec2, Vec3};

use crate::math::warp::square_to_disk;

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

/// Start and unit direction of a ray into the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraRay {
    /// A point on the lens, m.
    pub origin: Vec3,
    /// Unit direction.
    pub direction: Vec3,
}

/// A [`Camera`] made ready for one picture shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraRays {
    position: Vec3,
    /// Unit axes of the picture.
    right: Vec3,
    up: Vec3,
    forward: Vec3,
    /// Tangents of half the field of view, horizontal and vertical.
    half_extent: Vec2,
    lens_radius: f32,
    focus_distance: f32,
}

impl Camera {
    /// The rays of this camera through a picture `aspect` times as wide as it is high, with square
    /// pixels.
    pub fn rays(&self, aspect: f32) -> CameraRays {
        let view = self.target - self.position;
        let forward = view.try_normalize().unwrap_or(Vec3::NEG_Z);
        let right =
            forward.cross(self.up).try_normalize().unwrap_or_else(|| forward.any_orthonormal_vector());
        let tangent = (0.5 * self.vertical_fov).tan();
        CameraRays {
            position: self.position,
            right,
            up: right.cross(forward),
            forward,
            half_extent: Vec2::new(tangent * aspect, tangent),
            lens_radius: 0.5 * self.aperture,
            focus_distance: self.focus_distance.unwrap_or(view.length()),
        }
    }
}

impl CameraRays {
    /// The ray through the point `film` of the picture, (0, 0) its top left and (1, 1) its bottom
    /// right corner, from the point of the lens that `lens`, uniform in the unit square, picks.
    pub fn ray(&self, film: [f32; 2], lens: [f32; 2]) -> CameraRay {
        let offset = Vec2::new(2.0 * film[0] - 1.0, 1.0 - 2.0 * film[1]) * self.half_extent;
        // Its component along the view axis is 1, so multiples of it end on planes of equal focus.
        let through_center = self.forward + self.right * offset.x + self.up * offset.y;
        if self.lens_radius == 0.0 {
            return CameraRay { origin: self.position, direction: through_center.normalize() };
        }
        let on_lens = square_to_disk(lens[0], lens[1]) * self.lens_radius;
        let shift = self.right * on_lens.x + self.up * on_lens.y;
        CameraRay {
            origin: self.position + shift,
            direction: (through_center * self.focus_distance - shift).normalize(),
        }
    }

    /// Unit vector to the right in the picture.
    pub fn right(&self) -> Vec3 {
        self.right
    }

    /// Unit vector upwards in the picture.
    pub fn up(&self) -> Vec3 {
        self.up
    }

    /// Unit vector into the picture.
    pub fn forward(&self) -> Vec3 {
        self.forward
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Film position in pixels of 128 × 128 from the top left, and direction: sensor rays of
    /// Mitsuba 3.9.1 (`perspective`, to_world of the look-at below, 34° across a square film).
    const MITSUBA_RAYS: [([f32; 2], [f32; 3]); 5] = [
        ([0.5, 0.5], [-0.530_778_05, 0.087_580_72, -0.842_973_53]),
        ([127.5, 0.5], [0.005_315_981_3, 0.087_580_72, -0.996_143_3]),
        ([0.5, 127.5], [-0.499_868_07, -0.458_494_75, -0.734_788_8]),
        ([127.5, 127.5], [0.036_225_937, -0.458_494_75, -0.887_958_5]),
        ([64.0, 64.0], [-0.269_069_17, -0.201_801_85, -0.941_741_94]),
    ];

    fn camera() -> Camera {
        Camera {
            position: Vec3::new(1.2, 0.9, 4.2),
            vertical_fov: 34.0_f32.to_radians(),
            ..Camera::default()
        }
    }

    #[test]
    fn pinhole_rays_are_those_of_another_renderer() {
        let rays = camera().rays(1.0);
        for (pixel, expected) in MITSUBA_RAYS {
            let ray = rays.ray([pixel[0] / 128.0, pixel[1] / 128.0], [0.3, 0.9]);
            assert_eq!(ray.origin, camera().position);
            // A dozen roundings of numbers of size up to 1 on either side, among them those of a
            // 4×4 projection matrix inverted there: 12 ulps of 1.
            let error = (ray.direction - Vec3::from_array(expected)).abs().max_element();
            assert!(error <= 12.0 * f32::EPSILON, "{pixel:?}: off by {error:e}");
        }
    }

    #[test]
    fn pixels_are_square_and_the_field_of_view_is_vertical() {
        let rays = camera().rays(2.5);
        let angle = |a: [f32; 2], b: [f32; 2]| {
            rays.ray(a, [0.5; 2]).direction.angle_between(rays.ray(b, [0.5; 2]).direction)
        };
        // acos near these angles turns an ulp of the cosine into two of the angle, after a few roundings.
        let close = |a: f32, b: f32| (a - b).abs() < 16.0 * f32::EPSILON;
        assert!(close(angle([0.5, 0.0], [0.5, 1.0]), 34.0_f32.to_radians()));
        assert!(close(angle([0.0, 0.5], [1.0, 0.5]), 2.0 * (2.5 * 17.0_f32.to_radians().tan()).atan()));
    }

    #[test]
    fn all_rays_of_a_lens_meet_in_the_plane_of_focus() {
        let lens = Camera { aperture: 0.4, focus_distance: Some(3.0), ..camera() };
        let (rays, pinhole) = (lens.rays(1.0), camera().rays(1.0));
        let center = pinhole.ray([0.2, 0.7], [0.0; 2]).direction;
        let focus = lens.position + center * (3.0 / center.dot(rays.forward()));
        let mut farthest = 0.0_f32;
        for i in 0..64 {
            let u = [(i % 8) as f32 / 7.0, (i / 8) as f32 / 7.0];
            let ray = rays.ray([0.2, 0.7], u);
            let along = (focus - ray.origin).dot(ray.direction);
            // Coordinates up to 5 m through about ten roundings.
            assert!((ray.origin + ray.direction * along - focus).length() < 10.0 * 5.0 * f32::EPSILON);
            assert!((ray.origin - lens.position).dot(rays.forward()).abs() < 5.0 * f32::EPSILON);
            farthest = farthest.max((ray.origin - lens.position).length());
        }
        // The aperture is the diameter: corners of the unit square lie on the rim.
        assert!((farthest - 0.2).abs() < 5.0 * 2.0 * f32::EPSILON);
    }

    #[test]
    fn looking_along_up_still_gives_rays() {
        let camera = Camera { up: Vec3::Z, ..Camera::default() };
        assert!(camera.rays(1.0).ray([0.1, 0.2], [0.0; 2]).direction.is_normalized());
    }
}
