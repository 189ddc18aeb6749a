//! KHR_lights_punctual.

use std::f32::consts::FRAC_PI_2;

use glam::{DAffine3, DVec3, Vec3};

use super::Reader;
use crate::radiometry::{LUMENS_PER_WATT, Rgb};
use crate::scene::{Light, SceneError};

impl Reader<'_> {
    /// Places light `index` at the node at `place`: it shines along the node's −z.
    ///
    /// The node's scale does not act on a light, and its `range` is ignored: light falls off by the
    /// inverse square for ever. Photometric units become radiometric by [`LUMENS_PER_WATT`].
    pub(super) fn read_light(
        &mut self,
        index: usize,
        transform: DAffine3,
        place: &str,
    ) -> Result<(), SceneError> {
        let node_place = format!("{place}/extensions/KHR_lights_punctual/light");
        let light = self.document.get(&self.document.lights, "light", index, &node_place)?;
        let place = format!("/extensions/KHR_lights_punctual/lights/{index}");

        let power = Rgb::from_fn(|c| light.color[c] * light.intensity) / LUMENS_PER_WATT;
        if !(power.is_finite() && power.min_component() >= 0.0) {
            return Err(self
                .document
                .error(place, "color and intensity must be finite and not negative; mend them"));
        }
        let position = transform.translation.as_vec3();
        let direction = transform.transform_vector3(DVec3::NEG_Z).normalize_or_zero().as_vec3();
        if !position.is_finite() || (direction == Vec3::ZERO && light.kind != "point") {
            self.warnings.add("a light whose node is scaled to nothing is left out", node_place);
            return Ok(());
        }
        let light = match light.kind.as_str() {
            "point" => Light::Point { position, intensity: power.into() },
            "directional" => Light::Directional { direction, irradiance: power.into() },
            "spot" => {
                let inner_angle = light.spot.inner_cone_angle;
                let outer_angle = light.spot.outer_cone_angle;
                // The standard's own exporters write π/2 rounded up.
                if !(0.0 <= inner_angle && inner_angle <= outer_angle && outer_angle <= FRAC_PI_2 + 1e-4) {
                    return Err(self.document.error(
                        format!("{place}/spot"),
                        format!("0 ≤ innerConeAngle ({inner_angle}) ≤ outerConeAngle ({outer_angle}) ≤ π/2 does not hold; mend it"),
                    ));
                }
                let outer_angle = outer_angle.min(FRAC_PI_2);
                Light::Spot { position, direction, intensity: power.into(), inner_angle, outer_angle }
            }
            other => {
                return Err(self.document.error(
                    format!("{place}/type"),
                    format!("\"{other}\" is not a type of light; it must be point, spot or directional"),
                ));
            }
        };
        self.warnings.add(
            format!("lights are in candela and lux by the standard: divided by {LUMENS_PER_WATT} lm/W"),
            place,
        );
        self.scene.lights.push(light);
        Ok(())
    }
}
