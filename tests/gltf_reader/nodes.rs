//! The hierarchy, instancing, cameras and lights.

use alabaster::radiometry::{LUMENS_PER_WATT, Rgb};
use alabaster::scene::Light;
use glam::Vec3;
use serde_json::json;

use crate::builder::{Builder, assert_warns};

/// Where the instance puts the triangle's vertices.
fn corners(builder: &Builder) -> Vec<[Vec3; 3]> {
    let scene = builder.read_ok().scene;
    let place = |instance: &alabaster::scene::Instance| {
        [Vec3::ZERO, Vec3::X, Vec3::Y].map(|v| instance.transform.transform_point3(v))
    };
    scene.instances.iter().map(place).collect()
}

#[test]
fn transforms_compose_scale_rotate_translate() {
    let mut builder = Builder::triangle();
    let half = std::f32::consts::FRAC_1_SQRT_2;
    builder.json["nodes"] = json!([
        { "mesh": 0, "scale": [2, 3, 4] },
        { "children": [0], "rotation": [0, 0, half, half], "translation": [10, 0, 0] },
        { "children": [1], "matrix": [1,0,0,0, 0,0,-1,0, 0,1,0,0, 0,0,5,1] },
    ]);
    builder.json["scenes"] = json!([{ "nodes": [2] }]);
    // Scaled: x = (2,0,0), y = (0,3,0); turned by 90° about z: (0,2,0), (−3,0,0); moved by 10 x;
    // then (x, y, z) → (x, z, −y), moved by 5 z.
    let expected = [Vec3::new(10.0, 0.0, 5.0), Vec3::new(10.0, 0.0, 3.0), Vec3::new(7.0, 0.0, 5.0)];
    for (found, expected) in corners(&builder)[0].into_iter().zip(expected) {
        // 1/√2 in single precision: a relative error of 2⁻²⁴ on lengths up to 3, twice.
        assert!(found.abs_diff_eq(expected, 1e-6), "{found} {expected}");
    }
}

#[test]
fn mirrored_instances_keep_their_sign() {
    let mut builder = Builder::triangle();
    builder.json["nodes"][0]["scale"] = json!([-1, 1, 1]);
    let scene = builder.read_ok().scene;
    assert!(scene.instances[0].transform.matrix3.determinant() < 0.0);
    assert_eq!(corners(&builder)[0][1], Vec3::NEG_X);
}

#[test]
fn instancing_places_every_copy() {
    let mut builder = Builder::triangle();
    let translation = builder.floats("VEC3", &[1.0, 0.0, 0.0, 0.0, 2.0, 0.0]);
    let view = builder.view(&[0, 0, 0, 127, 0, 0, 127, 0]);
    let rotation = builder.accessor(view, 5120, "VEC4", 2);
    builder.json["accessors"][rotation]["normalized"] = json!(true);
    let attributes = json!({ "TRANSLATION": translation, "ROTATION": rotation, "_ID": 99 });
    builder.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    builder.json["nodes"][0]["extensions"] =
        json!({ "EXT_mesh_gpu_instancing": { "attributes": attributes } });
    assert_eq!(
        corners(&builder),
        [[Vec3::X, Vec3::X * 2.0, Vec3::X + Vec3::Y], [Vec3::Y * 2.0, Vec3::new(-1.0, 2.0, 0.0), Vec3::Y]]
    );
    assert_eq!(builder.read_ok().scene.meshes.len(), 1);
    let scale = builder.floats("VEC3", &[1.0; 9]);
    builder.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] = json!(scale);
    assert!(builder.read_error().problem.contains("different counts"));
}

#[test]
fn default_scene_else_first_else_all_roots() {
    let mut builder = Builder::triangle();
    builder.json["nodes"] = json!([{ "mesh": 0 }, { "mesh": 0, "translation": [1, 0, 0] }, { "mesh": 0, "translation": [2, 0, 0] }]);
    builder.json["scenes"] = json!([{ "nodes": [1] }, { "nodes": [2] }]);
    assert_eq!(corners(&builder)[0][0], Vec3::X);
    builder.json["scene"] = json!(1);
    assert_eq!(corners(&builder)[0][0], Vec3::X * 2.0);
    assert_warns(&builder.read_ok(), "of 2 scenes, scene 1 is shown");
    let object = builder.json.as_object_mut().unwrap();
    object.remove("scene");
    object.remove("scenes");
    builder.json["nodes"][0]["children"] = json!([2]);
    assert_eq!(corners(&builder).len(), 3);
    assert_warns(&builder.read_ok(), "has no scene");
}

