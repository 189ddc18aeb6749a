//! Pictures that are parts of a frame: what two of them have in common.

use super::Estimate;
use crate::film::Picture;
use crate::film::exr::PictureFile;

/// The part of a frame that two pictures both show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overlap {
    /// Column and row of its upper left pixel in the frame.
    pub position: [i64; 2],
    /// Width and height in pixels, at least 1.
    pub size: [u32; 2],
}

/// What `a` and `b` both show of their frame; `None` if they have no pixel in common.
pub fn overlap(a: &PictureFile, b: &PictureFile) -> Option<Overlap> {
    let end = |file: &PictureFile, axis: usize| {
        file.position[axis] + i64::from([file.picture.width, file.picture.height][axis])
    };
    let position = [0, 1].map(|axis| a.position[axis].max(b.position[axis]));
    let size = [0, 1].map(|axis| end(a, axis).min(end(b, axis)) - position[axis]);
    // A size is at most that of a picture.
    (size[0] > 0 && size[1] > 0).then(|| Overlap { position, size: size.map(|length| length as u32) })
}

/// The pixels of `file` in `part`, which is [`overlap`] of it and another.
pub fn crop(file: PictureFile, part: Overlap) -> Estimate {
    let Picture { width, height, pixels } = file.picture;
    if part.size == [width, height] {
        return Estimate { picture: Picture { width, height, pixels }, variance: file.variance };
    }
    let [left, top] = [0, 1].map(|axis| (part.position[axis] - file.position[axis]) as usize);
    let [columns, rows] = part.size.map(|length| length as usize);
    let rows_of = |values: &[_]| {
        values
            .chunks(width as usize)
            .skip(top)
            .take(rows)
            .flat_map(|row| row[left..left + columns].to_vec())
            .collect()
    };
    Estimate {
        picture: Picture { width: part.size[0], height: part.size[1], pixels: rows_of(&pixels) },
        variance: file.variance.as_deref().map(rows_of),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::radiometry::Rgb;

    /// A part of a frame of 10 × 10, every pixel of which is (column, row, 0) of the frame.
    fn file(position: [i64; 2], width: u32, height: u32) -> PictureFile {
        let pixel = |i: u32| {
            let [x, y] = [i64::from(i % width) + position[0], i64::from(i / width) + position[1]];
            Rgb::new(x as f32, y as f32, 0.0)
        };
        let pixels: Vec<Rgb> = (0..width * height).map(pixel).collect();
        let picture = Picture { width, height, pixels: pixels.clone() };
        PictureFile { picture, variance: Some(pixels), position, frame: [10, 10] }
    }

    #[test]
    fn the_same_pixels_of_the_frame_are_left_of_both() {
        let (a, b) = (file([0, 0], 6, 5), file([3, -2], 7, 4));
        let part = overlap(&a, &b).unwrap();
        assert_eq!(part, Overlap { position: [3, 0], size: [3, 2] });
        assert_eq!(crop(a.clone(), part), crop(b, part));
        assert_eq!(crop(a, part).picture.pixels[4], Rgb::new(4.0, 1.0, 0.0));
    }

    #[test]
    fn whole_frames_stay_and_separate_parts_have_nothing_in_common() {
        let whole = file([0, 0], 10, 10);
        let part = overlap(&whole, &whole).unwrap();
        assert_eq!(crop(whole.clone(), part).picture, whole.picture);
        assert_eq!(overlap(&file([0, 0], 4, 4), &file([4, 0], 4, 4)), None);
    }
}
