//! Scenes with an effect left out.

use super::effect_kind::EffectKind;
use crate::radiometry::Rgb;
use crate::scene::material::Coverage;
use crate::scene::{ColorInput, ColorMode, Light, Material, ScalarInput, ScatteringInput, Scene, Surface};

/// Leaves an effect out of `scene`. Those that are methods are the plan's to choose, and where bodies are is not changed.
pub fn leave_out(scene: &mut Scene, kind: EffectKind) {
    match kind {
        EffectKind::AreaLights => {
            scene.lights.retain(|light| !light.has_size());
            scene.materials.iter_mut().for_each(|material| material.emission = ColorInput::default());
        }
        EffectKind::LightsWithoutSize => scene.lights.retain(Light::has_size),
        EffectKind::Environment => scene.environment = None,
        EffectKind::Lens => scene.camera.aperture = 0.0,
        EffectKind::Spectral => scene.render.color_mode = ColorMode::Rgb,
        EffectKind::IndirectLight => scene.render.max_depth = 1,
        EffectKind::SubsurfaceScattering
        | EffectKind::AreaIntegral
        | EffectKind::RandomWalk
        | EffectKind::NestedMedia => {}
        _ => scene.materials.iter_mut().for_each(|material| leave_out_of(material, kind)),
    }
}

fn leave_out_of(material: &mut Material, kind: EffectKind) {
    match kind {
        EffectKind::Refraction => make_indices_equal(&mut material.surface),
        EffectKind::RoughSurfaces => make_smooth(&mut material.surface),
        EffectKind::Absorption => clear(&mut material.surface),
        EffectKind::AnisotropicScattering => change_medium(material, make_isotropic),
        EffectKind::ColoursOfMeanFreePaths => change_medium(material, make_extinction_gray),
        EffectKind::TexturedCoefficients => change_medium(material, |medium| {
            if let ScatteringInput::Albedo { albedo, .. } = medium {
                *albedo = ColorInput::constant(albedo.factor);
            }
        }),
        EffectKind::Textures => {
            let (colors, scalars) = material.inputs_mut();
            colors.into_iter().for_each(|input| *input = ColorInput::constant(input.factor));
            scalars.into_iter().for_each(|input| *input = ScalarInput::constant(input.factor));
            material.normal_map = None;
        }
        EffectKind::NormalMaps => material.normal_map = None,
        EffectKind::PartialCoverage => material.coverage = Coverage::Full,
        EffectKind::Dispersion => match &mut material.surface {
            Surface::Dielectric { dispersion, .. } => *dispersion = None,
            Surface::MetallicRoughness(m) => m.dispersion = None,
            _ => {}
        },
        _ => {}
    }
}

fn make_indices_equal(surface: &mut Surface) {
    match surface {
        Surface::Dielectric { ior, dispersion, .. } => (*ior, *dispersion) = (1.0, None),
        Surface::Translucent { ior, .. } => *ior = 1.0,
        Surface::MetallicRoughness(m) if m.transmission.factor > 0.0 && !m.thin => {
            (m.ior, m.dispersion) = (1.0, None);
        }
        _ => {}
    }
}

fn make_smooth(surface: &mut Surface) {
    match surface {
        Surface::Diffuse { .. } => {}
        Surface::Metal { roughness, .. } | Surface::Dielectric { roughness, .. } => {
            *roughness = ScalarInput::constant(0.0);
        }
        Surface::MetallicRoughness(m) => m.roughness = ScalarInput::constant(0.0),
        Surface::Translucent { roughness, .. } => *roughness = 0.0,
    }
}

/// Lets clear bodies absorb nothing.
fn clear(surface: &mut Surface) {
    match surface {
        Surface::Dielectric { sigma_a, .. } => *sigma_a = Rgb::ZERO,
        Surface::MetallicRoughness(m) => m.sigma_a = Rgb::ZERO,
        Surface::Translucent { medium: ScatteringInput::Coefficients { sigma_a, sigma_s, .. }, .. }
            if sigma_s.is_black() =>
        {
            *sigma_a = Rgb::ZERO;
        }
        _ => {}
    }
}

fn change_medium(material: &mut Material, change: impl FnOnce(&mut ScatteringInput)) {
    if let Surface::Translucent { medium, .. } = &mut material.surface {
        change(medium);
    }
}

