//! The files of `scenes/` that are made, each under its name.

use glam::{DVec2, DVec3};
use image::ImageError;
use serde_json::{Value, json};

use super::glb::Model;
use super::remesh::Shaded;
use super::revolve::{square, torus_knot};
use super::{candle, soap, swan, turned, wood};

/// A file name and how its bytes are made.
pub type Recipe = (&'static str, fn() -> Result<Vec<u8>, ImageError>);

/// Every file that is made.
pub const RECIPES: [Recipe; 11] = [
    ("swan.glb", || plain("swan", swan::swan())),
    ("pedestal.glb", || plain("pedestal", turned::pedestal())),
    ("candle.glb", || plain("candle", candle::wax())),
    ("wick.glb", || plain("wick", candle::wick())),
    ("flame.glb", flame),
    ("dish.glb", || plain("dish", turned::dish())),
    ("soap.glb", || plain("soap", soap::soap())),
    ("table.glb", table),
    ("glass.glb", || plain("glass", turned::glass())),
    ("milk.glb", || plain("milk", turned::milk())),
    ("knot.glb", || plain("knot", torus_knot(3.4, 1.3, 0.78, 300, 32))),
];

/// A mesh in centimetres whose material the scene file gives.
fn plain(name: &str, shape: Shaded) -> Result<Vec<u8>, ImageError> {
    Ok(model(name, shape, json!({ "name": name })).to_glb())
}

fn model(name: &str, shape: Shaded, material: Value) -> Model<'_> {
    Model { name, shape, scale: 0.01, coordinates: Vec::new(), material, jpeg: None }
}

/// The flame over the wick. It only shines.
fn flame() -> Result<Vec<u8>, ImageError> {
    let mut shape = turned::flame();
    let foot = DVec3::new(0.08, candle::POOL + 0.75, 0.0);
    shape.surface.positions.iter_mut().for_each(|p| *p += foot);
    let material = json!({
        "name": "flame",
        "pbrMetallicRoughness": { "baseColorFactor": [0.0, 0.0, 0.0, 1.0], "metallicFactor": 0.0 },
        "emissiveFactor": [1.0, 0.55, 0.2],
        "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 130.0 } },
    });
    Ok(model("flame", shape, material).to_glb())
}

/// A square of table, 240 cm wide; the picture of its wood is 60 cm wide and repeats.
fn table() -> Result<Vec<u8>, ImageError> {
    let material = json!({
        "name": "oak",
        "pbrMetallicRoughness": {
            "baseColorTexture": { "index": 0 },
            "metallicFactor": 0.0,
            "roughnessFactor": 0.45,
        },
    });
    let mut table = model("table", square(240.0), material);
    table.coordinates = [[0.0, 4.0], [4.0, 4.0], [4.0, 0.0], [0.0, 0.0]].map(DVec2::from_array).to_vec();
    table.jpeg = Some(wood::wood(768)?);
    Ok(table.to_glb())
}
