//! What a scene is, as plain data, and how it is read from glTF and TOML.
//!
//! After reading, everything is resolved: files are loaded, colours are linear Rec.709, lengths
//! metres, angles radians, powers turned into radiance or intensity. Nothing here traces rays.

pub mod camera;
mod complete;
mod emitted;
pub mod environment;
pub mod error;
pub mod filter;
pub mod gltf;
pub mod light;
mod lookup;
pub mod material;
mod medium_file;
pub mod mesh;
pub mod read;
pub mod settings;
pub mod shape;
pub mod texture;
mod toml;

pub use camera::Camera;
pub use emitted::{Emitted, Source};
pub use error::SceneError;
pub use gltf::{GltfScene, read_gltf};
pub use light::{Environment, Light};
pub use material::{Material, ScatteringInput, Surface};
pub use mesh::{Instance, Mesh};
pub use read::{read_scene, read_scene_with};
pub use settings::{
    ColorMode, FilmSettings, Filter, Method, ProfileChoice, RenderSettings, SubsurfaceSettings,
};
pub use texture::{ColorInput, Image, ScalarInput, Texture};

/// A scene: everything that a picture depends on.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Title for people.
    pub title: String,
    /// The camera.
    pub camera: Camera,
    /// Resolution and filter.
    pub film: FilmSettings,
    /// Triangle meshes, each in its own space.
    pub meshes: Vec<Mesh>,
    /// Meshes placed in the world.
    pub instances: Vec<Instance>,
    /// Materials, by index.
    pub materials: Vec<Material>,
    /// Textures, by index.
    pub textures: Vec<Texture>,
    /// Images that textures look up, by index.
    pub images: Vec<Image>,
    /// Lights given as lights (emissive materials are lights too, but stand with the materials).
    pub lights: Vec<Light>,
    /// Light from infinitely far away.
    pub environment: Option<Environment>,
    /// How subsurface scattering is computed.
    pub subsurface: SubsurfaceSettings,
    /// How much work is done.
    pub render: RenderSettings,
    /// What the reader assumed or left out; printed to the user.
    pub warnings: Vec<String>,
}
