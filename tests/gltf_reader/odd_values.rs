//! Every single value of a file in turn made odd.

use serde_json::{Value, json};

use crate::builder::Builder;

/// Every single value of a rich file replaced by an odd one: an error or a scene, never a panic.
#[test]
fn every_value_replaced_by_an_odd_one() {
    let mut builder = Builder::with_material(json!({
        "pbrMetallicRoughness": { "metallicFactor": 0, "baseColorTexture": { "index": 0, "texCoord": 0 } },
        "normalTexture": { "index": 0, "extensions": { "KHR_texture_transform": { "offset": [0, 0], "rotation": 1 } } },
        "extensions": {
            "KHR_materials_ior": { "ior": 1.4 },
            "KHR_materials_transmission": { "transmissionFactor": 1 },
            "KHR_materials_volume": { "thicknessFactor": 1, "attenuationDistance": 0.01, "attenuationColor": [0.1, 0.5, 1.0] },
            "KHR_materials_volume_scatter": { "multiscatterColor": [0.5, 0.5, 0.5], "scatterAnisotropy": 0.5 },
        }
    }));
    builder.texture(2, 2, [1, 2, 3, 4]);
    builder.json["samplers"] = json!([{ "magFilter": 9728, "wrapS": 33071 }]);
    builder.json["textures"][0]["sampler"] = json!(0);
    let view = builder.view(&[0, 1, 2]);
    let indices = builder.accessor(view, 5121, "SCALAR", 3);
    builder.primitive()["indices"] = json!(indices);
    builder.json["bufferViews"][0]["byteStride"] = json!(12);
    builder.json["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 1, "znear": 1 } }]);
    builder.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "spot", "intensity": 1, "spot": { "outerConeAngle": 1 } }] } });
    let instancing = json!({ "attributes": { "TRANSLATION": 0 } });
    builder.json["nodes"] = json!([{
        "mesh": 0, "camera": 0, "translation": [0, 0, 0], "rotation": [0, 0, 0, 1], "scale": [1, 1, 1],
        "extensions": { "KHR_lights_punctual": { "light": 0 }, "EXT_mesh_gpu_instancing": instancing },
    }]);
    builder.json["scene"] = json!(0);
    builder.read_ok();

    let mut pointers = Vec::new();
    collect_pointers(&builder.json, String::new(), &mut pointers);
    assert!(pointers.len() > 100);
    let odd: [Value; 12] = [
        json!(null),
        json!(-1),
        json!(0),
        json!(1e300),
        json!(1e39),
        json!(u64::MAX),
        json!(4294967295u32),
        json!(0.5),
        json!(""),
        json!("%ff../"),
        json!([]),
        json!({}),
    ];
    for pointer in pointers {
        for value in &odd {
            let original = std::mem::replace(builder.json.pointer_mut(&pointer).unwrap(), value.clone());
            if let Ok(read) = builder.read() {
                let scene = read.scene;
                assert!(
                    scene.instances.iter().all(|i| i.transform.inverse().is_finite()),
                    "{pointer} {value}"
                );
                for mesh in &scene.meshes {
                    assert!(mesh.positions.iter().all(|p| p.is_finite()), "{pointer} {value}");
                    assert!(mesh.tangents.iter().all(|t| t.is_finite()), "{pointer} {value}");
                    let count = mesh.positions.len() as u32;
                    assert!(mesh.triangles.iter().flatten().all(|&i| i < count), "{pointer} {value}");
                }
            }
            *builder.json.pointer_mut(&pointer).unwrap() = original;
        }
    }
}

fn collect_pointers(value: &Value, pointer: String, pointers: &mut Vec<String>) {
    match value {
        Value::Array(items) => {
            for (index, item) in items.iter().enumerate() {
                collect_pointers(item, format!("{pointer}/{index}"), pointers);
            }
        }
        Value::Object(map) => {
            for (key, item) in map {
                collect_pointers(item, format!("{pointer}/{key}"), pointers);
            }
        }
        _ => {}
    }
    if !pointer.is_empty() {
        pointers.push(pointer);
    }
}
