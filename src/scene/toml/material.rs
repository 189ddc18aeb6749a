//! `[material.NAME]`.

use super::document::{Read, Table, Value};
use super::refraction::{REFRACTION_KEYS, refraction};
use super::replacement::Inherits;
use crate::medium::presets::measured_material;
use crate::radiometry::Rgb;
use crate::scene::material::MetallicRoughness;
use crate::scene::medium_file::read_medium;
use crate::scene::{ColorInput, Material, ScalarInput, ScatteringInput, Surface};

#[derive(Clone, Copy)]
enum Kind {
    Translucent,
    Dielectric,
    Diffuse,
    Metal,
    Gltf,
}

const KINDS: [(&str, Kind); 5] = [
    ("translucent", Kind::Translucent),
    ("dielectric", Kind::Dielectric),
    ("diffuse", Kind::Diffuse),
    ("metal", Kind::Metal),
    ("gltf", Kind::Gltf),
];

/// The albedo that stands for the base colour of the glTF material replaced.
const BASE_COLOR: &str = "base-color";

/// Keys that every material has.
const COMMON: [&str; 3] = ["type", "emission", "double_sided"];

/// A material of any type. Besides the keys of its type: `emission` (radiance, W/(m² sr)) and
/// `double_sided`.
pub fn material(name: &str, table: &Table, warnings: &mut Vec<String>) -> Read<Material> {
    let surface = match table.required("type", |v| v.choice(&KINDS))? {
        Kind::Translucent => translucent(name, table, warnings)?,
        Kind::Dielectric => dielectric(table)?,
        Kind::Diffuse => diffuse(table)?,
        Kind::Metal => metal(table)?,
        Kind::Gltf => metallic_roughness(table)?,
    };
    Ok(Material {
        name: name.to_owned(),
        surface,
        emission: table.optional("emission", color(Value::rgb))?.unwrap_or_default(),
        double_sided: table.optional("double_sided", Value::boolean)?.unwrap_or(false),
        ..Material::default()
    })
}

/// What a material with `albedo = "base-color"` leaves to the glTF material that it replaces.
pub fn inherits(table: &Table) -> Option<Inherits> {
    let named = table.get("albedo").is_some_and(|value| value.text() == Ok(BASE_COLOR));
    named.then(|| Inherits { roughness: !table.has("roughness") })
}

fn only(table: &Table, keys: &[&str]) -> Read<()> {
    table.only(&[&COMMON, keys].concat())
}

/// Keys: `ior` (1.5, or the preset's), `roughness` (0), `g` (0), and the medium in one of five ways.
fn translucent(name: &str, table: &Table, warnings: &mut Vec<String>) -> Read<Surface> {
    let ways = MEDIUM_KEYS.concat();
    only(table, &[&["ior", "abbe", "roughness", "g"], ways.as_slice()].concat())?;
    if table.optional("abbe", Value::positive)?.is_some() {
        warnings.push(format!(
            "material `{name}`: `abbe` is ignored: translucent bodies are rendered without dispersion"
        ));
    }
    let (medium, measured_ior) = medium(name, table, warnings)?;
    Ok(Surface::Translucent {
        ior: table.optional("ior", Value::positive)?.or(measured_ior).unwrap_or(1.5),
        roughness: table.optional("roughness", Value::fraction)?.unwrap_or(0.0),
        medium,
    })
}

/// The ways to give a medium, which exclude each other.
const MEDIUM_KEYS: [&[&str]; 5] = [
    &["sigma_a", "sigma_s"],
    &["preset", "density"],
    &["albedo", "mean_free_path"],
    &["single_scattering_albedo", "sigma_t"],
    &["spectrum"],
];

