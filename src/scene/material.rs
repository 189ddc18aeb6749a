//! Materials as the scene gives them: constants and textures, not yet resolved at a point.

use std::sync::Arc;

use super::texture::{ColorInput, ScalarInput};
use crate::radiometry::Rgb;
use crate::radiometry::spectrum::dispersion::Dispersion;
use crate::radiometry::spectrum::medium_table::MediumTable;

/// A material.
#[derive(Clone, Debug, Default)]
pub struct Material {
    /// Name for people.
    pub name: String,
    /// What the surface does with light.
    pub surface: Surface,
    /// Emitted radiance, W/(m² sr), from the front (and, if double sided, the back).
    pub emission: ColorInput,
    /// Tangent-space normal map: texture index and scale of its x and y.
    pub normal_map: Option<(usize, f32)>,
    /// Where the surface is there at all.
    pub coverage: Coverage,
    /// glTF `doubleSided`: emission and opaque reflection act on both sides. Boundaries of media
    /// always act on both.
    pub double_sided: bool,
}

impl Material {
    /// The textures that the material looks up, by index; one may occur more than once.
    pub fn textures(&self) -> Vec<usize> {
        let mut textures = Vec::new();
        self.clone().for_each_texture_mut(|texture| textures.push(*texture));
        textures
    }

    /// Calls `visit` with every texture index in the material.
    pub fn for_each_texture_mut(&mut self, mut visit: impl FnMut(&mut usize)) {
        let (colors, scalars) = self.inputs_mut();
        colors.into_iter().filter_map(|input| input.texture.as_mut()).for_each(&mut visit);
        scalars.into_iter().filter_map(|input| input.texture.as_mut()).for_each(|(t, _)| visit(t));
        self.normal_map.iter_mut().for_each(|(texture, _)| visit(texture));
    }

    /// Every colour and every number of the material that may vary over the surface.
    pub fn inputs_mut(&mut self) -> (Vec<&mut ColorInput>, Vec<&mut ScalarInput>) {
        let mut colors = vec![&mut self.emission];
        let mut scalars = Vec::new();
        match &mut self.coverage {
            Coverage::Full => {}
            Coverage::Mask { alpha, .. } | Coverage::Blend { alpha } => scalars.push(alpha),
        }
        match &mut self.surface {
            Surface::Diffuse { reflectance } => colors.push(reflectance),
            Surface::Metal { reflectance, roughness } => {
                colors.push(reflectance);
                scalars.push(roughness);
            }
            Surface::MetallicRoughness(m) => {
                colors.extend([&mut m.base_color, &mut m.diffuse_transmission_color]);
                scalars.extend([
                    &mut m.metallic,
                    &mut m.roughness,
                    &mut m.transmission,
                    &mut m.diffuse_transmission,
                ]);
            }
            Surface::Dielectric { roughness, tint, .. } => {
                colors.push(tint);
                scalars.push(roughness);
            }
            Surface::Translucent { medium: ScatteringInput::Albedo { albedo, .. }, .. } => {
                colors.push(albedo)
            }
            Surface::Translucent {
                medium: ScatteringInput::Coefficients { .. } | ScatteringInput::Spectral { .. },
                ..
            } => {}
        }
        (colors, scalars)
    }

    /// True if anything of it varies over the surface.
    pub fn varies(&self) -> bool {
        let mut material = self.clone();
        let (colors, scalars) = material.inputs_mut();
        let varies = colors.iter().any(|input| input.varies()) || scalars.iter().any(|input| input.varies());
        varies || self.normal_map.is_some()
    }

    /// The base colour of a material read from glTF, whatever surface it became; `None` if there is none.
    pub fn base_color(&self) -> Option<ColorInput> {
        match &self.surface {
            Surface::Diffuse { reflectance } => Some(*reflectance),
            Surface::Metal { reflectance, .. } => Some(*reflectance),
            Surface::MetallicRoughness(m) => Some(m.base_color),
            Surface::Dielectric { tint, .. } => Some(*tint),
            Surface::Translucent { .. } => None,
        }
    }

