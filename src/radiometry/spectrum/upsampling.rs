//! Spectra for colours: smooth, within bounds, and seen as the colour that they are made from.
//!
//! A reflectance is S(λ) = ½ + x/(2√(1 + x²)) with x = c₀ t² + c₁ t + c₂, which lies between 0 and 1 whatever the
//! coefficients (Jakob and Hanika 2019, "A Low-Dimensional Function Space for Efficient Spectral Upsampling"). The three
//! coefficients are fitted to the colour that S has under D65, by Gauss–Newton steps in CIELAB.

use std::sync::LazyLock;

use glam::{DMat3, DVec3};
use thiserror::Error;

use super::illuminant::Illuminant;
use super::observer::{COLOR_MATCHING, COUNT, wavelength};
use super::{LONGEST, SHORTEST};
use crate::radiometry::Rgb;
use crate::radiometry::color::RGB_TO_XYZ;

/// A reflectance, or another share in [0, 1], by wavelength.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BoundedSpectrum {
    coefficients: [f32; 3],
}

/// A colour that no spectrum here has.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum UpsamplingError {
    /// A channel outside of [0, 1].
    #[error("a reflectance of {0:?}; every channel must lie between 0 and 1")]
    OutOfRange([f32; 3]),
    /// A channel that is not finite or negative.
    #[error("an emission of {0:?}; every channel must be finite and not negative")]
    Negative([f32; 3]),
}

/// Steps towards the colour, from grey: each begins where the one before has ended, so that none begins far off.
const APPROACHES: usize = 8;

/// Gauss–Newton steps at each approach, at most.
const STEPS: usize = 12;

/// CIELAB distance at which a step is the last: far below what is told apart, which is 1.
const CLOSE: f64 = 1e-4;

/// Largest coefficient: beyond, S is 0 or 1 to 10⁻⁶.
const LARGEST: f64 = 1e3;

/// The middle of the visible range and half its width, nm: where t is 0, and 1.
const MIDDLE: f64 = 0.5 * (SHORTEST + LONGEST);
const HALF_WIDTH: f64 = 0.5 * (LONGEST - SHORTEST);

/// X, Y, Z per reflectance at the wavelengths of the observer's table, under D65; those of white sum to its colour.
static RESPONSE: LazyLock<[DVec3; COUNT]> = LazyLock::new(|| {
    let mut response = [DVec3::ZERO; COUNT];
    for (row, response) in response.iter_mut().enumerate() {
        *response = DVec3::from(COLOR_MATCHING[row]) * Illuminant::D65.relative_power(wavelength(row));
    }
    // White is the same as by finer steps.
    let sum: DVec3 = response.iter().sum();
    response.map(|component| component / sum * *WHITE)
});

/// X, Y, Z of white, Y being 1.
static WHITE: LazyLock<DVec3> = LazyLock::new(|| DVec3::from(Illuminant::D65.white()));

impl BoundedSpectrum {
    /// The spectrum of a surface that has the colour `rgb` (linear Rec.709) under D65.
    ///
    /// # Errors
    /// If a channel is outside of [0, 1].
    pub fn fit(rgb: Rgb) -> Result<Self, UpsamplingError> {
        if !rgb.0.iter().all(|channel| (0.0..=1.0).contains(channel)) {
            return Err(UpsamplingError::OutOfRange(rgb.0));
        }
        let color = DVec3::from(rgb.0.map(f64::from));
        let grey = DVec3::splat(color.element_sum() / 3.0);
        let mut coefficients = DVec3::new(0.0, 0.0, inverse_sigmoid(grey.x));
        if color == grey {
            return Ok(Self::from_coefficients(coefficients));
        }
        for approach in 1..=APPROACHES {
            let target = grey.lerp(color, approach as f64 / APPROACHES as f64);
            coefficients = approach_color(coefficients, lab(*RGB_TO_XYZ * target).0);
        }
        Ok(Self::from_coefficients(coefficients))
    }

    fn from_coefficients(coefficients: DVec3) -> Self {
        Self { coefficients: coefficients.to_array().map(|c| c as f32) }
    }

