//! A scene with one effect off.

use crate::medium::albedo_inversion::AlbedoInversion;
use crate::medium::{Entry, Medium};
use crate::radiometry::Rgb;
use crate::scene::{ScatteringInput, Scene, Surface};

/// What can be left out of the light transport in translucent bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// The phase function: it becomes isotropic, scattering is reduced to σ_s (1 − g).
    Anisotropy,
    /// The change of index at the boundary: light goes straight in and nothing is reflected.
    Refraction,
    /// Roughness of the boundary.
    Roughness,
    /// Coefficients of their own for each channel: all have the mean.
    Channels,
    /// Subsurface scattering: light leaves where it entered.
    Subsurface,
}

impl Effect {
    /// All of them.
    pub const ALL: [Self; 5] =
        [Self::Anisotropy, Self::Refraction, Self::Roughness, Self::Channels, Self::Subsurface];

    /// The name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Anisotropy => "anisotropy",
            Self::Refraction => "refraction",
            Self::Roughness => "roughness",
            Self::Channels => "channels",
            Self::Subsurface => "subsurface",
        }
    }

    /// What is done where it is off.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Anisotropy => "scattering alike in all directions, σₛ (1 − g) in place of σₛ",
            Self::Refraction => "no boundary: index 1 inside",
            Self::Roughness => "a smooth boundary",
            Self::Channels => "the same coefficients for red, green and blue",
            Self::Subsurface => "light leaves where it entered (diffuse)",
        }
    }

    /// `scene` without it; `None` if it has no such effect.
    pub fn off(self, scene: &Scene) -> Option<Scene> {
        let mut changed = scene.clone();
        let mut any = false;
        for material in &mut changed.materials {
            let Surface::Translucent { ior, roughness, medium } = &mut material.surface else { continue };
            any |= match self {
                Self::Anisotropy => make_isotropic(medium, *ior),
                Self::Refraction => replace(ior, 1.0),
                Self::Roughness => replace(roughness, 0.0),
                Self::Channels => make_gray(medium),
                Self::Subsurface => true,
            };
        }
        any.then_some(changed)
    }
}

/// Puts `value` into `place`; true if it was another.
fn replace(place: &mut f32, value: f32) -> bool {
    std::mem::replace(place, value) != value
}

/// The coefficients of a medium; `None` where they vary over the surface. `ior` is the index relative to what is around.
pub fn coefficients(medium: &ScatteringInput, ior: f32) -> Option<Medium> {
    match medium {
        ScatteringInput::Coefficients { sigma_a, sigma_s, g }
        | ScatteringInput::Spectral { sigma_a, sigma_s, g, .. } => {
            Some(Medium { sigma_a: *sigma_a, sigma_s: *sigma_s, g: *g })
        }
        ScatteringInput::Albedo { albedo, .. } if albedo.texture.is_some() || albedo.vertex_color => None,
        ScatteringInput::Albedo { albedo, mean_free_path, g } => {
            let inversion = AlbedoInversion::new(f64::from(ior), f64::from(*g), Entry::Diffuse);
            let absorbed = albedo.factor.map(|a| inversion.absorbed_share(f64::from(a)) as f32);
            let extinction = mean_free_path.map(|l| 1.0 / l);
            let sigma_s = extinction.zip(absorbed, |t, x| t * (1.0 - x));
            Some(Medium { sigma_a: extinction * absorbed, sigma_s, g: *g })
        }
    }
}

fn make_isotropic(medium: &mut ScatteringInput, ior: f32) -> bool {
    if medium.g() == 0.0 {
        return false;
    }
    let Some(known) = coefficients(medium, ior) else { return false };
    *medium =
        ScatteringInput::Coefficients { sigma_a: known.sigma_a, sigma_s: known.sigma_s_reduced(), g: 0.0 };
    true
}

fn make_gray(medium: &mut ScatteringInput) -> bool {
    let flatten = |color: &mut Rgb| {
        let gray = Rgb::splat(color.mean());
        std::mem::replace(color, gray) != gray
    };
    medium.forget_wavelengths();
    match medium {
        ScatteringInput::Coefficients { sigma_a, sigma_s, .. }
        | ScatteringInput::Spectral { sigma_a, sigma_s, .. } => flatten(sigma_a) | flatten(sigma_s),
        ScatteringInput::Albedo { albedo, mean_free_path, .. } => {
            flatten(&mut albedo.factor) | flatten(mean_free_path)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{ColorInput, Material};

    fn scene(ior: f32, roughness: f32, medium: ScatteringInput) -> Scene {
        let surface = Surface::Translucent { ior, roughness, medium };
        Scene {
            materials: vec![Material { surface, ..Material::default() }, Material::default()],
            ..Scene::default()
        }
    }

    fn medium_of(scene: &Scene) -> Medium {
        match &scene.materials[0].surface {
            Surface::Translucent { medium, ior, .. } => coefficients(medium, *ior).unwrap(),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn each_effect_goes_off_alone() {
        let (sigma_a, sigma_s) = (Rgb::new(1.0, 2.0, 3.0), Rgb::new(100.0, 200.0, 300.0));
        let full = scene(1.5, 0.4, ScatteringInput::Coefficients { sigma_a, sigma_s, g: 0.5 });
        let isotropic = medium_of(&Effect::Anisotropy.off(&full).unwrap());
        assert_eq!((isotropic.g, isotropic.sigma_s, isotropic.sigma_a), (0.0, sigma_s * 0.5, sigma_a));
        let gray = medium_of(&Effect::Channels.off(&full).unwrap());
        assert_eq!((gray.sigma_a, gray.sigma_s), (Rgb::splat(2.0), Rgb::splat(200.0)));
        for (effect, expected) in [(Effect::Refraction, (1.0, 0.4)), (Effect::Roughness, (1.5, 0.0))] {
            let Surface::Translucent { ior, roughness, .. } = effect.off(&full).unwrap().materials[0].surface
            else {
                panic!("not translucent");
            };
            assert_eq!((ior, roughness), expected);
        }
    }

    #[test]
    fn what_is_not_there_cannot_go_off() {
        let medium = ScatteringInput::Coefficients { sigma_a: Rgb::ONE, sigma_s: Rgb::ONE, g: 0.0 };
        let plain = scene(1.0, 0.0, medium);
        for effect in [Effect::Anisotropy, Effect::Refraction, Effect::Roughness, Effect::Channels] {
            assert!(effect.off(&plain).is_none(), "{effect:?}");
        }
        assert!(Effect::Subsurface.off(&plain).is_some());
        assert!(Effect::ALL.iter().all(|effect| effect.off(&Scene::default()).is_none()));
    }

    /// A medium asked for by its look reflects the same when its coefficients are written out: to the precision of the
    /// inversion, and of single precision of the share absorbed (10⁻³ here), which 1 − A takes over by half.
    #[test]
    fn a_wanted_albedo_becomes_coefficients() {
        let input = ScatteringInput::Albedo {
            albedo: ColorInput::constant(Rgb::splat(0.8)),
            mean_free_path: Rgb::splat(0.01),
            g: 0.3,
        };
        let medium = coefficients(&input, 1.4).unwrap();
        assert!((medium.sigma_a[0] + medium.sigma_s[0] - 100.0).abs() < 1e-4);
        let share = f64::from(medium.sigma_a[0] / (medium.sigma_a[0] + medium.sigma_s[0]));
        let albedo = AlbedoInversion::new(1.4, 0.3_f32.into(), Entry::Diffuse).albedo(share);
        assert!((albedo - f64::from(0.8_f32)).abs() < 1e-6, "{albedo}");
    }
}
