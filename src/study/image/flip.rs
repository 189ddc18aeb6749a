//! HDR-FLIP: how large a difference a person sees who flips between two pictures.
//!
//! Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating Images", at the exposures of Andersson
//! et al. 2021, "Visualizing Errors in Rendered High Dynamic Range Images", from the darkest at which something is
//! seen of the reference's brightest pixel to the one that shows its median; each pixel has its largest error.

use flip_rs::{FlipError, HdrOptions, RgbImage, hdr_flip};
use thiserror::Error;

use crate::film::Picture;

/// Pixels per degree of the eye's angle: a screen of 3840 pixels, as far away as it is wide.
pub const PIXELS_PER_DEGREE: f32 = flip_rs::DEFAULT_PPD;

/// What a person would see.
#[derive(Clone, Debug, PartialEq)]
pub struct Flip {
    /// Mean over the pixels, from 0 to 1.
    pub mean: f64,
    /// Largest of a pixel.
    pub max: f64,
    /// First and last exposure, EV.
    pub exposures: [f64; 2],
    /// By pixel, row-major from the top.
    pub map: Vec<f32>,
}

/// Why there is no such value.
#[derive(Debug, Error)]
pub enum NoFlip {
    /// There is no exposure for a picture that is black.
    #[error("the reference is black")]
    Black,
    /// The pictures are too large or have too wide a range.
    #[error("{0}")]
    Refused(#[from] FlipError),
    /// Radiance so large that its tone-mapped value overflows.
    #[error("the pictures are too bright for single precision")]
    Overflow,
}

/// HDR-FLIP of A against the reference B, by the tone curve of ACES. Pixels that are not finite in either
/// are black in both; negative radiance, which no screen shows, is black.
pub fn flip(a: &Picture, b: &Picture) -> Result<Flip, NoFlip> {
    let seen = |own: &Picture, other: &Picture| {
        let pairs = own.pixels.iter().zip(&other.pixels);
        let channels = pairs.flat_map(|(own, other)| {
            if own.is_finite() && other.is_finite() { own.map(|x| x.max(0.0)).0 } else { [0.0; 3] }
        });
        RgbImage::new(own.width as usize, own.height as usize, channels.collect())
    };
    let (test, reference) = (seen(a, b)?, seen(b, a)?);
    if reference.pixels().iter().all(|&x| x == 0.0) {
        return Err(NoFlip::Black);
    }
    let mut options = HdrOptions::default();
    options.return_exposure_map = false;
    let found = hdr_flip(&reference, &test, options)?;
    let map = found.error_map.into_pixels();
    if !map.iter().all(|error| error.is_finite()) {
        return Err(NoFlip::Overflow);
    }
    let parameters = found.parameters;
    Ok(Flip {
        mean: map.iter().map(|&error| f64::from(error)).sum::<f64>() / map.len() as f64,
        max: map.iter().copied().fold(0.0, f32::max).into(),
        exposures: [parameters.start_exposure, parameters.stop_exposure].map(f64::from),
        map,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::radiometry::Rgb;

    fn picture(pixel: impl Fn(u32, u32) -> Rgb) -> Picture {
        let pixels = (0..24 * 32).map(|i| pixel(i % 32, i / 32)).collect();
        Picture { width: 32, height: 24, pixels }
    }

    fn reference(x: u32, y: u32) -> Rgb {
        Rgb::new((1 + (7 * x + 13 * y) % 32) as f32, x as f32, y as f32) * 0.125
    }

    fn test(x: u32, y: u32) -> Rgb {
        reference(x, y) + Rgb::new(0.5 * ((x + y) % 3) as f32, 0.0, 0.25 * ((x * y) % 5) as f32)
    }

    /// Mean, largest value and exposures by NVIDIA's own program, flip-evaluator 1.7, on the same pictures.
    #[test]
    fn values_are_those_of_the_authors_program() {
        let found = flip(&picture(test), &picture(reference)).unwrap();
        // Single precision throughout, of which powers and roots of small differences leave five digits.
        let close = |value: f64, expected: f64| (value - expected).abs() < 1e-5;
        assert!(close(found.mean, 0.281_842_9) && close(found.max, 0.529_036_1), "{found:?}");
        let [first, last] = found.exposures;
        assert!(close(first, -0.823_266_4) && close(last, 0.134_883_1), "{first} {last}");
    }

    #[test]
    fn what_is_not_finite_is_not_seen() {
        let broken = |x, y| if (x, y) == (3, 5) { Rgb::splat(f32::NAN) } else { reference(x, y) };
        let found = flip(&picture(broken), &picture(reference)).unwrap();
        assert_eq!((found.mean, found.max), (0.0, 0.0));
        assert!(matches!(flip(&picture(test), &picture(|_, _| Rgb::ZERO)), Err(NoFlip::Black)));
    }
}
