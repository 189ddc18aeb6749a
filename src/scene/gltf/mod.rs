//! The glTF 2.0 reader.

use std::path::Path;

use super::{Camera, Scene, SceneError};

/// What a glTF file holds.
#[derive(Clone, Debug, Default)]
pub struct GltfScene {
    /// Meshes, instances, materials, textures and lights.
    pub scene: Scene,
    /// The first camera.
    pub camera: Option<Camera>,
}

/// Reads the `.gltf` or `.glb` file at `path`.
pub fn read_gltf(path: &Path) -> Result<GltfScene, SceneError> {
    Err(SceneError::file(path, "reading glTF is not built yet"))
}
