//! The heat map as a bitmap, with its scale below it.

use super::heat_map::{DECADES, Scale, shade};

/// An 8-bit sRGB bitmap.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bitmap {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Row-major pixels from the top.
    pub pixels: Vec<[u8; 3]>,
}

/// Least width, for the labels of the scale.
const MIN_WIDTH: usize = 240;
/// Height to which a small picture is enlarged at most.
const MAX_ENLARGED: usize = 2048;
/// Height of the scale, in which the bar stands at the rows [`BAR`].
const STRIP: usize = 34;
const BAR: std::ops::Range<usize> = 6..16;
const TEXT_TOP: usize = 20;
/// Space to the left and right of the bar.
const MARGIN: usize = 22;
const WHITE: [u8; 3] = [255; 3];
/// A pixel of a glyph is as many pixels wide and high.
const DOT: usize = 2;

/// Draws `errors`, rows of `width`, in the colours of `scale`, which stands below it with its powers of ten. A
/// small picture is enlarged by a whole number.
pub fn draw(errors: &[Option<f64>], width: usize, scale: Scale) -> Bitmap {
    let height = errors.len() / width.max(1);
    let zoom = MIN_WIDTH.div_ceil(width.max(1)).min(MAX_ENLARGED / height.max(1)).max(1);
    let mut bitmap = Bitmap::black((zoom * width).max(MIN_WIDTH), zoom * height + STRIP);
    for (i, &error) in errors.iter().enumerate() {
        bitmap.fill(i % width * zoom, i / width * zoom, zoom, zoom, scale.color(error));
    }
    draw_scale(&mut bitmap, zoom * height, scale);
    bitmap
}

fn draw_scale(bitmap: &mut Bitmap, top: usize, scale: Scale) {
    let length = bitmap.width - 2 * MARGIN;
    for x in 0..length {
        let color = shade((x as f64 + 0.5) / length as f64);
        bitmap.fill(MARGIN + x, top + BAR.start, 1, BAR.len(), color);
    }
    for decade in 0..=DECADES {
        let x = MARGIN + (length - 1) * decade as usize / DECADES as usize;
        bitmap.fill(x, top + BAR.end, 1, 2, WHITE);
        let label = format!("1e{}", scale.top - DECADES + decade);
        let half = (4 * label.len() - 1) * DOT / 2;
        draw_text(bitmap, x.saturating_sub(half), top + TEXT_TOP, &label);
    }
}

fn draw_text(bitmap: &mut Bitmap, left: usize, top: usize, text: &str) {
    for (i, character) in text.chars().enumerate() {
        for (y, row) in glyph(character).into_iter().enumerate() {
            for x in (0..3).filter(|x| row >> (2 - x) & 1 == 1) {
                bitmap.fill(left + DOT * (4 * i + x), top + DOT * y, DOT, DOT, WHITE);
            }
        }
    }
}

/// Five rows of three dots.
fn glyph(character: char) -> [u8; 5] {
    match character {
        '0' => [0b111, 0b101, 0b101, 0b101, 0b111],
        '1' => [0b010, 0b110, 0b010, 0b010, 0b111],
        '2' => [0b111, 0b001, 0b111, 0b100, 0b111],
        '3' => [0b111, 0b001, 0b111, 0b001, 0b111],
        '4' => [0b101, 0b101, 0b111, 0b001, 0b001],
        '5' => [0b111, 0b100, 0b111, 0b001, 0b111],
        '6' => [0b111, 0b100, 0b111, 0b101, 0b111],
        '7' => [0b111, 0b001, 0b010, 0b010, 0b010],
        '8' => [0b111, 0b101, 0b111, 0b101, 0b111],
        '9' => [0b111, 0b101, 0b111, 0b001, 0b111],
        'e' => [0b000, 0b111, 0b111, 0b100, 0b111],
        '-' => [0b000, 0b000, 0b111, 0b000, 0b000],
        _ => [0; 5],
    }
}

impl Bitmap {
    fn black(width: usize, height: usize) -> Self {
        Self { width, height, pixels: vec![[0; 3]; width * height] }
    }

    /// Fills a rectangle; what of it lies outside is left out.
    fn fill(&mut self, left: usize, top: usize, width: usize, height: usize, color: [u8; 3]) {
        let (right, bottom) = ((left + width).min(self.width), (top + height).min(self.height));
        for y in top..bottom {
            if let Some(row) = self.pixels.get_mut(y * self.width + left..y * self.width + right) {
                row.fill(color);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_stand_where_they_are_in_the_picture() {
        let scale = Scale { top: 0 };
        let errors = [Some(1.0), None, Some(0.0), Some(1e-2), Some(1.0), Some(1e-4)];
        let bitmap = draw(&errors, 3, scale);
        assert_eq!((bitmap.width, bitmap.height), (240, 160 + STRIP));
        for (i, &error) in errors.iter().enumerate() {
            let (x, y) = (80 * (i % 3), 80 * (i / 3));
            for (x, y) in [(x, y), (x + 79, y + 79)] {
                assert_eq!(bitmap.pixels[y * 240 + x], scale.color(error), "{i}");
            }
        }
    }

    #[test]
    fn the_scale_runs_from_dark_to_light() {
        let bitmap = draw(&[Some(0.0); 300], 300, Scale { top: -12 });
        let bar = &bitmap.pixels[(1 + BAR.start) * 300..][..300];
        assert_eq!((bar[MARGIN - 1], bar[300 - MARGIN]), ([0; 3], [0; 3]));
        assert_eq!((bar[MARGIN], bar[299 - MARGIN]), (shade(0.5 / 256.0), shade(255.5 / 256.0)));
        // White is that of ticks and labels.
        assert!(bitmap.pixels[(1 + TEXT_TOP) * 300..].contains(&WHITE));
    }

    #[test]
    fn long_strips_are_not_enlarged_without_bound() {
        let bitmap = draw(&vec![Some(1.0); 5000], 1, Scale { top: 0 });
        assert_eq!((bitmap.width, bitmap.height), (MIN_WIDTH, 5000 + STRIP));
    }
}
