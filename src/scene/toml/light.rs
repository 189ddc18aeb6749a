//! `[[light]]`.

use std::f32::consts::PI;

use glam::Vec3;

use super::document::{Read, Table, Value};
use crate::radiometry::Rgb;
use crate::scene::Light;
use crate::scene::light::spot_solid_angle;
use crate::scene::shape::horizontal_frame;

#[derive(Clone, Copy)]
enum Kind {
    Quad,
    Disk,
    Sphere,
    Point,
    Spot,
    Directional,
}

const KINDS: [(&str, Kind); 6] = [
    ("quad", Kind::Quad),
    ("disk", Kind::Disk),
    ("sphere", Kind::Sphere),
    ("point", Kind::Point),
    ("spot", Kind::Spot),
    ("directional", Kind::Directional),
];

/// A light of any type. `power` is the whole radiant flux in W, instead of radiance or intensity.
pub fn light(table: &Table) -> Read<Light> {
    match table.required("type", |v| v.choice(&KINDS))? {
        Kind::Quad => quad(table),
        Kind::Disk => disk(table),
        Kind::Sphere => sphere(table),
        Kind::Point => point(table),
        Kind::Spot => spot(table),
        Kind::Directional => directional(table),
    }
}

/// Keys: `position` (of the centre), `target`, `size` (number or width and height; the width is
/// horizontal), `radiance` or `power`.
fn quad(table: &Table) -> Read<Light> {
    table.only(&["type", "position", "target", "size", "radiance", "power"])?;
    let center = table.required("position", Value::vector)?;
    let (u, v) = horizontal_frame(facing(table, center)?);
    let [width, height] = table.required("size", rectangle)?;
    let radiance = emitted(table, "radiance", PI * width * height)?;
    Ok(Light::Quad { center, half_u: u * (0.5 * width), half_v: v * (0.5 * height), radiance })
}

/// Keys: `position` (of the centre), `target`, `radius`, `radiance` or `power`.
fn disk(table: &Table) -> Read<Light> {
    table.only(&["type", "position", "target", "radius", "radiance", "power"])?;
    let center = table.required("position", Value::vector)?;
    let normal = facing(table, center)?;
    let radius = table.required("radius", Value::positive)?;
    Ok(Light::Disk { center, normal, radius, radiance: emitted(table, "radiance", (PI * radius).powi(2))? })
}

/// Keys: `center`, `radius`, `radiance` or `power`.
fn sphere(table: &Table) -> Read<Light> {
    table.only(&["type", "center", "radius", "radiance", "power"])?;
    let center = table.required("center", Value::vector)?;
    let radius = table.required("radius", Value::positive)?;
    Ok(Light::Sphere { center, radius, radiance: emitted(table, "radiance", (2.0 * PI * radius).powi(2))? })
}

/// Keys: `position`, `intensity` or `power`.
fn point(table: &Table) -> Read<Light> {
    table.only(&["type", "position", "intensity", "power"])?;
    let position = table.required("position", Value::vector)?;
    Ok(Light::Point { position, intensity: emitted(table, "intensity", 4.0 * PI)? })
}

/// Keys: `position`, `target`, `angle` (of the whole cone, degrees), `inner_angle` (of the cone of
/// full intensity; ¾ of `angle`), `intensity` (on the axis) or `power`.
fn spot(table: &Table) -> Read<Light> {
    table.only(&["type", "position", "target", "angle", "inner_angle", "intensity", "power"])?;
    let position = table.required("position", Value::vector)?;
    let direction = facing(table, position)?;
    let angle = table.required("angle", |v| {
        v.number_where(|x| x > 0.0 && x <= 180.0, "above 0 and at most 180 degrees")
    })?;
    let narrower = |v: &Value| v.number_where(|x| x >= 0.0 && x <= angle, "from 0 to `angle`");
    let inner = table.optional("inner_angle", narrower)?.unwrap_or(0.75 * angle);
    let (inner_angle, outer_angle) = ((0.5 * inner).to_radians(), (0.5 * angle).to_radians());
    let intensity = emitted(table, "intensity", spot_solid_angle(inner_angle, outer_angle))?;
    Ok(Light::Spot { position, direction, intensity, inner_angle, outer_angle })
}

/// Keys: `direction` (in which the light travels), `irradiance` (on a surface that faces it).
fn directional(table: &Table) -> Read<Light> {
    table.only(&["type", "direction", "irradiance"])?;
    Ok(Light::Directional {
        direction: table.required("direction", Value::direction)?,
        irradiance: table.required("irradiance", Value::rgb)?,
    })
}

/// Unit vector from `position` to `target`.
fn facing(table: &Table, position: Vec3) -> Read<Vec3> {
    let target = table.required("target", Value::vector)?;
    let direction = (target - position).try_normalize();
    direction.ok_or_else(|| table.error("`position` and `target` are the same point, or too far apart"))
}

/// Two lengths, or one for both.
pub fn rectangle(value: &Value) -> Read<[f32; 2]> {
    let size = if value.is_list() { value.numbers()? } else { [value.number()?; 2] };
    if size.iter().all(|&s| s > 0.0) { Ok(size) } else { Err(value.error("must be greater than 0")) }
}

/// What `key` says, or `power` divided by the power that `key` = 1 gives.
fn emitted(table: &Table, key: &'static str, power_of_one: f32) -> Read<Rgb> {
    table.exclusive(&[key, "power"])?;
    let Some(power) = table.get("power") else { return table.required(key, Value::rgb) };
    let emitted = power.rgb()? / power_of_one;
    if emitted.is_finite() { Ok(emitted) } else { Err(power.error("too much for the size of the light")) }
}
