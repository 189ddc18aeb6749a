//! What a model costs, and whether what is drawn from it is distributed as it is.

use std::hint::black_box;
use std::time::Instant;

use crate::diffusion::integrate::energy_between;
use crate::diffusion::{DiffusionModel, Profile, ShapeTable};

/// Cost of a model on this machine, on one thread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Seconds for R(r) by the model itself.
    pub seconds_per_evaluation: f64,
    /// Seconds to draw a radius and to evaluate R there, both by the [`ShapeTable`] made of the model, which is what a
    /// renderer does.
    pub seconds_per_sample: f64,
    /// Largest difference between the share of drawn radii and the share of the model's energy within any radius
    /// (Kolmogorov's distance, without noise as the numbers drawn from are equidistant).
    pub sampling_error: f64,
}

/// Least time that is measured, s.
const LEAST_TIME: f64 = 4e-3;
/// Radii at which a model is evaluated.
const RADII: usize = 256;
/// Numbers from which radii are drawn.
const DRAWN: usize = 512;

/// Measures `model`, of `reduced` as reduced mean free path.
pub fn measure(model: &dyn DiffusionModel, reduced: f64) -> Cost {
    let radii: Vec<f64> =
        (0..RADII).map(|i| reduced * 10.0_f64.powf(4.0 * i as f64 / RADII as f64 - 3.0)).collect();
    let seconds_per_evaluation =
        seconds_each(RADII, || radii.iter().map(|&radius| model.reflectance(black_box(radius))).sum());
    let table = ShapeTable::of_one(model, reduced);
    let shape = table.shape(0.0, reduced as f32);
    let numbers: Vec<f32> = (0..DRAWN).map(|i| (i as f32 + 0.5) / DRAWN as f32).collect();
    let draw = |&xi: &f32| {
        let radius = shape.sample_radius(black_box(xi));
        f64::from(shape.density(radius))
    };
    let seconds_per_sample = seconds_each(DRAWN, || numbers.iter().map(draw).sum());
    let drawn: Vec<f64> = numbers.iter().map(|&xi| f64::from(shape.sample_radius(xi))).collect();
    Cost { seconds_per_evaluation, seconds_per_sample, sampling_error: sampling_error(model, &drawn) }
}

/// Shortest time of three for one of `count` pieces of `work`.
fn seconds_each(count: usize, work: impl Fn() -> f64) -> f64 {
    let time = || {
        let start = Instant::now();
        let mut repeats = 0;
        while start.elapsed().as_secs_f64() < LEAST_TIME {
            black_box(work());
            repeats += count;
        }
        start.elapsed().as_secs_f64() / repeats as f64
    };
    time().min(time()).min(time())
}

/// `drawn` rises, from equidistant numbers.
fn sampling_error(model: &dyn DiffusionModel, drawn: &[f64]) -> f64 {
    let total = model.albedo();
    let (mut inside, mut from, mut largest) = (0.0, 0.0, 0.0_f64);
    for (i, &radius) in drawn.iter().enumerate() {
        inside += energy_between(model, from, radius);
        from = radius;
        let wanted = (i as f64 + 0.5) / drawn.len() as f64;
        largest = largest.max((inside / total - wanted).abs());
    }
    largest
}
