//! Textures, samplers and pictures (glTF 2.0, section 3.8).

use std::collections::BTreeSet;
use std::io::Cursor;

use ::gltf::json;
use ::gltf::json::texture::{MagFilter, WrappingMode};
use ::gltf::json::validation::Checked;
use ::image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use glam::{Affine2, Mat2, Vec2};
use serde_json::{Map, Value};

use super::Reader;
use super::extensions::{TextureTransform, WebpTexture};
use super::uri::read_uri;
use crate::scene::texture::{EncodedImage, Pixels, Wrap};
use crate::scene::{Image, Scene, SceneError, Texture};

/// Widest and highest picture, pixels.
const MAX_IMAGE_SIZE: u32 = 1 << 15;

/// Longest compressed picture, bytes.
const MAX_IMAGE_LENGTH: u64 = 1 << 30;

/// Most pixels of all pictures together: a small file can decode to a huge picture.
const PIXEL_BUDGET: u64 = 1 << 29;

/// A use of a texture by a material.
#[derive(Clone, Copy)]
pub(super) struct TextureReference<'a> {
    index: usize,
    coordinate_set: u32,
    extensions: Option<&'a Map<String, Value>>,
}

impl<'a> From<&'a json::texture::Info> for TextureReference<'a> {
    fn from(info: &'a json::texture::Info) -> Self {
        Self {
            index: info.index.value(),
            coordinate_set: info.tex_coord,
            extensions: info.extensions.as_ref().map(|e| &e.others),
        }
    }
}

impl<'a> TextureReference<'a> {
    /// A normal map.
    pub fn normal(info: &'a json::material::NormalTexture) -> Self {
        Self {
            index: info.index.value(),
            coordinate_set: info.tex_coord,
            extensions: info.extensions.as_ref().map(|e| &e.others),
        }
    }
}

/// What makes two uses of a glTF texture the same: index, coordinate set, sRGB, bits of the transform.
pub(super) type TextureKey = (usize, usize, bool, [u32; 6]);

