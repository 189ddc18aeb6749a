//! Accessors and primitives.

use glam::{Vec2, Vec3, Vec4};
use serde_json::json;

use crate::builder::{Builder, assert_warns, bytes_of};

#[test]
fn a_bare_triangle() {
    let read = Builder::triangle().read_ok();
    let mesh = &read.scene.meshes[0];
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    assert!(mesh.normals.is_empty() && mesh.colors.is_empty());
    assert!(!read.has_lights && read.camera.is_none());
    assert_eq!(read.scene.warnings, [""; 0]);
}

#[test]
fn interleaved_attributes() {
    let mut builder = Builder::triangle();
    #[rustfmt::skip]
    let view = builder.view(&bytes_of(&[
        1.0, 2.0, 3.0,  0.0, 0.0, 2.0,
        4.0, 5.0, 7.0,  0.0, 3.0, 0.0,
        7.0, 8.0, 9.0,  0.0, 0.0, 0.0,
    ]));
    builder.json["bufferViews"][view]["byteStride"] = json!(24);
    let position = builder.accessor(view, 5126, "VEC3", 3);
    let normal = builder.accessor(view, 5126, "VEC3", 3);
    builder.json["accessors"][normal]["byteOffset"] = json!(12);
    builder.primitive()["attributes"] = json!({ "POSITION": position, "NORMAL": normal });
    let read = builder.read_ok();
    let mesh = &read.scene.meshes[0];
    assert_eq!(mesh.positions[1], Vec3::new(4.0, 5.0, 7.0));
    assert_eq!(mesh.normals[..2], [Vec3::Z, Vec3::Y]);
    assert!(mesh.normals[2].is_normalized());
    assert_warns(&read, "normals of length 0");
}

#[test]
fn sparse_with_and_without_a_base() {
    let mut builder = Builder::triangle();
    let indices = builder.view(&[1, 0, 2, 0]);
    let values = builder.view(&bytes_of(&[5.0, 0.0, 0.0, 0.0, 6.0, 0.0]));
    let sparse = json!({
        "count": 2,
        "indices": { "bufferView": indices, "componentType": 5123 },
        "values": { "bufferView": values },
    });
    builder.json["accessors"][0]["sparse"] = sparse;
    let expected = [Vec3::ZERO, Vec3::new(5.0, 0.0, 0.0), Vec3::new(0.0, 6.0, 0.0)];
    assert_eq!(builder.read_ok().scene.meshes[0].positions, expected);
    builder.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    assert_eq!(builder.read_ok().scene.meshes[0].positions, expected);
}

#[test]
fn normalised_colours_and_coordinates() {
    let mut builder = Builder::triangle();
    let colors = builder.view(&[255, 0, 51, 0, 255, 0, 0, 0, 0, 0, 102, 0]);
    builder.json["bufferViews"][colors]["byteStride"] = json!(4);
    let color = builder.accessor(colors, 5121, "VEC3", 3);
    builder.json["accessors"][color]["normalized"] = json!(true);
    let coordinates: Vec<u8> =
        [0u16, 65535, 13107, 0, 0, 0].iter().flat_map(|value| value.to_le_bytes()).collect();
    let view = builder.view(&coordinates);
    let coordinate = builder.accessor(view, 5123, "VEC2", 3);
    builder.json["accessors"][coordinate]["normalized"] = json!(true);
    builder.primitive()["attributes"]["COLOR_0"] = json!(color);
    builder.primitive()["attributes"]["TEXCOORD_1"] = json!(coordinate);
    let read = builder.read_ok();
    let mesh = &read.scene.meshes[0];
    assert_eq!(
        mesh.colors,
        [Vec4::new(1.0, 0.0, 0.2, 1.0), Vec4::new(1.0, 0.0, 0.0, 1.0), Vec4::new(0.0, 0.0, 0.4, 1.0)]
    );
    assert_eq!(mesh.texture_coordinates[1], [Vec2::Y, Vec2::new(0.2, 0.0), Vec2::ZERO]);
    assert!(mesh.texture_coordinates[0].is_empty());
}

#[test]
fn quantised_positions_need_their_extension() {
    let mut builder = Builder::triangle();
    let view = builder.view(&[0, 0, 0, 0, 10, 0, 0, 0, 0, 20, 0, 0]);
    builder.json["bufferViews"][view]["byteStride"] = json!(4);
    let position = builder.accessor(view, 5121, "VEC3", 3);
    builder.primitive()["attributes"]["POSITION"] = json!(position);
    assert_eq!(builder.read_error().place, format!("/accessors/{position}/componentType"));
    builder.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    assert_eq!(builder.read_ok().scene.meshes[0].positions[2], Vec3::new(0.0, 20.0, 0.0));
}

