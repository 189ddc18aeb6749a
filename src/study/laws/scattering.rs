//! The three properties of a BSDF: it is not negative, conserves energy, and is reciprocal.

use std::f32::consts::TAU;

use glam::Vec3;
use serde::Serialize;

use crate::math::sampler::HashGenerator;
use crate::transport::{Boundaries, Lobes};

/// Cosines from which light is looked at.
const COSINES: [f32; 6] = [1.0, 0.8, 0.5, 0.2, 0.05, 0.01];

/// Directions drawn at each.
const DRAWS: u32 = 4000;

/// Pairs of directions for reciprocity.
const PAIRS: u32 = 4000;

/// Standard errors that a mean may be above a limit by chance: one in 3 million checks.
const SIGMAS: f64 = 5.0;

/// What single precision makes of a weight: the sum of its roundings.
const ROUNDING: f64 = 1e-5;

/// Break of reciprocity that rounding makes: half vectors of directions that nearly cancel lose some digits.
const RECIPROCAL: f64 = 1e-3;

/// How a surface obeys the laws.
#[derive(Clone, Debug, Default, Serialize)]
pub struct SurfaceLaws {
    /// Values and weights that are negative or not finite.
    pub negative: u64,
    /// The largest share of power that is scattered from any direction, in any channel.
    pub largest_albedo: f64,
    /// Its standard error.
    pub largest_albedo_error: f64,
    /// True if no albedo is above 1 by more than chance and rounding make.
    pub conserves_energy: bool,
    /// Mean of |f(a, b) − f(b, a)| over that of f(a, b) + f(b, a), radiance over squared index; from 0 to 1. `null` where there is
    /// nothing to compare: mirrors, and mixtures whose parts have different laws.
    pub reciprocity_break: Option<f64>,
}

impl SurfaceLaws {
    /// True if values are not negative.
    pub fn is_non_negative(&self) -> bool {
        self.negative == 0
    }

    /// True if reciprocity is not seen to break.
    pub fn is_reciprocal(&self) -> bool {
        self.reciprocity_break.is_none_or(|broken| broken <= RECIPROCAL)
    }

    /// The worse of both in everything.
    pub fn worse(self, other: Self) -> Self {
        let larger = if other.largest_albedo > self.largest_albedo { &other } else { &self };
        let (largest_albedo, largest_albedo_error) = (larger.largest_albedo, larger.largest_albedo_error);
        let broken = [self.reciprocity_break, other.reciprocity_break].into_iter().flatten();
        Self {
            negative: self.negative + other.negative,
            largest_albedo,
            largest_albedo_error,
            conserves_energy: self.conserves_energy && other.conserves_energy,
            reciprocity_break: broken.reduce(f64::max),
        }
    }
}

/// Checks what scatters light where it is met.
pub fn check_surface(boundaries: &Boundaries, lobes: &Lobes) -> SurfaceLaws {
    let mut random = HashGenerator::new(0);
    let mut laws = SurfaceLaws { conserves_energy: true, ..SurfaceLaws::default() };
    // From inside only where it is the inside of something, and all light that passes comes to the same.
    let has_inside = lobes.transmits() && !boundaries.is_mixed && boundaries.eta != 1.0;
    let sides: &[f32] = if has_inside { &[1.0, -1.0] } else { &[1.0] };
    for side in sides {
        for cos in COSINES {
            let (mean, error) = albedo(lobes, side * cos, boundaries, &mut random, &mut laws.negative);
            if mean > laws.largest_albedo {
                (laws.largest_albedo, laws.largest_albedo_error) = (mean, error);
            }
            laws.conserves_energy &= mean <= 1.0 + SIGMAS * error + ROUNDING;
        }
    }
    laws.reciprocity_break =
        reciprocity_break(lobes, boundaries, has_inside, &mut random, &mut laws.negative);
    laws
}

/// Mean share of power scattered from cosine `cos` in the channel that has most, and its standard error.
fn albedo(
    lobes: &Lobes,
    cos: f32,
    boundaries: &Boundaries,
    random: &mut HashGenerator,
    negative: &mut u64,
) -> (f64, f64) {
    let wo = direction(cos, 0.7);
    let (mut sums, mut squares) = ([0.0; 3], [0.0; 3]);
    for draw in 0..DRAWS {
        // Stratified in the choice of lobe.
        let choice = ((draw as f32 + random.next_f32()) / DRAWS as f32).min(1.0 - f32::EPSILON);
        let u = [random.next_f32(), random.next_f32(), choice];
        let Some(sample) = lobes.sample(wo, u, random) else { continue };
        // Weights are of radiance: n² of the side it goes to over that of the side it comes from.
        let scale = if sample.crosses_boundary { squared_index(boundaries, cos) } else { 1.0 };
        for c in 0..3 {
            let weight = f64::from(sample.weight[c] * scale);
            *negative += u64::from(!(weight >= 0.0 && weight.is_finite()));
            sums[c] += weight;
            squares[c] += weight * weight;
        }
    }
    let count = f64::from(DRAWS);
    let estimate = |c: usize| {
        let mean: f64 = sums[c] / count;
        (mean, ((squares[c] / count - mean * mean).max(0.0) / count).sqrt())
    };
    [0, 1, 2].map(estimate).into_iter().fold((0.0, 0.0), |a, b| if b.0 > a.0 { b } else { a })
}

