//! The JSON of the extensions that are read; keys and defaults as their specifications give them.

use ::gltf::json;
use serde::Deserialize;
use serde_json::{Map, Value};

/// KHR_materials_ior.
#[derive(Deserialize)]
#[serde(default)]
pub(super) struct Ior {
    /// Index of refraction; 0 stands for infinity.
    pub ior: f32,
}

impl Default for Ior {
    fn default() -> Self {
        Self { ior: 1.5 }
    }
}

/// KHR_materials_transmission.
#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Transmission {
    pub transmission_factor: f32,
    pub transmission_texture: Option<json::texture::Info>,
}

/// KHR_materials_volume. The thickness texture serves rasterisers only.
#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Volume {
    /// In the space of the mesh; 0: a thin wall. A ray tracer needs only to know which.
    pub thickness_factor: f32,
    /// World space, m; infinite by default.
    pub attenuation_distance: f32,
    pub attenuation_color: [f32; 3],
}

impl Default for Volume {
    fn default() -> Self {
        Self { thickness_factor: 0.0, attenuation_distance: f32::INFINITY, attenuation_color: [1.0; 3] }
    }
}

/// KHR_materials_volume_scatter and KHR_materials_scatter, two drafts of one idea.
#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Scatter {
    /// The first draft's key; samples in the wild use it.
    multiscatter_color: Option<[f32; 3]>,
    multiscatter_color_factor: Option<[f32; 3]>,
    pub multiscatter_color_texture: Option<json::texture::Info>,
    pub scatter_anisotropy: f32,
    scatter_strength_factor: Option<f32>,
    pub scatter_strength_texture: Option<json::texture::Info>,
}

impl Scatter {
    /// The multi-scatter colour, or `default` which differs between the drafts.
    pub fn color(&self, default: [f32; 3]) -> [f32; 3] {
        self.multiscatter_color_factor.or(self.multiscatter_color).unwrap_or(default)
    }

    /// The factor on the multi-scatter colour, or `default` which differs between the drafts.
    pub fn strength(&self, default: f32) -> f32 {
        self.scatter_strength_factor.unwrap_or(default)
    }
}

/// KHR_materials_dispersion.
#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct Dispersion {
    /// 20 / Abbe number; 0: none.
    pub dispersion: f32,
}

/// KHR_materials_diffuse_transmission.
#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct DiffuseTransmission {
    pub diffuse_transmission_factor: f32,
    /// In its alpha channel.
    pub diffuse_transmission_texture: Option<json::texture::Info>,
    pub diffuse_transmission_color_factor: [f32; 3],
    pub diffuse_transmission_color_texture: Option<json::texture::Info>,
}

impl Default for DiffuseTransmission {
    fn default() -> Self {
        Self {
            diffuse_transmission_factor: 0.0,
            diffuse_transmission_texture: None,
            diffuse_transmission_color_factor: [1.0; 3],
            diffuse_transmission_color_texture: None,
        }
    }
}

/// KHR_materials_emissive_strength.
#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct EmissiveStrength {
    pub emissive_strength: f32,
}

impl Default for EmissiveStrength {
    fn default() -> Self {
        Self { emissive_strength: 1.0 }
    }
}

/// KHR_texture_transform.
#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct TextureTransform {
    pub offset: [f32; 2],
    /// Radians.
    pub rotation: f32,
    pub scale: [f32; 2],
    pub tex_coord: Option<u32>,
}

impl Default for TextureTransform {
    fn default() -> Self {
        Self { offset: [0.0; 2], rotation: 0.0, scale: [1.0; 2], tex_coord: None }
    }
}

/// EXT_texture_webp.
#[derive(Deserialize)]
pub(super) struct WebpTexture {
    pub source: Option<usize>,
}

/// EXT_mesh_gpu_instancing: accessors by attribute name.
#[derive(Deserialize)]
pub(super) struct MeshInstancing {
    #[serde(default)]
    pub attributes: Map<String, Value>,
}

/// KHR_lights_punctual at the top of the file.
#[derive(Deserialize)]
pub(super) struct Lights {
    pub lights: Vec<Light>,
}

/// One light of KHR_lights_punctual.
#[derive(Clone, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Light {
    #[serde(rename = "type")]
    pub kind: String,
    #[serde(default = "white")]
    pub color: [f32; 3],
    /// Candela (point, spot) or lux (directional).
    #[serde(default = "one")]
    pub intensity: f32,
    #[serde(default)]
    pub spot: SpotCone,
}

/// The cone of a spot light: half angles, radians.
#[derive(Clone, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct SpotCone {
    pub inner_cone_angle: f32,
    pub outer_cone_angle: f32,
}

impl Default for SpotCone {
    fn default() -> Self {
        Self { inner_cone_angle: 0.0, outer_cone_angle: std::f32::consts::FRAC_PI_4 }
    }
}

/// KHR_lights_punctual on a node.
#[derive(Deserialize)]
pub(super) struct NodeLight {
    pub light: usize,
}

fn white() -> [f32; 3] {
    [1.0; 3]
}

fn one() -> f32 {
    1.0
}
