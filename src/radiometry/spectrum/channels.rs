//! What red, green and blue see of a spectrum that is no colour, such as a coefficient: its means.

use std::sync::LazyLock;

use glam::DVec3;

use super::illuminant::Illuminant;
use super::observer::{COLOR_MATCHING, COUNT, wavelength};
use crate::radiometry::Rgb;
use crate::radiometry::color::XYZ_TO_RGB;

/// How much each channel sees of white light (D65) at the wavelengths of the observer's table: its matching function, where that is
/// above 0. Each sums to 1.
static WEIGHTS: LazyLock<[DVec3; COUNT]> = LazyLock::new(|| {
    let mut weights = [DVec3::ZERO; COUNT];
    for (row, weight) in weights.iter_mut().enumerate() {
        let matching = *XYZ_TO_RGB * DVec3::from(COLOR_MATCHING[row]);
        *weight = matching.max(DVec3::ZERO) * Illuminant::D65.relative_power(wavelength(row));
    }
    let sum: DVec3 = weights.iter().sum();
    weights.map(|weight| weight / sum)
});

/// The mean of `value` (by wavelength in nm) over what each channel of linear Rec.709 sees of white light. Not the colour of a filter that
/// transmits `value`: weights are not negative, so that means lie between the least value and the greatest.
pub fn channel_means(value: impl Fn(f64) -> f64) -> Rgb {
    let mut means = DVec3::ZERO;
    for (row, weight) in WEIGHTS.iter().enumerate() {
        means += *weight * value(wavelength(row));
    }
    Rgb::from_fn(|channel| means[channel] as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_stay_and_channels_see_their_part() {
        // 95 roundings in double precision, one in single.
        let constant = channel_means(|_| 3.0);
        assert!(constant.0.iter().all(|mean| (mean - 3.0).abs() <= 3.0 * f32::EPSILON), "{constant:?}");
        let [r, g, b] = channel_means(|nanometres| nanometres).0;
        // Primaries of Rec.709 have the dominant wavelengths 611, 549 and 464 nm; red sees a little violet as well.
        assert!(
            (r - 611.0).abs() < 25.0 && (g - 549.0).abs() < 10.0 && (b - 464.0).abs() < 10.0,
            "{r} {g} {b}"
        );
    }
}
