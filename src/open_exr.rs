//! Reading OpenEXR files that may be damaged.
//!
//! The exr crate believes the sizes in headers and blocks and allocates what they ask for, up to
//! aborting the process. So blocks are decoded here one by one, each after its sizes are judged.

use std::fs::File;
use std::io::{self, BufReader};
use std::path::Path;

use exr::block::chunk::{Chunk, CompressedBlock};
use exr::block::lines::LineRef;
use exr::block::reader::Reader;
use exr::block::{BlockIndex, UncompressedBlock};
use exr::error::{Error, Result};
use exr::math::Vec2;
use exr::meta::attribute::{Compression, SampleType};
use exr::meta::header::Header;
use exr::prelude::f16;
use thiserror::Error as ThisError;

/// Largest block that is decoded: 256 lines (DWAB) of 16,384 pixels of 4 float channels.
const MAX_BLOCK_BYTES: usize = 1 << 26;

/// Names of channels that a message lists.
const MAX_NAMES: usize = 12;

/// Why a file cannot be read.
#[derive(Debug, ThisError)]
pub enum ExrError {
    /// The machine cannot read it.
    #[error("cannot be read: {0}")]
    Io(#[from] io::Error),
    /// It is something else, or damaged, or of a kind that is not supported.
    #[error("is not an OpenEXR file that can be read: {0}")]
    Format(String),
    /// No layer has the channels of a colour.
    #[error(
        "is an OpenEXR file without channels R, G, B or Y; it has {0}; write the picture with these names"
    )]
    NoColor(String),
}

impl From<Error> for ExrError {
    fn from(error: Error) -> Self {
        match error {
            Error::Io(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
                Self::Format("it ends too early".into())
            }
            Error::Io(error) => Self::Io(error),
            other => Self::Format(other.to_string()),
        }
    }
}

/// A file of which the headers are read.
pub struct ExrFile {
    reader: Reader<BufReader<File>>,
}

impl ExrFile {
    /// Opens a file and reads its headers. They can name any size: judge it before reading pixels.
    pub fn open(path: &Path) -> std::result::Result<Self, ExrError> {
        let file = BufReader::new(File::open(path)?);
        Ok(Self { reader: exr::block::read(file, false)? })
    }

    /// A header for each layer.
    pub fn headers(&self) -> &[Header] {
        self.reader.headers()
    }

