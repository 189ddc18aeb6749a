//! Broken and odd input files, given to the program as a person would: a picture, or exit code 2 and one
//! message, within ten seconds; never a panic, and nothing overwritten.

#[path = "gltf_reader/builder.rs"]
#[allow(dead_code)]
mod builder;
mod common;
#[path = "common/program.rs"]
#[allow(dead_code)]
mod program;

use std::fs;
use std::path::Path;

use builder::Builder;
use common::assets::{assets, files};
use program::render_tiny;
use serde_json::{Value, json};

/// Renders `scene` of `folder` over an existing picture, which must stay as it is when the scene is refused.
#[track_caller]
fn refuses(folder: &Path, scene: &str, part: &str) {
    let output = folder.join("out.png");
    fs::write(&output, "an older picture").unwrap();
    let run = render_tiny(folder, scene, "out.png");
    run.is_refused(part);
    assert!(run.stderr.contains(scene), "the message does not name the file: {run:?}");
    assert_eq!(fs::read(&output).unwrap(), b"an older picture");
}

/// Refuses the triangle of [`Builder`] after `change`.
#[track_caller]
fn refuses_changed(change: impl FnOnce(&mut Builder), part: &str) {
    let mut builder = Builder::triangle();
    change(&mut builder);
    builder.file("scene.gltf", builder.json.to_string().as_bytes());
    refuses(builder.folder.path(), "scene.gltf", part);
}

#[test]
fn broken_files_of_others_end_in_a_picture_or_one_message() {
    let Some(assets) = assets() else { return };
    let (mut rendered, mut refused) = (0, 0);
    for path in files(&assets.join("bad"), &["gltf", "glb"]) {
        let folder = tempfile::tempdir().unwrap();
        let run = render_tiny(folder.path(), path.to_str().unwrap(), "out.png");
        let picture = folder.path().join("out.png");
        match run.code {
            0 => {
                assert_eq!(run.errors(), 0, "{}: {run:?}", path.display());
                let picture = image::open(&picture).unwrap();
                assert_eq!((picture.width(), picture.height()), (16, 16));
                rendered += 1;
            }
            _ => {
                run.is_refused(path.file_name().unwrap().to_str().unwrap());
                assert!(!picture.exists());
                refused += 1;
            }
        }
        println!("{}: exit {}: {}", path.display(), run.code, run.stderr.trim_end());
    }
    assert!(rendered > 0 && refused > 0, "{rendered} rendered, {refused} refused");
}

#[test]
fn files_that_are_missing_cut_or_of_another_kind() {
    let builder = Builder::triangle();
    let folder = builder.folder.path();
    for missing in ["missing.glb", "missing.gltf"] {
        refuses(folder, missing, "cannot be read");
    }
    let whole = builder.glb(&[0; 36]);
    for length in [0, 4, 12, 20, whole.len() / 2, whole.len() - 1] {
        builder.file("cut.glb", &whole[..length]);
        refuses(folder, "cut.glb", "");
    }
    builder.file("model.obj", b"v 0 0 0");
    refuses(folder, "model.obj", "export them as glTF");
    fs::create_dir(folder.join("folder.glb")).unwrap();
    refuses(folder, "folder.glb", "not a regular file");
}

/// Names and values of a file may hold what a terminal obeys.
#[test]
fn control_characters_are_not_printed() {
    let escape = "\u{1b}[2J";
    refuses_changed(|b| b.json["asset"]["version"] = json!(escape), "\\u{1b}[2J");
    let mut builder = Builder::triangle();
    builder.json["extensionsUsed"] = json!([escape]);
    builder.file("scene.gltf", builder.json.to_string().as_bytes());
    let run = render_tiny(builder.folder.path(), "scene.gltf", "out.png");
    assert_eq!(run.code, 0, "{run:?}");
    assert!(run.stderr.contains("\\u{1b}[2J") && !run.stderr.contains(escape), "{run:?}");
}

#[test]
fn nodes_in_a_circle() {
    refuses_changed(|b| b.json["nodes"] = json!([{ "mesh": 0, "children": [0] }]), "/nodes/0/children/0");
}

