//! Everything that can be wrong ends in an error with the file, the place and a remedy.

use alabaster::scene::read_gltf;
use serde_json::{Value, json};

use crate::builder::{Builder, bytes_of};

/// Asserts that the file with `value` at `pointer` is refused at `place` with a problem that holds `part`.
#[track_caller]
fn refuses(mut builder: Builder, pointer: &str, value: Value, place: &str, part: &str) {
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    let target = builder.json.pointer_mut(parent).unwrap();
    match target {
        Value::Array(array) => array[key.parse::<usize>().unwrap()] = value,
        other => other[key] = value,
    }
    let error = builder.read_error();
    assert_eq!(error.place, place, "{error}");
    assert!(error.problem.contains(part), "{error}");
    assert!(error.file.ends_with("scene.gltf"), "{error}");
}

#[test]
fn files_that_are_no_gltf() {
    let builder = Builder::empty();
    let refused = |bytes: &[u8]| {
        let error = read_gltf(&builder.file("scene.glb", bytes)).expect_err("no glTF");
        assert!(error.file.ends_with("scene.glb"), "{error}");
        error.problem
    };
    for bytes in [&b""[..], b"{", b"[]", b"null", b"\xff\xfe", b"hello", b"{\"asset\": 3}", b"\xef\xbb\xbf{"]
    {
        refused(bytes);
    }
    // A nesting that would overflow the stack of a recursive parser.
    refused("[".repeat(1_000_000).as_bytes());
    let missing = read_gltf(&builder.folder.path().join("none.glb")).expect_err("no file");
    assert!(missing.problem.contains("cannot be read"), "{missing}");
    let folder = read_gltf(builder.folder.path()).expect_err("a folder");
    assert!(folder.problem.contains("not a regular file"), "{folder}");
}

#[test]
fn glb_cut_anywhere() {
    let mut builder = Builder::triangle();
    builder.json["buffers"] = json!([{ "byteLength": 36 }]);
    let whole = builder.glb(&bytes_of(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]));
    read_gltf(&builder.file("scene.glb", &whole)).unwrap();
    for length in 0..whole.len() {
        let error = read_gltf(&builder.file("scene.glb", &whole[..length])).expect_err("cut");
        assert!(!error.problem.is_empty());
    }
    // Damaged lengths, version, kinds of chunk.
    for position in (4..20).chain([whole.len() - 44, whole.len() - 40]) {
        for value in [0, 1, 0x7f, 0xff] {
            let mut damaged = whole.clone();
            if damaged[position] != value {
                damaged[position] = value;
                // Must only come back; a longer declared JSON may still be refused or read.
                let _ = read_gltf(&builder.file("scene.glb", &damaged));
            }
        }
    }
    for length in [0u32, 3, 11, 12, 19] {
        let mut damaged = whole.clone();
        damaged[8..12].copy_from_slice(&length.to_le_bytes());
        read_gltf(&builder.file("scene.glb", &damaged)).expect_err("header length");
    }
}

#[test]
fn versions() {
    let at = "/asset/version";
    refuses(Builder::triangle(), at, json!("1.0"), at, "1.0");
    refuses(Builder::triangle(), at, json!("3.0"), at, "3.0");
    refuses(Builder::triangle(), at, json!(""), at, "");
    refuses(Builder::triangle(), at, json!(2.0), at, "missing");
    refuses(Builder::triangle(), "/asset/minVersion", json!("2.1"), "/asset/minVersion", "2.1");
}

#[test]
fn required_extensions_are_named() {
    let at = "/extensionsRequired";
    let draco = "KHR_draco_mesh_compression";
    refuses(Builder::triangle(), at, json!([draco]), at, "without Draco");
    refuses(Builder::triangle(), at, json!(["KHR_materials_volume", "VENDOR_x"]), at, "requires VENDOR_x,");
    refuses(Builder::triangle(), at, json!(["KHR_texture_basisu"]), at, "PNG, JPEG or WebP");
    refuses(Builder::triangle(), at, json!("KHR_materials_volume"), at, "");
    let mut builder = Builder::triangle();
    builder.json[&at[1..]] = json!(["KHR_materials_volume", "KHR_materials_ior", "KHR_lights_punctual"]);
    builder.read_ok();
}

