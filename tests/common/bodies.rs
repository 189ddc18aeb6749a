//! The bodies of the white furnace: flat, small, thin, concave, and next to itself.

use alabaster::scene::{Mesh, shape};
use glam::Vec3;

use super::scenes::{l_shape, two_slabs};

/// A closed body (or an endless plane) and how densely it scatters.
#[derive(Clone)]
pub struct Body {
    pub name: &'static str,
    pub mesh: Mesh,
    /// Extinction coefficient, 1/m.
    pub sigma_t: f32,
    pub is_convex: bool,
}

/// Bodies of size 1 or so, from much larger than a free path to much smaller.
pub fn bodies() -> Vec<Body> {
    let sphere = shape::sphere(Vec3::ZERO, 1.0, 5);
    let slab = shape::cuboid(Vec3::ZERO, Vec3::new(4.0, 0.2, 4.0));
    let mut bodies = vec![Body { name: "plane", mesh: plane(), sigma_t: 10.0, is_convex: true }];
    bodies.extend([1.0, 3.0, 10.0, 30.0, 100.0].map(|sigma_t| Body {
        name: "sphere, R = 1",
        mesh: sphere.clone(),
        sigma_t,
        is_convex: true,
    }));
    bodies.extend([1.0, 5.0, 25.0].map(|sigma_t| Body {
        name: "slab, 0.2 thick",
        mesh: slab.clone(),
        sigma_t,
        is_convex: true,
    }));
    bodies.extend([1.0, 10.0].map(|sigma_t| Body {
        name: "concave L",
        mesh: l_shape(),
        sigma_t,
        is_convex: false,
    }));
    bodies.extend([1.0, 10.0].map(|sigma_t| Body {
        name: "two slabs, gap 0.1",
        mesh: two_slabs(),
        sigma_t,
        is_convex: false,
    }));
    bodies
}

/// The sphere that scatters less than what is around it refracts: index 0.8.
pub fn bubble() -> Body {
    Body { name: "bubble, R = 1", mesh: shape::sphere(Vec3::ZERO, 1.0, 5), sigma_t: 10.0, is_convex: true }
}

/// Wide enough that none of the light in the middle reaches its edge.
fn plane() -> Mesh {
    shape::quad(Vec3::ZERO, Vec3::Z * 50.0, Vec3::X * 50.0)
}
