//! Cameras (glTF 2.0, section 3.10).

use ::gltf::json::camera::Type;
use ::gltf::json::validation::Checked;
use glam::{DAffine3, DVec3};

use super::Reader;
use crate::scene::{Camera, SceneError};

impl Reader<'_> {
    /// Takes camera `index` of the node at `place` if it is the first that can be used.
    ///
    /// The aspect ratio is the film's. Without a target in glTF, the target is 1 m ahead.
    pub(super) fn read_camera(
        &mut self,
        index: usize,
        transform: DAffine3,
        place: &str,
    ) -> Result<(), SceneError> {
        let node_place = format!("{place}/camera");
        let camera = self.document.get(&self.document.cameras, "camera", index, &node_place)?;
        let place = format!("/cameras/{index}");
        let perspective = match (&camera.type_, &camera.perspective) {
            (Checked::Valid(Type::Perspective), Some(perspective)) => perspective,
            (Checked::Valid(Type::Orthographic), _) => {
                self.warnings.add("orthographic cameras are not supported and left out", place);
                return Ok(());
            }
            _ => {
                return Err(self.document.error(
                    place,
                    "needs `type` \"perspective\" and an object `perspective`; export it again",
                ));
            }
        };
        let vertical_fov = perspective.yfov;
        if !(vertical_fov > 0.0 && vertical_fov < std::f32::consts::PI) {
            return Err(self.document.error(
                format!("{place}/perspective/yfov"),
                format!("{vertical_fov} is not an angle between 0 and π radians; mend it"),
            ));
        }
        if self.camera.is_some() {
            self.warnings.add("further cameras are not used", node_place);
            return Ok(());
        }
        let position = transform.translation;
        let forward = transform.transform_vector3(DVec3::NEG_Z).try_normalize();
        let up = transform.transform_vector3(DVec3::Y).try_normalize();
        match (forward, up) {
            (Some(forward), Some(up))
                if position.as_vec3().is_finite() && forward.cross(up).length() > 1e-6 =>
            {
                self.camera = Some(Camera {
                    position: position.as_vec3(),
                    target: (position + forward).as_vec3(),
                    up: up.as_vec3(),
                    vertical_fov,
                    ..Camera::default()
                });
            }
            _ => self.warnings.add("a camera whose node is scaled to nothing is left out", node_place),
        }
        Ok(())
    }
}
