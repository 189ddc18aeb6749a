//! The glTF reader reads what the standard allows and refuses the rest with one clear message:
//! small files made here, and real ones where they are at hand.

#[path = "gltf_reader/assets.rs"]
mod assets;
#[path = "gltf_reader/bad_input.rs"]
mod bad_input;
#[path = "gltf_reader/builder.rs"]
mod builder;
#[path = "common/assets.rs"]
mod common_assets;
#[path = "gltf_reader/geometry.rs"]
mod geometry;
#[path = "gltf_reader/materials.rs"]
mod materials;
#[path = "gltf_reader/nodes.rs"]
mod nodes;
#[path = "gltf_reader/odd_values.rs"]
mod odd_values;
