//! The promises of the TOML scene file: every key is read, and every mistake is answered with its
//! line, its key, and a remedy.

#[path = "common/assets.rs"]
#[allow(dead_code)]
mod assets;
#[path = "gltf_reader/builder.rs"]
#[allow(dead_code)]
mod builder;

use std::fs;
use std::path::Path;

use alabaster::radiometry::Rgb;
use alabaster::radiometry::spectrum::dispersion::Dispersion;
use alabaster::scene::light::spot_solid_angle;
use alabaster::scene::{
    ColorMode, Emitted, Environment, Filter, Light, Method, ProfileChoice, ScatteringInput, Scene,
    SceneError, Surface, read_scene,
};
use assets::assets;
use builder::Builder;
use glam::Vec3;
use serde_json::json;

const SPHERE: &str = "[[object]]\nshape = 'sphere'\ncenter = [0, 0, 0]\nradius = 1\nmaterial = 'm'\n";
const MATERIAL: &str = "[material.m]\ntype = 'diffuse'\n";
const LIGHT: &str = "[environment]\nradiance = 1\n";
const CAMERA: &str = "[camera]\nposition = [0, 0, 4]\ntarget = [0, 0, 0]\n";

fn read(text: &str) -> Result<Scene, SceneError> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    read_in(folder.path(), text)
}

fn read_in(folder: &Path, text: &str) -> Result<Scene, SceneError> {
    let path = folder.join("scene.toml");
    fs::write(&path, text).expect("a writable temporary folder");
    read_scene(&path)
}

/// A complete scene plus `extra`.
fn with(extra: &str) -> Scene {
    read(&[SPHERE, MATERIAL, LIGHT, CAMERA, extra].concat()).expect(extra)
}

fn surface(material: &str) -> Surface {
    let text = [SPHERE, LIGHT, CAMERA, "[material.m]\n", material].concat();
    read(&text).expect(material).materials.remove(0).surface
}

#[test]
fn every_section_is_read() {
    let scene = read(
        "title = 'Everything'\n[[object]]\nshape = 'box'\nname = 'slab'\ncenter = [0, 0, 0]\nsize = [2, 2, 0.1]\n\
         material = 'm'\ntransform = { scale = 2.0, rotate = [0, 30, 0], translate = [1, 0, 0] }\n\
         [camera]\nposition = [1, 2, 3]\ntarget = [0, 1, 0]\nup = [0, 0, 2]\nfov = 60\naperture = 0.1\nfocus = 2.5\n\
         [film]\nwidth = 640\nheight = 480\nfilter = 'gaussian'\n[environment]\nradiance = [1, 2, 3]\n\
         [subsurface]\nmethod = 'walk'\nprofile = 'photon-beam'\nsimilarity = true\n[render]\nspp = 7\nmax_depth = 9\nmode = 'rgb'\n\
         [material.m]\ntype = 'diffuse'\ncolor = [0.1, 0.2, 0.3]\nemission = 2\ndouble_sided = true\n",
    )
    .expect("a valid scene");
    assert_eq!(scene.title, "Everything");
    assert_eq!(scene.instances[0].name, "slab");
    assert_eq!(scene.camera.position, Vec3::new(1.0, 2.0, 3.0));
    assert_eq!(scene.camera.up, Vec3::Z);
    assert_eq!(scene.camera.vertical_fov, 60.0_f32.to_radians());
    assert_eq!((scene.camera.aperture, scene.camera.focus_distance), (0.1, Some(2.5)));
    assert_eq!((scene.film.width, scene.film.height, scene.film.filter), (640, 480, Filter::Gaussian));
    assert_eq!(scene.environment, Some(Environment::Constant(Rgb::new(1.0, 2.0, 3.0))));
    assert_eq!(
        (scene.subsurface.method, scene.subsurface.profile, scene.subsurface.similarity),
        (Method::Walk, ProfileChoice::PhotonBeam, true)
    );
    assert_eq!((scene.render.spp, scene.render.max_depth), (7, 9));
    assert_eq!(scene.render.color_mode, ColorMode::Rgb);
    let material = &scene.materials[0];
    assert_eq!((material.emission.factor, material.double_sided), (Rgb::splat(2.0), true));
    let Surface::Diffuse { reflectance } = material.surface else { panic!("{:?}", material.surface) };
    assert_eq!(reflectance.factor, Rgb::new(0.1, 0.2, 0.3));
    assert_eq!(scene.warnings, Vec::<String>::new());
}

