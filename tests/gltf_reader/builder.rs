//! Small glTF files made in code.

use std::path::PathBuf;

use alabaster::scene::{GltfScene, SceneError, read_gltf};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};
use tempfile::TempDir;

pub const FLOAT: u32 = 5126;

/// A glTF document in a folder of its own.
pub struct Builder {
    pub json: Value,
    pub folder: TempDir,
}

impl Builder {
    /// No content but the version.
    pub fn empty() -> Self {
        let json =
            json!({ "asset": { "version": "2.0" }, "buffers": [], "bufferViews": [], "accessors": [] });
        Self { json, folder: tempfile::tempdir().unwrap() }
    }

    /// One triangle in the plane z = 0, not indexed, at one node; material 0 if there is one.
    pub fn triangle() -> Self {
        let mut builder = Self::empty();
        let position = builder.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        builder.json["meshes"] = json!([{ "primitives": [{ "attributes": { "POSITION": position } }] }]);
        builder.json["nodes"] = json!([{ "mesh": 0 }]);
        builder.json["scenes"] = json!([{ "nodes": [0] }]);
        builder
    }

    /// The triangle with texture coordinates and `material`.
    pub fn with_material(material: Value) -> Self {
        let mut builder = Self::triangle();
        let coordinates = builder.floats("VEC2", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
        builder.json["materials"] = json!([material]);
        builder.primitive()["material"] = json!(0);
        builder.primitive()["attributes"]["TEXCOORD_0"] = json!(coordinates);
        builder
    }

    /// The first primitive.
    pub fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    /// Adds a buffer with one view and returns the view's index.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        let uri = format!("data:application/octet-stream;base64,{}", BASE64_STANDARD.encode(bytes));
        let buffer = self.push("buffers", json!({ "uri": uri, "byteLength": bytes.len() }));
        self.push("bufferViews", json!({ "buffer": buffer, "byteLength": bytes.len() }))
    }

    /// Adds an accessor of a view and returns its index.
    pub fn accessor(&mut self, view: usize, component: u32, kind: &str, count: usize) -> usize {
        self.push(
            "accessors",
            json!({ "bufferView": view, "componentType": component, "type": kind, "count": count }),
        )
    }

    /// Adds a buffer, view and accessor of floats.
    pub fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        let components = if kind == "SCALAR" { 1 } else { usize::from(kind.as_bytes()[3] - b'0') };
        let view = self.view(&bytes_of(values));
        self.accessor(view, FLOAT, kind, values.len() / components)
    }

    /// Adds an element to a top-level array and returns its index.
    pub fn push(&mut self, section: &str, value: Value) -> usize {
        if self.json[section].is_null() {
            self.json[section] = json!([]);
        }
        let array = self.json[section].as_array_mut().unwrap();
        array.push(value);
        array.len() - 1
    }

    /// Adds an image of `width` × `height` pixels of one colour, with its texture; returns the texture.
    pub fn texture(&mut self, width: u32, height: u32, color: [u8; 4]) -> usize {
        let uri = format!("data:image/png;base64,{}", BASE64_STANDARD.encode(png(width, height, color)));
        let image = self.push("images", json!({ "uri": uri }));
        self.push("textures", json!({ "source": image }))
    }

    /// Writes a file beside the scene.
    pub fn file(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }

    pub fn read(&self) -> Result<GltfScene, SceneError> {
        read_gltf(&self.file("scene.gltf", self.json.to_string().as_bytes()))
    }

    pub fn read_ok(&self) -> GltfScene {
        self.read().unwrap_or_else(|error| panic!("{error}"))
    }

    /// The error that reading must give.
    pub fn read_error(&self) -> SceneError {
        self.read().expect_err("this file must be refused")
    }

    /// As a GLB whose binary chunk is `binary`.
    pub fn glb(&self, binary: &[u8]) -> Vec<u8> {
        let glb = gltf::binary::Glb {
            header: gltf::binary::Header { magic: *b"glTF", version: 2, length: 0 },
            json: self.json.to_string().into_bytes().into(),
            bin: Some(binary.to_vec().into()),
        };
        glb.to_vec().unwrap()
    }
}

pub fn bytes_of(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

pub fn png(width: u32, height: u32, color: [u8; 4]) -> Vec<u8> {
    let picture = image::RgbaImage::from_pixel(width, height, image::Rgba(color));
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// Asserts that one warning holds `part`.
pub fn assert_warns(scene: &GltfScene, part: &str) {
    let found = scene.scene.warnings.iter().any(|warning| warning.contains(part));
    assert!(found, "no warning holds {part:?}: {:#?}", scene.scene.warnings);
}
