//! What a script relies on: exit codes, one message, JSON, files.

#[path = "common/program.rs"]
#[allow(dead_code)]
mod program;

use std::fs;
use std::path::Path;

use alabaster::film::exr::read_picture;
use alabaster::raycast::Backend;
use program::{Folder, SCENE};

/// A directory with a scene in it.
fn folder() -> Folder {
    let folder = Folder::new();
    fs::write(folder.path("scene.toml"), SCENE).unwrap();
    folder
}

/// `render scene.toml --width 16 --height 12` with more arguments.
fn render<'a>(arguments: &[&'a str]) -> Vec<&'a str> {
    [&["render", "scene.toml", "--width", "16", "--height", "12"], arguments].concat()
}

fn png_size(path: &Path) -> (u32, u32) {
    let picture = image::open(path).unwrap();
    (picture.width(), picture.height())
}

#[test]
fn render_writes_every_output_and_reports_what_it_did() {
    let folder = folder();
    let report = folder
        .run(&render(&["-o", "a.exr", "-o", "a.png", "--spp", "3", "--threads", "1", "--json"]))
        .report();
    for key in [
        "seconds",
        "samples_per_second",
        "nonfinite",
        "rejected",
        "capped_walks",
        "firefly_index",
        "brightest_over_mean",
    ] {
        assert!(report[key].is_number(), "{key}");
    }
    for key in ["cast", "missed", "hits", "overflowed"] {
        assert!(report["probes"][key].is_u64(), "{key}");
    }
    assert_eq!(report["spp"], 3);
    assert_eq!(report["samples"], 3 * 16 * 12);
    assert_eq!(report["threads"], 1);
    assert_eq!(report["backend"], Backend::default().name());
    assert_eq!(report["method"], "auto");
    let of_sphere = &report["methods"][0];
    assert_eq!(report["methods"].as_array().map(Vec::len), Some(1));
    assert_eq!(of_sphere["object"], "sphere");
    assert!(of_sphere["expected_error"].as_f64() <= Some(0.02), "{of_sphere}");
    assert_eq!(report["outputs"], serde_json::json!(["a.exr", "a.png"]));
    let picture = read_picture(&folder.path("a.exr")).unwrap();
    assert_eq!((picture.width, picture.height), (16, 12));
    assert!(picture.pixels.iter().all(|pixel| pixel.is_finite()));
    assert!(picture.pixels.iter().any(|pixel| !pixel.is_black()));
    assert_eq!(png_size(&folder.path("a.png")), (16, 12));
    assert_eq!(folder.names(), ["a.exr", "a.png", "scene.toml"]);
}

#[test]
fn the_same_seed_gives_the_same_bits_on_any_number_of_threads() {
    let folder = folder();
    for (name, seed, threads) in [("a.exr", "1", "1"), ("b.exr", "1", "3"), ("c.exr", "2", "1")] {
        folder.run(&render(&["-o", name, "--spp", "5", "--seed", seed, "--threads", threads])).ends_with(0);
    }
    let [a, b, c] = ["a.exr", "b.exr", "c.exr"].map(|name| read_picture(&folder.path(name)).unwrap());
    assert!(a == b);
    assert!(a != c);
}

/// Both backends trace the same paths; a ray that passes within rounding of an edge may go another way.
/// So the pictures' means differ by far less than their own noise.
#[test]
fn every_backend_of_this_build_renders() {
    let folder = folder();
    let means = Backend::available().iter().map(|backend| {
        let file = format!("{}.exr", backend.name());
        let arguments = ["-o", &file, "--spp", "16", "--backend", backend.name(), "--json"];
        let report = folder.run(&render(&arguments)).report();
        assert_eq!(report["backend"], backend.name());
        let pixels = read_picture(&folder.path(&file)).unwrap().pixels;
        let mean = pixels.iter().map(|pixel| f64::from(pixel.0[1])).sum::<f64>() / pixels.len() as f64;
        // σ of the mean over all pixels: each has the noise that the report states for their mean.
        (mean, mean * report["relative_error"].as_f64().unwrap() / (pixels.len() as f64).sqrt())
    });
    let means: Vec<(f64, f64)> = means.collect();
    for &(mean, sigma) in &means {
        assert!(mean > 0.1 && (mean - means[0].0).abs() <= 3.0 * sigma, "{means:?}");
    }
}

