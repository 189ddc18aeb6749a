//! Spectra by their values at equal steps, for looking them up fast.

use super::observer::{self, STEP};
use super::{SHORTEST, Spectrum};

/// Rows of a regular spectrum: those of the observer.
pub const ROWS: usize = observer::COUNT;

/// A spectrum by its values from 360 to 830 nm in steps of 5 nm.
pub type RegularSpectrum = Spectrum<ROWS>;

impl RegularSpectrum {
    /// The values of `spectrum`, given in nm.
    pub fn tabulate(spectrum: impl Fn(f64) -> f64) -> Self {
        Self::from_fn(|row| spectrum(observer::wavelength(row)) as f32)
    }
}

/// The row that stands for a visible wavelength in nm: that before or after it, by `u` in [0, 1), so that the wavelengths of rows for all `u` have it
/// for their mean. Values in rows then stand for those that are linear between them.
#[inline]
pub fn row(nanometres: f32, u: f32) -> usize {
    let place = (nanometres - SHORTEST as f32) * (1.0 / STEP as f32);
    // Not below 0: a cast takes what is to 0.
    ((place + u) as usize).min(ROWS - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::radiometry::spectrum::LONGEST;

    #[test]
    fn values_are_linear_between_rows() {
        let spectrum = RegularSpectrum::tabulate(|nanometres| 2.0 * nanometres - 100.0);
        for nanometres in [SHORTEST, 361.0, 555.0, 557.5, 829.9, LONGEST] {
            let draws = 1000;
            let value = |i| f64::from(spectrum[row(nanometres as f32, (i as f32 + 0.5) / draws as f32)]);
            let mean = (0..draws).map(value).sum::<f64>() / f64::from(draws);
            // A comb of a thousand counts each of two rows, whose values differ by 10, to one tooth.
            assert!((mean - (2.0 * nanometres - 100.0)).abs() <= 10.0 / f64::from(draws), "{mean}");
        }
        assert_eq!([row(0.0, 0.5), row(f32::NAN, 0.5), row(f32::INFINITY, 0.5)], [0, 0, ROWS - 1]);
    }
}
