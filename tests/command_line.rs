//! What a script relies on: exit codes, one message, JSON, files.

use std::fs;
use std::path::{Path, PathBuf};

use alabaster::film::exr::read_picture;
use alabaster::raycast::Backend;
use assert_cmd::Command;
use serde_json::Value;
use tempfile::TempDir;

const SCENE: &str = r#"
[[object]]
shape = "sphere"
center = [0, 0, 0]
radius = 1.0
material = "marble"

[camera]
position = [0, 0, 4]
target = [0, 0, 0]
fov = 40.0

[environment]
radiance = [1, 0.8, 0.6]

[material.marble]
type = "translucent"
ior = 1.5
sigma_a = [2.1, 4.1, 7.1]
sigma_s = [2190, 2620, 3000]
"#;

/// A directory with a scene in it.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        let directory = tempfile::tempdir().unwrap();
        fs::write(directory.path().join("scene.toml"), SCENE).unwrap();
        Self(directory)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_alabaster"));
        command.current_dir(self.0.path()).env_remove("RUST_LOG").args(arguments);
        command
    }

    /// `render scene.toml --width 16 --height 12` with more arguments.
    fn render(&self, arguments: &[&str]) -> Command {
        let mut command = self.command(&["render", "scene.toml", "--width", "16", "--height", "12"]);
        command.args(arguments);
        command
    }

    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

/// Standard output and standard error of a command that must end with `code`.
fn ends_with(mut command: Command, code: i32) -> (String, String) {
    let output = command.assert().code(code).get_output().clone();
    (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap())
}

/// Must be refused with `code` and one message that contains `part`, and write nothing.
fn is_refused(folder: &Folder, command: Command, code: i32, part: &str) {
    let before = folder.names();
    let (stdout, stderr) = ends_with(command, code);
    assert_eq!(stdout, "");
    assert_eq!(stderr.matches("error: ").count(), 1, "{stderr}");
    assert!(stderr.contains(part), "{stderr}");
    assert_eq!(folder.names(), before);
}

fn report(command: Command) -> Value {
    let (stdout, _) = ends_with(command, 0);
    serde_json::from_str(&stdout).unwrap()
}

fn png_size(path: &Path) -> (u32, u32) {
    let picture = image::open(path).unwrap();
    (picture.width(), picture.height())
}

#[test]
fn render_writes_every_output_and_reports_what_it_did() {
    let folder = Folder::new();
    let report =
        report(folder.render(&["-o", "a.exr", "-o", "a.png", "--spp", "3", "--threads", "1", "--json"]));
    for key in ["seconds", "samples_per_second", "nonfinite", "rejected", "capped_walks", "firefly_index"] {
        assert!(report[key].is_number(), "{key}");
    }
    for key in ["cast", "missed", "hits", "overflowed"] {
        assert!(report["probes"][key].is_u64(), "{key}");
    }
    assert_eq!(report["spp"], 3);
    assert_eq!(report["samples"], 3 * 16 * 12);
    assert_eq!(report["threads"], 1);
    assert_eq!(report["backend"], Backend::default().name());
    assert_eq!(report["method"], "bssrdf");
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
    let folder = Folder::new();
    for (name, seed, threads) in [("a.exr", "1", "1"), ("b.exr", "1", "3"), ("c.exr", "2", "1")] {
        ends_with(folder.render(&["-o", name, "--spp", "5", "--seed", seed, "--threads", threads]), 0);
    }
    let [a, b, c] = ["a.exr", "b.exr", "c.exr"].map(|name| read_picture(&folder.path(name)).unwrap());
    assert!(a == b);
    assert!(a != c);
}

