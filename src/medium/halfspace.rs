//! The exact albedo of a thick flat body: an isotropically scattering half-space under a smooth
//! dielectric boundary, by Chandrasekhar's H function.
//!
//! "Albedo" here is the share of the flux that entered the body which leaves it again, when the
//! surface is lit alike from all sides. It is the number by which a separable BSSRDF
//! S = (1 − F_o) R(r) S_w must scale its profile, ∫R dA = albedo, to be right on a plane.

use crate::math::quadrature::GaussLegendre;
use crate::optics::fresnel::fresnel_dielectric;

/// Nodes on each side of the critical angle.
const NODES: usize = 24;

/// Cosines inside the body, their weights and the boundary's internal reflectance there.
struct Directions {
    mu: Vec<f64>,
    weight: Vec<f64>,
    reflectance: Vec<f64>,
}

impl Directions {
    /// Quadrature on (0, 1) split at the critical cosine; above it the substitution
    /// μ = μ_c + (1 − μ_c)x² removes the square root with which Fresnel's reflectance leaves 1.
    fn new(eta: f64) -> Self {
        let critical = (1.0 - 1.0 / (eta * eta)).max(0.0).sqrt();
        let mut directions = Self { mu: Vec::new(), weight: Vec::new(), reflectance: Vec::new() };
        for &(x, w) in GaussLegendre::new(NODES).nodes() {
            if critical > 0.0 {
                directions.push(critical * x, critical * w, eta);
            }
            let span = 1.0 - critical;
            directions.push(critical + span * x * x, 2.0 * x * span * w, eta);
        }
        directions
    }

    fn push(&mut self, mu: f64, weight: f64, eta: f64) {
        self.mu.push(mu);
        self.weight.push(weight);
        self.reflectance.push(f64::from(fresnel_dielectric(-mu as f32, eta as f32).reflectance));
    }
}

/// Chandrasekhar's H function of isotropic scattering at the nodes, by fixed-point iteration of
/// 1/H(μ) = √(1−ω) + (ω/2) ∫ μ'H(μ')/(μ+μ') dμ' (Chandrasekhar 1960, chapter V, equation 16).
fn h_function(directions: &Directions, absorbed_share: f64) -> Vec<f64> {
    let omega = 1.0 - absorbed_share;
    let n = directions.mu.len();
    let mut h = vec![1.0; n];
    for _ in 0..1000 {
        let mut change = 0.0_f64;
        let next: Vec<f64> = (0..n)
            .map(|i| {
                let integral: f64 = (0..n)
                    .map(|j| {
                        directions.weight[j] * directions.mu[j] * h[j] / (directions.mu[i] + directions.mu[j])
                    })
                    .sum();
                1.0 / (absorbed_share.sqrt() + 0.5 * omega * integral)
            })
            .collect();
        for i in 0..n {
            change = change.max((next[i] / h[i] - 1.0).abs());
            // The mean of old and new: the plain iteration overshoots as ω → 1.
            h[i] = 0.5 * (h[i] + next[i]);
        }
        if change < 1e-13 {
            break;
        }
    }
    h
}

/// Albedo of an isotropically scattering half-space behind a smooth boundary of relative index
/// `eta` = n_inside/n_outside, for the flux that entered from uniform surroundings.
///
/// `absorbed_share` is σ_a/(σ_a+σ_s) in [0, 1]. Exact up to quadrature (about 10⁻⁶).
pub fn planar_albedo(absorbed_share: f64, eta: f64) -> f64 {
    if absorbed_share <= 0.0 {
        return 1.0;
    }
    if absorbed_share >= 1.0 {
        return 0.0;
    }
    let directions = Directions::new(eta);
    let h = h_function(&directions, absorbed_share);
    let omega = 1.0 - absorbed_share;
    let n = h.len();
    // Upward radiance U just below the surface, downward D = T + F U, where T is what entered:
    // U(μ_i) = ω/2 Σ_j w_j H_i H_j μ_j/(μ_i+μ_j) D(μ_j)   (Chandrasekhar 1960, chapter III).
    let kernel = |i: usize, j: usize| {
        0.5 * omega * h[i] * h[j] * directions.weight[j] * directions.mu[j]
            / (directions.mu[i] + directions.mu[j])
    };
    let mut matrix = vec![vec![0.0; n + 1]; n];
    for (i, row) in matrix.iter_mut().enumerate() {
        for j in 0..n {
            row[j] = f64::from(u8::from(i == j)) - kernel(i, j) * directions.reflectance[j];
            row[n] += kernel(i, j) * (1.0 - directions.reflectance[j]);
        }
    }
    let upward = solve(matrix);
    let flux = |radiance: &dyn Fn(usize) -> f64| -> f64 {
        (0..n)
            .map(|i| {
                directions.weight[i] * directions.mu[i] * (1.0 - directions.reflectance[i]) * radiance(i)
            })
            .sum()
    };
    flux(&|i| upward[i]) / flux(&|_| 1.0)
}