#[test]
fn a_chain_of_two_hundred_thousand_nodes() {
    const LENGTH: usize = 200_000;
    let mut builder = Builder::triangle();
    let mut nodes: Vec<_> =
        (1..LENGTH).map(|child| json!({ "children": [child], "translation": [1, 0, 0] })).collect();
    nodes.push(json!({ "mesh": 0 }));
    builder.json["nodes"] = json!(nodes);
    assert_eq!(corners(&builder)[0][0], Vec3::X * (LENGTH - 1) as f32);
}

#[test]
fn instances_scaled_to_nothing_are_dropped() {
    let mut builder = Builder::triangle();
    builder.json["nodes"] = json!([{ "mesh": 0 }, { "mesh": 0, "scale": [1, 0, 1] }, { "mesh": 0, "scale": [1e-25, 1e-25, 1e-25] }]);
    builder.json["scenes"] = json!([{ "nodes": [0, 1, 2] }]);
    let read = builder.read_ok();
    assert_eq!(read.scene.instances.len(), 1);
    assert_warns(&read, "scaled to nothing is left out (2 times)");
}

#[test]
fn the_first_perspective_camera_is_taken() {
    let mut builder = Builder::triangle();
    builder.json["cameras"] = json!([
        { "type": "orthographic", "orthographic": { "xmag": 1, "ymag": 1, "znear": 0, "zfar": 1 } },
        { "type": "perspective", "perspective": { "yfov": 0.7, "znear": 0.1 } },
        { "type": "perspective", "perspective": { "yfov": 0.9, "znear": 0.1 } },
    ]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    builder.json["nodes"] = json!([
        { "mesh": 0 },
        { "camera": 0 },
        { "camera": 1, "translation": [1, 2, 3], "rotation": [0, half, 0, half], "scale": [2, 2, 2] },
        { "camera": 2 },
    ]);
    builder.json["scenes"] = json!([{ "nodes": [0, 1, 2, 3] }]);
    let read = builder.read_ok();
    let camera = read.camera.unwrap();
    assert_eq!(camera.vertical_fov, 0.7);
    assert_eq!(camera.position, Vec3::new(1.0, 2.0, 3.0));
    // A quarter turn about y: −z becomes −x.
    assert!((camera.target - camera.position).abs_diff_eq(Vec3::NEG_X, 1e-6));
    assert!(camera.up.abs_diff_eq(Vec3::Y, 1e-6));
    assert_warns(&read, "orthographic");
    assert_warns(&read, "further cameras");
}

#[test]
fn lights_become_radiometric() {
    let mut builder = Builder::triangle();
    builder.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "point", "color": [1, 0.5, 0], "intensity": 683 },
        { "type": "directional" },
        { "type": "spot", "intensity": 6830, "spot": { "innerConeAngle": 0.1 } },
    ] } });
    let on_node = |light: usize| json!({ "KHR_lights_punctual": { "light": light } });
    builder.json["nodes"] = json!([
        { "mesh": 0 },
        { "extensions": on_node(0), "translation": [0, 7, 0] },
        { "extensions": on_node(1), "scale": [3, 3, 3] },
        { "extensions": on_node(2), "rotation": [1, 0, 0, 0] },
    ]);
    builder.json["scenes"] = json!([{ "nodes": [0, 1, 2, 3] }]);
    let read = builder.read_ok();
    assert!(read.has_lights);
    assert_warns(&read, "683 lm/W");
    assert_eq!(
        read.scene.lights,
        [
            Light::Point { position: Vec3::new(0.0, 7.0, 0.0), intensity: Rgb::new(1.0, 0.5, 0.0).into() },
            Light::Directional { direction: Vec3::NEG_Z, irradiance: (Rgb::ONE / LUMENS_PER_WATT).into() },
            Light::Spot {
                position: Vec3::ZERO,
                direction: Vec3::Z,
                intensity: Rgb::splat(10.0).into(),
                inner_angle: 0.1,
                outer_angle: std::f32::consts::FRAC_PI_4,
            },
        ]
    );
}
