//! `alabaster profile`: files, JSON, exit codes and messages.

#[path = "common/program.rs"]
#[allow(dead_code)]
mod program;

use std::fs;

use program::{Folder, names};
use serde_json::Value;

/// `profile` with these arguments, few photons, and `-o out`.
fn profile<'a>(arguments: &[&'a str]) -> Vec<&'a str> {
    [&["profile", "-o", "out", "--photons", "2000"], arguments].concat()
}

/// The names of the files in `out`.
fn outputs(folder: &Folder) -> Vec<String> {
    names(&folder.path("out"))
}

#[test]
fn a_material_gives_tables_pictures_and_json() {
    let folder = Folder::new();
    let report = folder.run(&profile(&["marble", "--json", "--cutoff", "0.002"])).report();
    assert_eq!(report["material"], "Marble");
    for key in ["albedo", "stderr"] {
        assert!(report["truth"][key].as_f64().unwrap() > 0.0, "{key}");
    }
    let models = report["models"].as_array().unwrap();
    assert_eq!(models.len(), 6);
    for model in models {
        assert!(model["name"].is_string());
        for key in ["albedo", "l1_error", "seconds_per_evaluation", "seconds_per_sample"] {
            assert!(model[key].as_f64().unwrap() > 0.0, "{model} {key}");
        }
    }
    let channels = report["channels"].as_array().unwrap();
    assert_eq!(
        channels.iter().map(|c| c["channel"].as_str().unwrap()).collect::<Vec<_>>(),
        ["red", "green", "blue"]
    );
    let beyond = &channels[1]["truth"]["energy_beyond"];
    // The user's cut-off is first.
    assert!((beyond[0]["radius_mm"].as_f64().unwrap() - 2.0).abs() < 1e-12);
    assert!(beyond[0]["energy"].as_f64().unwrap() > 0.0);
    // The worst channel counts.
    let worst = channels.iter().map(|c| c["models"][0]["l1_error"].as_f64().unwrap()).fold(0.0, f64::max);
    assert_eq!(models[0]["l1_error"].as_f64().unwrap(), worst);
    let files = [
        "errors.csv",
        "profile.csv",
        "profile.json",
        "profile_cumulative.svg",
        "profile_linear.svg",
        "profile_log.svg",
        "profile_radius_times_r.svg",
    ];
    assert_eq!(outputs(&folder), files);
    let written: Value =
        serde_json::from_str(&fs::read_to_string(folder.path("out/profile.json")).unwrap()).unwrap();
    assert_eq!(written, report);
}

#[test]
fn the_table_names_models_and_lengths() {
    let folder = Folder::new();
    let (stdout, stderr) = folder.run(&profile(&["marble", "--models", "photon-beam,dipole"])).ends_with(0);
    assert!(stdout.contains("green, reflectance: mean free path 0.3811 mm, reduced 0.3811 mm"), "{stdout}");
    assert_eq!(stdout.matches("photon-beam").count(), 3);
    assert!(!stdout.contains("tabulated") && stderr.is_empty(), "{stderr}");
    let (stdout, _) = folder.run(&profile(&["marble", "--quiet"])).ends_with(0);
    assert_eq!(stdout, "");
}

#[test]
fn every_way_to_give_a_medium_is_taken() {
    let folder = Folder::new();
    let one = |arguments: &[&str]| {
        folder.run(&profile(&[arguments, &["--models", "dipole", "--json"]].concat())).report()
    };
    let marble = one(&["marble"]);
    let coefficients = one(&["--sigma-a", "2.1,4.1,7.1", "--sigma-s", "2190,2620,3000", "--ior", "1.5"]);
    let albedo = |report: &Value| report["truth"]["albedo"].as_f64().unwrap();
    // The measured ones are kept in single precision.
    assert!((albedo(&coefficients) / albedo(&marble) - 1.0).abs() < 1e-6);
    let dense = one(&["marble", "--density", "10"]);
    assert_eq!(albedo(&dense), albedo(&marble));
    let lengths =
        [&marble, &dense].map(|report| report["channels"][0]["mean_free_path_mm"].as_f64().unwrap());
    assert!((lengths[0] / lengths[1] - 10.0).abs() < 1e-9);
    let look = one(&[
        "--albedo",
        "0.8",
        "--mean-free-path",
        "1e-3",
        "--ior",
        "1.4",
        "--g",
        "0.5",
        "--entry",
        "diffuse",
    ]);
    let channel = &look["channels"][0];
    assert!((channel["truth"]["exact_albedo"].as_f64().unwrap() - 0.8).abs() < 1e-9);
    assert!((channel["mean_free_path_mm"].as_f64().unwrap() - 1.0).abs() < 1e-12);
}

