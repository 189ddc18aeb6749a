//! Writes one mesh as a binary glTF 2.0 file.

use glam::DVec2;
use serde_json::{Value, json};

use super::remesh::Shaded;

/// A mesh with all that its file says about it.
pub struct Model<'a> {
    /// Name of mesh and node.
    pub name: &'a str,
    /// Geometry.
    pub shape: Shaded,
    /// Metres per unit of the geometry.
    pub scale: f64,
    /// Texture coordinates at each vertex; empty: none.
    pub coordinates: Vec<DVec2>,
    /// A glTF material object.
    pub material: Value,
    /// A JPEG that the material names as texture 0.
    pub jpeg: Option<Vec<u8>>,
}

impl Model<'_> {
    /// The whole `.glb` file.
    pub fn to_glb(&self) -> Vec<u8> {
        let mut buffer = Buffer::default();
        let positions: Vec<[f32; 3]> =
            self.shape.surface.positions.iter().map(|p| (p * self.scale).as_vec3().to_array()).collect();
        let normals: Vec<[f32; 3]> = self.shape.normals.iter().map(|n| n.as_vec3().to_array()).collect();
        let bound = |pick: fn(f32, f32) -> f32| {
            positions.iter().copied().reduce(|a, b| [0, 1, 2].map(|i| pick(a[i], b[i])))
        };

        let position = buffer.accessor(bytemuck::cast_slice(&positions), positions.len(), 5126, "VEC3");
        buffer.accessors[position]["min"] = json!(bound(f32::min));
        buffer.accessors[position]["max"] = json!(bound(f32::max));
        let normal = buffer.accessor(bytemuck::cast_slice(&normals), normals.len(), 5126, "VEC3");
        let mut attributes = json!({ "POSITION": position, "NORMAL": normal });
        if !self.coordinates.is_empty() {
            let uv: Vec<[f32; 2]> = self.coordinates.iter().map(|c| c.as_vec2().to_array()).collect();
            attributes["TEXCOORD_0"] =
                json!(buffer.accessor(bytemuck::cast_slice(&uv), uv.len(), 5126, "VEC2"));
        }
        let indices = self.indices(&mut buffer);

        let mut document = json!({
            "asset": { "version": "2.0", "generator": "alabaster make_scenes" },
            "scene": 0,
            "scenes": [{ "nodes": [0] }],
            "nodes": [{ "name": self.name, "mesh": 0 }],
            "meshes": [{
                "name": self.name,
                "primitives": [{ "attributes": attributes, "indices": indices, "material": 0 }],
            }],
            "materials": [self.material],
        });
        if let Some(extensions) = self.material["extensions"].as_object() {
            document["extensionsUsed"] = json!(extensions.keys().collect::<Vec<_>>());
        }
        if let Some(jpeg) = &self.jpeg {
            document["images"] = json!([{ "bufferView": buffer.view(jpeg), "mimeType": "image/jpeg" }]);
            document["samplers"] =
                json!([{ "magFilter": 9729, "minFilter": 9729, "wrapS": 10497, "wrapT": 10497 }]);
            document["textures"] = json!([{ "source": 0, "sampler": 0 }]);
        }
        document["accessors"] = Value::Array(buffer.accessors);
        document["bufferViews"] = Value::Array(buffer.views);
        document["buffers"] = json!([{ "byteLength": buffer.bytes.len() }]);
        container(document.to_string().into_bytes(), buffer.bytes)
    }

    /// Accessor of the indices: 16 bits where they suffice (65535 itself is not allowed).
    fn indices(&self, buffer: &mut Buffer) -> usize {
        let flat = self.shape.surface.triangles.as_flattened();
        if self.shape.surface.positions.len() < 65535 {
            let short: Vec<u16> = flat.iter().map(|&i| i as u16).collect();
            buffer.accessor(bytemuck::cast_slice(&short), flat.len(), 5123, "SCALAR")
        } else {
            buffer.accessor(bytemuck::cast_slice(flat), flat.len(), 5125, "SCALAR")
        }
    }
}

/// The binary chunk in the making.
#[derive(Default)]
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Buffer {
    /// Appends `bytes` at a multiple of four as a buffer view.
    fn view(&mut self, bytes: &[u8]) -> usize {
        self.views.push(json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() }));
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    fn accessor(&mut self, bytes: &[u8], count: usize, component: u32, kind: &str) -> usize {
        let view = self.view(bytes);
        self.accessors
            .push(json!({ "bufferView": view, "componentType": component, "count": count, "type": kind }));
        self.accessors.len() - 1
    }
}

/// Header, JSON chunk and binary chunk (glTF 2.0, section 4.4).
fn container(mut json: Vec<u8>, binary: Vec<u8>) -> Vec<u8> {
    json.resize(json.len().next_multiple_of(4), b' ');
    let total = 12 + 8 + json.len() + 8 + binary.len();
    let mut file = Vec::with_capacity(total);
    let word = |file: &mut Vec<u8>, value: u32| file.extend_from_slice(&value.to_le_bytes());
    for value in [0x4654_6C67, 2, total as u32, json.len() as u32, 0x4E4F_534A] {
        word(&mut file, value);
    }
    file.extend_from_slice(&json);
    for value in [binary.len() as u32, 0x004E_4942] {
        word(&mut file, value);
    }
    file.extend_from_slice(&binary);
    file
}
