//! What the comparison of slabs with transport theory needs.

pub mod family;
pub mod observers;

use std::path::Path;

use alabaster::slab::{Grid, Layer, LayerStack};

/// Totals alone.
pub const ONE_BIN: Grid = Grid { radial_step: 1.0, radial: 1, depth_step: 1.0, depth: 1, angular: 1 };

/// The lines of a file in tests/data, without comments; the first is the header.
pub fn lines(name: &str) -> Vec<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name);
    let text = std::fs::read_to_string(path).unwrap();
    text.lines().filter(|line| !line.starts_with('#')).map(str::to_owned).collect()
}

/// The rows of a file in tests/data that holds numbers only.
pub fn rows(name: &str) -> Vec<Vec<f64>> {
    let number = |word: &str| word.parse().unwrap();
    lines(name).iter().skip(1).map(|line| line.split(',').map(number).collect()).collect()
}

/// A layer of optical thickness `tau` in air; if that is infinite, a half-space.
pub fn slab(tau: f64, omega: f64, g: f64, eta: f64) -> LayerStack {
    let layer = Layer { ior: eta, sigma_a: 1.0 - omega, sigma_s: omega, g, thickness: tau };
    LayerStack::new(1.0, vec![layer], if tau.is_finite() { 1.0 } else { eta }).unwrap()
}
