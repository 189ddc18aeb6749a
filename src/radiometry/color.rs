//! Colour spaces: linear Rec.709, its luminance, and the sRGB transfer curve.

use super::Rgb;

impl Rgb {
    /// Luminance Y of linear Rec.709 (ITU-R BT.709-6).
    pub fn luminance(self) -> f32 {
        0.2126 * self[0] + 0.7152 * self[1] + 0.0722 * self[2]
    }
}

/// sRGB-encoded value in [0, 1] to linear (IEC 61966-2-1).
pub fn srgb_to_linear(encoded: f32) -> f32 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// Linear value in [0, 1] to sRGB-encoded (IEC 61966-2-1).
pub fn linear_to_srgb(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}
