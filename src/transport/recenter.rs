//! Scenes far from the origin, brought home before they are rendered.
//!
//! A million metres from the origin single-precision coordinates are a sixteenth of a metre apart. What is given there by the placement of
//! objects keeps its digits if everything is moved to the origin before vertices are placed; no light knows the difference.

use glam::{Affine3A, DVec3, Vec3};

use crate::scene::{Light, Mesh, Scene};

/// Moves `scene` to the origin if it lies farther from it than it is large. By how much it has been moved back, m: the old place of what is now at
/// the origin.
pub fn recenter(scene: &mut Scene) -> Vec3 {
    let Some((low, high)) = bounds(scene) else { return Vec3::ZERO };
    let center = (0.5 * (low + high)).as_vec3();
    if !center.is_finite() || center.as_dvec3().length() <= (high - low).length() {
        return Vec3::ZERO;
    }
    for instance in &mut scene.instances {
        // Not a product of maps, which would round the matrix.
        instance.transform.translation -= glam::Vec3A::from(center);
    }
    scene.camera.position -= center;
    scene.camera.target -= center;
    scene.lights.iter_mut().filter_map(position_of).for_each(|position| *position -= center);
    center
}

fn position_of(light: &mut Light) -> Option<&mut Vec3> {
    match light {
        Light::Quad { center, .. } | Light::Disk { center, .. } | Light::Sphere { center, .. } => {
            Some(center)
        }
        Light::Point { position, .. } | Light::Spot { position, .. } => Some(position),
        Light::Directional { .. } => None,
    }
}

/// Lowest and highest corner of a box around all objects; lights may be anywhere.
fn bounds(scene: &Scene) -> Option<(DVec3, DVec3)> {
    let boxes: Vec<_> = scene.meshes.iter().map(bounds_of_mesh).collect();
    let corners = scene.instances.iter().filter_map(|instance| {
        let (low, high) = boxes[instance.mesh]?;
        Some(placed_corners(&instance.transform, low, high))
    });
    corners.flatten().fold(None, |bounds: Option<(DVec3, DVec3)>, p| {
        let (low, high) = bounds.unwrap_or((p, p));
        Some((low.min(p), high.max(p)))
    })
}

fn bounds_of_mesh(mesh: &Mesh) -> Option<(Vec3, Vec3)> {
    mesh.positions.iter().fold(None, |bounds: Option<(Vec3, Vec3)>, p| {
        let (low, high) = bounds.unwrap_or((*p, *p));
        Some((low.min(*p), high.max(*p)))
    })
}

fn placed_corners(transform: &Affine3A, low: Vec3, high: Vec3) -> [DVec3; 8] {
    let transform = transform.as_daffine3();
    std::array::from_fn(|i| {
        let pick = |axis: usize| if i >> axis & 1 == 1 { high[axis] } else { low[axis] };
        transform.transform_point3(Vec3::new(pick(0), pick(1), pick(2)).as_dvec3())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Instance, shape};

    fn ball(translation: Vec3) -> Scene {
        Scene {
            meshes: vec![shape::sphere(Vec3::ZERO, 1.0, 1)],
            instances: vec![Instance {
                name: "ball".into(),
                mesh: 0,
                material: 0,
                transform: Affine3A::from_translation(translation),
            }],
            lights: vec![Light::Point {
                position: translation + Vec3::Y,
                intensity: crate::radiometry::Rgb::ONE.into(),
            }],
            ..Scene::default()
        }
    }

    #[test]
    fn what_is_far_away_is_brought_home_without_rounding() {
        let far = Vec3::new(1e6, -3e5, 0.25);
        let mut scene = ball(far);
        scene.camera.target = far;
        assert_eq!(recenter(&mut scene), far);
        assert_eq!(scene.camera.target, Vec3::ZERO);
        assert_eq!(scene.instances[0].transform, Affine3A::IDENTITY);
        assert!(matches!(scene.lights[0], Light::Point { position: Vec3::Y, .. }));
    }

    #[test]
    fn what_is_at_home_stays_as_it_is() {
        for mut scene in [ball(Vec3::new(0.1, 2.0, 0.0)), Scene::default()] {
            assert_eq!(recenter(&mut scene), Vec3::ZERO);
        }
    }
}
