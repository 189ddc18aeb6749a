//! Placing the content of glTF files in a scene.

use std::path::{Path, PathBuf};

use glam::Affine3A;

use super::replacement::{Heirs, Replacement};
use crate::scene::gltf::{GltfScene, read_undecoded};
use crate::scene::{Camera, Instance, Light, Scene, SceneError};

/// The glTF files that a scene names: each is read once, however often it is placed.
#[derive(Default)]
pub struct GltfFiles {
    files: Vec<LoadedFile>,
    heirs: Heirs,
    /// The first camera that was placed.
    pub camera: Option<Camera>,
}

/// A file whose meshes have moved into the scene.
struct LoadedFile {
    path: PathBuf,
    gltf: GltfScene,
    first_mesh: usize,
    /// Where its materials begin in the scene, once an object has needed them.
    first_material: Option<usize>,
}

impl GltfFiles {
    /// Adds everything in the file at `path` to `scene`, with `transform` applied, and with
    /// `replacement` instead of the file's own materials if given.
    pub fn place(
        &mut self,
        path: &Path,
        replacement: Option<&Replacement>,
        transform: Affine3A,
        scene: &mut Scene,
    ) -> Result<(), SceneError> {
        let index = self.load(path, scene)?;
        let file = &mut self.files[index];
        let needs_own = replacement.is_none_or(|replacement| replacement.inherits.is_some());
        let first_material = match needs_own {
            true => *file.first_material.get_or_insert_with(|| move_materials(&mut file.gltf.scene, scene)),
            false => 0,
        };
        for instance in &file.gltf.scene.instances {
            let own = first_material + instance.material;
            let material = match replacement {
                Some(replacement) => self.heirs.index(replacement, own, scene)?,
                None => own,
            };
            scene.instances.push(Instance {
                name: instance.name.clone(),
                mesh: file.first_mesh + instance.mesh,
                material,
                transform: transform * instance.transform,
            });
        }
        scene.lights.extend(file.gltf.scene.lights.iter().map(|light| moved_light(light, &transform)));
        let camera = file.gltf.camera.map(|camera| moved_camera(camera, &transform));
        self.camera = self.camera.or(camera);
        Ok(())
    }

    /// The index of the file, which is read if it has not been.
    fn load(&mut self, path: &Path, scene: &mut Scene) -> Result<usize, SceneError> {
        if let Some(known) = self.files.iter().position(|file| file.path == path) {
            return Ok(known);
        }
        let mut gltf = read_undecoded(path)?;
        let first_mesh = scene.meshes.len();
        scene.meshes.append(&mut gltf.scene.meshes);
        scene.warnings.append(&mut gltf.scene.warnings);
        self.files.push(LoadedFile { path: path.to_owned(), gltf, first_mesh, first_material: None });
        Ok(self.files.len() - 1)
    }
}

/// Moves materials, textures and images; returns the new index of the first material.
fn move_materials(from: &mut Scene, to: &mut Scene) -> usize {
    let (first_material, first_texture, first_image) =
        (to.materials.len(), to.textures.len(), to.images.len());
    for material in &mut from.materials {
        material.for_each_texture_mut(|texture| *texture += first_texture);
    }
    for texture in &mut from.textures {
        texture.image += first_image;
    }
    to.materials.append(&mut from.materials);
    to.textures.append(&mut from.textures);
    to.images.append(&mut from.images);
    first_material
}

/// A light of a glTF file (which has only lights without size), placed. Intensities are kept:
/// KHR_lights_punctual excludes them from scaling.
fn moved_light(light: &Light, transform: &Affine3A) -> Light {
    let mut light = light.clone();
    match &mut light {
        Light::Point { position, .. } => *position = transform.transform_point3(*position),
        Light::Spot { position, direction, .. } => {
            *position = transform.transform_point3(*position);
            *direction = transform.transform_vector3(*direction).normalize();
        }
        Light::Directional { direction, .. } => {
            *direction = transform.transform_vector3(*direction).normalize();
        }
        Light::Quad { .. } | Light::Disk { .. } | Light::Sphere { .. } => {}
    }
    light
}

fn moved_camera(camera: Camera, transform: &Affine3A) -> Camera {
    Camera {
        position: transform.transform_point3(camera.position),
        target: transform.transform_point3(camera.target),
        up: transform.transform_vector3(camera.up),
        ..camera
    }
}
