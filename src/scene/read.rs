//! Reading a scene from whatever file holds it.

use std::path::Path;

use super::complete::complete;
use super::gltf::read_gltf;
use super::toml::read_toml;
use super::{Scene, SceneError};

/// Reads the scene at `path`: a `.toml` scene file, or a `.glb` or `.gltf` file alone. What the file
/// left out and the reader assumed stands in [`Scene::warnings`].
///
/// Errors name the file and the place in it.
pub fn read_scene(path: &Path) -> Result<Scene, SceneError> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    match extension.as_str() {
        "toml" => read_toml(path),
        "glb" | "gltf" => {
            let gltf = read_gltf(path)?;
            let mut scene = gltf.scene;
            complete(&mut scene, gltf.camera, gltf.has_lights, path)?;
            Ok(scene)
        }
        _ => Err(SceneError::file(
            path,
            "a scene is a .toml, .glb or .gltf file; other models: export them as glTF",
        )),
    }
}
