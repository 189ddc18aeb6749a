//! Values on the command line.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};

use crate::film::layers::Layer;
use crate::film::view::View;
use crate::scene::{Method, ProfileChoice, SubsurfaceSettings};

/// A parser that knows the names in `table`, which are also those in scene files.
pub fn named<T: Copy + Send + Sync + 'static, const N: usize>(
    table: [(&'static str, T); N],
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(table.map(|(name, _)| name)).try_map(move |given| {
        let found = table.iter().find(|(name, _)| *name == given);
        found.map(|&(_, value)| value).ok_or("unknown name")
    })
}

/// A finite number.
pub fn finite(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err("a finite number is wanted".into()),
    }
}

/// A finite number above 0.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() && number > 0.0 => Ok(number),
        _ => Err("a number above 0 is wanted".into()),
    }
}

/// A finite number, 0 or above.
pub fn not_negative(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() && number >= 0.0 => Ok(number),
        _ => Err("a number, 0 or above, is wanted".into()),
    }
}

/// A cosine of an angle below 90°.
pub fn cosine(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number > 0.0 && number <= 1.0 => Ok(number),
        _ => Err("a number above 0, 1 at most, is wanted".into()),
    }
}

/// A share above 0, 1 at most, also in per cent.
pub fn share(text: &str) -> Result<f32, String> {
    let (number, unit) = text.strip_suffix('%').map_or((text, 1.0), |number| (number, 0.01));
    match number.trim_end().parse::<f32>().map(|number| number * unit) {
        Ok(share) if share > 0.0 && share <= 1.0 => Ok(share),
        _ => Err("a share above 0, 1 at most, is wanted, such as 0.02 or 2%".into()),
    }
}

/// How light under surfaces is computed.
#[derive(Args)]
pub struct SubsurfaceArgs {
    /// How light under surfaces is computed [default: the scene's]
    #[arg(long, value_parser = named(Method::NAMES))]
    method: Option<Method>,
    /// Diffusion profile [default: the scene's]
    #[arg(long, value_name = "NAME", value_parser = named(ProfileChoice::NAMES))]
    profile: Option<ProfileChoice>,
    /// The method auto takes approximations whose expected relative error is at most this: 0.05 or 5% [default: the scene's, else 0.02]
    #[arg(long, value_name = "SHARE", value_parser = share, allow_negative_numbers = true)]
    accuracy: Option<f32>,
}

impl SubsurfaceArgs {
    /// Puts what is given in the place of the scene's.
    pub fn override_in(&self, settings: &mut SubsurfaceSettings) {
        settings.method = self.method.unwrap_or(settings.method);
        settings.profile = self.profile.unwrap_or(settings.profile);
        settings.accuracy = self.accuracy.unwrap_or(settings.accuracy);
    }
}

/// How a .png shows radiance.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum ViewChoice {
    /// Film-like: soft highlights, middle grey kept
    #[default]
    Filmic,
    /// The plain sRGB curve: 1 is white, what is above is cut
    Srgb,
}

impl From<ViewChoice> for View {
    fn from(choice: ViewChoice) -> Self {
        match choice {
            ViewChoice::Filmic => Self::Filmic,
            ViewChoice::Srgb => Self::Srgb,
        }
    }
}

/// Layers of an .exr beside the colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LayerChoice {
    /// Every layer
    All,
    /// Variance of the mean: variance.R, variance.G, variance.B
    Variance,
    /// Samples taken in each pixel
    Samples,
}

impl LayerChoice {
    /// The layers that `choices` name, each once.
    pub fn layers(choices: &[Self]) -> Vec<Layer> {
        let wanted = |layer: &Layer| {
            choices.contains(&Self::All)
                || choices.contains(match layer {
                    Layer::Variance => &Self::Variance,
                    Layer::Samples => &Self::Samples,
                })
        };
        Layer::ALL.into_iter().filter(wanted).collect()
    }
}
