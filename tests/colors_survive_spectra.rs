//! A colour made into a reflectance spectrum, and seen again under D65, is the same colour.

use alabaster::math::sampler::HashGenerator;
use alabaster::radiometry::Rgb;
use alabaster::radiometry::color::{XYZ_TO_RGB, srgb_to_linear};
use alabaster::radiometry::spectrum::illuminant::Illuminant;
use alabaster::radiometry::spectrum::observer::xyz;
use alabaster::radiometry::spectrum::upsampling::BoundedSpectrum;
use glam::DVec3;
use palette::color_difference::Ciede2000;
use palette::{FromColor, Lab, LinSrgb};

/// Half of what is just told apart side by side.
const LARGEST_DIFFERENCE: f64 = 0.5;

fn lab(rgb: [f64; 3]) -> Lab<palette::white_point::D65, f64> {
    Lab::from_color(LinSrgb::from(rgb))
}

/// CIEDE2000 between a colour and what its spectrum looks like under D65.
fn difference(rgb: Rgb) -> f64 {
    let spectrum = BoundedSpectrum::fit(rgb).unwrap();
    let luminance = xyz(|nanometres| Illuminant::D65.relative_power(nanometres))[1];
    let reflected = xyz(|nanometres| {
        Illuminant::D65.relative_power(nanometres) / luminance * f64::from(spectrum.value(nanometres as f32))
    });
    let seen = *XYZ_TO_RGB * DVec3::from(reflected);
    lab(rgb.0.map(f64::from)).difference(lab(seen.to_array()))
}

#[test]
fn a_thousand_colors_come_back() {
    let mut random = HashGenerator::new(1);
    let (mut largest, mut sum) = (0.0_f64, 0.0);
    for _ in 0..1000 {
        let rgb = Rgb::from_fn(|_| srgb_to_linear(random.next_f32()));
        let difference = difference(rgb);
        assert!(difference < LARGEST_DIFFERENCE, "{rgb:?}: {difference}");
        largest = largest.max(difference);
        sum += difference;
    }
    println!("CIEDE2000: mean {:.4}, largest {largest:.4}", sum / 1000.0);
}

/// The hardest: the corners and edges of what a screen can show, where a spectrum comes closest to 0 and 1.
#[test]
fn the_purest_colors_come_back() {
    for corner in 0..8 {
        for weaker in [0.0, 0.05, 0.5] {
            let rgb = Rgb::from_fn(|c| if corner >> c & 1 == 1 { 1.0 } else { srgb_to_linear(weaker) });
            let difference = difference(rgb);
            println!("{rgb:?}: {difference:.4}");
            assert!(difference < LARGEST_DIFFERENCE, "{rgb:?}: {difference}");
        }
    }
}