#[test]
fn indices_that_point_nowhere() {
    let with = |key: &str, value: Value| {
        let mut builder = Builder::triangle();
        builder.primitive()[key] = value;
        builder
    };
    let primitive = "/meshes/0/primitives/0";
    refuses(Builder::triangle(), "/scene", json!(1), "/scene", "scene 1 does not exist");
    refuses(Builder::triangle(), "/scenes/0/nodes/0", json!(9), "/scenes/0/nodes/0", "node 9");
    refuses(Builder::triangle(), "/nodes/0/mesh", json!(3), "/nodes/0/mesh", "mesh 3");
    refuses(Builder::triangle(), "/nodes/0/children", json!([0, 7]), "/nodes/0/children/0", "reached twice");
    refuses(Builder::triangle(), "/nodes/0/children", json!([7]), "/nodes/0/children/0", "node 7");
    refuses(Builder::triangle(), "/nodes/0/camera", json!(0), "/nodes/0/camera", "camera 0");
    refuses(with("material", json!(4)), "/scene", json!(0), "/meshes/0", "material 4");
    refuses(with("indices", json!(5)), "/scene", json!(0), &format!("{primitive}/indices"), "accessor 5");
    refuses(
        Builder::triangle(),
        "/meshes/0/primitives/0/attributes/POSITION",
        json!(8),
        &format!("{primitive}/attributes/POSITION"),
        "accessor 8",
    );
    refuses(Builder::triangle(), "/accessors/0/bufferView", json!(2), "/accessors/0", "bufferView 2");
    refuses(Builder::triangle(), "/bufferViews/0/buffer", json!(2), "/bufferViews/0", "buffer 2");
    let light = json!({ "KHR_lights_punctual": { "light": 0 } });
    refuses(
        Builder::triangle(),
        "/nodes/0/extensions",
        light,
        "/nodes/0/extensions/KHR_lights_punctual/light",
        "light 0",
    );
    let textured = || Builder::with_material(json!({ "normalTexture": { "index": 0 } }));
    refuses(textured(), "/scene", json!(0), "/materials/0/normalTexture/index", "texture 0");
    let mut builder = textured();
    builder.texture(1, 1, [0; 4]);
    refuses(builder, "/textures/0", json!({ "source": 0, "sampler": 1 }), "/textures/0", "sampler 1");
    let mut builder = textured();
    builder.texture(1, 1, [0; 4]);
    refuses(builder, "/textures/0", json!({ "source": 1 }), "/textures/0/source", "image 1");
}

#[test]
fn vertex_indices_out_of_range() {
    for (component, bytes) in [
        (5121, vec![0, 1, 3]),
        (5123, vec![0, 0, 1, 0, 255, 255]),
        (5125, [[255; 4], [0; 4], [0; 4]].concat()),
    ] {
        let mut builder = Builder::triangle();
        let view = builder.view(&bytes);
        let indices = builder.accessor(view, component, "SCALAR", 3);
        builder.primitive()["indices"] = json!(indices);
        let error = builder.read_error();
        assert_eq!(error.place, "/meshes/0/primitives/0/indices");
        assert!(error.problem.contains("out of range"), "{error}");
    }
}

