//! What a scene file may say by wavelength: dispersion, lamps and media. Every mistake is answered with its place and what is wrong.

#[path = "common/program.rs"]
#[allow(dead_code)]
mod program;

use std::fs;
use std::path::Path;

use alabaster::radiometry::Rgb;
use alabaster::radiometry::spectrum::dispersion::Dispersion;
use alabaster::radiometry::spectrum::lamp::Lamp;
use alabaster::radiometry::spectrum::medium_table::MediumTable;
use alabaster::scene::{Light, ScatteringInput, Scene, SceneError, Source, Surface, read_scene};
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

fn lamp(keys: &str) -> Light {
    read(&format!("[material.m]\ntype = 'diffuse'\n[[light]]\n{keys}\n")).expect(keys).lights.remove(0)
}

/// Every kind of light, and the key of its strength.
const LIGHTS: [(&str, &str); 6] = [
    ("type = 'quad'\nposition = [0, 4, 0]\ntarget = [0, 0, 0]\nsize = [3, 1]", "radiance"),
    ("type = 'disk'\nposition = [0, 4, 0]\ntarget = [0, 0, 0]\nradius = 0.5", "radiance"),
    ("type = 'sphere'\ncenter = [0, 4, 0]\nradius = 0.5", "radiance"),
    ("type = 'point'\nposition = [0, 4, 0]", "intensity"),
    ("type = 'spot'\nposition = [0, 4, 0]\ntarget = [0, 0, 0]\nangle = 40", "intensity"),
    ("type = 'directional'\ndirection = [0, -1, 0]", "irradiance"),
];

#[test]
fn every_kind_of_light_can_be_a_lamp() {
    for (keys, strength) in LIGHTS {
        let white = lamp(&format!("{keys}\n{strength} = 3"));
        assert_eq!((white.emitted().rgb, white.emitted().source), (Rgb::splat(3.0), Source::Color));
        for (law, expected) in [
            ("temperature = 2856", Lamp::blackbody(2856.0)),
            ("temperature = 1200.5", Lamp::blackbody(1200.5)),
            ("illuminant = 'D50'", Lamp::illuminant("D50")),
        ] {
            let expected = expected.unwrap();
            let light = lamp(&format!("{keys}\n{strength} = 3\n{law}"));
            let emitted = light.emitted();
            assert_eq!(emitted.source, Source::Lamp(expected), "{keys}");
            // As bright as white: a rounding of each channel.
            let luminance = emitted.luminance();
            assert!((luminance - 3.0).abs() < 3.0 * f64::from(f32::EPSILON), "{keys} {law}: {luminance}");
            assert_eq!(emitted.rgb, expected.rgb() * 3.0);
            assert_eq!(emitted.source.relative_power(550.0), Some(expected.relative_power(550.0)));
        }
        if strength != "irradiance" {
            let of_power = |law: &str| lamp(&format!("{keys}\npower = 7\n{law}"));
            let (plain, warm) = (of_power(""), of_power("temperature = 2856"));
            assert_eq!(warm.emitted().rgb, Lamp::blackbody(2856.0).unwrap().rgb() * plain.emitted().rgb[0]);
        }
    }
}

/// What is wrong with a light, its line after the first and its key, and part of the message.
const NO_LAMP: [(&str, usize, &str, &str); 12] = [
    (
        "radiance = 1\ntemperature = 0",
        4,
        ".temperature",
        "a temperature of 0 K; it must be finite and above 0",
    ),
    ("radiance = 1\ntemperature = -2856", 4, ".temperature", "a temperature of -2856 K"),
    ("radiance = 1\ntemperature = inf", 4, ".temperature", "must be a finite number"),
    ("radiance = 1\ntemperature = 1", 4, ".temperature", "a temperature of 1 K; a body shines visibly"),
    ("radiance = 1\ntemperature = 1e300", 4, ".temperature", "a temperature of"),
    ("radiance = 1\ntemperature = '6500'", 4, ".temperature", "expected a number"),
    ("radiance = 1\nilluminant = 'D60'", 4, ".illuminant", "\"D60\" is no illuminant; known are A, D50"),
    ("radiance = 1\nilluminant = 65", 4, ".illuminant", "expected text"),
    ("radiance = [1, 1, 1]\nilluminant = 'A'", 3, ".radiance", "must be one number"),
    ("power = [1, 1, 1]\ntemperature = 3000", 3, ".power", "must be one number"),
    ("radiance = 1\ntemperature = 3000\nilluminant = 'A'", 5, ".illuminant", "excludes `temperature`"),
    ("radiance = 3e38\ntemperature = 1000", 0, "", "brighter than can be computed"),
];