#[test]
fn names_of_settings_are_all_known() {
    for (name, filter) in Filter::NAMES {
        assert_eq!(with(&format!("[film]\nfilter = '{name}'")).film.filter, filter);
    }
    for (name, method) in Method::NAMES {
        let read = with(&format!("[subsurface]\nmethod = '{name}'")).subsurface;
        assert_eq!((read.method, read.similarity), (method, false));
    }
    for (name, profile) in ProfileChoice::NAMES {
        assert_eq!(with(&format!("[subsurface]\nprofile = '{name}'")).subsurface.profile, profile);
    }
}

#[test]
fn transforms_turn_about_x_then_y_then_z() {
    let place = |transform: &str, point: Vec3| {
        let text = [SPHERE, "transform = ", transform, "\n", MATERIAL, LIGHT, CAMERA].concat();
        read(&text).expect(transform).instances[0].transform.transform_point3(point)
    };
    // y goes to z (90° about x), to x (90° about y), to y (90° about z); stretched before, moved after.
    let moved = place("{ scale = [1, 2, 1], rotate = [90, 90, 90], translate = [5, 0, 0] }", Vec3::Y);
    assert!((moved - Vec3::new(5.0, 2.0, 0.0)).length() < 8.0 * f32::EPSILON, "{moved}");
    // R_y(90°)·R_x(90°) takes z to −y; the other order would take it to x.
    let order = place("{ rotate = [90, 90, 0] }", Vec3::Z);
    assert!((order - Vec3::NEG_Y).length() < 4.0 * f32::EPSILON, "{order}");
    assert_eq!(place("{ scale = -2 }", Vec3::X), Vec3::new(-2.0, 0.0, 0.0));
    let matrix = place("{ matrix = [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 7, 8, 9, 1] }", Vec3::X);
    assert_eq!(matrix, Vec3::new(7.0, 9.0, 9.0));
}

#[test]
fn all_shapes_are_read() {
    for (shape, triangles) in [
        ("shape = 'sphere'\nradius = 2", 81_920),
        ("shape = 'box'\nsize = 1", 12),
        ("shape = 'quad'\nnormal = [0, 1, 0]\nsize = [2, 3]", 2),
        ("shape = 'disk'\nnormal = [0, 2, 0]\nradius = 0.5", 512),
    ] {
        let text =
            format!("[[object]]\n{shape}\ncenter = [1, 0, 0]\nmaterial = 'm'\n{MATERIAL}{LIGHT}{CAMERA}");
        assert_eq!(read(&text).expect(shape).meshes[0].triangles.len(), triangles);
    }
}