/// Both backends trace the same paths; a ray that passes within rounding of an edge may go another way.
/// So the pictures' means differ by far less than their own noise.
#[test]
fn every_backend_of_this_build_renders() {
    let folder = Folder::new();
    let means = Backend::available().iter().map(|backend| {
        let file = format!("{}.exr", backend.name());
        let arguments = ["-o", &file, "--spp", "16", "--backend", backend.name(), "--json"];
        let report = report(folder.render(&arguments));
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
    let folder = Folder::new();
    is_refused(&folder, folder.render(&["-o", "a.exr", "--backend", "embree"]), 2, "use --backend bvh");
}

#[test]
fn what_is_not_there_yet_is_refused() {
    let folder = Folder::new();
    fs::write(folder.path("spectral.toml"), format!("{SCENE}[render]\nmode = \"spectral\"\n")).unwrap();
    is_refused(&folder, folder.command(&["render", "spectral.toml", "-o", "a.exr"]), 2, "auto, rgb");
}

#[test]
fn every_profile_renders_and_is_reported() {
    let folder = Folder::new();
    let names =
        ["dipole", "better-dipole", "directional-dipole", "normalized-diffusion", "photon-beam", "tabulated"];
    for name in names {
        let made = report(folder.render(&["-o", "a.exr", "--spp", "1", "--profile", name, "--json"]));
        assert_eq!(made["profiles"], serde_json::json!([name]));
        assert_eq!(made["nonfinite"], 0);
    }
    let made = report(folder.render(&["-o", "a.exr", "--spp", "1", "--method", "diffuse", "--json"]));
    assert_eq!(made["profiles"], serde_json::json!([]));
}

#[test]
fn walks_are_reported_and_what_is_odd_is_told() {
    let folder = Folder::new();
    let made = report(folder.render(&["-o", "a.exr", "--spp", "1", "--method", "walk", "--json"]));
    assert_eq!((&made["method"], &made["profiles"]), (&serde_json::json!("walk"), &serde_json::json!([])));
    assert!(made["collisions"].as_u64() > Some(0));
    assert_eq!((&made["open_walks"], &made["capped_walks"]), (&serde_json::json!(0), &serde_json::json!(0)));
    let sheet = "[[object]]\nname = \"leaf\"\nshape = \"quad\"\ncenter = [0, 0, 2]\nnormal = [0, 0, 1]\n\
                 size = [1, 1]\nmaterial = \"marble\"\n[subsurface]\nmethod = \"walk\"\n";
    fs::write(folder.path("leaf.toml"), format!("{SCENE}{sheet}")).unwrap();
    let (_, told) = ends_with(folder.command(&["render", "leaf.toml", "-o", "a.exr", "--spp", "1"]), 0);
    assert!(told.contains("warning: object \"leaf\": it encloses no volume"), "{told}");
}

#[test]
fn the_tabulated_profile_says_what_it_covers() {
    let folder = Folder::new();
    fs::write(folder.path("diamond.toml"), SCENE.replace("ior = 1.5", "ior = 2.4")).unwrap();
    let render = |profile| folder.command(&["render", "diamond.toml", "-o", "a.exr", "--profile", profile]);
    let message = "material \"marble\": the tabulated profile covers relative indices from 0.6 to 2.042";
    is_refused(&folder, render("tabulated"), 2, message);
    ends_with(render("auto"), 0);
}

#[test]
fn the_header_tells_how_the_picture_was_made() {
    let folder = Folder::new();
    ends_with(folder.render(&["-o", "a.exr", "--spp", "2", "--seed", "77", "--aov", "variance,samples"]), 0);
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
    let folder = Folder::new();
    assert!(report(folder.render(&["-o", "a.exr", "--time", "0.2", "--json"]))["spp"].as_u64() >= Some(1));
    // An error of 1000 % is reached as soon as an estimate is believed.
    assert_eq!(report(folder.render(&["-o", "a.exr", "--error", "10", "--json"]))["spp"], 16);
    assert_eq!(report(folder.render(&["-o", "a.exr", "--error", "10", "--spp", "4", "--json"]))["spp"], 4);
}

#[test]
fn quiet_is_quiet() {
    let folder = Folder::new();
    let silence = (String::new(), String::new());
    assert_eq!(ends_with(folder.render(&["-o", "a.png", "--spp", "1", "--quiet"]), 0), silence);
}

#[test]
fn wrong_command_lines_are_refused() {
    let folder = Folder::new();
    let cases: [(&[&str], &str); 13] = [
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
        (&["-o", "a.exr", "--backend", "magic"], "[possible values: embree, bvh]"),
        (&["-o", "a.exr", "--aov", "depth"], "depth"),
    ];
    for (arguments, part) in cases {
        is_refused(&folder, folder.render(arguments), 2, part);
    }
    is_refused(&folder, folder.command(&["rendr"]), 2, "render");
}

#[test]
fn impossible_film_sizes_are_refused() {
    let folder = Folder::new();
    for (width, height) in [("0", "10"), ("10", "0"), ("65537", "1"), ("65536", "65536")] {
        let arguments = ["render", "scene.toml", "-o", "a.exr", "--width", width, "--height", height];
        is_refused(&folder, folder.command(&arguments), 2, width);
    }
}

#[test]
fn wrong_scenes_are_refused() {
    let folder = Folder::new();
    is_refused(&folder, folder.command(&["render", "missing.toml", "-o", "a.exr"]), 2, "missing.toml");
    fs::write(folder.path("wrong.toml"), SCENE.replace("sigma_a", "sigma_b")).unwrap();
    is_refused(&folder, folder.command(&["render", "wrong.toml", "-o", "a.exr"]), 2, "sigma_a");
    fs::write(folder.path("wrong.glb"), "glTF but not much of it").unwrap();
    is_refused(&folder, folder.command(&["render", "wrong.glb", "-o", "a.exr"]), 2, "wrong.glb");
}

/// So many samples would take days: the refusal comes before them.
#[test]
fn unwritable_outputs_are_refused_before_rendering() {
    let folder = Folder::new();
    fs::create_dir(folder.path("directory.exr")).unwrap();
    for output in ["missing/a.exr", "scene.toml/a.exr", "directory.exr"] {
        let command = folder.render(&["-o", "a.png", "-o", output, "--spp", "1000000000"]);
        is_refused(&folder, command, 3, output);
    }
}

#[cfg(unix)]
#[test]
fn an_interrupt_saves_what_is_done() {
    use std::io::{BufRead, BufReader};
    use std::process::{Command, Stdio};
    use std::time::Duration;

    let folder = Folder::new();
    let mut child = Command::new(env!("CARGO_BIN_EXE_alabaster"))
        .current_dir(folder.0.path())
        .args(["-v", "render", "scene.toml", "-o", "a.exr", "--spp", "1000000000"])
        .args(["--width", "16", "--height", "12"])
        .env_remove("RUST_LOG")
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
    assert!(lines.any(|line| line.contains("rendering 16 × 12 pixels")));
    // Signals are handled by now; a moment later there is something to save.
    std::thread::sleep(Duration::from_millis(500));
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(lines.any(|line| line.starts_with("interrupted; what was done")));
    let picture = read_picture(&folder.path("a.exr")).unwrap();
    assert!(picture.pixels.iter().any(|pixel| !pixel.is_black()));
}

#[test]
fn tonemap_shows_what_render_shows() {
    let folder = Folder::new();
    let view = ["--view", "filmic", "--exposure", "-0.5"];
    ends_with(folder.render(&[&["-o", "a.exr", "-o", "a.png", "--spp", "4"], &view[..]].concat()), 0);
    ends_with(folder.command(&[&["tonemap", "a.exr", "b.png"], &view[..]].concat()), 0);
    assert_eq!(fs::read(folder.path("a.png")).unwrap(), fs::read(folder.path("b.png")).unwrap());
    ends_with(folder.command(&["tonemap", "a.exr", "c.png", "--exposure", "3"]), 0);
    assert_ne!(fs::read(folder.path("a.png")).unwrap(), fs::read(folder.path("c.png")).unwrap());
}

#[test]
fn tonemap_refuses_what_it_cannot_read_or_write() {
    let folder = Folder::new();
    fs::write(folder.path("a.exr"), "not OpenEXR").unwrap();
    is_refused(&folder, folder.command(&["tonemap", "a.exr", "a.png"]), 2, "a.exr: is not an OpenEXR file");
    is_refused(
        &folder,
        folder.command(&["tonemap", "missing.exr", "a.png"]),
        2,
        "missing.exr: cannot be read",
    );
    is_refused(&folder, folder.command(&["tonemap", "a.exr", "b.exr"]), 2, "tonemap writes .png");
    is_refused(&folder, folder.command(&["tonemap", "a.exr", "missing/b.png"]), 3, "missing/b.png");
}

#[test]
fn materials_are_listed_with_their_sources() {
    let folder = Folder::new();
    let (table, _) = ends_with(folder.command(&["materials"]), 0);
    let materials = report(folder.command(&["materials", "--json"]));
    let materials = materials.as_array().unwrap();
    assert_eq!(table.lines().count(), 1 + materials.len());
    let marble = materials.iter().find(|material| material["name"] == "Marble").unwrap();
    assert_eq!(marble["source"], "Jensen et al. 2001");
    assert_eq!(marble["sigma_a"][2].as_f64().unwrap() as f32, 7.1);
}

#[test]
fn help_and_version_are_no_errors() {
    let folder = Folder::new();
    for arguments in [&["--help"][..], &["render", "--help"], &["--version"]] {
        let (stdout, stderr) = ends_with(folder.command(arguments), 0);
        assert!(!stdout.is_empty() && stderr.is_empty());
    }
}