/// An .mci file of `layers`, lengths in cm.
fn mci(layers: &[&str]) -> String {
    format!(
        "1.0\n1\n# one run\na.mco A\n1000\n0.01 0.01\n10 10 10\n{}\n1.0\n{}\n1.0\n",
        layers.len(),
        layers.join("\n")
    )
}

#[test]
fn layers_of_mcml_are_half_spaces_or_slabs() {
    let folder = Folder::new();
    fs::write(folder.path("deep.mci"), mci(&["1.4 0.2 10 0.0 1e8"])).unwrap();
    let deep = folder.run(&profile(&["deep.mci", "--models", "dipole", "--json"])).report();
    assert_eq!(deep["thickness_m"], Value::Null);
    let channel = &deep["channels"][0];
    // 1/cm are 100/m.
    assert!((channel["sigma_a"].as_f64().unwrap() - 20.0).abs() < 1e-12);
    assert!((channel["sigma_s"].as_f64().unwrap() - 1000.0).abs() < 1e-9);
    fs::write(folder.path("thin.mci"), mci(&["1.4 0.2 10 0.0 0.5"])).unwrap();
    let thin = folder.run(&profile(&["thin.mci", "--json"])).report();
    assert!((thin["thickness_m"].as_f64().unwrap() - 0.005).abs() < 1e-15);
    let quantities: Vec<_> =
        thin["channels"].as_array().unwrap().iter().map(|c| c["quantity"].as_str().unwrap()).collect();
    assert_eq!(quantities, ["reflectance", "transmittance"]);
    assert_eq!(thin["models"][0]["name"], "multipole");
    let pictures = fs::read_to_string(folder.path("out/profile_log.svg")).unwrap();
    assert!(pictures.contains("T(r) [1/mm²]"));
}

#[test]
fn files_that_no_model_is_of_are_refused() {
    let folder = Folder::new();
    fs::write(folder.path("two.mci"), mci(&["1.4 0.2 10 0.0 0.5", "1.5 0.1 20 0.0 1e8"])).unwrap();
    folder.refuses(&profile(&["two.mci"]), 2, "two.mci: run on line 4: there are 2 layers");
    fs::write(folder.path("bad.mci"), mci(&["1.4 -0.2 10 0.0 0.5"])).unwrap();
    folder.refuses(&profile(&["bad.mci"]), 2, "bad.mci: line 10");
    fs::write(folder.path("thin.mci"), mci(&["1.4 0.2 10 0.0 0.5"])).unwrap();
    folder.refuses(&profile(&["thin.mci", "--models", "dipole"]), 2, "dipole is a model of a half-space");
    folder.refuses(&profile(&["thin.mci", "--sweep", "g=0:0.5:2"]), 2, "--sweep is of half-spaces");
    folder.refuses(&profile(&["thin.mci", "--g", "0.5"]), 2, "leave out --g and --ior");
}

#[test]
fn lengths_that_are_hardly_meant_are_said() {
    let folder = Folder::new();
    let (stdout, stderr) = folder
        .run(&profile(&["--sigma-a", "0.0041", "--sigma-s", "2.62", "--models", "dipole"]))
        .ends_with(0);
    assert!(stderr.contains("warning: ") && stderr.contains("multiply them by 1000"), "{stderr}");
    assert!(stdout.contains("mean free path 381.1 mm"), "{stdout}");
}

#[test]
fn too_large_errors_end_with_1_after_everything_is_written() {
    let folder = Folder::new();
    let arguments = ["--sigma-a", "100", "--sigma-s", "900", "--models", "dipole"];
    let (_, stderr) = folder.run(&profile(&[&arguments[..], &["--max-error", "0.05"]].concat())).ends_with(1);
    assert!(stderr.contains("failed: L1 error above --max-error 0.05: dipole"), "{stderr}");
    assert_eq!(outputs(&folder).len(), 7);
    folder.run(&profile(&[&arguments[..], &["--max-error", "3"]].concat())).ends_with(0);
}

#[test]
fn sweeps_are_written() {
    let folder = Folder::new();
    let sweep = folder.run(&profile(&["--sweep", "albedo=0.5:1:3", "--models", "dipole", "--json"])).report();
    assert_eq!(sweep["parameter"], "albedo");
    assert_eq!(sweep["points"].as_array().unwrap().len(), 3);
    // Without absorption everything comes back.
    assert_eq!(sweep["points"][2]["truth"]["exact_albedo"], 1.0);
    assert_eq!(outputs(&folder), ["sweep.csv", "sweep.json", "sweep.svg"]);
    for (sweep, value) in [("g=0:0.8:2", "0.8"), ("ior=1:1.5:2", "1.5")] {
        folder.run(&profile(&["--sweep", sweep, "--models", "dipole", "--quiet"])).ends_with(0);
        let csv = fs::read_to_string(folder.path("out/sweep.csv")).unwrap();
        assert!(csv.lines().last().unwrap().starts_with(value), "{csv}");
    }
}

