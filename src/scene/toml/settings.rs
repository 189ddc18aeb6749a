//! `[camera]`, `[film]`, `[environment]`, `[subsurface]`, `[render]`.

use super::document::{Read, Table, Value};
use crate::scene::environment::load_environment;
use crate::scene::{
    Camera, ColorMode, Environment, FilmSettings, Filter, Method, ProfileChoice, RenderSettings,
    SubsurfaceSettings,
};

const MAX_SIDE: u32 = 65_536;
/// Largest picture: the film keeps tens of bytes for every pixel.
const MAX_PIXELS: u64 = 1 << 28;

/// Keys: `position`, `target`, `up` (y), `fov` (vertical, 40°), `aperture` (diameter, 0), `focus`
/// (distance, that of the target).
pub fn camera(table: &Table) -> Read<Camera> {
    table.only(&["position", "target", "up", "fov", "aperture", "focus"])?;
    let default = Camera::default();
    let angle = |v: &Value| v.number_where(|x| x > 0.0 && x < 180.0, "between 0 and 180 degrees");
    let camera = Camera {
        position: table.required("position", Value::vector)?,
        target: table.required("target", Value::vector)?,
        up: table.optional("up", Value::direction)?.unwrap_or(default.up),
        vertical_fov: table.optional("fov", angle)?.map_or(default.vertical_fov, f32::to_radians),
        aperture: table.optional("aperture", Value::not_negative)?.unwrap_or(default.aperture),
        focus_distance: table.optional("focus", Value::positive)?,
    };
    let Some(view) = (camera.target - camera.position).try_normalize() else {
        return Err(table.error("`position` and `target` are the same point, or too far apart"));
    };
    // Within 10⁻⁵ the rounding of the target decides what is up.
    if view.cross(camera.up).length() < 1e-5 {
        return Err(table.error("`up` points along the view; choose another direction"));
    }
    Ok(camera)
}

/// Keys: `width` (512), `height` (512), `filter`.
pub fn film(table: &Table) -> Read<FilmSettings> {
    table.only(&["width", "height", "filter"])?;
    let default = FilmSettings::default();
    let side = |v: &Value| v.whole(1, MAX_SIDE);
    let film = FilmSettings {
        width: table.optional("width", side)?.unwrap_or(default.width),
        height: table.optional("height", side)?.unwrap_or(default.height),
        filter: table.optional("filter", |v| v.choice(&Filter::NAMES))?.unwrap_or(default.filter),
    };
    if u64::from(film.width) * u64::from(film.height) > MAX_PIXELS {
        return Err(
            table.error(format!("{} × {} pixels; the limit is {MAX_PIXELS} pixels", film.width, film.height))
        );
    }
    Ok(film)
}

/// Keys: `radiance`, or `image` with `scale` (1) and `rotate` (degrees about +y, 0).
pub fn environment(table: &Table, warnings: &mut Vec<String>) -> Read<Environment> {
    table.only(&["radiance", "image", "scale", "rotate"])?;
    table.exclusive(&["radiance", "image"])?;
    if let Some(image) = table.get("image") {
        let scale = table.optional("scale", Value::not_negative)?.unwrap_or(1.0);
        let rotate = table.optional("rotate", Value::number)?.unwrap_or(0.0);
        return load_environment(&image.existing_file()?, scale, rotate.to_radians(), warnings);
    }
    table.exclusive(&["radiance", "scale"])?;
    table.exclusive(&["radiance", "rotate"])?;
    if !table.has("radiance") {
        return Err(table.error("`radiance` or `image` is missing"));
    }
    Ok(Environment::Constant(table.required("radiance", Value::rgb)?))
}

/// Keys: `method`, `profile`, `accuracy` (0.02), `similarity` (false).
pub fn subsurface(table: &Table) -> Read<SubsurfaceSettings> {
    table.only(&["method", "profile", "accuracy", "similarity"])?;
    let default = SubsurfaceSettings::default();
    let share = |v: &Value| v.number_where(|x| x > 0.0 && x <= 1.0, "above 0, and 1 at most");
    Ok(SubsurfaceSettings {
        method: table.optional("method", |v| v.choice(&Method::NAMES))?.unwrap_or_default(),
        profile: table.optional("profile", |v| v.choice(&ProfileChoice::NAMES))?.unwrap_or_default(),
        accuracy: table.optional("accuracy", share)?.unwrap_or(default.accuracy),
        similarity: table.optional("similarity", Value::boolean)?.unwrap_or_default(),
    })
}

/// Keys: `spp` (64), `max_depth` (0: no limit), `mode`.
pub fn render(table: &Table) -> Read<RenderSettings> {
    table.only(&["spp", "max_depth", "mode"])?;
    let default = RenderSettings::default();
    Ok(RenderSettings {
        spp: table.optional("spp", |v| v.whole(1, u32::MAX))?.unwrap_or(default.spp),
        max_depth: table.optional("max_depth", |v| v.whole(0, u32::MAX))?.unwrap_or(default.max_depth),
        color_mode: table.optional("mode", |v| v.choice(&ColorMode::NAMES))?.unwrap_or_default(),
    })
}
