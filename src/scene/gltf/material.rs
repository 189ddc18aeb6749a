//! Materials (glTF 2.0, section 3.9) with the translucency extensions.

use ::gltf::json;
use ::gltf::json::material::AlphaMode;
use ::gltf::json::validation::Checked;
use serde_json::{Map, Value};

use super::Reader;
use super::extensions::{self, DiffuseTransmission, EmissiveStrength, Ior, Scatter, Transmission, Volume};
use super::image::TextureReference;
use super::volume::{ScatterDraft, extinction};
use crate::radiometry::spectrum::dispersion::Dispersion;
use crate::radiometry::{Rgb, Spectrum};
use crate::scene::material::{Coverage, MetallicRoughness};
use crate::scene::{ColorInput, Material, ScalarInput, SceneError, Surface};

/// Stands for the infinite index of refraction that glTF writes as 0: reflects all but 4·10⁻⁶.
const INFINITE_IOR: f32 = 1e6;

/// The extensions of one material.
pub(super) struct Extensions {
    pub ior: f32,
    pub dispersion: Option<Dispersion>,
    pub transmission: Transmission,
    pub volume: Volume,
    pub diffuse_transmission: DiffuseTransmission,
    pub scatter: Option<(ScatterDraft, Scatter)>,
    pub unlit: bool,
}

/// The inputs that every kind of surface is made from.
pub(super) struct Base {
    pub color: ColorInput,
    pub metallic: ScalarInput,
    pub roughness: ScalarInput,
}