    /// The share at `nanometres`.
    #[inline]
    pub fn value(&self, nanometres: f32) -> f32 {
        let [c0, c1, c2] = self.coefficients;
        let t = (nanometres - MIDDLE as f32) * (1.0 / HALF_WIDTH as f32);
        let x = (c0 * t + c1) * t + c2;
        0.5 + 0.5 * x / (1.0 + x * x).sqrt()
    }
}

/// A quantity without an upper bound by wavelength: a bounded spectrum, scaled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScaledSpectrum {
    scale: f32,
    share: BoundedSpectrum,
}

impl ScaledSpectrum {
    /// The spectrum of the values `rgb` (linear Rec.709): of what differs from grey as a reflectance under D65 does.
    ///
    /// # Errors
    /// If a channel is not finite or negative.
    pub fn fit(rgb: Rgb) -> Result<Self, UpsamplingError> {
        if !(rgb.is_finite() && rgb.min_component() >= 0.0) {
            return Err(UpsamplingError::Negative(rgb.0));
        }
        let (scale, share) = split(rgb);
        Ok(Self { scale, share: BoundedSpectrum::fit(share)? })
    }

    /// The value at `nanometres`.
    pub fn value(&self, nanometres: f32) -> f32 {
        self.scale * self.share.value(nanometres)
    }

    /// The value at `nanometres` of the emission that has the colour `rgb`, D65 being white; per nanometre on the scale on which
    /// constant 1 has Y = 1.
    pub fn emission(&self, nanometres: f32) -> f32 {
        self.value(nanometres) * daylight(nanometres)
    }
}

/// A scale and a share of it, that are `rgb` together; nothing of what has no channel above zero.
fn split(rgb: Rgb) -> (f32, Rgb) {
    // Half, where a share is smoothest.
    let scale = 2.0 * rgb.max_component().clamp(0.0, 0.5 * f32::MAX);
    (scale, if scale > 0.0 { rgb / scale } else { Rgb::ZERO })
}

/// Power of D65 at `nanometres`, its Y being 1 on the scale on which constant 1 has Y = 1.
pub fn daylight(nanometres: f32) -> f32 {
    (Illuminant::D65.relative_power(f64::from(nanometres)) / *WHITE_LUMINANCE) as f32
}

/// Spectra of the colours of a lattice, for colours that are known only when they are met.
///
/// Between the points of the lattice spectra are blended. As a colour is linear in its spectrum, and a colour the same blend
/// of the colours around it, the colour of a blend is the one asked for.
#[derive(Clone, Debug)]
pub struct UpsamplingTable {
    fits: Vec<BoundedSpectrum>,
}

/// Points of the lattice along a channel.
const POINTS: usize = 9;

impl UpsamplingTable {
    /// Fits all of it: some 0.02 s.
    ///
    /// # Errors
    /// That of [`BoundedSpectrum::fit`], which colours of the lattice do not have.
    pub fn new() -> Result<Self, UpsamplingError> {
        let channel = |i: usize| i as f32 / (POINTS - 1) as f32;
        let color = |i: usize| {
            Rgb::new(channel(i / (POINTS * POINTS)), channel(i / POINTS % POINTS), channel(i % POINTS))
        };
        let fits: Result<_, _> = (0..POINTS.pow(3)).map(|i| BoundedSpectrum::fit(color(i))).collect();
        Ok(Self { fits: fits? })
    }

    /// The shares at some wavelengths (nm) of a surface that has the colour `rgb` under D65. Channels are taken within [0, 1].
    pub fn shares<const N: usize>(&self, rgb: Rgb, nanometres: [f32; N]) -> [f32; N] {
        let mut shares = [0.0; N];
        for (weight, fit) in self.around(rgb) {
            for (share, nanometres) in shares.iter_mut().zip(nanometres) {
                *share += weight * fit.value(nanometres);
            }
        }
        shares
    }

    /// The same of an emission of the colour `rgb` that is not negative, per unit of [`daylight`].
    pub fn filters<const N: usize>(&self, rgb: Rgb, nanometres: [f32; N]) -> [f32; N] {
        let (scale, share) = split(rgb);
        self.shares(share, nanometres).map(|share| share * scale)
    }