#[test]
fn lights_are_read_and_power_becomes_radiance_or_intensity() {
    let light = |text: &str| with(&format!("[[light]]\n{text}\n")).lights.remove(0);
    // A handful of roundings on either side.
    let close = |a: Emitted, b: f32| a.rgb.0.iter().all(|x| (x / b - 1.0).abs() < 4.0 * f32::EPSILON);
    let pi = std::f32::consts::PI;

    let quad = light("type = 'quad'\nposition = [0, 4, 0]\ntarget = [0, 0, 0]\nsize = [3, 1]\npower = 6");
    let Light::Quad { center, half_u, half_v, radiance } = quad else { panic!("{quad:?}") };
    assert_eq!((center, half_u.cross(half_v).normalize()), (Vec3::new(0.0, 4.0, 0.0), Vec3::NEG_Y));
    assert_eq!((half_u.length(), half_v.length(), half_u.y), (1.5, 0.5, 0.0));
    assert!(close(radiance, 2.0 / pi));

    let disk = light("type = 'disk'\nposition = [0, 0, 1]\ntarget = [0, 0, 0]\nradius = 0.5\npower = 1");
    let Light::Disk { normal, radiance, .. } = disk else { panic!("{disk:?}") };
    assert!(normal == Vec3::NEG_Z && close(radiance, 4.0 / (pi * pi)));

    let sphere = light("type = 'sphere'\ncenter = [9, 0, 0]\nradius = 2\npower = 1");
    let Light::Sphere { radius, radiance, .. } = sphere else { panic!("{sphere:?}") };
    assert!(radius == 2.0 && close(radiance, 1.0 / (16.0 * pi * pi)));

    let point = light("type = 'point'\nposition = [1, 2, 3]\npower = 1");
    assert!(matches!(point, Light::Point { intensity, .. } if close(intensity, 1.0 / (4.0 * pi))));

    let cone =
        "type = 'spot'\nposition = [0, 5, 0]\ntarget = [0, 0, 0]\nangle = 60\ninner_angle = 40\npower = 1";
    let Light::Spot { direction, intensity, inner_angle, outer_angle, .. } = light(cone) else {
        panic!("not a spot")
    };
    assert_eq!((inner_angle, outer_angle), (20.0_f32.to_radians(), 30.0_f32.to_radians()));
    assert!(direction == Vec3::NEG_Y && close(intensity, 1.0 / spot_solid_angle(inner_angle, outer_angle)));

    let sun = light("type = 'directional'\ndirection = [0, -3, 0]\nirradiance = [1, 2, 3]");
    let irradiance = Rgb::new(1.0, 2.0, 3.0);
    assert_eq!(sun, Light::Directional { direction: Vec3::NEG_Y, irradiance: irradiance.into() });
}

#[test]
fn a_medium_is_given_in_any_of_four_ways() {
    let medium = |keys: &str| match surface(&format!("type = 'translucent'\n{keys}\n")) {
        Surface::Translucent { ior, medium, .. } => (ior, medium),
        other => panic!("{other:?}"),
    };
    let coefficients = |keys: &str| match medium(keys) {
        (ior, ScatteringInput::Coefficients { sigma_a, sigma_s, g }) => (ior, sigma_a, sigma_s, g),
        other => panic!("{other:?}"),
    };
    let (a, s) = (Rgb::new(2.1, 4.1, 7.1), Rgb::new(2190.0, 2620.0, 3000.0));
    let direct = "ior = 1.4\nsigma_a = [2.1, 4.1, 7.1]\nsigma_s = [2190, 2620, 3000]\ng = 0.9";
    assert_eq!(coefficients(direct), (1.4, a, s, 0.9));
    assert_eq!(coefficients("preset = 'marble'"), (1.5, a, s, 0.0));
    assert_eq!(coefficients("preset = 'Marble'\ndensity = 2\ng = 0.5"), (1.5, a * 2.0, s * 4.0, 0.5));
    assert_eq!(coefficients("preset = 'skim-milk'\nior = 1.2").0, 1.2);
    let half = Rgb::new(20.0, 10.0, 40.0);
    assert_eq!(
        coefficients("single_scattering_albedo = 0.5\nsigma_t = [40, 20, 80]"),
        (1.5, half, half, 0.0)
    );
    let (_, wanted) = medium("albedo = [0.8, 0.5, 0.3]\nmean_free_path = [0.3, 0.2, 0.1]");
    let ScatteringInput::Albedo { albedo, mean_free_path, g } = wanted else { panic!("{wanted:?}") };
    assert_eq!((albedo.factor, g), (Rgb::new(0.8, 0.5, 0.3), 0.0));
    assert_eq!(mean_free_path, Rgb::new(0.3, 0.2, 0.1));
}

