//! Quantities of light as types, each in the one unit that it is kept in.
//!
//! The types are the project's own, and few. A crate of units compares dimensions, and to it the steradian and the
//! cosine have none: irradiance and exitance, radiance over a solid angle and over a projected one, an area and what
//! is seen of it are each one type there, and to take one for the other is how radiometry goes wrong. Here they
//! are different, and only the [laws](super::law) lead from one to another.
//!
//! Amounts are f64, or whatever else is an [`Amount`]: an `Irradiance<Rgb>` is three irradiances. A quantity is
//! laid out as its amount and compiles to the same arithmetic; inner loops of the renderer are written in plain
//! floats all the same, with the units in their comments.

use std::fmt;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, Mul, Sub};

use serde::Serialize;

use super::Spectrum;

/// What a quantity can be an amount of: one number, or one by channel.
pub trait Amount: Copy + Default + Add<Output = Self> + Sub<Output = Self> {
    /// `self` times `factor`.
    fn scaled(self, factor: f64) -> Self;
}

impl Amount for f64 {
    #[inline]
    fn scaled(self, factor: f64) -> Self {
        self * factor
    }
}

impl Amount for f32 {
    #[inline]
    fn scaled(self, factor: f64) -> Self {
        (f64::from(self) * factor) as Self
    }
}

impl<const N: usize> Amount for Spectrum<N> {
    #[inline]
    fn scaled(self, factor: f64) -> Self {
        self.map(|x| x.scaled(factor))
    }
}

/// A type for a quantity, with the arithmetic that keeps the unit: sums, and multiples by plain numbers.
macro_rules! quantity {
    ($(#[$about:meta])* $name:ident, $unit:literal) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Serialize)]
        #[serde(transparent)]
        #[repr(transparent)]
        pub struct $name<A = f64>(pub A);

        impl $name {
            #[doc = concat!("`", $unit, "`.")]
            pub const UNIT: &str = $unit;
        }

        impl<A: Amount> Add for $name<A> {
            type Output = Self;

            #[inline]
            fn add(self, other: Self) -> Self {
                Self(self.0 + other.0)
            }
        }

        impl<A: Amount> Sub for $name<A> {
            type Output = Self;

            #[inline]
            fn sub(self, other: Self) -> Self {
                Self(self.0 - other.0)
            }
        }

        impl<A: Amount> AddAssign for $name<A> {
            #[inline]
            fn add_assign(&mut self, other: Self) {
                *self = *self + other;
            }
        }

        impl<A: Amount> Mul<f64> for $name<A> {
            type Output = Self;

            #[inline]
            fn mul(self, factor: f64) -> Self {
                Self(self.0.scaled(factor))
            }
        }

        impl Div for $name {
            type Output = f64;

            #[inline]
            fn div(self, other: Self) -> f64 {
                self.0 / other.0
            }
        }

        impl<A: Amount> Sum for $name<A> {
            fn sum<I: Iterator<Item = Self>>(amounts: I) -> Self {
                amounts.fold(Self::default(), |sum, amount| sum + amount)
            }
        }

        impl<A: fmt::Display> fmt::Display for $name<A> {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.0.fmt(f)?;
                f.write_str(concat!(" ", $unit))
            }
        }
    };
}

quantity! {
    /// Energy of one photon, hc/λ.
    PhotonEnergy, "J"
}
quantity! {
    /// Energy per wavelength, Q_λ = dQ/dλ.
    SpectralEnergy, "J/nm"
}
quantity! {
    /// Energy carried by light, Q.
    RadiantEnergy, "J"
}
quantity! {
    /// Power per wavelength, Φ_λ = dΦ/dλ.
    SpectralFlux, "W/nm"
}
quantity! {
    /// Power carried by light, Φ = dQ/dt.
    RadiantFlux, "W"
}
quantity! {
    /// Flux that arrives at a surface per area, E = dΦ/dA.
    Irradiance, "W/m²"
}
quantity! {
    /// Flux that leaves a surface per area, M = dΦ/dA.
    Exitance, "W/m²"
}
quantity! {
    /// Flux that leaves a point per solid angle, I = dΦ/dω.
    RadiantIntensity, "W/sr"
}
quantity! {
    /// Flux per area seen and solid angle, L = d²Φ/(dA cosθ dω): what a ray carries.
    Radiance, "W/(m² sr)"
}
quantity! {
    /// Radiance per wavelength, L_λ = dL/dλ.
    SpectralRadiance, "W/(m² sr nm)"
}
quantity! {
    /// Area of a surface, A.
    Area, "m²"
}
quantity! {
    /// Area of a surface as seen from a direction, A cosθ.
    ProjectedArea, "m²"
}
quantity! {
    /// Interval of wavelengths, Δλ.
    Bandwidth, "nm"
}

impl Area {
    /// As seen at an angle of cosine `cos` with the normal; nothing of it from behind.
    #[inline]
    pub fn projected(self, cos: f64) -> ProjectedArea {
        ProjectedArea(self.0 * cos.max(0.0))
    }
}