#[test]
fn numbers_that_are_no_coordinates() {
    for bad in [f32::NAN, f32::INFINITY, -f32::MAX] {
        let change = |b: &mut Builder| {
            let position = b.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, bad, 0.0]);
            b.primitive()["attributes"]["POSITION"] = json!(position);
        };
        refuses_changed(change, "not finite");
    }
    refuses_changed(|b| b.json["nodes"][0]["scale"] = json!([1e38, 1e38, 1e38]), "/nodes/0");
}

/// Coordinates that are allowed, however small or large, give a picture.
#[test]
fn scenes_of_any_size_are_rendered() {
    for size in [1e-12_f32, 1e-6, 1e6, 1e12] {
        let mut builder = Builder::triangle();
        let position = builder.floats("VEC3", &[0.0, 0.0, 0.0, size, 0.0, 0.0, 0.0, size, 0.0]);
        builder.primitive()["attributes"]["POSITION"] = json!(position);
        builder.file("scene.gltf", builder.json.to_string().as_bytes());
        let run = render_tiny(builder.folder.path(), "scene.gltf", "out.png");
        assert_eq!((run.code, run.errors()), (0, 0), "{size}: {run:?}");
        let picture = image::open(builder.folder.path().join("out.png")).unwrap().into_rgb8();
        let shades: std::collections::HashSet<_> = picture.pixels().collect();
        assert!(shades.len() > 1, "{size}: nothing to be seen");
    }
}

#[test]
fn indices_out_of_range() {
    let vertex = |b: &mut Builder| {
        let view = b.view(&[0, 1, 3]);
        let indices = b.accessor(view, 5121, "SCALAR", 3);
        b.primitive()["indices"] = json!(indices);
    };
    refuses_changed(vertex, "out of range");
    refuses_changed(|b| b.json["nodes"][0]["mesh"] = json!(7), "/nodes/0");
    refuses_changed(|b| b.primitive()["material"] = json!(7), "material");
}

#[test]
fn nothing_to_see() {
    let flat = |b: &mut Builder| {
        let position = b.floats("VEC3", &[1.0; 9]);
        b.primitive()["attributes"]["POSITION"] = json!(position);
    };
    refuses_changed(flat, "without area");
    refuses_changed(|b| b.json = json!({ "asset": { "version": "2.0" } }), "nothing to render");
    refuses_changed(|b| b.json["scenes"][0]["nodes"] = json!([]), "nothing to render");
}

#[test]
fn textures_that_are_missing() {
    let textured = |image: Value| {
        let mut builder =
            Builder::with_material(json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }));
        builder.json["images"] = json!([image]);
        builder.json["textures"] = json!([{ "source": 0 }]);
        builder.file("scene.gltf", builder.json.to_string().as_bytes());
        builder
    };
    refuses(textured(json!({ "uri": "missing.png" })).folder.path(), "scene.gltf", "missing.png");
    let cut = textured(json!({ "uri": "cut.png" }));
    let whole = builder::png(8, 8, [9, 9, 9, 255]);
    cut.file("cut.png", &whole[..whole.len() / 2]);
    refuses(cut.folder.path(), "scene.gltf", "/images/0: the image cannot be decoded");
}

#[test]
fn scene_files_with_mistakes() {
    let folder = tempfile::tempdir().unwrap();
    let sphere = "[[object]]\nshape = 'sphere'\ncenter = [0, 0, 0]\nradius = 1\nmaterial = 'm'\n\
        [material.m]\ntype = 'diffuse'\n";
    let cases: [(&str, &str, &str); 6] = [
        ("[render]\nsppp = 4\n", "", "did you mean `spp`?"),
        ("[film]\nwidth = nan\n", "", "expected a whole number"),
        ("[environment]\nimage = 'missing.hdr'\n", "", "missing.hdr"),
        ("", "object", "no objects"),
        ("[[object]]\ngltf = 'missing.glb'\n", "", "missing.glb"),
        ("[material.m]\n", "", "duplicate key"),
    ];
    for (extra, drop, part) in cases {
        let scene = if drop.is_empty() { format!("{sphere}{extra}") } else { extra.to_owned() };
        fs::write(folder.path().join("scene.toml"), scene).unwrap();
        refuses(folder.path(), "scene.toml", part);
    }
}
