//! A picture of oak planks, made of value noise.

use glam::DVec3;
use image::codecs::jpeg::JpegEncoder;
use image::{ImageError, Rgb, RgbImage};

use super::distance::smooth_step;

/// Planks across the picture.
const PLANKS: u32 = 4;

/// The picture as JPEG; the planks run along its width, and its edges fit together.
pub fn wood(size: u32) -> Result<Vec<u8>, ImageError> {
    let picture = RgbImage::from_fn(size, size, |x, y| {
        let [u, v] = [x, y].map(|i| (f64::from(i) + 0.5) / f64::from(size));
        Rgb(color(u, v).to_array().map(|c| (255.0 * c.clamp(0.0, 1.0)) as u8))
    });
    let mut jpeg = Vec::new();
    JpegEncoder::new_with_quality(&mut jpeg, 82).encode_image(&picture)?;
    Ok(jpeg)
}

/// sRGB-encoded colour at (u, v) in the unit square.
fn color(u: f64, v: f64) -> DVec3 {
    let across = v * f64::from(PLANKS);
    let plank = across as u32;
    let w = across - f64::from(plank);
    // Year rings cut lengthwise: bands that waver along the plank and crowd to one side.
    let waver = noise(u, 3, w, 2, plank) + 0.35 * noise(u, 11, w, 4, plank + 40);
    let rings = 9.0 * (w + 0.25 * w * w) + 3.2 * waver;
    let saw = rings - rings.floor();
    let late_wood = smooth_step(0.15, 0.85, saw) * smooth_step(1.0, 0.9, saw);
    let pores = noise(u, 40, v, 400, 7) * noise(u, 90, v, 700, 8);
    let tone = 0.25 * noise(0.5, 1, 0.5, 1, plank * 17 + 3);
    let light = DVec3::new(0.72, 0.54, 0.36);
    let dark = DVec3::new(0.50, 0.33, 0.19);
    let share = 0.15 + tone + 0.5 * late_wood + 0.45 * pores;
    let gap = smooth_step(0.0, 0.012, w.min(1.0 - w));
    light.lerp(dark, share) * (0.25 + 0.75 * gap)
}

/// Smooth noise in [0, 1] with `nu` × `nv` cells over the unit square, periodic.
fn noise(u: f64, nu: u32, v: f64, nv: u32, seed: u32) -> f64 {
    let (x, y) = (u * f64::from(nu), v * f64::from(nv));
    let (i, j) = (x as u32, y as u32);
    let (s, t) = (smooth_step(0.0, 1.0, x - f64::from(i)), smooth_step(0.0, 1.0, y - f64::from(j)));
    let at = |di: u32, dj: u32| hash((i + di) % nu, (j + dj) % nv, seed);
    let low = at(0, 0) + (at(1, 0) - at(0, 0)) * s;
    let high = at(0, 1) + (at(1, 1) - at(0, 1)) * s;
    low + (high - low) * t
}

/// A number in [0, 1) from three integers.
fn hash(a: u32, b: u32, c: u32) -> f64 {
    let mut h = a.wrapping_mul(0x9E37_79B1) ^ b.wrapping_mul(0x85EB_CA77) ^ c.wrapping_mul(0xC2B2_AE3D);
    h = (h ^ (h >> 15)).wrapping_mul(0x2C1B_3C6D);
    h = (h ^ (h >> 12)).wrapping_mul(0x297A_2D39);
    f64::from(h ^ (h >> 15)) / 4_294_967_296.0
}
