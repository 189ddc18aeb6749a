//! Slab Monte Carlo against independent solutions of the transport equation, and the exact laws of random walks.
//!
//! Each comparison asserts two bounds. One is statistical, in units of the standard error σ (of the simulation and of
//! the reference together). The bound for a family of n comparisons is the one that chance alone crosses in one family
//! of 370, as it crosses 3σ for n = 1 (Bonferroni); and the sum of squares must be that of n normal numbers within three
//! of its own standard deviations, so that many small deviations do not pass either. Seeds are fixed. The other bound is absolute,
//! 2·10⁻⁴ of the light sent in.

mod slab_transport;

use std::sync::atomic::AtomicBool;

use alabaster::math::quadrature::GaussLegendre;
use alabaster::slab::{
    Estimate, Grid, Layer, LayerStack, Roulette, Scattered, Simulation, Source, Walk, estimate,
};
use slab_transport::family::{Comparison, Family};
use slab_transport::observers::{Collisions, Rings};
use slab_transport::{ONE_BIN, rows, slab};

/// Largest deviation, as a share of the light sent in.
const ABSOLUTE: f64 = 2e-4;
/// Standard error that photons are chosen for: the bound of a family of a hundred, 4.2σ, is then below
/// [`ABSOLUTE`] even where the pilot's σ is a tenth too small, and the absolute bound fails no more often by chance than the other.
const SIGMA: f64 = 4.3e-5;
/// Photons from which the number of photons is chosen.
const PILOT: u64 = 1 << 15;

const NORMAL: Source = Source::Pencil { cosine: 1.0 };

fn simulate(stack: &LayerStack, source: Source, grid: Grid, photons: u64, seed: u64) -> Scattered {
    let simulation = Simulation { stack: stack.clone(), source, grid, photons, seed };
    simulation.run(|_| {}, &AtomicBool::new(false)).0
}

/// Standard error for the few published values: their bound is 3.3σ.
const SIGMA_OF_FEW: f64 = 5.4e-5;

/// Simulates with as many photons as standard error `sigma` takes; nothing if that is more than `most` flights.
fn simulate_to_sigma(
    stack: &LayerStack,
    source: Source,
    sigma: f64,
    most: f64,
    seed: u64,
) -> Option<Scattered> {
    let pilot = simulate(stack, source, ONE_BIN, PILOT, seed);
    let found = reflected(&pilot).standard_error.max(pilot.transmitted.standard_error);
    let photons = PILOT as f64 * (found / sigma).powi(2);
    let flights = photons * (2.0 + pilot.collisions_per_photon.value);
    // Another seed, as the number was chosen by the pilot's.
    (flights <= most).then(|| simulate(stack, source, ONE_BIN, photons.ceil() as u64 + PILOT, seed + 1))
}

/// The rows of both tables whose albedo is at most `largest_albedo` and that take at most `most` flights for each source;
/// the number of comparisons that were left out.
fn compare_planar(family: &mut Family, largest_albedo: f64, most: f64) -> usize {
    let mut seed = 0;
    let mut left_out = 0;
    for row in rows("halfspace_planar_albedo.csv").iter().filter(|row| row[0] <= largest_albedo) {
        let &[omega, g, eta, _, normal, _, oblique, grazing, diffuse, _] = row.as_slice() else { panic!() };
        let stack = slab(f64::INFINITY, omega, g, eta);
        for (source, exact) in sources().into_iter().zip([normal, oblique, grazing, diffuse]) {
            seed += 2;
            match simulate_to_sigma(&stack, source, SIGMA, most, seed) {
                Some(found) => family.add(format!("half-space {row:?} {source:?}"), reflected(&found), exact),
                None => left_out += 1,
            }
        }
    }
    for row in rows("slab_planar_RT.csv").iter().filter(|row| row[1] <= largest_albedo) {
        let &[tau, omega, g, eta, r1, t1, r2, t2, r3, t3, _] = row.as_slice() else { panic!() };
        let stack = slab(tau, omega, g, eta);
        let [normal, oblique, _, diffuse] = sources();
        for (source, r, t) in [(normal, r1, t1), (oblique, r2, t2), (diffuse, r3, t3)] {
            seed += 2;
            match simulate_to_sigma(&stack, source, SIGMA, most, seed) {
                Some(found) => {
                    family.add(format!("R of slab {row:?} {source:?}"), reflected(&found), r);
                    family.add(format!("T of slab {row:?} {source:?}"), found.transmitted, t);
                }
                None => left_out += 2,
            }
        }
    }
    left_out
}