    /// The corners of the tetrahedron around `rgb` and their weights.
    fn around(&self, rgb: Rgb) -> [(f32, BoundedSpectrum); 4] {
        let steps = [POINTS * POINTS, POINTS, 1];
        let (mut corner, mut rest) = (0, [(0.0, 0); 3]);
        for ((rest, channel), step) in rest.iter_mut().zip(rgb.0).zip(steps) {
            let place = channel.clamp(0.0, 1.0) * (POINTS - 1) as f32;
            let low = (place as usize).min(POINTS - 2);
            corner += low * step;
            *rest = (place - low as f32, step);
        }
        // From the lowest corner to the highest, first along the channel that is farthest on.
        rest.sort_unstable_by(|(a, _), (b, _)| b.total_cmp(a));
        let [(first, a), (second, b), (third, c)] = rest;
        let weights = [1.0 - first, first - second, second - third, third];
        let corners = [corner, corner + a, corner + a + b, corner + a + b + c];
        std::array::from_fn(|i| (weights[i], self.fits[corners[i]]))
    }
}

/// Y of D65 at power 1 at 560 nm.
static WHITE_LUMINANCE: LazyLock<f64> =
    LazyLock::new(|| super::observer::xyz(|nanometres| Illuminant::D65.relative_power(nanometres))[1]);

/// x at which S is `share`, within bounds.
fn inverse_sigmoid(share: f64) -> f64 {
    // s = ½ + x/(2√(1+x²)): x = (s − ½)/√(s(1 − s)).
    let x = (share - 0.5) / (share * (1.0 - share)).sqrt();
    x.clamp(-LARGEST, LARGEST)
}

/// Coefficients of the colour `target` in CIELAB, from others near them: Gauss–Newton steps, shortened (Levenberg 1944)
/// as long as they lead away.
fn approach_color(start: DVec3, target: DVec3) -> DVec3 {
    let mut coefficients = start;
    let (mut residual, mut jacobian) = residual(coefficients, target);
    let mut damping = 1e-6;
    for _ in 0..STEPS {
        if residual.length() < CLOSE {
            break;
        }
        let normal = jacobian.transpose() * jacobian;
        let diagonal = DMat3::from_diagonal(normal.diagonal() + DVec3::splat(1e-12));
        let step = (normal + diagonal * damping).inverse() * (jacobian.transpose() * residual);
        let next = (coefficients - step).clamp(DVec3::splat(-LARGEST), DVec3::splat(LARGEST));
        let (next_residual, next_jacobian) = self::residual(next, target);
        if next_residual.length() < residual.length() {
            (coefficients, residual, jacobian) = (next, next_residual, next_jacobian);
            damping *= 0.1;
        } else {
            damping *= 10.0;
        }
    }
    coefficients
}

/// How far the colour of the coefficients is from `target` in CIELAB, and its derivatives by them, one a column.
fn residual(coefficients: DVec3, target: DVec3) -> (DVec3, DMat3) {
    let (mut color, mut slopes) = (DVec3::ZERO, DMat3::ZERO);
    for (row, response) in RESPONSE.iter().enumerate() {
        let t = (wavelength(row) - MIDDLE) / HALF_WIDTH;
        let powers = DVec3::new(t * t, t, 1.0);
        let x = coefficients.dot(powers);
        let root = (1.0 + x * x).sqrt();
        color += *response * (0.5 + 0.5 * x / root);
        let slope = *response * (0.5 / (root * root * root));
        slopes += DMat3::from_cols(slope * powers.x, slope * powers.y, slope * powers.z);
    }
    let (lab, derivative) = lab(color);
    (lab - target, derivative * slopes)
}

