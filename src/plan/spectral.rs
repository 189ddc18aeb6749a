//! Whether light is carried by wavelength, and what calls for it.

use super::effects::{by_wavelength, dispersion, first_of, users};
use crate::scene::{ColorMode, Light, Scene};

/// What calls for light by wavelength: the scene file, or something that red, green and blue cannot show.
pub fn spectral(scene: &Scene) -> Option<String> {
    match scene.render.color_mode {
        ColorMode::Spectral => Some("`mode = \"spectral\"` asks for it".into()),
        ColorMode::Rgb => None,
        ColorMode::Auto => {
            users(scene, dispersion).or_else(|| users(scene, by_wavelength)).or_else(|| lamps(scene))
        }
    }
}

/// Lamps whose spectrum is more than a colour; that of D65 is white.
fn lamps(scene: &Scene) -> Option<String> {
    let lamps = scene.lights.iter().filter(|light| !light.emitted().rgb.is_black());
    let lamps = lamps.filter_map(|light: &Light| light.emitted().source.lamp());
    first_of(lamps.filter(|lamp| !lamp.is_white()).map(|lamp| format!("a light is {lamp}")))
}

/// What is said where nothing calls for it.
pub fn not_spectral(scene: &Scene) -> &'static str {
    match scene.render.color_mode {
        ColorMode::Rgb => "`mode = \"rgb\"` excludes it",
        _ => "nothing depends on the wavelength that red, green and blue would not show",
    }
}
