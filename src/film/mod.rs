//! Where light lands: exact accumulation by pixel, and the files made of it.
//!
//! The reconstruction filter is applied by where samples are placed, so a sample belongs to one
//! pixel only and pixels are independent.

pub mod accumulator;
pub mod exr;
pub mod layers;
pub mod output;
pub mod picture;
pub mod png;
pub mod schedule;
pub mod view;

mod accumulate;

pub use accumulator::Accumulator;
pub use picture::Picture;

use thiserror::Error;

/// Largest width and height.
pub const MAX_SIDE: u32 = 1 << 16;
/// Most pixels of a film or of a picture that is read (16384 × 16384).
pub const MAX_PIXELS: u64 = 1 << 28;

/// Side of a tile, the unit of work of a thread, in pixels.
const TILE: u32 = 16;
const TILE_PIXELS: usize = (TILE * TILE) as usize;

/// Offset in the denominator of relative errors, (W/(m² sr))²: pixels much darker than 0.1 count by
/// their absolute error, so that black ones do not decide.
pub const RELATIVE_ERROR_OFFSET: f64 = 0.01;

/// Why a film cannot be made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum FilmError {
    /// Too many or no pixels.
    #[error(
        "a film of {width} × {height} pixels is not possible: each side from 1 to {MAX_SIDE}, {MAX_PIXELS} pixels together"
    )]
    Size {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
    },
    /// The memory is not there.
    #[error("not enough memory for a film of {width} × {height} pixels ({bytes} bytes)")]
    Memory {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
        /// Bytes that were asked for.
        bytes: usize,
    },
}

/// A picture in the making.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Film {
    width: u32,
    height: u32,
    /// Tile after tile in row-major order, each with its pixels in row-major order. Tiles at the
    /// right and lower edge are stored whole; what lies outside stays empty.
    pixels: Vec<Accumulator>,
}

impl Film {
    /// An empty film of `width` × `height` pixels.
    pub fn new(width: u32, height: u32) -> Result<Self, FilmError> {
        check_size(width, height)?;
        let count = width.div_ceil(TILE) as usize * height.div_ceil(TILE) as usize * TILE_PIXELS;
        let mut pixels = Vec::new();
        pixels.try_reserve_exact(count).map_err(|_| {
            let bytes = count * size_of::<Accumulator>();
            FilmError::Memory { width, height, bytes }
        })?;
        pixels.resize(count, Accumulator::default());
        Ok(Self { width, height, pixels })
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The pixel in column `x` from the left and row `y` from the top.
    pub fn pixel(&self, x: u32, y: u32) -> &Accumulator {
        let tile = (y / TILE) as usize * self.width.div_ceil(TILE) as usize + (x / TILE) as usize;
        &self.pixels[tile * TILE_PIXELS + (y % TILE * TILE + x % TILE) as usize]
    }

    /// All pixels, row by row from the top.
    pub fn rows(&self) -> impl Iterator<Item = &Accumulator> {
        (0..self.height).flat_map(move |y| (0..self.width).map(move |x| self.pixel(x, y)))
    }

    /// Count of pixels.
    pub fn pixel_count(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }

    /// The picture so far.
    pub fn picture(&self) -> Picture {
        let pixels = self.rows().map(Accumulator::mean).collect();
        Picture { width: self.width, height: self.height, pixels }
    }

    /// Samples over all pixels: taken, not finite, clamped, the brightest; and the fewest that a pixel has.
    pub fn tally(&self) -> Tally {
        let mut tally = Tally { fewest: u64::MAX, ..Tally::default() };
        for pixel in self.rows() {
            tally.taken += pixel.taken();
            tally.nonfinite += u64::from(pixel.nonfinite());
            tally.clamped += u64::from(pixel.clamped());
            tally.fewest = tally.fewest.min(pixel.taken());
            tally.brightest = tally.brightest.max(pixel.brightest());
        }
        tally
    }

    /// Estimate of the relative error of the picture: √relMSE, where
    /// relMSE = mean over pixels and channels of Var(mean)/(mean² + 0.01)
    /// is what `compare` would measure against the true picture, in expectation and up to noise in
    /// the denominator. Infinite (unknown) while a pixel has fewer than two samples.
    ///
    /// The variances take samples for independent ([`Accumulator::variance_of_mean`]), so with
    /// low-discrepancy samples this is rather too large than too small. An effect that no sample
    /// has met yet is not in it.
    pub fn relative_error(&self) -> f64 {
        let sum: f64 = self.rows().map(relative_variance).sum();
        (sum / (3.0 * self.pixel_count() as f64)).sqrt()
    }

    /// The largest channel of any sample over the mean of the picture: what one path brings at most. 0 for a black picture.
    pub fn brightest_over_mean(&self) -> f64 {
        let mean =
            self.rows().map(|pixel| f64::from(pixel.mean().mean())).sum::<f64>() / self.pixel_count() as f64;
        if mean > 0.0 { f64::from(self.tally().brightest) / mean } else { 0.0 }
    }

    /// Share of the picture's total relative variance that stands in its noisiest 0.1 % of pixels
    /// (at least one): small for even noise, towards 1 where a few bright outliers ("fireflies")
    /// make up the error. 0 without noise or while the noise is unknown.
    pub fn firefly_index(&self) -> f64 {
        let mut variances: Vec<f64> = self.rows().map(relative_variance).collect();
        let total: f64 = variances.iter().sum();
        if total == 0.0 || !total.is_finite() {
            return 0.0;
        }
        let noisiest = variances.len().div_ceil(1000);
        variances.select_nth_unstable_by(noisiest - 1, |a, b| b.total_cmp(a));
        variances[..noisiest].iter().sum::<f64>() / total
    }
}

/// Sums over the pixels of a film.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tally {
    /// Samples taken.
    pub taken: u64,
    /// Samples that were not finite and added nothing.
    pub nonfinite: u64,
    /// Samples too large to be summed, and clamped.
    pub clamped: u64,
    /// Samples of the pixel that has fewest.
    pub fewest: u64,
    /// The largest channel of any sample, W/(m² sr).
    pub brightest: f32,
}

