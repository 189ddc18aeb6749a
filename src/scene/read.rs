//! Reading a scene from whatever file holds it.

use std::path::Path;

use super::complete::complete;
use super::gltf::{decode_images, read_undecoded};
use super::toml::read_toml;
use super::{Scene, SceneError};

/// Reads the scene at `path`: a `.toml` scene file, or a `.glb` or `.gltf` file alone. What the file
/// left out and the reader assumed stands in [`Scene::warnings`].
///
/// Errors name the file and the place in it.
pub fn read_scene(path: &Path) -> Result<Scene, SceneError> {
    read_scene_with(path, |_| Ok(()))
}

/// The same, changed by `change` before images are decoded: those that no placed surface shows any more are not.
pub fn read_scene_with<E: From<SceneError>>(
    path: &Path,
    change: impl FnOnce(&mut Scene) -> Result<(), E>,
) -> Result<Scene, E> {
    let mut scene = read_undecoded_scene(path)?;
    change(&mut scene)?;
    decode_images(&mut scene)?;
    Ok(scene)
}

fn read_undecoded_scene(path: &Path) -> Result<Scene, SceneError> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    match extension.as_str() {
        "toml" => read_toml(path),
        "glb" | "gltf" => {
            let gltf = read_undecoded(path)?;
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
