//! `[[light]]`.

use std::f32::consts::PI;

use glam::Vec3;

use super::document::{Read, Table, Value};
use crate::radiometry::Rgb;
use crate::radiometry::spectrum::lamp::{Lamp, LampError};
use crate::scene::light::spot_solid_angle;
use crate::scene::shape::horizontal_frame;
use crate::scene::{Emitted, Light};

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

/// A light of any type. `power` is the whole radiant flux in W, instead of radiance or intensity. Any may have a `temperature` or an `illuminant`,
/// by whose spectrum it shines, as bright as white light of the strength given.
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
    table.only(&["type", "position", "target", "size", "radiance", "power", "temperature", "illuminant"])?;
    let center = table.required("position", Value::vector)?;
    let (u, v) = horizontal_frame(facing(table, center)?);
    let [width, height] = table.required("size", rectangle)?;
    let radiance = strength(table, "radiance", Some(PI * width * height))?;
    Ok(Light::Quad { center, half_u: u * (0.5 * width), half_v: v * (0.5 * height), radiance })
}

/// Keys: `position` (of the centre), `target`, `radius`, `radiance` or `power`.
fn disk(table: &Table) -> Read<Light> {
    table.only(&[
        "type",
        "position",
        "target",
        "radius",
        "radiance",
        "power",
        "temperature",
        "illuminant",
    ])?;
    let center = table.required("position", Value::vector)?;
    let normal = facing(table, center)?;
    let radius = table.required("radius", Value::positive)?;
    Ok(Light::Disk {
        center,
        normal,
        radius,
        radiance: strength(table, "radiance", Some((PI * radius).powi(2)))?,
    })
}

/// Keys: `center`, `radius`, `radiance` or `power`.
fn sphere(table: &Table) -> Read<Light> {
    table.only(&["type", "center", "radius", "radiance", "power", "temperature", "illuminant"])?;
    let center = table.required("center", Value::vector)?;
    let radius = table.required("radius", Value::positive)?;
    Ok(Light::Sphere {
        center,
        radius,
        radiance: strength(table, "radiance", Some((2.0 * PI * radius).powi(2)))?,
    })
}

/// Keys: `position`, `intensity` or `power`.
fn point(table: &Table) -> Read<Light> {
    table.only(&["type", "position", "intensity", "power", "temperature", "illuminant"])?;
    let position = table.required("position", Value::vector)?;
    Ok(Light::Point { position, intensity: strength(table, "intensity", Some(4.0 * PI))? })
}

/// Keys: `position`, `target`, `angle` (of the whole cone, degrees), `inner_angle` (of the cone of
/// full intensity; ¾ of `angle`), `intensity` (on the axis) or `power`.
fn spot(table: &Table) -> Read<Light> {
    table.only(&[
        "type",
        "position",
        "target",
        "angle",
        "inner_angle",
        "intensity",
        "power",
        "temperature",
        "illuminant",
    ])?;
    let position = table.required("position", Value::vector)?;
    let direction = facing(table, position)?;
    let angle = table.required("angle", |v| {
        v.number_where(|x| x > 0.0 && x <= 180.0, "above 0 and at most 180 degrees")
    })?;
    let narrower = |v: &Value| v.number_where(|x| x >= 0.0 && x <= angle, "from 0 to `angle`");
    let inner = table.optional("inner_angle", narrower)?.unwrap_or(0.75 * angle);
    let (inner_angle, outer_angle) = ((0.5 * inner).to_radians(), (0.5 * angle).to_radians());
    let intensity = strength(table, "intensity", Some(spot_solid_angle(inner_angle, outer_angle)))?;
    Ok(Light::Spot { position, direction, intensity, inner_angle, outer_angle })
}

/// Keys: `direction` (in which the light travels), `irradiance` (on a surface that faces it).
fn directional(table: &Table) -> Read<Light> {
    table.only(&["type", "direction", "irradiance", "temperature", "illuminant"])?;
    Ok(Light::Directional {
        direction: table.required("direction", Value::direction)?,
        irradiance: strength(table, "irradiance", None)?,
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

/// What `key` says, or `power` divided by the power that `key` = 1 gives, if it has one: a colour, or one number beside a lamp.
fn strength(table: &Table, key: &'static str, power_of_one: Option<f32>) -> Read<Emitted> {
    let lamp = lamp(table)?;
    table.exclusive(&[key, "power"])?;
    let given = match (table.get("power"), power_of_one) {
        (Some(power), Some(power_of_one)) => {
            let share = strength_of(&power, lamp.is_some())? / power_of_one;
            if share.is_finite() {
                share
            } else {
                return Err(power.error("too much for the size of the light"));
            }
        }
        _ => table.required(key, |value| strength_of(value, lamp.is_some()))?,
    };
    let Some(lamp) = lamp else { return Ok(given.into()) };
    let emitted = Emitted::by(lamp, given[0]);
    if emitted.rgb.is_finite() { Ok(emitted) } else { Err(table.error("brighter than can be computed")) }
}

/// Red, green and blue; of a lamp, which has its own colour, one number.
fn strength_of(value: &Value, is_lamp: bool) -> Read<Rgb> {
    match is_lamp && value.is_list() {
        true => Err(value.error(
            "must be one number, that of white light as bright: the colour is that of `temperature` or `illuminant`",
        )),
        false => value.rgb(),
    }
}

/// Keys: `temperature` (of a blackbody, K) or `illuminant` (its name); `None` if neither is given.
fn lamp(table: &Table) -> Read<Option<Lamp>> {
    table.exclusive(&["temperature", "illuminant"])?;
    let refused = |value: &Value, error: LampError| value.error(error.to_string());
    if let Some(value) = table.get("temperature") {
        return Lamp::blackbody(value.precise()?).map(Some).map_err(|error| refused(&value, error));
    }
    table.optional("illuminant", |value| {
        Lamp::illuminant(value.text()?).map_err(|error| refused(value, error))
    })
}
