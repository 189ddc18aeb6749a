//! Solid angles, plain and projected: how much of all directions something takes up.

use std::f64::consts::PI;
use std::iter::Sum;
use std::ops::{Add, Mul, Sub};

use glam::DVec3;
use serde::Serialize;

/// A set of directions by its area on the unit sphere, ω in sr.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Serialize)]
#[serde(transparent)]
#[repr(transparent)]
pub struct SolidAngle(pub f64);

/// A set of directions by the area of its shadow on a plane, ∫ cosθ dω in sr; θ is the angle with the normal of
/// the plane, and only directions on the side of the normal count.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Serialize)]
#[serde(transparent)]
#[repr(transparent)]
pub struct ProjectedSolidAngle(pub f64);

impl SolidAngle {
    /// All directions, 4π.
    pub const SPHERE: Self = Self(4.0 * PI);
    /// All directions on one side of a plane, 2π.
    pub const HEMISPHERE: Self = Self(2.0 * PI);

    /// A cone of the given half angle (radians, 0 to π): 2π (1 − cos α).
    pub fn cone(half_angle: f64) -> Self {
        // 1 − cos α = 2 sin²(α/2) keeps the digits of narrow cones.
        Self(4.0 * PI * (0.5 * half_angle).sin().powi(2))
    }

    /// A cap cut off a sphere around the eye, as seen from there: 2π h/r for height `height` and radius `radius`
    /// (Archimedes).
    pub fn cap(height: f64, radius: f64) -> Self {
        Self(2.0 * PI * (height / radius).clamp(0.0, 2.0))
    }

    /// A sphere of radius `radius` whose centre is `distance` away; everything from inside.
    pub fn sphere(radius: f64, distance: f64) -> Self {
        let sin = radius / distance;
        if sin >= 1.0 {
            return Self::SPHERE;
        }
        // 1 − √(1 − s²) = s²/(1 + √(1 − s²)) keeps the digits of small ones.
        Self(2.0 * PI * sin * sin / (1.0 + ((1.0 - sin) * (1.0 + sin)).sqrt()))
    }

    /// A triangle as seen from `eye`: tan(ω/2) = |a·(b×c)| / (abc + (a·b)c + (b·c)a + (c·a)b) for the vectors a, b, c
    /// to its corners (Van Oosterom and Strackee 1983, "The Solid Angle of a Plane Triangle", eq. 8).
    pub fn triangle(corners: [DVec3; 3], eye: DVec3) -> Self {
        let [a, b, c] = corners.map(|corner| corner - eye);
        // The same volume by edges, which are short where the triangle is small.
        let volume = a.dot((corners[1] - corners[0]).cross(corners[2] - corners[0])).abs();
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        let denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        Self(2.0 * volume.atan2(denominator))
    }

    /// A flat convex quad, its corners in order, as seen from `eye`.
    pub fn quad(corners: [DVec3; 4], eye: DVec3) -> Self {
        let [a, b, c, d] = corners;
        Self::triangle([a, b, c], eye) + Self::triangle([a, c, d], eye)
    }

    /// The same directions, all at an angle of cosine `cos` with a normal; nothing below its horizon.
    #[inline]
    pub fn projected(self, cos: f64) -> ProjectedSolidAngle {
        ProjectedSolidAngle(self.0 * cos.max(0.0))
    }
}

impl ProjectedSolidAngle {
    /// All directions on the side of the normal, π.
    pub const HEMISPHERE: Self = Self(PI);

    /// A cone of the given half angle (radians, 0 to π/2) around the normal: π sin²α.
    pub fn cone(half_angle: f64) -> Self {
        Self(PI * half_angle.sin().powi(2))
    }

    /// A sphere wholly above the horizon, its centre `distance` away in a direction of cosine `cos` with the normal:
    /// π (r/d)² cosθ.
    pub fn sphere(radius: f64, distance: f64, cos: f64) -> Self {
        Self(PI * (radius / distance).powi(2) * cos.max(0.0))
    }

    /// A polygon, its corners in order, as seen from `eye` on a surface of unit normal `normal`. No corner may be below
    /// the horizon. Lambert's formula, ½ |Σ Γᵢ·n|, Γᵢ the angle of an edge along the normal of its plane through
    /// the eye (Lambert 1760, *Photometria*).
    pub fn polygon(corners: &[DVec3], eye: DVec3, normal: DVec3) -> Self {
        let edge = |i: usize| {
            let a = (corners[i] - eye).normalize_or_zero();
            let b = (corners[(i + 1) % corners.len()] - eye).normalize_or_zero();
            let cross = a.cross(b);
            cross.normalize_or_zero().dot(normal) * cross.length().atan2(a.dot(b))
        };
        Self(0.5 * (0..corners.len()).map(edge).sum::<f64>().abs())
    }
}

