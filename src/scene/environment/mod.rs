//! Environment maps: reading them, and looking radiance up by direction.

use std::f32::consts::{PI, TAU};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use glam::{Mat3, Vec2, Vec3};
use image::ImageDecoder;
use image::codecs::hdr::HdrDecoder;

use super::{Environment, SceneError};
use crate::open_exr::{ExrError, ExrFile};
use crate::radiometry::{Rgb, Spectrum};

/// Largest map that is read: 16,384 × 8,192 pixels take 1.6 GB.
const MAX_PIXELS: usize = 1 << 27;

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

fn read_exr(path: &Path) -> Result<ImagePixels, SceneError> {
    let unreadable = |e: ExrError| SceneError::file(path, e.to_string());
    let file = ExrFile::open(path).map_err(unreadable)?;
    for header in file.headers() {
        pixel_count(path, header.layer_size.width(), header.layer_size.height())?;
    }
    let (layer, names) = file.color().map_err(unreadable)?;
    let size = file.headers()[layer].layer_size;
    let samples = file.read_pixels(layer, names).map_err(unreadable)?;
    Ok((size.width(), size.height(), samples.into_iter().map(Spectrum).collect()))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_and_coordinates_are_inverse() {
        // Landmarks of the mapping.
        for (direction, uv) in [
            (Vec3::NEG_Z, Vec2::new(0.5, 0.5)),
            (Vec3::X, Vec2::new(0.75, 0.5)),
            (Vec3::NEG_X, Vec2::new(0.25, 0.5)),
            (Vec3::Y, Vec2::new(0.5, 0.0)),
        ] {
            let got = direction_to_uv(direction);
            assert!(got.y == uv.y && (got.x == uv.x || direction == Vec3::Y), "{direction} {got}");
        }
        for i in 0..64 {
            for j in 0..64 {
                let uv = Vec2::new((i as f32 + 0.5) / 64.0, (j as f32 + 0.5) / 64.0);
                let direction = uv_to_direction(uv);
                // A few ulps of angles up to π; near the poles u is known only relative to sin θ.
                let error = (direction_to_uv(direction) - uv).abs();
                let tolerance = 4.0 * f32::EPSILON;
                assert!(error.y <= tolerance && error.x * (PI * uv.y).sin() <= tolerance, "{uv}: {error}");
                assert!((direction.length() - 1.0).abs() <= 2.0 * f32::EPSILON);
            }
        }
    }

    fn map(rotation: Mat3) -> Environment {
        let radiance = (0..32).map(|i| Rgb::splat(i as f32)).collect();
        Environment::Map { width: 8, height: 4, radiance, rotation }
    }

    #[test]
    fn look_up_is_exact_at_pixel_centres_and_linear_between() {
        let environment = map(Mat3::IDENTITY);
        let at = |x: f32, y: f32| environment.radiance(uv_to_direction(Vec2::new(x / 8.0, y / 4.0)))[0];
        // Pixel values up to 31 times a few ulps of the coordinates, which 8 pixels multiply.
        let close = |a: f32, b: f32| (a - b).abs() < 31.0 * 8.0 * 8.0 * f32::EPSILON;
        for i in 0..32 {
            assert!(close(at((i % 8) as f32 + 0.5, (i / 8) as f32 + 0.5), i as f32));
        }
        assert!(close(at(3.0, 1.5), 10.5));
        assert!(close(at(2.5, 2.0), 14.0));
        // Across the seam, pixels 7 and 0 of row 2; beyond the pole, row 0 itself.
        assert!(close(at(8.0, 2.5), 19.5));
        assert!(close(at(2.5, 0.1), 2.0));
    }

    #[test]
    fn rotation_turns_the_map_counter_clockwise_seen_from_above() {
        // What was seen ahead (−z) is seen to the left (−x) after a quarter turn about +y.
        let (plain, turned) = (map(Mat3::IDENTITY), map(Mat3::from_rotation_y(-PI / 2.0)));
        let (ahead, left) = (plain.radiance(Vec3::NEG_Z)[0], turned.radiance(Vec3::NEG_X)[0]);
        assert!((ahead - left).abs() < 31.0 * 8.0 * 8.0 * f32::EPSILON, "{ahead} {left}");
    }
}