#[test]
fn surfaces_of_every_type_are_read() {
    let glass =
        "type = 'dielectric'\nior = 1.52\nabbe = 58\nroughness = 0.1\nsigma_a = [1, 2, 3]\ntint = 0.9\n";
    let Surface::Dielectric { ior, dispersion, roughness, sigma_a, tint } = surface(glass) else {
        panic!("not a dielectric")
    };
    let crown = Dispersion::from_abbe(1.52_f32.into(), 58.0).unwrap();
    assert_eq!((ior, dispersion, roughness.factor, tint.factor), (1.52, Some(crown), 0.1, Rgb::splat(0.9)));
    assert_eq!(sigma_a, Rgb::new(1.0, 2.0, 3.0));

    let stained =
        surface("type = 'dielectric'\nattenuation_color = [1, 0.5, 0.25]\nattenuation_distance = 0.1\n");
    let Surface::Dielectric { sigma_a, .. } = stained else { panic!("{stained:?}") };
    let transmitted = (sigma_a * -0.1).exp() - Rgb::new(1.0, 0.5, 0.25);
    // Three roundings of an exponent up to 1.4, and those of ln and exp.
    assert!(transmitted.0.iter().all(|x| x.abs() < 4.0 * f32::EPSILON), "{sigma_a:?}");

    let metal = surface("type = 'metal'\nreflectance = [0.9, 0.6, 0.3]\nroughness = 0.3\n");
    let Surface::Metal { reflectance, roughness } = metal else { panic!("{metal:?}") };
    assert_eq!((reflectance.factor, roughness.factor), (Rgb::new(0.9, 0.6, 0.3), 0.3));

    let full = "type = 'gltf'\nbase_color = [0.1, 0.2, 0.3]\nmetallic = 0.4\nroughness = 0.5\nior = 1.6\n\
        transmission = 0.7\ndiffuse_transmission = 0.2\ndiffuse_transmission_color = [1, 0, 0]\nabbe = 30\n\
        sigma_a = 4\n";
    let Surface::MetallicRoughness(gltf) = surface(full) else { panic!("not metallic-roughness") };
    assert_eq!((gltf.metallic.factor, gltf.roughness.factor, gltf.ior), (0.4, 0.5, 1.6));
    assert_eq!((gltf.transmission.factor, gltf.diffuse_transmission.factor), (0.7, 0.2));
    assert_eq!(gltf.diffuse_transmission_color.factor, Rgb::new(1.0, 0.0, 0.0));
    let flint = Dispersion::from_abbe(gltf.ior.into(), 30.0).unwrap();
    assert_eq!((gltf.thin, gltf.sigma_a, gltf.dispersion), (false, Rgb::splat(4.0), Some(flint)));
    let Surface::MetallicRoughness(plain) = surface("type = 'gltf'\n") else {
        panic!("not metallic-roughness")
    };
    assert!(plain.thin && plain.metallic.factor == 1.0 && plain.base_color.factor == Rgb::ONE);
}

