//! Materials, textures and the translucency extensions.

use alabaster::radiometry::Rgb;
use alabaster::radiometry::color::srgb_to_linear;
use alabaster::radiometry::spectrum::dispersion::Dispersion;
use alabaster::scene::material::{Coverage, MetallicRoughness};
use alabaster::scene::texture::Wrap;
use alabaster::scene::{GltfScene, ScatteringInput, Surface};
use glam::{Vec2, Vec4};
use serde_json::{Value, json};

use crate::builder::{Builder, assert_warns, png};

fn read(material: Value) -> GltfScene {
    Builder::with_material(material).read_ok()
}

fn metallic_roughness(read: &GltfScene) -> &MetallicRoughness {
    match &read.scene.materials[0].surface {
        Surface::MetallicRoughness(surface) => surface,
        other => panic!("not metallic-roughness: {other:?}"),
    }
}

/// A translucent material: transmission, a volume, and the given scattering.
fn translucent(name: &str, scatter: Value) -> Value {
    let mut material = json!({
        "pbrMetallicRoughness": { "metallicFactor": 0, "roughnessFactor": 0.25 },
        "extensions": {
            "KHR_materials_ior": { "ior": 1.4 },
            "KHR_materials_transmission": { "transmissionFactor": 1 },
            "KHR_materials_volume":
                { "thicknessFactor": 1, "attenuationDistance": 0.01, "attenuationColor": [0.1, 0.5, 1.0] },
        }
    });
    material["extensions"][name] = scatter;
    material
}

#[test]
fn without_a_material_the_standard_default_stands() {
    let read = Builder::triangle().read_ok();
    let surface = metallic_roughness(&read);
    assert_eq!(surface.base_color.factor, Rgb::ONE);
    assert_eq!((surface.metallic.factor, surface.roughness.factor), (1.0, 1.0));
    assert_eq!((surface.ior, surface.thin, surface.transmission.factor), (1.5, true, 0.0));
}

#[test]
fn metallic_roughness_reads_its_channels() {
    let mut builder = Builder::with_material(json!({
        "name": "brass",
        "doubleSided": true,
        "alphaMode": "MASK",
        "alphaCutoff": 0.25,
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.5, 1, 1, 0.5],
            "baseColorTexture": { "index": 0 },
            "metallicRoughnessTexture": { "index": 1 },
            "metallicFactor": 0.5,
        },
        "normalTexture": { "index": 1, "scale": 2 },
    }));
    builder.texture(1, 1, [188, 0, 255, 51]);
    builder.texture(1, 1, [1, 51, 102, 255]);
    let read = builder.read_ok();
    let material = &read.scene.materials[0];
    let surface = metallic_roughness(&read);
    let uv = [Vec2::splat(0.5); 2];
    let vertex = Vec4::ONE;
    let color = read.scene.color(&surface.base_color, uv, vertex);
    assert_eq!(color, Rgb::new(0.5 * srgb_to_linear(188.0 / 255.0), 0.0, 1.0));
    assert_eq!(read.scene.scalar(&surface.roughness, uv, vertex), 0.2);
    assert_eq!(read.scene.scalar(&surface.metallic, uv, vertex), 0.2);
    match material.coverage {
        Coverage::Mask { alpha, cutoff } => {
            assert_eq!((read.scene.scalar(&alpha, uv, vertex), cutoff), (0.1, 0.25));
        }
        other => panic!("{other:?}"),
    }
    assert!(material.double_sided);
    assert_eq!(material.name, "brass");
    let (normal, scale) = material.normal_map.unwrap();
    assert_eq!(scale, 2.0);
    // The normal map and the metallic-roughness map are one texture; each image is decoded once.
    assert_eq!(Some(normal), surface.roughness.texture.map(|(texture, _)| texture));
    assert_eq!((read.scene.textures.len(), read.scene.images.len()), (2, 2));
    let srgb: Vec<bool> = read.scene.textures.iter().map(|texture| texture.srgb).collect();
    assert_eq!(srgb, [true, false]);
}

#[test]
fn one_image_serves_as_colour_and_data() {
    let mut builder = Builder::with_material(json!({
        "emissiveFactor": [1, 1, 1],
        "emissiveTexture": { "index": 0 },
        "occlusionTexture": { "index": 7 },
        "normalTexture": { "index": 0 },
    }));
    builder.texture(2, 2, [128; 4]);
    let read = builder.read_ok();
    assert_eq!((read.scene.textures.len(), read.scene.images.len()), (2, 1));
    // A surface that glows no brighter than white paper is no light.
    assert!(!read.has_lights);
}

