//! What mutations begin with: small files of every format.

use std::fs;
use std::path::{Path, PathBuf};

use exr::prelude::{Compression, Encoding, Image, Layer, LayerAttributes, SpecificChannels, WritableImage};
use serde_json::json;

use super::assets::{assets, files};
use super::builder::{Builder, bytes_of};

/// A larger one is slow to read, and mutations seldom meet what matters.
const LARGEST: usize = 32 << 10;

/// A file.
pub struct Seed {
    pub name: String,
    pub bytes: Vec<u8>,
}

impl Seed {
    fn read(path: &Path) -> Self {
        Self { name: path.to_string_lossy().into_owned(), bytes: fs::read(path).unwrap() }
    }

    /// True if it is one of our own that is not damaged.
    pub fn is_whole(&self) -> bool {
        !self.name.contains("regressions") && !self.name.contains("/bad/")
    }

    /// The ending of its name: the format.
    pub fn ending(&self) -> &str {
        self.name.rsplit('.').next().unwrap_or_default()
    }
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/fuzz")
}

/// All files with one of these endings, those that once broke the law first.
pub fn seeds(endings: &[&str]) -> Vec<Seed> {
    let mut seeds: Vec<Seed> = files(&folder(), endings).iter().map(|path| Seed::read(path)).collect();
    seeds.sort_by_key(|seed| !seed.name.contains("regressions"));
    seeds.extend(made());
    if endings.contains(&"glb")
        && let Some(assets) = assets()
    {
        seeds.extend(files(&assets.join("bad"), endings).iter().map(|path| Seed::read(path)));
    }
    seeds.retain(|seed| endings.contains(&seed.ending()) && seed.bytes.len() <= LARGEST);
    seeds
}

/// Puts into `target` what the seeds name.
pub fn put_beside(target: &Path) {
    for name in ["sky.hdr", "tissue.csv"] {
        fs::copy(folder().join(name), target.join(name)).unwrap();
    }
    for seed in made() {
        fs::write(target.join(&seed.name), &seed.bytes).unwrap();
    }
    if let Some(assets) = assets() {
        for path in files(&assets.join("bad"), &["bin", "png"]) {
            fs::copy(&path, target.join(path.file_name().unwrap())).unwrap();
        }
    }
}

/// Binary files, as libraries write them.
fn made() -> Vec<Seed> {
    let mut seeds = vec![Seed { name: "box.glb".into(), bytes: glb() }];
    let compressions = [
        ("sky.exr", Compression::Uncompressed),
        ("rle.exr", Compression::RLE),
        ("zip.exr", Compression::ZIP16),
        ("piz.exr", Compression::PIZ),
        ("pxr24.exr", Compression::PXR24),
        ("b44.exr", Compression::B44),
        ("dwaa.exr", Compression::DWAA(None)),
    ];
    seeds.extend(compressions.map(|(name, compression)| Seed { name: name.into(), bytes: exr(compression) }));
    seeds
}

fn exr(compression: Compression) -> Vec<u8> {
    let pixel = |at: exr::math::Vec2<usize>| (at.x() as f32 / 8.0, at.y() as f32 / 4.0, 0.5_f32);
    let encoding = Encoding { compression, ..Encoding::FAST_LOSSLESS };
    let layer = Layer::new((8, 4), LayerAttributes::default(), encoding, SpecificChannels::rgb(pixel));
    let mut bytes = std::io::Cursor::new(Vec::new());
    Image::from_layer(layer).write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

/// A triangle with every attribute, a texture as colour and as normal map, a camera, and what extensions know of bodies.
fn glb() -> Vec<u8> {
    let mut builder = Builder::with_material(json!({
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0, "extensions": { "KHR_texture_transform": { "scale": [2, 3], "rotation": 0.5 } } } },
        "normalTexture": { "index": 0, "scale": 0.5 },
        "alphaMode": "MASK",
        "extensions": {
            "KHR_materials_ior": { "ior": 1.4 },
            "KHR_materials_transmission": { "transmissionFactor": 1 },
            "KHR_materials_volume": { "thicknessFactor": 1, "attenuationDistance": 0.5, "attenuationColor": [0.9, 0.8, 0.5] },
            "KHR_materials_diffuse_transmission": { "diffuseTransmissionFactor": 1 },
            "KHR_materials_volume_scatter": { "multiscatterColor": [0.7, 0.5, 0.3], "scatterAnisotropy": 0.2 },
        }
    }));
    builder.texture(2, 2, [128, 128, 255, 255]);
    let view = builder.view(&[0, 1, 2, 0]);
    let indices = builder.accessor(view, 5121, "SCALAR", 3);
    builder.primitive()["indices"] = json!(indices);
    let normal = builder.floats("VEC3", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    builder.primitive()["attributes"]["NORMAL"] = json!(normal);
    let color = builder.floats("VEC4", &[1.0; 12]);
    builder.primitive()["attributes"]["COLOR_0"] = json!(color);
    builder.json["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 1, "znear": 0.1 } }]);
    builder.push("nodes", json!({ "camera": 0, "translation": [0.3, 0.3, 2.0], "rotation": [0, 0, 0, 1] }));
    builder.json["scenes"][0]["nodes"] = json!([0, 1]);
    // The positions go to the binary chunk, where damage makes numbers of every kind.
    builder.json["buffers"][0] = json!({ "byteLength": 36 });
    builder.glb(&bytes_of(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]))
}
