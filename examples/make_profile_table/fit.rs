//! From rings of light to the logits of the table.

use alabaster::diffusion::shape::{KNOTS, knot_radius};
use alabaster::slab::white::{RINGS, RINGS_PER_DECADE, ring_edge};

/// Shares of the energy, on either side, below which a cumulative energy rests on too few packets: it is continued from there.
const LEAST_INSIDE: f64 = 3e-4;
const LEAST_OUTSIDE: f64 = 1e-4;
/// The same where nothing is absorbed: far out few packets count there, and much each, while 1 − F ~ 1/r.
const LEAST_OUTSIDE_OF_WHITE: f64 = 0.03;

/// Rings on either side of a knot from which its logit is found.
const WINDOW: usize = RINGS_PER_DECADE / 8;

/// Logits of the share of energy within the radii of the knots. `rings` holds the energy by ring, in
/// mean free paths, per energy that entered; `reduced` is the reduced extinction coefficient over the extinction coefficient; `absorbs` is false
/// for the row without absorption.
pub fn logits(rings: &[f64], reduced: f64, absorbs: bool) -> [f64; KNOTS] {
    let inside = running_sums(rings.iter());
    let total = inside[RINGS - 1];
    let outside: Vec<f64> = if absorbs {
        running_sums(rings[1..].iter().rev()).into_iter().rev().collect()
    } else {
        // All that entered leaves: better known than the sum of the few packets that come out far away.
        inside[..RINGS - 1].iter().map(|e| 1.0 - e).collect()
    };
    let least_outside = if absorbs { LEAST_OUTSIDE } else { LEAST_OUTSIDE_OF_WHITE };
    // At the outer edges of the rings that have one.
    let edges: Vec<(f64, f64)> = (0..RINGS - 1)
        .filter(|&i| inside[i] > LEAST_INSIDE * total && outside[i] > least_outside * total)
        .map(|i| ((ring_edge(i) * reduced).ln(), (inside[i] / outside[i]).ln()))
        .collect();
    std::array::from_fn(|k| at(&edges, knot_radius(k).ln(), absorbs))
}

fn running_sums<'a>(energies: impl Iterator<Item = &'a f64>) -> Vec<f64> {
    let add = |sum: &mut f64, energy: &f64| {
        *sum += energy;
        Some(*sum)
    };
    energies.scan(0.0, add).collect()
}

/// The logit at `position` = ln r, from logits at equidistant `edges`.
fn at(edges: &[(f64, f64)], position: f64, absorbs: bool) -> f64 {
    let (first, last) = (edges[0], edges[edges.len() - 1]);
    if position <= first.0 {
        // The pole R ~ 1/r of light scattered once: F in proportion to r.
        return first.1 + position - first.0;
    }
    if position >= last.0 {
        // Far out 1 − F ~ e^(−κr)/r, with κ = 0 where nothing is absorbed, so s − ℓ grows in proportion to r.
        let before = edges[edges.len() - 1 - RINGS_PER_DECADE / 3];
        let rise = (last.1 - last.0) - (before.1 - before.0);
        let rate = if absorbs { (rise / (last.0.exp() - before.0.exp())).max(0.0) } else { 0.0 };
        return last.1 + (position - last.0) + rate * (position.exp() - last.0.exp());
    }
    let step = edges[1].0 - edges[0].0;
    let nearest = ((position - first.0) / step).round() as usize;
    let low = nearest.saturating_sub(WINDOW);
    let high = (nearest + WINDOW).min(edges.len() - 1);
    quadratic_fit(&edges[low..=high], position)
}

/// Value at `x` of the parabola fitted to `points` by least squares.
fn quadratic_fit(points: &[(f64, f64)], x: f64) -> f64 {
    let mut moments = [0.0; 5];
    let mut right = [0.0; 3];
    for (position, value) in points {
        let t = position - x;
        for (power, moment) in moments.iter_mut().enumerate() {
            *moment += t.powi(power as i32);
        }
        for (power, r) in right.iter_mut().enumerate() {
            *r += value * t.powi(power as i32);
        }
    }
    let matrix = nalgebra::Matrix3::from_fn(|i, j| moments[i + j]);
    let solution = matrix.lu().solve(&nalgebra::Vector3::from(right));
    solution.map_or(points[points.len() / 2].1, |s| s[0])
}
