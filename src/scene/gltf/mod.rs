//! Reads glTF 2.0 scenes (`.gltf`, `.glb`).
//!
//! The crate `gltf` splits the GLB container and gives the JSON its types. Everything that follows an
//! index or an offset is done here instead, because a scene file is not to be trusted: each look-up
//! is checked and ends in a [`SceneError`] with the JSON path of the culprit. No file outside the
//! folder of the scene is opened, and memory is bounded by what the files really hold.
//!
//! | file | does |
//! |---|---|
//! | `document` | container, JSON, versions, extensions, buffers |
//! | `uri` | data URIs and files beside the scene |
//! | `accessor` | numbers out of buffers: strided, sparse, normalised |
//! | `geometry`, `tangents` | primitives to triangle meshes |
//! | `nodes` | the node hierarchy to placed instances |
//! | `material`, `translucent`, `volume`, `extensions` | materials, and what is inside them |
//! | `image` | textures, samplers, pictures |
//! | `light`, `camera` | `KHR_lights_punctual` and cameras |

mod accessor;
mod camera;
mod document;
mod extensions;
mod geometry;
mod image;
mod light;
mod material;
mod nodes;
mod tangents;
mod translucent;
mod uri;
mod volume;
mod warnings;

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use self::document::Document;
use self::image::TextureKey;
pub use self::image::decode_images;
use self::warnings::Warnings;
use super::{Camera, Scene, SceneError};

/// What a glTF file holds.
#[derive(Clone, Debug, Default)]
pub struct GltfScene {
    /// Meshes, instances, materials, textures, images, lights and warnings; the rest is default.
    pub scene: Scene,
    /// The first perspective camera in the order of the nodes.
    pub camera: Option<Camera>,
    /// True if something is meant as light: a light, or a material that emits more than a white page
    /// shows, radiance 1 (labels and displays glow below it, KHR_materials_emissive_strength lifts above).
    pub has_lights: bool,
}

/// Reads the default scene of a glTF file (the first scene if none is said to be the default).
///
/// Conventions beyond the standard:
/// - Emission, `emissiveFactor` × texture × `emissiveStrength`, is taken as radiance in W/(m² sr).
/// - Lights are photometric (candela, lux) by the standard and are divided by
///   [`LUMENS_PER_WATT`](crate::radiometry::LUMENS_PER_WATT).
/// - Primitives of one mesh with the same material and the same attributes become one mesh, because
///   a translucent body must be one.
/// - Occlusion textures are not read: the renderer finds occlusion itself.
///
/// # Errors
/// A file is missing, damaged, unsafe to follow, or needs an extension that is not supported; or
/// there is no triangle in the scene.
pub fn read_gltf(path: &Path) -> Result<GltfScene, SceneError> {
    let mut gltf = read_undecoded(path)?;
    decode_images(&mut gltf.scene)?;
    Ok(gltf)
}

/// The same with its images as they are in the files: what becomes of them is known once the scene is complete ([`decode_images`]).
pub fn read_undecoded(path: &Path) -> Result<GltfScene, SceneError> {
    let document = Document::open(path)?;
    let mut reader = Reader::new(&document);
    reader.read_nodes()?;
    reader.finish()
}

/// A scene being read, with what has been read already by its index in the file.
struct Reader<'a> {
    document: &'a Document,
    scene: Scene,
    camera: Option<Camera>,
    warnings: Warnings,
    /// Parts of each glTF mesh: (mesh, material) by index in the scene.
    meshes: BTreeMap<usize, Vec<(usize, usize)>>,
    materials: HashMap<Option<usize>, usize>,
    textures: HashMap<TextureKey, usize>,
    images: HashMap<usize, usize>,
}

impl<'a> Reader<'a> {
    fn new(document: &'a Document) -> Self {
        let title = document.file.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        let mut warnings = Warnings::default();
        if !document.ignored_extensions.is_empty() {
            warnings.add(
                format!(
                    "extensions that are not supported are ignored: {}",
                    document.ignored_extensions.join(", ")
                ),
                "/extensionsUsed",
            );
        }
        for ignored in &document.ignored_features {
            warnings.add(format!("{ignored} are ignored: the scene is shown at rest"), format!("/{ignored}"));
        }
        Self {
            document,
            scene: Scene { title: title.unwrap_or_default(), ..Scene::default() },
            camera: None,
            warnings,
            meshes: BTreeMap::new(),
            materials: HashMap::new(),
            textures: HashMap::new(),
            images: HashMap::new(),
        }
    }

    fn finish(mut self) -> Result<GltfScene, SceneError> {
        self.warn_of_missing_coordinates();
        let warnings = self.warnings.lines();
        if self.scene.instances.is_empty() {
            let notes: String = warnings.iter().map(|line| format!(" (note: {line})")).collect();
            return Err(self.document.error(
                "/scenes",
                format!("there is nothing to render: no node of the scene has a mesh with triangles{notes}; export the objects together with their nodes"),
            ));
        }
        let file = self.document.file.display();
        self.scene.warnings = warnings.into_iter().map(|line| format!("{file}: {line}")).collect();
        let emits = |&(_, material): &(usize, usize)| {
            self.scene.materials.get(material).is_some_and(|m| m.emission.factor.max_component() > 1.0)
        };
        let has_lights = !self.scene.lights.is_empty() || self.meshes.values().flatten().any(emits);
        Ok(GltfScene { scene: self.scene, camera: self.camera, has_lights })
    }
}