#[cfg(not(feature = "embree"))]
#[test]
fn embree_is_refused_where_it_is_not_built_in() {
    let folder = folder();
    folder.refuses(&render(&["-o", "a.exr", "--backend", "embree"]), 2, "use --backend bvh");
}

#[test]
fn the_kernel_is_that_of_the_mode() {
    let folder = folder();
    for (mode, kernel) in [("spectral", "spectral"), ("rgb", "subsurface"), ("auto", "subsurface")] {
        let scene = format!("{SCENE}[render]\nmode = \"{mode}\"\n");
        fs::write(folder.path("mode.toml"), scene).unwrap();
        let arguments = ["render", "mode.toml", "-o", "a.exr", "--spp", "1", "--method", "bssrdf", "--json"];
        assert_eq!(folder.run(&arguments).report()["kernel"], kernel, "{mode}");
    }
}

#[test]
fn every_profile_renders_and_is_reported() {
    let folder = folder();
    let names =
        ["dipole", "better-dipole", "directional-dipole", "normalized-diffusion", "photon-beam", "tabulated"];
    for name in names {
        let made = folder.run(&render(&["-o", "a.exr", "--spp", "1", "--profile", name, "--json"])).report();
        assert_eq!(made["profiles"], serde_json::json!([name]));
        assert_eq!(made["nonfinite"], 0);
    }
    let made = folder.run(&render(&["-o", "a.exr", "--spp", "1", "--method", "diffuse", "--json"])).report();
    assert_eq!(made["profiles"], serde_json::json!([]));
}

#[test]
fn walks_are_reported_and_what_is_odd_is_told() {
    let folder = folder();
    let made = folder.run(&render(&["-o", "a.exr", "--spp", "1", "--method", "walk", "--json"])).report();
    assert_eq!((&made["method"], &made["profiles"]), (&serde_json::json!("walk"), &serde_json::json!([])));
    assert!(made["collisions"].as_u64() > Some(0));
    assert_eq!((&made["open_walks"], &made["capped_walks"]), (&serde_json::json!(0), &serde_json::json!(0)));
    let sheet = "[[object]]\nname = \"leaf\"\nshape = \"quad\"\ncenter = [0, 0, 2]\nnormal = [0, 0, 1]\n\
                 size = [1, 1]\nmaterial = \"marble\"\n[subsurface]\nmethod = \"walk\"\n";
    fs::write(folder.path("leaf.toml"), format!("{SCENE}{sheet}")).unwrap();
    let (_, told) = folder
        .run(&["render", "leaf.toml", "-o", "a.exr", "--spp", "1", "--width", "32", "--height", "32"])
        .ends_with(0);
    assert!(told.contains("warning: object \"leaf\": it encloses no volume"), "{told}");
}

#[test]
fn the_tabulated_profile_says_what_it_covers() {
    let folder = folder();
    fs::write(folder.path("diamond.toml"), SCENE.replace("ior = 1.5", "ior = 2.4")).unwrap();
    let small = ["--width", "16", "--height", "12", "--spp", "1"];
    let with =
        |profile| [&["render", "diamond.toml", "-o", "a.exr", "--profile", profile], &small[..]].concat();
    let message = "material \"marble\": the tabulated profile covers relative indices from 0.6 to 2.042";
    folder.refuses(&with("tabulated"), 2, message);
    folder.run(&with("auto")).ends_with(0);
}

#[test]
fn the_header_tells_how_the_picture_was_made() {
    let folder = folder();
    folder
        .run(&render(&["-o", "a.exr", "--spp", "2", "--seed", "77", "--aov", "variance,samples"]))
        .ends_with(0);
    let image = exr::prelude::read_all_flat_layers_from_file(folder.path("a.exr")).unwrap();
    let layer = &image.layer_data[0];
    let channels: Vec<String> = layer.channel_data.list.iter().map(|c| c.name.to_string()).collect();
    assert_eq!(channels, ["B", "G", "R", "samples", "variance.B", "variance.G", "variance.R"]);
    let attribute = |name: &str| {
        let (_, value) = layer.attributes.other.iter().find(|(key, _)| *key == name).unwrap();
        value.to_text().unwrap().to_string()
    };
    assert_eq!(attribute("alabaster.seed"), "77");
    assert_eq!(attribute("alabaster.spp"), "2");
    assert_eq!(attribute("alabaster.nonfinite"), "0");
    assert_eq!(attribute("alabaster.version"), env!("CARGO_PKG_VERSION"));
    assert!(attribute("alabaster.seconds").parse::<f64>().unwrap() > 0.0);
    assert!(attribute("alabaster.commandLine").ends_with("--seed 77 --aov variance,samples"));
}

