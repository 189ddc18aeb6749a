//! Warps from the unit square to other domains, each with its density.

use std::f32::consts::{FRAC_PI_4, PI, TAU};

use glam::{Vec2, Vec3};

/// Concentric map of the unit square onto the unit disk (Shirley and Chiu 1997); density 1/π.
pub fn square_to_disk(u: f32, v: f32) -> Vec2 {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    if a == 0.0 && b == 0.0 {
        return Vec2::ZERO;
    }
    let (r, phi) =
        if a.abs() > b.abs() { (a, FRAC_PI_4 * (b / a)) } else { (b, 2.0 * FRAC_PI_4 - FRAC_PI_4 * (a / b)) };
    Vec2::from_angle(phi) * r
}

/// Direction on the hemisphere around +z with density cosθ/π.
pub fn square_to_cosine_hemisphere(u: f32, v: f32) -> Vec3 {
    let d = square_to_disk(u, v);
    d.extend((1.0 - d.length_squared()).max(0.0).sqrt())
}

/// Direction inside the cone around +z whose half angle has 1 − cosine `one_minus_cos_max`
/// (so that narrow cones keep their digits); density 1/(2π·`one_minus_cos_max`).
pub fn square_to_cone(u: f32, v: f32, one_minus_cos_max: f32) -> Vec3 {
    let one_minus_cos = u * one_minus_cos_max;
    let sin = (one_minus_cos * (2.0 - one_minus_cos)).max(0.0).sqrt();
    Vec3::new(sin * (TAU * v).cos(), sin * (TAU * v).sin(), 1.0 - one_minus_cos)
}

/// Barycentric coordinates (of the second and third vertex) uniform over a triangle
/// (Heitz 2019, "A Low-Distortion Map Between Triangle and Square").
pub fn square_to_triangle(u: f32, v: f32) -> Vec2 {
    if u > v {
        let x = 0.5 * v;
        Vec2::new(u - x, x)
    } else {
        let x = 0.5 * u;
        Vec2::new(x, v - x)
    }
}

/// Density of [`square_to_cosine_hemisphere`] per solid angle.
pub fn cosine_hemisphere_density(cos_theta: f32) -> f32 {
    cos_theta.max(0.0) / PI
}
