//! Values per spectral channel, and spectra by wavelength.

pub mod blackbody;
pub mod channels;
pub mod dispersion;
pub mod hero;
pub mod illuminant;
pub mod lamp;
pub mod medium_table;
pub mod observer;
pub mod regular;
pub mod table;
pub mod upsampling;

use std::array;
use std::ops::{Add, AddAssign, Div, Index, Mul, MulAssign, Sub};

use serde::{Deserialize, Serialize};

/// The shortest visible wavelength, nm: that at which the tables of the CIE begin.
pub const SHORTEST: f64 = 360.0;
/// The longest visible wavelength, nm.
pub const LONGEST: f64 = 830.0;

/// `N` channel values of a radiometric quantity or of a dimensionless factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spectrum<const N: usize>(pub [f32; N]);

/// Linear Rec.709 red, green, blue.
pub type Rgb = Spectrum<3>;

impl<const N: usize> Spectrum<N> {
    /// All channels 0.
    pub const ZERO: Self = Self([0.0; N]);
    /// All channels 1.
    pub const ONE: Self = Self([1.0; N]);

    /// All channels `value`.
    pub const fn splat(value: f32) -> Self {
        Self([value; N])
    }

    /// The spectrum with channel c = `f(c)`.
    pub fn from_fn(f: impl FnMut(usize) -> f32) -> Self {
        Self(array::from_fn(f))
    }

    /// Each channel through `f`.
    pub fn map(self, f: impl FnMut(f32) -> f32) -> Self {
        Self(self.0.map(f))
    }

    /// Channel by channel.
    pub fn zip(self, other: Self, mut f: impl FnMut(f32, f32) -> f32) -> Self {
        Self(array::from_fn(|c| f(self.0[c], other.0[c])))
    }

    /// The largest channel.
    pub fn max_component(self) -> f32 {
        self.0.into_iter().fold(f32::NEG_INFINITY, f32::max)
    }

    /// The smallest channel.
    pub fn min_component(self) -> f32 {
        self.0.into_iter().fold(f32::INFINITY, f32::min)
    }

    /// Mean over the channels.
    pub fn mean(self) -> f32 {
        self.0.into_iter().sum::<f32>() / N as f32
    }

    /// True if every channel is exactly 0.
    pub fn is_black(self) -> bool {
        self.0.into_iter().all(|x| x == 0.0)
    }

    /// True if all channels are the same.
    pub fn is_gray(self) -> bool {
        self.0.iter().all(|x| *x == self.0[0])
    }

    /// True if no channel is infinite or NaN.
    pub fn is_finite(self) -> bool {
        self.0.into_iter().all(f32::is_finite)
    }

    /// Channel-wise e^x.
    pub fn exp(self) -> Self {
        self.map(f32::exp)
    }
}

impl Rgb {
    /// From red, green, blue.
    pub const fn new(r: f32, g: f32, b: f32) -> Self {
        Self([r, g, b])
    }
}

impl<const N: usize> Default for Spectrum<N> {
    fn default() -> Self {
        Self::ZERO
    }
}

impl<const N: usize> Index<usize> for Spectrum<N> {
    type Output = f32;

    fn index(&self, channel: usize) -> &f32 {
        &self.0[channel]
    }
}

impl<const N: usize> Add for Spectrum<N> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl<const N: usize> Sub for Spectrum<N> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl<const N: usize> Mul for Spectrum<N> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl<const N: usize> Mul<f32> for Spectrum<N> {
    type Output = Self;

    fn mul(self, factor: f32) -> Self {
        self.map(|x| x * factor)
    }
}

impl<const N: usize> Div<f32> for Spectrum<N> {
    type Output = Self;

    fn div(self, divisor: f32) -> Self {
        self.map(|x| x / divisor)
    }
}

impl<const N: usize> AddAssign for Spectrum<N> {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const N: usize> MulAssign for Spectrum<N> {
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl<const N: usize> MulAssign<f32> for Spectrum<N> {
    fn mul_assign(&mut self, factor: f32) {
        *self = *self * factor;
    }
}

impl Serialize for Rgb {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Rgb {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        <[f32; 3]>::deserialize(deserializer).map(Self)
    }
}
