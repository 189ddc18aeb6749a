//! Joins pictures of one height side by side into a JPEG, as the documentation shows them:
//! `cargo run --release --example side_by_side -- out.jpg a.png b.png c.png`

use std::error::Error;
use std::fs::File;
use std::io::BufWriter;

use image::codecs::jpeg::JpegEncoder;
use image::{GenericImage, RgbImage};

const QUALITY: u8 = 88;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args_os().skip(1);
    let output = arguments.next().ok_or("usage: side_by_side OUT.jpg IN.png...")?;
    let pictures: Vec<RgbImage> =
        arguments.map(|path| Ok(image::open(path)?.into_rgb8())).collect::<Result<_, image::ImageError>>()?;
    let width = pictures.iter().map(RgbImage::width).sum();
    let height = pictures.iter().map(RgbImage::height).max().unwrap_or(0);
    let mut joined = RgbImage::new(width, height);
    let mut left = 0;
    for picture in &pictures {
        joined.copy_from(picture, left, 0)?;
        left += picture.width();
    }
    let file = BufWriter::new(File::create(output)?);
    JpegEncoder::new_with_quality(file, QUALITY).encode_image(&joined)?;
    Ok(())
}