#[test]
fn limits_of_time_and_error_end_a_render() {
    let folder = folder();
    assert!(
        folder.run(&render(&["-o", "a.exr", "--time", "0.2", "--json"])).report()["spp"].as_u64() >= Some(1)
    );
    // An error of 1000 % is reached as soon as an estimate is believed.
    assert_eq!(folder.run(&render(&["-o", "a.exr", "--error", "10", "--json"])).report()["spp"], 16);
    assert_eq!(
        folder.run(&render(&["-o", "a.exr", "--error", "10", "--spp", "4", "--json"])).report()["spp"],
        4
    );
}

#[test]
fn quiet_is_quiet() {
    let folder = folder();
    let silence = (String::new(), String::new());
    assert_eq!(folder.run(&render(&["-o", "a.png", "--spp", "1", "--quiet"])).ends_with(0), silence);
}

#[test]
fn wrong_command_lines_are_refused() {
    let folder = folder();
    let cases: [(&[&str], &str); 18] = [
        (&[], "--output"),
        (&["-o", "a.jpg"], "a.jpg: pictures are written as .exr or .png"),
        (&["-o", "a"], "choose one of these endings"),
        (&["-o", "a.exr", "--spp", "0"], "--spp"),
        (&["-o", "a.exr", "--spp", "many"], "--spp"),
        (&["-o", "a.exr", "--time", "-1"], "-1"),
        (&["-o", "a.exr", "--time", "NaN"], "a number above 0 is wanted"),
        (&["-o", "a.exr", "--error", "0"], "a number above 0 is wanted"),
        (&["-o", "a.png", "--exposure", "inf"], "a finite number is wanted"),
        (&["-o", "a.exr", "--threads", "0"], "--threads"),
        (&["-o", "a.exr", "--method", "magic"], "[possible values: auto, bssrdf, walk, diffuse]"),
        (&["-o", "a.exr", "--accuracy", "0"], "above 0, 1 at most"),
        (&["-o", "a.exr", "--accuracy", "-0.1"], "such as 0.02 or 2%"),
        (&["-o", "a.exr", "--accuracy", "NaN"], "above 0, 1 at most"),
        (&["-o", "a.exr", "--accuracy", "1.01"], "above 0, 1 at most"),
        (&["-o", "a.exr", "--accuracy", "101%"], "above 0, 1 at most"),
        (&["-o", "a.exr", "--backend", "magic"], "[possible values: embree, bvh, obvhs]"),
        (&["-o", "a.exr", "--aov", "depth"], "depth"),
    ];
    for (arguments, part) in cases {
        folder.refuses(&render(arguments), 2, part);
    }
    folder.refuses(&["rendr"], 2, "render");
}

#[test]
fn impossible_film_sizes_are_refused() {
    let folder = folder();
    for (width, height) in [("0", "10"), ("10", "0"), ("65537", "1"), ("65536", "65536")] {
        let arguments = ["render", "scene.toml", "-o", "a.exr", "--width", width, "--height", height];
        folder.refuses(&arguments, 2, width);
    }
}

#[test]
fn wrong_scenes_are_refused() {
    let folder = folder();
    folder.refuses(&["render", "missing.toml", "-o", "a.exr"], 2, "missing.toml");
    fs::write(folder.path("wrong.toml"), SCENE.replace("sigma_a", "sigma_b")).unwrap();
    folder.refuses(&["render", "wrong.toml", "-o", "a.exr"], 2, "sigma_a");
    fs::write(folder.path("wrong.glb"), "glTF but not much of it").unwrap();
    folder.refuses(&["render", "wrong.glb", "-o", "a.exr"], 2, "wrong.glb");
}

/// So many samples would take days: the refusal comes before them.
#[test]
fn unwritable_outputs_are_refused_before_rendering() {
    let folder = folder();
    fs::create_dir(folder.path("directory.exr")).unwrap();
    for output in ["missing/a.exr", "scene.toml/a.exr", "directory.exr"] {
        folder.refuses(&render(&["-o", "a.png", "-o", output, "--spp", "1000000000"]), 3, output);
    }
}