/// The medium, and the index of refraction if it was measured with it.
fn medium(name: &str, table: &Table, warnings: &mut Vec<String>) -> Read<(ScatteringInput, Option<f32>)> {
    let given_g = table.optional("g", |v| v.number_where(|x| x.abs() < 1.0, "between −1 and 1"))?;
    let g = given_g.unwrap_or(0.0);
    for (i, way) in MEDIUM_KEYS.iter().enumerate() {
        for other in MEDIUM_KEYS[i + 1..].iter().copied().flatten() {
            for key in *way {
                table.exclusive(&[key, other])?;
            }
        }
    }
    let given = |way: usize| MEDIUM_KEYS[way].iter().any(|key| table.has(key));
    if given(0) {
        let sigma_a = table.required("sigma_a", Value::rgb)?;
        let sigma_s = table.required("sigma_s", Value::rgb)?;
        Ok((ScatteringInput::Coefficients { sigma_a, sigma_s, g }, None))
    } else if given(1) {
        measured(table, g)
    } else if given(2) {
        let albedo = table.required("albedo", albedo)?;
        let length = |v: &Value| v.rgb_where(|x| x > 0.0, "greater than 0");
        let mean_free_path = table.required("mean_free_path", length)?;
        Ok((ScatteringInput::Albedo { albedo, mean_free_path, g }, None))
    } else if given(3) {
        let albedo = table.required("single_scattering_albedo", Value::rgb_fraction)?;
        let sigma_t = table.required("sigma_t", Value::rgb)?;
        let sigma_a = (Rgb::ONE - albedo) * sigma_t;
        Ok((ScatteringInput::Coefficients { sigma_a, sigma_s: albedo * sigma_t, g }, None))
    } else if given(4) {
        let file = table.required("spectrum", Value::existing_file)?;
        let read = read_medium(&file, given_g)?;
        warnings.extend(read.warnings.into_iter().map(|warning| format!("material `{name}`: {warning}")));
        Ok((read.medium, read.ior))
    } else {
        Err(table.error(
            "what is inside? Give `sigma_a` and `sigma_s`, or `preset`, or `albedo` and `mean_free_path`, \
             or `single_scattering_albedo` and `sigma_t`, or `spectrum`",
        ))
    }
}

/// A colour, or `"base-color"`, in whose place white stands until the glTF material is known.
fn albedo(value: &Value) -> Read<ColorInput> {
    match value.text() {
        Ok(_) => value.choice(&[(BASE_COLOR, ColorInput::constant(Rgb::ONE))]),
        Err(_) => color(Value::rgb_fraction)(value),
    }
}

/// Keys: `preset`, `density` (1).
fn measured(table: &Table, g: f32) -> Read<(ScatteringInput, Option<f32>)> {
    let preset =
        table.required("preset", |v| measured_material(v.text()?).map_err(|e| v.error(e.to_string())))?;
    let density = table.optional("density", Value::positive)?.unwrap_or(1.0);
    let sigma_a = preset.sigma_a * density;
    let sigma_s = preset.sigma_s_reduced * (density / (1.0 - g));
    if !(sigma_a + sigma_s).is_finite() {
        return Err(table.error("`density` is too large"));
    }
    Ok((ScatteringInput::Coefficients { sigma_a, sigma_s, g }, Some(preset.ior)))
}

/// Keys: those of [`refraction`], `roughness` (0), absorption (0), `tint` (1).
fn dielectric(table: &Table) -> Read<Surface> {
    let keys = ["roughness", "sigma_a", "attenuation_color", "attenuation_distance", "tint"];
    only(table, &[&REFRACTION_KEYS, keys.as_slice()].concat())?;
    let (ior, dispersion) = refraction(table)?;
    Ok(Surface::Dielectric {
        ior,
        dispersion,
        roughness: scalar(table, "roughness", 0.0)?,
        sigma_a: absorption(table)?.unwrap_or(Rgb::ZERO),
        tint: table.optional("tint", color(Value::rgb_fraction))?.unwrap_or(ColorInput::constant(Rgb::ONE)),
    })
}

/// Keys: `reflectance` or `color` (0.5).
fn diffuse(table: &Table) -> Read<Surface> {
    only(table, &["reflectance", "color"])?;
    Ok(Surface::Diffuse { reflectance: reflectance(table, 0.5)? })
}

