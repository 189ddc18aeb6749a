//! `alabaster compare`: numbers, exit codes, JSON, the heat map, and what is refused.

#[path = "common/program.rs"]
#[allow(dead_code)]
mod program;

use std::fs::{self, File};

use alabaster::film::Picture;
use alabaster::film::exr::{self, PictureFile, read_picture};
use alabaster::film::layers::Channel;
use alabaster::radiometry::Rgb;
use program::{Folder, SCENE};
use serde_json::{Value, json};

/// Offset in the denominators of relMSE and MAPE, as the guide states it.
const OFFSET: f64 = 0.01;

/// Renders [`SCENE`] to `a.exr` and `b.exr`, which differ in the seed, with layers of the variance.
fn two_seeds() -> Folder {
    let folder = Folder::new();
    fs::write(folder.path("scene.toml"), SCENE).unwrap();
    let options = ["--width", "24", "--height", "18", "--spp", "64", "--aov", "variance", "--quiet"];
    for (name, seed) in [("a.exr", "1"), ("b.exr", "2")] {
        let render = ["render", "scene.toml", "-o", name, "--seed", seed];
        folder.run(&[&render[..], &options].concat()).ends_with(0);
    }
    folder
}

fn write(folder: &Folder, name: &str, width: u32, pixels: &[Rgb], channels: &[Channel]) {
    let picture = Picture { width, height: pixels.len() as u32 / width, pixels: pixels.to_vec() };
    exr::write(&mut File::create(folder.path(name)).unwrap(), &picture, channels, &[]).unwrap();
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

#[test]
fn two_seeds_differ_by_their_noise() {
    let folder = two_seeds();
    let found = folder.run(&["compare", "a.exr", "b.exr", "--json"]).report();
    for key in ["mse", "relmse", "mape", "relmse_of_noise"] {
        assert!(found[key].as_f64().unwrap() > 0.0, "{key}");
    }
    for key in ["mean_a", "mean_b", "bias", "mean_a_stderr", "mean_b_stderr", "bias_stderr"] {
        assert_eq!(numbers(&found[key]).len(), 3, "{key}");
    }
    assert_eq!((&found["nonfinite_a"], &found["nonfinite_b"]), (&json!(0), &json!(0)));
    assert_eq!((&found["pixels"], &found["confidence"]), (&json!(24 * 18), &json!(0.95)));
    let (bias, sigma) = (numbers(&found["bias"]), numbers(&found["bias_stderr"]));
    for channel in 0..3 {
        assert!(bias[channel].abs() <= 3.0 * sigma[channel], "{found}");
        let interval = numbers(&found["bias_interval"][channel]);
        assert!(interval[0] < bias[channel] && bias[channel] < interval[1]);
    }

    let [a, b] = ["a.exr", "b.exr"].map(|name| exr::read(&folder.path(name)).unwrap());
    let terms = noise_of_relmse(&a, &b);
    let count = terms.len() as f64;
    let noise = terms.iter().sum::<f64>() / count;
    // Sums of the same terms in another order, and what JSON keeps of them.
    assert!((found["relmse_of_noise"].as_f64().unwrap() / noise - 1.0).abs() < count * f64::EPSILON);
    // The square of a difference that is normal with variance v has variance 2v². The variances take samples for
    // independent, and those of a low-discrepancy sequence are better than that: there is no such lower bound.
    let spread = (2.0 * terms.iter().map(|term| term * term).sum::<f64>()).sqrt() / count;
    assert!(found["relmse"].as_f64().unwrap() < noise + 3.0 * spread, "{found}");
}

/// What the variances foretell of the relative squared error, by pixel and channel.
fn noise_of_relmse(a: &PictureFile, b: &PictureFile) -> Vec<f64> {
    let (in_a, in_b) = (a.variance.as_ref().unwrap(), b.variance.as_ref().unwrap());
    let pixels = in_a.iter().zip(in_b).zip(&b.picture.pixels);
    pixels
        .flat_map(|((a, b), pixel)| {
            [0, 1, 2].map(|c| (f64::from(a[c]) + f64::from(b[c])) / (f64::from(pixel[c]).powi(2) + OFFSET))
        })
        .collect()
}

#[test]
fn numbers_are_those_of_the_pixels() {
    let folder = two_seeds();
    let found = folder.run(&["compare", "a.exr", "b.exr", "--json"]).report();
    let [a, b] = ["a.exr", "b.exr"].map(|name| read_picture(&folder.path(name)).unwrap());
    let pairs = a.pixels.iter().zip(&b.pixels).flat_map(|(a, b)| a.0.into_iter().zip(b.0));
    let pairs: Vec<(f64, f64)> = pairs.map(|(a, b)| (f64::from(a), f64::from(b))).collect();
    let mean = |term: &dyn Fn(f64, f64) -> f64| {
        pairs.iter().map(|&(a, b)| term(a, b)).sum::<f64>() / pairs.len() as f64
    };
    // Sums of the same terms in another order.
    let rounding = pairs.len() as f64 * f64::EPSILON;
    for (key, expected) in [
        ("mse", mean(&|a, b| (a - b).powi(2))),
        ("relmse", mean(&|a, b| (a - b).powi(2) / (b * b + OFFSET))),
        ("mape", mean(&|a, b| (a - b).abs() / (b.abs() + OFFSET))),
    ] {
        assert!((found[key].as_f64().unwrap() / expected - 1.0).abs() < rounding, "{key}");
    }
    let largest = pairs.iter().map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    // The reader of JSON may be some ulps off.
    let difference = found["largest"]["difference"].as_f64().unwrap();
    assert!((difference / largest - 1.0).abs() < 4.0 * f64::EPSILON, "{difference}, not {largest}");
    let at = |key: &str| found["largest"][key].as_u64().unwrap() as usize;
    assert_eq!(numbers(&found["largest"]["a"])[0] as f32, a.pixels[24 * at("y") + at("x")][0]);
    let flip = found["flip"]["mean"].as_f64().unwrap();
    assert!(0.0 < flip && flip < found["flip"]["max"].as_f64().unwrap());

    let same = folder.run(&["compare", "a.exr", "a.exr", "--json"]).report();
    assert_eq!((&same["mse"], &same["relmse"], &same["mape"]), (&json!(0.0), &json!(0.0), &json!(0.0)));
    assert_eq!((&same["bias"], &same["flip"]["max"]), (&json!([0.0, 0.0, 0.0]), &json!(0.0)));
}

#[test]
fn the_limit_decides_the_exit_code_after_everything_is_said() {
    let folder = two_seeds();
    let limited = |limit| folder.run(&["compare", "a.exr", "b.exr", "--max-relmse", limit]);
    let (table, message) = limited("1e-9").ends_with(1);
    for part in [
        "a.exr against b.exr, 432 pixels",
        "mean of A",
        "green",
        " ± ",
        "relMSE",
        "MAPE",
        "FLIP",
        "± holds 95 %",
    ] {
        assert!(table.contains(part), "no {part:?} in {table}");
    }
    assert!(
        message.starts_with("failed: relMSE ") && message.contains("above --max-relmse 1e-9"),
        "{message}"
    );
    assert_eq!(limited("1").ends_with(0), (table, String::new()));
    folder.run(&["compare", "a.exr", "a.exr", "--max-relmse", "0"]).ends_with(0);
    let quiet = folder.run(&["compare", "a.exr", "b.exr", "--quiet", "--no-flip"]).ends_with(0);
    assert_eq!(quiet, (String::new(), String::new()));
}

#[test]
fn the_heat_map_shows_where() {
    let folder = Folder::new();
    let reference = vec![Rgb::ONE; 24 * 18];
    let mut pixels = reference.clone();
    pixels[24 * 17] = Rgb::splat(2.0);
    pixels[23] = Rgb::splat(f32::NAN);
    write(&folder, "a.exr", 24, &pixels, &[]);
    write(&folder, "b.exr", 24, &reference, &[]);
    let arguments = ["compare", "a.exr", "b.exr", "--json", "--heat-map", "map.png"];
    let (stdout, stderr) = folder.run(&arguments).ends_with(0);
    let found: Value = serde_json::from_str(&stdout).unwrap();
    // One pixel in 431 is more than a thousandth; its error is 1/1.01.
    assert_eq!(found["heat_map"], json!({"from": 1e-4, "to": 1.0}));
    assert!(stderr.contains("map.png: relative squared error from 1e-4 (dark) to 1e0 (yellow)"), "{stderr}");
    let map = image::open(folder.path("map.png")).unwrap().to_rgb8();
    // Pixels are ten wide and high.
    assert_eq!(map.width(), 240);
    let colors = [(5, 175), (235, 5), (5, 5)].map(|(x, y)| map.get_pixel(x, y).0);
    // By its logarithm the error stands at 0.999 of viridis; each channel is within a step of the end.
    let near = colors[0].iter().zip([254, 232, 37]).all(|(&c, end)| i32::from(c).abs_diff(end) <= 1);
    assert!(near, "{colors:?}");
    assert_eq!(colors[1..], [[255, 0, 144], [68, 1, 84]]);
}

#[test]
fn what_is_not_finite_is_counted_and_said() {
    let folder = Folder::new();
    let mut pixels = [Rgb::splat(0.5); 12];
    write(&folder, "b.exr", 4, &pixels, &[]);
    pixels[3] = Rgb::new(0.5, f32::NAN, 0.5);
    pixels[7] = Rgb::splat(f32::INFINITY);
    write(&folder, "a.exr", 4, &pixels, &[]);
    let (stdout, stderr) = folder.run(&["compare", "a.exr", "b.exr", "--json"]).ends_with(0);
    let found: Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!((&found["nonfinite_a"], &found["nonfinite_b"]), (&json!(2), &json!(0)));
    assert_eq!(
        (&found["pixels"], &found["mse"], &found["flip"]["max"]),
        (&json!(10), &json!(0.0), &json!(0.0))
    );
    assert!(stderr.contains("warning: a.exr: 2 pixels are not finite"), "{stderr}");
    // No layers of the variance: the noise is unknown.
    assert_eq!(found["relmse_of_noise"], Value::Null);
    assert_eq!(found["bias_interval"], json!([null, null, null]));
    write(&folder, "none.exr", 4, &[Rgb::splat(f32::NAN); 12], &[]);
    let message = "none.exr and b.exr: no pixel is finite in both pictures: 12 of 12";
    folder.refuses(&["compare", "none.exr", "b.exr"], 2, message);
}

#[test]
fn a_reference_without_variance_is_exact() {
    let folder = Folder::new();
    let channels =
        ["variance.R", "variance.G", "variance.B"].map(|name| Channel { name, values: vec![4.0; 16] });
    write(&folder, "a.exr", 4, &[Rgb::splat(2.0); 16], &channels);
    write(&folder, "b.exr", 4, &[Rgb::ONE; 16], &[]);
    let found = folder.run(&["compare", "a.exr", "b.exr", "--json"]).report();
    assert_eq!((&found["bias"], &found["bias_stderr"]), (&json!([1.0, 1.0, 1.0]), &json!([0.5, 0.5, 0.5])));
    assert_eq!(found["mean_b_stderr"], json!([null, null, null]));
    let (table, _) = folder.run(&["compare", "a.exr", "b.exr"]).ends_with(0);
    assert!(table.contains("the picture without them counts as exact"), "{table}");
}

/// A picture by another program: half floats with alpha, `width` × 2 pixels from column `left` of a frame of 6 × 4.
fn write_foreign(folder: &Folder, name: &str, left: i32, width: usize, red: &str) {
    use ::exr::prelude::*;

    let values = |value: f32| FlatSamples::F16(vec![f16::from_f32(value); 2 * width]);
    let channels = [(red, 0.25), ("G", 0.5), ("B", 0.75), ("A", 1.0)];
    let channels = channels.into_iter().map(|(name, value)| AnyChannel::new(name, values(value))).collect();
    let attributes = LayerAttributes { layer_position: Vec2(left, 1), ..LayerAttributes::default() };
    let layer = Layer::new((width, 2), attributes, Encoding::FAST_LOSSLESS, AnyChannels::sort(channels));
    let mut image = Image::from_layer(layer);
    image.attributes.display_window = IntegerBounds::new((0, 0), (6, 4));
    image.write().to_file(folder.path(name)).unwrap();
}

#[test]
fn parts_of_a_frame_are_compared_where_they_meet() {
    let folder = Folder::new();
    write_foreign(&folder, "left.exr", 0, 4, "R");
    write_foreign(&folder, "right.exr", 3, 3, "R");
    let mut pixels = [Rgb::new(0.25, 0.5, 0.75); 24];
    pixels[6 + 3] = Rgb::new(0.25, 0.5, 1.75);
    write(&folder, "whole.exr", 6, &pixels, &[]);
    let compare = |a, b| folder.run(&["compare", a, b, "--json"]);
    let (stdout, stderr) = compare("left.exr", "whole.exr").ends_with(0);
    let found: Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!((&found["pixels"], &found["mse"]), (&json!(8), &json!(1.0 / 24.0)));
    assert!(
        stderr.contains("only what both have is compared, 4 × 2 pixels from column 0, row 1"),
        "{stderr}"
    );
    assert_eq!(compare("left.exr", "right.exr").report()["pixels"], 2);
    write_foreign(&folder, "far.exr", 4, 2, "R");
    let message = "left.exr and far.exr show different parts of a frame";
    folder.refuses(&["compare", "left.exr", "far.exr"], 2, message);
}

#[test]
fn wrong_files_and_commands_are_refused() {
    let folder = Folder::new();
    write(&folder, "a.exr", 4, &[Rgb::ONE; 12], &[]);
    write(&folder, "wide.exr", 6, &[Rgb::ONE; 12], &[]);
    write_foreign(&folder, "layer.exr", 0, 6, "ViewLayer.Combined.R");
    fs::write(folder.path("text.exr"), "not OpenEXR").unwrap();
    let whole = fs::read(folder.path("a.exr")).unwrap();
    fs::write(folder.path("cut.exr"), &whole[..whole.len() - 9]).unwrap();
    let cases: [(&[&str], &str); 11] = [
        (&["a.exr"], "<B>"),
        (&["a.exr", "wide.exr"], "a.exr is a picture of 4 × 3 pixels, wide.exr of 6 × 2 pixels; render one"),
        (&["a.exr", "missing.exr"], "missing.exr: cannot be read"),
        (&["a.exr", "text.exr"], "text.exr: is not an OpenEXR file"),
        (&["cut.exr", "a.exr"], "cut.exr: is not an OpenEXR file that can be read"),
        (
            &["layer.exr", "a.exr"],
            "layer.exr: is an OpenEXR file without channels R, G, B or Y; it has A, B, G, ViewLayer",
        ),
        (&["a.exr", "a.exr", "--max-relmse", "-1"], "a number, 0 or above, is wanted"),
        (&["a.exr", "a.exr", "--max-relmse", "NaN"], "a number, 0 or above, is wanted"),
        (&["a.exr", "a.exr", "--max-relmse", "much"], "--max-relmse"),
        (&["a.exr", "a.exr", "--heat-map", "map.exr"], "map.exr: a heat map is written as .png"),
        (&["a.exr", "a.exr", "--heat-map", "map"], "choose one of these endings"),
    ];
    for (arguments, part) in cases {
        folder.refuses(&[&["compare"], arguments].concat(), 2, part);
    }
    folder.refuses(&["compare", "a.exr", "a.exr", "--heat-map", "missing/map.png"], 3, "missing/map.png");
}
