//! Environment maps: reading them, and looking radiance up by direction.

use std::f32::consts::{PI, TAU};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use exr::math::Vec2 as ExrVec2;
use exr::meta::header::Header;
use exr::prelude::{ReadChannels, ReadLayers, ReadSpecificChannel};
use glam::{Mat3, Vec2, Vec3};
use image::ImageDecoder;
use image::codecs::hdr::HdrDecoder;

use super::{Environment, SceneError};
use crate::radiometry::{Rgb, Spectrum};

/// Largest map that is read: 16,384 × 8,192 pixels take 1.6 GB.
const MAX_PIXELS: usize = 1 << 27;

/// Largest block of an EXR file that is decoded: 32 lines of 16,384 pixels of 16 float channels.
const MAX_BLOCK_BYTES: usize = 32 * 16_384 * 64;

/// An image in memory: width, height, row-major pixels.
type ImagePixels = (usize, usize, Vec<Rgb>);

/// Reads the equirectangular map at `path` (`.hdr` or `.exr`, linear Rec.709), multiplies it by
/// `scale` and turns it by `rotation` radians about +y (counter-clockwise seen from above).
///
/// Values that are negative or not finite become 0 and are counted in `warnings`.
pub fn load_environment(
    path: &Path,
    scale: f32,
    rotation: f32,
    warnings: &mut Vec<String>,
) -> Result<Environment, SceneError> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let (width, height, mut radiance) = match extension.as_str() {
        "hdr" => read_hdr(path)?,
        "exr" => read_exr(path)?,
        _ => return Err(SceneError::file(path, "an environment map must be a .hdr or .exr file")),
    };
    let mut rejected = 0;
    for pixel in &mut radiance {
        let scaled = *pixel * scale;
        *pixel = scaled.map(|x| if x.is_finite() { x.max(0.0) } else { 0.0 });
        rejected += usize::from(*pixel != scaled);
    }
    if rejected > 0 {
        warnings.push(format!(
            "{}: {rejected} of {} pixels had negative or non-finite values; these were set to 0",
            path.display(),
            radiance.len()
        ));
    }
    Ok(Environment::Map { width, height, radiance, rotation: Mat3::from_rotation_y(-rotation) })
}

/// The number of pixels, if it is one that a map can have.
fn pixel_count(path: &Path, width: usize, height: usize) -> Result<usize, SceneError> {
    let count = width.checked_mul(height).filter(|n| (1..=MAX_PIXELS).contains(n));
    count.ok_or_else(|| {
        SceneError::file(
            path,
            format!("a map of {width} × {height} pixels; the limit is {MAX_PIXELS} pixels"),
        )
    })
}

fn open(path: &Path) -> Result<BufReader<File>, SceneError> {
    let file = File::open(path).map_err(|e| SceneError::file(path, e.to_string()))?;
    Ok(BufReader::new(file))
}

fn read_hdr(path: &Path) -> Result<ImagePixels, SceneError> {
    let unreadable = |e: image::ImageError| SceneError::file(path, format!("not a readable HDR image: {e}"));
    let decoder = HdrDecoder::new(open(path)?).map_err(unreadable)?;
    let (width, height) = decoder.dimensions();
    let (width, height) = (width as usize, height as usize);
    let count = pixel_count(path, width, height)?;
    let mut samples = vec![[0.0_f32; 3]; count];
    decoder.read_image(bytemuck::cast_slice_mut(&mut samples)).map_err(unreadable)?;
    Ok((width, height, samples.into_iter().map(Spectrum).collect()))
}