impl Reader<'_> {
    /// The scene's texture for a use at `place`; `srgb` for colours.
    pub(super) fn texture(
        &mut self,
        reference: TextureReference,
        srgb: bool,
        place: &str,
    ) -> Result<usize, SceneError> {
        let document = self.document;
        let transform: TextureTransform =
            document.extension(reference.extensions, "KHR_texture_transform", place)?.unwrap_or_default();
        let matrix = texture_matrix(&transform);
        if !matrix.is_finite() {
            return Err(document.error(
                format!("{place}/extensions/KHR_texture_transform"),
                "offset, rotation and scale must be finite; mend them",
            ));
        }
        let mut coordinate_set = transform.tex_coord.unwrap_or(reference.coordinate_set) as usize;
        if coordinate_set > 1 {
            self.warnings.add(
                format!(
                    "texture coordinates TEXCOORD_{coordinate_set} are not read, TEXCOORD_0 is used instead"
                ),
                place,
            );
            coordinate_set = 0;
        }
        let key = (reference.index, coordinate_set, srgb, matrix.to_cols_array().map(f32::to_bits));
        if let Some(&known) = self.textures.get(&key) {
            return Ok(known);
        }

        let source =
            document.get(&document.textures, "texture", reference.index, &format!("{place}/index"))?;
        let texture_place = format!("/textures/{}", reference.index);
        let image = self.image(self.image_index(source, &texture_place)?, &texture_place)?;
        let default = json::texture::Sampler::default();
        let sampler = match source.sampler {
            None => &default,
            Some(sampler) => document.get(&document.samplers, "sampler", sampler.value(), &texture_place)?,
        };
        self.scene.textures.push(Texture {
            image,
            coordinate_set,
            transform: matrix,
            wrap_u: wrap(&sampler.wrap_s),
            wrap_v: wrap(&sampler.wrap_t),
            nearest: sampler.mag_filter == Some(Checked::Valid(MagFilter::Nearest)),
            srgb,
        });
        self.textures.insert(key, self.scene.textures.len() - 1);
        Ok(self.scene.textures.len() - 1)
    }

    /// The image that a texture shows: WebP where given, else the core one.
    fn image_index(&self, texture: &json::Texture, place: &str) -> Result<usize, SceneError> {
        let extensions = texture.extensions.as_ref().map(|e| &e.others);
        let webp: Option<WebpTexture> = self.document.extension(extensions, "EXT_texture_webp", place)?;
        if let Some(source) = webp.and_then(|webp| webp.source) {
            return Ok(source);
        }
        // The crate marks an absent `source` by the largest index.
        match texture.source.value() {
            index if index == u32::MAX as usize => Err(self.document.error(
                place,
                "has no PNG, JPEG or WebP image (no `source`); export the textures as one of these",
            )),
            index => Ok(index),
        }
    }

    /// The scene's image for glTF image `index`, not decoded yet; one however many textures show it.
    fn image(&mut self, index: usize, place: &str) -> Result<usize, SceneError> {
        if let Some(&known) = self.images.get(&index) {
            return Ok(known);
        }
        let document = self.document;
        let source = document.get(&document.images, "image", index, &format!("{place}/source"))?;
        let place = format!("/images/{index}");
        let bytes = match (&source.buffer_view, &source.uri) {
            (Some(view), _) => document.view(view.value(), &place)?.to_vec(),
            (None, Some(uri)) => read_uri(&document.folder, uri, MAX_IMAGE_LENGTH)
                .map_err(|problem| document.error(format!("{place}/uri"), problem))?,
            (None, None) => {
                return Err(document.error(place, "has neither `uri` nor `bufferView`; export it again"));
            }
        };
        let name = source.name.clone().or_else(|| source.uri.clone().filter(|uri| !uri.starts_with("data:")));
        self.scene.images.push(Image {
            name: name.unwrap_or_else(|| format!("image {index}")),
            width: 1,
            height: 1,
            pixels: Pixels::Encoded(EncodedImage { bytes, file: document.file.clone(), place }),
        });
        self.images.insert(index, self.scene.images.len() - 1);
        Ok(self.scene.images.len() - 1)
    }

    /// Warns of textured instances whose mesh lacks the coordinates: they show one pixel only.
    pub(super) fn warn_of_missing_coordinates(&mut self) {
        let scene = &self.scene;
        for &(mesh, material) in self.meshes.values().flatten() {
            let (Some(mesh), Some(material)) = (scene.meshes.get(mesh), scene.materials.get(material)) else {
                continue;
            };
            let lacks = |texture: usize| {
                scene
                    .textures
                    .get(texture)
                    .is_some_and(|t| mesh.texture_coordinates[t.coordinate_set].is_empty())
            };
            if material.textures().into_iter().any(lacks) {
                self.warnings.add(
                    "a textured material on a mesh without the texture coordinates it asks for",
                    format!("material \"{}\" on \"{}\"", material.name, mesh.name),
                );
            }
        }
    }
}

/// Translation × rotation × scale. Positive angles turn the coordinates counter-clockwise as seen
/// with v downwards, so the rotation is by −angle in the (u, v) plane.
fn texture_matrix(transform: &TextureTransform) -> Affine2 {
    let (sin, cos) = transform.rotation.sin_cos();
    let [scale_u, scale_v] = transform.scale;
    let matrix = Mat2::from_cols(Vec2::new(cos, -sin) * scale_u, Vec2::new(sin, cos) * scale_v);
    Affine2::from_mat2_translation(matrix, Vec2::from(transform.offset))
}

fn wrap(mode: &Checked<WrappingMode>) -> Wrap {
    match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        _ => Wrap::Repeat,
    }
}