macro_rules! sums {
    ($name:ident) => {
        impl Add for $name {
            type Output = Self;

            #[inline]
            fn add(self, other: Self) -> Self {
                Self(self.0 + other.0)
            }
        }

        impl Sub for $name {
            type Output = Self;

            #[inline]
            fn sub(self, other: Self) -> Self {
                Self(self.0 - other.0)
            }
        }

        impl Mul<f64> for $name {
            type Output = Self;

            #[inline]
            fn mul(self, factor: f64) -> Self {
                Self(self.0 * factor)
            }
        }

        impl Sum for $name {
            fn sum<I: Iterator<Item = Self>>(parts: I) -> Self {
                parts.fold(Self::default(), |sum, part| sum + part)
            }
        }
    };
}

sums!(SolidAngle);
sums!(ProjectedSolidAngle);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::quadrature::GaussLegendre;

    /// Eight triangles of an octahedron see all directions, from anywhere inside.
    #[test]
    fn triangles_around_the_eye_fill_the_sphere() {
        for eye in [DVec3::ZERO, DVec3::new(0.3, -0.2, 0.4), DVec3::new(0.999_999, 0.0, 0.0)] {
            let signs = [-1.0, 1.0];
            let faces = signs.iter().flat_map(|x| signs.iter().flat_map(move |y| signs.map(|z| (*x, *y, z))));
            let sum: SolidAngle = faces
                .map(|(x, y, z)| SolidAngle::triangle([DVec3::X * x, DVec3::Y * y, DVec3::Z * z], eye))
                .sum();
            // Corners nearer than 1e-6 lose as many digits of their directions.
            assert!((sum.0 - 4.0 * PI).abs() < 1e-9, "{eye}: {}", sum.0);
        }
    }

    /// Small and far: A cosθ/r², where the plain formula by unit vectors has lost every digit.
    #[test]
    fn a_small_triangle_keeps_its_digits() {
        let size = 1e-9;
        let corners = [DVec3::ZERO, DVec3::X * size, DVec3::Y * size].map(|p| p + DVec3::Z * 2.0);
        let expected = 0.5 * size * size / 4.0;
        let got = SolidAngle::triangle(corners, DVec3::ZERO).0;
        // The edges are differences of exact coordinates; what is left is the curvature, of order size².
        assert!((got / expected - 1.0).abs() < 1e-12, "{got} {expected}");
    }

    #[test]
    fn a_cube_has_six_equal_faces() {
        let face = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(x, y)| DVec3::new(x, y, 1.0));
        let angle = SolidAngle::quad(face, DVec3::ZERO).0;
        assert!((angle - 4.0 * PI / 6.0).abs() < 8.0 * f64::EPSILON, "{angle}");
    }

    #[test]
    fn cones_caps_and_spheres_are_one_thing() {
        for half_angle in [1e-8_f64, 1e-3, 0.4, 1.3] {
            let cone = SolidAngle::cone(half_angle).0;
            let sphere = SolidAngle::sphere(half_angle.sin(), 1.0).0;
            let cap = SolidAngle::cap(2.0 * (0.5 * half_angle).sin().powi(2), 1.0).0;
            assert!((cone / sphere - 1.0).abs() < 1e-14 && (cone / cap - 1.0).abs() < 1e-14, "{half_angle}");
        }
        assert_eq!(SolidAngle::sphere(2.0, 1.0), SolidAngle::SPHERE);
        assert!((SolidAngle::cone(PI).0 - 4.0 * PI).abs() < 4.0 * f64::EPSILON);
    }

    /// ∫ cosθ dω over the quad by quadrature over its area.
    #[test]
    fn a_projected_polygon_is_the_integral_of_the_cosine() {
        let (eye, normal) = (DVec3::new(0.1, -0.2, 0.3), DVec3::new(0.2, 0.1, 1.0).normalize());
        let (center, u, v) = (DVec3::new(0.4, 0.6, 2.0), DVec3::X * 0.8, DVec3::new(0.0, 0.5, 0.3));
        let corners = [center - u - v, center + u - v, center + u + v, center - u + v];
        let rule = GaussLegendre::new(24);
        let integral = rule.integrate(-1.0, 1.0, |s| {
            rule.integrate(-1.0, 1.0, |t| {
                let offset = center + u * s + v * t - eye;
                let squared = offset.length_squared();
                u.cross(v).dot(offset).abs() * normal.dot(offset) / (squared * squared)
            })
        });
        // The integrand is analytic some diameters around the quad: 24 nodes leave rounding only.
        let got = ProjectedSolidAngle::polygon(&corners, eye, normal).0;
        assert!((got - integral).abs() < 1e-13, "{got} {integral}");
    }

    #[test]
    fn a_projected_cone_and_sphere_agree_around_the_normal() {
        for half_angle in [1e-6_f64, 0.2, 1.0] {
            let cone = ProjectedSolidAngle::cone(half_angle).0;
            let sphere = ProjectedSolidAngle::sphere(half_angle.sin(), 1.0, 1.0).0;
            assert!((cone / sphere - 1.0).abs() < 4.0 * f64::EPSILON);
        }
        assert!((ProjectedSolidAngle::cone(PI / 2.0).0 - PI).abs() < 2.0 * f64::EPSILON);
        assert_eq!(SolidAngle(2.0).projected(-0.5).0, 0.0);
    }
}
