//! `alabaster plan`, and what `render` makes of it.

#[path = "common/program.rs"]
#[allow(dead_code)]
mod program;

use std::fs;

use program::{Folder, SCENE};

/// A folder with the marble sphere, of 3,000 mean free paths, and `more` in the scene file.
fn folder(more: &str) -> Folder {
    let folder = Folder::new();
    fs::write(folder.path("scene.toml"), format!("{SCENE}{more}")).unwrap();
    folder
}

/// A thin one of the same material, and an open one.
const MORE: &str = r#"
[[object]]
name = "bead"
shape = "sphere"
center = [1.2, 0, 0]
radius = 0.01
material = "marble"

[[object]]
name = "leaf"
shape = "quad"
center = [0, 1.2, 0]
normal = [0, 0, 1]
size = [0.5, 0.5]
material = "marble"
"#;

#[test]
fn each_object_gets_a_method_and_a_reason() {
    let folder = folder(MORE);
    let plan = folder.run(&["plan", "scene.toml", "--accuracy", "5%", "--json"]).report();
    assert_eq!(plan["effects"][0]["on"], true);
    assert_eq!(plan["kernel"], "generic");
    assert!((plan["accuracy"].as_f64().unwrap() - 0.05).abs() < 1e-6);
    let objects = plan["objects"].as_array().unwrap();
    let of = |name: &str| objects.iter().find(|object| object["object"] == name).unwrap();
    assert_eq!(objects.len(), 3);
    let bead = of("bead");
    assert_eq!((&bead["method"], &bead["material"]), (&"walk".into(), &"marble".into()));
    assert!(bead["expected_error"]["bssrdf"].as_f64() > Some(0.05), "{bead}");
    assert_eq!(bead["expected_error"]["walk"], 0.0);
    // 4/3 of the radius, in free paths 1/(2190 + 2.1) m; the mesh is a little smaller than the sphere.
    let thickness = bead["thickness"][0].as_f64().unwrap();
    assert!((thickness / (0.01 * 4.0 / 3.0 * 2192.1) - 1.0).abs() < 0.01, "{thickness}");
    let leaf = of("leaf");
    assert_eq!(
        (&leaf["method"], &leaf["expected_error"]["walk"]),
        (&"bssrdf".into(), &serde_json::Value::Null)
    );
    assert!(leaf["reason"].as_str().unwrap().contains("it encloses no volume"), "{leaf}");
    let dropped = plan["dropped"].as_array().unwrap();
    let of_leaf = dropped.iter().find(|dropped| dropped["object"] == "leaf").unwrap();
    assert_eq!((&of_leaf["bound"], &of_leaf["reason"]), (&leaf["expected_error"]["bssrdf"], &leaf["reason"]));
    assert_eq!(of_leaf["name"], "shape of the body under the surface");
    assert!(dropped.iter().all(|dropped| dropped["object"] != "bead"), "{dropped:?}");
    let thick =
        objects.iter().find(|object| object["object"] != "bead" && object["object"] != "leaf").unwrap();
    assert_ne!(thick["method"], "walk");

    let (text, _) = folder.run(&["plan", "scene.toml", "--accuracy", "0.05"]).ends_with(0);
    for part in ["bead    walk", "leaf    bssrdf", "5.0 % is asked for", "it encloses no volume"] {
        assert!(text.contains(part), "no {part:?} in {text}");
    }
}

#[test]
fn the_scene_and_the_command_line_say_what_is_wanted() {
    let folder = folder("[subsurface]\naccuracy = 0.4\n");
    let method = |more: &[&str]| {
        let plan = folder.run(&[&["plan", "scene.toml", "--json"], more].concat()).report();
        plan["objects"][0]["method"].as_str().unwrap().to_owned()
    };
    assert_eq!(method(&[]), "diffuse");
    assert_eq!(method(&["--accuracy", "1e-5"]), "walk");
    assert_eq!(method(&["--method", "bssrdf"]), "bssrdf");
    assert_eq!(method(&["--profile", "dipole"]), "bssrdf");
    // Pixels that show less see where light leaves.
    assert_eq!(method(&["--accuracy", "0.021", "--height", "8"]), "diffuse");
    assert_ne!(method(&["--accuracy", "0.021", "--height", "65536"]), "diffuse");
}

#[test]
fn walks_are_not_sent_where_they_find_no_light() {
    let point = "[[light]]\ntype = \"point\"\nposition = [2, 2, 2]\nintensity = 1\n";
    let folder = folder(point);
    let plan = || folder.run(&["plan", "scene.toml", "--accuracy", "1e-5", "--json"]).report();
    let smooth = plan();
    assert_eq!(smooth["objects"][0]["method"], "bssrdf");
    assert!(smooth["objects"][0]["reason"].as_str().unwrap().contains("lights without size"), "{smooth}");
    let rough = SCENE.replace("ior = 1.5", "ior = 1.5\nroughness = 0.5");
    fs::write(folder.path("scene.toml"), format!("{rough}{point}")).unwrap();
    assert_eq!(plan()["objects"][0]["method"], "walk");
}

#[test]
fn a_scene_without_scattering_has_an_empty_plan() {
    let folder = Folder::new();
    let clear = SCENE.replace("sigma_s = [2190, 2620, 3000]", "sigma_s = 0");
    fs::write(folder.path("scene.toml"), clear).unwrap();
    let plan = folder.run(&["plan", "scene.toml", "--json"]).report();
    assert_eq!((&plan["objects"], &plan["effects"][0]["on"]), (&serde_json::json!([]), &false.into()));
    assert_eq!(folder.run(&["plan", "scene.toml"]).ends_with(0).0, "no object is translucent\n");
}

#[test]
fn methods_of_one_material_are_mixed_and_reported() {
    let folder = folder(MORE);
    let made = folder
        .run(&[
            "render",
            "scene.toml",
            "-o",
            "a.exr",
            "--width",
            "16",
            "--height",
            "16",
            "--spp",
            "2",
            "--accuracy",
            "5%",
            "--json",
        ])
        .report();
    let methods: Vec<&str> =
        made["methods"].as_array().unwrap().iter().map(|of| of["method"].as_str().unwrap()).collect();
    assert_eq!(methods.len(), 3);
    assert!(methods.contains(&"walk") && methods.contains(&"bssrdf"), "{methods:?}");
    assert_eq!((&made["method"], &made["nonfinite"]), (&"auto".into(), &0.into()));
    assert_eq!(made["profiles"], serde_json::json!(["tabulated"]));
    let image = exr::prelude::read_all_flat_layers_from_file(folder.path("a.exr")).unwrap();
    let mut attributes = image.layer_data[0].attributes.other.iter();
    let (_, plan) = attributes.find(|(key, _)| *key == "alabaster.plan").unwrap();
    let plan: serde_json::Value = serde_json::from_str(&plan.to_text().unwrap().to_string()).unwrap();
    assert_eq!(
        plan,
        folder.run(&["plan", "scene.toml", "--height", "16", "--accuracy", "5%", "--json"]).report()
    );
}

#[test]
fn wrong_command_lines_are_refused() {
    let folder = folder("");
    for accuracy in ["0", "-1", "NaN", "inf", "1.5", "200%", "%", "two"] {
        folder.refuses(
            &["plan", "scene.toml", "--accuracy", accuracy],
            2,
            "a share above 0, 1 at most, is wanted",
        );
    }
    folder.refuses(&["plan", "scene.toml", "--height", "0"], 2, "--height");
    folder.refuses(&["plan", "missing.toml"], 2, "missing.toml");
    folder.refuses(&["plan"], 2, "SCENE");
}