/// Mistakes: what is put after a valid object, material and light; the place and a piece of the
/// message. Lines count from 1; the extra text begins on line 10.
#[rustfmt::skip]
const MISTAKES: [(&str, &str, &str); 44] = [
    ("[render]\nsp = 1", "line 11, render.sp", "did you mean `spp`?"),
    ("[rendr]\n", "line 10, rendr", "did you mean `render`?"),
    ("[film]\nzzzzzz = 1", "line 11, film.zzzzzz", "known: width, height, filter"),
    ("[film]\nwidth = 0", "line 11, film.width", "from 1 to 65536"),
    ("[film]\nwidth = 1.5", "line 11, film.width", "expected a whole number"),
    ("[film]\nwidth = 65536\nheight = 65536", "line 10, film", "the limit is"),
    ("[film]\nfilter = 'boxx'", "line 11, film.filter", "did you mean `box`?"),
    ("[render]\nspp = 0", "line 11, render.spp", "from 1"),
    ("[render]\nspp = -3", "line 11, render.spp", "not -3"),
    ("[render]\nmode = 7", "line 11, render.mode", "expected text"),
    ("[subsurface]\nmethod = 'wlak'", "line 11, subsurface.method", "did you mean `walk`?"),
    ("[subsurface]\naccuracy = 0", "line 11, subsurface.accuracy", "above 0, and 1 at most, not 0"),
    ("[subsurface]\naccuracy = 2", "line 11, subsurface.accuracy", "above 0, and 1 at most, not 2"),
    ("[subsurface]\naccuracy = nan", "line 11, subsurface.accuracy", "finite"),
    ("[subsurface]\naccurcy = 0.1", "line 11, subsurface.accurcy", "did you mean `accuracy`?"),
    ("[camera]\ntarget = [0, 0, 0]", "line 10, camera", "`position` is missing"),
    ("[camera]\nposition = [0, 0, 1]\ntarget = [0, 0, 1]", "line 10, camera", "same point"),
    ("[camera]\nposition = [0, 9, 0]\ntarget = [0, 0, 0]", "line 10, camera", "`up` points along"),
    ("[camera]\nposition = [0, 0, 1]\ntarget = [0, 0]", "line 12, camera.target", "expected 3 numbers, found 2"),
    ("[camera]\nposition = [0, 0, nan]\ntarget = 0", "line 11, camera.position[2]", "finite"),
    ("[camera]\nposition = [0, 0, 1]\ntarget = [0, 0, 0]\nfov = 180", "line 13, camera.fov", "not 180"),
    ("[camera]\nposition = [0, 0, 1e39]\ntarget = 0", "line 11, camera.position[2]", "finite"),
    ("[[light]]\ntype = 'qaud'", "line 11, light[0].type", "did you mean `quad`?"),
    ("[[light]]\ntype = 'point'\nposition = [0, 1, 0]\nintensity = -1", "line 13, light[0].intensity", "0 or more, not -1"),
    ("[[light]]\ntype = 'point'\nposition = [0, 1, 0]", "line 10, light[0]", "`intensity` is missing"),
    ("[[light]]\ntype = 'point'\nposition = [0, 1, 0]\nintensity = 1\npower = 1", "line 14, light[0].power", "excludes `intensity`"),
    ("[[light]]\ntype = 'sphere'\ncenter = [0, 1, 0]\nradius = 0\npower = 1", "line 13, light[0].radius", "greater than 0"),
    ("[[light]]\ntype = 'directional'\ndirection = [0, 0, 0]\nirradiance = 1", "line 12, light[0].direction", "length"),
    ("[[light]]\ntype = 'sphere'\ncenter = [0, 1, 0]\nradius = 1e-18\npower = 1e10", "line 14, light[0].power", "too much"),
    ("[[object]]\nmaterial = 'm'", "line 10, object[1]", "needs `gltf` or `shape`"),
    ("[[object]]\nshap = 'box'", "line 11, object[1].shap", "did you mean `shape`?"),
    ("[[object]]\nshape = 'box'\ncenter = [0, 0, 0]\nsize = 1", "line 10, object[1]", "`material` is missing"),
    ("[[object]]\nshape = 'box'\ncenter = [0, 0, 0]\nsize = 1\nmaterial = 'n'", "line 14, object[1].material", "did you mean `m`?"),
    ("[[object]]\nshape = 'sphere'\ncenter = [0, 0, 0]\nradisu = 1", "line 13, object[1].radisu", "did you mean `radius`?"),
    ("[[object]]\ngltf = 'missing.glb'", "line 11, object[1].gltf", "there is no file"),
    ("[[object]]\ngltf = 'x.glb'\ntransform = { scale = 0 }", "line 12, object[1].transform", "singular"),
    ("[[object]]\ngltf = 'x.glb'\ntransform = { scale = 1, matrix = [] }", "line 12, object[1].transform.matrix", "excludes `scale`"),
    ("[material.x]\n", "line 10, material.x", "`type` is missing"),
    ("[material.x]\ntype = 'diffuse'\nreflectance = 1.5", "line 12, material.x.reflectance", "from 0 to 1, not 1.5"),
    ("[material.x]\ntype = 'translucent'", "line 10, material.x", "what is inside?"),
    ("[material.x]\ntype = 'translucent'\nsigma_a = 1", "line 10, material.x", "`sigma_s` is missing"),
    ("[material.x]\ntype = 'translucent'\npreset = 'marble'\nsigma_t = 1", "line 13, material.x.sigma_t", "excludes `preset`"),
    ("[material.x]\ntype = 'translucent'\npreset = 'marbel'", "line 12, material.x.preset", "did you mean `Marble`?"),
    ("[material.x]\ntype = 'translucent'\npreset = 'marble'\ng = 1", "line 13, material.x.g", "between −1 and 1"),
];

#[test]
fn every_mistake_is_answered_with_line_key_and_remedy() {
    for (extra, place, problem) in MISTAKES {
        let text = [SPHERE, MATERIAL, LIGHT, extra].concat();
        let error = read(&text).expect_err(extra);
        assert_eq!(error.place, place, "{extra}: {error}");
        assert!(error.problem.contains(problem), "{extra}: {error}");
        assert!(error.to_string().contains("scene.toml: line "));
    }
}

