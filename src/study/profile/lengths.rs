//! The lengths that coefficients imply, and whether they are likely.

use crate::diffusion::HalfSpace;
use crate::study::numbers::significant;

/// Mean free paths outside of this, m, are hardly those of a thing that one renders.
const LIKELY: std::ops::RangeInclusive<f64> = 1e-7..=0.1;

const MILLIMETRES: f64 = 1e3;

/// The mean free paths of `medium`, in words.
pub fn mean_free_paths(medium: &HalfSpace) -> String {
    format!(
        "mean free path {} mm, reduced {} mm",
        significant(MILLIMETRES / medium.sigma_t()),
        significant(MILLIMETRES * medium.mean_free_path_reduced())
    )
}

/// What is likely wrong with the units of `medium`, if something is, and the factor that mends it.
pub fn unit_hint(medium: &HalfSpace) -> Option<String> {
    let length = 1.0 / medium.sigma_t();
    if LIKELY.contains(&length) {
        return None;
    }
    let millimetres = significant(MILLIMETRES * length);
    let (adjective, mended, mend) = if length > *LIKELY.end() {
        (
            "long",
            1e-3 * length,
            "if they were given in 1/mm, multiply them by 1000 (a mean free path by 0.001)",
        )
    } else {
        (
            "short",
            1e3 * length,
            "if they are too large by such a unit, multiply them by 0.001 (a mean free path by 1000)",
        )
    };
    Some(format!(
        "a mean free path of {millimetres} mm is very {adjective}: coefficients are 1/m; {mend}, and it is {} mm",
        significant(MILLIMETRES * mended)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_units_are_noticed() {
        let medium = |sigma_s| HalfSpace::new(0.0, sigma_s, 0.0, 1.4).unwrap();
        assert_eq!(unit_hint(&medium(2620.0)), None);
        let hint = unit_hint(&medium(2.62)).unwrap();
        assert!(hint.contains("381.7 mm is very long") && hint.contains("multiply them by 1000"), "{hint}");
        assert!(hint.ends_with("it is 0.3817 mm"), "{hint}");
        assert!(unit_hint(&medium(2.62e9)).unwrap().contains("very short"));
    }
}