#[test]
fn what_is_no_lamp_is_refused_by_name() {
    for (keys, line, key, problem) in NO_LAMP {
        let light = "[[light]]\ntype = 'sphere'\ncenter = [0, 4, 0]\nradius = 0.5\n";
        let error = read(&format!("[material.m]\ntype = 'diffuse'\n{light}{keys}\n")).expect_err(keys);
        let line = LINES + 2 + if line == 0 { 1 } else { line + 2 };
        let place = format!("line {line}, light[0]{key}");
        assert!(error.place == place && error.problem.contains(problem), "{keys}: {error}, not {place}");
    }
}

/// A table in `skin.csv` and a translucent material that names it; `keys` are the material's other ones.
fn read_medium(table: &str, keys: &str) -> Result<Scene, SceneError> {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("skin.csv"), table).unwrap();
    read_in(folder.path(), &format!("[material.m]\ntype = 'translucent'\nspectrum = 'skin.csv'\n{keys}\n"))
}

/// Index, coefficients seen by the channels, mean cosine and table of what was read.
fn spectral(scene: &Scene) -> (f32, Rgb, Rgb, f32, &MediumTable) {
    match &scene.materials[0].surface {
        Surface::Translucent {
            ior,
            medium: ScatteringInput::Spectral { sigma_a, sigma_s, g, table },
            ..
        } => (*ior, *sigma_a, *sigma_s, *g, table),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_medium_is_read_from_a_table() {
    let table = "# skin\nwavelength [nm], mu_a [1/cm], mu_s_reduced [1/mm], g, n\n400, 5, 6, 0.8, 1.4\n700, 1, 2, 0.8, 1.4\n";
    let scene = read_medium(table, "roughness = 0.3").unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let (ior, sigma_a, sigma_s, g, table) = spectral(&scene);
    assert_eq!((ior, g), (1.4, 0.8));
    // Half-way between the rows, in 1/m; 1 − g loses a digit of sixteen to rounding.
    let middle = table.similar(550.0, f64::from(g));
    assert!((middle.mu_a - 300.0).abs() < 1e-9 && (middle.mu_s * (1.0 - f64::from(g)) - 4000.0).abs() < 1e-9);
    // Within the table, and in the order of the wavelengths that the channels see.
    for (sigma, low, high) in [(sigma_a, 100.0, 500.0), (sigma_s, 1e4, 3e4)] {
        assert!(low < sigma[0] && sigma[0] < sigma[1] && sigma[1] < sigma[2] && sigma[2] < high, "{sigma:?}");
    }
}

#[test]
fn a_constant_medium_is_what_its_coefficients_say() {
    for (columns, row, keys, expected) in [
        ("mu_a,mu_s", "2,300", "", (1.5, 2.0, 300.0, 0.0)),
        ("mu_a,mu_s", "2,300", "g = 0.5\nior = 1.33", (1.33, 2.0, 300.0, 0.5)),
        ("mu_a,mu_s_reduced", "2,300", "g = 0.5", (1.5, 2.0, 600.0, 0.5)),
        ("mu_a,mu_s_reduced,g,n", "2,300,0.75,1.4", "", (1.4, 2.0, 1200.0, 0.75)),
        ("mu_a,mu_s_reduced,n", "2,300,1.4", "ior = 1.33", (1.33, 2.0, 300.0, 0.0)),
    ] {
        let scene = read_medium(&format!("wavelength,{columns}\n550,{row}\n"), keys).unwrap();
        let (ior, sigma_a, sigma_s, g, _) = spectral(&scene);
        assert_eq!((ior, g), (expected.0, expected.3), "{columns} {keys}");
        for channel in 0..3 {
            // A rounding to single precision.
            assert!(
                (sigma_a[channel] / expected.1 - 1.0).abs() <= f32::EPSILON,
                "{columns} {keys}: {sigma_a:?}"
            );
            assert!(
                (sigma_s[channel] / expected.2 - 1.0).abs() <= f32::EPSILON,
                "{columns} {keys}: {sigma_s:?}"
            );
        }
    }
}

#[test]
fn what_is_taken_for_constant_and_is_not_is_said() {
    let warnings = |g: [f64; 2], n: [f64; 2]| {
        let row = |i: usize| format!("{},1,100,{},{}\n", 400 + 300 * i, g[i], n[i]);
        let table = format!("wavelength,mu_a,mu_s,g,n\n{}{}", row(0), row(1));
        read_medium(&table, "").unwrap().warnings.join("\n")
    };
    assert_eq!(warnings([0.8, 0.81], [1.4, 1.405]), "");
    let said = warnings([0.7, 0.9], [1.4, 1.405]);
    assert_eq!(
        said,
        "material `m`: g of skin.csv goes from 0.7 to 0.9; 0.8000, that at 550 nm, stands for all wavelengths, reduced scattering kept"
    );
    let said = warnings([0.8, 0.8], [1.36, 1.42]);
    assert_eq!(
        said,
        "material `m`: n of skin.csv goes from 1.36 to 1.42; 1.3900, that at 550 nm, stands for all wavelengths"
    );
    let clear = read_medium("wavelength,mu_a,mu_s\n400,1,0\n700,3,0\n", "").unwrap().warnings;
    assert!(clear.concat().contains("nothing scatters in skin.csv"), "{clear:?}");
}

/// Tables that are none, and the line and part of the message.
const NO_TABLE: [(&str, &str, &str); 15] = [
    ("", "line 1", "there is no row"),
    ("wavelength,mu_a,mu_s\n", "line 1", "there is no row"),
    ("wavelength,mu_a\n550,1\n", "line 1", "there is no mu_s or mu_s_reduced"),
    ("wavelength,mua,mu_s\n550,1,1\n", "line 1", "\"mua\" is no column"),
    ("wavelength,mu_a [1/in],mu_s\n550,1,1\n", "line 1", "\"1/in\" is no unit of mu_a"),
    ("wavelength,mu_a,mu_s\n350,1,1\n", "line 2", "wavelength: 350 nm is out of range"),
    ("wavelength,mu_a,mu_s\n550,1,1\n1000,1,1\n", "line 3", "wavelength: 1000 nm is out of range"),
    ("wavelength,mu_a,mu_s\n550,1,1\n\n# red\n540,1,1\n", "line 5", "wavelength: 540 nm comes after 550 nm"),
    ("wavelength,mu_a,mu_s\n550,1,1\n550,2,1\n", "line 3", "wavelength: 550 nm is there already"),
    ("wavelength,mu_a,mu_s\n550,-1,1\n", "line 2", "mu_a: -1 at 550 nm; it must be finite and not negative"),
    ("wavelength,mu_a,mu_s\n550,1,-2\n", "line 2", "mu_s: -2 at 550 nm"),
    ("wavelength,mu_a,mu_s_reduced\n550,1,inf\n", "line 2", "mu_s_reduced: inf at 550 nm"),
    ("wavelength,mu_a,mu_s\n550,1,x\n", "line 2", "\"x\" is no number (mu_s)"),
    ("wavelength,mu_a,mu_s,g\n550,1,1,1\n", "line 2", "g = 1; it must lie between"),
    ("wavelength,mu_a,mu_s,n\n550,1,1,0\n", "line 2", "n = 0"),
];

#[test]
fn what_is_no_table_is_refused_by_name() {
    for (table, line, problem) in NO_TABLE {
        let error = read_medium(table, "").expect_err(table);
        assert!(error.file.ends_with("skin.csv"), "{error}");
        assert!(error.place == line && error.problem.contains(problem), "{table}: {error}");
    }
    let two = read_medium("wavelength,mu_a,mu_s,g\n550,1,1,0.5\n", "g = 0.5").unwrap_err();
    assert!(two.problem.contains("leave one of them out"), "{two}");
    let huge = read_medium("wavelength,mu_a,mu_s\n550,1e39,1\n", "").unwrap_err();
    assert!(huge.problem.contains("larger than can be computed"), "{huge}");
}

#[test]
fn a_table_is_one_way_of_several_to_give_a_medium() {
    let material = |keys: &str| read(&format!("[material.m]\ntype = 'translucent'\n{keys}\n")).unwrap_err();
    let missing = material("spectrum = 'missing.csv'");
    assert_eq!(missing.place, "line 13, material.m.spectrum");
    assert!(missing.problem.contains("there is no file"), "{missing}");
    let both = material("sigma_a = 1\nsigma_s = 1\nspectrum = 'skin.csv'");
    assert!(
        both.place == "line 15, material.m.spectrum" && both.problem.contains("excludes `sigma_a`"),
        "{both}"
    );
    assert!(material("").problem.contains("or `spectrum`"));
}

#[test]
fn the_program_says_what_is_wrong_and_ends_with_2() {
    let folder = Folder::new();
    let lit =
        "[material.m]\ntype = 'diffuse'\n[[light]]\ntype = 'point'\nposition = [0, 4, 0]\nintensity = 1\n";
    let cold = format!("{lit}temperature = 0\n");
    for (more, part) in [
        ("[material.m]\ntype = 'dielectric'\nabbe = 0\n", "material.m.abbe: an Abbe number of 0"),
        (&cold, "light[0].temperature: a temperature of 0 K"),
    ] {
        fs::write(folder.path("scene.toml"), text(more)).unwrap();
        folder.refuses(&["render", "scene.toml", "-o", "a.exr"], 2, part);
        folder.refuses(&["plan", "scene.toml"], 2, part);
    }
    fs::write(folder.path("skin.csv"), "wavelength,mu_a,mu_s\n500,1,1\n400,1,1\n").unwrap();
    fs::write(folder.path("scene.toml"), text("[material.m]\ntype = 'translucent'\nspectrum = 'skin.csv'\n"))
        .unwrap();
    folder.refuses(&["plan", "scene.toml"], 2, "skin.csv: line 3: wavelength: 400 nm comes after 500 nm");
}