/// Reflectance and transmittance of every row whose cost is small, for normal, oblique and diffuse light.
#[test]
fn planar_reflectance_and_transmittance() {
    let mut family = Family::new(ABSOLUTE);
    compare_planar(&mut family, 0.9, 4e6);
    assert!(family.len() >= 60, "{}", family.len());
    family.check();
}

/// In the order of the columns of the half-space table.
fn sources() -> [Source; 4] {
    [NORMAL, Source::Pencil { cosine: 0.5 }, Source::Pencil { cosine: 0.1 }, Source::Diffuse]
}

/// Reflectance with its specular part, which chance has a hand in for diffuse light. Where next to all light comes back, what
/// is absorbed or transmitted is known better than that, and the rest is the reflectance.
fn reflected(found: &Scattered) -> Estimate {
    // The parts come from the same photons; the error of a sum is at most the sum of the errors.
    let sum = |a: Estimate, b: Estimate| Estimate {
        value: a.value + b.value,
        standard_error: a.standard_error + b.standard_error,
    };
    let direct = sum(found.specular, found.diffuse_reflectance);
    let rest = sum(found.absorbed, found.transmitted);
    if rest.standard_error < direct.standard_error {
        Estimate { value: 1.0 - rest.value, ..rest }
    } else {
        direct
    }
}

/// The third of both tables that takes a hundred million flights at most for each source.
#[test]
#[ignore = "ten minutes on two cores"]
fn a_third_of_planar_reflectance_and_transmittance() {
    let mut family = Family::new(ABSOLUTE);
    let left_out = compare_planar(&mut family, 1.0, 1e8);
    println!("{left_out} comparisons take longer");
    assert!(family.len() >= 360, "{}", family.len());
    family.check();
}

/// Every row of both tables: 1.4·10¹² flights.
#[test]
#[ignore = "a day on two cores"]
fn every_planar_reflectance_and_transmittance() {
    let mut family = Family::new(ABSOLUTE);
    assert_eq!(compare_planar(&mut family, 1.0, f64::INFINITY), 0);
    assert_eq!(family.len(), 97 * 4 + 134 * 6);
    family.check();
}

/// The distinct values of some columns, in the order of the table.
fn distinct<const N: usize>(table: &[Vec<f64>], columns: [usize; N]) -> Vec<[f64; N]> {
    let mut found: Vec<[f64; N]> = Vec::new();
    for row in table {
        let key = columns.map(|column| row[column]);
        if !found.contains(&key) {
            found.push(key);
        }
    }
    found
}

