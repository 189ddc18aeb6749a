//! Makes the table of the tabulated diffusion profile by Monte Carlo.

mod nodes;
mod simulate;

use std::path::PathBuf;

use simulate::Node;

fn main() {
    let folder = PathBuf::from(std::env::args().nth(1).expect("folder"));
    for g in nodes::G {
        for eta in nodes::eta_nodes() {
            for diffuse in [true, false] {
                simulate::rings(Node { diffuse, eta, g }, &folder).unwrap();
            }
        }
    }
}
