//! Images, textures, and inputs that are a constant or textured.

use std::path::PathBuf;

use glam::Affine2;

use crate::radiometry::Rgb;

/// A picture in memory.
#[derive(Clone, Debug)]
pub struct Image {
    /// Where it came from, for people.
    pub name: String,
    /// Width in pixels, at least 1.
    pub width: u32,
    /// Height in pixels, at least 1.
    pub height: u32,
    /// Row-major pixels from the top.
    pub pixels: Pixels,
}

/// Pixels as stored; decoded to linear on look-up. An image used both as colour and as data is
/// decoded by how the texture uses it (see [`Texture::srgb`]).
#[derive(Clone, Debug)]
pub enum Pixels {
    /// 8 bits per channel RGBA.
    Rgba8(Vec<[u8; 4]>),
    /// 16 bits per channel RGBA.
    Rgba16(Vec<[u16; 4]>),
    /// Not decoded, because nothing needs it: it counts as white.
    Encoded(EncodedImage),
}

/// A file in memory.
#[derive(Clone, Debug)]
pub struct EncodedImage {
    /// PNG, JPEG or WebP.
    pub bytes: Vec<u8>,
    /// What it was read from, for messages.
    pub file: PathBuf,
    /// Where in that file, for messages.
    pub place: String,
}

/// How coordinates outside [0, 1] are brought back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// Repeat.
    #[default]
    Repeat,
    /// Repeat, every other copy mirrored.
    Mirror,
    /// The edge pixel.
    Clamp,
}

/// An image with a way to look it up.
#[derive(Clone, Copy, Debug)]
pub struct Texture {
    /// Index into the scene's images.
    pub image: usize,
    /// Which set of texture coordinates of the mesh: 0 or 1.
    pub coordinate_set: usize,
    /// Applied to the coordinates first (KHR_texture_transform).
    pub transform: Affine2,
    /// Horizontal wrapping.
    pub wrap_u: Wrap,
    /// Vertical wrapping.
    pub wrap_v: Wrap,
    /// True: nearest pixel; false: bilinear.
    pub nearest: bool,
    /// True if red, green and blue are sRGB-encoded (colours); alpha is always linear.
    pub srgb: bool,
}

/// A colour: a constant, times a texture's RGB and the mesh's vertex colour where wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ColorInput {
    /// Constant factor.
    pub factor: Rgb,
    /// Index into the scene's textures.
    pub texture: Option<usize>,
    /// Multiply by the vertex colour.
    pub vertex_color: bool,
}

impl ColorInput {
    /// The same everywhere.
    pub const fn constant(factor: Rgb) -> Self {
        Self { factor, texture: None, vertex_color: false }
    }

    /// True if it may differ from point to point.
    pub const fn varies(&self) -> bool {
        self.texture.is_some() || self.vertex_color
    }
}

/// A number: a constant, times one channel of a texture (and the vertex alpha where wanted).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ScalarInput {
    /// Constant factor.
    pub factor: f32,
    /// Index into the scene's textures, and the channel 0–3 (RGBA).
    pub texture: Option<(usize, usize)>,
    /// Multiply by the alpha of the vertex colour.
    pub vertex_alpha: bool,
}

impl ScalarInput {
    /// The same everywhere.
    pub const fn constant(factor: f32) -> Self {
        Self { factor, texture: None, vertex_alpha: false }
    }

    /// True if it may differ from point to point.
    pub const fn varies(&self) -> bool {
        self.texture.is_some() || self.vertex_alpha
    }
}