/// Light by angle of exit in bins of 5°, against the radiance I(μ) of the table integrated over the bin.
///
/// I is interpolated between its μ by a cubic through the four next ones; what a parabola through three of them says otherwise
/// bounds the error of that, which is added to the statistical one. Bins below μ = 0.1, where I is not
/// smooth, and transmission above 0.7, where it is a peak, are left out.
#[test]
fn light_by_angle() {
    const PHOTONS: u64 = 5_000_000;
    const BINS: usize = 18;
    let table = rows("angular_normal_incidence_matched.csv");
    let mut family = Family::new(ABSOLUTE);
    for (seed, [tau, omega, g]) in distinct(&table, [0, 1, 2]).into_iter().enumerate() {
        let nodes: Vec<_> = table.iter().filter(|row| [row[0], row[1], row[2]] == [tau, omega, g]).collect();
        let grid = Grid { angular: BINS, ..ONE_BIN };
        let found = simulate(&slab(tau, omega, g, 1.0), NORMAL, grid, PHOTONS, seed as u64);
        let last = if tau.is_finite() { 2 } else { 1 };
        for (column, leaving, highest) in
            [(5, &found.reflected, 1.0), (6, &found.leaving_below, 0.7)].into_iter().take(last)
        {
            let radiance: Vec<(f64, f64)> =
                nodes.iter().filter(|row| row[3] <= highest).map(|row| (row[3], row[column])).collect();
            for (i, per_angle) in leaving.by_angle.iter().enumerate() {
                let edges = [i + 1, i].map(|edge| (edge as f64 * 5.0).to_radians().cos());
                if edges[0] < 0.1 || edges[1] > highest {
                    continue;
                }
                let [exact, error] = flux(&radiance, edges);
                let share = *per_angle * found.grid.solid_angle(i);
                family.push(Comparison {
                    name: format!("τ {tau} ω {omega} g {g}, column {column}, {}°", 5 * i),
                    found: share,
                    exact,
                    allowance: error,
                });
            }
        }
    }
    assert!(family.len() >= 60, "{}", family.len());
    family.check();
}

/// 2π ∫ I μ dμ between `edges`, and a bound of its error.
fn flux(radiance: &[(f64, f64)], edges: [f64; 2]) -> [f64; 2] {
    let rule = GaussLegendre::new(8);
    let integral = |points: usize| {
        let at = |mu: f64| std::f64::consts::TAU * mu * interpolate(radiance, mu, points);
        // Piecewise, as the points taken change at the nodes.
        let mut cuts: Vec<f64> = radiance.iter().map(|node| node.0).collect();
        cuts.retain(|cut| edges[0] < *cut && *cut < edges[1]);
        cuts.extend(edges);
        cuts.sort_by(f64::total_cmp);
        cuts.windows(2).map(|cut| rule.integrate(cut[0], cut[1], at)).sum::<f64>()
    };
    [integral(4), (integral(4) - integral(3)).abs()]
}

/// The polynomial through the `points` nodes next to `mu` (Lagrange).
fn interpolate(nodes: &[(f64, f64)], mu: f64, points: usize) -> f64 {
    let mut next = nodes.to_vec();
    next.sort_by(|a, b| (a.0 - mu).abs().total_cmp(&(b.0 - mu).abs()));
    next.truncate(points);
    let weight = |i: usize| {
        let others = (0..points).filter(|&j| j != i);
        others.map(|j| (mu - next[j].0) / (next[i].0 - next[j].0)).product::<f64>()
    };
    (0..points).map(|i| weight(i) * next[i].1).sum()
}

/// Rings about a pencil beam, all light and the part that collided once, against another Monte Carlo program.
#[test]
fn rings_about_a_pencil_beam() {
    const PHOTONS: u64 = 5_200_000;
    let mut family = Family::new(ABSOLUTE);
    let table = slab_transport::lines("radial_searchlight_mc.csv");
    let configurations: [(&str, _, _, _, f64); 4] = [
        ("A", 0.9, 1.0, NORMAL, 1e8),
        ("D", 0.5, 1.0, NORMAL, 1e8),
        ("B", 0.9, 1.5, NORMAL, 8e7),
        ("E", 0.9, 1.0, Source::Diffuse, 1e8),
    ];
    for (seed, (name, omega, eta, source, reference_photons)) in configurations.into_iter().enumerate() {
        let rings: Vec<Vec<f64>> = table
            .iter()
            .filter(|line| line.starts_with(&format!("{name},")))
            .map(|line| line.split(',').skip(2).map(|word| word.parse().unwrap()).collect())
            .collect();
        let edges: Vec<f64> = rings.iter().map(|ring| ring[1]).collect();
        let walk = Walk::new(&slab(f64::INFINITY, omega, 0.0, eta), source, Roulette::default());
        let observer = |_| Rings::new(&edges);
        let found = estimate(&walk, PHOTONS, seed as u64, observer, |_| {}, &AtomicBool::new(false));
        let (all, single) = found.estimates.split_at(edges.len());
        for (i, ring) in rings.iter().enumerate() {
            let &[r0, r1, flux, stderr, _, single_flux] = ring.as_slice() else { panic!() };
            let both = |found: Estimate, other: f64| Estimate {
                standard_error: found.standard_error.hypot(other),
                ..found
            };
            // Its standard error is not in the table; it is that of this simulation but for the number of photons.
            let other = single[i].standard_error * (PHOTONS as f64 / reference_photons).sqrt();
            for (kind, found, exact) in
                [("all", both(all[i], stderr), flux), ("once", both(single[i], other), single_flux)]
            {
                // What a ring holds has a normal distribution only where many photons leave.
                if exact * PHOTONS as f64 > 300.0 {
                    let name = format!("{name} {r0}..{r1} {kind}");
                    family.push(Comparison { name, found, exact, allowance: 0.0 });
                }
            }
        }
    }
    assert!(family.len() >= 300, "{}", family.len());
    family.check();
}

