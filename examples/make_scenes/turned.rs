//! Turned bodies, in centimetres: pedestal, dish, flame, glass and milk.

use super::remesh::Shaded;
use super::revolve::revolve;

/// Pedestal of the swan: top at y = 0, 1.8 high.
pub fn pedestal() -> Shaded {
    let profile = [
        [0.0, 0.0],
        [1.8, 0.0],
        [3.6, 0.0],
        [4.9, 0.0],
        [5.3, 0.0],
        [5.45, -0.1],
        [5.45, -0.3],
        [5.2, -0.42],
        [5.05, -0.55],
        [5.1, -0.8],
        [5.5, -1.1],
        [5.9, -1.2],
        [6.1, -1.35],
        [6.1, -1.7],
        [5.95, -1.8],
        [5.5, -1.8],
        [3.6, -1.8],
        [1.8, -1.8],
        [0.0, -1.8],
    ];
    revolve(&profile, 3, 112)
}

/// Dish under the candle, standing on y = 0.
pub fn dish() -> Shaded {
    let profile = [
        [0.0, 0.4],
        [1.6, 0.4],
        [3.2, 0.4],
        [4.6, 0.4],
        [5.4, 0.5],
        [6.0, 0.85],
        [6.5, 1.15],
        [6.75, 1.2],
        [6.8, 1.08],
        [6.5, 0.85],
        [6.0, 0.4],
        [5.3, 0.05],
        [4.6, 0.0],
        [3.2, 0.0],
        [1.6, 0.0],
        [0.0, 0.0],
    ];
    revolve(&profile, 4, 112)
}

/// Flame: a teardrop 2.9 high, its foot at the origin.
pub fn flame() -> Shaded {
    let profile = [
        [0.0, 2.9],
        [0.04, 2.65],
        [0.15, 2.15],
        [0.3, 1.55],
        [0.45, 1.0],
        [0.48, 0.5],
        [0.38, 0.12],
        [0.19, 0.0],
        [0.0, 0.0],
    ];
    revolve(&profile, 3, 24)
}

/// Radius of the inner wall of the glass at height `y`.
fn inner_radius(y: f64) -> f64 {
    2.7 + 0.055 * y
}

/// Thickness of the wall of the glass.
const WALL: f64 = 0.22;

/// Height of the inner bottom of the glass.
const BOTTOM: f64 = 0.9;

/// A drinking glass on y = 0: inner and outer wall are one closed body.
pub fn glass() -> Shaded {
    let mut profile =
        vec![[0.0, BOTTOM], [0.9, BOTTOM], [1.8, BOTTOM], [2.4, BOTTOM], [inner_radius(BOTTOM), BOTTOM]];
    let wall = |offset: f64| move |y: f64| [inner_radius(y) + offset, y];
    let heights: Vec<f64> = (0..=10).map(|i| 1.5 + f64::from(i)).collect();
    profile.extend(heights.iter().copied().map(wall(0.0)));
    profile.extend([[inner_radius(11.7) + 0.02, 11.72], [inner_radius(11.7) + WALL - 0.02, 11.72]]);
    profile.extend(heights.iter().rev().copied().map(wall(WALL)));
    profile.extend([
        wall(WALL)(0.7),
        wall(WALL)(0.25),
        [2.75, 0.0],
        [2.4, 0.0],
        [1.8, 0.06],
        [0.9, 0.08],
        [0.0, 0.08],
    ]);
    revolve(&profile, 4, 96)
}

/// The milk in the glass. Its side and bottom reach 0.2 mm into the glass, so that no air is
/// between them; its surface climbs the wall a little.
pub fn milk() -> Shaded {
    const OVERLAP: f64 = 0.02;
    const LEVEL: f64 = 8.6;
    let wall = inner_radius(LEVEL);
    let mut profile = vec![
        [0.0, LEVEL],
        [0.9, LEVEL],
        [1.8, LEVEL],
        [2.5, LEVEL],
        [2.85, LEVEL + 0.02],
        [wall - 0.12, LEVEL + 0.07],
        [wall - 0.02, LEVEL + 0.17],
        [wall + 0.05, LEVEL + 0.22],
        [wall + OVERLAP + 0.01, LEVEL + 0.16],
    ];
    let heights = [8.5, 8.0, 7.5, 6.5, 5.5, 4.5, 3.5, 2.5, 1.5];
    profile.extend(heights.map(|y| [inner_radius(y) + OVERLAP, y]));
    let floor = BOTTOM - OVERLAP;
    profile.extend([
        [inner_radius(BOTTOM) + OVERLAP, floor],
        [2.4, floor],
        [1.8, floor],
        [0.9, floor],
        [0.0, floor],
    ]);
    revolve(&profile, 4, 96)
}
