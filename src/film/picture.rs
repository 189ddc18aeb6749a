//! A finished picture.

use crate::radiometry::Rgb;

/// Linear Rec.709 radiance by pixel, W/(m² sr).
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Row-major pixels from the top.
    pub pixels: Vec<Rgb>,
}