#[test]
fn index_types_strips_and_fans() {
    for (component, bytes) in [
        (5121, vec![0, 1, 2]),
        (5123, vec![0, 0, 1, 0, 2, 0]),
        (5125, vec![0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]),
    ] {
        for mode in [4, 5, 6] {
            let mut builder = Builder::triangle();
            let view = builder.view(&bytes);
            let indices = builder.accessor(view, component, "SCALAR", 3);
            builder.primitive()["indices"] = json!(indices);
            builder.primitive()["mode"] = json!(mode);
            let mut corners = builder.read_ok().scene.meshes[0].triangles[0];
            // The fan of the standard starts with its second vertex.
            corners.rotate_right(usize::from(mode == 6));
            assert_eq!(corners, [0, 1, 2], "mode {mode}");
        }
    }
}

#[test]
fn points_and_lines_are_left_out() {
    let mut builder = Builder::triangle();
    let lines = json!({ "attributes": { "POSITION": 0 }, "mode": 1 });
    builder.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(lines);
    let read = builder.read_ok();
    assert_eq!(read.scene.meshes.len(), 1);
    assert_warns(&read, "points and lines");
    builder.primitive()["mode"] = json!(0);
    assert!(builder.read_error().problem.contains("nothing to render"));
}

#[test]
fn primitives_of_one_material_become_one_mesh() {
    let mut builder = Builder::triangle();
    let other = builder.floats("VEC3", &[0.0, 0.0, 1.0, 1.0, 0.0, 1.0, 0.0, 1.0, 1.0]);
    builder.json["materials"] = json!([{}, {}]);
    builder.json["meshes"][0]["primitives"] = json!([
        { "attributes": { "POSITION": 0 }, "material": 0 },
        { "attributes": { "POSITION": 0 }, "material": 1 },
        { "attributes": { "POSITION": other }, "material": 0 },
        { "attributes": { "POSITION": 0 }, "material": 0 },
        { "attributes": { "POSITION": 0, "NORMAL": other }, "material": 0 },
    ]);
    let scene = builder.read_ok().scene;
    let counts: Vec<(usize, usize)> =
        scene.meshes.iter().map(|mesh| (mesh.positions.len(), mesh.triangles.len())).collect();
    // Shared vertices once; with normals apart.
    assert_eq!(counts, [(6, 3), (3, 1), (3, 1)]);
    assert_eq!(scene.meshes[0].triangles, [[0, 1, 2], [3, 4, 5], [0, 1, 2]]);
    let materials: Vec<usize> = scene.instances.iter().map(|instance| instance.material).collect();
    assert_eq!(materials, [0, 1, 0]);
}

#[test]
fn triangles_without_area_are_dropped_and_counted() {
    let mut builder = Builder::triangle();
    let view = builder.view(&[0, 1, 2, 0, 0, 1, 2, 2, 2]);
    let indices = builder.accessor(view, 5121, "SCALAR", 9);
    builder.primitive()["indices"] = json!(indices);
    let read = builder.read_ok();
    assert_eq!(read.scene.meshes[0].triangles, [[0, 1, 2]]);
    assert_warns(&read, "without area is left out (2 times)");
}

#[test]
fn buffers_from_glb_and_from_files() {
    let positions = bytes_of(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    let mut builder = Builder::triangle();
    builder.json["buffers"] = json!([{ "byteLength": 36 }]);
    let path = builder.file("scene.glb", &builder.glb(&positions));
    let read = alabaster::scene::read_gltf(&path).unwrap();
    assert_eq!(read.scene.meshes[0].positions[1], Vec3::X);
    assert_eq!(read.scene.title, "scene");

    builder.file("my data.bin", &positions);
    for uri in ["my data.bin", "my%20data.bin", "./my data.bin"] {
        builder.json["buffers"][0]["uri"] = json!(uri);
        assert_eq!(builder.read_ok().scene.meshes[0].positions[1], Vec3::X, "{uri}");
    }
}

#[test]
fn tangents_are_unit_with_handedness() {
    let mut builder = Builder::triangle();
    let normal = builder.floats("VEC3", &[0.0, 0.0, 1.0].repeat(3));
    let tangent = builder.floats("VEC4", &[2.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0]);
    builder.primitive()["attributes"]["TANGENT"] = json!(tangent);
    assert!(builder.read_ok().scene.meshes[0].tangents.is_empty(), "tangents without normals");
    builder.primitive()["attributes"]["NORMAL"] = json!(normal);
    let read = builder.read_ok();
    let tangents = &read.scene.meshes[0].tangents;
    assert_eq!(tangents[0], Vec4::new(1.0, 0.0, 0.0, -1.0));
    assert!(tangents[1].truncate().is_normalized() && tangents[1].z == 0.0);
    assert_warns(&read, "tangents of length 0");
}
