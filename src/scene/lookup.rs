//! Looking up textures and textured inputs at a point.

use std::sync::LazyLock;

use glam::{Vec2, Vec4};

use super::Scene;
use super::texture::{ColorInput, Image, Pixels, ScalarInput, Texture, Wrap};
use crate::radiometry::Rgb;
use crate::radiometry::color::srgb_to_linear;

/// Linear value of each 8-bit sRGB code.
static SRGB_TABLE: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|code| srgb_to_linear(code as f32 / 255.0)));

impl Image {
    /// The pixel in column `x` and row `y` (from the top), RGBA in [0, 1]; red, green and blue made
    /// linear if they are `srgb`-encoded. Outside the picture: its nearest pixel.
    pub fn texel(&self, x: u32, y: u32, srgb: bool) -> [f32; 4] {
        let x = x.min(self.width.saturating_sub(1)) as usize;
        let y = y.min(self.height.saturating_sub(1)) as usize;
        let index = y * self.width as usize + x;
        match &self.pixels {
            Pixels::Rgba8(pixels) => decode8(pixels[index], srgb),
            Pixels::Rgba16(pixels) => decode16(pixels[index], srgb),
            Pixels::Encoded(_) => [1.0; 4],
        }
    }
}

fn decode8([r, g, b, a]: [u8; 4], srgb: bool) -> [f32; 4] {
    let linear = |code: u8| f32::from(code) / 255.0;
    if srgb {
        let table = &*SRGB_TABLE;
        [table[usize::from(r)], table[usize::from(g)], table[usize::from(b)], linear(a)]
    } else {
        [r, g, b, a].map(linear)
    }
}

fn decode16(codes: [u16; 4], srgb: bool) -> [f32; 4] {
    let [r, g, b, a] = codes.map(|code| f32::from(code) / 65535.0);
    if srgb { [srgb_to_linear(r), srgb_to_linear(g), srgb_to_linear(b), a] } else { [r, g, b, a] }
}

impl Wrap {
    /// Brings a pixel index back into [0, `size`), `size` ≥ 1.
    fn index(self, i: i64, size: u32) -> u32 {
        let size = i64::from(size.max(1));
        let wrapped = match self {
            Self::Repeat => i.rem_euclid(size),
            Self::Mirror => {
                let i = i.rem_euclid(2 * size);
                if i < size { i } else { 2 * size - 1 - i }
            }
            Self::Clamp => i.clamp(0, size - 1),
        };
        wrapped as u32
    }

    /// Brings a coordinate back near [0, 1] before it is scaled to pixels, so that far coordinates
    /// keep their precision and huge ones do not overflow.
    fn coordinate(self, t: f32) -> f32 {
        if !t.is_finite() {
            return 0.0;
        }
        match self {
            Self::Repeat => t - t.floor(),
            Self::Mirror => t - 2.0 * (0.5 * t).floor(),
            Self::Clamp => t.clamp(0.0, 1.0),
        }
    }
}

impl Texture {
    /// Texture coordinates after this texture's own transform.
    pub fn coordinates(&self, uv: Vec2) -> Vec2 {
        self.transform.transform_point2(uv)
    }

    /// RGBA at `uv`, which are the mesh's coordinates of this texture's set: transformed, wrapped,
    /// linear. The centre of pixel (i, j) is at ((i + ½)/width, (j + ½)/height), v downwards.
    /// Bilinear interpolation is between linear values.
    pub fn sample(&self, image: &Image, uv: Vec2) -> [f32; 4] {
        let uv = self.coordinates(uv);
        let x = self.wrap_u.coordinate(uv.x) * image.width as f32;
        let y = self.wrap_v.coordinate(uv.y) * image.height as f32;
        let texel = |x: i64, y: i64| {
            let (x, y) = (self.wrap_u.index(x, image.width), self.wrap_v.index(y, image.height));
            Vec4::from(image.texel(x, y, self.srgb))
        };
        if self.nearest {
            return texel(x.floor() as i64, y.floor() as i64).to_array();
        }
        let (x, y) = (x - 0.5, y - 0.5);
        let (column, row) = (x.floor(), y.floor());
        let (s, t) = (x - column, y - row);
        let (column, row) = (column as i64, row as i64);
        let upper = texel(column, row) * (1.0 - s) + texel(column + 1, row) * s;
        let lower = texel(column, row + 1) * (1.0 - s) + texel(column + 1, row + 1) * s;
        (upper * (1.0 - t) + lower * t).to_array()
    }
}

impl Scene {
    /// RGBA of texture `index` at a point with texture coordinates `uv` (sets 0 and 1); white if
    /// there is no such texture or image.
    pub fn texture(&self, index: usize, uv: [Vec2; 2]) -> [f32; 4] {
        let found = self.textures.get(index).and_then(|t| Some((t, self.images.get(t.image)?)));
        match found {
            Some((texture, image)) => texture.sample(image, uv[texture.coordinate_set & 1]),
            None => [1.0; 4],
        }
    }

    /// The value of a colour input at a point with texture coordinates `uv` (sets 0 and 1) and
    /// interpolated vertex colour.
    pub fn color(&self, input: &ColorInput, uv: [Vec2; 2], vertex_color: Vec4) -> Rgb {
        let mut color = input.factor;
        if let Some(texture) = input.texture {
            let [r, g, b, _] = self.texture(texture, uv);
            color *= Rgb::new(r, g, b);
        }
        if input.vertex_color {
            color *= Rgb::new(vertex_color.x, vertex_color.y, vertex_color.z);
        }
        color
    }

