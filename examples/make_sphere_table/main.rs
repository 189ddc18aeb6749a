//! Makes `src/medium/sphere_step/table.f32`: what leaves spheres of a scattering medium.
//!
//! `cargo run --release --example make_sphere_table`
//!
//! It takes about a minute of processor time. The same bytes come out on any number of threads.

mod transport;

use std::f64::consts::FRAC_PI_2;
use std::io;
use std::path::Path;

use alabaster::math::quadrature::GaussLegendre;
use alabaster::medium::sphere_step::table::{ANGLES, RATES, SUMS, asymptotic_survival, node};
use rayon::prelude::*;
use transport::Sphere;

fn main() -> io::Result<()> {
    let nodes: Vec<_> = (0..SUMS).flat_map(|i| (0..RATES).map(move |j| node(i, j))).collect();
    let rows: Vec<_> = nodes.par_iter().map(|&(rate, radius)| row(rate.tanh(), radius)).collect();
    let bytes: Vec<u8> = rows.iter().flatten().flat_map(|x| (*x as f32).to_le_bytes()).collect();
    std::fs::write(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/medium/sphere_step/table.f32"), bytes)
}

/// Survival over its asymptotic form, then the density of the exit angle.
fn row(kappa: f64, radius: f64) -> Vec<f64> {
    let sphere = Sphere::new(kappa, radius);
    let collided = GaussLegendre::new(64).integrate(0.0, FRAC_PI_2, |angle| sphere.leaving(angle));
    let straight = ((kappa - 1.0) * radius).exp();
    let survival = (collided + straight) / (asymptotic_survival(kappa, radius, kappa * radius));
    let step = FRAC_PI_2 / (ANGLES - 1) as f64;
    // At 0 and π/2 the limits.
    let angle = |i: usize| (step * i as f64).clamp(1e-6, FRAC_PI_2);
    let densities: Vec<f64> = (0..ANGLES).map(|i| sphere.leaving(angle(i))).collect();
    // As the straight lines between them are normalised.
    let sum = step * (densities.iter().sum::<f64>() - 0.5 * (densities[0] + densities[ANGLES - 1]));
    std::iter::once(survival).chain(densities.iter().map(|density| density / sum)).collect()
}