#[test]
fn emission_is_factor_times_strength() {
    let read = read(json!({
        "emissiveFactor": [1, 0.5, 0],
        "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 8 } },
    }));
    assert_eq!(read.scene.materials[0].emission.factor, Rgb::new(8.0, 4.0, 0.0));
    assert!(read.has_lights);
}

#[test]
fn samplers_and_transforms() {
    let mut builder = Builder::with_material(json!({
        "pbrMetallicRoughness": { "baseColorTexture": {
            "index": 0,
            "texCoord": 0,
            "extensions": { "KHR_texture_transform": { "offset": [0.25, 0.5], "scale": [2, 4], "texCoord": 1 } },
        } },
    }));
    builder.texture(1, 1, [0; 4]);
    builder.json["samplers"] = json!([{ "magFilter": 9728, "wrapS": 33071, "wrapT": 33648 }]);
    builder.json["textures"][0]["sampler"] = json!(0);
    let read = builder.read_ok();
    let texture = read.scene.textures[0];
    assert_eq!((texture.wrap_u, texture.wrap_v, texture.nearest), (Wrap::Clamp, Wrap::Mirror, true));
    assert_eq!(texture.coordinate_set, 1);
    assert_eq!(texture.coordinates(Vec2::ONE), Vec2::new(2.25, 4.5));
    assert_warns(&read, "without the texture coordinates");
}

#[test]
fn image_kinds_and_depths() {
    let rgb16 = {
        let picture = image::ImageBuffer::from_pixel(2, 1, image::Rgb([1u16, 2, 65535]));
        let mut bytes = std::io::Cursor::new(Vec::new());
        image::DynamicImage::ImageRgb16(picture).write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        bytes.into_inner()
    };
    let mut builder =
        Builder::with_material(json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }));
    let view = builder.view(&rgb16);
    // No mimeType, or a wrong one: the bytes tell.
    builder.json["images"] = json!([{ "bufferView": view, "mimeType": "image/jpeg" }]);
    builder.json["textures"] = json!([{ "source": 0 }]);
    let read = builder.read_ok();
    assert_eq!(read.scene.images[0].texel(1, 0, false), [1.0 / 65535.0, 2.0 / 65535.0, 1.0, 1.0]);

    let picture = image::RgbaImage::from_pixel(3, 2, image::Rgba([10, 20, 30, 40]));
    picture.save(builder.folder.path().join("a b.webp")).unwrap();
    builder.json["images"] = json!([{ "uri": "a%20b.webp" }]);
    builder.json["textures"] = json!([{ "extensions": { "EXT_texture_webp": { "source": 0 } } }]);
    builder.json["extensionsRequired"] = json!(["EXT_texture_webp"]);
    let read = builder.read_ok();
    assert_eq!((read.scene.images[0].width, read.scene.images[0].height), (3, 2));
    assert_eq!(read.scene.images[0].texel(2, 1, false), [10, 20, 30, 40].map(|c: u8| f32::from(c) / 255.0));
}