fn relative_variance(pixel: &Accumulator) -> f64 {
    let mean = pixel.mean();
    let term = |channel: usize| {
        pixel.variance_of_mean(channel) / (f64::from(mean[channel]).powi(2) + RELATIVE_ERROR_OFFSET)
    };
    term(0) + term(1) + term(2)
}

fn check_size(width: u32, height: u32) -> Result<(), FilmError> {
    let sides = 1..=MAX_SIDE;
    let pixels = u64::from(width) * u64::from(height);
    if sides.contains(&width) && sides.contains(&height) && pixels <= MAX_PIXELS {
        Ok(())
    } else {
        Err(FilmError::Size { width, height })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::radiometry::Rgb;

    #[test]
    fn impossible_sizes_are_refused() {
        for (width, height) in [(0, 1), (1, 0), (MAX_SIDE + 1, 1), (MAX_SIDE, MAX_SIDE)] {
            assert_eq!(Film::new(width, height).unwrap_err(), FilmError::Size { width, height });
        }
    }

    #[test]
    fn error_and_firefly_index_tell_even_noise_from_outliers() {
        let mut film = Film::new(40, 50).unwrap();
        assert_eq!((film.relative_error(), film.firefly_index()), (f64::INFINITY, 0.0));
        for pixel in &mut film.pixels {
            // Mean 1/2, variance of the mean 1/4.
            pixel.add(Rgb::ZERO);
            pixel.add(Rgb::ONE);
        }
        let relative_error = (0.25_f64 / (0.25 + 0.01)).sqrt();
        // 6000 equal terms are added, each addition within half an ulp.
        assert!((film.relative_error() / relative_error - 1.0).abs() < 6000.0 * f64::EPSILON);
        assert!((film.firefly_index() - 0.001).abs() < 1e-12);

        let mut film = Film::new(40, 50).unwrap();
        for pixel in &mut film.pixels {
            pixel.add(Rgb::ONE);
            pixel.add(Rgb::ONE);
        }
        film.pixels[17].add(Rgb::splat(100.0));
        assert_eq!(film.firefly_index(), 1.0);
        // The pixel's mean is 34, that of the picture 1 + 33/2000.
        assert!((film.brightest_over_mean() - 100.0 / 1.0165).abs() < 1e-9);
    }
}
