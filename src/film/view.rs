//! From scene radiance to what a screen shows.

use crate::radiometry::Rgb;
use crate::radiometry::color::linear_to_srgb;

/// How radiance is brought into the range of a screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum View {
    /// A film-like curve with soft highlights, see [`filmic`].
    #[default]
    Filmic,
    /// Nothing but the sRGB transfer curve: 1 is white, what is above is cut.
    Srgb,
}

impl View {
    /// The 8-bit sRGB pixel for `radiance` exposed by `exposure` EV (a factor 2^exposure). What is
    /// not a number is black.
    pub fn encode(self, radiance: Rgb, exposure: f32) -> [u8; 3] {
        let exposed = (radiance * exposure.exp2()).map(|x| if x.is_nan() { 0.0 } else { x.clamp(0.0, 1e9) });
        let shown = match self {
            Self::Filmic => filmic(exposed),
            Self::Srgb => exposed,
        };
        shown.0.map(|x| (linear_to_srgb(x.clamp(0.0, 1.0)) * 255.0).round() as u8)
    }
}

/// Makes [`tone_curve`] leave 18 % grey where it is.
const MIDDLE_GREY_SCALE: f32 = 0.723_17;

/// Tone curve of Narkowicz 2015, "ACES Filmic Tone Mapping Curve", a fit to the reference rendering
/// of the Academy Color Encoding System, scaled to fix 18 % grey. `x` ≥ 0; 1 is reached near 10.
fn tone_curve(x: f32) -> f32 {
    let y = MIDDLE_GREY_SCALE * x;
    (y * (2.51 * y + 0.03) / (y * (2.43 * y + 0.59) + 0.14)).min(1.0)
}

/// The tone curve on a colour with finite channels ≥ 0.
///
/// Applied to each channel it bleaches highlights but turns their hue; applied to the largest
/// channel and the others in proportion, it keeps hue but leaves bright saturated colours garish.
/// The mean of both does a little of each: wax stays warm and its brightest part goes to white.
pub fn filmic(color: Rgb) -> Rgb {
    let peak = color.max_component();
    if peak <= 0.0 {
        return Rgb::ZERO;
    }
    let hue_kept = color * (tone_curve(peak) / peak);
    (color.map(tone_curve) + hue_kept) * 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn middle_grey_stays() {
        // The scale is given to 5 digits and the curve's logarithmic slope is below 2.
        assert!((filmic(Rgb::splat(0.18))[1] / 0.18 - 1.0).abs() < 2e-5);
    }

    #[test]
    fn filmic_is_monotone_within_range_and_keeps_the_order_of_channels() {
        let mut last = Rgb::ZERO;
        for step in 0..400 {
            let shown = filmic(Rgb::new(1.0, 0.6, 0.2) * (step as f32 * 0.1 - 20.0).exp2());
            assert!(shown[0] >= shown[1] && shown[1] >= shown[2] && shown[2] >= 0.0 && shown[0] <= 1.0);
            // Each step is 7 % of radiance; where the curve has saturated the values are equal to rounding.
            assert!(shown.zip(last, |new, old| new - old).min_component() >= -f32::EPSILON);
            last = shown;
        }
    }

    #[test]
    fn srgb_view_is_the_transfer_curve() {
        assert_eq!(View::Srgb.encode(Rgb::new(0.0, 0.214_041_14, 1.0), 0.0), [0, 128, 255]);
        assert_eq!(View::Srgb.encode(Rgb::splat(0.25), 2.0), [255; 3]);
    }

    #[test]
    fn every_value_has_a_pixel() {
        for view in [View::Filmic, View::Srgb] {
            assert_eq!(view.encode(Rgb::new(f32::NAN, -1.0, f32::NEG_INFINITY), 0.0), [0; 3]);
            assert_eq!(view.encode(Rgb::splat(f32::INFINITY), 0.0), [255; 3]);
            assert_eq!(view.encode(Rgb::splat(1.0), -200.0), [0; 3]);
            assert_eq!(view.encode(Rgb::ZERO, 200.0), [0; 3]);
        }
    }
}
