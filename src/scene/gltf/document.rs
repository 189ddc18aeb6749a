//! The file as a whole: GLB or JSON, version, extensions, typed sections, buffers.

use std::cell::Cell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use ::gltf::binary::Glb;
use ::gltf::json;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use super::extensions::{Light, Lights};
use super::uri::{read_file, read_uri};
use crate::scene::SceneError;

/// Extensions that change the picture and are understood.
const SUPPORTED_EXTENSIONS: &[&str] = &[
    "EXT_mesh_gpu_instancing",
    "EXT_texture_webp",
    "KHR_lights_punctual",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_scatter",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_materials_volume_scatter",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// Longest file that is read, bytes: four times what a GLB can hold.
const MAX_FILE_LENGTH: u64 = 1 << 34;

/// Accessor elements that may be decoded whatever the file holds, and for each of its bytes besides.
/// Accessors without a buffer view, and many accessors of one view, ask for more elements than there
/// are bytes: a small file must not claim all memory.
const FREE_ELEMENTS: usize = 1 << 24;
const ELEMENTS_PER_BYTE: usize = 16;

/// A glTF document with its buffers, typed but not yet followed.
pub(super) struct Document {
    pub file: PathBuf,
    pub folder: PathBuf,
    pub accessors: Vec<json::Accessor>,
    pub buffer_views: Vec<json::buffer::View>,
    pub buffers: Vec<Arc<Vec<u8>>>,
    pub cameras: Vec<json::Camera>,
    pub images: Vec<json::Image>,
    pub lights: Vec<Light>,
    pub materials: Vec<json::Material>,
    pub meshes: Vec<json::Mesh>,
    pub nodes: Vec<json::Node>,
    pub samplers: Vec<json::texture::Sampler>,
    pub scenes: Vec<SceneNodes>,
    pub default_scene: Option<usize>,
    pub textures: Vec<json::Texture>,
    /// True if `KHR_mesh_quantization` is declared: integer positions and normals are allowed.
    pub quantized: bool,
    pub ignored_extensions: Vec<String>,
    /// Sections that are present and not read: `animations`, `skins`.
    pub ignored_features: Vec<&'static str>,
    elements_left: Cell<usize>,
}

/// A scene. The standard lets `nodes` be absent, which the crate's own type does not.
#[derive(Deserialize)]
pub(super) struct SceneNodes {
    #[serde(default)]
    pub nodes: Vec<usize>,
}

impl Document {
    /// Reads the file and every buffer that it names.
    pub fn open(path: &Path) -> Result<Self, SceneError> {
        let bytes = read_file(path, MAX_FILE_LENGTH).map_err(|problem| SceneError::file(path, problem))?;
        let (text, chunk) = split_container(&bytes).map_err(|problem| SceneError::file(path, problem))?;
        let root: Map<String, Value> = serde_json::from_slice(text).map_err(|error| {
            SceneError::file(
                path,
                format!("not a glTF file (expected GLB, or a JSON object): {error}; export it again"),
            )
        })?;
        let source = Source { file: path, root: &root };
        source.check_version()?;
        source.check_required_extensions()?;
        Self::from_source(&source, chunk)
    }

    fn from_source(source: &Source, chunk: Option<&[u8]>) -> Result<Self, SceneError> {
        let file = source.file.to_path_buf();
        let folder = match file.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent.to_path_buf(),
            _ => PathBuf::from("."),
        };
        let buffers = source.buffers(&folder, chunk)?;
        // A buffer that several entries share counts once.
        let bytes: usize = buffers.iter().map(|buffer| buffer.len() / Arc::strong_count(buffer)).sum();
        let elements = bytes.saturating_mul(ELEMENTS_PER_BYTE).saturating_add(FREE_ELEMENTS);
        let declared = source.strings("extensionsUsed")?;
        let required = source.strings("extensionsRequired")?;
        let is_supported = |name: &str| SUPPORTED_EXTENSIONS.contains(&name);
        Ok(Self {
            file,
            folder,
            accessors: source.section("accessors")?,
            buffer_views: source.section("bufferViews")?,
            buffers,
            cameras: source.section("cameras")?,
            images: source.section("images")?,
            lights: source.lights()?,
            materials: source.section("materials")?,
            meshes: source.section("meshes")?,
            nodes: source.section("nodes")?,
            samplers: source.section("samplers")?,
            scenes: source.section("scenes")?,
            default_scene: source.value("scene")?,
            textures: source.section("textures")?,
            quantized: declared.iter().chain(&required).any(|name| name == "KHR_mesh_quantization"),
            ignored_extensions: declared.into_iter().filter(|name| !is_supported(name)).collect(),
            ignored_features: ["animations", "skins"]
                .into_iter()
                .filter(|name| {
                    source.root.get(*name).is_some_and(|v| v.as_array().is_some_and(|a| !a.is_empty()))
                })
                .collect(),
            elements_left: Cell::new(elements),
        })
    }

    /// An error at a JSON path of this file.
    pub fn error(&self, place: impl Into<String>, problem: impl Into<String>) -> SceneError {
        SceneError::at(&self.file, place, problem)
    }

    /// Element `index` of `items`, which `/place` of the file refers to.
    pub fn get<'a, T>(
        &self,
        items: &'a [T],
        kind: &str,
        index: usize,
        place: &str,
    ) -> Result<&'a T, SceneError> {
        items.get(index).ok_or_else(|| {
            self.error(
                place,
                format!("{kind} {index} does not exist (the file has {}); mend the index", items.len()),
            )
        })
    }

    /// The extension `name` of an object at `place`, if it is there.
    pub fn extension<T: DeserializeOwned>(
        &self,
        extensions: Option<&Map<String, Value>>,
        name: &str,
        place: &str,
    ) -> Result<Option<T>, SceneError> {
        let Some(value) = extensions.and_then(|map| map.get(name)) else { return Ok(None) };
        T::deserialize(value)
            .map(Some)
            .map_err(|error| self.error(format!("{place}/extensions/{name}"), wrong_json(&error)))
    }

    /// Takes `count` elements from what may still be decoded.
    pub fn charge_elements(&self, count: usize, place: &str) -> Result<(), SceneError> {
        match self.elements_left.get().checked_sub(count) {
            Some(left) => {
                self.elements_left.set(left);
                Ok(())
            }
            None => Err(self.error(
                place,
                "the accessors ask for far more elements than the buffers hold; reduce `count` or split the scene",
            )),
        }
    }
}

