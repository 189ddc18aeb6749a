//! Pictures as OpenEXR: 32-bit float, linear Rec.709, row 0 at the top.

use std::fs::File;
use std::io::{self, BufReader, Seek, Write};
use std::path::Path;

use ::exr::block;
use ::exr::meta::attribute::Chromaticities;
use ::exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Blocks, Compression, Encoding, Error as ExrError, FlatSamples,
    Image, Layer, LayerAttributes, LineOrder, ReadChannels, ReadLayers, Text, Vec2, WritableImage, read,
};
use thiserror::Error;

use super::layers::Channel;
use super::{FilmError, Picture, check_size};
use crate::radiometry::Rgb;

/// A header attribute: name and text.
pub type Attribute = (&'static str, String);

/// Why a picture cannot be read.
#[derive(Debug, Error)]
pub enum ReadError {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Io(#[from] io::Error),
    /// The file is not OpenEXR, is damaged, or has no channels R, G and B.
    #[error("is not an OpenEXR file with channels R, G and B: {0}")]
    Format(String),
    /// The picture is empty or too large.
    #[error(transparent)]
    Size(#[from] FilmError),
}

/// Writes `picture` with `channels` beside it and `attributes` in the header. PIZ compression, which
/// loses nothing.
pub fn write(
    to: &mut (impl Write + Seek),
    picture: &Picture,
    channels: &[Channel],
    attributes: &[Attribute],
) -> io::Result<()> {
    let color = ["R", "G", "B"].into_iter().enumerate().map(|(index, name)| {
        let values = picture.pixels.iter().map(|pixel| pixel[index]).collect();
        AnyChannel::new(name, FlatSamples::F32(values))
    });
    let layers = channels
        .iter()
        .map(|channel| AnyChannel::new(channel.name, FlatSamples::F32(channel.values.clone())));
    let encoding = Encoding {
        compression: Compression::PIZ,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let layer = Layer::new(
        (picture.width as usize, picture.height as usize),
        header(attributes),
        encoding,
        AnyChannels::sort(color.chain(layers).collect()),
    );
    let mut image = Image::from_layer(layer);
    image.attributes.chromaticities = Some(REC_709);
    image.write().to_buffered(to).map_err(|error| match error {
        ExrError::Io(error) => error,
        other => io::Error::other(other.to_string()),
    })
}

/// Primaries and white (D65) of ITU-R BT.709-6.
const REC_709: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.30, 0.60),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.3290),
};

fn header(attributes: &[Attribute]) -> LayerAttributes {
    LayerAttributes {
        software_name: Some(text(concat!("alabaster ", env!("CARGO_PKG_VERSION")))),
        other: attributes
            .iter()
            .map(|(name, value)| (text(name), AttributeValue::Text(text(value))))
            .collect(),
        ..LayerAttributes::default()
    }
}

/// Text as UTF-8. (The crate's own conversion is to Latin-1 and panics on other characters.)
fn text(string: &str) -> Text {
    Text::from_slice_unchecked(string.as_bytes())
}

/// Reads channels R, G and B of the first layer that has them.
///
/// The header is read and its dimensions are bounded before memory is asked for: a damaged header
/// can name any size.
pub fn read_picture(path: &Path) -> Result<Picture, ReadError> {
    let file = BufReader::new(File::open(path)?);
    let chunks = block::read(file, false).map_err(read_error)?;
    for header in chunks.headers() {
        let Vec2(width, height) = header.layer_size;
        check_size(side(width), side(height))?;
    }
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |Vec2(width, height), _| Picture {
                width: side(width),
                height: side(height),
                pixels: vec![Rgb::ZERO; width * height],
            },
            |picture: &mut Picture, Vec2(x, y), (r, g, b): (f32, f32, f32)| {
                picture.pixels[y * picture.width as usize + x] = Rgb::new(r, g, b);
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_chunks(chunks)
        .map_err(read_error)?;
    Ok(image.layer_data.channel_data.pixels)
}

fn side(length: usize) -> u32 {
    u32::try_from(length).unwrap_or(u32::MAX)
}

fn read_error(error: ExrError) -> ReadError {
    match error {
        ExrError::Io(error) => ReadError::Io(error),
        other => ReadError::Format(other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;

    fn odd_picture() -> Picture {
        let value = |i: u32| (i as f32 * 0.37).exp() * if i % 7 == 0 { -1.0 } else { 1e-3 };
        let pixels = (0..5 * 33).map(|i| Rgb::new(value(i), i as f32, f32::MIN_POSITIVE)).collect();
        Picture { width: 5, height: 33, pixels }
    }

    fn encode(picture: &Picture, channels: &[Channel], attributes: &[Attribute]) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        write(&mut bytes, picture, channels, attributes).unwrap();
        bytes.into_inner()
    }

    fn decode(bytes: &[u8]) -> Result<Picture, ReadError> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), bytes).unwrap();
        read_picture(file.path())
    }

    #[test]
    fn pixels_come_back_bit_for_bit() {
        let picture = odd_picture();
        let samples = Channel { name: "samples", values: vec![3.0; 5 * 33] };
        assert_eq!(decode(&encode(&picture, &[samples], &[])).unwrap(), picture);
    }

    #[test]
    fn attributes_and_layers_stand_in_the_file() {
        let variance = Channel { name: "variance.R", values: vec![f32::INFINITY; 5 * 33] };
        let attributes = [("alabaster.commandLine", "render κερί.toml -o \"a b.exr\"".repeat(20))];
        let bytes = encode(&odd_picture(), &[variance.clone()], &attributes);
        let image = read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_buffered(Cursor::new(bytes))
            .unwrap();
        let own = &image.layer_data.attributes;
        assert_eq!(own.other[&text("alabaster.commandLine")], AttributeValue::Text(text(&attributes[0].1)));
        let software = own.software_name.clone().unwrap().to_string();
        assert_eq!(software, format!("alabaster {}", env!("CARGO_PKG_VERSION")));
        let channels = &image.layer_data.channel_data.list;
        let names: Vec<String> = channels.iter().map(|channel| channel.name.to_string()).collect();
        assert_eq!(names, ["B", "G", "R", "variance.R"]);
        assert_eq!(channels[3].sample_data, FlatSamples::F32(variance.values));
    }

    /// Every truncation, and in every byte the lowest, the highest or all bits flipped: an error or
    /// a picture, no panic, no allocation that aborts.
    #[test]
    fn damaged_files_are_refused() {
        let picture = Picture { width: 4, height: 3, pixels: vec![Rgb::splat(0.25); 12] };
        let whole = encode(&picture, &[], &[("alabaster.seed", "1".into())]);
        for length in 0..whole.len() {
            decode(&whole[..length]).unwrap_err();
        }
        for (position, flip) in (0..whole.len()).flat_map(|at| [1, 0x80, 0xff].map(|flip| (at, flip))) {
            let mut bytes = whole.clone();
            bytes[position] ^= flip;
            if let Ok(picture) = decode(&bytes) {
                assert_eq!(picture.pixels.len(), picture.width as usize * picture.height as usize);
            }
        }
    }
}
