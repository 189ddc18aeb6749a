//! Pictures as OpenEXR: 32-bit float, linear Rec.709, row 0 at the top.

use std::io::{self, Seek, Write};
use std::path::Path;

use ::exr::error::Error as CodecError;
use ::exr::meta::attribute::Chromaticities;
use ::exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Blocks, Compression, Encoding, FlatSamples, Image, Layer,
    LayerAttributes, LineOrder, Text, Vec2, WritableImage,
};
use thiserror::Error;

use super::layers::Channel;
use super::{FilmError, Picture, check_size};
use crate::open_exr::{ExrError, ExrFile, has_channels};
use crate::radiometry::{Rgb, Spectrum};

/// A header attribute: name and text.
pub type Attribute = (&'static str, String);

/// Why a picture cannot be read.
#[derive(Debug, Error)]
pub enum ReadError {
    /// The file is not an OpenEXR picture that can be read.
    #[error(transparent)]
    File(#[from] ExrError),
    /// The picture is empty or too large.
    #[error(transparent)]
    Size(#[from] FilmError),
}

/// What a file holds of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureFile {
    /// The colour: channels R, G and B, or Y.
    pub picture: Picture,
    /// Variance of the mean by pixel, (W/(m² sr))²: channels variance.R, .G, .B, where they are there.
    pub variance: Option<Vec<Rgb>>,
    /// Where in the frame the upper left pixel stands: column, row (the corner of the data window in the
    /// display window; both may be negative, and pixels may lie outside of the frame).
    pub position: [i64; 2],
    /// Width and height of the frame (the display window), of which the pixels may be a part.
    pub frame: [u64; 2],
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
        CodecError::Io(error) => error,
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

/// Names of the channels of [`Layer::Variance`](super::layers::Layer::Variance).
const VARIANCE: [&str; 3] = ["variance.R", "variance.G", "variance.B"];

/// Reads a picture: the first layer that has a colour.
///
/// The headers are read and their dimensions are bounded before memory is asked for: a damaged header
/// can name any size.
pub fn read(path: &Path) -> Result<PictureFile, ReadError> {
    let file = ExrFile::open(path)?;
    for header in file.headers() {
        check_size(side(header.layer_size.width()), side(header.layer_size.height()))?;
    }
    let (layer, [r, g, b]) = file.color()?;
    let header = &file.headers()[layer];
    let (width, height) = (side(header.layer_size.width()), side(header.layer_size.height()));
    let (window, at) = (header.shared_attributes.display_window, header.own_attributes.layer_position);
    let position = [(at.x(), window.position.x()), (at.y(), window.position.y())]
        .map(|(a, b)| i64::from(a) - i64::from(b));
    let frame = [window.size.width() as u64, window.size.height() as u64];
    let (pixels, variance) = if has_channels(header, &VARIANCE) {
        let all = file.read_pixels(layer, [r, g, b, VARIANCE[0], VARIANCE[1], VARIANCE[2]])?;
        let split = all.into_iter().map(|[r, g, b, x, y, z]| (Rgb::new(r, g, b), Rgb::new(x, y, z)));
        let (pixels, variance) = split.unzip();
        (pixels, Some(variance))
    } else {
        (file.read_pixels(layer, [r, g, b])?.into_iter().map(Spectrum).collect(), None)
    };
    Ok(PictureFile { picture: Picture { width, height, pixels }, variance, position, frame })
}

/// Reads the colour alone, wherever it stands in its frame.
pub fn read_picture(path: &Path) -> Result<Picture, ReadError> {
    Ok(read(path)?.picture)
}

fn side(length: usize) -> u32 {
    u32::try_from(length).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use ::exr::prelude::{ReadChannels, ReadLayers};

    use super::*;

    fn odd_picture() -> Picture {
        let value = |i: u32| (i as f32 * 0.37).exp() * if i.is_multiple_of(7) { -1.0 } else { 1e-3 };
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
    fn variance_comes_back_where_it_is() {
        let picture = odd_picture();
        let file = tempfile::NamedTempFile::new().unwrap();
        let layer = |name, value| Channel { name, values: vec![value; 5 * 33] };
        let variance =
            [layer("variance.R", 1.0), layer("variance.B", 3.0), layer("variance.G", f32::INFINITY)];
        std::fs::write(file.path(), encode(&picture, &variance, &[])).unwrap();
        let expected = PictureFile {
            picture: picture.clone(),
            variance: Some(vec![Rgb::new(1.0, f32::INFINITY, 3.0); 5 * 33]),
            position: [0, 0],
            frame: [5, 33],
        };
        assert_eq!(read(file.path()).unwrap(), expected);
        std::fs::write(file.path(), encode(&picture, &variance[..2], &[])).unwrap();
        assert_eq!(read(file.path()).unwrap(), PictureFile { variance: None, ..expected });
    }

    /// A layer of one channel `name` in half floats, 4 × 3 pixels at (−1, 2) of a frame of 10 × 8 at (0, 1).
    fn foreign(name: &str) -> Vec<u8> {
        let values = (0..12_u8).map(|i| ::exr::prelude::f16::from_f32(f32::from(i))).collect();
        let channels =
            AnyChannels::sort([AnyChannel::new(name, FlatSamples::F16(values))].into_iter().collect());
        let encoding = Encoding::SMALL_LOSSLESS;
        let attributes = LayerAttributes { layer_position: Vec2(-1, 2), ..LayerAttributes::default() };
        let mut image = Image::from_layer(Layer::new((4, 3), attributes, encoding, channels));
        image.attributes.display_window = ::exr::prelude::IntegerBounds::new((0, 1), (10, 8));
        let mut bytes = Cursor::new(Vec::new());
        image.write().to_buffered(&mut bytes).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn a_part_of_a_grey_frame_is_read_with_its_place() {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), foreign("Y")).unwrap();
        let read = read(file.path()).unwrap();
        assert_eq!((read.position, read.frame), ([-1, 1], [10, 8]));
        assert_eq!((read.picture.width, read.picture.height), (4, 3));
        assert_eq!(read.picture.pixels[7], Rgb::splat(7.0));
    }

    #[test]
    fn a_file_without_colour_says_what_it_has() {
        let error = decode(&foreign("ViewLayer.Combined.R")).unwrap_err().to_string();
        assert!(error.contains("without channels R, G, B or Y; it has ViewLayer.Combined.R"), "{error}");
    }

    #[test]
    fn attributes_and_layers_stand_in_the_file() {
        let variance = Channel { name: "variance.R", values: vec![f32::INFINITY; 5 * 33] };
        let attributes = [("alabaster.commandLine", "render κερί.toml -o \"a b.exr\"".repeat(20))];
        let bytes = encode(&odd_picture(), std::slice::from_ref(&variance), &attributes);
        let image = ::exr::prelude::read()
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