/// (n_i/n_o)² of light that passes the boundary towards cosine `cos`.
fn squared_index(boundaries: &Boundaries, cos: f32) -> f32 {
    let squared = if boundaries.is_mixed { 1.0 } else { boundaries.eta * boundaries.eta };
    if cos < 0.0 { 1.0 / squared } else { squared }
}

/// f(a, b) n_b² against f(b, a) n_a² (Veach 1997, eq. 5.14).
fn reciprocity_break(
    lobes: &Lobes,
    boundaries: &Boundaries,
    has_inside: bool,
    random: &mut HashGenerator,
    negative: &mut u64,
) -> Option<f64> {
    let (mut differences, mut sums) = (0.0, 0.0);
    for _ in 0..PAIRS {
        let mut draw = || {
            let z = random.next_f32().max(1e-3);
            let side = if has_inside && random.next_f32() < 0.5 { -1.0 } else { 1.0 };
            direction(side * z, TAU * random.next_f32())
        };
        let (a, b) = (draw(), draw());
        let factor = if a.z * b.z < 0.0 { squared_index(boundaries, a.z) } else { 1.0 };
        let (there, back) = (lobes.evaluate(a, b), lobes.evaluate(b, a));
        for c in 0..3 {
            let there = f64::from(there[c] * factor / b.z.abs());
            let back = f64::from(back[c] / a.z.abs());
            if there >= 0.0 && back >= 0.0 && (there + back).is_finite() {
                differences += (there - back).abs();
                sums += there + back;
            } else {
                *negative += 1;
            }
        }
    }
    (sums > 0.0).then(|| differences / sums)
}

/// The unit direction of cosine `cos` with +z and azimuth `azimuth`.
pub(super) fn direction(cos: f32, azimuth: f32) -> Vec3 {
    let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
    Vec3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::{Bsdf, Dielectric, Interface, Metal};
    use crate::radiometry::Rgb;

    fn laws(lobes: Lobes, eta: f32) -> SurfaceLaws {
        let boundaries = Boundaries { lobes: None, eta, is_mixed: false, has_bssrdf: false };
        check_surface(&boundaries, &lobes)
    }

    fn diffuse(reflectance: f32) -> SurfaceLaws {
        laws(Lobes::Bsdf(Bsdf::Diffuse { reflectance: Rgb::splat(reflectance) }), 1.0)
    }

    #[test]
    fn a_lambertian_surface_obeys_all_laws() {
        let found = diffuse(0.7);
        assert!(found.is_non_negative() && found.conserves_energy && found.is_reciprocal(), "{found:?}");
        assert!((found.largest_albedo - 0.7).abs() < 1e-6, "{found:?}");
        // f is the same number both ways, but for the rounding of cosines.
        assert!(found.reciprocity_break < Some(1e-6), "{found:?}");
    }

    #[test]
    fn what_breaks_a_law_is_found() {
        assert!(!diffuse(1.01).conserves_energy);
        assert!(!diffuse(-0.1).is_non_negative());
        assert!(!diffuse(f32::NAN).is_non_negative());
    }

    #[test]
    fn boundaries_of_glass_conserve_light_from_both_sides() {
        for alpha in [0.0, 0.2] {
            let glass = Bsdf::Dielectric(Dielectric { eta: 1.5, alpha, tint: Rgb::ONE });
            let found = laws(Lobes::Bsdf(glass), 1.5);
            assert!(found.conserves_energy && found.is_non_negative() && found.is_reciprocal(), "{found:?}");
            assert_eq!(found.reciprocity_break.is_none(), alpha == 0.0, "{found:?}");
            // Light of radiance 1 inside leaves with 1/n² as radiance, and that is not a loss.
            assert!(found.largest_albedo > 0.99, "{found:?}");
        }
    }

    /// By its own account the boundary of walks gives reciprocity up for energy.
    #[test]
    fn the_boundary_of_walks_breaks_reciprocity_measurably() {
        let interface = Interface::new(1.5, 0.5);
        let found = laws(Lobes::Interface(&interface), 1.5);
        assert!(found.conserves_energy && !found.is_reciprocal(), "{found:?}");
        let metal = Bsdf::Metal(Metal { reflectance_normal: Rgb::splat(0.9), alpha: 0.5 });
        assert!(laws(Lobes::Bsdf(metal), 1.0).is_reciprocal());
    }
}
