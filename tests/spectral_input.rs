//! What a scene file may say by wavelength: dispersion, lamps and media. Every mistake is answered with its place and what is wrong.

#[path = "common/program.rs"]
#[allow(dead_code)]
mod program;

use std::fs;
use std::path::Path;

use alabaster::radiometry::spectrum::dispersion::Dispersion;
use alabaster::scene::{Scene, SceneError, Surface, read_scene};
use program::Folder;

const SPHERE: &str = "[[object]]\nshape = 'sphere'\ncenter = [0, 0, 0]\nradius = 1\nmaterial = 'm'\n";
const LIGHT: &str = "[environment]\nradiance = 1\n";
const CAMERA: &str = "[camera]\nposition = [0, 0, 4]\ntarget = [0, 0, 0]\n";
/// Lines before what a test adds.
const LINES: usize = 10;

fn text(more: &str) -> String {
    [SPHERE, LIGHT, CAMERA, more].concat()
}

fn read_in(folder: &Path, more: &str) -> Result<Scene, SceneError> {
    let path = folder.join("scene.toml");
    fs::write(&path, text(more)).unwrap();
    read_scene(&path)
}

fn read(more: &str) -> Result<Scene, SceneError> {
    read_in(tempfile::tempdir().unwrap().path(), more)
}

/// Index and dispersion of a clear material.
fn clear(kind: &str, keys: &str) -> (f32, Option<Dispersion>) {
    let scene = read(&format!("[material.m]\ntype = '{kind}'\n{keys}\n")).expect(keys);
    match &scene.materials[0].surface {
        Surface::Dielectric { ior, dispersion, .. } => (*ior, *dispersion),
        Surface::MetallicRoughness(m) => (m.ior, m.dispersion),
        other => panic!("{other:?}"),
    }
}

/// Schott N-SF11 (data sheet 785257.322).
const FLINT: &str =
    "sellmeier = { b = [1.73759695, 0.313747346, 1.89878101], c = [0.013188707, 0.0623068142, 155.23629] }";

#[test]
fn dispersion_is_given_in_three_ways() {
    for kind in ["dielectric", "gltf"] {
        assert_eq!(clear(kind, ""), (1.5, None));
        let (ior, glass) = clear(kind, "ior = 1.625\nabbe = 36");
        assert_eq!((ior, glass), (1.625, Some(Dispersion::from_abbe(1.625, 36.0).unwrap())));
        let (ior, glass) = clear(kind, "cauchy = [1.5046, 4200, 0]");
        assert_eq!(glass, Some(Dispersion::cauchy([1.5046, 4200.0, 0.0]).unwrap()));
        // 1.5046 + 4200/587.5618², rounded to single precision.
        assert_eq!(ior, (1.5046 + 4200.0 / (587.5618_f64 * 587.5618)) as f32);
        let (ior, glass) = clear(kind, FLINT);
        // To the five and four digits of the data sheet.
        assert!((ior - 1.784_72).abs() < 6e-6, "{ior}");
        assert!((glass.unwrap().abbe() - 25.68).abs() < 6e-3, "{glass:?}");
        // The same index again is no contradiction.
        assert_eq!(clear(kind, &format!("ior = 1.785\n{FLINT}")), (ior, glass));
    }
}

/// What is wrong with a clear material, its line and its key, and part of the message.
const NO_GLASS: [(&str, usize, &str, &str); 13] = [
    ("abbe = 0", 3, ".abbe", "an Abbe number of 0; it must be finite and above 0"),
    ("abbe = -30", 3, ".abbe", "an Abbe number of -30"),
    ("abbe = nan", 3, ".abbe", "finite"),
    ("abbe = 0.1", 3, ".abbe", "an index of refraction of"),
    ("abbe = '30'", 3, ".abbe", "expected a number"),
    ("abbe = 30\ncauchy = [1.5, 4200, 0]", 4, ".cauchy", "excludes `abbe`"),
    ("cauchy = [1.5, 4200]", 3, ".cauchy", "expected 3 numbers, found 2"),
    ("cauchy = [-1.5, 4200, 0]", 3, ".cauchy", "an index of refraction of -1.4"),
    ("sellmeier = { b = [1, 0, 0] }", 3, ".sellmeier", "the key `c` is missing"),
    ("sellmeier = { b = [1, 0, 0], c = [0.25, 0, 0] }", 3, ".sellmeier", "a resonance at 500 nm"),
    ("sellmeier = { b = [-2, 0, 0], c = [0.01, 0, 0] }", 3, ".sellmeier", "an index of refraction of NaN"),
    ("sellmeier = { b = [1, 0, 0], d = [0, 0, 0] }", 3, ".sellmeier.d", "unknown key `d`"),
    (
        "ior = 1.6\ncauchy = [1.5, 4200, 0]",
        3,
        ".ior",
        "1.6 contradicts the coefficients of the dispersion, by which it is 1.5122",
    ),
];

#[test]
fn what_is_no_glass_is_refused_by_name() {
    for (keys, line, key, problem) in NO_GLASS {
        let error = read(&format!("[material.m]\ntype = 'dielectric'\n{keys}\n")).expect_err(keys);
        let place = format!("line {}, material.m{key}", LINES + line);
        assert!(error.place == place && error.problem.contains(problem), "{keys}: {error}");
    }
}

#[test]
fn the_program_says_what_is_wrong_and_ends_with_2() {
    let folder = Folder::new();
    for (more, part) in
        [("[material.m]\ntype = 'dielectric'\nabbe = 0\n", "material.m.abbe: an Abbe number of 0")]
    {
        fs::write(folder.path("scene.toml"), text(more)).unwrap();
        folder.refuses(&["render", "scene.toml", "-o", "a.exr"], 2, part);
        folder.refuses(&["plan", "scene.toml"], 2, part);
    }
}
