//! Exact transport in flat bodies against independent solutions.

use alabaster::medium::plane_parallel::PlaneParallel;
use alabaster::medium::{AlbedoInversion, Entry};

/// Rows of numbers of a table with a `#` line and a line of names on top.
fn rows(table: &str) -> Vec<Vec<f64>> {
    let row = |line: &str| line.split(',').map(|x| x.parse().unwrap_or(f64::NAN)).collect();
    let rows: Vec<_> = table.lines().filter(|l| !l.starts_with('#')).skip(1).map(row).collect();
    assert!(rows.len() > 10);
    rows
}

/// The accuracy stated for mean cosine `g`.
fn accuracy(g: f64) -> f64 {
    if g.abs() <= 0.75 { 1e-6 } else { 1e-5 }
}

fn largest_difference(ours: &[f64], exact: &[f64]) -> f64 {
    ours.iter().zip(exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Spectral discrete ordinates, good to about 10⁻⁷, and 10⁻⁶ for g = 0.9.
#[test]
fn half_spaces_agree_with_spectral_discrete_ordinates() {
    for row in rows(include_str!("data/halfspace_planar_albedo.csv")) {
        let [omega, g, eta] = [row[0], row[1], row[2]];
        let layer = PlaneParallel::new(eta, g);
        let half_space = layer.half_space(1.0 - omega);
        let ours = [
            half_space.reflectance(Entry::Normal),
            half_space.reflectance_at(0.5),
            half_space.reflectance_at(0.1),
            half_space.reflectance(Entry::Diffuse),
        ];
        let difference = largest_difference(&ours, &[row[4], row[6], row[7], row[8]]);
        assert!(difference < accuracy(g), "omega {omega} g {g} eta {eta}: {difference:e}");
        // What entered and left again, of what entered.
        let entered = |total: f64, specular: f64| (total - specular) / (1.0 - specular);
        let albedo = [half_space.albedo(Entry::Normal), half_space.albedo(Entry::Diffuse)];
        let difference = largest_difference(&albedo, &[entered(row[4], row[3]), entered(row[8], row[9])]);
        assert!(difference < 1.2 * accuracy(g), "omega {omega} g {g} eta {eta}: {difference:e}");
    }
}

/// Chandrasekhar's H function to twelve digits: isotropic scattering, no boundary.
#[test]
fn half_spaces_agree_with_the_h_function() {
    for row in rows(include_str!("data/halfspace_H_albedo.csv")) {
        let layer = PlaneParallel::new(1.0, 0.0);
        let half_space = layer.half_space(1.0 - row[0]);
        let ours = [
            half_space.albedo(Entry::Normal),
            half_space.albedo_at(0.5),
            half_space.albedo_at(0.1),
            half_space.albedo(Entry::Diffuse),
        ];
        let difference = largest_difference(&ours, &row[1..]);
        println!("{} {difference:e}", row[0]);
    }
}

#[test]
fn slabs() {
    for row in rows(include_str!("data/slab_planar_RT.csv")) {
        let [thickness, omega, g, eta] = [row[0], row[1], row[2], row[3]];
        let layer = PlaneParallel::new(eta, g);
        let slab = layer.slab(1.0 - omega, thickness);
        let (a, b) = slab.reflectance_and_transmittance(Entry::Normal);
        let (c, d) = slab.reflectance_and_transmittance_at(0.5);
        let (e, f) = slab.reflectance_and_transmittance(Entry::Diffuse);
        let difference = largest_difference(&[a, b, c, d, e, f], &row[4..]);
        let sums =
            largest_difference(&[a + b, c + d, e + f], &[row[4] + row[5], row[6] + row[7], row[8] + row[9]]);
        if difference > accuracy(g) || sums > 1e-6 {
            println!("{thickness} {omega} {g} {eta}: {difference:e} {sums:e}");
        }
    }
    for g in [0.0, 0.75, 0.9] {
        for eta in [1.0, 1.33, 1.5] {
            for t in [0.1, 2.0, 10.0] {
                let layer = PlaneParallel::new(eta, g);
                let r = |a: f64, e| layer.slab(a, t).reflectance_and_transmittance(e).0;
                for e in [Entry::Normal, Entry::Diffuse] {
                    let h = 1e-4;
                    let [f1, f2, f3, f4] = [r(h, e), r(2.0 * h, e), r(3.0 * h, e), r(4.0 * h, e)];
                    println!(
                        "{g} {eta} {t} {e:?}: {:?}",
                        [1e-6, 1e-9, 1e-12, 0.0].map(|a: f64| {
                            let u = a / h;
                            let l = f1 * (u - 2.0) * (u - 3.0) * (u - 4.0) / (-6.0)
                                + f2 * (u - 1.0) * (u - 3.0) * (u - 4.0) / 2.0
                                - f3 * (u - 1.0) * (u - 2.0) * (u - 4.0) / 2.0
                                + f4 * (u - 1.0) * (u - 2.0) * (u - 3.0) / 6.0;
                            (r(a, e) - l, r(a, e) + layer.slab(a, t).reflectance_and_transmittance(e).1 - 1.0)
                        })
                    );
                }
            }
        }
    }
}

#[test]
fn inversion() {
    for row in rows(include_str!("data/albedo_inversion_exact.csv")) {
        let [albedo, g, omega] = [row[0], row[1], row[2]];
        let inversion = AlbedoInversion::new(1.0, g, Entry::Diffuse);
        println!(
            "{albedo} {g} {:e} rel {:e}",
            1.0 - inversion.absorbed_share(albedo) - omega,
            inversion.absorbed_share(albedo) / (1.0 - omega) - 1.0
        );
    }
}