#[test]
fn clear_bodies_become_dielectrics() {
    let glass = Some(Dispersion::from_abbe(1.4_f32.into(), 40.0).unwrap());
    let mut material = translucent("KHR_materials_dispersion", json!({ "dispersion": 0.5 }));
    let read_surface = |material: &Value| read(material.clone()).scene.materials[0].surface.clone();
    match read_surface(&material) {
        Surface::Dielectric { ior, dispersion, roughness, sigma_a, tint } => {
            assert_eq!((ior, dispersion, roughness.factor, tint.factor), (1.4, glass, 0.25, Rgb::ONE));
            // −ln c / d, one ulp for each of ln and the division.
            for (found, expected) in sigma_a.0.into_iter().zip([230.258_5, 69.314_72, 0.0]) {
                assert!((found - expected).abs() <= 2.0 * f32::EPSILON * expected, "{found} {expected}");
            }
        }
        other => panic!("{other:?}"),
    }
    material["extensions"]["KHR_materials_transmission"]["transmissionFactor"] = json!(0.5);
    match read_surface(&material) {
        Surface::MetallicRoughness(surface) => {
            assert_eq!((surface.transmission.factor, surface.thin), (0.5, false));
            assert_eq!((surface.sigma_a[2], surface.dispersion), (0.0, glass));
        }
        other => panic!("{other:?}"),
    }
    material["extensions"]["KHR_materials_transmission"]["transmissionFactor"] = json!(1);
    material["extensions"]["KHR_materials_volume"]["thicknessFactor"] = json!(0);
    match read_surface(&material) {
        Surface::MetallicRoughness(surface) => {
            assert_eq!((surface.transmission.factor, surface.thin), (1.0, true))
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn dispersion_is_an_abbe_number_or_refused() {
    let dispersive =
        |dispersion: Value| translucent("KHR_materials_dispersion", json!({ "dispersion": dispersion }));
    match read(dispersive(json!(0))).scene.materials[0].surface {
        Surface::Dielectric { dispersion, .. } => assert_eq!(dispersion, None),
        ref other => panic!("{other:?}"),
    }
    // So much that the index falls below 0 at long wavelengths.
    for (dispersion, problem) in
        [(json!(-1), "-1 means an Abbe number of -20"), (json!(100), "an index of refraction")]
    {
        let error = Builder::with_material(dispersive(dispersion)).read_error();
        assert!(error.place.ends_with("KHR_materials_dispersion/dispersion"), "{error}");
        assert!(error.problem.contains(problem), "{error}");
    }
}

#[test]
fn diffuse_transmission_reads_its_alpha() {
    let mut builder = Builder::with_material(json!({ "extensions": { "KHR_materials_diffuse_transmission": {
        "diffuseTransmissionFactor": 0.5,
        "diffuseTransmissionTexture": { "index": 0 },
        "diffuseTransmissionColorFactor": [0.1, 0.2, 0.3],
    } } }));
    builder.texture(1, 1, [255, 255, 255, 51]);
    let read = builder.read_ok();
    let surface = metallic_roughness(&read);
    assert_eq!(read.scene.scalar(&surface.diffuse_transmission, [Vec2::ZERO; 2], Vec4::ONE), 0.1);
    assert_eq!(surface.diffuse_transmission_color.factor, Rgb::new(0.1, 0.2, 0.3));
}

/// (σ_a, σ_s, g) of a translucent material.
fn coefficients(material: Value) -> (Rgb, Rgb, f32) {
    match read(material).scene.materials[0].surface {
        Surface::Translucent {
            ior,
            roughness,
            medium: ScatteringInput::Coefficients { sigma_a, sigma_s, g },
        } => {
            assert_eq!((ior, roughness), (1.4, 0.25));
            (sigma_a, sigma_s, g)
        }
        ref other => panic!("{other:?}"),
    }
}

#[test]
fn both_spellings_of_scattering() {
    let color = [0.2, 0.8, 0.9];
    let rho_to_albedo = |rho: f64, g: f64| {
        let s = 4.09712 + 4.20863 * rho - (9.59217 + 41.6808 * rho + 17.7126 * rho * rho).sqrt();
        (1.0 - s * s) / (1.0 - g * s * s)
    };
    let extinction = [-(0.1f64.ln()) / 0.01, -(0.5f64.ln()) / 0.01, 0.0];
    let cases = [
        (
            "KHR_materials_volume_scatter",
            json!({ "multiscatterColor": color, "scatterAnisotropy": 0.5 }),
            1.0,
            0.0,
        ),
        (
            "KHR_materials_volume_scatter",
            json!({ "multiscatterColorFactor": color, "scatterAnisotropy": 0.5 }),
            1.0,
            0.0,
        ),
        (
            "KHR_materials_scatter",
            json!({ "multiscatterColorFactor": color, "scatterAnisotropy": 0.5, "scatterStrengthFactor": 0.75 }),
            0.75,
            0.5,
        ),
    ];
    for (name, scatter, strength, g_of_formula) in cases {
        let (sigma_a, sigma_s, g) = coefficients(translucent(name, scatter));
        assert_eq!(g, 0.5);
        for c in 0..3 {
            let expected = extinction[c] * rho_to_albedo(strength * color[c], g_of_formula);
            // Single precision: a handful of roundings on σ_t, on which both depend.
            let tolerance = 8.0 * f64::from(f32::EPSILON) * extinction[c];
            assert!((f64::from(sigma_s[c]) - expected).abs() <= tolerance, "{name} {c}");
            assert!((f64::from(sigma_a[c] + sigma_s[c]) - extinction[c]).abs() <= tolerance, "{name} {c}");
        }
    }
}

#[test]
fn a_textured_colour_is_an_albedo_to_invert() {
    let scatter =
        json!({ "multiscatterColorFactor": [0.5, 1, 1], "multiscatterColorTexture": { "index": 0 } });
    let mut builder = Builder::with_material(translucent("KHR_materials_volume_scatter", scatter));
    builder.texture(1, 1, [255, 188, 0, 255]);
    let read = builder.read_ok();
    let Surface::Translucent { medium: ScatteringInput::Albedo { albedo, mean_free_path, g }, .. } =
        &read.scene.materials[0].surface
    else {
        panic!("{:?}", read.scene.materials[0].surface);
    };
    let color = read.scene.color(albedo, [Vec2::ZERO; 2], Vec4::ONE);
    assert_eq!(color, Rgb::new(0.5, srgb_to_linear(188.0 / 255.0), 0.0));
    assert_eq!(*g, 0.0);
    assert!((mean_free_path[0] * 230.258_5 - 1.0).abs() < 4.0 * f32::EPSILON);
    assert!(mean_free_path.is_finite());
}

#[test]
fn scattering_that_has_no_effect_says_why() {
    let scatter = json!({ "multiscatterColor": [0.5, 0.5, 0.5] });
    let changed = |pointer: &str, value: Value| {
        let mut material = translucent("KHR_materials_volume_scatter", scatter.clone());
        *material.pointer_mut(pointer).unwrap() = value;
        let read = read(material);
        assert!(!matches!(read.scene.materials[0].surface, Surface::Translucent { .. }), "{pointer}");
        read
    };
    let extension = |name: &str| format!("/extensions/KHR_materials_{name}");
    assert_warns(&changed(&extension("transmission/transmissionFactor"), json!(0)), "without transmission");
    assert_warns(&changed("/pbrMetallicRoughness/metallicFactor", json!(1)), "inside a metal");
    assert_warns(&changed(&extension("volume/thicknessFactor"), json!(0)), "thin wall");
    assert_warns(&changed(&extension("volume/attenuationColor"), json!([1, 1, 1])), "without attenuation");
    // The newer draft's default strength is 0: plain glass, and nothing to warn of.
    let glass = read(translucent("KHR_materials_scatter", json!({ "multiscatterColorFactor": [1, 1, 1] })));
    assert!(matches!(glass.scene.materials[0].surface, Surface::Dielectric { .. }));
    assert_eq!(glass.scene.warnings, [""; 0]);
}

#[test]
fn odd_indices_of_refraction() {
    let ior = |value: f64| {
        let read = read(json!({ "extensions": { "KHR_materials_ior": { "ior": value } } }));
        (metallic_roughness(&read).ior, read)
    };
    assert!(ior(0.0).0 > 1e5, "0 stands for infinity");
    let (clamped, read) = ior(-3.0);
    assert_eq!(clamped, 1.0);
    assert_warns(&read, "ior -3 is below 1");
}

#[test]
fn unlit_is_diffuse_with_a_warning() {
    let read = read(json!({ "extensions": { "KHR_materials_unlit": {} } }));
    assert!(matches!(read.scene.materials[0].surface, Surface::Diffuse { .. }));
    assert_warns(&read, "unlit");
}

#[test]
fn extensions_merely_used_are_warned_of() {
    let mut builder = Builder::triangle();
    builder.json["extensionsUsed"] = json!(["KHR_materials_clearcoat", "KHR_materials_ior", "VENDOR_x"]);
    builder.json["animations"] = json!([{ "channels": [], "samplers": [] }]);
    builder.json["skins"] = json!([{ "joints": [0] }]);
    let read = builder.read_ok();
    assert_warns(&read, "KHR_materials_clearcoat, VENDOR_x");
    assert_warns(&read, "animations are ignored");
    assert_warns(&read, "skins are ignored");
}

#[test]
fn images_of_unused_materials_are_not_read() {
    let mut builder = Builder::with_material(json!({}));
    builder.push("materials", json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }));
    builder.json["textures"] = json!([{ "source": 0 }]);
    builder.json["images"] = json!([{ "uri": "is-not-there.png" }]);
    assert!(builder.read_ok().scene.images.is_empty());
    builder.file("is-there.png", &png(1, 1, [0; 4]));
    builder.primitive()["material"] = json!(1);
    assert_eq!(builder.read_error().place, "/images/0/uri");
    builder.json["images"] = json!([{ "uri": "is-there.png" }]);
    assert_eq!(builder.read_ok().scene.images.len(), 1);
}
