//! `alabaster check`.

#[path = "common/program.rs"]
#[allow(dead_code)]
mod program;

use std::fs;
use std::time::Duration;

use program::{Folder, Run, SCENE, run_within};
use serde_json::Value;

/// The marble sphere, and what else is to be checked.
const MORE: &str = r#"
[[object]]
shape = "box"
center = [1.5, 0, 0]
size = [0.3, 0.3, 0.3]
material = "glass"

[[object]]
shape = "quad"
center = [0, -1.2, 0]
normal = [0, 1, 0]
size = [4, 4]
material = "floor"

[material.glass]
type = "dielectric"
ior = 1.5
roughness = 0.3

[material.floor]
type = "diffuse"
reflectance = [0.5, 0.6, 0.7]

[[light]]
type = "sphere"
center = [2, 3, 2]
radius = 0.5
power = [10, 20, 30]

[[light]]
type = "directional"
direction = [0, -1, 0]
irradiance = [1, 1, 1]
"#;

fn check(scene: &str, more: &[&str]) -> Run {
    let folder = Folder::new();
    fs::write(folder.path("scene.toml"), scene).unwrap();
    let arguments =
        [&["check", "scene.toml", "--method", "bssrdf", "--width", "12", "--height", "12"], more].concat();
    // Tables of every profile are made.
    run_within(Duration::from_secs(120), &folder.path(""), &arguments)
}

fn named<'a>(list: &'a Value, key: &str, name: &str) -> &'a Value {
    list.as_array().unwrap().iter().find(|entry| entry[key] == name).unwrap()
}

#[test]
fn every_material_is_checked_and_light_taken_apart() {
    let report = check(&format!("{SCENE}{MORE}"), &["--spp", "8", "--orders", "4", "--json"]).report();
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);

    let floor = named(&report["materials"], "name", "floor");
    assert_eq!((&floor["kind"], &floor["surface"]["negative"]), (&"diffuse".into(), &0.into()));
    assert!((number(&floor["surface"]["largest_albedo"]) - 0.7).abs() < 1e-6, "{floor}");
    assert!(number(&floor["surface"]["reciprocity_break"]) < 1e-6, "{floor}");
    let glass = &named(&report["materials"], "name", "glass")["surface"];
    assert_eq!(glass["conserves_energy"], true);
    assert!(number(&glass["reciprocity_break"]) < 1e-3, "{glass}");

    // Profiles that know nothing of directions are reciprocal on a plane, to rounding; the directional dipole is not.
    let marble = &named(&report["materials"], "name", "marble")["bssrdf"];
    assert_eq!(marble.as_array().unwrap().len(), 6, "{marble}");
    for profile in marble.as_array().unwrap() {
        assert_eq!((&profile["negative"], &profile["conserves_energy"]), (&0.into(), &true.into()));
        let broken = number(&profile["reciprocity_break"]);
        assert_eq!(broken > 1e-2, profile["profile"] == "directional-dipole", "{profile}");
        assert!(broken < 1e-5 || profile["profile"] == "directional-dipole", "{profile}");
    }
    let used: Vec<_> =
        marble.as_array().unwrap().iter().filter(|profile| profile["in_use"] == true).collect();
    assert_eq!(used.len(), 1, "{marble}");

    // What is left out by cutting after an order is what those after it add.
    let terms = report["orders"]["orders"].as_array().unwrap();
    assert_eq!(terms.len(), 5, "{terms:?}");
    let shares: f64 = terms.iter().map(|term| number(&term["share"])).sum();
    let lost = number(&terms[4]["lost_if_cut"]);
    assert!((shares + lost - 1.0).abs() < 1e-12, "{shares} {lost}");
    let whole = number(&report["orders"]["whole"]["value"]);
    assert!(whole > 0.0 && number(&report["orders"]["whole"]["stderr"]) < whole);
}

#[test]
fn what_lights_emit_is_told_in_watts() {
    let more = MORE.replace("irradiance = [1, 1, 1]", "irradiance = 1\nilluminant = \"A\"");
    let report = check(&format!("{SCENE}{more}"), &["--spp", "2", "--orders", "0", "--json"]).report();
    let sphere = named(&report["lights"], "type", "sphere");
    assert_eq!((&sphere["quantity"], &sphere["unit"]), (&"radiance".into(), &"W/(m² sr)".into()));
    for (c, watts) in [10.0, 20.0, 30.0].into_iter().enumerate() {
        let power = sphere["power"][c].as_f64().unwrap();
        // Radiance is kept in single precision.
        assert!((power / watts - 1.0).abs() < 4.0 * f64::from(f32::EPSILON), "{sphere}");
    }
    let sun = named(&report["lights"], "type", "directional");
    assert_eq!((&sun["unit"], &sun["power"]), (&"W/m²".into(), &Value::Null));
    assert_eq!((&sun["lamp"], sphere.get("lamp")), (&"illuminant A".into(), None));
}

#[test]
fn a_limit_on_reciprocity_is_kept() {
    let limit = ["--spp", "2", "--orders", "0", "--max-reciprocity-break", "0.001"];
    let profile = |name| check(SCENE, &[&limit[..], &["--profile", name]].concat());
    let (table, said) = profile("directional-dipole").ends_with(1);
    assert!(said.contains("failed: \"marble\" breaks reciprocity by"), "{said}");
    assert!(table.contains("marble (bssrdf, directional-dipole, in use)"), "{table}");
    let (table, _) = profile("normalized-diffusion").ends_with(0);
    assert!(table.contains("marble (bssrdf, normalized-diffusion, in use)"), "{table}");
}

#[test]
fn what_cannot_be_checked_is_refused() {
    let folder = Folder::new();
    folder.refuses(&["check", "missing.toml"], 2, "missing.toml");
    fs::write(folder.path("scene.toml"), SCENE).unwrap();
    folder.refuses(&["check", "scene.toml", "--spp", "1"], 2, "--spp");
}
