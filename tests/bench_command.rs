//! `alabaster bench`: the ray casters of this build on the rays of a scene.

#[path = "common/program.rs"]
#[allow(dead_code)]
mod program;

use std::fs;

use program::{Folder, SCENE};

/// So that there are shadow rays.
const LAMP: &str = "\n[[light]]\ntype = \"sphere\"\ncenter = [2, 3, 3]\nradius = 0.3\nradiance = 5\n";

fn bench(more: &[&str]) -> serde_json::Value {
    let folder = Folder::new();
    // Thin, so that walks are short.
    let scene = SCENE.replace("2190, 2620, 3000", "3, 4, 5");
    fs::write(folder.path("scene.toml"), format!("{scene}{LAMP}")).unwrap();
    let start = ["bench", "scene.toml", "--rays", "2000", "--rounds", "3", "--json", "--quiet"];
    folder.run(&[&start, more].concat()).report()
}

#[test]
fn json_has_the_keys_of_the_contract() {
    let found = bench(&["--method", "bssrdf"]);
    let names = if cfg!(feature = "embree") { vec!["embree", "bvh", "obvhs"] } else { vec!["bvh", "obvhs"] };
    assert_eq!(found["backends"].as_object().unwrap().len(), names.len());
    for name in names {
        let backend = &found["backends"][name];
        assert!(
            backend["build_seconds"].as_f64() >= Some(0.0) && backend["bytes"].as_u64() > Some(0),
            "{backend}"
        );
        for kind in ["camera", "bounce", "shadow", "probe"] {
            assert!(backend["mrays_per_second"][kind].as_f64() > Some(0.0), "{name} {kind}");
        }
    }
    for kind in ["camera", "bounce", "shadow", "probe", "render"] {
        assert!(found["ratio"][kind].as_f64() > Some(0.0), "{kind}");
    }
    // As many as asked for of each kind, but for probes, for which few of the paths have a use.
    let rays = found["rays"].as_u64().unwrap();
    assert!((6_000..=8_000).contains(&rays) && found["agreement"]["rays"] == rays, "{rays}");
    assert!(found["triangles"].as_u64() > Some(0) && found["threads"].as_u64() > Some(0));
}

/// With a walk there are no probes, and the casters agree about all other rays.
#[test]
fn casters_agree_on_the_rays_of_a_walk() {
    let found = bench(&["--method", "walk"]);
    assert!(found["ratio"].get("probe").is_none());
    let agreement = &found["agreement"];
    assert_eq!(agreement["rays"], found["rays"]);
    assert_eq!((&agreement["missing"], &agreement["extra"]), (&0.into(), &0.into()), "{agreement}");
    let same = agreement["identical"].as_u64().unwrap() + agreement["within_ulp"].as_u64().unwrap();
    assert_eq!(Some(same), found["rays"].as_u64());
}

#[test]
fn a_scene_of_two_triangles_is_raced_on() {
    let folder = Folder::new();
    let quad = "[[object]]\nshape = \"quad\"\ncenter = [0, 0, 0]\nnormal = [0, 0, 1]\nsize = [1, 1]\nmaterial = \"grey\"\n[environment]\nradiance = 1\n[material.grey]\ntype = \"diffuse\"\n";
    fs::write(folder.path("quad.toml"), quad).unwrap();
    let arguments = ["bench", "quad.toml", "--rays", "100", "--rounds", "1", "--json", "--quiet"];
    let found = folder.run(&arguments).report();
    assert_eq!(found["triangles"], 2);
    assert_eq!(found["agreement"]["missing"], 0);
}

#[test]
fn what_cannot_be_raced_on_is_refused() {
    let folder = Folder::new();
    folder.run(&["bench", "missing.toml"]).is_refused("missing.toml");
    folder.run(&["bench", "--rays", "0"]).is_refused("--rays");
}
