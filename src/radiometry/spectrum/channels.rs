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
        // Of the dominant wavelengths of the primaries of Rec.709, its own is nearest to what a channel sees.
        let dominant = [611.0_f32, 549.0, 464.0];
        let seen = channel_means(|nanometres| nanometres);
        for channel in 0..3 {
            let distance = |of: usize| (seen[channel] - dominant[of]).abs();
            assert!((0..3).all(|of| of == channel || distance(channel) < distance(of)), "{seen:?}");
        }
    }
}