/// A photon that enters collides P(absorbed)/(1 − ω) times in the mean: an analog walk, and one with weights.
#[test]
fn collisions_follow_their_law() {
    const FLIGHTS: f64 = 5e6;
    let mut family = Family::new(f64::INFINITY);
    for (i, row) in rows("walk_cost_law.csv").iter().enumerate() {
        let &[omega, _, exact] = row.as_slice() else { panic!() };
        if omega > 0.999 {
            continue;
        }
        let photons = (FLIGHTS / (1.0 + exact)) as u64;
        let stack = slab(f64::INFINITY, omega, 0.0, 1.0);
        let analog = Roulette { weight: 1.0, collisions: u64::MAX, kept: 1.0 };
        let walk = Walk::new(&stack, NORMAL, analog);
        let stop = AtomicBool::new(false);
        let found = estimate(&walk, photons, i as u64, |_| Collisions::default(), |_| {}, &stop).estimates[0];
        // The table has six digits.
        let rounding = 0.5e-5 * exact;
        let weighted = simulate(&stack, NORMAL, ONE_BIN, photons, 100 + i as u64).collisions_per_photon;
        for (kind, found) in [("analog", found), ("weighted", weighted)] {
            assert!(found.standard_error < 0.02 * exact, "ω {omega} {kind}: {found:?}");
            let name = format!("collisions, ω {omega}, {kind}");
            family.push(Comparison { name, found, exact, allowance: rounding });
        }
    }
    assert_eq!(family.len(), 26);
    family.check();
}

/// What MCML's authors published, and what their program found for two layers. The exact values are in the column before
/// the last of the table.
#[test]
fn published_slabs() {
    let table = slab_transport::lines("mcml_references.csv");
    let mut family = Family::new(ABSOLUTE);
    for (digits, place) in [("0.0973946", 1), ("0.6609577", 2), ("0.25991857", 7)] {
        assert!(table[place].contains(digits), "{}", table[place]);
    }
    let van_de_hulst = simulate_to_sigma(&van_de_hulst(), NORMAL, SIGMA_OF_FEW, f64::INFINITY, 1).unwrap();
    family.add("van de Hulst, R".into(), reflected(&van_de_hulst), 0.0973946);
    family.add("van de Hulst, T".into(), van_de_hulst.transmitted, 0.6609577);
    let giovanelli = LayerStack::half_space(1.5, 10.0, 90.0, 0.0).unwrap();
    let giovanelli = simulate_to_sigma(&giovanelli, NORMAL, SIGMA_OF_FEW, f64::INFINITY, 3).unwrap();
    family.add("Giovanelli".into(), reflected(&giovanelli), 0.25991857);
    family.check();

    // Given to four digits, found with a million photons.
    let two_layers = simulate(&two_layers(), NORMAL, ONE_BIN, 1_000_000, 5);
    let found = two_layers.diffuse_reflectance;
    let sigma = found.standard_error * 2.0_f64.sqrt();
    assert!((two_layers.specular.value - 0.0170132).abs() < 1e-6);
    assert!((found.value - 0.1050).abs() < 3.0 * sigma + 0.5e-4, "{found:?}");
}