/// Decodes the images that placed surfaces of `scene` show; all others stay as they are.
///
/// # Errors
/// An image is damaged, or all together are too large.
pub fn decode_images(scene: &mut Scene) -> Result<(), SceneError> {
    let placed = scene.instances.iter().filter(|placed| !scene.meshes[placed.mesh].triangles.is_empty());
    let materials: BTreeSet<usize> = placed.map(|placed| placed.material).collect();
    let textures = materials.into_iter().flat_map(|material| scene.materials[material].textures());
    let images: BTreeSet<usize> =
        textures.filter_map(|texture| scene.textures.get(texture)).map(|texture| texture.image).collect();
    let mut pixels_left = PIXEL_BUDGET;
    for index in images {
        let Some(image) = scene.images.get_mut(index) else { continue };
        if let Pixels::Encoded(encoded) = &image.pixels {
            let decoded = decode(&encoded.bytes, &mut pixels_left)
                .map_err(|problem| SceneError::at(&encoded.file, &encoded.place, problem))?;
            (image.width, image.height) = (decoded.width(), decoded.height());
            image.pixels = pixels(decoded);
        }
    }
    Ok(())
}

/// Decodes a picture. Its kind is found from its first bytes: declared types are often wrong.
fn decode(bytes: &[u8], pixels_left: &mut u64) -> Result<DynamicImage, String> {
    let reader = ImageReader::new(Cursor::new(bytes));
    let mut reader = reader.with_guessed_format().map_err(|error| error.to_string())?;
    if !matches!(reader.format(), Some(ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::WebP)) {
        return Err("the image is not PNG, JPEG or WebP, or is damaged; convert it to one of these".into());
    }
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_IMAGE_SIZE);
    limits.max_image_height = Some(MAX_IMAGE_SIZE);
    limits.max_alloc = Some(8 * *pixels_left);
    reader.limits(limits);
    let cannot = |error| format!("the image cannot be decoded: {error}; save it again");
    let decoder = reader.into_decoder().map_err(cannot)?;
    let (width, height) = decoder.dimensions();
    let count = u64::from(width) * u64::from(height);
    if count == 0 {
        return Err("the image has no pixels; save it again".into());
    }
    let Some(left) = pixels_left.checked_sub(count) else {
        return Err(format!(
            "the images of the scene have more than {PIXEL_BUDGET} pixels together; scale them down"
        ));
    };
    let decoded = DynamicImage::from_decoder(decoder).map_err(cannot)?;
    *pixels_left = left;
    Ok(decoded)
}

/// Eight bits stay eight bits; anything deeper becomes sixteen.
fn pixels(image: DynamicImage) -> Pixels {
    match image {
        DynamicImage::ImageLuma8(_)
        | DynamicImage::ImageLumaA8(_)
        | DynamicImage::ImageRgb8(_)
        | DynamicImage::ImageRgba8(_) => Pixels::Rgba8(image.into_rgba8().pixels().map(|p| p.0).collect()),
        deep => Pixels::Rgba16(deep.into_rgba16().pixels().map(|p| p.0).collect()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texture_transform_gives_the_quadrant_of_the_specification() {
        // KHR_texture_transform, first example: the lower left quadrant, rotated.
        let matrix = texture_matrix(&TextureTransform {
            offset: [0.0, 1.0],
            rotation: std::f32::consts::FRAC_PI_2,
            scale: [0.5, 0.5],
            tex_coord: None,
        });
        let corner = |u: f32, v: f32| matrix.transform_point2(Vec2::new(u, v));
        // cos(π/2) rounds to −4·10⁻⁸.
        assert!(corner(0.0, 0.0).abs_diff_eq(Vec2::new(0.0, 1.0), 1e-7));
        assert!(corner(1.0, 0.0).abs_diff_eq(Vec2::new(0.0, 0.5), 1e-7));
        assert!(corner(1.0, 1.0).abs_diff_eq(Vec2::new(0.5, 0.5), 1e-7));
    }
}
