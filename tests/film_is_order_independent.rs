//! The film promises that the same samples give the same bits, in whatever order and in whatever
//! parts they arrive, and however many threads bring them.

use std::sync::atomic::AtomicBool;

use alabaster::film::accumulator::LARGEST;
use alabaster::film::{Accumulator, Film};
use alabaster::math::sampler::SampleStream;
use alabaster::radiometry::Rgb;
use proptest::prelude::*;
use rand::RngExt;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_distr::{Distribution, LogNormal};
use rand_pcg::Pcg64;

fn sum(samples: &[Rgb]) -> Accumulator {
    let mut accumulator = Accumulator::default();
    samples.iter().for_each(|&sample| accumulator.add(sample));
    accumulator
}

/// Any bits at all (NaN, infinities, subnormals), and ordinary radiance.
fn any_sample() -> impl Strategy<Value = Rgb> {
    let any_bits = any::<[u32; 3]>().prop_map(|bits| Rgb::from_fn(|c| f32::from_bits(bits[c])));
    let ordinary =
        [-12.0_f32..20.0, -12.0_f32..20.0, -12.0_f32..20.0].prop_map(|e| Rgb::from_fn(|c| e[c].exp2()));
    prop_oneof![any_bits, ordinary]
}

proptest! {
    #[test]
    fn any_order_gives_the_same_bits(samples in prop::collection::vec(any_sample(), 0..200), seed: u64) {
        let mut shuffled = samples.clone();
        shuffled.shuffle(&mut Pcg64::seed_from_u64(seed));
        prop_assert_eq!(sum(&shuffled), sum(&samples));
    }

    #[test]
    fn any_partition_merges_to_the_same_bits(samples in prop::collection::vec(any_sample(), 0..200), seed: u64) {
        let mut random = Pcg64::seed_from_u64(seed);
        let mut parts = vec![Vec::new(); 1 + random.random_range(0..9)];
        for &sample in &samples {
            let part = random.random_range(0..parts.len());
            parts[part].push(sample);
        }
        // Merge two parts at random until one is left: any tree of merges.
        let mut sums: Vec<Accumulator> = parts.iter().map(|part| sum(part)).collect();
        while sums.len() > 1 {
            let a = sums.swap_remove(random.random_range(0..sums.len()));
            let into = random.random_range(0..sums.len());
            sums[into].merge(&a);
        }
        prop_assert_eq!(sums[0], sum(&samples));
    }

    /// Each sample is within half a quantum (2⁻⁵⁹) of what it was; sums are exact; the mean is
    /// rounded to f64 three times and once to f32.
    #[test]
    fn the_mean_is_that_of_exact_arithmetic(exponents in prop::collection::vec(-40.0_f32..35.0, 1..100)) {
        let samples: Vec<Rgb> = exponents.iter().map(|e| Rgb::splat(e.exp2())).collect();
        // f64 addition of n positive terms errs by at most n·2⁻⁵³ of the sum.
        let n = samples.len() as f64;
        let expected = samples.iter().map(|sample| f64::from(sample[0])).sum::<f64>() / n;
        let tolerance = 2.0_f64.powi(-59) + expected * ((n + 3.0) * 2.0_f64.powi(-53) + 2.0_f64.powi(-24));
        prop_assert!((f64::from(sum(&samples).mean()[0]) - expected).abs() <= tolerance);
    }
}

#[test]
fn the_variance_is_that_of_the_two_pass_formula() {
    let mut random = Pcg64::seed_from_u64(7);
    // As a picture with fireflies has it: a few samples hold most of the variance.
    let heavy_tailed = LogNormal::new(0.0_f32, 2.0).unwrap();
    let samples: Vec<Rgb> = (0..10_000)
        .map(|_| {
            let strength = heavy_tailed.sample(&mut random);
            Rgb::new(strength, 1000.0 + random.random::<f32>(), 1e-6 * random.random::<f32>())
        })
        .collect();
    let n = samples.len() as f64;
    let pixel = sum(&samples);
    for channel in 0..3 {
        let values = || samples.iter().map(|sample| f64::from(sample[channel]));
        let mean = values().sum::<f64>() / n;
        let expected = values().map(|x| (x - mean).powi(2)).sum::<f64>() / (n * (n - 1.0));
        // One-pass cancellation: a few ulps of mean² over n. Quantum of the squares: 2⁻⁵⁵ each at
        // most, over n. Rounding of the two-pass sum: n ulps relative.
        let tolerance = (4.0 * f64::EPSILON * (mean * mean) + 2.0_f64.powi(-55)) / (n - 1.0)
            + expected * n * f64::EPSILON;
        assert!((pixel.variance_of_mean(channel) - expected).abs() <= tolerance, "channel {channel}");
    }
}

#[test]
fn light_far_apart_in_strength_is_not_lost() {
    // In f32 the small samples would vanish beside the large one; here they are all in the sum.
    let mut samples = vec![Rgb::splat(1e-9); 1 << 16];
    samples.push(Rgb::splat(LARGEST));
    samples.push(Rgb::splat(-LARGEST));
    let expected = f64::from(1e-9_f32) * 65_536.0 / 65_538.0;
    // 2¹⁶ roundings of at most 2⁻⁵⁹ in the sum, and the mean's to f32.
    let tolerance = 2.0_f64.powi(-59) + expected * 2.0_f64.powi(-23);
    assert!((f64::from(sum(&samples).mean()[0]) - expected).abs() <= tolerance);
}

fn noise(x: u32, y: u32, sample: u64) -> Rgb {
    let numbers = SampleStream::new(5, u64::from(y) << 32 | u64::from(x), sample).quad(0);
    Rgb::from_fn(|channel| (numbers[channel] * 30.0 - 20.0).exp2())
}

fn render(passes: &[std::ops::Range<u64>], threads: usize) -> (Film, u64) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let mut film = Film::new(45, 33).unwrap();
    let mut counted = 0;
    for pass in passes {
        counted += pool.install(|| {
            film.accumulate(
                pass.clone(),
                |x, y, sample, count: &mut u64| {
                    *count += u64::from(x ^ y) + sample;
                    noise(x, y, sample)
                },
                |total, count| *total += count,
                &AtomicBool::new(false),
                |_| (),
            )
        });
    }
    (film, counted)
}

#[test]
#[allow(clippy::single_range_in_vec_init, reason = "one pass of that range is meant")]
fn threads_and_passes_do_not_change_the_film() {
    let reference = render(&[0..24], 1);
    assert!(render(&[0..24], 3) == reference);
    assert!(render(&[0..1, 1..2, 2..4, 4..8, 8..16, 16..24], 2) == reference);
    assert!(render(&[16..24, 3..16, 0..3], 2) == reference);
    assert!(render(&[0..23], 2) != reference);
}