/// Reads the first layer's channels R, G, B, or else Y.
fn read_exr(path: &Path) -> Result<ImagePixels, SceneError> {
    let unreadable = |e: exr::error::Error| SceneError::file(path, format!("not a readable EXR image: {e}"));
    let chunks = exr::block::read(open(path)?, false).map_err(unreadable)?;
    // A damaged header may ask for any amount of memory, so it is judged before any is given.
    let colored = check_exr_headers(path, chunks.headers())?;
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .optional("R", 0.0_f32)
        .optional("G", 0.0_f32)
        .optional("B", 0.0_f32)
        .optional("Y", 0.0_f32)
        .collect_pixels(
            |size, _| (size, vec![Rgb::ZERO; size.area()]),
            move |(size, pixels): &mut (ExrVec2<usize>, Vec<Rgb>), at, (r, g, b, y): (f32, f32, f32, f32)| {
                if let Some(pixel) = pixels.get_mut(at.y() * size.width() + at.x()) {
                    *pixel = if colored { Rgb::new(r, g, b) } else { Rgb::splat(y) };
                }
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_chunks(chunks)
        .map_err(unreadable)?;
    let (size, pixels) = image.layer_data.channel_data.pixels;
    Ok((size.width(), size.height(), pixels))
}

/// Whether the first layer has the channels R, G and B rather than Y, if it can be read at all.
fn check_exr_headers(path: &Path, headers: &[Header]) -> Result<bool, SceneError> {
    let refuse = |problem: String| Err(SceneError::file(path, problem));
    for header in headers {
        pixel_count(path, header.layer_size.width(), header.layer_size.height())?;
        if header.max_block_byte_size() > MAX_BLOCK_BYTES {
            return refuse(format!(
                "a block of {} bytes: the header is damaged",
                header.max_block_byte_size()
            ));
        }
    }
    let Some(header) = headers.first() else { return refuse("no layers".into()) };
    if header.deep {
        return refuse("deep images are not environment maps".into());
    }
    let channels = &header.channels.list;
    if channels.iter().any(|c| c.sampling != ExrVec2(1, 1)) {
        return refuse("channels of lower resolution (chroma subsampling) are not supported".into());
    }
    let names: Vec<String> = channels.iter().map(|c| c.name.to_string()).collect();
    let has = |name: &str| names.iter().any(|n| n == name);
    let colored = has("R") && has("G") && has("B");
    if !colored && !has("Y") {
        return refuse(format!("channels R, G, B or Y are needed; the first layer has {}", names.join(", ")));
    }
    Ok(colored)
}

impl Environment {
    /// Radiance that arrives from the unit `direction`, W/(m² sr). Maps are interpolated bilinearly
    /// between pixel centres, across the left and right edge, not across the poles.
    pub fn radiance(&self, direction: Vec3) -> Rgb {
        match self {
            Self::Constant(radiance) => *radiance,
            Self::Map { width, height, radiance, rotation } => {
                let uv = direction_to_uv(*rotation * direction);
                let (left, right, across) = neighbours(uv.x * *width as f32 - 0.5, *width, true);
                let (top, bottom, down) = neighbours(uv.y * *height as f32 - 0.5, *height, false);
                let row = |y: usize| {
                    radiance[y * width + left] * (1.0 - across) + radiance[y * width + right] * across
                };
                row(top) * (1.0 - down) + row(bottom) * down
            }
        }
    }
}

/// The pixels around `x` on an axis of `count` pixels, and how far `x` is from the first to the
/// second. Beyond the ends the axis either comes around or stands still.
fn neighbours(x: f32, count: usize, periodic: bool) -> (usize, usize, f32) {
    let floor = x.floor();
    let clamp = |i: i64| {
        let count = count as i64;
        (if periodic { i.rem_euclid(count) } else { i.clamp(0, count - 1) }) as usize
    };
    (clamp(floor as i64), clamp(floor as i64 + 1), x - floor)
}

/// Where in an equirectangular map a direction (of any length) of the map's own frame is found:
/// u and v in [0, 1], v = 0 at +y, u = 0.5 at −z, u = 0.75 at +x.
pub fn direction_to_uv(direction: Vec3) -> Vec2 {
    let Vec3 { x, y, z } = direction;
    Vec2::new(0.5 + x.atan2(-z) / TAU, x.hypot(z).atan2(y) / PI)
}

/// The unit direction at `uv`; inverse of [`direction_to_uv`].
pub fn uv_to_direction(uv: Vec2) -> Vec3 {
    let (sin_phi, cos_phi) = (TAU * (uv.x - 0.5)).sin_cos();
    let (sin_theta, cos_theta) = (PI * uv.y).sin_cos();
    Vec3::new(sin_theta * sin_phi, cos_theta, -sin_theta * cos_phi)
}