/// Solves the linear system given with its right side in the last column (Gauss with partial pivoting).
fn solve(mut rows: Vec<Vec<f64>>) -> Vec<f64> {
    let n = rows.len();
    for column in 0..n {
        let pivot = (column..n)
            .max_by(|&a, &b| rows[a][column].abs().total_cmp(&rows[b][column].abs()))
            .unwrap_or(column);
        rows.swap(column, pivot);
        let (above, below) = rows.split_at_mut(column + 1);
        let pivot_row = &above[column];
        for row in below {
            let factor = row[column] / pivot_row[column];
            for k in column..=n {
                row[k] -= factor * pivot_row[k];
            }
        }
    }
    let mut x = vec![0.0; n];
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|j| rows[i][j] * x[j]).sum();
        x[i] = (rows[i][n] - known) / rows[i][i];
    }
    x
}

/// [`planar_albedo`] for one relative index, tabulated over the absorbed share so that it can be
/// looked up, and inverted, at every point of a textured surface.
#[derive(Clone, Debug)]
pub struct PlanarAlbedo {
    /// Albedo at absorbed share t⁴, t = i/(n−1): near 0 the albedo is 1 − k t², with a large k where
    /// the boundary holds light back.
    behind_boundary: Vec<f32>,
}

const TABLE_SIZE: usize = 129;

impl PlanarAlbedo {
    /// Tabulates for relative index `eta`.
    pub fn new(eta: f32) -> Self {
        let behind_boundary = (0..TABLE_SIZE)
            .map(|i| {
                let t = i as f64 / (TABLE_SIZE - 1) as f64;
                planar_albedo(t.powi(4), f64::from(eta)) as f32
            })
            .collect();
        Self { behind_boundary }
    }

    /// Albedo where the share `absorbed_share` = 1 − α' is absorbed per collision.
    pub fn albedo(&self, absorbed_share: f32) -> f32 {
        let position = absorbed_share.clamp(0.0, 1.0).sqrt().sqrt() * (TABLE_SIZE - 1) as f32;
        let i = (position as usize).min(TABLE_SIZE - 2);
        let fraction = position - i as f32;
        self.behind_boundary[i] + fraction * (self.behind_boundary[i + 1] - self.behind_boundary[i])
    }

    /// The absorbed share 1 − α' at which the albedo is `albedo`: the inverse of [`Self::albedo`].
    pub fn absorbed_share(&self, albedo: f32) -> f32 {
        let albedo = albedo.clamp(0.0, 1.0);
        // The table falls from 1 to 0.
        let i = self.behind_boundary.partition_point(|&a| a > albedo).clamp(1, TABLE_SIZE - 1) - 1;
        let (a, b) = (self.behind_boundary[i], self.behind_boundary[i + 1]);
        let fraction = if a > b { ((a - albedo) / (a - b)).clamp(0.0, 1.0) } else { 0.0 };
        let t = (i as f32 + fraction) / (TABLE_SIZE - 1) as f32;
        t * t * t * t
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (ω, η, R for cosine entry including specular, Fresnel's external diffuse reflectance), from an
    /// independent spectral discrete-ordinate solver, g = 0.
    const REFERENCE: &str = include_str!("../../tests/data/halfspace_cosine_albedo.csv");

    #[test]
    fn agrees_with_discrete_ordinates() {
        let mut rows = 0;
        for line in REFERENCE.lines().filter(|l| !l.starts_with('#') && !l.starts_with("omega")) {
            let v: Vec<f64> = line.split(',').map(|x| x.parse().unwrap()).collect();
            let (omega, eta, total, specular) = (v[0], v[1], v[2], v[3]);
            let exact = (total - specular) / (1.0 - specular);
            let ours = planar_albedo(1.0 - omega, eta);
            // The reference is good to 1e-7 after 8 printed digits; our Fresnel factors are f32.
            assert!((ours - exact).abs() < 3e-6, "omega {omega} eta {eta}: {ours} against {exact}");
            rows += 1;
        }
        assert!(rows >= 10);
    }

    #[test]
    fn table_follows_the_function_and_inverts() {
        for eta in [0.75, 1.0, 1.33, 1.5] {
            let table = PlanarAlbedo::new(eta);
            let bend = table.behind_boundary.windows(3).map(|a| (a[0] - 2.0 * a[1] + a[2]).abs());
            // Linear interpolation misses by an eighth of the second difference.
            let bound = bend.fold(0.0, f32::max) / 8.0;
            assert!(bound < 3e-4, "eta {eta}: {bound}");
            for i in 0..200 {
                let share = (i as f32 / 199.0).powi(4);
                let exact = planar_albedo(f64::from(share), f64::from(eta)) as f32;
                // The second derivative may exceed the largest difference taken of it a little.
                assert!((table.albedo(share) - exact).abs() < 1.1 * bound, "eta {eta} share {share}");
                let albedo = table.albedo(share);
                assert!((table.albedo(table.absorbed_share(albedo)) - albedo).abs() < 1e-5);
            }
        }
    }
}
