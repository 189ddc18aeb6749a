//! Placing the content of glTF files in a scene.

use std::path::{Path, PathBuf};

use glam::Affine3A;

use crate::scene::gltf::{GltfScene, read_gltf};
use crate::scene::material::Coverage;
use crate::scene::{
    Camera, ColorInput, Instance, Light, Material, ScalarInput, ScatteringInput, Scene, SceneError, Surface,
};

/// The glTF files that a scene names: each is read once, however often it is placed.
#[derive(Default)]
pub struct GltfFiles {
    files: Vec<LoadedFile>,
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
    /// `material` instead of the file's own if given.
    pub fn place(
        &mut self,
        path: &Path,
        material: Option<usize>,
        transform: Affine3A,
        scene: &mut Scene,
    ) -> Result<(), SceneError> {
        let file = self.load(path, scene)?;
        let first_material = match material {
            Some(_) => 0,
            None => *file.first_material.get_or_insert_with(|| move_materials(&mut file.gltf.scene, scene)),
        };
        scene.instances.extend(file.gltf.scene.instances.iter().map(|instance| Instance {
            name: instance.name.clone(),
            mesh: file.first_mesh + instance.mesh,
            material: material.unwrap_or(first_material + instance.material),
            transform: transform * instance.transform,
        }));
        scene.lights.extend(file.gltf.scene.lights.iter().map(|light| moved_light(light, &transform)));
        let camera = file.gltf.camera.map(|camera| moved_camera(camera, &transform));
        self.camera = self.camera.or(camera);
        Ok(())
    }

    fn load(&mut self, path: &Path, scene: &mut Scene) -> Result<&mut LoadedFile, SceneError> {
        let index = match self.files.iter().position(|file| file.path == path) {
            Some(index) => index,
            None => {
                let mut gltf = read_gltf(path)?;
                let first_mesh = scene.meshes.len();
                scene.meshes.append(&mut gltf.scene.meshes);
                scene.warnings.append(&mut gltf.scene.warnings);
                self.files.push(LoadedFile { path: path.to_owned(), gltf, first_mesh, first_material: None });
                self.files.len() - 1
            }
        };
        Ok(&mut self.files[index])
    }
}

/// Moves materials, textures and images; returns the new index of the first material.
fn move_materials(from: &mut Scene, to: &mut Scene) -> usize {
    let (first_material, first_texture, first_image) =
        (to.materials.len(), to.textures.len(), to.images.len());
    for material in &mut from.materials {
        shift_textures(material, first_texture);
    }
    for texture in &mut from.textures {
        texture.image += first_image;
    }
    to.materials.append(&mut from.materials);
    to.textures.append(&mut from.textures);
    to.images.append(&mut from.images);
    first_material
}

/// Adds `by` to every texture index of `material`.
fn shift_textures(material: &mut Material, by: usize) {
    let color = |input: &mut ColorInput| {
        if let Some(texture) = &mut input.texture {
            *texture += by;
        }
    };
    let scalar = |input: &mut ScalarInput| {
        if let Some((texture, _)) = &mut input.texture {
            *texture += by;
        }
    };
    color(&mut material.emission);
    if let Some((texture, _)) = &mut material.normal_map {
        *texture += by;
    }
    match &mut material.coverage {
        Coverage::Full => {}
        Coverage::Mask { alpha, .. } | Coverage::Blend { alpha } => scalar(alpha),
    }
    match &mut material.surface {
        Surface::Diffuse { reflectance } => color(reflectance),
        Surface::Metal { reflectance, roughness } => {
            color(reflectance);
            scalar(roughness);
        }
        Surface::MetallicRoughness(m) => {
            color(&mut m.base_color);
            color(&mut m.diffuse_transmission_color);
            for input in [&mut m.metallic, &mut m.roughness, &mut m.transmission, &mut m.diffuse_transmission]
            {
                scalar(input);
            }
        }
        Surface::Dielectric { roughness, tint, .. } => {
            scalar(roughness);
            color(tint);
        }
        Surface::Translucent { medium: ScatteringInput::Albedo { albedo, .. }, .. } => color(albedo),
        Surface::Translucent { medium: ScatteringInput::Coefficients { .. }, .. } => {}
    }
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
