//! The Monte Carlo part: rings of light for every node of the table, each kept in a file.

use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use alabaster::diffusion::tabulated::{ROWS, absorbed_share_of_row};
use alabaster::medium::Entry;
use alabaster::slab::white::{RINGS, WhiteTally, white_walk};
use alabaster::slab::{Estimate, estimate};

/// Packets of each walk.
const PHOTONS: u64 = 5_000_000;

/// A node of the table: one walk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// How light enters.
    pub entry: Entry,
    /// Index of refraction.
    pub eta: f64,
    /// Mean cosine.
    pub g: f64,
}

/// Light per light that entered, by row of absorbed share and ring.
pub type Rings = Vec<Vec<f64>>;

/// The rings of `node`, from `folder` if they are there, by simulation if not.
pub fn rings(node: Node, folder: &Path) -> std::io::Result<Rings> {
    let path = folder.join(format!("{}-{:.6}-{:.6}.csv", node.entry.name(), node.eta, node.g));
    if !path.exists() {
        let text = simulate(node);
        fs::write(path.with_extension("part"), text)?;
        fs::rename(path.with_extension("part"), &path)?;
    }
    let text = fs::read_to_string(&path)?;
    Ok(text.lines().map(|line| line.split(',').map_while(|x| x.parse().ok()).collect()).collect())
}

fn simulate(node: Node) -> String {
    let start = Instant::now();
    let walk = white_walk(node.eta, node.g, node.entry.into()).expect("the nodes are valid half-spaces");
    let shares: Vec<f64> = (0..ROWS).map(|row| absorbed_share_of_row(row, node.g)).collect();
    let tally = |batch| WhiteTally::new(node.eta, node.g, &shares, batch);
    let outcome = estimate(&walk, PHOTONS, 1, tally, |_| {}, &AtomicBool::new(false));
    let entered = outcome.estimates[shares.len() * RINGS].value;
    let rows = outcome.estimates[..shares.len() * RINGS].chunks(RINGS);
    let noise = |row: &[Estimate]| {
        let (sum, error) = row.iter().fold((0.0, 0.0), |(s, e), x| (s + x.value, e + x.standard_error));
        0.8 * error / sum
    };
    let noises: Vec<String> = rows.clone().step_by(8).map(|row| format!("{:.4}", noise(row))).collect();
    eprintln!("{node:?}: {:.0} s, noise {}", start.elapsed().as_secs_f64(), noises.join(" "));
    rows.map(|row| {
        let values: Vec<String> = row.iter().map(|e| format!("{:e}", e.value / entered)).collect();
        values.join(",") + "\n"
    })
    .collect()
}
