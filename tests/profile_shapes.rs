//! exploration
use alabaster::diffusion::*;
use std::time::Instant;

fn explore<M: DiffusionModel>(name: &str, eta: f64, g: f64, make: impl Fn(&HalfSpace) -> M + Sync) {
    let t = Instant::now();
    let table = ShapeTable::of_model(eta, g, &make).unwrap();
    let seconds = t.elapsed().as_secs_f64();
    let mut worst = (0.0, 0.0);
    let mut rise = (0.0_f32, 0.0, 0.0);
    for i in [0.3, 0.5, 1.5, 2.5, 4.5, 8.5, 16.5, 24.5, 28.5, 31.5] {
        let root: f64 = i / 32.0;
        let share = root * root;
        let hs = HalfSpace::new(share, (1.0 - share) / (1.0 - g), g, eta).unwrap();
        let model = make(&hs);
        let shape = table.shape(share as f32, 1.0);
        let total = model.albedo();
        let (mut diff, mut sum) = (0.0, 0.0);
        let mut last = f32::INFINITY;
        for k in 0..(5 * 12) {
            let (a, b) = (10f64.powf(-3.0 + k as f64 / 12.0), 10f64.powf(-3.0 + (k + 1) as f64 / 12.0));
            let e = integrate::energy_between(&model, a, b) / total;
            diff += (f64::from(shape.cumulative(b as f32) - shape.cumulative(a as f32)) - e).abs();
            sum += e;
            for j in 0..8 {
                let r = (a * (b / a).powf(j as f64 / 8.0)) as f32;
                let d = shape.density(r);
                if d / last > rise.0 {
                    rise = (d / last, share, r);
                }
                last = d;
            }
        }
        if diff / sum > worst.0 {
            worst = (diff / sum, share);
        }
    }
    println!(
        "{name} eta {eta} g {g}: {seconds:.3} s, L1 {:.1e} at {:.4}, largest rise {:?}",
        worst.0, worst.1, rise
    );
}

#[test]
fn explore_all() {
    for (eta, g) in [(1.0, 0.0), (1.5, 0.0), (1.33, 0.8), (0.75, 0.0), (2.4, -0.5)] {
        explore("dipole", eta, g, Dipole::new);
        explore("better", eta, g, BetterDipole::new);
        explore("directional", eta, g, UniformlyLitDirectionalDipole::new);
        explore("beam", eta, g, PhotonBeam::new);
    }
}
