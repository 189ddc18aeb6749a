//! What no effect of a scene needs is neither decoded nor made ready.

#[path = "common/scenes.rs"]
#[allow(dead_code)]
mod scenes;

use std::fs;
use std::io::Cursor;
use std::path::Path;

use alabaster::plan::{EffectKind, Forces};
use alabaster::radiometry::Rgb;
use alabaster::scene::texture::Pixels;
use alabaster::scene::{Method, Scene, SceneError, read_scene, read_scene_with, shape};
use alabaster::transport::{Inventory, RenderOptions, Renderer};
use base64::Engine;
use glam::Vec3;
use image::{ImageFormat, RgbaImage};
use scenes::{body, caster, furnace, options};
use serde_json::json;

/// A triangle with texture coordinates and tangents, whose material shows `picture`, also as its normal map, and is as `material` says beside.
fn write_textured(folder: &Path, picture: &[u8], material: &serde_json::Value) {
    let numbers: [f32; 33] = [
        [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].as_slice(),
        &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0],
        &[1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0],
        &[1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0],
    ]
    .concat()
    .try_into()
    .unwrap();
    let (bytes, encode) = (numbers.map(f32::to_le_bytes).concat(), |bytes: &[u8]| {
        base64::engine::general_purpose::STANDARD.encode(bytes)
    });
    let accessor = |offset: usize, kind: &str| {
        json!({ "bufferView": 0, "byteOffset": 4 * offset, "componentType": 5126, "count": 3, "type": kind,
            "min": [0, 0, 0], "max": [1, 1, 1] })
    };
    let gltf = json!({
        "asset": { "version": "2.0" },
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{
            "attributes": { "POSITION": 0, "NORMAL": 1, "TANGENT": 2, "TEXCOORD_0": 3 }, "material": 0,
        }] }],
        "materials": [material],
        "textures": [{ "source": 0 }],
        "images": [{ "uri": format!("data:image/png;base64,{}", encode(picture)) }],
        "accessors": [accessor(0, "VEC3"), accessor(9, "VEC3"), accessor(18, "VEC4"), accessor(24, "VEC2")],
        "bufferViews": [{ "buffer": 0, "byteLength": bytes.len() }],
        "buffers": [{
            "byteLength": bytes.len(),
            "uri": format!("data:application/octet-stream;base64,{}", encode(&bytes)),
        }],
    });
    fs::write(folder.join("model.gltf"), gltf.to_string()).unwrap();
    let scene = "[[object]]\ngltf = \"model.gltf\"\nmaterial = \"plain\"\n[material.plain]\ntype = \"diffuse\"\n\
                 [environment]\nradiance = 1\n";
    fs::write(folder.join("scene.toml"), scene).unwrap();
}

/// With a factor for each of its textures.
fn material(factor: f32, scale: f32) -> serde_json::Value {
    json!({
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "baseColorFactor": [factor, factor, factor, 1] },
        "normalTexture": { "index": 0, "scale": scale },
    })
}

/// A picture of 4 × 4 pixels that differ.
fn picture() -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let pixel = |x: u32, y: u32| image::Rgba([60 * x as u8, 60 * y as u8, 200, 255]);
    RgbaImage::from_fn(4, 4, pixel).write_to(&mut bytes, ImageFormat::Png).unwrap();
    bytes.into_inner()
}

fn inventory(scene: Scene, options: RenderOptions) -> Inventory {
    Renderer::new(scene, options, caster).unwrap().inventory()
}

#[test]
fn a_material_that_is_replaced_costs_no_picture() {
    let folder = tempfile::tempdir().unwrap();
    write_textured(folder.path(), b"not a picture", &material(1.0, 1.0));
    // Alone the file shows the picture, which is none.
    let error = read_scene(&folder.path().join("model.gltf")).unwrap_err();
    assert!(error.place == "/images/0" && error.problem.contains("not PNG"), "{error}");
    read_scene(&folder.path().join("scene.toml")).unwrap();

    write_textured(folder.path(), &picture(), &material(1.0, 1.0));
    let of = |file: &str| inventory(read_scene(&folder.path().join(file)).unwrap(), options());
    let textured = of("model.gltf");
    assert_eq!((textured.pixels, textured.tangents, textured.texture_coordinates), (16, 3, 3));
    let plain = of("scene.toml");
    assert_eq!((plain.pixels, plain.tangents, plain.texture_coordinates), (0, 0, 0));
}

#[test]
fn textures_that_change_nothing_are_dropped() {
    let folder = tempfile::tempdir().unwrap();
    let of = |factor, scale| {
        write_textured(folder.path(), &picture(), &material(factor, scale));
        inventory(read_scene(&folder.path().join("model.gltf")).unwrap(), options())
    };
    // Colours without a normal map need no tangents; black needs no texture.
    assert_eq!((of(1.0, 0.0).pixels, of(1.0, 0.0).tangents), (16, 0));
    assert_eq!((of(0.0, 1.0).pixels, of(0.0, 1.0).tangents), (16, 3));
    assert_eq!((of(0.0, 0.0).pixels, of(0.0, 0.0).texture_coordinates), (0, 0));
}

#[test]
fn pictures_of_effects_that_are_switched_off_are_not_decoded() {
    let folder = tempfile::tempdir().unwrap();
    write_textured(folder.path(), b"not a picture", &material(1.0, 1.0));
    let forces = Forces::new([(EffectKind::Textures, false)]).unwrap();
    let scene = read_scene_with(&folder.path().join("model.gltf"), |scene| {
        forces.apply(scene).map_err(|error| SceneError::file("", error.to_string()))
    })
    .unwrap();
    assert!(matches!(scene.images[0].pixels, Pixels::Encoded(_)));
    assert_eq!(inventory(scene, RenderOptions { forces, ..options() }).pixels, 0);
}

/// A ball of two hundred free paths, which absorbs, so that walks are guided in it and cross it on spheres.
fn ball() -> Scene {
    let mut material = body(1.4, 0.3, 0.01);
    if let alabaster::scene::Surface::Translucent {
        medium: alabaster::scene::ScatteringInput::Coefficients { sigma_a, .. },
        ..
    } = &mut material.surface
    {
        *sigma_a = Rgb::splat(10.0);
    }
    furnace(shape::sphere(Vec3::ZERO, 1.0, 3), material)
}

#[test]
fn each_method_has_its_own_and_no_more() {
    let of = |method| inventory(ball(), RenderOptions { method, ..options() });
    let nothing = Inventory { scatterers: 1, ..Inventory::default() };
    assert_eq!(of(Method::Diffuse), nothing);
    assert_eq!(of(Method::Bssrdf), Inventory { profile_tables: 1, ..nothing });
    let walk = of(Method::Walk);
    assert_eq!((walk.profile_tables, walk.interfaces, walk.guides, walk.sphere_steps), (0, 2, 2, 2));
    assert_eq!((walk.clearances, walk.emitters), (1, 0));
}

#[test]
fn what_nothing_is_made_of_is_not_made_ready() {
    let mut scene = ball();
    scene.materials.extend([body(1.5, 0.2, 0.3), body(1.7, 0.1, 0.2)]);
    let with = inventory(scene, options());
    assert_eq!(with, inventory(ball(), options()));
}
