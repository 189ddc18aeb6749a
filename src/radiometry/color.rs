//! Colour spaces: linear Rec.709, its luminance, the way to it from XYZ, and the sRGB transfer curve.

use std::sync::LazyLock;

use glam::{DMat3, DVec3};

use super::Rgb;
use super::spectrum::illuminant::Illuminant;

/// x and y of the primaries red, green, blue (ITU-R BT.709-6).
const PRIMARIES: [[f64; 2]; 3] = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]];

/// Linear Rec.709 to XYZ. White is that of [`Illuminant::D65`] by its spectrum: a surface that reflects all wavelengths
/// alike, under D65, has three equal channels, exactly.
pub static RGB_TO_XYZ: LazyLock<DMat3> = LazyLock::new(|| {
    let [red, green, blue] = PRIMARIES.map(|[x, y]| DVec3::new(x / y, 1.0, (1.0 - x - y) / y));
    let luminances = DMat3::from_cols(red, green, blue).inverse() * DVec3::from(Illuminant::D65.white());
    DMat3::from_cols(red * luminances.x, green * luminances.y, blue * luminances.z)
});

/// XYZ to linear Rec.709, not clipped; the inverse of [`RGB_TO_XYZ`].
pub static XYZ_TO_RGB: LazyLock<DMat3> = LazyLock::new(|| RGB_TO_XYZ.inverse());

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_matrix_is_that_of_the_standard() {
        // IEC 61966-2-1, four digits; its white is D65 to four digits of x and y.
        let published = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]];
        for (row, published) in published.iter().enumerate() {
            for (column, published) in published.iter().enumerate() {
                let got = RGB_TO_XYZ.col(column)[row];
                assert!((got - published).abs() < 4e-4, "{row} {column}: {got}");
            }
        }
        let white = *XYZ_TO_RGB * DVec3::from(Illuminant::D65.white());
        assert!((white - DVec3::ONE).abs().max_element() < 8.0 * f64::EPSILON, "{white}");
        // Luminance by the same row.
        let y = RGB_TO_XYZ.row(1);
        let luminance = Rgb::new(1.0, 0.0, 0.0).luminance();
        assert!((y.x - f64::from(luminance)).abs() < 4e-4);
    }
}
