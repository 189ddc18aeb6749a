//! Light that goes to the surface of a sphere in one step arrives as light that walks there.

#[path = "../examples/make_sphere_table/transport.rs"]
mod transport;

use std::f64::consts::FRAC_PI_2;

use alabaster::math::quadrature::GaussLegendre;
use alabaster::medium::SphereStep;
use alabaster::medium::sphere_step::{Exit, LARGEST_ABSORBED_SHARE};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use transport::Sphere;

fn uniform(random: &mut Xoshiro256PlusPlus) -> f64 {
    (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

/// Walks from the centre of a sphere of radius `radius` mean free paths. Collisions, cosine at the exit and length, if it is
/// not absorbed.
fn walk(radius: f64, absorbed_share: f64, random: &mut Xoshiro256PlusPlus) -> Option<(u32, f64, f64)> {
    let (mut position, mut length) = ([0.0_f64; 3], 0.0);
    for collisions in 0.. {
        let z = 2.0 * uniform(random) - 1.0;
        let (sin, cos) = (std::f64::consts::TAU * uniform(random)).sin_cos();
        let across = (1.0 - z * z).sqrt();
        let direction = [across * cos, across * sin, z];
        let along: f64 = position.iter().zip(direction).map(|(x, d)| x * d).sum();
        let square: f64 = position.iter().map(|x| x * x).sum();
        let to_surface = (along * along + radius * radius - square).max(0.0).sqrt() - along;
        let flight = -(1.0 - uniform(random)).ln();
        if flight >= to_surface {
            return Some((collisions, (along + to_surface) / radius, length + to_surface));
        }
        length += flight;
        position.iter_mut().zip(direction).for_each(|(x, d)| *x += d * flight);
        if uniform(random) < absorbed_share {
            return None;
        }
    }
    None
}

/// Equal steps of the exit angle.
const BINS: usize = 12;

/// Off the nodes of the table: optical radius, share absorbed, walks.
const CASES: [(f64, f64, u32); 8] = [
    (1.07, 0.0, 400_000),
    (1.37, 0.43, 400_000),
    (2.9, 0.13, 400_000),
    (4.3, 0.0, 400_000),
    (7.7, 0.021, 300_000),
    (11.3, 0.08, 300_000),
    (16.6, 0.003, 200_000),
    (31.0, 0.000_3, 100_000),
];

/// The share of the light that is between two angles, from densities. They are straight within steps a hundred
/// times shorter than a bin, to 10⁻⁵.
fn share_between(step: &SphereStep, radius: f64, from: f64, to: f64) -> f64 {
    let departure = step.departure(radius as f32);
    let at = |angle: f64| f64::from(departure.density(Exit::Oblique { angle: angle as f32 }));
    let count = 100;
    let width = (to - from) / f64::from(count);
    (0..count).map(|i| width * at(from + width * (f64::from(i) + 0.5))).sum()
}

/// Survival, the share never scattered and the angle are those of analog walks: each within 3 σ, and χ² of the
/// angles below its mean by 3 σ of its own.
#[test]
fn exits_are_those_of_walks() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    for (radius, absorbed_share, walks) in CASES {
        let step = SphereStep::new(absorbed_share as f32).unwrap();
        let (mut left, mut straight, mut angles) = (0.0, 0.0, [0.0; BINS]);
        for _ in 0..walks {
            let Some((collisions, cosine, _)) = walk(radius, absorbed_share, &mut random) else { continue };
            left += 1.0;
            if collisions == 0 {
                straight += 1.0;
            } else {
                let bin = cosine.min(1.0).acos() / FRAC_PI_2 * BINS as f64;
                angles[(bin as usize).min(BINS - 1)] += 1.0;
            }
        }
        let count = f64::from(walks);
        let pull = |found: f64, share: f64| {
            let variance = count * share * (1.0 - share);
            (found - count * share) / variance.max(f64::MIN_POSITIVE).sqrt()
        };
        let departure = step.departure(radius as f32);
        let survival = f64::from(departure.survival());
        if absorbed_share > 0.0 {
            assert!(pull(left, survival).abs() < 3.0, "{radius} {absorbed_share}: {}", left / count);
        } else {
            assert_eq!(survival, 1.0);
        }
        let share = f64::from(departure.density(Exit::Straight));
        assert!(pull(straight, share).abs() < 3.0, "{radius} {absorbed_share}: {}", straight / count);
        let width = FRAC_PI_2 / BINS as f64;
        let pulls = (0..BINS).map(|bin| {
            let from = width * bin as f64;
            pull(angles[bin], share_between(&step, radius, from, from + width))
        });
        let chi_squared: f64 = pulls.map(|pull| pull * pull).sum();
        let bins = BINS as f64;
        assert!(chi_squared < bins + 3.0 * (2.0 * bins).sqrt(), "{radius} {absorbed_share}: {chi_squared}");
    }
}

/// The table between its nodes, against the solution there.
#[test]
fn the_table_has_the_accuracy_that_it_states() {
    let nodes = GaussLegendre::new(96);
    for (radius, absorbed_share) in [
        (1.0, 1e-7),
        (1.07, 0.43),
        (1.3, 0.0025),
        (1.9, 0.3),
        (2.9, 0.13),
        (4.4, 0.017),
        (5.3, 0.3),
        (9.2, 0.041),
        (14.0, 0.09),
        (23.0, 0.000_7),
        (61.0, 0.004),
        (170.0, 0.000_03),
        (1234.0, 0.000_01),
    ] {
        let sphere = Sphere::of_share(absorbed_share, radius);
        let step = SphereStep::new(absorbed_share as f32).unwrap();
        let departure = step.departure(radius as f32);
        let exact: Vec<f64> = nodes.nodes().iter().map(|&(x, _)| sphere.leaving(FRAC_PI_2 * x)).collect();
        let sum = |f: &dyn Fn(usize) -> f64| -> f64 {
            nodes.nodes().iter().enumerate().map(|(i, (_, w))| FRAC_PI_2 * w * f(i)).sum()
        };
        let (scale, straight) = (sphere.scale(), (-radius).exp());
        let collided = sum(&|i| exact[i]) * scale;
        let survival = collided + straight;
        let found = f64::from(departure.survival());
        let at = |i: usize| {
            let angle = (FRAC_PI_2 * nodes.nodes()[i].0) as f32;
            f64::from(departure.density(Exit::Oblique { angle })) / found
        };
        let difference = sum(&|i| (at(i) - exact[i] * scale / survival).abs());
        assert!(survival > 1e-3);
        assert!((found / survival - 1.0).abs() < 1e-4, "{radius} {absorbed_share}: {found}, not {survival}");
        assert!(difference < 1e-3, "{radius} {absorbed_share}: {difference}");
    }
}

/// Numbers spread evenly give exits whose counts are the integrals of the density: up to the two ends of each interval in both
/// tables between which is interpolated, and rounding of the running sums (8 units in the last place).
#[test]
fn exits_are_drawn_with_their_density() {
    let draws = 1 << 17;
    for (radius, absorbed_share) in [(1.0_f32, 0.0), (1.7, 0.4), (9.3, 0.02), (250.0, 1e-6), (1e5, 0.0)] {
        let step = SphereStep::new(absorbed_share).unwrap();
        let departure = step.departure(radius);
        let (mut straight, mut counts) = (0, [0; BINS]);
        for i in 0..draws {
            match departure.sample((i as f32 + 0.5) / draws as f32) {
                Exit::Straight => straight += 1,
                Exit::Oblique { angle } => {
                    assert!((0.0..=FRAC_PI_2 as f32).contains(&angle), "{angle}");
                    counts[((f64::from(angle) / FRAC_PI_2 * BINS as f64) as usize).min(BINS - 1)] += 1;
                }
            }
        }
        let expected = |share: f64| f64::from(draws) * share / f64::from(departure.survival());
        let tolerance = 4.0 + f64::from(draws) * 8.0 * f64::from(f32::EPSILON);
        let share = f64::from(departure.density(Exit::Straight));
        assert!((f64::from(straight) - expected(share)).abs() < tolerance);
        for (bin, count) in counts.into_iter().enumerate() {
            let width = FRAC_PI_2 / BINS as f64;
            let from = width * bin as f64;
            let expected = expected(share_between(&step, f64::from(radius), from, from + width));
            // And 10⁻⁵ for the sum that stands for the integral.
            let tolerance = tolerance + 1e-5 * expected;
            assert!(
                (f64::from(count) - expected).abs() < tolerance,
                "{radius} {bin}: {count}, not {expected}"
            );
        }
    }
}

/// An exit drawn for one wavelength, weighted by the ratio of densities, gives the survival of another one.
#[test]
fn one_wavelength_speaks_for_another() {
    let steps = [0.0002, 0.003, 0.04].map(|share| SphereStep::new(share).unwrap());
    let departures = [(&steps[0], 5.0), (&steps[1], 7.0), (&steps[2], 6.2)]
        .map(|(step, radius): (&SphereStep, f32)| step.departure(radius));
    let draws = 1 << 16;
    for (lead, other) in [(0, 1), (1, 2), (2, 0)] {
        let (lead, other) = (&departures[lead], &departures[other]);
        let weight = |i: i32| {
            let exit = lead.sample((i as f32 + 0.5) / draws as f32);
            f64::from(other.density(exit) / lead.density(exit) * lead.survival())
        };
        let mean = (0..draws).map(weight).sum::<f64>() / f64::from(draws);
        // A midpoint rule with this many points and a weight that varies by less than its mean.
        assert!((mean / f64::from(other.survival()) - 1.0).abs() < 1e-4, "{mean}");
    }
}

/// Without absorption the mean length of walks is that which their exits tell: τ²/2 + τ cos θ, in the mean.
#[test]
fn lengths_of_paths_follow_from_their_exits() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(2);
    for (radius, walks) in [(1.3, 200_000), (6.1, 100_000), (17.0, 50_000)] {
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..walks {
            let (_, _, length) = walk(radius, 0.0, &mut random).expect("nothing is absorbed");
            sum += length;
            squares += length * length;
        }
        let count = f64::from(walks);
        let mean = sum / count;
        let error = ((squares / count - mean * mean) / count).sqrt();
        let step = SphereStep::new(0.0).unwrap();
        let departure = step.departure(radius as f32);
        let draws = 1 << 14;
        let length = |i: i32| departure.sample((i as f32 + 0.5) / draws as f32).path_length(radius as f32);
        let told = (0..draws).map(|i| f64::from(length(i))).sum::<f64>() / f64::from(draws);
        assert!((mean - told).abs() < 3.0 * error, "{radius}: {mean} ± {error}, {told}");
    }
}

/// Any radius and share give finite answers, and more absorption leaves less.
#[test]
fn the_whole_range_is_covered() {
    for bad in [-1e-9, 0.500_001, 1.0, f32::NAN, f32::INFINITY] {
        assert!(SphereStep::new(bad).is_none(), "{bad}");
    }
    let shares = [0.0, 1e-12, 1e-6, 1e-4, 1e-2, 0.1, LARGEST_ABSORBED_SHARE];
    let steps = shares.map(|share| SphereStep::new(share).unwrap());
    for radius in [1.0, 1.5, 10.0, 1e3, 2e4, 1e10] {
        let departures = steps.each_ref().map(|step| step.departure(radius));
        assert!(departures.windows(2).all(|pair| pair[1].survival() <= pair[0].survival()));
        assert_eq!(departures[0].survival(), 1.0);
        for departure in departures {
            assert!((0.0..=1.0).contains(&departure.survival()));
            for u in [0.0, 0.3, 1.0 - f32::EPSILON / 2.0] {
                let exit = departure.sample(u);
                let density = departure.density(exit);
                assert!(density.is_finite() && density >= 0.0, "{radius} {u}: {exit:?} {density}");
                assert!((0.0..=1.0).contains(&exit.cosine()));
            }
        }
    }
}
