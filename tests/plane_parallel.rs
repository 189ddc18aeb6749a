//! Exact transport in flat bodies against independent solutions.

use alabaster::medium::plane_parallel::PlaneParallel;
use alabaster::medium::{AlbedoInversion, Entry};
use alabaster::optics::fresnel::Interface;

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
        // The table has twelve digits.
        assert!(difference < 2e-12, "omega {}: {difference:e}", row[0]);
    }
}

/// Spectral discrete ordinates, printed to seven digits.
#[test]
fn slabs_agree_with_spectral_discrete_ordinates() {
    for row in rows(include_str!("data/slab_planar_RT.csv")) {
        let [thickness, omega, g, eta] = [row[0], row[1], row[2], row[3]];
        let layer = PlaneParallel::new(eta, g);
        let slab = layer.slab(1.0 - omega, thickness);
        let ours = [
            slab.reflectance_and_transmittance(Entry::Normal),
            slab.reflectance_and_transmittance_at(0.5),
            slab.reflectance_and_transmittance(Entry::Diffuse),
        ];
        for (entry, (r, t)) in ours.into_iter().enumerate() {
            let [exact_r, exact_t] = [row[4 + 2 * entry], row[5 + 2 * entry]];
            let name = format!("thickness {thickness} omega {omega} g {g} eta {eta} entry {entry}");
            let sum = (r + t - exact_r - exact_t).abs();
            assert!(sum < accuracy(g), "{name}: {sum:e}");
            // At ω = 0.999999 the table's own R − T has lost digits (up to 10⁻⁴ of them); the test
            // of continuity below covers what it cannot.
            if omega < 0.99999 {
                let difference = largest_difference(&[r, t], &[exact_r, exact_t]);
                assert!(difference < accuracy(g), "{name}: {difference:e}");
            }
        }
    }
}

/// R of a slab is analytic in what is absorbed: the cubic through four shares of a few 10⁻⁵ gives it
/// where nearly nothing is, to (10⁻⁵ τ²)⁴ at most, and no digit may be lost there.
#[test]
fn slabs_that_absorb_nearly_nothing_are_the_limit_of_those_that_absorb_little() {
    for g in [0.0, 0.75, 0.9] {
        for eta in [0.75, 1.0, 1.33, 1.5] {
            for thickness in [0.1, 2.0, 10.0] {
                let layer = PlaneParallel::new(eta, g);
                for entry in [Entry::Normal, Entry::Diffuse] {
                    let both = |share: f64| layer.slab(share, thickness).reflectance_and_transmittance(entry);
                    let [a, b, c, d] = [1.0, 2.0, 3.0, 4.0].map(|i| both(1e-5 * i).0);
                    let limit = 4.0 * a - 6.0 * b + 4.0 * c - d;
                    let (r, t) = both(0.0);
                    let name = format!("g {g} eta {eta} thickness {thickness} {entry:?}");
                    assert!((r - limit).abs() < 1e-10, "{name}: {r} against {limit}");
                    assert!((r + t - 1.0).abs() < 1e-13, "{name}: {}", r + t);
                    for share in [1e-14, 1e-18, 1e-22] {
                        let near = both(share).0;
                        assert!((near - r).abs() < 1e-11, "{name} share {share}: {near} against {r}");
                    }
                }
            }
        }
    }
}

/// Without scattering the light that enters at one angle goes to and fro between the surfaces.
#[test]
fn slabs_that_only_absorb_follow_beer_and_fresnel() {
    for eta in [0.75, 1.0, 1.5] {
        for thickness in [1e-9, 0.3, 5.0] {
            for mu in [1.0, 0.9] {
                let surface = Interface::new(mu, eta);
                let (f, e) = (surface.reflectance, (-thickness / surface.cos_t).exp());
                let through = surface.transmittance.powi(2) * e / (1.0 - (f * e).powi(2));
                let layer = PlaneParallel::new(eta, 0.5);
                let (r, t) = layer.slab(1.0, thickness).reflectance_and_transmittance_at(mu);
                assert!((t - through).abs() < 1e-12, "eta {eta} thickness {thickness} mu {mu}: {t}");
                assert!((r - (f + f * e * through)).abs() < 1e-12, "eta {eta} thickness {thickness} mu {mu}");
            }
        }
    }
}

#[test]
fn a_thick_slab_is_a_half_space() {
    for (eta, g) in [(0.75, 0.5), (1.0, -0.5), (1.5, 0.8)] {
        let layer = PlaneParallel::new(eta, g);
        let (half_space, slab) = (layer.half_space(0.2), layer.slab(0.2, 1e3));
        for entry in [Entry::Normal, Entry::Diffuse] {
            let (r, t) = slab.reflectance_and_transmittance(entry);
            assert!((r - half_space.reflectance(entry)).abs() < 1e-12 && t.abs() < 1e-12);
        }
    }
}

/// A half-space that absorbs nothing returns all; one that absorbs nearly nothing loses in proportion
/// to the root of what it absorbs, whatever the quadrature.
#[test]
fn half_spaces_return_all_they_do_not_absorb() {
    for eta in [0.5, 0.75, 0.9999, 1.0, 1.0001, 1.5, 3.0] {
        for g in [-0.9, 0.0, 0.75, 0.95] {
            let layer = PlaneParallel::new(eta, g);
            let white = layer.half_space(0.0);
            for entry in [Entry::Normal, Entry::Diffuse] {
                assert_eq!((white.albedo(entry), white.reflectance(entry)), (1.0, 1.0));
                let lost = |share: f64| (1.0 - layer.half_space(share).albedo(entry)) / share.sqrt();
                let [a, b] = [lost(1e-11), lost(1e-15)];
                // The next term is √share times the loss itself, here at most 10⁻⁵·200.
                assert!((a / b - 1.0).abs() < 2e-3, "eta {eta} g {g} {entry:?}: {a} {b}");
            }
            let black = layer.half_space(1.0);
            assert!(black.albedo(Entry::Normal).abs() < 1e-12 && black.albedo(Entry::Diffuse).abs() < 1e-12);
        }
    }
}

/// The single-scattering albedos that give an albedo, printed to eight digits.
#[test]
fn inversion_agrees_with_exact_values() {
    for row in rows(include_str!("data/albedo_inversion_exact.csv")) {
        let [albedo, g, omega] = [row[0], row[1], row[2]];
        let share = AlbedoInversion::new(1.0, g, Entry::Diffuse).absorbed_share(albedo);
        assert!((1.0 - share - omega).abs() < 1e-8, "albedo {albedo} g {g}: {share} and {omega}");
    }
}
