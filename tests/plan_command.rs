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
    // A walk is among the methods.
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
    assert_eq!(plan["kernel"], "glass");
    let text = folder.run(&["plan", "scene.toml"]).ends_with(0).0;
    assert!(text.starts_with("no object is translucent\n") && text.ends_with("kernel: glass\n"), "{text}");
}

/// The plan with effects forced.
fn forced(folder: &Folder, forces: &[&str]) -> serde_json::Value {
    let forces = forces.iter().flat_map(|force| ["--force", force]);
    folder.run(&["plan", "scene.toml", "--json"].into_iter().chain(forces).collect::<Vec<_>>()).report()
}

fn effect<'a>(plan: &'a serde_json::Value, name: &str) -> &'a serde_json::Value {
    plan["effects"].as_array().unwrap().iter().find(|effect| effect["name"] == name).unwrap()
}

#[test]
fn effects_are_switched() {
    let folder = folder("");
    let plan = forced(&folder, &["subsurface-scattering=off", "refraction=off"]);
    assert_eq!(plan["objects"][0]["method"], "diffuse");
    for name in ["subsurface scattering", "refraction"] {
        assert_eq!(
            (&effect(&plan, name)["on"], &effect(&plan, name)["reason"]),
            (&false.into(), &"switched off".into())
        );
    }
    let plan = forced(&folder, &["random walk=on", "lens=off"]);
    assert_eq!(plan["objects"][0]["method"], "walk");
    assert_eq!(effect(&plan, "random walk")["on"], true);
    // The method asked for gives way.
    let plan = forced(&folder, &["random_walk=off", "Area-Integral=on"]);
    assert_eq!((&plan["objects"][0]["method"], &plan["kernel"]), (&"bssrdf".into(), &"subsurface".into()));
    let plan = forced(&folder, &["area-integral=on", "normal-maps=on"]);
    assert_eq!(plan["kernel"], "textured subsurface");
    assert_eq!(effect(&plan, "normal maps")["reason"], "switched on; no material has a normal map");
    let plan = forced(&folder, &["environment=off", "rough-surfaces=off", "colours-of-mean-free-paths=off"]);
    for name in ["environment", "rough surfaces", "colours of mean free paths"] {
        assert_eq!(effect(&plan, name)["on"], false, "{name}");
    }
    assert_eq!(plan["objects"][0]["thickness"][0], plan["objects"][0]["thickness"][2]);
}

#[test]
fn what_is_forced_is_rendered_and_kept_in_the_picture() {
    let folder = folder("");
    let render = |name: &str, forces: &[&str]| {
        let forces = forces.iter().flat_map(|force| ["--force", force]);
        let size = ["--width", "8", "--height", "8", "--spp", "1", "--method", "bssrdf", "--json"];
        let arguments = ["render", "scene.toml", "-o", name].into_iter().chain(size).chain(forces);
        let made = folder.run(&arguments.collect::<Vec<_>>()).report();
        let image = exr::prelude::read_all_flat_layers_from_file(folder.path(name)).unwrap();
        let layer = &image.layer_data[0];
        let values: Vec<Vec<f32>> = layer
            .channel_data
            .list
            .iter()
            .map(|channel| channel.sample_data.values_as_f32().collect())
            .collect();
        let (_, plan) = layer.attributes.other.iter().find(|(key, _)| *key == "alabaster.plan").unwrap();
        let plan: serde_json::Value = serde_json::from_str(&plan.to_text().unwrap().to_string()).unwrap();
        assert_eq!(plan["kernel"], made["kernel"]);
        (values, plan)
    };
    let (plain, plan) = render("plain.exr", &[]);
    assert_eq!(plan["kernel"], "subsurface");
    let (kept, plan) = render("kept.exr", &["nested-media=on"]);
    assert_eq!(plan["kernel"], "generic");
    assert_eq!(plain, kept, "the same bits");
    let (dark, plan) = render("dark.exr", &["environment=off"]);
    assert_eq!(effect(&plan, "environment")["on"], false);
    assert!(dark.iter().flatten().all(|&value| value == 0.0));
    let (diffuse, plan) = render("diffuse.exr", &["subsurface-scattering=off"]);
    assert_eq!(plan["objects"][0]["method"], "diffuse");
    assert_ne!(plain, diffuse);
}

/// The plan of the scene with a sphere of glass, in a mode, with what is forced.
fn spectral_plan(glass: &str, mode: &str, forces: &[&str]) -> serde_json::Value {
    let ball = "[[object]]\nname = \"ball\"\nshape = \"sphere\"\ncenter = [3, 0, 0]\nradius = 1\nmaterial = \"glass\"\n";
    let more =
        format!("{ball}[material.glass]\ntype = \"dielectric\"\n{glass}\n[render]\nmode = \"{mode}\"\n");
    forced(&folder(&more), forces)
}

