//! Snell and Fresnel at a smooth interface, without the cancellations of the textbook forms.
//!
//! Throughout, `eta` = n_inside / n_outside, where inside is the −z side of the normal: any positive
//! value, below 1 for a bubble, exactly 1 for an interface that is not there.

use std::sync::LazyLock;

use glam::Vec3;

use crate::math::quadrature::GaussLegendre;
use crate::radiometry::Spectrum;

/// What an interface does with unpolarised light that arrives at one angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fresnel {
    /// Share of the power reflected, in [0, 1].
    pub reflectance: f32,
    /// Share of the power transmitted, 1 − reflectance with its own digits: its relative error is a
    /// few ulps also where the reflectance rounds to 1.
    pub transmittance: f32,
    /// Cosine of the refracted direction with the normal: opposite in sign to the incident one, 0 at
    /// total internal reflection.
    pub cos_t: f32,
}

/// Fresnel's equations for a dielectric. `cos_i` is the cosine between the normal and the direction
/// *towards* the light: positive for light from outside, negative for light from inside.
pub fn fresnel_dielectric(cos_i: f32, eta: f32) -> Fresnel {
    let eta = f64::from(eta);
    let relative_eta = if cos_i < 0.0 { 1.0 / eta } else { eta };
    let interface = Interface::new(f64::from(cos_i.abs().min(1.0)), relative_eta);
    Fresnel {
        reflectance: interface.reflectance as f32,
        transmittance: interface.transmittance as f32,
        cos_t: -(interface.cos_t as f32).copysign(cos_i),
    }
}

/// Double-precision Fresnel terms. Inputs are single precision on the hot path, so their squares are
/// exact here and cos²_i − μ_c² keeps its digits up to the critical angle itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interface {
    /// Share of the power reflected, in [0, 1].
    pub reflectance: f64,
    /// Share of the power transmitted, 1 − reflectance with its own digits.
    pub transmittance: f64,
    /// Cosine of the refracted direction; non-negative, 0 at total internal reflection.
    pub cos_t: f64,
}

impl Interface {
    const TOTAL_REFLECTION: Self = Self { reflectance: 1.0, transmittance: 0.0, cos_t: 0.0 };

    /// At `cos_i` in [0, 1], `relative_eta` = n_transmitted / n_incident.
    ///
    /// With e = `relative_eta`, c = cos_i, g = e·cos_t, one has g² = c² + (e² − 1), so that
    /// c − g = −(e² − 1)/(c + g) and e²c − g = (e² − 1)((e² + 1)c² − 1)/(e²c + g): both amplitudes
    /// carry the factor e² − 1, and nothing is left to cancel as e → 1. Likewise
    /// 1 − R_s = 4cg/(c + g)² and 1 − R_p = 4e²cg/(e²c + g)² need no subtraction from 1.
    pub fn new(cos_i: f64, relative_eta: f64) -> Self {
        let e2 = relative_eta * relative_eta;
        let contrast = (relative_eta - 1.0) * (relative_eta + 1.0);
        if contrast == 0.0 {
            return Self { reflectance: 0.0, transmittance: 1.0, cos_t: cos_i };
        }
        let g2 = cos_i * cos_i + contrast;
        // False also for NaN; an infinite ratio is a perfect mirror.
        if !(g2 > 0.0 && g2 < f64::INFINITY) {
            return Self::TOTAL_REFLECTION;
        }
        let g = g2.sqrt();
        let s = 1.0 / (cos_i + g);
        let p = 1.0 / (e2 * cos_i + g);
        let (s2, p2) = (s * s, p * p);
        let amplitude_s = contrast * s2;
        let amplitude_p = contrast * ((e2 + 1.0) * cos_i * cos_i - 1.0) * p2;
        Self {
            reflectance: 0.5 * (amplitude_s * amplitude_s + amplitude_p * amplitude_p),
            transmittance: 2.0 * cos_i * g * (s2 + e2 * p2),
            cos_t: (g / relative_eta).min(1.0),
        }
    }
}

/// The direction into which `w` (unit, pointing away from the surface) is refracted at a surface of
/// unit `normal`, or nothing at total internal reflection.
pub fn refract(w: Vec3, normal: Vec3, eta: f32) -> Option<Vec3> {
    let cos_i = w.dot(normal);
    let fresnel = fresnel_dielectric(cos_i, eta);
    let relative_eta = if cos_i < 0.0 { 1.0 / eta } else { eta };
    (fresnel.transmittance > 0.0).then(|| refracted(w, normal, relative_eta, cos_i, fresnel.cos_t))
}

/// Snell's law with the cosines already known: `cos_t` has the sign opposite to `cos_i` = `w`·`normal`.
pub(super) fn refracted(w: Vec3, normal: Vec3, relative_eta: f32, cos_i: f32, cos_t: f32) -> Vec3 {
    // The tangential part is scaled on its own, so the result does not inherit an error along the normal.
    let tangential = w - cos_i * normal;
    (cos_t * normal - tangential / relative_eta).normalize()
}

/// Direction of mirror reflection of `w` at unit `normal`.
pub fn reflect(w: Vec3, normal: Vec3) -> Vec3 {
    2.0 * w.dot(normal) * normal - w
}

/// (1 − cos)⁵, the blend of Schlick's approximation.
pub fn schlick_weight(cos: f32) -> f32 {
    let m = (1.0 - cos).clamp(0.0, 1.0);
    let m2 = m * m;
    m2 * m2 * m
}

/// Reflectance of a conductor with normal-incidence reflectance `f0` (Schlick 1994, eq. 24).
pub fn fresnel_conductor_schlick<const N: usize>(f0: Spectrum<N>, cos: f32) -> Spectrum<N> {
    let weight = schlick_weight(cos);
    f0.map(|f| f + (1.0 - f) * weight)
}

/// Moment C_k = ∫₀¹ F(μ) μᵏ dμ of the unpolarised Fresnel reflectance, `relative_eta` =
/// n_transmitted / n_incident: `eta` for light from outside, 1/`eta` for light from inside.
///
/// Below the critical cosine μ_c F is 1 and the integral is known. Above it, μ = μ_c + (1 − μ_c)x²
/// takes the square root out of the integrand, and Gauss–Legendre converges to about 1e-14
/// (for |relative_eta − 1| down to 1e-6, to 1e-10 of the moment).
pub fn fresnel_moment(relative_eta: f64, order: u32) -> f64 {
    static RULE: LazyLock<GaussLegendre> = LazyLock::new(|| GaussLegendre::new(200));
    let critical = ((1.0 - relative_eta) * (1.0 + relative_eta)).max(0.0).sqrt();
    let power = order as i32;
    let total = critical.powi(power + 1) / f64::from(power + 1);
    let partial = RULE.integrate(0.0, 1.0, |x| {
        let mu = critical + (1.0 - critical) * x * x;
        Interface::new(mu, relative_eta).reflectance * mu.powi(power) * x
    });
    total + 2.0 * (1.0 - critical) * partial
}