#[test]
fn mistakes_in_whole_files_are_answered() {
    let cases = [
        ("", "", "has no objects"),
        ("a = [", "line 1", "not valid TOML"),
        ("title = 3", "line 1, title", "expected text"),
        ("object = 3", "line 1, object", "expected [[object]]"),
        ("film = []", "line 1, film", "expected a table"),
        (
            "[environment]\nradiance = 1\n[[object]]\nshape = 'box'",
            "line 3, object[0]",
            "`center` is missing",
        ),
    ];
    for (text, place, problem) in cases {
        let error = read(text).expect_err(text);
        assert!(error.place == place && error.problem.contains(problem), "{text}: {error}");
    }
    for environment in
        ["", "radiance = 1\nimage = 'x.hdr'", "image = 'x.hdr'", "radiance = 1\nscale = 2", "radiance = -1"]
    {
        let text = [SPHERE, MATERIAL, "[environment]\n", environment].concat();
        assert!(read(&text).expect_err(environment).place.contains("environment"));
    }
    assert!(read_scene(Path::new("missing.toml")).is_err());
    assert!(read_scene(Path::new("model.obj")).is_err_and(|e| e.problem.contains(".toml, .glb or .gltf")));
}

#[test]
fn what_is_left_out_is_filled_in_and_said() {
    let scene = read(&[SPHERE, MATERIAL].concat()).expect("a scene without camera and light");
    assert!(scene.warnings.iter().any(|w| w.contains("no camera")));
    assert!(scene.warnings.iter().any(|w| w.contains("default rig")));
    assert!(scene.environment.is_some() && scene.lights.len() == 1);
    // The framed camera sees all of the sphere.
    let rays = scene.camera.rays(1.0);
    let tangent = (0.5 * scene.camera.vertical_fov).tan();
    for &p in &scene.meshes[0].positions {
        let v = p - scene.camera.position;
        let reach = v.dot(rays.forward()) * tangent;
        assert!(v.dot(rays.up()).abs() < reach && v.dot(rays.right()).abs() < reach);
    }
}

#[test]
fn coefficients_in_the_wrong_unit_are_noticed() {
    let hint = |sigma: &str| {
        let material = format!("[material.m]\ntype = 'translucent'\nsigma_a = 0\nsigma_s = {sigma}\n");
        read(&[SPHERE, &material, LIGHT, CAMERA].concat()).expect("a scene").warnings.concat()
    };
    // The sphere's bounding box has a diagonal of 2√3 m.
    let expected = "material `m`: mean free path 50000 mm in a body of 3460 mm: are the coefficients in 1/m?";
    assert_eq!(hint("0.02"), expected);
    assert!(hint("1e6").contains("are the coefficients in 1/m?"));
    assert_eq!(hint("100"), "");
    assert_eq!(hint("0"), "");
}

#[test]
fn dispersion_that_is_not_rendered_is_said() {
    for (material, mode, said) in [
        ("ior = 1.5\nabbe = 58", "rgb", true),
        ("ior = 1.5", "rgb", false),
        ("ior = 1.5\nabbe = 58", "auto", false),
        ("ior = 1.5\nabbe = 58", "spectral", false),
    ] {
        let material = format!("[material.m]\ntype = 'dielectric'\n{material}\n[render]\nmode = '{mode}'\n");
        let warnings = read(&[SPHERE, &material, LIGHT, CAMERA].concat()).expect("a scene").warnings;
        assert_eq!(warnings.concat().contains("`m`: rendered without dispersion"), said, "{warnings:?}");
    }
}

