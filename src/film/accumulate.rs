//! Taking samples in parallel.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::{Accumulator, Film, TILE, TILE_PIXELS};
use crate::radiometry::Rgb;

impl Film {
    /// Adds to every pixel the samples with indices `samples`, computed by `sample(x, y, index,
    /// context)` on all threads of the current pool.
    ///
    /// A context is made for each tile of the film; those of all tiles are merged in fixed order and
    /// returned, so what is counted there does not depend on the threads either.
    ///
    /// After each row of a tile `progress` is told how many samples were added. Before each pixel
    /// `stop` is looked at: a pixel gets all of `samples` or none, so the film is valid whenever the
    /// call returns.
    pub fn accumulate<T: Default + Send>(
        &mut self,
        samples: Range<u64>,
        sample: impl Fn(u32, u32, u64, &mut T) -> Rgb + Sync,
        merge: impl Fn(&mut T, T),
        stop: &AtomicBool,
        progress: impl Fn(u64) + Sync,
    ) -> T {
        let (width, height) = (self.width, self.height);
        let tiles_across = width.div_ceil(TILE) as usize;
        let contexts: Vec<T> = self
            .pixels
            .par_chunks_mut(TILE_PIXELS)
            .enumerate()
            .map(|(tile, pixels)| {
                let mut context = T::default();
                let left = (tile % tiles_across) as u32 * TILE;
                let top = (tile / tiles_across) as u32 * TILE;
                for (y, row) in (top..height).zip(pixels.chunks_mut(TILE as usize)) {
                    let added = accumulate_row(row, left..width, samples.clone(), stop, |x, index| {
                        sample(x, y, index, &mut context)
                    });
                    progress(added);
                }
                context
            })
            .collect();
        let mut total = T::default();
        contexts.into_iter().for_each(|context| merge(&mut total, context));
        total
    }
}

/// Adds samples to the pixels of one row of a tile; returns how many.
fn accumulate_row(
    row: &mut [Accumulator],
    columns: Range<u32>,
    samples: Range<u64>,
    stop: &AtomicBool,
    mut sample: impl FnMut(u32, u64) -> Rgb,
) -> u64 {
    let mut added = 0;
    for (x, pixel) in columns.zip(row) {
        if stop.load(Ordering::Relaxed) {
            break;
        }
        for index in samples.clone() {
            pixel.add(sample(x, index));
        }
        added += samples.end - samples.start;
    }
    added
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicU64;

    use super::*;

    #[test]
    fn every_pixel_gets_every_sample_once() {
        let mut film = Film::new(37, 21).unwrap();
        let progress = AtomicU64::new(0);
        let count = film.accumulate(
            3..7,
            |x, y, index, count: &mut u64| {
                *count += 1;
                Rgb::new(x as f32, y as f32, index as f32)
            },
            |total, count| *total += count,
            &AtomicBool::new(false),
            |added| {
                progress.fetch_add(added, Ordering::Relaxed);
            },
        );
        assert_eq!((count, progress.into_inner()), (37 * 21 * 4, 37 * 21 * 4));
        for y in 0..21 {
            for x in 0..37 {
                assert_eq!(film.pixel(x, y).taken(), 4);
                assert_eq!(film.pixel(x, y).mean(), Rgb::new(x as f32, y as f32, 4.5));
            }
        }
        assert_eq!(film.picture().pixels[37 * 20 + 36], Rgb::new(36.0, 20.0, 4.5));
    }

    #[test]
    fn a_stopped_pass_leaves_whole_pixels() {
        let mut film = Film::new(64, 64).unwrap();
        let (stop, calls) = (AtomicBool::new(false), AtomicU64::new(0));
        film.accumulate(
            0..8,
            |_, _, _, _: &mut ()| {
                if calls.fetch_add(1, Ordering::Relaxed) == 1003 {
                    stop.store(true, Ordering::Relaxed);
                }
                Rgb::ONE
            },
            |_, _| (),
            &stop,
            |_| (),
        );
        assert!(film.rows().all(|pixel| matches!(pixel.taken(), 0 | 8)));
        let done = film.rows().filter(|pixel| pixel.taken() == 8).count();
        assert!((126..64 * 64).contains(&done));
        assert_eq!(film.tally().taken, calls.into_inner());
    }
}