/// The similar medium of order 1, σ_s' = σ_s (1 − g). With a wanted albedo the mean free path becomes 1/(σ_t (1 − g)), which it is where
/// little is absorbed.
fn make_isotropic(medium: &mut ScatteringInput) {
    match medium {
        // Of a table, too, reduced scattering stays.
        ScatteringInput::Coefficients { sigma_s, g, .. } | ScatteringInput::Spectral { sigma_s, g, .. } => {
            *sigma_s *= 1.0 - *g;
            *g = 0.0;
        }
        ScatteringInput::Albedo { mean_free_path, g, .. } => {
            *mean_free_path = *mean_free_path / (1.0 - *g);
            *g = 0.0;
        }
    }
}

/// Gives all channels the mean σ_t; how much of it scatters stays as it is, and with it the albedo.
fn make_extinction_gray(medium: &mut ScatteringInput) {
    let mean = medium.sigma_t().mean();
    medium.forget_wavelengths();
    match medium {
        ScatteringInput::Coefficients { sigma_a, sigma_s, .. }
        | ScatteringInput::Spectral { sigma_a, sigma_s, .. } => {
            let sigma_t = *sigma_a + *sigma_s;
            let to_mean = |coefficient: f32, sigma_t: f32| {
                if sigma_t > 0.0 { coefficient / sigma_t * mean } else { 0.0 }
            };
            (*sigma_a, *sigma_s) = (sigma_a.zip(sigma_t, to_mean), sigma_s.zip(sigma_t, to_mean));
        }
        ScatteringInput::Albedo { mean_free_path, .. } => *mean_free_path = Rgb::splat(1.0 / mean),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn medium(kind: EffectKind, medium: ScatteringInput) -> ScatteringInput {
        let surface = Surface::Translucent { ior: 1.5, roughness: 0.3, medium };
        let mut scene =
            Scene { materials: vec![Material { surface, ..Material::default() }], ..Scene::default() };
        leave_out(&mut scene, kind);
        match scene.materials.remove(0).surface {
            Surface::Translucent { medium, .. } => medium,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn coefficients_keep_what_is_not_left_out() {
        let (sigma_a, sigma_s) = (Rgb::new(1.0, 2.0, 4.0), Rgb::new(3.0, 8.0, 12.0));
        let input = ScatteringInput::Coefficients { sigma_a, sigma_s, g: 0.5 };
        let ScatteringInput::Coefficients { sigma_a: a, sigma_s: s, g } =
            medium(EffectKind::AnisotropicScattering, input.clone())
        else {
            panic!()
        };
        assert_eq!((a, s, g), (sigma_a, sigma_s * 0.5, 0.0));
        let ScatteringInput::Coefficients { sigma_a: a, sigma_s: s, g } =
            medium(EffectKind::ColoursOfMeanFreePaths, input)
        else {
            panic!()
        };
        // σ_t of 4, 10 and 16 have the mean 10; shares of absorption 1/4, 1/5 and 1/4.
        assert_eq!((a, s, g), (Rgb::new(2.5, 2.0, 2.5), Rgb::new(7.5, 8.0, 7.5), 0.5));
    }

    #[test]
    fn a_wanted_albedo_stays() {
        let albedo = ColorInput { factor: Rgb::splat(0.7), texture: Some(0), vertex_color: true };
        let input = || ScatteringInput::Albedo { albedo, mean_free_path: Rgb::new(0.5, 0.25, 0.125), g: 0.5 };
        let parts = |kind| match medium(kind, input()) {
            ScatteringInput::Albedo { albedo, mean_free_path, g } => (albedo, mean_free_path, g),
            other => panic!("{other:?}"),
        };
        let reduced = (albedo, Rgb::new(1.0, 0.5, 0.25), 0.0);
        assert_eq!(parts(EffectKind::AnisotropicScattering), reduced);
        assert_eq!(parts(EffectKind::ColoursOfMeanFreePaths), (albedo, Rgb::splat(3.0 / 14.0), 0.5));
        assert_eq!(parts(EffectKind::TexturedCoefficients).0, ColorInput::constant(Rgb::splat(0.7)));
    }
}