/// CIELAB of a colour under D65, and its derivatives by X, Y, Z (ISO/CIE 11664-4:2019).
fn lab(xyz: DVec3) -> (DVec3, DMat3) {
    const EDGE: f64 = 6.0 / 29.0;
    let share = xyz / *WHITE;
    let curve = |s: f64| match s > EDGE.powi(3) {
        true => (s.cbrt(), 1.0 / (3.0 * s.cbrt().powi(2))),
        false => (s / (3.0 * EDGE * EDGE) + 4.0 / 29.0, 1.0 / (3.0 * EDGE * EDGE)),
    };
    let [(x, dx), (y, dy), (z, dz)] = share.to_array().map(curve);
    let lab = DVec3::new(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z));
    let by_curve = DMat3::from_cols(
        DVec3::new(0.0, 500.0, 0.0),
        DVec3::new(116.0, -500.0, 200.0),
        DVec3::new(0.0, 0.0, -200.0),
    );
    (lab, by_curve * DMat3::from_diagonal(DVec3::new(dx, dy, dz) / *WHITE))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sampler::HashGenerator;
    use crate::radiometry::color::XYZ_TO_RGB;
    use crate::radiometry::spectrum::observer::xyz;

    fn seen(spectrum: impl Fn(f32) -> f32) -> DVec3 {
        *XYZ_TO_RGB * DVec3::from(xyz(|nanometres| f64::from(spectrum(nanometres as f32))))
    }

    #[test]
    fn grey_is_the_same_at_every_wavelength() {
        for grey in [0.0, 1e-4, 0.18, 0.5, 0.999, 1.0] {
            let spectrum = BoundedSpectrum::fit(Rgb::splat(grey)).unwrap();
            for nanometres in [360.0, 500.0, 830.0] {
                // The bound on the coefficients leaves 2.5e-7 of nothing; the sigmoid rounds differences of order 1.
                assert!((spectrum.value(nanometres) - grey).abs() < 5e-7, "{grey}");
            }
        }
    }

    #[test]
    fn shares_stay_within_their_bounds() {
        let mut random = HashGenerator::new(4);
        for _ in 0..300 {
            let rgb = Rgb::from_fn(|_| (1.2 * random.next_f32() - 0.1).clamp(0.0, 1.0));
            let spectrum = BoundedSpectrum::fit(rgb).unwrap();
            for nanometres in (360..=830).step_by(5) {
                let share = spectrum.value(nanometres as f32);
                assert!((0.0..=1.0).contains(&share), "{rgb:?} {nanometres}: {share}");
            }
        }
    }

    #[test]
    fn emission_has_its_color_at_any_power() {
        for rgb in [Rgb::new(3.0, 2.0, 1.0), Rgb::new(1e-6, 0.0, 0.0), Rgb::new(0.0, 4e9, 1e9), Rgb::ZERO] {
            let emission = ScaledSpectrum::fit(rgb).unwrap();
            let got = seen(|nanometres| emission.emission(nanometres));
            let scale = f64::from(rgb.max_component());
            for c in 0..3 {
                // Lab distance 1e-4 of a colour of lightness 76; steps of 1 nm where the fit has 5 nm.
                let error = (got[c] - f64::from(rgb[c])).abs();
                assert!(error <= 5e-3 * scale, "{rgb:?}: {got}");
            }
        }
    }

    /// Blends between colours have the colours between them, to what the fits leave, and stay within bounds.
    #[test]
    fn blends_have_their_color() {
        let table = UpsamplingTable::new().unwrap();
        let mut random = HashGenerator::new(7);
        for i in 0..200 {
            let rgb = if i < 8 {
                Rgb::from_fn(|c| (i >> c & 1) as f32)
            } else {
                Rgb::from_fn(|_| random.next_f32())
            };
            let share = |nanometres: f32| table.shares(rgb, [nanometres])[0];
            for nanometres in (360..=830).step_by(10) {
                assert!((0.0..=1.0 + f32::EPSILON).contains(&share(nanometres as f32)), "{rgb:?}");
            }
            let got = seen(|nanometres| share(nanometres) * daylight(nanometres));
            let bright = seen(|nanometres| table.filters(rgb * 7.0, [nanometres])[0] * daylight(nanometres));
            for c in 0..3 {
                // As for a fit: what it leaves of a colour, in steps of 1 nm where it has 5 nm.
                assert!((got[c] - f64::from(rgb[c])).abs() < 5e-3, "{rgb:?}: {got}");
                assert!((bright[c] / 7.0 - f64::from(rgb[c])).abs() < 5e-3, "{rgb:?}: {bright}");
            }
        }
    }

    #[test]
    fn what_is_no_color_is_refused() {
        for channel in [-0.1, 1.1, f32::NAN, f32::INFINITY] {
            assert!(BoundedSpectrum::fit(Rgb::new(0.5, channel, 0.5)).is_err(), "{channel}");
        }
        for channel in [-0.1, f32::NAN, f32::INFINITY] {
            assert!(ScaledSpectrum::fit(Rgb::new(0.5, 0.5, channel)).is_err(), "{channel}");
        }
    }
}