impl Reader<'_> {
    /// The scene's material for glTF material `index`, or for the default one.
    pub(super) fn material(&mut self, index: Option<usize>, place: &str) -> Result<usize, SceneError> {
        if let Some(&known) = self.materials.get(&index) {
            return Ok(known);
        }
        let material = match index {
            None => self.convert(&json::Material::default(), "default", place)?,
            Some(index) => {
                let source = self.document.get(&self.document.materials, "material", index, place)?;
                let name = source.name.clone().unwrap_or_else(|| format!("material {index}"));
                self.convert(source, &name, &format!("/materials/{index}"))?
            }
        };
        self.scene.materials.push(material);
        self.materials.insert(index, self.scene.materials.len() - 1);
        Ok(self.scene.materials.len() - 1)
    }

    fn convert(&mut self, source: &json::Material, name: &str, place: &str) -> Result<Material, SceneError> {
        let map = source.extensions.as_ref().map(|e| &e.others);
        let extensions = self.extensions(map, place)?;
        let base = self.base(source, place)?;
        let coverage = self.coverage(source, base.color.texture, place)?;
        let surface = self.surface(base, extensions, place)?;
        let normal_map = match &source.normal_texture {
            None => None,
            Some(info) => {
                let reference = TextureReference::normal(info);
                let scale = self.finite(info.scale, place, "normalTexture/scale")?;
                Some((self.texture(reference, false, &format!("{place}/normalTexture"))?, scale))
            }
        };
        Ok(Material {
            name: name.to_owned(),
            surface,
            emission: self.emission(source, map, place)?,
            normal_map,
            coverage,
            double_sided: source.double_sided,
        })
    }

    fn extensions(
        &mut self,
        map: Option<&Map<String, Value>>,
        place: &str,
    ) -> Result<Extensions, SceneError> {
        let document = self.document;
        let Ior { ior } = document.extension(map, "KHR_materials_ior", place)?.unwrap_or_default();
        let ior = self.index_of_refraction(ior, place)?;
        let volume: Volume = document.extension(map, "KHR_materials_volume", place)?.unwrap_or_default();
        if volume.attenuation_distance <= 0.0 {
            return Err(document.error(
                format!("{place}/extensions/KHR_materials_volume/attenuationDistance"),
                format!("{} is not a distance above 0; mend it", volume.attenuation_distance),
            ));
        }
        let attenuation_color = self.color_factor(
            volume.attenuation_color,
            place,
            "extensions/KHR_materials_volume/attenuationColor",
        );
        let scatter = match document.extension(map, "KHR_materials_scatter", place)? {
            Some(scatter) => Some((ScatterDraft::Scatter, scatter)),
            None => document
                .extension(map, "KHR_materials_volume_scatter", place)?
                .map(|scatter| (ScatterDraft::VolumeScatter, scatter)),
        };
        Ok(Extensions {
            ior,
            dispersion: self.dispersion(ior, map, place)?,
            transmission: document.extension(map, "KHR_materials_transmission", place)?.unwrap_or_default(),
            volume: Volume { attenuation_color: attenuation_color.0, ..volume },
            diffuse_transmission: document
                .extension(map, "KHR_materials_diffuse_transmission", place)?
                .unwrap_or_default(),
            scatter,
            unlit: map.is_some_and(|map| map.contains_key("KHR_materials_unlit")),
        })
    }

    /// By the Abbe number 20/dispersion; 0: none.
    fn dispersion(
        &self,
        ior: f32,
        map: Option<&Map<String, Value>>,
        place: &str,
    ) -> Result<Option<Dispersion>, SceneError> {
        let extension = self.document.extension(map, "KHR_materials_dispersion", place)?;
        let extensions::Dispersion { dispersion } = extension.unwrap_or_default();
        if dispersion == 0.0 {
            return Ok(None);
        }
        let key = "extensions/KHR_materials_dispersion/dispersion";
        let abbe = 20.0 / f64::from(self.finite(dispersion, place, key)?);
        let found = Dispersion::from_abbe(f64::from(ior), abbe);
        found.map(Some).map_err(|error| {
            self.document.error(format!("{place}/{key}"), format!("{dispersion} means {error}; mend it"))
        })
    }

    fn index_of_refraction(&mut self, ior: f32, place: &str) -> Result<f32, SceneError> {
        let key = "extensions/KHR_materials_ior/ior";
        let ior = self.finite(ior, place, key)?;
        if ior == 0.0 {
            return Ok(INFINITE_IOR);
        }
        if ior < 1.0 {
            self.warnings.add(format!("ior {ior} is below 1, taken as 1"), format!("{place}/{key}"));
        }
        Ok(ior.clamp(1.0, INFINITE_IOR))
    }

    fn base(&mut self, source: &json::Material, place: &str) -> Result<Base, SceneError> {
        let pbr = &source.pbr_metallic_roughness;
        let place = format!("{place}/pbrMetallicRoughness");
        let [r, g, b, _] = pbr.base_color_factor.0;
        let color = ColorInput {
            factor: self.color_factor([r, g, b], &place, "baseColorFactor"),
            texture: self.color_texture(pbr.base_color_texture.as_ref(), &place, "baseColorTexture")?,
            vertex_color: true,
        };
        let texture = pbr.metallic_roughness_texture.as_ref();
        let key = "metallicRoughnessTexture";
        Ok(Base {
            color,
            metallic: ScalarInput {
                factor: self.factor(pbr.metallic_factor.0, &place, "metallicFactor"),
                texture: self.data_texture(texture, 2, &place, key)?,
                vertex_alpha: false,
            },
            roughness: ScalarInput {
                factor: self.factor(pbr.roughness_factor.0, &place, "roughnessFactor"),
                texture: self.data_texture(texture, 1, &place, key)?,
                vertex_alpha: false,
            },
        })
    }

    fn coverage(
        &mut self,
        source: &json::Material,
        base_color_texture: Option<usize>,
        place: &str,
    ) -> Result<Coverage, SceneError> {
        let factor = source.pbr_metallic_roughness.base_color_factor.0[3];
        let factor = self.factor(factor, place, "pbrMetallicRoughness/baseColorFactor");
        let alpha = ScalarInput { factor, texture: base_color_texture.map(|t| (t, 3)), vertex_alpha: true };
        match source.alpha_mode {
            Checked::Valid(AlphaMode::Opaque) => Ok(Coverage::Full),
            Checked::Valid(AlphaMode::Mask) => {
                let cutoff = source.alpha_cutoff.unwrap_or_default().0;
                Ok(Coverage::Mask { alpha, cutoff: self.finite(cutoff, place, "alphaCutoff")? })
            }
            Checked::Valid(AlphaMode::Blend) => Ok(Coverage::Blend { alpha }),
            Checked::Invalid => Err(self
                .document
                .error(format!("{place}/alphaMode"), "must be \"OPAQUE\", \"MASK\" or \"BLEND\"; mend it")),
        }
    }

    /// `emissiveFactor` × texture × `emissiveStrength`, taken as W/(m² sr).
    fn emission(
        &mut self,
        source: &json::Material,
        map: Option<&Map<String, Value>>,
        place: &str,
    ) -> Result<ColorInput, SceneError> {
        let EmissiveStrength { emissive_strength } =
            self.document.extension(map, "KHR_materials_emissive_strength", place)?.unwrap_or_default();
        let factor = Spectrum(source.emissive_factor.0) * emissive_strength;
        if !(factor.is_finite() && factor.min_component() >= 0.0) {
            return Err(self.document.error(
                format!("{place}/emissiveFactor"),
                "emissiveFactor × emissiveStrength must be finite and not negative; mend it",
            ));
        }
        if factor.is_black() {
            return Ok(ColorInput::default());
        }
        let texture = self.color_texture(source.emissive_texture.as_ref(), place, "emissiveTexture")?;
        Ok(ColorInput { factor, texture, vertex_color: false })
    }

    /// Chooses the kind of surface.
    fn surface(&mut self, base: Base, extensions: Extensions, place: &str) -> Result<Surface, SceneError> {
        if extensions.unlit {
            self.warnings.add("an unlit material is rendered as a diffuse one", place);
            return Ok(Surface::Diffuse { reflectance: base.color });
        }
        if let Some((draft, scatter)) = &extensions.scatter
            && let Some(medium) = self.scattering(*draft, scatter, &base, &extensions, place)?
        {
            return Ok(self.translucent(medium, &base, &extensions, place));
        }
        let solid = extensions.volume.thickness_factor > 0.0;
        let clear = extensions.transmission.transmission_factor == 1.0
            && extensions.transmission.transmission_texture.is_none()
            && extensions.diffuse_transmission.diffuse_transmission_factor == 0.0;
        if solid && clear && is_zero(base.metallic) {
            return Ok(Surface::Dielectric {
                ior: extensions.ior,
                dispersion: extensions.dispersion,
                roughness: base.roughness,
                sigma_a: extinction(&extensions.volume),
                tint: base.color,
            });
        }
        self.metallic_roughness(base, extensions, place)
    }

    fn metallic_roughness(
        &mut self,
        base: Base,
        extensions: Extensions,
        place: &str,
    ) -> Result<Surface, SceneError> {
        let transmission = extensions.transmission;
        let diffuse = extensions.diffuse_transmission;
        let transmission_place = format!("{place}/extensions/KHR_materials_transmission");
        let diffuse_place = format!("{place}/extensions/KHR_materials_diffuse_transmission");
        Ok(Surface::MetallicRoughness(Box::new(MetallicRoughness {
            base_color: base.color,
            metallic: base.metallic,
            roughness: base.roughness,
            ior: extensions.ior,
            transmission: ScalarInput {
                factor: self.factor(
                    transmission.transmission_factor,
                    &transmission_place,
                    "transmissionFactor",
                ),
                texture: self.data_texture(
                    transmission.transmission_texture.as_ref(),
                    0,
                    &transmission_place,
                    "transmissionTexture",
                )?,
                vertex_alpha: false,
            },
            diffuse_transmission: ScalarInput {
                factor: self.factor(
                    diffuse.diffuse_transmission_factor,
                    &diffuse_place,
                    "diffuseTransmissionFactor",
                ),
                texture: self.data_texture(
                    diffuse.diffuse_transmission_texture.as_ref(),
                    3,
                    &diffuse_place,
                    "diffuseTransmissionTexture",
                )?,
                vertex_alpha: false,
            },
            diffuse_transmission_color: ColorInput {
                factor: self.color_factor(
                    diffuse.diffuse_transmission_color_factor,
                    &diffuse_place,
                    "diffuseTransmissionColorFactor",
                ),
                texture: self.color_texture(
                    diffuse.diffuse_transmission_color_texture.as_ref(),
                    &diffuse_place,
                    "diffuseTransmissionColorTexture",
                )?,
                vertex_color: false,
            },
            thin: extensions.volume.thickness_factor <= 0.0,
            sigma_a: extinction(&extensions.volume),
            dispersion: extensions.dispersion,
        })))
    }

    pub(super) fn color_texture(
        &mut self,
        info: Option<&json::texture::Info>,
        place: &str,
        key: &str,
    ) -> Result<Option<usize>, SceneError> {
        let reference = info.map(TextureReference::from);
        reference.map(|reference| self.texture(reference, true, &format!("{place}/{key}"))).transpose()
    }

    fn data_texture(
        &mut self,
        info: Option<&json::texture::Info>,
        channel: usize,
        place: &str,
        key: &str,
    ) -> Result<Option<(usize, usize)>, SceneError> {
        let Some(info) = info else { return Ok(None) };
        let texture = self.texture(TextureReference::from(info), false, &format!("{place}/{key}"))?;
        Ok(Some((texture, channel)))
    }

    pub(super) fn finite(&self, value: f32, place: &str, key: &str) -> Result<f32, SceneError> {
        if value.is_finite() {
            return Ok(value);
        }
        Err(self.document.error(format!("{place}/{key}"), format!("{value} is not a finite number; mend it")))
    }

    /// A factor in [0, 1]; outside it is clamped with a warning.
    pub(super) fn factor(&mut self, value: f32, place: &str, key: &str) -> f32 {
        let clamped = if value.is_nan() { 0.0 } else { value.clamp(0.0, 1.0) };
        if clamped != value {
            self.warnings.add(format!("{key} outside [0, 1] is clamped"), format!("{place}/{key}"));
        }
        clamped
    }

    pub(super) fn color_factor(&mut self, color: [f32; 3], place: &str, key: &str) -> Rgb {
        Spectrum(color.map(|value| self.factor(value, place, key)))
    }
}

pub(super) fn is_zero(input: ScalarInput) -> bool {
    input.factor == 0.0
}
