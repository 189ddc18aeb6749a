//! Reading EXR files that may be damaged.
//!
//! The exr crate believes the sizes in headers and blocks and allocates what they ask for, up to
//! aborting the process. So blocks are decoded here one by one, each after its sizes are judged.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use exr::block::UncompressedBlock;
use exr::block::chunk::{Chunk, CompressedBlock};
use exr::block::lines::LineRef;
use exr::error::{Error, Result};
use exr::math::Vec2;
use exr::meta::attribute::{Compression, SampleType};
use exr::meta::header::Header;
use exr::prelude::f16;

use super::{ImagePixels, pixel_count};
use crate::radiometry::Spectrum;
use crate::scene::SceneError;

/// Largest block that is decoded: 256 lines (DWAB) of 16,384 pixels of 4 float channels.
const MAX_BLOCK_BYTES: usize = 1 << 26;

/// Reads the first layer's channels R, G, B, or else Y.
pub fn read_exr(path: &Path) -> std::result::Result<ImagePixels, SceneError> {
    let file = File::open(path).map_err(|e| SceneError::file(path, e.to_string()))?;
    let unreadable = |e: Error| SceneError::file(path, format!("not a readable EXR image: {e}"));
    let reader = exr::block::read(BufReader::new(file), false).map_err(unreadable)?;
    for header in reader.headers() {
        pixel_count(path, header.layer_size.width(), header.layer_size.height())?;
    }
    let Some(header) = reader.headers().first().cloned() else {
        return Err(SceneError::file(path, "there is no layer"));
    };
    let targets = channel_targets(&header).map_err(|problem| SceneError::file(path, problem))?;
    decode(reader, &header, &targets).map_err(unreadable)
}

/// Which of red, green and blue each channel of the layer sets.
fn channel_targets(header: &Header) -> std::result::Result<Vec<&'static [usize]>, String> {
    let channels = &header.channels.list;
    if header.deep {
        return Err("deep images are not environment maps".into());
    }
    if channels.iter().any(|c| c.sampling != Vec2(1, 1)) {
        return Err("channels of lower resolution (chroma subsampling) are not supported".into());
    }
    if header.max_block_byte_size() > MAX_BLOCK_BYTES {
        return Err(format!(
            "blocks of {} bytes; the limit is {MAX_BLOCK_BYTES}",
            header.max_block_byte_size()
        ));
    }
    let names: Vec<String> = channels.iter().map(|c| c.name.to_string()).collect();
    let colored = ["R", "G", "B"].iter().all(|name| names.iter().any(|n| n == name));
    if !colored && !names.iter().any(|n| n == "Y") {
        return Err(format!("channels R, G, B or Y are needed; the first layer has {}", names.join(", ")));
    }
    let target = |name: &String| -> &'static [usize] {
        match (name.as_str(), colored) {
            ("R", true) => &[0],
            ("G", true) => &[1],
            ("B", true) => &[2],
            ("Y", false) => &[0, 1, 2],
            _ => &[],
        }
    };
    Ok(names.iter().map(target).collect())
}

fn decode(
    reader: exr::block::reader::Reader<BufReader<File>>,
    header: &Header,
    targets: &[&[usize]],
) -> Result<ImagePixels> {
    let metadata = reader.meta_data().clone();
    let first_image = |_: &_, tile: exr::block::chunk::TileCoordinates, block: exr::block::BlockIndex| {
        block.layer == 0 && tile.is_largest_resolution_level()
    };
    let (width, height) = (header.layer_size.width(), header.layer_size.height());
    // Zeros that the system hands out untouched cost nothing if the file then ends early.
    let mut pixels = vec![[0.0; 3]; width * height];
    for chunk in reader.filter_chunks(false, first_image)? {
        let chunk = chunk?;
        check_block(header, &chunk)?;
        let block = UncompressedBlock::decompress_chunk(chunk, &metadata, false)?;
        for line in block.lines(&header.channels) {
            let channel = line.location.channel;
            let start = line.location.position.y() * width + line.location.position.x();
            let Some(row) = pixels.get_mut(start..start + line.location.sample_count) else {
                return Err(Error::Invalid("block outside of the image".into()));
            };
            for &target in targets[channel] {
                copy_line(&line, header.channels.list[channel].sample_type, row, target)?;
            }
        }
    }
    Ok((width, height, pixels.into_iter().map(Spectrum).collect()))
}

fn copy_line(line: &LineRef, sample_type: SampleType, row: &mut [[f32; 3]], target: usize) -> Result<()> {
    fn copy(samples: impl Iterator<Item = Result<f32>>, row: &mut [[f32; 3]], target: usize) -> Result<()> {
        for (pixel, sample) in row.iter_mut().zip(samples) {
            pixel[target] = sample?;
        }
        Ok(())
    }
    match sample_type {
        SampleType::F16 => copy(line.read_samples().map(|s| s.map(f16::to_f32)), row, target),
        SampleType::F32 => copy(line.read_samples(), row, target),
        SampleType::U32 => copy(line.read_samples().map(|s| s.map(|x: u32| x as f32)), row, target),
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
