//! The profile tabulated from Monte Carlo: a half-space of any albedo, index of refraction and mean cosine.
//!
//! `cargo run --release --example make_profile_table` makes the table with this project's own photon Monte Carlo
//! ([`crate::slab`]). It holds form only: the energy is normalised, exactly, by the way in which a
//! [`ShapeTable`] keeps it, whatever is interpolated; the total albedo comes from transport theory.

use std::sync::LazyLock;

use super::shape::{KNOTS, ShapeTable};
use crate::medium::Entry;
use crate::medium::albedo_inversion::unreduced_share;
use crate::optics::fresnel_moment;

/// Rows of the absorbed share of the reduced medium, 1 − α' = (i/(ROWS − 1))².
pub const ROWS: usize = 41;

/// Absorbed share 1 − ω of the medium itself in row `row`.
pub fn absorbed_share_of_row(row: usize, g: f64) -> f64 {
    let root = row as f64 / (ROWS - 1) as f64;
    // The form of the last row is that of single scattering alone; at ω = 0 nothing would be left of it.
    unreduced_share((root * root).min(1.0 - 1e-7), g)
}

/// Mean cosines, from 0 to 0.9. In ln(1 − g) their distances are nearly alike, but for one between the first two.
pub const G_NODES: [f64; 6] =
    [0.0, 0.2, 0.437_658_674_809_650_3, 0.683_772_233_983_162_1, 0.822_172_058_996_109_5, 0.9];

/// Indices of refraction below 1, where the boundary reflects little from inside.
const ETA_BELOW_ONE: [f64; 2] = [0.6, 0.8];

/// Nodes from η = 1 up.
const ETA_FROM_ONE: usize = 7;

/// Nodes of η.
pub const ETA_NODES: usize = ETA_BELOW_ONE.len() + ETA_FROM_ONE;

/// The largest internal diffuse reflectance of the boundary, 2C₁.
const LARGEST_REFLECTANCE: f64 = 0.8;

/// Indices of refraction, rising: those below 1, then those whose boundaries reflect 0, …, 0.8 of diffuse light
/// from inside, equidistantly; the last is 2.042.
pub fn eta_nodes() -> [f64; ETA_NODES] {
    std::array::from_fn(|i| match i.checked_sub(ETA_BELOW_ONE.len()) {
        None => ETA_BELOW_ONE[i],
        // Bisection would only come near 1.
        Some(0) => 1.0,
        Some(j) => index_reflecting(LARGEST_REFLECTANCE * j as f64 / (ETA_FROM_ONE - 1) as f64),
    })
}

/// The index of refraction above 1 whose boundary reflects the share `wanted` of diffuse light from inside.
fn index_reflecting(wanted: f64) -> f64 {
    let (mut low, mut high) = (1.0, 3.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if internal_reflectance(middle) < wanted { low = middle } else { high = middle }
    }
    low
}

/// Diffuse reflectance of the boundary for light from inside, 2C₁.
fn internal_reflectance(eta: f64) -> f64 {
    2.0 * fresnel_moment(1.0 / eta, 1)
}

/// The coordinate in which profiles are interpolated over η. From 1 up it is the root of the diffuse reflectance from inside,
/// like the cosine of the critical angle ∝ √(η − 1) near 1, on which what grazing light does depends. Below 1, where nothing is
/// totally reflected, it is minus the reflectance.
fn eta_coordinate(eta: f64) -> f64 {
    let reflectance = internal_reflectance(eta);
    if eta < 1.0 { -reflectance } else { reflectance.sqrt() }
}

/// Logits of all shapes, [entry][g][η][row][knot] in little-endian f32.
static DATA: &[u8] = include_bytes!("tabulated.f32");

/// The relative indices of refraction that the table covers, lowest and highest.
pub fn eta_range() -> [f64; 2] {
    static LARGEST: LazyLock<f64> = LazyLock::new(|| eta_nodes()[ETA_NODES - 1]);
    [ETA_BELOW_ONE[0], *LARGEST]
}

