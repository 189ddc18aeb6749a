//! The same properties of a BSSRDF, S(x_o, ω_o; x_i, ω_i), on a plane.

use std::f32::consts::TAU;

use glam::Vec3;
use serde::Serialize;

use super::scattering::direction;
use crate::math::sampler::HashGenerator;
use crate::transport::PlaneBssrdf;

/// Pairs of points and directions.
const PAIRS: u32 = 4000;

/// Cosines at which the share sent back is looked at.
const COSINES: u32 = 64;

/// What single precision makes of a sum of shares that is 1.
const ROUNDING: f64 = 1e-5;

/// How a BSSRDF obeys the laws.
#[derive(Clone, Debug, Serialize)]
pub struct BssrdfLaws {
    /// Values that are negative or not finite.
    pub negative: u64,
    /// The largest share of the light from any direction that is sent back, in any channel.
    pub largest_albedo: f64,
    /// True if it is not above 1.
    pub conserves_energy: bool,
    /// Mean of |S(a; b) − S(b; a)| over that of S(a; b) + S(b; a), from 0 to 1: points as far apart as light spreads, directions as of
    /// uniform light.
    pub reciprocity_break: f64,
}

/// Checks `bssrdf`.
pub fn check_bssrdf(bssrdf: &PlaneBssrdf) -> BssrdfLaws {
    let mut random = HashGenerator::new(0);
    let (mut negative, mut differences, mut sums) = (0, 0.0, 0.0);
    for pair in 0..PAIRS {
        let channel = (pair % 3) as usize;
        let distance = bssrdf.sample_distance(channel, random.next_f32());
        let mut draw = || direction((1.0 - random.next_f32()).sqrt(), TAU * random.next_f32());
        let (a, b) = (draw(), draw());
        let offset = Vec3::X * distance;
        let (there, back) = (bssrdf.value(a, b, offset)[channel], bssrdf.value(b, a, -offset)[channel]);
        let (there, back) = (f64::from(there), f64::from(back));
        if !(there >= 0.0 && back >= 0.0 && (there + back).is_finite()) {
            negative += 1;
        } else if there + back > 0.0 {
            // Each pair was drawn by what S has there, about: as a share of it none outweighs the others.
            differences += (there - back).abs() / (there + back);
            sums += 1.0;
        }
    }
    let cosines = (1..=COSINES).map(|i| i as f32 / COSINES as f32);
    let largest_albedo = cosines.map(|mu| f64::from(bssrdf.albedo(mu).max_component())).fold(0.0, f64::max);
    BssrdfLaws {
        negative,
        largest_albedo,
        conserves_energy: largest_albedo <= 1.0 + ROUNDING,
        reciprocity_break: if sums > 0.0 { differences / sums } else { 0.0 },
    }
}