#[test]
fn fits_are_written() {
    let folder = Folder::new();
    folder
        .run(&profile(&["--sigma-a", "20", "--sigma-s", "1500", "--ior", "1.4", "--models", "photon-beam"]))
        .ends_with(0);
    let written = fs::read_to_string(folder.path("out/profile.csv")).unwrap();
    // The model's own curve, in the columns that a measurement has.
    let rows = written.lines().filter(|line| line.contains(",photon-beam,")).map(|line| {
        let fields: Vec<&str> = line.split(',').collect();
        format!("{},{}\n", fields[5], fields[6])
    });
    let rows: String = rows.skip(20).take(30).collect();
    fs::write(folder.path("measured.csv"), format!("radius_mm,reflectance_per_mm2\n{rows}")).unwrap();
    let fit = folder
        .run(&profile(&["--fit", "measured.csv", "--ior", "1.4", "--models", "photon-beam", "--json"]))
        .report();
    // Means over rings are not values at their middles: 1 % of the curve.
    for (key, expected) in [("sigma_s_reduced", 1500.0), ("sigma_a", 20.0)] {
        let value = fit[key]["value"].as_f64().unwrap();
        assert!((value / expected - 1.0).abs() < 0.05, "{key} {value}");
        assert!(fit[key]["stderr"].as_f64().unwrap() > 0.0);
    }
    assert!(outputs(&folder).iter().any(|name| name == "fit.svg"));
}

#[test]
fn wrong_command_lines_are_refused() {
    let folder = Folder::new();
    fs::write(folder.path("bad.csv"), "radius_mm,reflectance\n1,x\n").unwrap();
    let cases: [(&[&str], &str); 24] = [
        (&[], "which material?"),
        (&["marbel"], "did you mean `Marble`?"),
        (&["marble", "--density", "-1"], "density is -1"),
        (&["--density", "2", "--sigma-a", "1", "--sigma-s", "1"], "--density goes with a measured material"),
        (&["marble", "--sigma-a", "1"], "given twice"),
        (&["--sigma-a", "1"], "--sigma-a goes with --sigma-s"),
        (&["--mean-free-path", "1"], "--mean-free-path goes with --albedo"),
        (&["--sigma-a", "-1", "--sigma-s", "1"], "sigma_a is -1"),
        (&["--sigma-a", "1", "--sigma-s", "NaN"], "sigma_s is NaN"),
        (&["--sigma-a", "1,2", "--sigma-s", "1"], "sigma_a has 2 values"),
        (&["--sigma-a", "1", "--sigma-s", "1", "--g", "1"], "g is 1"),
        (&["--sigma-a", "1", "--sigma-s", "1", "--ior", "0"], "eta is 0"),
        (&["--albedo", "1.2", "--mean-free-path", "1"], "albedo is 1.2"),
        (&["--albedo", "0.5", "--mean-free-path", "0"], "mean_free_path is 0"),
        (&["marble", "--models", "tripole"], "no model `tripole`"),
        (&["marble", "--photons", "0"], "--photons"),
        (&["marble", "--max-error", "-1"], "a number above 0 is wanted"),
        (&["marble", "--cutoff", "NaN"], "a number above 0 is wanted"),
        (&["marble", "--sweep", "albedo=0:1:3"], "albedo from 0 to 1"),
        (&["marble", "--sweep", "g=0:0.5:3"], "--sweep is of one channel"),
        (&["--fit", "missing.csv"], "missing.csv: cannot be read"),
        (&["--fit", "bad.csv"], "bad.csv: line 2: reflectance is `x`"),
        (&["marble", "--fit", "bad.csv"], "--fit finds the material"),
        (&["missing.mci"], "missing.mci: cannot be read"),
    ];
    for (arguments, part) in cases {
        folder.refuses(&profile(arguments), 2, part);
    }
}

#[test]
fn a_directory_that_cannot_be_made_is_a_failure_of_the_machine() {
    let folder = Folder::new();
    fs::write(folder.path("out"), "a file").unwrap();
    let (_, stderr) = folder.run(&profile(&["marble"])).ends_with(3);
    assert!(stderr.contains("out: the directory cannot be made"), "{stderr}");
}

#[cfg(unix)]
#[test]
fn an_interrupt_ends_with_130() {
    use std::time::Duration;

    use program::run_interrupted;

    let folder = Folder::new();
    let arguments = ["profile", "marble", "-o", "out", "--photons", "20000000", "--threads", "1"];
    let run = run_interrupted(&folder.path(""), &arguments, "walking photons", Duration::ZERO);
    assert_eq!(run.code, 130);
    assert!(run.stderr.lines().any(|line| line.starts_with("interrupted")), "{run:?}");
}