#[test]
fn environment_maps_in_the_wild_are_read() {
    let Some(assets) = assets() else { return };
    for name in ["kiara_1_dawn_1k.hdr", "studio_small_05_1k.hdr", "studio_dwab.exr"] {
        let image = assets.join("env").join(name);
        let environment = format!("[environment]\nimage = '{}'\nscale = 2\nrotate = 90", image.display());
        let scene = read(&[SPHERE, MATERIAL, CAMERA, &environment].concat()).expect(name);
        let Some(Environment::Map { width, height, radiance, .. }) = &scene.environment else {
            panic!("{name}")
        };
        assert_eq!((*width, radiance.len()), (2 * height, width * height));
        assert!(radiance.iter().all(|p| p.is_finite() && p.min_component() >= 0.0));
        assert!(radiance.iter().any(|p| p.max_component() > 0.5));
        // Its lossy compression rings around the lamps: OpenEXR's own reader finds as many negative pixels.
        let negative = (name == "studio_dwab.exr").then_some("798 of 131072 pixels had negative");
        assert_eq!(scene.warnings.len(), negative.iter().len(), "{:?}", scene.warnings);
        assert!(scene.warnings.iter().all(|warning| warning.contains(negative.unwrap_or_default())));
    }
}

#[test]
fn a_gltf_file_is_a_scene_and_can_be_placed_twice() {
    let Some(assets) = assets() else { return };
    let file = assets.join("meshes/UtahTeapot.glb");
    let alone = read_scene(&file).expect("the teapot");
    assert!(alone.warnings.iter().any(|w| w.contains("default rig")), "{:?}", alone.warnings);
    let object = format!("[[object]]\ngltf = '{}'\n", file.display());
    let moved = "transform = { translate = [9, 0, 0] }\nmaterial = 'm'\n";
    let scene =
        read(&[&object, object.as_str(), moved, MATERIAL, LIGHT, CAMERA].concat()).expect("two teapots");
    assert_eq!(scene.meshes.len(), alone.meshes.len());
    assert_eq!(scene.instances.len(), 2 * alone.instances.len());
    let (first, second) = (&scene.instances[0], &scene.instances[alone.instances.len()]);
    assert_eq!(scene.materials[second.material].name, "m");
    assert_ne!(first.material, second.material);
    assert_eq!(first.mesh, second.mesh);
    assert_eq!(second.transform.translation, first.transform.translation + glam::Vec3A::new(9.0, 0.0, 0.0));
}

#[test]
fn pixels_that_are_no_radiance_are_counted_and_black() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let value = |x: usize| [1.0, f32::NAN, -2.0, f32::INFINITY][x];
    exr::prelude::write_rgb_file(folder.path().join("map.exr"), 4, 2, |x, _| (value(x), 0.5_f32, 0.25_f32))
        .expect("a writable temporary folder");
    let text = [SPHERE, MATERIAL, CAMERA, "[environment]\nimage = 'map.exr'\n"].concat();
    let scene = read_in(folder.path(), &text).expect("a scene with a map");
    assert!(scene.warnings[0].contains("6 of 8 pixels"), "{:?}", scene.warnings);
    let Some(Environment::Map { radiance, .. }) = scene.environment else { panic!("no map") };
    assert_eq!(radiance[0], Rgb::new(1.0, 0.5, 0.25));
    assert!(radiance[1..4].iter().all(|p| *p == Rgb::new(0.0, 0.5, 0.25)));
}

#[test]
fn damaged_maps_are_errors() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("map.exr");
    exr::prelude::write_rgb_file(&path, 16, 8, |x, y| (x as f32, y as f32, 1.0_f32))
        .expect("a writable temporary folder");
    let good = fs::read(&path).expect("the file just written");
    let text = "[[object]]\nshape = 'quad'\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nsize = 1\nmaterial = 'm'\n\
        [material.m]\ntype = 'diffuse'\n[environment]\nimage = 'map.exr'\n";
    for length in [0, 4, 100, good.len() / 2, good.len() - 1] {
        fs::write(&path, &good[..length]).expect("a writable temporary folder");
        let error = read_in(folder.path(), text).expect_err("a cut file");
        assert!(error.problem.contains("is not an OpenEXR file that can be read"), "{error}");
    }
    // Every third bit of the header flipped in turn: whatever it then says, an answer; a panic, or an
    // allocation that aborts, would end the test.
    for bit in (0..8 * 330).step_by(3) {
        let mut bytes = good.clone();
        bytes[bit / 8] ^= 1 << (bit % 8);
        fs::write(&path, &bytes).expect("a writable temporary folder");
        if let Err(error) = read_in(folder.path(), text) {
            assert_eq!(error.file, path);
        }
    }
}