/// The mean cosines that the table covers, lowest and highest.
pub fn g_range() -> [f64; 2] {
    [G_NODES[0], G_NODES[G_NODES.len() - 1]]
}

/// Whether the table covers the index of refraction and mean cosine. It covers every albedo.
pub fn covers(eta: f64, g: f64) -> bool {
    let ([eta_low, eta_high], [g_low, g_high]) = (eta_range(), g_range());
    eta >= eta_low && eta <= eta_high && g >= g_low && g <= g_high
}

/// Shapes of the half-space of relative index `eta` and mean cosine `g`, for every albedo; the nearest in the
/// table where it does not [cover](covers) them.
pub fn shape_table(entry: Entry, eta: f64, g: f64) -> ShapeTable {
    let in_g = weights(&G_NODES.map(|g| -(1.0 - g).ln()), -(1.0 - g).ln());
    let nodes = eta_nodes();
    // The profile is not smooth across η = 1, where total reflection begins: each side is interpolated apart.
    let one = ETA_BELOW_ONE.len();
    let (first, side) = if eta < 1.0 { (0, &nodes[..=one]) } else { (one, &nodes[one..]) };
    let coordinates: Vec<f64> = side.iter().map(|&node| eta_coordinate(node)).collect();
    let in_eta = weights(&coordinates, eta_coordinate(eta));
    let logits: Vec<[f64; KNOTS]> = (0..ROWS)
        .map(|row| {
            let mut sum = [0.0; KNOTS];
            for (i, wg) in in_g.iter().enumerate().filter(|(_, w)| **w != 0.0) {
                for (j, we) in in_eta.iter().enumerate().filter(|(_, w)| **w != 0.0) {
                    let shape = ((entry as usize * G_NODES.len() + i) * ETA_NODES + first + j) * ROWS + row;
                    for (k, s) in sum.iter_mut().enumerate() {
                        *s += wg * we * logit(shape * KNOTS + k);
                    }
                }
            }
            sum
        })
        .collect();
    ShapeTable::new(&logits)
}

fn logit(index: usize) -> f64 {
    let bytes = DATA.get(4 * index..4 * index + 4).and_then(|bytes| bytes.try_into().ok());
    f64::from(bytes.map_or(0.0, f32::from_le_bytes))
}

/// Lagrange weights of the four `nodes` nearest to `x` (of all, if there are fewer), 0 for the others. Outside
/// the nodes, those of the nearest end.
fn weights(nodes: &[f64], x: f64) -> Vec<f64> {
    let x = x.clamp(nodes[0], nodes[nodes.len() - 1]);
    let count = nodes.len().min(4);
    let above = nodes.partition_point(|&node| node < x);
    let first = above.saturating_sub(count / 2).min(nodes.len() - count);
    let used = first..first + count;
    let weight = |i: usize| {
        let others = used.clone().filter(|&j| j != i);
        others.map(|j| (x - nodes[j]) / (nodes[i] - nodes[j])).product()
    };
    (0..nodes.len()).map(|i| if used.contains(&i) { weight(i) } else { 0.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_whole_and_small() {
        assert_eq!(DATA.len(), 2 * G_NODES.len() * ETA_NODES * ROWS * KNOTS * 4);
        assert!(DATA.len() <= 2 << 20);
    }

    #[test]
    fn weights_interpolate_cubics() {
        let nodes = [0.0, 0.5, 1.0, 2.0, 2.5, 4.0];
        let cubic = |x: f64| 1.0 + x - 2.0 * x * x + 0.3 * x * x * x;
        for x in [0.0, 0.3, 0.5, 1.7, 2.2, 3.9, 4.0] {
            let sum: f64 = weights(&nodes, x).iter().zip(nodes).map(|(w, node)| w * cubic(node)).sum();
            assert!((sum - cubic(x)).abs() < 1e-13, "{x}: {sum}");
        }
    }
}
