//! Lights.

use std::f64::consts::PI;

use glam::{Mat3, Vec3};

use super::emitted::Emitted;
use crate::radiometry::{
    Area, Irradiance, ProjectedSolidAngle, Radiance, RadiantFlux, RadiantIntensity, Rgb, SolidAngle,
};

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
        radiance: Emitted,
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
        radiance: Emitted,
    },
    /// A sphere that emits outwards.
    Sphere {
        /// Centre, m.
        center: Vec3,
        /// Radius, m.
        radius: f32,
        /// Emitted radiance, W/(m² sr).
        radiance: Emitted,
    },
    /// A point that emits alike in all directions.
    Point {
        /// Position, m.
        position: Vec3,
        /// Radiant intensity, W/sr.
        intensity: Emitted,
    },
    /// A point that emits into a cone.
    Spot {
        /// Position, m.
        position: Vec3,
        /// Unit axis of the cone.
        direction: Vec3,
        /// Radiant intensity on the axis, W/sr.
        intensity: Emitted,
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
        irradiance: Emitted,
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

    /// How much it emits, and by which spectrum.
    pub fn emitted(&self) -> &Emitted {
        match self {
            Self::Quad { radiance, .. } | Self::Disk { radiance, .. } | Self::Sphere { radiance, .. } => {
                radiance
            }
            Self::Point { intensity, .. } | Self::Spot { intensity, .. } => intensity,
            Self::Directional { irradiance, .. } => irradiance,
        }
    }

    /// What it emits, in the quantity that a light of its kind has.
    pub fn emission(&self) -> Emission {
        match *self {
            Self::Quad { radiance, .. } | Self::Disk { radiance, .. } | Self::Sphere { radiance, .. } => {
                Emission::Radiance(Radiance(radiance.rgb))
            }
            Self::Point { intensity, .. } | Self::Spot { intensity, .. } => {
                Emission::Intensity(RadiantIntensity(intensity.rgb))
            }
            Self::Directional { irradiance, .. } => Emission::Irradiance(Irradiance(irradiance.rgb)),
        }
    }

    /// The whole power that it emits; `None` for parallel light, which has as much as it finds surfaces.
    pub fn power(&self) -> Option<RadiantFlux<Rgb>> {
        match (self.emission(), self.extent()) {
            (Emission::Radiance(radiance), Extent::Surface(area)) => {
                Some(radiance.exitance(ProjectedSolidAngle::HEMISPHERE) * area)
            }
            (Emission::Intensity(intensity), Extent::Directions(solid_angle)) => {
                Some(intensity * solid_angle)
            }
            _ => None,
        }
    }

    fn extent(&self) -> Extent {
        let squared = |radius: f32| f64::from(radius).powi(2);
        match *self {
            Self::Quad { half_u, half_v, .. } => {
                Extent::Surface(Area(4.0 * half_u.as_dvec3().cross(half_v.as_dvec3()).length()))
            }
            Self::Disk { radius, .. } => Extent::Surface(Area(PI * squared(radius))),
            Self::Sphere { radius, .. } => Extent::Surface(Area(4.0 * PI * squared(radius))),
            Self::Point { .. } => Extent::Directions(SolidAngle::SPHERE),
            Self::Spot { inner_angle, outer_angle, .. } => {
                Extent::Directions(SolidAngle(f64::from(spot_solid_angle(inner_angle, outer_angle))))
            }
            Self::Directional { .. } => Extent::Unbounded,
        }
    }

    /// Name of its kind in scene files.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Quad { .. } => "quad",
            Self::Disk { .. } => "disk",
            Self::Sphere { .. } => "sphere",
            Self::Point { .. } => "point",
            Self::Spot { .. } => "spot",
            Self::Directional { .. } => "directional",
        }
    }
}

/// What a light emits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Emission {
    /// Of something that has a surface, alike in all directions.
    Radiance(Radiance<Rgb>),
    /// Of a point; on its axis where it has one.
    Intensity(RadiantIntensity<Rgb>),
    /// Of parallel light, on a surface that faces it.
    Irradiance(Irradiance<Rgb>),
}

/// What the emission of a light extends over.
enum Extent {
    Surface(Area),
    /// Directions, weighted by the share of the intensity on the axis.
    Directions(SolidAngle),
    Unbounded,
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
    let (inner, outer) = (SolidAngle::cone(inner_angle.into()), SolidAngle::cone(outer_angle.into()));
    (inner + (outer - inner) * (1.0 / 3.0)).0 as f32
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
            let expected = 2.0 * PI * sum * step;
            let got = f64::from(spot_solid_angle(inner, outer));
            assert!((got - expected).abs() <= 2.0 * PI * (step + 1e-6 * top), "{got} {expected}");
        }
    }

    #[test]
    fn power_is_radiance_over_surface_and_directions() {
        let rgb = Rgb::new(1.0, 2.0, 3.0);
        let radiance = Emitted::from(rgb);
        let sphere = Light::Sphere { center: Vec3::ZERO, radius: 0.5, radiance };
        let quad = Light::Quad { center: Vec3::ZERO, half_u: Vec3::X, half_v: 0.25 * Vec3::Y, radiance };
        let disk = Light::Disk { center: Vec3::ZERO, normal: Vec3::Z, radius: 2.0, radiance };
        let point = Light::Point { position: Vec3::ZERO, intensity: radiance };
        for (light, of_one) in [(sphere, PI * PI), (quad, PI), (disk, 4.0 * PI * PI), (point, 4.0 * PI)] {
            let power = light.power().unwrap().0;
            for c in 0..3 {
                let expected = of_one * f64::from(rgb[c]);
                // One rounding to single precision.
                assert!((f64::from(power[c]) / expected - 1.0).abs() < 1e-7, "{}", light.kind());
            }
        }
        let sun = Light::Directional { direction: Vec3::NEG_Y, irradiance: radiance };
        assert_eq!(sun.power(), None);
        assert_eq!(sun.emission(), Emission::Irradiance(Irradiance(rgb)));
    }
}
