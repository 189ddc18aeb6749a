//! What the tests of scattering share.

use std::f64::consts::TAU;

use alabaster::math::quadrature::GaussLegendre;
use alabaster::optics::{Bsdf, Dielectric, Metal, MetallicRoughness, Plastic, ThinDielectric};
use alabaster::radiometry::Rgb;
use glam::Vec3;

/// The unit direction of cosine `cos` with +z and azimuth `phi`.
pub fn direction(cos: f32, phi: f32) -> Vec3 {
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    Vec3::new(sin * phi.cos(), sin * phi.sin(), cos)
}

/// ∫ `f` over the sphere of directions.
pub fn sphere_integral(f: impl Fn(Vec3) -> f64) -> f64 {
    const AZIMUTHS: usize = 400;
    let rule = GaussLegendre::new(200);
    let ring = |z: f64| {
        let r = (1.0 - z * z).sqrt();
        let at = |j: usize| {
            let phi = TAU * (j as f64 + 0.5) / AZIMUTHS as f64;
            f(Vec3::new((r * phi.cos()) as f32, (r * phi.sin()) as f32, z as f32))
        };
        TAU * (0..AZIMUTHS).map(at).sum::<f64>() / AZIMUTHS as f64
    };
    rule.integrate(-1.0, 0.0, ring) + rule.integrate(0.0, 1.0, ring)
}

const GOLD: Rgb = Rgb::new(1.0, 0.8, 0.3);

/// The glTF material that the others are varied from.
pub fn gltf() -> MetallicRoughness {
    MetallicRoughness {
        base_color: GOLD,
        metallic: 0.0,
        alpha: 0.25,
        eta: 1.5,
        transmission: 0.0,
        diffuse_transmission: 0.0,
        diffuse_transmission_color: Rgb::new(1.0, 1.0, 0.5),
        thin: false,
    }
}

/// Every kind of BSDF with lobes wide enough for quadrature over the sphere.
pub fn rough_bsdfs() -> Vec<(&'static str, Bsdf)> {
    let plastic = |alpha, thin| {
        let (reflectance, transmittance) = (Rgb::new(0.7, 0.2, 0.1), Rgb::new(0.3, 0.5, 0.1));
        Bsdf::Plastic(Plastic { reflectance_normal: 0.04, alpha, reflectance, transmittance, thin })
    };
    let dielectric = |eta, alpha| Bsdf::Dielectric(Dielectric { eta, alpha, tint: Rgb::ONE });
    vec![
        ("diffuse", Bsdf::Diffuse { reflectance: GOLD }),
        ("metal", Bsdf::Metal(Metal { reflectance_normal: GOLD, alpha: 0.2 })),
        ("rough metal", Bsdf::Metal(Metal { reflectance_normal: GOLD, alpha: 1.0 })),
        ("glass", dielectric(1.5, 0.15)),
        ("rough glass", dielectric(1.5, 0.7)),
        ("bubble", dielectric(1.0 / 1.5, 0.3)),
        ("thin wall", Bsdf::ThinDielectric(ThinDielectric { eta: 1.5, alpha: 0.2, tint: GOLD })),
        ("plastic", plastic(0.3, true)),
        ("glossy plastic", plastic(0.0, false)),
        ("glTF plastic", Bsdf::MetallicRoughness(gltf())),
        ("glTF alloy", Bsdf::MetallicRoughness(MetallicRoughness { metallic: 0.4, ..gltf() })),
        ("glTF everything", Bsdf::MetallicRoughness(everything(false))),
        ("glTF thin everything", Bsdf::MetallicRoughness(everything(true))),
    ]
}

/// A material with all lobes at once.
pub fn everything(thin: bool) -> MetallicRoughness {
    MetallicRoughness { metallic: 0.2, transmission: 0.4, diffuse_transmission: 0.3, thin, ..gltf() }
}
