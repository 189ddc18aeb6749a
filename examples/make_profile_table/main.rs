//! Makes the table of the tabulated diffusion profile, `src/diffusion/tabulated.f32`, by Monte Carlo:
//!
//! ```sh
//! cargo run --release --example make_profile_table
//! ```
//!
//! It takes about an hour and a half of processor time. Each of its 108 walks is kept in `target/profile_table`, so it can be
//! interrupted. The same bytes come out on any number of threads.

mod fit;
mod simulate;

use std::io;
use std::path::{Path, PathBuf};

use alabaster::diffusion::tabulated::{G_NODES, ROWS, absorbed_share_of_row, eta_nodes};
use alabaster::medium::Entry;
use simulate::Node;

fn main() -> io::Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = std::env::args().nth(1).map_or_else(|| root.join("target/profile_table"), PathBuf::from);
    std::fs::create_dir_all(&folder)?;
    let mut bytes = Vec::new();
    for entry in [Entry::Normal, Entry::Diffuse] {
        for g in G_NODES {
            for eta in eta_nodes() {
                let rings = simulate::rings(Node { entry, eta, g }, &folder)?;
                for (row, rings) in rings.iter().enumerate().take(ROWS) {
                    // σ_t'/σ_t = 1 − ωg.
                    let omega = 1.0 - absorbed_share_of_row(row, g);
                    let logits = fit::logits(rings, 1.0 - omega * g, row > 0);
                    bytes.extend(logits.iter().flat_map(|s| (*s as f32).to_le_bytes()));
                }
            }
        }
    }
    std::fs::write(root.join("src/diffusion/tabulated.f32"), bytes)
}