/// μ_a 10/cm, μ_s 90/cm, g 0.75, 0.02 cm.
fn van_de_hulst() -> LayerStack {
    let layer = Layer { ior: 1.0, sigma_a: 10.0, sigma_s: 90.0, g: 0.75, thickness: 0.02 };
    LayerStack::new(1.0, vec![layer], 1.0).unwrap()
}

/// Per millimetre.
fn two_layers() -> LayerStack {
    let layers = vec![
        Layer { ior: 1.3, sigma_a: 2.0, sigma_s: 20.0, g: 0.7, thickness: 0.1 },
        Layer { ior: 1.4, sigma_a: 1.0, sigma_s: 20.0, g: 0.9, thickness: 1e8 },
    ];
    LayerStack::new(1.0, layers, 1.0).unwrap()
}

/// Light is neither lost nor made: specular, diffuse, absorbed and transmitted shares add up to 1, and so do their parts by
/// layer, radius, depth and angle.
#[test]
fn the_parts_add_up() {
    let grid = Grid { radial_step: 0.05, radial: 8, depth_step: 0.02, depth: 9, angular: 5 };
    for (seed, source) in sources().into_iter().enumerate() {
        let found = simulate(&two_layers(), source, grid, 200_000, seed as u64);
        let accounted = found.accounted;
        // Roulette takes and gives: its noise.
        assert!((accounted.value - 1.0).abs() < 4.0 * accounted.standard_error, "{accounted:?}");
        assert!(accounted.standard_error < 1e-3, "{accounted:?}");
        let sum = |estimates: &[Estimate], measure: &dyn Fn(usize) -> f64| -> f64 {
            estimates.iter().enumerate().map(|(i, estimate)| estimate.value * measure(i)).sum()
        };
        let same = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} and {b}");
        let share = |_: usize| 1.0;
        let area = |i: usize| grid.ring_area(i);
        let angle = |i: usize| grid.solid_angle(i);
        for (leaving, total) in [
            (&found.reflected, found.diffuse_reflectance.value),
            (&found.leaving_below, found.transmitted.value - found.unscattered_transmittance.value),
        ] {
            same(sum(&leaving.by_radius, &area) + leaving.beyond.value, total);
            same(sum(&leaving.by_angle, &angle), total);
            same(sum(&leaving.beyond_by_angle, &share), leaving.beyond.value);
            let cell = |i: usize| area(i / grid.angular) * angle(i % grid.angular);
            same(sum(&leaving.by_radius_and_angle, &cell) + leaving.beyond.value, total);
        }
        same(sum(&found.unscattered_below, &share), found.unscattered_transmittance.value);
        let absorbed = found.absorbed.value;
        same(sum(&found.absorbed_by_layer, &share), absorbed);
        let inside = &found.absorption;
        same(sum(&inside.by_depth, &|_| grid.depth_step) + inside.below.value, absorbed);
        same(sum(&inside.below_by_radius, &share), inside.below.value);
        let cell = |i: usize| area(i % grid.radial) * grid.depth_step;
        let outside = sum(&inside.outside_by_depth, &share);
        same(sum(&inside.by_depth_and_radius, &cell) + outside + inside.below.value, absorbed);
    }
}

/// The same seed gives the same bits on any number of threads, another seed others.
#[test]
fn the_same_bits_on_any_number_of_threads() {
    let grid = Grid { radial_step: 0.05, radial: 8, depth_step: 0.02, depth: 9, angular: 5 };
    let run = |threads: usize, seed: u64| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| simulate(&two_layers(), NORMAL, grid, 100_001, seed))
    };
    let one = run(1, 1);
    assert!(one == run(3, 1));
    assert!(one != run(1, 2));
}