#[test]
fn cycles_and_shared_children() {
    let with = |nodes: Value| {
        let mut builder = Builder::triangle();
        builder.json["nodes"] = nodes;
        builder.read_error()
    };
    let error = with(json!([{ "mesh": 0, "children": [1] }, { "children": [2] }, { "children": [0] }]));
    assert_eq!(error.place, "/nodes/2/children/0");
    let error = with(json!([{ "children": [0] }]));
    assert_eq!(error.place, "/nodes/0/children/0");
    let error =
        with(json!([{ "children": [1, 2] }, { "children": [3] }, { "children": [3] }, { "mesh": 0 }]));
    assert!(error.problem.contains("two parents"), "{error}");
}

#[test]
fn numbers_that_are_not_finite_or_huge() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 2e30, -f32::MAX] {
        let mut builder = Builder::triangle();
        let position = builder.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, bad, 0.0]);
        builder.primitive()["attributes"]["POSITION"] = json!(position);
        let error = builder.read_error();
        assert_eq!(error.place, format!("/accessors/{position}"));
        assert!(error.problem.contains("element 2"), "{error}");
    }
    let node = "/nodes/0";
    refuses(Builder::triangle(), "/nodes/0/translation", json!([1e39, 0, 0]), node, "finite");
    refuses(Builder::triangle(), "/nodes/0/translation", json!([2e30, 0, 0]), node, "farther");
    refuses(Builder::triangle(), "/nodes/0/rotation", json!([0, 0, 0, 0]), node, "quaternion");
    refuses(Builder::triangle(), "/nodes/0/scale", json!([1, 1]), node, "length");
    let projective = json!([1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
    refuses(Builder::triangle(), "/nodes/0/matrix", projective, "/nodes/0/matrix", "0, 0, 0, 1");
    let mut chain = Builder::triangle();
    chain.json["nodes"] = json!([
        { "scale": [1e30, 1e30, 1e30], "children": [1] },
        { "scale": [1e30, 1e30, 1e30], "children": [2] },
        { "mesh": 0 },
    ]);
    assert_eq!(chain.read_error().place, "/nodes/2");
}

#[test]
fn accessors_that_lie() {
    let component = "/accessors/0/componentType";
    let kind = "/accessors/0/type";
    let count = "/accessors/0/count";
    refuses(Builder::triangle(), component, json!(5123), component, "Position");
    refuses(Builder::triangle(), component, json!(1), component, "unknown");
    refuses(Builder::triangle(), kind, json!("VEC2"), kind, "3 components");
    refuses(Builder::triangle(), kind, json!("VEC5"), kind, "unknown");
    refuses(Builder::triangle(), count, json!(4), "/accessors/0", "do not fit");
    refuses(Builder::triangle(), count, json!(0), count, "at least 1");
    refuses(Builder::triangle(), count, json!(u64::MAX), count, "far more");
    refuses(Builder::triangle(), count, json!(-1), "/accessors/0", "");
    refuses(Builder::triangle(), count, json!(1.5), "/accessors/0", "");
    refuses(Builder::triangle(), "/accessors/0/byteOffset", json!(1), "/accessors/0", "do not fit");
    refuses(Builder::triangle(), "/accessors/0/byteOffset", json!(u64::MAX), "/accessors/0", "do not fit");
    let view = "/bufferViews/0";
    refuses(
        Builder::triangle(),
        "/bufferViews/0/byteStride",
        json!(8),
        "/bufferViews/0/byteStride",
        "less than",
    );
    refuses(Builder::triangle(), "/bufferViews/0/byteStride", json!(u64::MAX), "/accessors/0", "do not fit");
    refuses(Builder::triangle(), "/bufferViews/0/byteLength", json!(37), view, "outside");
    refuses(Builder::triangle(), "/bufferViews/0/byteLength", json!(u64::MAX), view, "outside");
    refuses(Builder::triangle(), "/bufferViews/0/byteOffset", json!(u64::MAX), view, "outside");
    refuses(Builder::triangle(), "/bufferViews/0/byteLength", json!(1e300), view, "");
    refuses(Builder::triangle(), "/buffers/0/byteLength", json!(37), "/buffers/0", "truncated");
    refuses(Builder::triangle(), "/accessors/0", json!({ "count": 3 }), "/accessors/0", "missing field");
    refuses(Builder::triangle(), "/accessors", json!({}), "/accessors", "array");
}

#[test]
fn zero_filled_accessors_are_bounded() {
    let mut builder = Builder::triangle();
    builder.json["accessors"][0] = json!({ "count": 1u64 << 40, "componentType": 5126, "type": "VEC3" });
    assert_eq!(builder.read_error().place, "/accessors/0/count");
    // Many small lies together.
    builder.json["accessors"][0]["count"] = json!(1 << 20);
    builder.json["meshes"][0]["primitives"] =
        Value::Array((0..200).map(|i| json!({ "attributes": { "POSITION": 0 }, "material": i })).collect());
    builder.json["materials"] = json!(vec![json!({}); 200]);
    assert!(builder.read_error().problem.contains("far more"));
}

#[test]
fn sparse_accessors_that_lie() {
    let sparse = |count: u64, indices: &[u8], values: usize| {
        let mut builder = Builder::triangle();
        let index_view = builder.view(indices);
        let value_view = builder.view(&vec![0; values]);
        builder.json["accessors"][0]["sparse"] = json!({
            "count": count,
            "indices": { "bufferView": index_view, "componentType": 5121 },
            "values": { "bufferView": value_view },
        });
        builder.read_error()
    };
    assert_eq!(sparse(1, &[3], 12).place, "/accessors/0/sparse/indices");
    assert_eq!(sparse(4, &[0, 1, 2, 2], 48).place, "/accessors/0/sparse/count");
    assert_eq!(sparse(u64::MAX, &[0], 12).place, "/accessors/0/sparse/count");
    assert_eq!(sparse(2, &[0], 24).place, "/accessors/0/sparse/indices");
    assert_eq!(sparse(2, &[0, 1], 12).place, "/accessors/0/sparse/values");
}

#[test]
fn attributes_of_different_lengths() {
    let mut builder = Builder::triangle();
    let normal = builder.floats("VEC3", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    builder.primitive()["attributes"]["NORMAL"] = json!(normal);
    let error = builder.read_error();
    assert_eq!(error.place, "/meshes/0/primitives/0/attributes/NORMAL");
}

#[test]
fn uris_that_leave_the_folder_or_lead_nowhere() {
    for uri in [
        "../scene.bin",
        "/etc/passwd",
        "file:///etc/passwd",
        "http://example.com/x.bin",
        "a/../../b",
        "%2e%2e%2fb",
    ] {
        refuses(Builder::triangle(), "/buffers/0/uri", json!(uri), "/buffers/0/uri", "scene's own folder");
    }
    for (uri, part) in [
        ("none.bin", "does not exist"),
        ("%ff.bin", "UTF-8"),
        (".", "not a regular file"),
        ("data:;base64,@@@@", "base64"),
        ("data:", "comma"),
        ("", "empty"),
    ] {
        refuses(Builder::triangle(), "/buffers/0/uri", json!(uri), "/buffers/0/uri", part);
    }
    refuses(Builder::triangle(), "/buffers/0", json!({ "byteLength": 36 }), "/buffers/0", "neither");
}

#[test]
fn images_that_cannot_be_had() {
    let with = |image: Value| {
        let mut builder =
            Builder::with_material(json!({ "emissiveFactor": [1, 1, 1], "emissiveTexture": { "index": 0 } }));
        builder.json["textures"] = json!([{ "source": 0 }]);
        builder.json["images"] = json!([image]);
        builder
    };
    let refused = |image: Value, place: &str, part: &str| {
        let error = with(image).read_error();
        assert_eq!(error.place, place, "{error}");
        assert!(error.problem.contains(part), "{error}");
    };
    refused(json!({ "uri": "none.png" }), "/images/0/uri", "does not exist");
    refused(json!({ "uri": "../none.png" }), "/images/0/uri", "leaves the folder");
    refused(json!({ "uri": "data:image/png;base64,AAAA" }), "/images/0", "not PNG");
    refused(json!({}), "/images/0", "neither");
    refused(json!({ "bufferView": 9 }), "/images/0", "bufferView 9");
    refused(json!({ "bufferView": 0 }), "/images/0", "not PNG");
    let builder = with(json!({ "uri": "cut.png" }));
    let whole = crate::builder::png(16, 16, [1, 2, 3, 4]);
    for length in [8, 20, 33, whole.len() / 2] {
        builder.file("cut.png", &whole[..length]);
        assert!(builder.read_error().problem.contains("cannot be decoded"), "{length}");
    }
    // A header that asks for 2³¹ pixels squared.
    let mut huge = whole;
    huge[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
    builder.file("cut.png", &huge);
    assert_eq!(builder.read_error().place, "/images/0");
    let mut builder = with(json!({}));
    builder.json["textures"] = json!([{}]);
    assert!(builder.read_error().problem.contains("no PNG, JPEG or WebP"));
}

#[test]
fn materials_lights_and_cameras_out_of_bounds() {
    let material = |material: Value| Builder::with_material(material).read_error();
    let volume = "KHR_materials_volume";
    for distance in [0.0, -1.0] {
        let error = material(json!({ "extensions": { volume: { "attenuationDistance": distance } } }));
        assert_eq!(error.place, "/materials/0/extensions/KHR_materials_volume/attenuationDistance");
    }
    let error = material(json!({ "extensions": { volume: { "attenuationColor": [1, 1] } } }));
    assert_eq!(error.place, "/materials/0/extensions/KHR_materials_volume");
    assert_eq!(material(json!({ "alphaMode": "ADD" })).place, "/materials/0/alphaMode");
    assert_eq!(material(json!({ "emissiveFactor": [-1, 0, 0] })).place, "/materials/0/emissiveFactor");
    assert_eq!(material(json!({ "pbrMetallicRoughness": { "metallicFactor": "a" } })).place, "/materials/0");

    let light = |light: Value| {
        let mut builder = Builder::triangle();
        builder.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [light] } });
        builder.json["nodes"][0]["extensions"] = json!({ "KHR_lights_punctual": { "light": 0 } });
        builder.read_error().place
    };
    let place = "/extensions/KHR_lights_punctual/lights/0";
    assert_eq!(light(json!({ "type": "area" })), format!("{place}/type"));
    assert_eq!(light(json!({ "type": "point", "intensity": -1 })), place);
    assert_eq!(light(json!({ "type": "spot", "spot": { "outerConeAngle": 2 } })), format!("{place}/spot"));
    assert_eq!(
        light(json!({ "type": "spot", "spot": { "innerConeAngle": 0.5, "outerConeAngle": 0.4 } })),
        format!("{place}/spot")
    );

    let camera = |camera: Value| {
        let mut builder = Builder::triangle();
        builder.json["cameras"] = json!([camera]);
        builder.json["nodes"][0]["camera"] = json!(0);
        builder.read_error().place
    };
    for yfov in [0.0, -1.0, 3.2, 1e39] {
        let perspective = json!({ "type": "perspective", "perspective": { "yfov": yfov, "znear": 1 } });
        assert_eq!(camera(perspective), "/cameras/0/perspective/yfov");
    }
    assert_eq!(camera(json!({ "type": "perspective" })), "/cameras/0");
}

#[test]
fn nothing_to_render() {
    let error = Builder::empty().read_error();
    assert!(error.problem.contains("nothing to render"), "{error}");
    let mut builder = Builder::triangle();
    let flat = builder.floats("VEC3", &[1.0; 9]);
    builder.primitive()["attributes"]["POSITION"] = json!(flat);
    let error = builder.read_error();
    assert!(error.problem.contains("without area"), "{error}");
}
