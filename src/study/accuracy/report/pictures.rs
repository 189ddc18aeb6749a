//! Pictures within the page.

use std::io;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use thiserror::Error;

use crate::film::Picture;
use crate::film::png;
use crate::film::view::View;

/// A picture cannot be encoded.
#[derive(Debug, Error)]
#[error("a picture cannot be encoded: {0}")]
pub struct PictureError(#[from] io::Error);

/// A picture as a person sees it, as the address of its data.
pub fn shown(picture: &Picture) -> Result<String, PictureError> {
    let mut bytes = Vec::new();
    png::write(&mut bytes, picture, View::Filmic, 0.0)?;
    Ok(address(&bytes))
}

/// 8-bit sRGB pixels, row by row from the top, as the address of their data.
pub fn map(size: [u32; 2], pixels: &[u8]) -> Result<String, PictureError> {
    let mut bytes = Vec::new();
    png::write_srgb(&mut bytes, size, pixels)?;
    Ok(address(&bytes))
}

fn address(png: &[u8]) -> String {
    format!("data:image/png;base64,{}", STANDARD.encode(png))
}
