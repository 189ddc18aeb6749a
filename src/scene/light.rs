//! Lights.

use std::f32::consts::TAU;

use glam::{Mat3, Vec3};

use crate::radiometry::Rgb;

/// A light. All are seen by the camera where they have a size.
#[derive(Clone, Debug, PartialEq)]
pub enum Light {
    /// A parallelogram that emits from the side its normal u×v points to; black and opaque behind.
    Quad {
        /// Centre, m.
        center: Vec3,
        /// Half of the first edge, m.
        half_u: Vec3,
        /// Half of the second edge, orthogonal to the first, m.
        half_v: Vec3,
        /// Emitted radiance, W/(m² sr).
        radiance: Rgb,
    },
    /// A disk that emits from the side of its normal; black and opaque behind.
    Disk {
        /// Centre, m.
        center: Vec3,
        /// Unit normal of the emitting side.
        normal: Vec3,
        /// Radius, m.
        radius: f32,
        /// Emitted radiance, W/(m² sr).
        radiance: Rgb,
    },
    /// A sphere that emits outwards.
    Sphere {
        /// Centre, m.
        center: Vec3,
        /// Radius, m.
        radius: f32,
        /// Emitted radiance, W/(m² sr).
        radiance: Rgb,
    },
    /// A point that emits alike in all directions.
    Point {
        /// Position, m.
        position: Vec3,
        /// Radiant intensity, W/sr.
        intensity: Rgb,
    },
    /// A point that emits into a cone.
    Spot {
        /// Position, m.
        position: Vec3,
        /// Unit axis of the cone.
        direction: Vec3,
        /// Radiant intensity on the axis, W/sr.
        intensity: Rgb,
        /// Half angle within which the intensity is full, radians.
        inner_angle: f32,
        /// Half angle beyond which there is none, radians.
        outer_angle: f32,
    },
    /// Parallel light from infinitely far away.
    Directional {
        /// Unit direction in which the light travels.
        direction: Vec3,
        /// Irradiance on a surface that faces the light, W/m².
        irradiance: Rgb,
    },
}

impl Light {
    /// True if paths can meet it.
    pub fn has_size(&self) -> bool {
        match self {
            Self::Quad { .. } | Self::Disk { .. } | Self::Sphere { .. } => true,
            Self::Point { .. } | Self::Spot { .. } | Self::Directional { .. } => false,
        }
    }
}

/// Light from infinitely far away in every direction.
#[derive(Clone, Debug, PartialEq)]
pub enum Environment {
    /// The same radiance from everywhere, W/(m² sr).
    Constant(Rgb),
    /// An equirectangular map: row 0 looks up (+y), the middle column looks down −z before `rotation`.
    Map {
        /// Width in pixels.
        width: usize,
        /// Height in pixels.
        height: usize,
        /// Row-major radiance, W/(m² sr), finite and not negative; scale already applied.
        radiance: Vec<Rgb>,
        /// World direction to map direction.
        rotation: Mat3,
    },
}

/// Share of its intensity that a spot light sends at `cos_angle` from its axis: 1 inside the inner
/// and 0 outside the outer half angle (radians), in between the squared ramp in the cosine that
/// KHR_lights_punctual recommends.
pub fn spot_falloff(cos_angle: f32, inner_angle: f32, outer_angle: f32) -> f32 {
    let (inner, outer) = (inner_angle.cos(), outer_angle.cos());
    if cos_angle >= inner {
        1.0
    } else if cos_angle <= outer {
        0.0
    } else {
        ((cos_angle - outer) / (inner - outer)).powi(2)
    }
}

/// Integral of [`spot_falloff`] over the sphere, sr: 2π[(1 − cos θᵢ) + (cos θᵢ − cos θₒ)/3].
/// The power of a spot light is this times the intensity on its axis.
pub fn spot_solid_angle(inner_angle: f32, outer_angle: f32) -> f32 {
    // 1 − cos θ = 2 sin²(θ/2) keeps the digits of narrow cones.
    let one_minus_cos = |angle: f32| 2.0 * (0.5 * angle).sin().powi(2);
    let (inner, outer) = (one_minus_cos(inner_angle), one_minus_cos(outer_angle));
    TAU * (inner + (outer - inner) / 3.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spot_solid_angle_is_the_integral_of_the_falloff() {
        for (inner, outer) in [(0.0_f32, 0.5_f32), (0.2, 0.7), (0.4, 0.4), (1.0, 1.5)] {
            // Midpoint rule in the cosine over the cone; the integrand is monotone and at most 1, so
            // the rule is off by at most one step.
            let (n, top) = (100_000, 1.0 - f64::from(outer.cos()));
            let step = top / f64::from(n);
            let sum: f64 = (0..n)
                .map(|i| 1.0 - (f64::from(i) + 0.5) * step)
                .map(|cos| f64::from(spot_falloff(cos as f32, inner, outer)))
                .sum();
            let expected = f64::from(TAU) * sum * step;
            let got = f64::from(spot_solid_angle(inner, outer));
            assert!((got - expected).abs() <= f64::from(TAU) * (step + 1e-6 * top), "{got} {expected}");
        }
    }
}
