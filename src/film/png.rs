//! Pictures as 8-bit PNG, for people.

use std::io::{self, Write};

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageError};

use super::Picture;
use super::view::View;

/// Writes `picture` as seen through `view` after `exposure` EV.
pub fn write(to: &mut impl Write, picture: &Picture, view: View, exposure: f32) -> io::Result<()> {
    let bytes: Vec<u8> = picture.pixels.iter().flat_map(|&pixel| view.encode(pixel, exposure)).collect();
    PngEncoder::new(to).write_image(&bytes, picture.width, picture.height, ExtendedColorType::Rgb8).map_err(
        |error| match error {
            ImageError::IoError(error) => error,
            other => io::Error::other(other),
        },
    )
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