/// A value of the wrong type, or a missing one.
fn wrong_json(error: &serde_json::Error) -> String {
    format!("{error}; mend the JSON or export it again")
}

/// The JSON text and the binary chunk of a GLB file; any other file is JSON text.
fn split_container(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), String> {
    if !bytes.starts_with(b"glTF") {
        // Some editors put a byte order mark before UTF-8.
        return Ok((bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), None));
    }
    // `Glb::from_slice` subtracts the header from this length without a check.
    let declared = bytes.get(8..12).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
    match declared {
        Some(length) if length as usize > bytes.len() => {
            return Err(format!(
                "the file is truncated: its GLB header says {length} bytes, it has {}; copy or export it again",
                bytes.len()
            ));
        }
        Some(length) if length >= 20 => {}
        _ => return Err(String::from("the GLB header is damaged; copy or export the file again")),
    }
    let glb = Glb::from_slice(bytes).map_err(|error| {
        format!("the GLB container is damaged or not version 2: {error}; copy or export the file again")
    })?;
    // The crate borrows both chunks from `bytes`; find them there again to borrow for longer.
    let json_end = 20 + glb.json.len();
    let binary = glb.bin.map(|chunk| (json_end + 8, json_end + 8 + chunk.len()));
    let part =
        |from: usize, to: usize| bytes.get(from..to).ok_or("the GLB chunks overlap the end of the file");
    let binary = binary.map(|(from, to)| part(from, to)).transpose()?;
    Ok((part(20, json_end)?, binary))
}

/// The JSON object of a file that is being opened.
struct Source<'a> {
    file: &'a Path,
    root: &'a Map<String, Value>,
}

