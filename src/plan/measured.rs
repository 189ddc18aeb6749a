//! What is measured of meshes, once for all instances of the same shape.

use std::collections::HashMap;

use glam::{Affine3A, Vec3};

use super::body::Body;
use super::solid::{Flaw, flaws};
use crate::scene::{Instance, Mesh, Scene};

/// Shapes that differ by less than this share are the same.
const RESOLUTION: f32 = 1e-4;

/// What has been measured so far.
#[derive(Default)]
pub struct Measured {
    flaws: HashMap<usize, Vec<Flaw>>,
    bounds: HashMap<usize, [Vec3; 2]>,
    /// By mesh and [`shape`].
    bodies: HashMap<(usize, [i32; 6]), Body>,
}

impl Measured {
    /// The body of an instance.
    pub fn body(&mut self, scene: &Scene, instance: &Instance) -> Body {
        let mesh = &scene.meshes[instance.mesh];
        let bounds = *self.bounds.entry(instance.mesh).or_insert_with(|| bounds_of(used(mesh)));
        let bounds = placed(bounds, &instance.transform);
        let (shape, size) = shape(&instance.transform);
        if !(size.is_finite() && size > 0.0) {
            return Body::new(mesh, &instance.transform);
        }
        let unit = || {
            let matrix3 = instance.transform.matrix3 * size.recip();
            Body::new(mesh, &Affine3A { matrix3, ..Affine3A::IDENTITY })
        };
        let body = self.bodies.entry((instance.mesh, shape)).or_insert_with(unit);
        body.scaled(f64::from(size), bounds)
    }

    /// The flaws of a mesh.
    pub fn flaws(&mut self, scene: &Scene, mesh: usize) -> &[Flaw] {
        self.flaws.entry(mesh).or_insert_with(|| flaws(&scene.meshes[mesh]))
    }
}

/// What a transform makes of shapes, turned and scaled in whatever way: the products of its axes (MᵀM), divided by the square of the size,
/// in units of [`RESOLUTION`]. And the size, the root mean square of the lengths of its axes.
fn shape(transform: &Affine3A) -> ([i32; 6], f32) {
    let [x, y, z] = [transform.matrix3.x_axis, transform.matrix3.y_axis, transform.matrix3.z_axis];
    let square = (x.length_squared() + y.length_squared() + z.length_squared()) / 3.0;
    let products = [x.dot(x), y.dot(y), z.dot(z), x.dot(y), y.dot(z), z.dot(x)];
    (products.map(|product| (product / (square * RESOLUTION)).round() as i32), square.sqrt())
}

/// The corners of all triangles.
fn used(mesh: &Mesh) -> impl Iterator<Item = Vec3> + Clone {
    mesh.triangles.iter().flatten().map(|&vertex| mesh.positions[vertex as usize])
}

fn bounds_of(points: impl Iterator<Item = Vec3> + Clone) -> [Vec3; 2] {
    let low = points.clone().reduce(Vec3::min);
    [low.unwrap_or_default(), points.reduce(Vec3::max).unwrap_or_default()]
}

/// Bounds of the corners of `bounds` as placed.
fn placed([low, high]: [Vec3; 2], transform: &Affine3A) -> [Vec3; 2] {
    let corner = |i: u32| {
        let of = |axis: usize| if i >> axis & 1 == 0 { low[axis] } else { high[axis] };
        transform.transform_point3(Vec3::new(of(0), of(1), of(2)))
    };
    let corners: [Vec3; 8] = std::array::from_fn(|i| corner(i as u32));
    bounds_of(corners.into_iter())
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;
    use crate::scene::shape;

    fn instance(transform: Affine3A) -> Instance {
        Instance { name: String::new(), mesh: 0, material: 0, transform }
    }

    #[test]
    fn a_shape_is_measured_once_and_as_if_each_time() {
        let scene =
            Scene { meshes: vec![shape::cuboid(Vec3::X, Vec3::new(1.0, 2.0, 3.0))], ..Scene::default() };
        let mut measured = Measured::default();
        let turned = |size: f32, stretch: f32| {
            let turn = Quat::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 1.0);
            let scale = Vec3::new(size, size * stretch, size);
            Affine3A::from_scale_rotation_translation(scale, turn, Vec3::splat(4.0 * size))
        };
        for (transform, shapes) in
            [(turned(1.0, 1.0), 1), (turned(1e-6, 1.0), 1), (Affine3A::IDENTITY, 1), (turned(3.0, 2.0), 2)]
        {
            let found = measured.body(&scene, &instance(transform));
            let direct = Body::new(&scene.meshes[0], &transform);
            // Single precision, and shapes that are the same to the resolution.
            let is_near = |a: f64, b: f64| (a / b - 1.0).abs() < 2e-4;
            assert!(is_near(found.volume, direct.volume), "{found:?} {direct:?}");
            assert!(is_near(found.area, direct.area) && is_near(found.curvature, direct.curvature));
            let tolerance = 1e-5 * direct.bounds[1].length();
            assert!((found.bounds[0] - direct.bounds[0]).length() < tolerance);
            assert!((found.bounds[1] - direct.bounds[1]).length() < tolerance);
            assert_eq!(measured.bodies.len(), shapes);
        }
    }

    #[test]
    fn what_has_no_size_has_no_body() {
        let scene = Scene { meshes: vec![shape::cuboid(Vec3::ZERO, Vec3::ONE)], ..Scene::default() };
        let nothing = instance(Affine3A::from_scale(Vec3::ZERO));
        assert!(Measured::default().body(&scene, &nothing).mean_chord().is_nan());
    }
}
