//! Pictures as 8-bit PNG, for people.

use std::io::{self, Write};

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageError};

use super::Picture;
use super::view::View;

/// Writes `picture` as seen through `view` after `exposure` EV.
pub fn write(to: &mut impl Write, picture: &Picture, view: View, exposure: f32) -> io::Result<()> {
    let bytes: Vec<u8> = picture.pixels.iter().flat_map(|&pixel| view.encode(pixel, exposure)).collect();
    write_srgb(to, [picture.width, picture.height], &bytes)
}

/// Writes 8-bit sRGB pixels, row by row from the top, of a picture of `size` (width, height).
pub fn write_srgb(to: &mut impl Write, size: [u32; 2], bytes: &[u8]) -> io::Result<()> {
    PngEncoder::new(to).write_image(bytes, size[0], size[1], ExtendedColorType::Rgb8).map_err(|error| {
        match error {
            ImageError::IoError(error) => error,
            other => io::Error::other(other),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::radiometry::Rgb;

    #[test]
    fn the_first_pixel_is_the_upper_left_one() {
        let picture = Picture { width: 2, height: 2, pixels: [1.0, 0.0, 0.0, 0.0].map(Rgb::splat).to_vec() };
        let mut bytes = Vec::new();
        write(&mut bytes, &picture, View::Srgb, 0.0).unwrap();
        let read = image::load_from_memory(&bytes).unwrap().to_rgb8();
        assert_eq!(read.into_raw(), [255, 255, 255, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
    }
}
