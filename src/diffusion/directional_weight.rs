//! How much more, or less, light from one direction spreads to a point than light from all directions does: the
//! directional dipole (Frisvad, Hachisuka and Kjeldsen 2014) over its mean.
//!
//! The radial profile is that of uniform light. Light that entered r away along the refracted direction ω₁₂ is
//! weighted by m = S_d(r, ω₁₂)/⟨S_d(r, ·)⟩, the mean being taken over the directions of uniform light that the boundary
//! lets in. So the mean of m is 1 at every distance and nothing changes where light is uniform. For that the geometry is that
//! of the plane, as in the profile itself: r is the distance in space, and both normals are that of the point of entry.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::shape_of_model::reduced_half_space;
use super::{BoundaryMoments, DirectionalDipole, HalfSpaceError};
use crate::math::quadrature::GaussLegendre;
use crate::optics::Boundary;
use crate::optics::fresnel::Interface;

/// Rows over √(1 − α').
const ROWS: usize = 33;

const KNOTS_PER_DECADE: usize = 12;
/// Radii of the first knot and of the last, in reduced mean free paths. Nearer and farther the weights are those
/// found here: they do not change there any more.
const RADII: [f64; 2] = [1e-3, 1e3];
const KNOTS: usize = 6 * KNOTS_PER_DECADE + 1;

/// e-folds of attenuation σ_tr r at which the weights stay as they are: no radius farther out is ever drawn.
const DEEPEST: f64 = 30.0;

/// Polar angles on either side of the critical one, and azimuths on half of the circle (the other half mirrors it).
const POLAR: usize = 24;
const AZIMUTHS: usize = 16;

/// The mean ⟨S_d⟩ under one boundary for every albedo and distance.
#[derive(Clone, Debug)]
pub struct DirectionalWeightTable {
    eta: f64,
    moments: BoundaryMoments,
    /// ln⟨S_d⟩ at reduced mean free path 1, less that of its tail ([`log_tail`]), in rows for √(1 − α').
    rows: Vec<[f64; KNOTS]>,
}

/// The weights of one medium at one distance.
#[derive(Clone, Copy, Debug)]
pub struct DirectionalWeight {
    /// At reduced mean free path 1.
    dipole: DirectionalDipole,
    /// In reduced mean free paths.
    radius: f64,
    inverse_mean: f64,
}

impl DirectionalWeightTable {
    /// The table for `boundary`. It takes about a million evaluations of the model, on all threads.
    ///
    /// # Errors
    /// If no half-space has the boundary's index.
    pub fn new(boundary: &Boundary) -> Result<Self, HalfSpaceError> {
        let eta = f64::from(boundary.eta());
        let moments = BoundaryMoments::new(eta);
        let directions = uniform_light(boundary);
        let row = |i: usize| {
            let root = i as f64 / (ROWS - 1) as f64;
            let half_space = reduced_half_space(root * root, 0.0, eta)?;
            let dipole = DirectionalDipole::with_moments(&half_space, moments);
            Ok(std::array::from_fn(|k| {
                let radius = RADII[0] * 10.0_f64.powf(k as f64 / KNOTS_PER_DECADE as f64);
                let mean: f64 =
                    directions.iter().map(|&(w12, weight)| weight * on_plane(&dipole, radius, w12)).sum();
                // Beyond DEEPEST it may underflow.
                mean.max(f64::MIN_POSITIVE).ln() - log_tail(dipole.sigma_tr() * radius)
            }))
        };
        let rows = (0..ROWS).into_par_iter().map(row).collect::<Result<_, HalfSpaceError>>()?;
        Ok(Self { eta, moments, rows })
    }