    /// The first layer that has channels R, G and B, else the first that has Y, and the names of its channels
    /// for red, green and blue.
    pub fn color(&self) -> std::result::Result<(usize, [&'static str; 3]), ExrError> {
        for names in [["R", "G", "B"], ["Y"; 3]] {
            if let Some(layer) = self.headers().iter().position(|header| has_channels(header, &names)) {
                return Ok((layer, names));
            }
        }
        let channels = self.headers().iter().flat_map(|header| &header.channels.list);
        let mut names: Vec<String> = channels.map(|channel| channel.name.to_string()).collect();
        if names.len() > MAX_NAMES {
            names.truncate(MAX_NAMES);
            names.push("more".into());
        }
        Err(ExrError::NoColor(names.join(", ")))
    }

    /// Reads the channels `names` of a layer: row-major pixels from the top. A channel that is not there is 0.
    pub fn read_pixels<const N: usize>(
        self,
        layer: usize,
        names: [&str; N],
    ) -> std::result::Result<Vec<[f32; N]>, ExrError> {
        let Some(header) = self.headers().get(layer).cloned() else {
            return Err(ExrError::Format(format!("there is no layer {layer}")));
        };
        check_header(&header).map_err(ExrError::Format)?;
        Ok(decode(self.reader, layer, &header, names)?)
    }
}

/// Whether a layer has all of these channels.
pub fn has_channels(header: &Header, names: &[&str]) -> bool {
    names.iter().all(|name| header.channels.list.iter().any(|channel| channel.name == **name))
}

fn check_header(header: &Header) -> std::result::Result<(), String> {
    if header.deep {
        return Err("deep images are not supported".into());
    }
    if header.channels.list.iter().any(|channel| channel.sampling != Vec2(1, 1)) {
        return Err("channels of lower resolution (chroma subsampling) are not supported".into());
    }
    if header.max_block_byte_size() > MAX_BLOCK_BYTES {
        return Err(format!(
            "blocks of {} bytes; the limit is {MAX_BLOCK_BYTES}",
            header.max_block_byte_size()
        ));
    }
    Ok(())
}

fn decode<const N: usize>(
    reader: Reader<BufReader<File>>,
    layer: usize,
    header: &Header,
    names: [&str; N],
) -> Result<Vec<[f32; N]>> {
    let metadata = reader.meta_data().clone();
    let largest = |_: &_, tile: exr::block::chunk::TileCoordinates, block: BlockIndex| {
        block.layer == layer && tile.is_largest_resolution_level()
    };
    let (width, height) = (header.layer_size.width(), header.layer_size.height());
    let components: Vec<Vec<usize>> = header
        .channels
        .list
        .iter()
        .map(|channel| (0..N).filter(|&component| channel.name == *names[component]).collect())
        .collect();
    // Zeros that the system hands out untouched cost nothing if the file then ends early.
    let mut pixels = vec![[0.0; N]; width * height];
    for chunk in reader.filter_chunks(false, largest)? {
        let chunk = chunk?;
        check_block(header, &chunk)?;
        let block = UncompressedBlock::decompress_chunk(chunk, &metadata, false)?;
        for line in block.lines(&header.channels) {
            let channel = line.location.channel;
            let start = line.location.position.y() * width + line.location.position.x();
            let Some(row) = pixels.get_mut(start..start + line.location.sample_count) else {
                return Err(Error::Invalid("block outside of the image".into()));
            };
            for &component in &components[channel] {
                copy_line(&line, header.channels.list[channel].sample_type, row, component)?;
            }
        }
    }
    Ok(pixels)
}

fn copy_line<const N: usize>(
    line: &LineRef,
    sample_type: SampleType,
    row: &mut [[f32; N]],
    component: usize,
) -> Result<()> {
    fn copy<const N: usize>(
        samples: impl Iterator<Item = Result<f32>>,
        row: &mut [[f32; N]],
        component: usize,
    ) -> Result<()> {
        for (pixel, sample) in row.iter_mut().zip(samples) {
            pixel[component] = sample?;
        }
        Ok(())
    }
    match sample_type {
        SampleType::F16 => copy(line.read_samples().map(|s| s.map(f16::to_f32)), row, component),
        SampleType::F32 => copy(line.read_samples(), row, component),
        SampleType::U32 => copy(line.read_samples().map(|s| s.map(|x: u32| x as f32)), row, component),
    }
}

/// Refuses DWA blocks (OpenEXR, `ImfDwaCompressor.cpp`) that promise more than a block can hold. They
/// begin with 11 numbers of 64 bits: version, compressed and uncompressed sizes and counts of their
/// parts, and a method.
fn check_block(header: &Header, chunk: &Chunk) -> Result<()> {
    let bytes = match &chunk.compressed_block {
        CompressedBlock::ScanLine(block) => &block.compressed_pixels_le,
        CompressedBlock::Tile(block) => &block.compressed_pixels_le,
        _ => return Err(Error::NotSupported("deep data".into())),
    };
    let is_dwa = matches!(header.compression, Compression::DWAA(_) | Compression::DWAB(_));
    let indices = header.get_block_data_indices(&chunk.compressed_block)?;
    let size = header.get_absolute_block_pixel_coordinates(indices)?.size;
    if !is_dwa || bytes.len() == size.area().saturating_mul(header.channels.bytes_per_pixel) {
        // A block that would not get smaller is stored as it is.
        return Ok(());
    }
    let sizes = bytes.chunks_exact(8).take(11).map(|b| b.iter().rev().fold(0, |n, &b| n << 8 | u64::from(b)));
    // Cosine transforms work on whole tiles of 8 × 8; twice for what compression may add.
    let padded = size.width().next_multiple_of(8) * size.height().next_multiple_of(8);
    let limit = 2 * (padded * 4 * header.channels.list.len()) as u64;
    if sizes.max().is_some_and(|size| size > limit) {
        return Err(Error::Invalid("size of a compressed block".into()));
    }
    Ok(())
}
