//! `alabaster study`: files, JSON, the report in a browser, going on after an interruption, messages.

#[path = "common/program.rs"]
#[allow(dead_code)]
mod program;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::time::Duration;

use alabaster::film::exr;
use program::{Folder, Run, run_within};
use serde_json::{Value, json};

/// A ball in which light collides a few times, under a rough boundary, on a floor.
const SCENE: &str = r#"
title = "Ball <of> wax & more"

[[object]]
shape = "sphere"
center = [0, 0, 0]
radius = 1.0
material = "wax, yellow"

[[object]]
shape = "quad"
center = [0, -1, 0]
normal = [0, 1, 0]
size = [6, 6]
material = "floor"

[camera]
position = [0, 1, 4]
target = [0, 0, 0]
fov = 40.0

[film]
width = 300
height = 200

[environment]
radiance = [1, 0.8, 0.6]

[material."wax, yellow"]
type = "translucent"
ior = 1.4
roughness = 0.5
sigma_a = [0.5, 1, 2]
sigma_s = [6, 7, 8]
g = 0.3

[material.floor]
type = "diffuse"
reflectance = [0.5, 0.5, 0.5]
"#;

/// No study here takes longer, on a busy machine neither.
const LIMIT: Duration = Duration::from_secs(120);

const METHODS: [&str; 5] =
    ["diffuse", "bssrdf-tabulated", "bssrdf-photon-beam", "bssrdf-directional-dipole", "walk"];

/// `study scene.toml -o out` with these arguments and few pixels.
fn study<'a>(arguments: &[&'a str]) -> Vec<&'a str> {
    [&["study", "scene.toml", "-o", "out", "--width", "24"], arguments].concat()
}

fn folder() -> Folder {
    let folder = Folder::new();
    fs::write(folder.path("scene.toml"), SCENE).unwrap();
    folder
}

#[track_caller]
fn run(folder: &Folder, arguments: &[&str]) -> Run {
    run_within(LIMIT, &folder.path(""), arguments)
}

/// The arguments of the study that the tests share.
fn shared_arguments() -> Vec<&'static str> {
    study(&[
        "--time",
        "24",
        "--seeds",
        "3",
        "--json",
        "--methods",
        "diffuse,tabulated,photon-beam,directional-dipole,walk",
    ])
}

/// A study, made once, and what it printed.
fn shared() -> &'static (Folder, Value) {
    static SHARED: OnceLock<(Folder, Value)> = OnceLock::new();
    SHARED.get_or_init(|| {
        let folder = folder();
        let report = run(&folder, &shared_arguments()).report();
        (folder, report)
    })
}