    /// The constant factor of the roughness; `None` if the surface has none.
    pub fn roughness(&self) -> Option<f32> {
        match &self.surface {
            Surface::Diffuse { .. } => None,
            Surface::Metal { roughness, .. } | Surface::Dielectric { roughness, .. } => {
                Some(roughness.factor)
            }
            Surface::MetallicRoughness(m) => Some(m.roughness.factor),
            Surface::Translucent { roughness, .. } => Some(*roughness),
        }
    }
}

/// Where a surface is there at all (glTF alphaMode).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Coverage {
    /// Everywhere.
    #[default]
    Full,
    /// Where the alpha of the base colour reaches `cutoff`.
    Mask {
        /// Alpha of the base colour.
        alpha: ScalarInput,
        /// Threshold.
        cutoff: f32,
    },
    /// With the probability given by the alpha of the base colour.
    Blend {
        /// Alpha of the base colour.
        alpha: ScalarInput,
    },
}

/// What a surface does with light.
#[derive(Clone, Debug)]
pub enum Surface {
    /// Lambert.
    Diffuse {
        /// Diffuse reflectance in [0, 1].
        reflectance: ColorInput,
    },
    /// A conductor under GGX microfacets, Fresnel by Schlick from normal-incidence reflectance.
    Metal {
        /// Reflectance at normal incidence.
        reflectance: ColorInput,
        /// Perceptual roughness; GGX α = roughness².
        roughness: ScalarInput,
    },
    /// glTF metallic-roughness with its transmission extensions.
    MetallicRoughness(Box<MetallicRoughness>),
    /// A clear or absorbing dielectric body.
    Dielectric {
        /// Index of refraction, at the line d where it depends on the wavelength.
        ior: f32,
        /// How it does; `None`: not at all.
        dispersion: Option<Dispersion>,
        /// Perceptual roughness; GGX α = roughness².
        roughness: ScalarInput,
        /// Absorption coefficient inside, 1/m.
        sigma_a: Rgb,
        /// Factor on every transmission.
        tint: ColorInput,
    },
    /// A dielectric body that scatters inside.
    Translucent {
        /// Index of refraction.
        ior: f32,
        /// Perceptual roughness of the boundary; GGX α = roughness².
        roughness: f32,
        /// What is inside.
        medium: ScatteringInput,
    },
}

impl Surface {
    /// True if light goes on unscattered in a body behind it.
    pub fn is_clear_body(&self) -> bool {
        match self {
            Self::Dielectric { .. } => true,
            Self::MetallicRoughness(m) => {
                !m.thin && (m.transmission.factor > 0.0 || m.transmission.texture.is_some())
            }
            _ => false,
        }
    }
}

impl Surface {
    /// Index of refraction of what is behind it, relative to air; 1 where light that passes it stays in the same medium.
    pub fn eta(&self) -> f32 {
        match self {
            Self::Diffuse { .. } | Self::Metal { .. } => 1.0,
            Self::MetallicRoughness(m) if m.thin => 1.0,
            Self::MetallicRoughness(m) => m.ior,
            Self::Dielectric { ior, .. } | Self::Translucent { ior, .. } => *ior,
        }
    }

    /// How the index of a clear body depends on the wavelength; `None` if it does not, or light does not get in.
    pub fn dispersion(&self) -> Option<&Dispersion> {
        match self {
            Self::Dielectric { dispersion, .. } => dispersion.as_ref(),
            Self::MetallicRoughness(m) if self.is_clear_body() => m.dispersion.as_ref(),
            _ => None,
        }
    }

    /// True if it sends light through into another medium and, diffusely, into the same one as well.
    pub fn is_mixed(&self) -> bool {
        match self {
            Self::MetallicRoughness(m) => {
                let has = |input: &ScalarInput| input.factor > 0.0;
                !m.thin && has(&m.diffuse_transmission) && m.ior != 1.0
            }
            _ => false,
        }
    }

