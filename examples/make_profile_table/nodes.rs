//! Where the table has its nodes.

use alabaster::optics::fresnel_moment;

/// Rows of the absorbed share of the reduced medium, 1 − α' = (i/(ROWS − 1))².
pub const ROWS: usize = 41;

/// Mean cosines: equidistant in ln(1 − g), from 0 to 0.9.
pub const G: [f64; 5] = [0.0, 0.437_658_674_809_650_3, 0.683_772_233_983_162_1, 0.822_172_058_996_109_5, 0.9];

/// Nodes of the index of refraction.
pub const ETA_NODES: usize = 7;

/// The largest internal diffuse reflectance of the boundary, 2C₁.
pub const LARGEST_REFLECTANCE: f64 = 0.8;

/// Indices of refraction whose boundaries reflect 0, …, 0.8 of diffuse light from inside, equidistantly.
pub fn eta_nodes() -> Vec<f64> {
    let reflectance = |eta: f64| 2.0 * fresnel_moment(1.0 / eta, 1);
    let node = |i: usize| {
        let wanted = LARGEST_REFLECTANCE * i as f64 / (ETA_NODES - 1) as f64;
        let (mut low, mut high) = (1.0, 3.0);
        // 1 is a node, and bisection would only come near it.
        for _ in 0..if i == 0 { 0 } else { 60 } {
            let middle = 0.5 * (low + high);
            if reflectance(middle) < wanted { low = middle } else { high = middle }
        }
        low
    };
    (0..ETA_NODES).map(node).collect()
}

/// Absorbed shares 1 − ω of the medium itself, for the rows of the reduced one.
///
/// With α' = ω(1−g)/(1−ωg): 1 − ω = (1 − α')/(1 − g(1 − α')) · … = a'/(1 − g + g a') · (1 − g) …
pub fn absorbed_share_rows(g: f64) -> Vec<f64> {
    let share = |i: usize| {
        let root = i as f64 / (ROWS - 1) as f64;
        let reduced = root * root;
        // 1 − ω = a'(1−g)/(1 − g a'), from σ_a/σ_s' = a'/(1−a') and σ_s' = σ_s(1−g).
        reduced * (1.0 - g) / (1.0 - g * reduced)
    };
    (0..ROWS).map(share).collect()
}

/// Packets walked for a node: more where fewer of them come back soon.
pub fn photons(g: f64) -> u64 {
    (12e6 * (1.0 - g).powf(-0.3)) as u64
}
