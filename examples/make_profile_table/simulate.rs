//! The Monte Carlo part: rings of light for every node of the table, each kept in a file.

use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use alabaster::slab::white::{RINGS, WhiteTally, white_walk};
use alabaster::slab::{Source, estimate};

use crate::nodes::{absorbed_share_rows, photons};

/// A node of the table: one walk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Light from all sides, or a pencil beam.
    pub diffuse: bool,
    /// Index of refraction.
    pub eta: f64,
    /// Mean cosine.
    pub g: f64,
}

/// Light per light that entered, by row of absorbed share and ring.
pub type Rings = Vec<Vec<f64>>;

/// The rings of `node`, from `folder` if they are there, by simulation if not.
pub fn rings(node: Node, folder: &Path) -> std::io::Result<Rings> {
    let entry = if node.diffuse { "diffuse" } else { "normal" };
    let path = folder.join(format!("{entry}-{:.6}-{:.6}.csv", node.eta, node.g));
    if !path.exists() {
        let text = simulate(node);
        fs::write(path.with_extension("part"), text)?;
        fs::rename(path.with_extension("part"), &path)?;
    }
    let text = fs::read_to_string(&path)?;
    Ok(text.lines().map(|line| line.split(',').map_while(|x| x.parse().ok()).collect()).collect())
}

fn simulate(node: Node) -> String {
    let source = if node.diffuse { Source::Diffuse } else { Source::Pencil { cosine: 1.0 } };
    let start = Instant::now();
    let walk = white_walk(node.eta, node.g, source).expect("the nodes are valid half-spaces");
    let shares = absorbed_share_rows(node.g);
    let tally = || WhiteTally::new(node.eta, &shares);
    let outcome = estimate(&walk, photons(node.g), 1, tally, |_| {}, &AtomicBool::new(false));
    let entered = outcome.estimates[shares.len() * RINGS].value;
    let rows = outcome.estimates[..shares.len() * RINGS].chunks(RINGS);
    let noise = |row: &[alabaster::slab::Estimate]| {
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