#[test]
fn json_has_the_keys_of_the_contract() {
    let (folder, report) = shared();
    let written: Value = serde_json::from_slice(&fs::read(folder.path("out/summary.json")).unwrap()).unwrap();
    assert_eq!(&written, report);
    for key in ["seconds", "relative_noise", "collisions_per_sample"] {
        assert!(report["reference"][key].as_f64().unwrap() > 0.0, "{key}");
    }
    let methods = report["methods"].as_array().unwrap();
    let names: Vec<String> = methods
        .iter()
        .map(|method| match method["profile"].as_str() {
            Some(profile) => format!("{}-{profile}", method["name"].as_str().unwrap()),
            None => method["name"].as_str().unwrap().into(),
        })
        .collect();
    assert_eq!(names, METHODS);
    for method in methods {
        assert!(method["bias_squared"].as_f64().unwrap() >= 0.0, "{method}");
        for key in ["variance_seconds", "efficiency", "setup_seconds"] {
            assert!(method[key].as_f64().unwrap() > 0.0, "{key} of {method}");
        }
        let is_walk = method["name"] == "walk";
        assert_eq!(method["crossover"].is_null(), is_walk);
        assert_eq!(method["crossover_seconds"].is_number(), !is_walk && method["crossover"] != "never");
        let points = method["points"].as_array().unwrap();
        assert!(points.len() >= 2);
        for pair in points.windows(2) {
            assert!(pair[0]["spp"].as_u64() < pair[1]["spp"].as_u64());
            assert!(pair[0]["seconds"].as_f64() < pair[1]["seconds"].as_f64());
        }
        assert!(points.iter().all(|point| point["relmse"].is_number()));
    }
    // Light that leaves where it entered is not this body: its bias is found, whatever the noise.
    assert!(methods[0]["bias_squared"].as_f64().unwrap() > 1e-3, "{}", methods[0]);
    assert_eq!(methods[4]["bias_squared"], 0.0);
    let regions: Vec<&Value> =
        report["regions"].as_array().unwrap().iter().map(|region| &region["name"]).collect();
    assert_eq!(regions, ["whole picture", "wax, yellow"]);
    let advice = report["advice"].as_array().unwrap();
    assert_eq!(advice.len(), 1);
    assert!(advice[0].as_str().unwrap().starts_with("wax, yellow: "), "{advice:?}");
    assert_eq!((&report["complete"], &report["confidence"]), (&json!(true), &json!(0.95)));
    let effects: Vec<&Value> =
        report["effects"].as_array().unwrap().iter().map(|effect| &effect["effect"]).collect();
    assert_eq!(effects, ["anisotropy", "refraction", "roughness", "channels", "subsurface"]);
    for kind in ["geometry", "profile", "direction", "sampling"] {
        assert!(report["errors"].as_array().unwrap().iter().any(|part| part["kind"] == kind), "{kind}");
    }
    assert!(report["collisions"][0]["collisions"][0].as_f64().unwrap() > 1.0);
}

/// Every point of every run: three runs of five methods, at the levels that the JSON has, in three regions.
#[test]
fn the_table_has_every_point() {
    let (folder, report) = shared();
    let csv = fs::read_to_string(folder.path("out/data.csv")).unwrap();
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some("region,method,profile,run,seed,spp,seconds,relmse"));
    let points: usize =
        report["methods"].as_array().unwrap().iter().map(|m| m["points"].as_array().unwrap().len()).sum();
    assert_eq!(lines.clone().count(), 3 * 3 * points);
    let of_material: Vec<&str> = lines.filter(|line| line.starts_with("\"wax, yellow\",")).collect();
    assert_eq!(of_material.len(), 3 * points);
    assert_eq!(of_material[0].split(',').count(), 9, "{}", of_material[0]);
}

/// Mean pictures are as large as asked for, in proportion, and say how uncertain they are.
#[test]
fn means_are_left_as_pictures() {
    let (folder, _) = shared();
    for name in METHODS.iter().chain([&"reference"]) {
        let file = exr::read(&folder.path(&format!("out/{name}.exr"))).unwrap();
        assert_eq!((file.picture.width, file.picture.height), (24, 16), "{name}");
        let variance = file.variance.unwrap();
        assert!(variance.iter().all(|v| v.is_finite() && v.min_component() >= 0.0), "{name}");
        assert!(variance.iter().any(|v| v.max_component() > 0.0), "{name}");
    }
}

#[test]
fn the_report_needs_nothing_else() {
    let (folder, report) = shared();
    let html = fs::read_to_string(folder.path("out/report.html")).unwrap();
    for loads in ["src=\"http", "href=\"http", "src=\"//", "url(", "@import", "fetch(", "XMLHttpRequest"] {
        assert!(!html.contains(loads), "{loads}");
    }
    assert!(html.contains("<h1>What accuracy costs in time: Ball &lt;of&gt; wax &amp; more</h1>"));
    let sentence = report["advice"][0].as_str().unwrap();
    assert!(html.contains(sentence), "{sentence}");
    // Two charts for the whole picture, two for the material.
    assert_eq!(html.matches("<figure class=\"plot\"><svg").count(), 4);
    // Those of the error over time are files, too.
    for name in ["error.svg", "error-wax--yellow.svg"] {
        let chart = fs::read_to_string(folder.path("out").join(name)).unwrap();
        assert!(chart.starts_with("<svg") && html.contains(&chart), "{name}");
    }
    for label in ["time T [s]", "relative error √relMSE [%]", "time needed [s]"] {
        assert_eq!(html.matches(label).count(), 2, "{label}");
    }
    for section in ["answers", "pictures", "curves", "tables", "maps", "effects", "collisions", "method"] {
        assert!(html.contains(&format!("<section id=\"{section}\">")), "{section}");
    }
}

