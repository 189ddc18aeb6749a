//! Instances as hits see them: how transforms wind triangles, and what they cost in digits.

use glam::{Affine3A, Vec3};

use crate::math::robust::gamma;

/// What is to know of an instance's transform at every hit.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    /// The mesh lies in world space.
    pub identity: bool,
    /// The winding of its triangles makes their normals point inward.
    pub mirrored: bool,
    /// Bound on the absolute error, by coordinate, that hits have because they are found in the space of the mesh.
    pub error: Vec3,
}

impl Placement {
    /// Of a mesh with vertices at `positions` that `transform` places within `bounds`; its triangles face inward if
    /// `inside_out`.
    pub fn new(
        transform: &Affine3A,
        positions: &[Vec3],
        (low, high): (Vec3, Vec3),
        inside_out: bool,
    ) -> Self {
        let identity = *transform == Affine3A::IDENTITY;
        let largest = positions.iter().fold(Vec3::ZERO, |largest, p| largest.max(p.abs()));
        let error = if identity { Vec3::ZERO } else { error(transform, largest, low.abs().max(high.abs())) };
        Self { identity, mirrored: mirrors(transform) != inside_out, error }
    }
}

/// True if `transform` turns triangles inside out.
pub fn mirrors(transform: &Affine3A) -> bool {
    transform.matrix3.determinant() < 0.0
}

/// Rays are mapped to the space of the mesh, met there, and the corners of triangles mapped back, all in single
/// precision: γ₄ of the terms that a coordinate is the sum of (Pharr, Jakob, Humphreys 2016, section 3.9.4), doubled for the
/// rounding of the inverse, and γ₇ of the plane as in [`crate::math::robust::interpolation_error`]. `local` and `world` are
/// the largest coordinates on either side. Nothing for a transform that has no inverse: rays meet nothing there.
fn error(transform: &Affine3A, local: Vec3, world: Vec3) -> Vec3 {
    let to_local = terms(&transform.inverse(), world);
    let found = to_local * (2.0 * gamma(4)) + local * (2.0 * gamma(7));
    let linear = Affine3A { translation: Vec3::ZERO.into(), ..*transform };
    let error = terms(&linear, found) + terms(transform, local) * gamma(4);
    if error.is_finite() { error } else { Vec3::ZERO }
}

/// Sums of the absolute values of the terms that the coordinates of a mapped point have.
fn terms(map: &Affine3A, largest: Vec3) -> Vec3 {
    let [x, y, z, t] = [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis, map.translation]
        .map(|v| Vec3::from(v.abs()));
    x * largest.x + y * largest.y + z * largest.z + t
}

#[cfg(all(test, feature = "embree"))]
mod tests {
    use super::*;
    use crate::math::robust::offset_from_surface;
    use crate::math::sampler::HashGenerator;
    use crate::math::warp;
    use crate::plan::Abilities;
    use crate::raycast::embree::EmbreeCaster;
    use crate::raycast::{Ray, RayCaster};
    use crate::scene::{Instance, Material, Scene, shape};
    use crate::transport::world::World;
    use glam::Quat;

    /// A path that goes straight on would pass it again and again.
    #[test]
    fn no_triangle_of_a_shared_mesh_is_met_again_by_a_ray_that_left_it() {
        let placed = |scale: Vec3, turn: f32, translation: Vec3| Instance {
            name: String::new(),
            mesh: 0,
            material: 0,
            transform: Affine3A::from_scale_rotation_translation(
                scale,
                Quat::from_rotation_y(turn) * Quat::from_rotation_x(0.3 * turn),
                translation,
            ),
        };
        let scene = Scene {
            meshes: vec![shape::sphere(Vec3::ZERO, 0.8, 5)],
            instances: vec![
                placed(Vec3::ONE, 0.0, Vec3::ZERO),
                placed(Vec3::new(0.7, 0.6, 0.8), 0.4, Vec3::new(0.5, 0.2, 0.0)),
                placed(Vec3::splat(0.25), 0.0, Vec3::new(-0.3, 0.2, 0.0)),
                placed(Vec3::new(0.2, 0.5, 0.1), 1.0, Vec3::new(30.0, 0.1, -4.0)),
            ],
            materials: vec![Material::default()],
            ..Scene::default()
        };
        let world = World::new(scene, vec![], |geometry| EmbreeCaster::new(geometry, 1)).unwrap();
        let mut random = HashGenerator::new(1);
        let mut again = [0; 4];
        for i in 0..400_000 {
            let (low, high) = world.bounds(i % 4);
            let [u, v, x, y, z] = [(); 5].map(|()| random.next_f32());
            let direction = warp::square_to_cone(u, v, 2.0);
            let ray = Ray::new(low + Vec3::new(x, y, z) * (high - low), direction);
            let Some(hit) = world.caster().closest(&ray) else { continue };
            let point = world.surface::<{ Abilities::NONE.bits() }>(&hit);
            let beyond = offset_from_surface(point.position, point.error, point.geometric_normal, direction);
            let next = world.caster().closest(&Ray::new(beyond, direction));
            if next.is_some_and(|next| (next.instance, next.primitive) == (hit.instance, hit.primitive)) {
                again[hit.instance as usize] += 1;
            }
        }
        assert_eq!(again, [0; 4]);
    }
}