impl Source<'_> {
    fn error(&self, place: impl Into<String>, problem: impl Into<String>) -> SceneError {
        SceneError::at(self.file, place, problem)
    }

    fn check_version(&self) -> Result<(), SceneError> {
        let field =
            |name: &str| self.root.get("asset").and_then(|asset| asset.get(name)).and_then(Value::as_str);
        let version = field("version").ok_or_else(|| {
            self.error("/asset/version", "missing: this is not a glTF 2.0 file; export it again as glTF 2.0")
        })?;
        let major = version.split_once('.').map_or(version, |(major, _)| major);
        if major != "2" {
            return Err(self.error(
                "/asset/version",
                format!("glTF version \"{version}\" is not supported; export as glTF 2.0"),
            ));
        }
        match field("minVersion") {
            None | Some("2.0") => Ok(()),
            Some(minimum) => Err(self.error(
                "/asset/minVersion",
                format!("the file needs glTF {minimum}, this program reads 2.0; export as glTF 2.0"),
            )),
        }
    }

    fn check_required_extensions(&self) -> Result<(), SceneError> {
        let required = self.strings("extensionsRequired")?;
        let unsupported: Vec<&str> =
            required.iter().map(String::as_str).filter(|name| !SUPPORTED_EXTENSIONS.contains(name)).collect();
        if unsupported.is_empty() {
            return Ok(());
        }
        let remedy = unsupported
            .iter()
            .find_map(|name| match *name {
                "KHR_draco_mesh_compression" => Some("export without Draco mesh compression"),
                "EXT_meshopt_compression" | "KHR_meshopt_compression" => {
                    Some("export without meshopt compression")
                }
                "KHR_texture_basisu" => Some("export the textures as PNG, JPEG or WebP"),
                "KHR_materials_pbrSpecularGlossiness" => Some("convert the materials to metallic-roughness"),
                _ => None,
            })
            .unwrap_or("export without it");
        Err(self.error(
            "/extensionsRequired",
            format!("the file requires {}, which is not supported; {remedy}", unsupported.join(", ")),
        ))
    }

    /// The value at the top-level key `name`, if there.
    fn value<T: DeserializeOwned>(&self, name: &str) -> Result<Option<T>, SceneError> {
        let Some(value) = self.root.get(name) else { return Ok(None) };
        T::deserialize(value).map(Some).map_err(|error| self.error(format!("/{name}"), wrong_json(&error)))
    }

    fn strings(&self, name: &str) -> Result<Vec<String>, SceneError> {
        Ok(self.value(name)?.unwrap_or_default())
    }

    /// The elements of the top-level array `name`; none if it is absent.
    fn section<T: DeserializeOwned>(&self, name: &str) -> Result<Vec<T>, SceneError> {
        match self.root.get(name) {
            None => Ok(Vec::new()),
            Some(value) => self.array(value, &format!("/{name}")),
        }
    }

    fn array<T: DeserializeOwned>(&self, value: &Value, place: &str) -> Result<Vec<T>, SceneError> {
        let items = value.as_array().ok_or_else(|| self.error(place, "must be an array"))?;
        let element = |(index, item): (usize, &Value)| {
            T::deserialize(item).map_err(|error| self.error(format!("{place}/{index}"), wrong_json(&error)))
        };
        items.iter().enumerate().map(element).collect()
    }

    fn lights(&self) -> Result<Vec<Light>, SceneError> {
        let place = "/extensions/KHR_lights_punctual";
        match self.root.get("extensions").and_then(|value| value.get("KHR_lights_punctual")) {
            None => Ok(Vec::new()),
            Some(value) => Lights::deserialize(value)
                .map(|lights| lights.lights)
                .map_err(|error| self.error(place, wrong_json(&error))),
        }
    }

    /// Every buffer, at least `byteLength` long. A file named by several buffers is read once.
    fn buffers(&self, folder: &Path, chunk: Option<&[u8]>) -> Result<Vec<Arc<Vec<u8>>>, SceneError> {
        let buffers: Vec<json::Buffer> = self.section("buffers")?;
        let mut read: HashMap<String, Arc<Vec<u8>>> = HashMap::new();
        let mut left = MAX_FILE_LENGTH;
        let mut contents = Vec::with_capacity(buffers.len());
        for (index, buffer) in buffers.into_iter().enumerate() {
            let place = format!("/buffers/{index}");
            let known = buffer.uri.as_ref().and_then(|uri| read.get(uri)).map(Arc::clone);
            let bytes = match (known, buffer.uri) {
                (Some(bytes), _) => bytes,
                (None, None) => Arc::new(self.binary_chunk(index, chunk, &place)?),
                (None, Some(uri)) => {
                    let bytes = read_uri(folder, &uri, left)
                        .map_err(|problem| self.error(format!("{place}/uri"), problem))?;
                    left = left.saturating_sub(bytes.len() as u64);
                    let bytes = Arc::new(bytes);
                    read.insert(uri, Arc::clone(&bytes));
                    bytes
                }
            };
            let length = buffer.byte_length.0;
            if (bytes.len() as u64) < length {
                return Err(self.error(
                    place,
                    format!(
                        "truncated: byteLength says {length}, the data has {} bytes; copy or export it again",
                        bytes.len()
                    ),
                ));
            }
            contents.push(bytes);
        }
        Ok(contents)
    }

    fn binary_chunk(&self, index: usize, chunk: Option<&[u8]>, place: &str) -> Result<Vec<u8>, SceneError> {
        match chunk {
            Some(bytes) if index == 0 => Ok(bytes.to_vec()),
            _ => Err(self.error(
                place,
                "has neither a `uri` nor the binary chunk of a .glb (which only buffer 0 may use); export it again",
            )),
        }
    }
}