    /// The value of a scalar input at a point with texture coordinates `uv` (sets 0 and 1) and
    /// interpolated vertex colour.
    pub fn scalar(&self, input: &ScalarInput, uv: [Vec2; 2], vertex_color: Vec4) -> f32 {
        let mut value = input.factor;
        if let Some((texture, channel)) = input.texture {
            value *= self.texture(texture, uv)[channel & 3];
        }
        if input.vertex_alpha {
            value *= vertex_color.w;
        }
        value
    }
}

#[cfg(test)]
mod tests {
    use glam::Affine2;

    use super::*;

    /// 4 × 2 pixels; red counts columns in 0.2, green rows.
    fn image() -> Image {
        let pixel = |i: u8| [51 * (i % 4), 255 * (i / 4), 128, 64];
        Image { name: String::new(), width: 4, height: 2, pixels: Pixels::Rgba8((0..8).map(pixel).collect()) }
    }

    fn texture(wrap: Wrap, nearest: bool) -> Texture {
        let transform = Affine2::IDENTITY;
        Texture { image: 0, coordinate_set: 0, transform, wrap_u: wrap, wrap_v: wrap, nearest, srgb: false }
    }

    #[test]
    fn pixel_centres_give_the_pixels_exactly() {
        let image = image();
        for nearest in [true, false] {
            for (x, y) in (0..2).flat_map(|y| (0..4).map(move |x| (x, y))) {
                // Powers of two: no rounding anywhere.
                let uv = Vec2::new((x as f32 + 0.5) / 4.0, (y as f32 + 0.5) / 2.0);
                let texture = texture(Wrap::Repeat, nearest);
                assert_eq!(texture.sample(&image, uv), image.texel(x, y, false));
                assert_eq!(texture.sample(&image, uv - Vec2::new(3.0, 8.0)), image.texel(x, y, false));
            }
        }
    }

    #[test]
    fn bilinear_is_the_mean_half_way() {
        let [red, green, ..] = texture(Wrap::Repeat, false).sample(&image(), Vec2::new(0.25, 0.5));
        // Half-way between columns 0 and 1 and both rows; two roundings.
        assert!((red - 0.1).abs() <= f32::EPSILON && (green - 0.5).abs() <= f32::EPSILON);
    }

    #[test]
    fn edges_wrap_as_asked() {
        let image = image();
        // Between the last column and what follows it.
        let red = |wrap| texture(wrap, false).sample(&image, Vec2::new(1.0, 0.25))[0];
        assert!((red(Wrap::Repeat) - 0.3).abs() <= f32::EPSILON);
        assert!((red(Wrap::Mirror) - 0.6).abs() <= f32::EPSILON);
        assert!((red(Wrap::Clamp) - 0.6).abs() <= f32::EPSILON);
        // 1.125 lies one half-pixel past the edge.
        let red = |wrap| texture(wrap, true).sample(&image, Vec2::new(1.125, 0.25))[0];
        assert_eq!([red(Wrap::Repeat), red(Wrap::Mirror), red(Wrap::Clamp)], [0.0, 0.6, 0.6]);
        let red = |wrap| texture(wrap, true).sample(&image, Vec2::new(-0.375, 0.25))[0];
        assert_eq!([red(Wrap::Repeat), red(Wrap::Mirror), red(Wrap::Clamp)], [0.4, 0.2, 0.0]);
    }

    #[test]
    fn odd_coordinates_are_harmless() {
        let image = image();
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            for nearest in [true, false] {
                for t in [f32::NAN, f32::INFINITY, f32::MAX, -1e30, -1e-30, 1.0, -0.0, 0.999_999_94] {
                    let value = texture(wrap, nearest).sample(&image, Vec2::new(t, t));
                    assert!(value.iter().all(|v| (0.0..=1.0).contains(v)), "{wrap:?} {t}: {value:?}");
                }
            }
        }
    }

    #[test]
    fn srgb_touches_colour_and_spares_alpha() {
        let image = image();
        let [_, green, blue, alpha] = image.texel(0, 1, true);
        assert_eq!(green, 1.0);
        assert_eq!(blue, srgb_to_linear(128.0 / 255.0));
        assert_eq!(alpha, 64.0 / 255.0);
        let deep = |code| Image { pixels: Pixels::Rgba16(vec![[code; 4]; 8]), ..image.clone() };
        // 257 = 65535/255: the same fractions, up to one rounding each, amplified by at most 2.4.
        let difference = deep(128 * 257).texel(0, 0, true)[0] - blue;
        assert!(difference.abs() <= 4.0 * f32::EPSILON);
    }

    #[test]
    fn inputs_multiply_factor_texture_and_vertex_colour() {
        let scene = Scene {
            images: vec![image()],
            textures: vec![Texture { coordinate_set: 1, ..texture(Wrap::Clamp, true) }],
            ..Scene::default()
        };
        let uv = [Vec2::ZERO, Vec2::new(0.9, 0.9)];
        let vertex = Vec4::new(0.5, 0.25, 1.0, 0.5);
        let color = ColorInput { factor: Rgb::splat(0.5), texture: Some(0), vertex_color: true };
        let found = scene.color(&color, uv, vertex);
        assert_eq!(found, Rgb::new(0.5 * 0.6 * 0.5, 0.125, 0.5 * (128.0 / 255.0)));
        let scalar = ScalarInput { factor: 2.0, texture: Some((0, 1)), vertex_alpha: true };
        assert_eq!(scene.scalar(&scalar, uv, vertex), 1.0);
        assert_eq!(scene.texture(7, uv), [1.0; 4]);
    }
}