#[cfg(unix)]
#[test]
fn an_interrupt_saves_what_is_done() {
    use std::time::Duration;

    use program::run_interrupted;

    let folder = folder();
    // Signals are handled when it says so; a moment later there is something to save.
    let (ready, pause) = ("rendering 16 × 12 pixels", Duration::from_millis(500));
    let arguments = render(&["-o", "a.exr", "--spp", "1000000000"]);
    let run = run_interrupted(&folder.path(""), &arguments, ready, pause);
    assert_eq!(run.code, 130);
    assert!(run.stderr.lines().any(|line| line.starts_with("interrupted; what was done")), "{run:?}");
    let picture = read_picture(&folder.path("a.exr")).unwrap();
    assert!(picture.pixels.iter().any(|pixel| !pixel.is_black()));
}

#[test]
fn tonemap_shows_what_render_shows() {
    let folder = folder();
    let view = ["--view", "filmic", "--exposure", "-0.5"];
    folder.run(&render(&[&["-o", "a.exr", "-o", "a.png", "--spp", "4"], &view[..]].concat())).ends_with(0);
    folder.run(&[&["tonemap", "a.exr", "b.png"], &view[..]].concat()).ends_with(0);
    assert_eq!(fs::read(folder.path("a.png")).unwrap(), fs::read(folder.path("b.png")).unwrap());
    folder.run(&["tonemap", "a.exr", "c.png", "--exposure", "3"]).ends_with(0);
    assert_ne!(fs::read(folder.path("a.png")).unwrap(), fs::read(folder.path("c.png")).unwrap());
}

#[test]
fn tonemap_refuses_what_it_cannot_read_or_write() {
    let folder = folder();
    fs::write(folder.path("a.exr"), "not OpenEXR").unwrap();
    folder.refuses(&["tonemap", "a.exr", "a.png"], 2, "a.exr: is not an OpenEXR file");
    folder.refuses(&["tonemap", "missing.exr", "a.png"], 2, "missing.exr: cannot be read");
    folder.refuses(&["tonemap", "a.exr", "b.exr"], 2, "tonemap writes .png");
    folder.refuses(&["tonemap", "a.exr", "missing/b.png"], 3, "missing/b.png");
}

#[test]
fn materials_are_listed_with_their_sources() {
    let folder = folder();
    let (table, _) = folder.run(&["materials"]).ends_with(0);
    let materials = folder.run(&["materials", "--json"]).report();
    let materials = materials.as_array().unwrap();
    assert_eq!(table.lines().count(), 1 + materials.len());
    let marble = materials.iter().find(|material| material["name"] == "Marble").unwrap();
    assert_eq!(marble["source"], "Jensen et al. 2001");
    assert_eq!(marble["sigma_a"][2].as_f64().unwrap() as f32, 7.1);
}

#[test]
fn help_and_version_are_no_errors() {
    let folder = folder();
    for arguments in [&["--help"][..], &["render", "--help"], &["--version"]] {
        let (stdout, stderr) = folder.run(arguments).ends_with(0);
        assert!(!stdout.is_empty() && stderr.is_empty());
    }
}

/// Five million triangles where there is room for the scene, but not for a hierarchy.
#[cfg(unix)]
#[test]
fn triangles_beyond_memory_are_refused_with_the_bytes() {
    let folder = Folder::new();
    let ball = |x: u32| {
        format!("[[object]]\nshape = \"sphere\"\ncenter = [{x}, 0, 0]\nradius = 0.4\nmaterial = \"chalk\"\n")
    };
    let material = "[material.chalk]\ntype = \"diffuse\"\nreflectance = 0.8\n[environment]\nradiance = 1\n";
    let balls: String = (0..60).map(ball).collect();
    fs::write(folder.path("balls.toml"), format!("{balls}{material}")).unwrap();
    let arguments = ["render", "balls.toml", "-o", "balls.exr", "--spp", "1", "--quiet", "--threads", "1"];
    for backend in Backend::available() {
        let arguments = [&arguments[..], &["--backend", backend.name()]].concat();
        let run = program::run_within_memory(800_000, &folder.path("."), &arguments);
        run.fails(3, "not enough memory for the hierarchy over the triangles (707788800 bytes)");
    }
    assert_eq!(folder.names(), ["balls.toml"]);
}
