//! Floating point that holds at the edges: square roots of rounded differences, ray offsets by
//! ulps of the coordinates instead of a fixed epsilon.

use glam::Vec3;

/// √x with x below zero (by rounding) taken as zero.
pub fn safe_sqrt(x: f32) -> f32 {
    x.max(0.0).sqrt()
}

/// The bound γ_n = nε/(1−nε) on the relative error of n successive roundings, ε = 2⁻²⁴
/// (Higham 2002, section 3.1).
pub const fn gamma(n: u32) -> f32 {
    let ne = n as f32 * (0.5 * f32::EPSILON);
    ne / (1.0 - ne)
}

/// Moves `point` off its surface to the side of `direction`, just far enough that a ray from there
/// cannot meet the surface again.
///
/// `error` bounds the absolute error of each coordinate of `point` (see
/// [`interpolation_error`]); the shift along the unit geometric `normal` is the
/// largest distance that error can put the point behind its plane, then each coordinate is rounded
/// away from the surface (Pharr, Jakob, Humphreys 2016, section 3.9.5).
pub fn offset_from_surface(point: Vec3, error: Vec3, normal: Vec3, direction: Vec3) -> Vec3 {
    let distance = normal.abs().dot(error);
    let toward = if direction.dot(normal) < 0.0 { -normal } else { normal };
    let offset = toward * distance;
    let moved = point + offset;
    Vec3::new(
        round_toward(moved.x, offset.x),
        round_toward(moved.y, offset.y),
        round_toward(moved.z, offset.z),
    )
}

fn round_toward(x: f32, sign: f32) -> f32 {
    if sign > 0.0 {
        x.next_up()
    } else if sign < 0.0 {
        x.next_down()
    } else {
        x
    }
}

/// Bound on the absolute error of each coordinate of a point interpolated from the vertices of a
/// triangle with barycentric coordinates, and traversed by a watertight but not exact intersector:
/// γ₇ of the largest vertex coordinates, doubled because the intersector computes its plane from
/// rounded vertex differences. At least an ulp of the triangle's largest coordinate: a point of the
/// plane y = 0 is exact, but a ray that starts on the plane itself would meet it again.
pub fn interpolation_error(a: Vec3, b: Vec3, c: Vec3) -> Vec3 {
    let largest = a.abs().max(b.abs()).max(c.abs());
    (largest * (2.0 * gamma(7))).max(Vec3::splat(largest.max_element() * f32::EPSILON))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offset_leaves_the_plane_on_the_side_of_the_direction() {
        let point = Vec3::new(1000.0, -3.0, 0.25);
        let normal = Vec3::new(0.6, 0.0, 0.8);
        let error = interpolation_error(point, point, point);
        for side in [1.0, -1.0] {
            let moved = offset_from_surface(point, error, normal, normal * side);
            assert!((moved - point).as_dvec3().dot(normal.as_dvec3()) * f64::from(side) > 0.0);
        }
    }

    #[test]
    fn a_point_of_a_coordinate_plane_leaves_it_too() {
        let [a, b, c] = [Vec3::ZERO, Vec3::X * 20.0, Vec3::Z * 20.0];
        let moved = offset_from_surface(Vec3::ZERO, interpolation_error(a, b, c), Vec3::Y, Vec3::Y);
        assert!(moved.y > 1e-6);
    }
}