#[test]
fn light_goes_by_wavelength_where_something_calls_for_it() {
    const ABBE: &str = "material `glass` of object `ball` has Abbe number 30";
    let none = "no clear body has a dispersion";
    for (glass, mode, forces, spectral, dispersion) in [
        ("", "auto", &[][..], (false, "nothing depends on the wavelength"), (false, none)),
        ("", "spectral", &[], (true, "`mode = \"spectral\"`"), (false, none)),
        ("", "auto", &["spectral=on"], (true, "switched on; nothing depends"), (false, none)),
        ("abbe = 30", "auto", &[], (true, ABBE), (true, ABBE)),
        ("abbe = 30", "spectral", &[], (true, "`mode = \"spectral\"`"), (true, ABBE)),
        (
            "abbe = 30",
            "rgb",
            &[],
            (false, "`mode = \"rgb\"` excludes it"),
            (false, "red, green and blue refract alike"),
        ),
        ("abbe = 30", "rgb", &["dispersion=on"], (true, "switched on"), (true, ABBE)),
        ("abbe = 30", "rgb", &["spectral=on"], (true, "switched on"), (true, ABBE)),
        ("abbe = 30", "spectral", &["spectral=off"], (false, "switched off"), (false, "refract alike")),
        ("abbe = 30", "auto", &["dispersion=off"], (false, "nothing depends"), (false, "switched off")),
        ("abbe = 30", "auto", &["refraction=off"], (false, "nothing depends"), (false, none)),
        ("abbe = 30\nior = 1", "auto", &[], (false, "nothing depends"), (false, none)),
    ] {
        let plan = spectral_plan(glass, mode, forces);
        for (name, (on, reason)) in [("spectral", spectral), ("dispersion", dispersion)] {
            let effect = effect(&plan, name);
            assert_eq!(effect["on"], on, "{glass} {mode} {forces:?}: {effect}");
            assert!(
                effect["reason"].as_str().unwrap().contains(reason),
                "{glass} {mode} {forces:?}: {effect}"
            );
        }
        assert_eq!(plan["kernel"] == "spectral", spectral.0, "{glass} {mode} {forces:?}");
    }
}

#[test]
fn media_by_wavelength_call_for_it() {
    let folder = folder("");
    fs::write(folder.path("skin.csv"), "wavelength,mu_a,mu_s\n400,9,900\n700,2,500\n").unwrap();
    let scene =
        SCENE.replace("sigma_a = [2.1, 4.1, 7.1]\nsigma_s = [2190, 2620, 3000]", "spectrum = \"skin.csv\"");
    fs::write(folder.path("scene.toml"), scene).unwrap();
    for (forces, reason) in [
        (&[][..], "material `marble` of object `sphere` is given by wavelength"),
        // What is left of it then is what the channels see.
        (&["colours-of-mean-free-paths=off"], "nothing depends on the wavelength"),
    ] {
        let plan = forced(&folder, forces);
        let spectral = effect(&plan, "spectral");
        assert_eq!(spectral["on"], reason.starts_with("material"), "{spectral}");
        assert!(spectral["reason"].as_str().unwrap().contains(reason), "{spectral}");
        assert_eq!(effect(&plan, "subsurface scattering")["on"], true);
    }
}

#[test]
fn coloured_lamps_call_for_wavelengths_and_white_ones_do_not() {
    let lamp = |law: &str, strength: &str| {
        format!("[[light]]\ntype = \"point\"\nposition = [0, 4, 0]\nintensity = {strength}\n{law}\n")
    };
    for (law, strength, reason) in [
        ("temperature = 2856", "1", "a light is a blackbody of 2856 K"),
        ("illuminant = \"A\"", "1", "a light is illuminant A"),
        ("illuminant = \"D65\"", "1", "nothing depends on the wavelength"),
        ("", "[1, 0.5, 0.2]", "nothing depends on the wavelength"),
        ("temperature = 2856", "0", "nothing depends on the wavelength"),
    ] {
        let plan = forced(&folder(&lamp(law, strength)), &[]);
        let spectral = effect(&plan, "spectral");
        assert_eq!(spectral["on"], reason.starts_with("a light"), "{law}: {spectral}");
        assert!(spectral["reason"].as_str().unwrap().contains(reason), "{law}: {spectral}");
    }
}

#[test]
fn wishes_that_cannot_be_met_are_refused() {
    let folder = folder("");
    for (forces, part) in [
        (vec!["lens=on"], "give the camera an `aperture`"),
        (vec!["lights-without-size=on"], "add a light of type \"point\""),
        (vec!["dispersion=on"], "give a clear material an `abbe` number"),
        (vec!["glow=on"], "there is no effect \"glow\"; the effects are subsurface-scattering,"),
        (vec!["lens"], "lens=off"),
        (vec!["lens=maybe"], "not \"maybe\""),
        (
            vec!["refraction=on", "refraction=off"],
            "`refraction=on` and `refraction=off` contradict each other",
        ),
        (vec!["random-walk=on", "area-integral=on"], "contradict each other"),
        (vec!["random-walk=on", "subsurface-scattering=off"], "contradict each other"),
        (vec!["dispersion=on", "spectral=off"], "contradict each other"),
        (vec!["dispersion=on", "refraction=off"], "contradict each other"),
    ] {
        let forces: Vec<&str> = forces.into_iter().flat_map(|force| ["--force", force]).collect();
        folder.refuses(&[&["plan", "scene.toml"], forces.as_slice()].concat(), 2, part);
        folder.refuses(&[&["render", "scene.toml", "-o", "a.exr"], forces.as_slice()].concat(), 2, part);
    }
    let clear = SCENE.replace("sigma_s = [2190, 2620, 3000]", "sigma_s = 0");
    fs::write(folder.path("scene.toml"), clear).unwrap();
    for effect in ["random-walk=on", "area-integral=on", "subsurface-scattering=on"] {
        folder.refuses(&["plan", "scene.toml", "--force", effect], 2, "give an object a material of type");
    }
    fs::write(folder.path("scene.toml"), format!("{SCENE}{NESTED}")).unwrap();
    folder.refuses(&["plan", "scene.toml", "--force", "nested-media=off"], 2, "move the bodies apart");
}

const NESTED: &str = r#"
[[object]]
name = "shell"
shape = "sphere"
center = [0.5, 0, 0]
radius = 1
material = "marble"
"#;

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
