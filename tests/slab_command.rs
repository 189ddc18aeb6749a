//! `alabaster slab`: the files that it writes, what it prints, and how it ends.

mod mcml;
#[path = "common/program.rs"]
#[allow(dead_code)]
mod program;

use std::fs;

use alabaster::slab::Source;
use mcml::{GOOD, good, mco, simulate, with_line};
use program::{names, run};
use serde_json::Value;

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("in.mci"), GOOD).unwrap();
    folder
}

#[test]
fn the_command_writes_the_files_that_the_input_names() {
    let folder = folder();
    fs::create_dir(folder.path().join("below")).unwrap();
    fs::rename(folder.path().join("in.mci"), folder.path().join("below/in.mci")).unwrap();
    let done = run(folder.path(), &["slab", "below/in.mci", "--seed", "7"]);
    assert_eq!((done.code, done.stderr.as_str()), (0, ""), "{done:?}");
    for part in ["run 1 of 2", "diffuse reflectance", "±", "in layer 2", "specular + diffuse", "b.mco"] {
        assert!(done.stdout.contains(part), "{done:?}");
    }
    assert_eq!(names(&folder.path().join("below")), ["a.mco", "b.mco", "in.mci"]);
    let text = fs::read_to_string(folder.path().join("below/a.mco")).unwrap();
    let expected = mco(&good()[0], &simulate(&good()[0], Source::Pencil { cosine: 1.0 }));
    // But for the line with the time.
    let without_time =
        |text: &str| text.lines().filter(|line| !line.starts_with("# alabaster")).collect::<String>();
    assert_eq!(without_time(&text), without_time(&expected));
}