/// Keys: `reflectance` or `color` at normal incidence (0.9), `roughness` (0).
fn metal(table: &Table) -> Read<Surface> {
    only(table, &["reflectance", "color", "roughness"])?;
    Ok(Surface::Metal { reflectance: reflectance(table, 0.9)?, roughness: scalar(table, "roughness", 0.0)? })
}

/// Keys and defaults as in glTF 2.0: `base_color` (1), `metallic` (1), `roughness` (1), those of [`refraction`],
/// `transmission` (0), `diffuse_transmission` (0), `diffuse_transmission_color` (1),
/// absorption (0), `thin` (true where no absorption is given).
fn metallic_roughness(table: &Table) -> Read<Surface> {
    let keys = [
        "base_color",
        "metallic",
        "roughness",
        "transmission",
        "diffuse_transmission",
        "diffuse_transmission_color",
        "sigma_a",
        "attenuation_color",
        "attenuation_distance",
        "thin",
    ];
    only(table, &[&REFRACTION_KEYS, keys.as_slice()].concat())?;
    let (ior, dispersion) = refraction(table)?;
    let white = ColorInput::constant(Rgb::ONE);
    let absorption = absorption(table)?;
    Ok(Surface::MetallicRoughness(Box::new(MetallicRoughness {
        base_color: table.optional("base_color", color(Value::rgb_fraction))?.unwrap_or(white),
        metallic: scalar(table, "metallic", 1.0)?,
        roughness: scalar(table, "roughness", 1.0)?,
        ior,
        transmission: scalar(table, "transmission", 0.0)?,
        diffuse_transmission: scalar(table, "diffuse_transmission", 0.0)?,
        diffuse_transmission_color: table
            .optional("diffuse_transmission_color", color(Value::rgb_fraction))?
            .unwrap_or(white),
        thin: table.optional("thin", Value::boolean)?.unwrap_or(absorption.is_none()),
        sigma_a: absorption.unwrap_or(Rgb::ZERO),
        dispersion,
    })))
}

/// `sigma_a` in 1/m, or the `attenuation_color` that white light has after `attenuation_distance`
/// metres: σ_a = −ln(c)/d (KHR_materials_volume).
fn absorption(table: &Table) -> Read<Option<Rgb>> {
    table.exclusive(&["sigma_a", "attenuation_color"])?;
    table.exclusive(&["sigma_a", "attenuation_distance"])?;
    if !table.has("attenuation_color") && !table.has("attenuation_distance") {
        return table.optional("sigma_a", Value::rgb);
    }
    let share = |v: &Value| v.rgb_where(|x| x > 0.0 && x <= 1.0, "above 0 and at most 1");
    let color = table.required("attenuation_color", share)?;
    let distance = table.required("attenuation_distance", Value::positive)?;
    // `0.0 -` rather than a sign, for white to give 0 and not −0.
    let sigma_a = color.map(|c| (0.0 - c.ln()) / distance);
    if sigma_a.is_finite() {
        Ok(Some(sigma_a))
    } else {
        Err(table.error("`attenuation_distance` is too small"))
    }
}

fn reflectance(table: &Table, default: f32) -> Read<ColorInput> {
    table.exclusive(&["reflectance", "color"])?;
    let key = if table.has("color") { "color" } else { "reflectance" };
    let given = table.optional(key, color(Value::rgb_fraction))?;
    Ok(given.unwrap_or(ColorInput::constant(Rgb::splat(default))))
}

fn scalar(table: &Table, key: &str, default: f32) -> Read<ScalarInput> {
    Ok(ScalarInput::constant(table.optional(key, Value::fraction)?.unwrap_or(default)))
}

/// Turns a reader of colours into one of constant inputs.
fn color<'a>(read: impl Fn(&Value<'a>) -> Read<Rgb>) -> impl Fn(&Value<'a>) -> Read<ColorInput> {
    move |value| read(value).map(ColorInput::constant)
}
