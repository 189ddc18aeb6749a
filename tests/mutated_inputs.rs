//! Damage of any kind to a scene file: an error or a scene that can be rendered, never a panic.

#[path = "gltf_reader/builder.rs"]
#[allow(dead_code)]
mod builder;
mod common;

use std::path::Path;

use alabaster::scene::read_scene;
use alabaster::transport::Counters;
use builder::{Builder, bytes_of};
use proptest::prelude::*;
use serde_json::json;

/// What is done to the bytes of a file.
#[derive(Clone, Debug)]
enum Damage {
    Replace(usize, u8),
    Remove(usize, usize),
    Insert(usize, Vec<u8>),
    /// Copies a stretch over another.
    Copy {
        from: usize,
        to: usize,
        length: usize,
    },
}

impl Damage {
    fn inflict(&self, bytes: &mut Vec<u8>) {
        let place = |position: usize, bytes: &Vec<u8>| position % (bytes.len() + 1);
        match self {
            Self::Replace(position, value) if !bytes.is_empty() => {
                let position = position % bytes.len();
                bytes[position] = *value;
            }
            Self::Replace(..) => {}
            Self::Remove(position, length) => {
                let start = place(*position, bytes);
                bytes.drain(start..(start + length).min(bytes.len()));
            }
            Self::Insert(position, text) => {
                let start = place(*position, bytes);
                bytes.splice(start..start, text.iter().copied());
            }
            Self::Copy { from, to, length } => {
                let start = place(*from, bytes);
                let stretch = bytes[start..(start + length).min(bytes.len())].to_vec();
                let target = place(*to, bytes);
                let end = (target + stretch.len()).min(bytes.len());
                bytes.splice(target..end, stretch);
            }
        }
    }
}

/// Bytes and pieces of text that matter to the formats.
fn piece() -> impl Strategy<Value = Vec<u8>> {
    let pieces =
        ["-", "1e39", "-1", "nan", "0", "[", "]", "{", "}", "\"", "'", ",", "=", "\n", "99999999999"];
    prop_oneof![
        prop::sample::select(pieces.to_vec()).prop_map(|text| text.as_bytes().to_vec()),
        prop::collection::vec(any::<u8>(), 1..5),
    ]
}

fn damage() -> impl Strategy<Value = Damage> {
    prop_oneof![
        (any::<usize>(), any::<u8>()).prop_map(|(position, value)| Damage::Replace(position, value)),
        (any::<usize>(), 1..9_usize).prop_map(|(position, length)| Damage::Remove(position, length)),
        (any::<usize>(), piece()).prop_map(|(position, text)| Damage::Insert(position, text)),
        (any::<usize>(), any::<usize>(), 1..40_usize).prop_map(|(from, to, length)| Damage::Copy {
            from,
            to,
            length
        }),
    ]
}

/// Reads the file; what can be read must also render, to finite radiance.
fn read_and_render(path: &Path) -> Result<(), TestCaseError> {
    let Ok(mut scene) = read_scene(path) else { return Ok(()) };
    (scene.film.width, scene.film.height) = (3, 3);
    let renderer = common::scenes::renderer(scene);
    let mut counters = Counters::default();
    for pixel in 0..9 {
        // Radiance that the file itself puts out of range is counted by the film, not an error.
        let _ = renderer.sample(pixel % 3, pixel / 3, 0, &mut counters);
    }
    Ok(())
}

fn check(original: &[u8], damages: &[Damage], name: &str) -> Result<(), TestCaseError> {
    let mut bytes = original.to_vec();
    damages.iter().for_each(|damage| damage.inflict(&mut bytes));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    read_and_render(&path)
}

/// A square with every attribute, a texture as colour and as normal map, a camera and a light.
fn glb() -> Vec<u8> {
    let mut builder = Builder::with_material(json!({
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "metallicFactor": 0.5 },
        "normalTexture": { "index": 0 },
        "extensions": {
            "KHR_materials_transmission": { "transmissionFactor": 1 },
            "KHR_materials_volume": { "thicknessFactor": 1, "attenuationDistance": 0.5 },
        }
    }));
    builder.texture(2, 2, [128, 128, 255, 255]);
    let normal = builder.floats("VEC3", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    builder.primitive()["attributes"]["NORMAL"] = json!(normal);
    builder.json["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 1, "znear": 0.1 } }]);
    builder.push("nodes", json!({ "camera": 0, "translation": [0.3, 0.3, 2.0] }));
    builder.json["scenes"][0]["nodes"] = json!([0, 1]);
    // The positions go to the binary chunk, where damage makes numbers of every kind.
    builder.json["buffers"][0] = json!({ "byteLength": 36 });
    builder.glb(&bytes_of(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]))
}

const TOML: &str = r#"
title = "Slab"
[[object]]
shape = "box"
center = [0, 0, 0]
size = [1, 1, 0.2]
material = "wax"
transform = { scale = 1.5, rotate = [0, 30, 0] }
[camera]
position = [0, 1, 4]
target = [0, 0, 0]
fov = 40.0
[environment]
radiance = [1, 0.8, 0.6]
[[light]]
type = "quad"
position = [0, 4, 0]
target = [0, 0, 0]
size = [1, 1]
power = 6
[material.wax]
type = "translucent"
ior = 1.4
albedo = [0.9, 0.8, 0.6]
mean_free_path = [0.02, 0.01, 0.005]
[render]
spp = 4
"#;

fn config() -> ProptestConfig {
    ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn damaged_glb(damages in prop::collection::vec(damage(), 1..4)) {
        check(&glb(), &damages, "scene.glb")?;
    }

    #[test]
    fn damaged_toml(damages in prop::collection::vec(damage(), 1..4)) {
        check(TOML.as_bytes(), &damages, "scene.toml")?;
    }
}

#[test]
fn undamaged_files_render() {
    check(&glb(), &[], "scene.glb").unwrap();
    check(TOML.as_bytes(), &[], "scene.toml").unwrap();
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in [("scene.glb", glb()), ("scene.toml", TOML.into())] {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        read_scene(&path).unwrap();
    }
}