/// Called again, it has nothing to render: it writes the same again.
#[test]
fn what_is_done_is_not_done_again() {
    let (folder, report) = shared();
    let before = fs::metadata(folder.path("out/runs/walk-02.exr")).unwrap().modified().unwrap();
    assert_eq!(&run(folder, &shared_arguments()).report(), report);
    assert_eq!(fs::metadata(folder.path("out/runs/walk-02.exr")).unwrap().modified().unwrap(), before);
}

#[test]
fn other_settings_are_refused_where_a_study_is() {
    let (folder, _) = shared();
    let mut arguments = shared_arguments();
    arguments.extend(["--seed", "7"]);
    run(folder, &arguments).is_refused("other settings: seed (0 there, 7 now)");
    let mut arguments = shared_arguments();
    arguments.extend(["--height", "20"]);
    run(folder, &arguments).is_refused("height (16 there, 20 now)");
    let changed = SCENE.replace("roughness = 0.5", "roughness = 0.25");
    fs::write(folder.path("changed.toml"), changed).unwrap();
    let mut arguments = shared_arguments();
    arguments[1] = "changed.toml";
    run(folder, &arguments).is_refused("other settings: the scene;");
}

/// Interrupted when it has begun with the candidates, it keeps what is done, and goes on with that.
#[cfg(unix)]
#[test]
fn an_interrupted_study_goes_on() {
    let folder = folder();
    let arguments =
        study(&["--time", "16", "--seeds", "4", "--methods", "diffuse,normalized-diffusion,walk"]);
    let mut child = Command::new(env!("CARGO_BIN_EXE_alabaster"))
        .current_dir(folder.path(""))
        .args(&arguments)
        .stderr(std::process::Stdio::piped())
        .stdout(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let second = folder.path("out/runs/diffuse-01.json");
    while !second.exists() {
        assert!(child.try_wait().unwrap().is_none(), "it ended before it had done two runs");
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{stderr}");
    assert!(stderr.contains("interrupted; what was done is kept and reported on; the same command goes on"));
    let html = fs::read_to_string(folder.path("out/report.html")).unwrap();
    assert!(html.contains("The study is not finished"));
    assert!(!folder.path("out/runs/walk-03.json").exists());
    let kept: Vec<PathBuf> = records(&folder.path("out/runs"));
    let contents: Vec<String> = kept.iter().map(|path| fs::read_to_string(path).unwrap()).collect();

    let summary = run(&folder, &[&arguments[..], &["--json"]].concat()).report();
    assert_eq!(summary["complete"], true);
    assert!(summary["methods"].as_array().unwrap().iter().all(|method| method["runs"] == 4));
    for (path, content) in kept.iter().zip(contents) {
        assert_eq!(fs::read_to_string(path).unwrap(), content, "{path:?}");
    }
}

/// The files that say what a run was.
#[cfg(unix)]
fn records(runs: &Path) -> Vec<PathBuf> {
    let files = program::names(runs).into_iter().map(|name| runs.join(name));
    files.filter(|path| path.extension().is_some_and(|ending| ending == "json")).collect()
}

#[test]
fn what_cannot_be_studied_is_refused() {
    let folder = folder();
    let opaque = SCENE.replace("material = \"wax, yellow\"", "material = \"floor\"");
    fs::write(folder.path("opaque.toml"), opaque).unwrap();
    let study = |arguments: &[&'static str]| [&["study"], arguments].concat();
    run(&folder, &study(&["opaque.toml", "-o", "out"]))
        .is_refused("nothing to compare: no object is of a translucent");
    let cases: [(&[&'static str], &str); 6] = [
        (&["scene.toml", "-o", "new", "--methods", "walk,magic"], "--methods: there is no \"magic\""),
        (&["scene.toml", "-o", "new", "--reference", "bssrdf"], "--reference: give one profile, or walk"),
        (&["scene.toml", "-o", "new", "--seeds", "1"], "--seeds"),
        (&["scene.toml", "-o", "new", "--time", "0"], "--time"),
        (&["scene.toml", "-o", "new", "--width", "0"], "--width"),
        (&["none.toml", "-o", "new"], "none.toml"),
    ];
    for (arguments, part) in cases {
        run(&folder, &study(arguments)).is_refused(part);
        assert!(!folder.path("new").exists(), "{arguments:?}");
    }
}

/// The least time is said, and is enough (three times over: speeds are measured anew, and other tests run beside).
#[test]
fn a_time_that_is_too_short_is_refused_with_the_least() {
    let folder = folder();
    let with_time = |time: &str| {
        let arguments = ["--seeds", "2", "--methods", "diffuse,walk", "--time", time, "--quiet"];
        run(&folder, &[&study(&[])[..], &arguments].concat())
    };
    let refused = with_time("0.001");
    refused.is_refused("--time 0.001 is too short: ");
    let rest = refused.stderr.split("too short: ").nth(1).unwrap();
    let least: f64 = rest.split(' ').next().unwrap().parse().unwrap();
    with_time(&format!("{}", 3.0 * least)).ends_with(0);
}

#[test]
fn a_directory_that_cannot_be_made_is_the_machines_fault() {
    let folder = folder();
    fs::write(folder.path("out"), "a file").unwrap();
    run(&folder, &study(&["--time", "5"])).fails(3, "out/runs");
}

/// What a browser makes of a page, and what it complains of.
struct Page {
    dom: String,
    complaints: Vec<String>,
}

/// Opens a page in headless Chromium; `None` where that is not installed.
fn open(path: &Path) -> Option<Page> {
    let profile = tempfile::tempdir().unwrap();
    let output = Command::new("chromium")
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr", "--dump-dom"])
        .arg("--virtual-time-budget=5000")
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(format!("file://{}", path.display()))
        .output()
        .ok()?;
    let stderr = String::from_utf8_lossy(&output.stderr);
    let complaints = stderr.lines().filter(|line| line.contains("CONSOLE")).map(String::from).collect();
    Some(Page { dom: String::from_utf8_lossy(&output.stdout).into_owned(), complaints })
}

/// The report opens without a complaint, with all its charts drawn and its pictures in place. That a complaint would
/// be seen is tried with a page that is wrong.
#[test]
fn a_browser_shows_the_report() {
    let folder = Folder::new();
    fs::write(folder.path("wrong.html"), "<p>a</p><script>missing();</script>").unwrap();
    let Some(wrong) = open(&folder.path("wrong.html")) else {
        eprintln!("skipped: there is no chromium on this machine (scripts/setup.sh --tests installs it)");
        return;
    };
    assert!(wrong.complaints.len() == 1 && wrong.complaints[0].contains("missing is not defined"));

    let (study, _) = shared();
    let page = open(&study.path("out/report.html")).unwrap();
    assert!(page.complaints.is_empty(), "{:?}", page.complaints);
    let charts: Vec<&str> = page.dom.split("<figure class=\"plot\"><svg").skip(1).collect();
    assert_eq!(charts.len(), 4);
    for chart in &charts {
        let chart = chart.split("</svg>").next().unwrap();
        // A line for each method within the chart, and the labels of both axes.
        assert!(chart.matches("<polyline").count() >= METHODS.len() && chart.contains("[s]"), "{chart}");
    }
    // The script has put the first method over the reference.
    let over = page.dom.split("id=\"wipe-over\"").nth(1).unwrap().split('>').next().unwrap();
    assert!(over.contains("src=\"data:image/png;base64,"), "{over:.200}");
    assert!(page.dom.contains("style=\"--at: 50%;\""));
}