#[test]
fn the_command_reports_as_json() {
    let folder = folder();
    let done = run(
        folder.path(),
        &["slab", "in.mci", "--json", "-o", "o.json", "-o", "o.csv", "-o", "o.mco", "--seed", "3"],
    );
    assert_eq!(done.code, 0, "{done:?}");
    // One file for all totals; the tables of each run by number.
    assert_eq!(names(folder.path()), ["in.mci", "o-1.csv", "o-1.mco", "o-2.csv", "o-2.mco", "o.json"]);
    assert_eq!(fs::read_to_string(folder.path().join("o.json")).unwrap(), done.stdout);
    let report: Value = serde_json::from_str(&done.stdout).unwrap();
    let runs = report["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 2);
    for (i, run) in runs.iter().enumerate() {
        for key in ["diffuse_reflectance", "absorbed", "transmitted", "collisions_per_photon", "accounted"] {
            assert!(run[key]["value"].is_f64() && run[key]["stderr"].is_f64(), "{key}: {run}");
        }
        assert!(run["specular"].is_f64() && run["seconds"].is_f64());
        assert_eq!(run["photons"], [1000, 2000][i]);
        assert_eq!(run["seed"], 3 + i);
        assert_eq!(run["absorbed_by_layer"].as_array().unwrap().len(), [2, 1][i]);
        let value = |key: &str| run[key]["value"].as_f64().unwrap();
        let together = run["specular"].as_f64().unwrap()
            + value("diffuse_reflectance")
            + value("absorbed")
            + value("transmitted");
        assert!((together - value("accounted")).abs() < 1e-12);
    }
}

#[test]
fn options_override_the_input() {
    let folder = folder();
    let report = |arguments: &[&str]| -> Value {
        let done = run(folder.path(), &[&["slab", "in.mci", "-o", "o.json", "--json"], arguments].concat());
        assert_eq!((done.code, done.stderr.as_str()), (0, ""), "{done:?}");
        let mut report: Value = serde_json::from_str(&done.stdout).unwrap();
        report["runs"][0].take()
    };
    assert_eq!(report(&["--photons", "500"])["photons"], 500);
    let fresnel = |run: &Value| run["specular"].as_f64().unwrap();
    // n = 1.4: ((n − 1)/(n + 1))² straight down; by Fresnel's formulas 0.0728 at 60°.
    assert!((fresnel(&report(&[])) - (0.4_f64 / 2.4).powi(2)).abs() < 1e-12);
    let (i, t) = (0.5_f64, (1.0 - 0.75 / 1.96_f64).sqrt());
    let (s, p) = ((i - 1.4 * t) / (i + 1.4 * t), (t - 1.4 * i) / (t + 1.4 * i));
    assert!((fresnel(&report(&["--cosine", "0.5"])) - 0.5 * (s * s + p * p)).abs() < 1e-12);
    let diffuse = report(&["--source", "diffuse"]);
    // The diffuse Fresnel reflectance for n = 1.4 is 0.0768.
    let sigma = diffuse["specular_stderr"].as_f64().unwrap();
    assert!((fresnel(&diffuse) - 0.07681155).abs() < 4.0 * sigma && sigma < 0.01, "{diffuse}");
    let same = |arguments: &[&str]| {
        let mut run = report(arguments);
        for key in ["seconds", "photons_per_second", "threads"] {
            run[key].take();
        }
        run
    };
    assert_eq!(same(&["--threads", "1"]), same(&["--threads", "3"]));
    assert_ne!(same(&["--seed", "1"]), same(&["--seed", "2"]));
    let quiet = run(folder.path(), &["slab", "in.mci", "--quiet"]);
    assert_eq!((quiet.code, quiet.stdout.as_str(), quiet.stderr.as_str()), (0, "", ""));
}

/// A single photon has no spread to tell an error from.
#[test]
fn an_unknown_error_is_null() {
    let folder = folder();
    let done = run(folder.path(), &["slab", "in.mci", "--photons", "1", "--json", "-o", "o.json"]);
    let report: Value = serde_json::from_str(&done.stdout).unwrap();
    assert!(report["runs"][0]["absorbed"]["stderr"].is_null(), "{report}");
}

#[test]
fn wrong_commands_and_files_are_refused() {
    let folder = folder();
    let path = folder.path();
    let command = |arguments: &[&str]| run(path, &[&["slab"], arguments].concat());
    fs::write(path.join("bad.mci"), with_line(14, "1.4 1 100 2 0.1")).unwrap();
    fs::write(path.join("self.mci"), GOOD.replace("a.mco", "self.mci")).unwrap();
    fs::write(path.join("binary.mci"), [0x80, 0xff, 0x00, 0x0a]).unwrap();
    let before = names(path);
    command(&["missing.mci"]).is_refused("missing.mci: cannot be read");
    command(&["."]).is_refused(".: cannot be read");
    command(&["bad.mci"])
        .is_refused("bad.mci: line 14: layer, n mua mus g d: layer 1: the mean cosine g is 2");
    command(&["binary.mci"]).is_refused("binary.mci: line 1: file version");
    command(&["self.mci"]).is_refused("self.mci: is the input");
    command(&["in.mci", "-o", "in.mci"]).is_refused("choose one of these endings");
    command(&["in.mci", "-o", "o.txt"]).is_refused("o.txt: slabs are written as .mco, .csv or .json");
    command(&["in.mci", "-o", "o.mco", "-o", "o.mco"]).is_refused("would be written twice");
    command(&["in.mci", "--source", "diffuse", "--cosine", "0.5"]).is_refused("--cosine");
    for wrong in
        [["--cosine", "0"], ["--cosine", "1.1"], ["--cosine", "nan"], ["--photons", "0"], ["--source", "x"]]
    {
        command(&[&["in.mci"], &wrong[..]].concat()).is_refused(wrong[0]);
    }
    let missing = command(&["in.mci", "-o", "missing/o.mco"]);
    assert_eq!((missing.code, missing.errors()), (3, 1), "{missing:?}");
    assert_eq!(names(path), before);
}

#[cfg(unix)]
#[test]
fn an_interrupt_saves_what_is_done() {
    use std::time::Duration;

    use program::run_interrupted;

    let folder = folder();
    // Signals are handled when it says so; a moment later there is something to save.
    let (ready, pause) = ("run 1 of 2: 100000000000 photons", Duration::from_millis(500));
    let arguments = ["slab", "in.mci", "--photons", "100000000000", "-o", "o.json"];
    let run = run_interrupted(folder.path(), &arguments, ready, pause);
    assert_eq!(run.code, 130);
    let said = "interrupted; what was done is saved: 1 of 2 runs";
    assert!(run.stderr.lines().any(|line| line.starts_with(said)), "{run:?}");
    let report: Value =
        serde_json::from_str(&fs::read_to_string(folder.path().join("o.json")).unwrap()).unwrap();
    let run = &report["runs"][0];
    assert!(run["photons"].as_u64().unwrap() > 0);
    let accounted = &run["accounted"];
    let off = (accounted["value"].as_f64().unwrap() - 1.0).abs();
    assert!(off < 5.0 * accounted["stderr"].as_f64().unwrap(), "{run}");
}
