//! Where pictures differ: the relative squared error of each pixel as a colour.

use plotters::style::colors::colormaps::ViridisRGB;

use super::metrics::relative_squared_error_of_pixel;
use crate::film::Picture;

/// Powers of ten from one end of the colours to the other.
pub const DECADES: i32 = 4;

/// The colour of a pixel that is not finite in a picture: one that the scale does not have.
pub const NOT_FINITE: [u8; 3] = [255, 0, 144];

/// What share of the pixels may have an error beyond the end of the scale.
const BEYOND: f64 = 0.001;

/// A logarithmic scale of errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scale {
    /// Its upper end is ten to this power, its lower end [`DECADES`] below.
    pub top: i32,
}

impl Scale {
    /// The scale on which all but a thousandth of the errors are at most the upper end.
    pub fn of(errors: &[Option<f64>]) -> Self {
        let mut known: Vec<f64> = errors.iter().copied().flatten().collect();
        if known.is_empty() {
            return Self { top: 0 };
        }
        let rank = ((1.0 - BEYOND) * (known.len() - 1) as f64) as usize;
        let (_, &mut high, _) = known.select_nth_unstable_by(rank, f64::total_cmp);
        Self { top: if high > 0.0 { high.log10().ceil() as i32 } else { 0 } }
    }

    /// The ends: errors that have the first and the last colour.
    pub fn ends(self) -> [f64; 2] {
        [self.top - DECADES, self.top].map(|exponent| 10_f64.powi(exponent))
    }

    /// The colour of an error.
    pub fn color(self, error: Option<f64>) -> [u8; 3] {
        let Some(error) = error else { return NOT_FINITE };
        let position = (error.log10() - f64::from(self.top - DECADES)) / f64::from(DECADES);
        shade(position)
    }
}

/// The colour at `position` from 0 to 1 of the map viridis (Smith and van der Walt 2015), which is perceptually even and
/// grows lighter all the way.
pub fn shade(position: f64) -> [u8; 3] {
    // An error of 0 stands at −∞, which is clamped, too.
    let color = ViridisRGB::get_color(position.clamp(0.0, 1.0));
    [color.0, color.1, color.2]
}

/// The relative squared error of each pixel of A against the reference B, mean of the channels; `None` if one is not finite.
pub fn errors(a: &Picture, b: &Picture) -> Vec<Option<f64>> {
    let pairs = a.pixels.iter().zip(&b.pixels);
    pairs.map(|(&a, &b)| relative_squared_error_of_pixel(a, b)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_covers_all_but_a_few_outliers() {
        let mut errors: Vec<Option<f64>> = (1..=1000).map(|i| Some(f64::from(i) * 1e-5)).collect();
        errors.push(None);
        assert_eq!(Scale::of(&errors), Scale { top: -2 });
        errors.push(Some(1e6));
        assert_eq!(Scale::of(&errors), Scale { top: -2 });
        errors.extend([Some(1e6); 2]);
        assert_eq!(Scale::of(&errors), Scale { top: 6 });
        assert_eq!((Scale::of(&[None]), Scale::of(&[Some(0.0)])), (Scale { top: 0 }, Scale { top: 0 }));
    }

    #[test]
    fn colours_grow_lighter_with_the_error() {
        let scale = Scale { top: -1 };
        assert_eq!(scale.ends(), [10_f64.powi(-5), 0.1]);
        // The ends of viridis.
        let (first, last) = (scale.color(Some(1e-5)), scale.color(Some(0.1)));
        assert_eq!((first, last), ([68, 1, 84], [254, 232, 37]));
        assert_eq!((scale.color(Some(0.0)), scale.color(Some(1e300))), (first, last));
        let mut darker = 0.0;
        for step in 0..=100 {
            let [r, g, b] = shade(f64::from(step) / 100.0).map(f32::from);
            let luma = 0.2126 * r + 0.7152 * g + 0.0722 * b;
            // Each channel is rounded to an integer.
            assert!(luma >= darker - 1.0, "{step}");
            darker = luma;
        }
        assert_eq!(scale.color(None), NOT_FINITE);
    }
}
