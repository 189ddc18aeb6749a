//! What leaves spheres, tabulated over decay rate and optical radius.
//!
//! Survival W and the law of the exit angle are smooth in κ and 1/τ except where both vanish: there the field falls
//! off at the surface as κ coth κτ, which has a limit along every line κτ = const, but not the same one. The table
//! is therefore made over T + 1/τ and T/(T + 1/τ), where T = artanh κ reaches beyond any range as ω falls.

use std::f64::consts::FRAC_PI_2;

/// Nodes of T + 1/τ, from 0.
pub const SUMS: usize = 31;
/// The largest T + 1/τ.
const LARGEST_SUM: f64 = 3.0;
/// Nodes of T/(T + 1/τ), from 0 to 1.
pub const RATES: usize = 21;
/// Nodes of the exit angle, from 0 to π/2.
pub const ANGLES: usize = 49;

/// Difference between neighbouring exit angles.
pub const ANGLE_STEP: f64 = FRAC_PI_2 / (ANGLES - 1) as f64;

/// How far beyond the surface of a large sphere that does not absorb the field extrapolates to zero (Milne's problem;
/// Case and Zweifel 1967, section 6.6), in mean free paths.
const EXTRAPOLATION: f64 = 0.710_446_09;

/// Numbers of a node: survival over its asymptotic form, then the density of the angle at each node.
const COLUMNS: usize = 1 + ANGLES;

/// `[sum][share][column]`, little-endian; `cargo run --release --example make_sphere_table` makes it.
static DATA: &[u8; SUMS * RATES * COLUMNS * 4] = include_bytes!("table.f32");

/// T = artanh κ and the optical radius τ of a node.
pub fn node(sum: usize, share: usize) -> (f64, f64) {
    // The limits, which are reached without a kink, by values close to them.
    let sum = (LARGEST_SUM * sum as f64 / (SUMS - 1) as f64).max(1e-4);
    let share = (share as f64 / (RATES - 1) as f64).clamp(1e-6, 1.0 - 1e-6);
    (sum * share, 1.0 / (sum * (1.0 - share)))
}

/// The survival that a sphere of optical radius `radius` has in diffusion, κ(τ + z)/sinh κ(τ + z), times
/// e^`gain`.
pub fn asymptotic_survival(kappa: f64, radius: f64, gain: f64) -> f64 {
    let x = kappa * (radius + EXTRAPOLATION);
    if x == 0.0 {
        return gain.exp();
    }
    -2.0 * x * (gain - x).exp() / (-2.0 * x).exp_m1()
}

/// T = artanh κ at the share absorbed 1 − ω: the root of T coth T = 1/ω, which is ω artanh(κ) = κ (Case and Zweifel
/// 1967, section 4.3). No digit of small shares is lost.
pub(super) fn decay_rate(absorbed_share: f64) -> f64 {
    let wanted = absorbed_share / (1.0 - absorbed_share);
    let mut t = (3.0 * wanted).sqrt();
    if t == 0.0 {
        return 0.0;
    }
    // Newton's method; the function is convex and lies below T²/3, so it comes from below once and then from above.
    for _ in 0..8 {
        let (value, slope) = excess(t);
        t += (wanted - value) / slope;
    }
    t
}

/// T coth T − 1 and its derivative.
fn excess(t: f64) -> (f64, f64) {
    if t < 0.03 {
        // The next term is below 10⁻¹² of the first.
        let x = t * t;
        return (x * (1.0 / 3.0 - x * (1.0 / 45.0 - x * (2.0 / 945.0))), t * (2.0 / 3.0 - x * (4.0 / 45.0)));
    }
    let (sinh, tanh) = (t.sinh(), t.tanh());
    (t / tanh - 1.0, 1.0 / tanh - t / (sinh * sinh))
}

/// Survival over its asymptotic form and the densities at the nodes of the exit angle, for T = `rate` and the
/// optical radius; at the edge of the table if that is outside.
pub(super) fn interpolate(rate: f64, radius: f64) -> [f64; COLUMNS] {
    let sum = rate + 1.0 / radius;
    let (first_sum, sum_weights) = cubic_weights(sum / LARGEST_SUM * (SUMS - 1) as f64, SUMS);
    let (first_share, share_weights) = cubic_weights(rate / sum * (RATES - 1) as f64, RATES);
    let mut columns = [0.0; COLUMNS];
    for (i, a) in (first_sum..).zip(sum_weights) {
        for (j, b) in (first_share..).zip(share_weights) {
            let start = (i * RATES + j) * COLUMNS;
            for (column, x) in columns.iter_mut().zip(numbers(start)) {
                *column += a * b * x;
            }
        }
    }
    columns
}

/// The numbers of the table from `start` on.
fn numbers(start: usize) -> impl Iterator<Item = f64> {
    DATA.as_chunks().0.iter().skip(start).map(|bytes| f64::from(f32::from_le_bytes(*bytes)))
}

/// Lagrange weights at `x` of the four nearest of `count` nodes 0, 1, 2, …, and the first of the four.
fn cubic_weights(x: f64, count: usize) -> (usize, [f64; 4]) {
    let x = x.clamp(0.0, (count - 1) as f64);
    let first = (x as usize).saturating_sub(1).min(count - 4);
    let [a, b, c, d] = [0.0, 1.0, 2.0, 3.0].map(|i| x - (first as f64 + i));
    (first, [-b * c * d / 6.0, a * c * d / 2.0, -a * b * d / 2.0, a * b * c / 6.0])
}
