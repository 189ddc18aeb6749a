//! Optional layers of a picture beside its colour.

use super::{Accumulator, Film};

/// A layer that can be written beside the colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// Variance of the mean of each channel, (W/(m² sr))²; infinite where unknown.
    Variance,
    /// Samples taken.
    Samples,
}

impl Layer {
    /// Every layer there is.
    pub const ALL: [Self; 2] = [Self::Variance, Self::Samples];
}

/// One channel of a layer.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Name in the file: `layer.channel`, or the layer alone where it has one channel.
    pub name: &'static str,
    /// Row-major values from the top.
    pub values: Vec<f32>,
}

impl Film {
    /// The channels of `layer` so far.
    pub fn layer(&self, layer: Layer) -> Vec<Channel> {
        let variance = |channel: usize| move |pixel: &Accumulator| pixel.variance_of_mean(channel) as f32;
        match layer {
            Layer::Variance => vec![
                self.channel("variance.R", variance(0)),
                self.channel("variance.G", variance(1)),
                self.channel("variance.B", variance(2)),
            ],
            Layer::Samples => vec![self.channel("samples", |pixel| pixel.taken() as f32)],
        }
    }

    fn channel(&self, name: &'static str, value: impl Fn(&Accumulator) -> f32) -> Channel {
        Channel { name, values: self.rows().map(value).collect() }
    }
}
