//! Makes the meshes in `scenes/`: `cargo run --release --example make_scenes -- scenes/`.
//!
//! The figures are distance fields (`swan`, `candle`, `soap`) polygonised and remeshed, or turned
//! bodies. The same bytes come out on every machine; `tests/scene_meshes.rs` holds the committed
//! files to that.

mod candle;
mod distance;
mod glb;
mod models;
mod polygonise;
mod remesh;
mod revolve;
mod soap;
mod swan;
mod turned;
mod wood;

use std::path::PathBuf;
use std::process::ExitCode;

fn main() -> ExitCode {
    let Some(folder) = std::env::args_os().nth(1).map(PathBuf::from) else {
        eprintln!("usage: make_scenes FOLDER");
        return ExitCode::from(2);
    };
    for (name, make) in models::RECIPES {
        let written = make().map_err(|e| e.to_string()).and_then(|bytes| {
            println!("{name}: {} bytes", bytes.len());
            std::fs::write(folder.join(name), bytes).map_err(|e| e.to_string())
        });
        if let Err(problem) = written {
            eprintln!("{}: {problem}", folder.join(name).display());
            return ExitCode::from(3);
        }
    }
    ExitCode::SUCCESS
}
