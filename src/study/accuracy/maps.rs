//! Where the error is: maps in colour.

use crate::study::image::heat_map::shade;

/// Share of the pixels that may lie beyond the end of a scale.
const BEYOND: f64 = 0.01;

/// Blue, white and red of ColorBrewer's RdBu (Brewer 2003), which colour-blind people tell apart: too dark, right, too bright.
const DIVERGING: [[u8; 3]; 7] = [
    [0x21, 0x66, 0xac],
    [0x67, 0xa9, 0xcf],
    [0xd1, 0xe5, 0xf0],
    [0xf7, 0xf7, 0xf7],
    [0xfd, 0xdb, 0xc7],
    [0xef, 0x8a, 0x62],
    [0xb2, 0x18, 0x2b],
];

/// The end of a scale for all of `maps`: 1, 2 or 5 times a power of ten, above all but a hundredth of their values.
pub fn scale<'a>(maps: impl Iterator<Item = &'a Vec<f64>>) -> f64 {
    let mut sizes: Vec<f64> = maps.flatten().map(|x| x.abs()).filter(|x| x.is_finite()).collect();
    if sizes.is_empty() {
        return 1.0;
    }
    let rank = ((1.0 - BEYOND) * (sizes.len() - 1) as f64) as usize;
    let (_, &mut size, _) = sizes.select_nth_unstable_by(rank, f64::total_cmp);
    rounded_up(size.max(1e-6))
}

fn rounded_up(value: f64) -> f64 {
    let decade = 10.0_f64.powf(value.log10().floor());
    // A rounding above a mark is still the mark.
    let steps = [1.0, 2.0, 5.0, 10.0];
    let step = steps.into_iter().find(|step| step * decade >= value * (1.0 - 1e-9)).unwrap_or(10.0);
    step * decade
}

/// A signed error as a colour, full at ±`scale`.
pub fn diverging(value: f64, scale: f64) -> [u8; 3] {
    let last = (DIVERGING.len() - 1) as f64;
    let at = ((value / scale).clamp(-1.0, 1.0) + 1.0) * 0.5 * last;
    let below = at.floor().min(last - 1.0);
    let [a, b] = [DIVERGING[below as usize], DIVERGING[below as usize + 1]];
    [0, 1, 2].map(|c| (f64::from(a[c]) + (at - below) * (f64::from(b[c]) - f64::from(a[c]))).round() as u8)
}

/// The pixels of a map of signed errors.
pub fn signed(map: &[f64], scale: f64) -> Vec<u8> {
    map.iter().flat_map(|&value| diverging(value, scale)).collect()
}

/// The pixels of a map of sizes, from dark at 0 to light at `scale`.
pub fn unsigned(map: &[f64], scale: f64) -> Vec<u8> {
    // What is not a number has no colour in the map's library.
    map.iter().flat_map(|&value| shade(if value.is_nan() { 0.0 } else { value / scale })).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_end_at_round_numbers() {
        let map: Vec<f64> = (0..1000).map(|i| -f64::from(i) * 1e-4).collect();
        assert!((scale([&map].into_iter()) - 0.1).abs() < 1e-12);
        assert!((rounded_up(0.21) - 0.5).abs() < 1e-12 && (rounded_up(0.2) - 0.2).abs() < 1e-12);
        assert_eq!(scale([].into_iter()), 1.0);
    }

    #[test]
    fn white_is_right_blue_too_dark_red_too_bright() {
        assert_eq!(diverging(0.0, 0.1), DIVERGING[3]);
        assert_eq!((diverging(-0.1, 0.1), diverging(9.0, 0.1)), (DIVERGING[0], DIVERGING[6]));
        assert_eq!(signed(&[0.0, 1.0], 1.0).len(), 6);
        assert_eq!(unsigned(&[f64::NAN, 0.0], 1.0)[..3], unsigned(&[0.0], 1.0));
    }
}