const SKIN: &str = "type = 'translucent'\nalbedo = 'base-color'\nmean_free_path = [0.001, 0.0005, 0.0003]\n";

/// A folder with `model.gltf`: a triangle whose material has a texture as base colour and as normal map.
fn textured_model() -> Builder {
    let mut builder = Builder::with_material(json!({
        "name": "face",
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.9, 0.8, 0.7, 1], "baseColorTexture": { "index": 0 }, "roughnessFactor": 0.4
        },
        "normalTexture": { "index": 0, "scale": 0.5 },
    }));
    builder.texture(2, 2, [10, 20, 30, 255]);
    builder.file("model.gltf", builder.json.to_string().as_bytes());
    builder
}

#[test]
fn the_albedo_can_be_the_base_colour_of_the_model() {
    let folder = textured_model().folder;
    let object = "[[object]]\ngltf = 'model.gltf'\n";
    let skin = format!("material = 'skin'\n[material.skin]\n{SKIN}");
    let rough = "[material.rough]\nroughness = 0.7\n";
    let text =
        [object, object, "material = 'skin'\n", object, "material = 'rough'\n", object, &skin, rough, SKIN];
    let scene = read_in(folder.path(), &[&text.concat(), LIGHT, CAMERA].concat()).expect("a valid scene");
    let material = |object: usize| &scene.materials[scene.instances[object].material];
    let (own, skin, rough) = (material(0), material(1), material(2));
    let Surface::MetallicRoughness(original) = &own.surface else { panic!("{own:?}") };
    assert_eq!((skin.name.as_str(), skin.normal_map), ("skin of face", own.normal_map));
    let Surface::Translucent {
        roughness,
        medium: ScatteringInput::Albedo { albedo, mean_free_path, .. },
        ..
    } = &skin.surface
    else {
        panic!("{skin:?}")
    };
    assert_eq!((*albedo, *roughness), (original.base_color, 0.4));
    assert_eq!((albedo.factor, albedo.texture), (Rgb::new(0.9, 0.8, 0.7), Some(0)));
    assert_eq!(*mean_free_path, Rgb::new(0.001, 0.0005, 0.0003));
    assert!(matches!(rough.surface, Surface::Translucent { roughness: 0.7, .. }), "{rough:?}");
    // The same model with the same replacement is the same material.
    assert_eq!(scene.instances[1].material, scene.instances[3].material);
    assert_ne!(scene.instances[1].material, scene.instances[2].material);
}

#[test]
fn an_albedo_from_the_base_colour_needs_one() {
    let skin = format!("[material.m]\n{SKIN}");
    let error = read(&[SPHERE, &skin, LIGHT, CAMERA].concat()).expect_err("a shape has no base colour");
    assert_eq!(error.place, "line 5, object[0].material");
    assert!(error.problem.contains("which a shape does not have"), "{error}");

    let wrong = format!("[material.m]\n{}", SKIN.replace("base-color", "base-colour"));
    let error = read(&[SPHERE, &wrong, LIGHT, CAMERA].concat()).expect_err("misspelt");
    assert!(error.problem.contains("did you mean `base-color`?"), "{error}");

    let marble = Builder::with_material(json!({
        "name": "marble",
        "pbrMetallicRoughness": { "metallicFactor": 0 },
        "extensions": {
            "KHR_materials_transmission": { "transmissionFactor": 1 },
            "KHR_materials_volume": { "thicknessFactor": 1, "attenuationDistance": 0.01, "attenuationColor": [0.5, 0.5, 0.5] },
            "KHR_materials_volume_scatter": { "multiscatterColor": [0.5, 0.5, 0.5] },
        }
    }));
    marble.file("model.gltf", marble.json.to_string().as_bytes());
    let object = "[[object]]\ngltf = 'model.gltf'\nmaterial = 'm'\n";
    let error =
        read_in(marble.folder.path(), &[object, &skin, LIGHT, CAMERA].concat()).expect_err("no base colour");
    assert_eq!(error.place, "line 3, object[0].material");
    assert!(error.problem.contains("`marble` has none"), "{error}");
}