    /// Name of its kind in scene files.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Diffuse { .. } => "diffuse",
            Self::Metal { .. } => "metal",
            Self::MetallicRoughness(_) => "gltf",
            Self::Dielectric { .. } => "dielectric",
            Self::Translucent { .. } => "translucent",
        }
    }
}

impl Default for Surface {
    fn default() -> Self {
        Self::Diffuse { reflectance: ColorInput::constant(Rgb::splat(0.5)) }
    }
}

/// glTF 2.0 metallic-roughness (appendix B of the specification) with KHR_materials_transmission,
/// _ior, _volume without scattering, _diffuse_transmission.
#[derive(Clone, Debug)]
pub struct MetallicRoughness {
    /// Base colour.
    pub base_color: ColorInput,
    /// Metalness in [0, 1].
    pub metallic: ScalarInput,
    /// Perceptual roughness; GGX α = roughness².
    pub roughness: ScalarInput,
    /// Index of refraction of the dielectric part, at the line d where it depends on the wavelength.
    pub ior: f32,
    /// Share of the dielectric base that transmits specularly.
    pub transmission: ScalarInput,
    /// Share of the dielectric base that transmits diffusely.
    pub diffuse_transmission: ScalarInput,
    /// Colour of diffuse transmission.
    pub diffuse_transmission_color: ColorInput,
    /// True if the surface is a thin wall: transmitted light goes straight on.
    pub thin: bool,
    /// Absorption coefficient inside, 1/m, where not thin.
    pub sigma_a: Rgb,
    /// How the index depends on the wavelength; `None`: not at all.
    pub dispersion: Option<Dispersion>,
}

/// What scatters inside a translucent body.
#[derive(Clone, Debug)]
pub enum ScatteringInput {
    /// Physical coefficients.
    Coefficients {
        /// Absorption coefficient, 1/m.
        sigma_a: Rgb,
        /// Scattering coefficient, 1/m (not reduced).
        sigma_s: Rgb,
        /// Mean cosine of the Henyey–Greenstein phase function.
        g: f32,
    },
    /// Coefficients by wavelength.
    Spectral {
        /// Absorption coefficient, 1/m, as the channels see it.
        sigma_a: Rgb,
        /// Scattering coefficient, 1/m (not reduced), as the channels see it.
        sigma_s: Rgb,
        /// Mean cosine of the Henyey–Greenstein phase function, at all wavelengths.
        g: f32,
        /// The coefficients; where their mean cosine is another, reduced scattering counts ([`MediumTable::similar`]).
        table: Arc<MediumTable>,
    },
    /// What an artist knows: the wanted reflectance.
    Albedo {
        /// Reflectance of a thick flat body for the light that has entered it, in [0, 1].
        albedo: ColorInput,
        /// 1/σ_t, m.
        mean_free_path: Rgb,
        /// Mean cosine of the Henyey–Greenstein phase function.
        g: f32,
    },
}

impl ScatteringInput {
    /// Mean cosine of the Henyey–Greenstein phase function.
    pub fn g(&self) -> f32 {
        match self {
            Self::Coefficients { g, .. } | Self::Spectral { g, .. } | Self::Albedo { g, .. } => *g,
        }
    }

    /// Leaves what the channels see of coefficients by wavelength.
    pub fn forget_wavelengths(&mut self) {
        if let Self::Spectral { sigma_a, sigma_s, g, .. } = *self {
            *self = Self::Coefficients { sigma_a, sigma_s, g };
        }
    }

    /// Extinction coefficient σ_t, 1/m.
    pub fn sigma_t(&self) -> Rgb {
        match self {
            Self::Coefficients { sigma_a, sigma_s, .. } | Self::Spectral { sigma_a, sigma_s, .. } => {
                *sigma_a + *sigma_s
            }
            Self::Albedo { mean_free_path, .. } => mean_free_path.map(|l| 1.0 / l),
        }
    }
}
