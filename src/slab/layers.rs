//! The stack of layers that photons walk through.

use thiserror::Error;

/// A homogeneous layer. Any unit of length will do, if it is the same everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// Index of refraction.
    pub ior: f64,
    /// Absorption coefficient μ_a, 1/length.
    pub sigma_a: f64,
    /// Scattering coefficient μ_s (not reduced), 1/length.
    pub sigma_s: f64,
    /// Mean cosine g of the Henyey–Greenstein phase function, in (−1, 1).
    pub g: f64,
    /// Thickness; infinite for a half-space, in the last layer only.
    pub thickness: f64,
}

impl Layer {
    /// Extinction coefficient, 1/length.
    pub fn sigma_t(&self) -> f64 {
        self.sigma_a + self.sigma_s
    }
}

/// Layers from top to bottom, between two clear media. z = 0 is the top, z grows downwards.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerStack {
    ior_above: f64,
    layers: Vec<Layer>,
    ior_below: f64,
}

/// What is wrong with a stack.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum LayerError {
    /// There is no layer at all.
    #[error("there are no layers; at least one is needed")]
    Empty,
    /// A value that cannot be.
    #[error("{place}: {field} is {value}; it must be {range}")]
    OutOfRange {
        /// Which layer, or above or below.
        place: Place,
        /// Name of the quantity.
        field: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
}

/// Where in a stack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The medium above.
    Above,
    /// A layer, counted from 1 at the top.
    Layer(usize),
    /// The medium below.
    Below,
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Above => f.write_str("medium above"),
            Self::Layer(number) => write!(f, "layer {number}"),
            Self::Below => f.write_str("medium below"),
        }
    }
}

impl LayerStack {
    /// `layers` from top to bottom between media of index `ior_above` and `ior_below`.
    ///
    /// # Errors
    /// If there is no layer, or a value is outside its range: indices positive, coefficients not
    /// negative, |g| < 1, thickness positive (infinite in the last layer only); all finite otherwise.
    pub fn new(ior_above: f64, layers: Vec<Layer>, ior_below: f64) -> Result<Self, LayerError> {
        if layers.is_empty() {
            return Err(LayerError::Empty);
        }
        check_ior(Place::Above, ior_above)?;
        for (i, layer) in layers.iter().enumerate() {
            check_layer(Place::Layer(i + 1), layer, i + 1 == layers.len())?;
        }
        check_ior(Place::Below, ior_below)?;
        Ok(Self { ior_above, layers, ior_below })
    }

    /// A half-space of one layer, in a medium of index 1.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn half_space(ior: f64, sigma_a: f64, sigma_s: f64, g: f64) -> Result<Self, LayerError> {
        Self::new(1.0, vec![Layer { ior, sigma_a, sigma_s, g, thickness: f64::INFINITY }], ior)
    }

    /// Index of refraction of the medium above.
    pub fn ior_above(&self) -> f64 {
        self.ior_above
    }

    /// The layers from top to bottom.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// Index of refraction of the medium below.
    pub fn ior_below(&self) -> f64 {
        self.ior_below
    }

    /// Total thickness.
    pub fn thickness(&self) -> f64 {
        self.layers.iter().map(|layer| layer.thickness).sum()
    }
}

fn check_ior(place: Place, ior: f64) -> Result<(), LayerError> {
    check(place, "the index of refraction", ior, ior > 0.0 && ior.is_finite(), "positive and finite")
}

fn check_layer(place: Place, layer: &Layer, last: bool) -> Result<(), LayerError> {
    let coefficient = |x: f64| x >= 0.0 && x.is_finite();
    let range = "0 or larger, and finite";
    check_ior(place, layer.ior)?;
    check(place, "the absorption coefficient mua", layer.sigma_a, coefficient(layer.sigma_a), range)?;
    check(place, "the scattering coefficient mus", layer.sigma_s, coefficient(layer.sigma_s), range)?;
    check(place, "the mean cosine g", layer.g, layer.g.abs() < 1.0, "between -1 and 1, both excluded")?;
    let range = if last { "positive" } else { "positive and finite (only the last layer may be infinite)" };
    let thick = layer.thickness > 0.0 && (last || layer.thickness.is_finite());
    check(place, "the thickness d", layer.thickness, thick, range)
}

fn check(
    place: Place,
    field: &'static str,
    value: f64,
    right: bool,
    range: &'static str,
) -> Result<(), LayerError> {
    if right { Ok(()) } else { Err(LayerError::OutOfRange { place, field, value, range }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_is_refused_with_its_place_and_name() {
        let good = Layer { ior: 1.4, sigma_a: 0.1, sigma_s: 10.0, g: 0.9, thickness: 1.0 };
        assert!(LayerStack::new(1.0, vec![good; 3], 1.0).is_ok());
        let cases = [
            (Layer { ior: 0.0, ..good }, "layer 2: the index of refraction is 0"),
            (Layer { sigma_a: -1.0, ..good }, "layer 2: the absorption coefficient mua is -1"),
            (Layer { sigma_s: f64::NAN, ..good }, "layer 2: the scattering coefficient mus is NaN"),
            (Layer { g: 1.0, ..good }, "layer 2: the mean cosine g is 1"),
            (Layer { thickness: 0.0, ..good }, "layer 2: the thickness d is 0"),
            (Layer { thickness: f64::INFINITY, ..good }, "only the last layer may be infinite"),
        ];
        for (bad, message) in cases {
            let error = LayerStack::new(1.0, vec![good, bad, good], 1.0).unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
        assert_eq!(LayerStack::new(1.0, Vec::new(), 1.0), Err(LayerError::Empty));
        assert!(LayerStack::new(1.0, vec![good], f64::NAN).is_err());
    }
}