    /// The weights in a medium of which the share `absorbed_share` = 1 − α' is absorbed at a collision of the reduced
    /// medium, `radius` reduced mean free paths away from where the light leaves.
    pub fn at(&self, absorbed_share: f32, radius: f32) -> Option<DirectionalWeight> {
        let half_space = reduced_half_space(f64::from(absorbed_share.clamp(0.0, 1.0)), 0.0, self.eta).ok()?;
        let dipole = DirectionalDipole::with_moments(&half_space, self.moments);
        let farthest = RADII[1].min(DEEPEST / dipole.sigma_tr());
        let radius = f64::from(radius).clamp(RADII[0], farthest);
        let row = half_space.sigma_a.sqrt() * (ROWS - 1) as f64;
        let knot = (radius / RADII[0]).log10() * KNOTS_PER_DECADE as f64;
        let log_mean = self.interpolate(row, knot) + log_tail(dipole.sigma_tr() * radius);
        Some(DirectionalWeight { dipole, radius, inverse_mean: (-log_mean).exp() })
    }

    /// By cubics through the four nearest rows and knots.
    fn interpolate(&self, row: f64, knot: f64) -> f64 {
        let (first_row, of_rows) = cubic_weights(row, ROWS);
        let (first_knot, of_knots) = cubic_weights(knot, KNOTS);
        let in_row = |row: &[f64; KNOTS]| -> f64 {
            row[first_knot..].iter().zip(of_knots).map(|(value, weight)| value * weight).sum()
        };
        self.rows[first_row..].iter().zip(of_rows).map(|(row, weight)| weight * in_row(row)).sum()
    }

    /// The unit direction below the boundary of light from the unit local direction `wi`, which points away
    /// from the surface (z is the normal). What enters a rough boundary beyond the critical angle of a smooth one grazes.
    pub fn refracted(&self, wi: Vec3) -> DVec3 {
        refracted(wi.as_dvec3(), self.eta)
    }
}

impl DirectionalWeight {
    /// m of light that goes down along `w12`, a unit direction in the frame whose z axis is the normal at the point of
    /// entry and whose x axis points to where the light leaves. Not negative, finite.
    pub fn of(&self, w12: DVec3) -> f32 {
        (on_plane(&self.dipole, self.radius, w12) * self.inverse_mean) as f32
    }
}

/// ln((1 + x)e^(−x)) at x = σ_tr r: how every dipole falls far out, but for powers of r.
fn log_tail(x: f64) -> f64 {
    x.ln_1p() - x
}

/// S_d on a plane.
fn on_plane(dipole: &DirectionalDipole, radius: f64, w12: DVec3) -> f64 {
    dipole.diffusive_part(radius * DVec3::X, w12, DVec3::Z, DVec3::Z)
}

fn refracted(wi: DVec3, eta: f64) -> DVec3 {
    let cos_t = Interface::new(wi.z.clamp(0.0, 1.0), eta).cos_t;
    let tangential = -wi.truncate();
    let sin_t = ((1.0 - cos_t) * (1.0 + cos_t)).sqrt();
    (tangential.normalize_or_zero() * sin_t).extend(-cos_t)
}

/// Directions below the boundary of light from uniform surroundings, with weights that sum to 1.
fn uniform_light(boundary: &Boundary) -> Vec<(DVec3, f64)> {
    let eta = f64::from(boundary.eta());
    let critical = ((1.0 - eta) * (1.0 + eta)).max(0.0).sqrt();
    let rule = GaussLegendre::new(POLAR);
    let mut directions = Vec::with_capacity(2 * POLAR * AZIMUTHS);
    for (from, to) in [(0.0, critical), (critical, 1.0)] {
        for &(x, node_weight) in rule.nodes() {
            // x⁴ takes out the square root at the critical angle, and resolves the grazing light that counts
            // nearby.
            let mu = from + (to - from) * x.powi(4);
            let lobe = mu * f64::from(boundary.transmittance(mu as f32));
            let weight = (to - from) * node_weight * x.powi(3) * lobe;
            let sin = ((1.0 - mu) * (1.0 + mu)).sqrt();
            for i in 0..AZIMUTHS {
                let (sin_azimuth, cos_azimuth) = (PI * (i as f64 + 0.5) / AZIMUTHS as f64).sin_cos();
                directions
                    .push((refracted(DVec3::new(sin * cos_azimuth, sin * sin_azimuth, mu), eta), weight));
            }
        }
    }
    directions.retain(|(_, weight)| *weight > 0.0);
    let total: f64 = directions.iter().map(|(_, weight)| weight).sum();
    directions.iter_mut().for_each(|(_, weight)| *weight /= total);
    directions
}

