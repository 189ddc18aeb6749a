//! What types with units cost: the irradiance of a thousand patches of sky, in quantities and in plain floats. The bits are the same.
//!
//! `cargo bench --bench quantities`

use std::hint::black_box;

use alabaster::math::sampler::HashGenerator;
use alabaster::radiometry::{Irradiance, Radiance, SolidAngle};
use criterion::Criterion;

/// Radiance, solid angle and cosine of a patch.
type Patch = [f64; 3];

fn in_quantities(sky: &[Patch]) -> f64 {
    let irradiance =
        |&[radiance, extent, cos]: &Patch| Radiance(radiance).irradiance(SolidAngle(extent).projected(cos));
    sky.iter().map(irradiance).fold(Irradiance(0.0), |sum, part| sum + part).0
}

fn in_plain_floats(sky: &[Patch]) -> f64 {
    sky.iter()
        .map(|&[radiance, extent, cos]| radiance * (extent * cos.max(0.0)))
        .fold(0.0, |sum, part| sum + part)
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    let mut random = HashGenerator::new(1);
    let sky: Vec<Patch> = (0..1000).map(|_| [0; 3].map(|_| f64::from(random.next_f32()))).collect();
    assert_eq!(in_quantities(&sky).to_bits(), in_plain_floats(&sky).to_bits());
    let mut group = criterion.benchmark_group("irradiance");
    group.bench_function("quantities", |bencher| bencher.iter(|| in_quantities(black_box(&sky))));
    group.bench_function("plain floats", |bencher| bencher.iter(|| in_plain_floats(black_box(&sky))));
    group.finish();
    criterion.final_summary();
}
