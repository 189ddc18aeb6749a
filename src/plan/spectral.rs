//! Whether light is carried by wavelength, and what calls for it.

use super::effects::{dispersion, users};
use crate::scene::{ColorMode, Scene};

/// What calls for light by wavelength: the scene file, or something that red, green and blue cannot show.
pub fn spectral(scene: &Scene) -> Option<String> {
    match scene.render.color_mode {
        ColorMode::Spectral => Some("`mode = \"spectral\"` asks for it".into()),
        ColorMode::Rgb => None,
        ColorMode::Auto => users(scene, dispersion),
    }
}

/// What is said where nothing calls for it.
pub fn not_spectral(scene: &Scene) -> &'static str {
    match scene.render.color_mode {
        ColorMode::Rgb => "`mode = \"rgb\"` excludes it",
        _ => "nothing depends on the wavelength that red, green and blue would not show",
    }
}