/// The first of the four of `count` equidistant nodes nearest to `position`, and their Lagrange weights.
fn cubic_weights(position: f64, count: usize) -> (usize, [f64; 4]) {
    let first = (position as usize).saturating_sub(1).min(count - 4);
    let t = position - first as f64;
    let (a, b, c, d) = (t, t - 1.0, t - 2.0, t - 3.0);
    (first, [-b * c * d / 6.0, a * c * d / 2.0, -a * b * d / 2.0, a * b * c / 6.0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sampler::HashGenerator;

    /// ∫ m S_w cosθ dω and its square's, by midpoints of the azimuth and Gauss–Legendre in the cubic root of the height
    /// above the critical cosine, other rules than those of the table.
    fn mean_weight(boundary: &Boundary, table: &DirectionalWeightTable, weight: &DirectionalWeight) -> f64 {
        let critical = f64::from((1.0 - boundary.eta().powi(2)).max(0.0).sqrt());
        let rule = GaussLegendre::new(100);
        let (mut sum, mut total) = (0.0, 0.0);
        for (from, to) in [(0.0, critical), (critical, 1.0)] {
            for &(x, node_weight) in rule.nodes() {
                let mu = (from + (to - from) * x.powi(3)) as f32;
                let lobe = (to - from) * x.powi(2) * node_weight * f64::from(boundary.exit_lobe(mu) * mu);
                for i in 0..50 {
                    let (sin, cos) = (std::f32::consts::PI * (i as f32 + 0.5) / 50.0).sin_cos();
                    let sine = (1.0 - mu * mu).sqrt();
                    let m = weight.of(table.refracted(Vec3::new(sine * cos, sine * sin, mu)));
                    assert!(m >= 0.0 && m.is_finite());
                    sum += lobe * f64::from(m);
                    total += lobe;
                }
            }
        }
        sum / total
    }

    #[test]
    fn mean_weight_of_uniform_light_is_one_at_every_distance() {
        for (eta, alpha) in [(1.0, 0.0), (1.33, 0.0), (1.5, 0.25), (0.75, 0.0), (0.75, 0.25)] {
            let boundary = Boundary::new(eta, alpha);
            let table = DirectionalWeightTable::new(&boundary).unwrap();
            let mut random = HashGenerator::new(5);
            let mut worst = 0.0_f64;
            for _ in 0..100 {
                let share = 0.9 * random.next_f32().powi(4);
                // Up to where a ten-thousandth of the light is left.
                let farthest = (10.0 / (3.0 * share).sqrt()).min(1e4);
                let radius = farthest * (1e-4 / farthest).powf(random.next_f32());
                let mean = mean_weight(&boundary, &table, &table.at(share, radius).unwrap());
                worst = worst.max((mean - 1.0).abs());
            }
            println!("eta {eta}, alpha {alpha}: {worst:.1e}");
            // Quadrature over a lobe that is tabulated where it is rough, and cubics between the nodes of a table: 4e-4.
            assert!(worst < 1e-3, "eta {eta}, alpha {alpha}: {worst:.1e}");
        }
    }

    #[test]
    fn weights_are_in_the_ratio_of_the_dipole() {
        let boundary = Boundary::new(1.4, 0.0);
        let table = DirectionalWeightTable::new(&boundary).unwrap();
        let half_space = crate::diffusion::HalfSpace::new(0.1, 0.9, 0.0, f64::from(1.4_f32)).unwrap();
        let dipole = DirectionalDipole::new(&half_space);
        for radius in [0.01_f32, 0.4, 3.0] {
            let weight = table.at(0.1, radius).unwrap();
            let [a, b] =
                [Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.36, 0.48, 0.8)].map(|wi| table.refracted(wi));
            let [exact_a, exact_b] = [a, b].map(|w12| on_plane(&dipole, f64::from(radius), w12));
            // The share absorbed is rounded to single precision, and so are the weights.
            assert!((f64::from(weight.of(a) / weight.of(b)) / (exact_a / exact_b) - 1.0).abs() < 1e-6);
            assert!(weight.of(b) > weight.of(a), "light that travels towards the exit brings more");
        }
    }
}
