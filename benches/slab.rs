//! Photons per second of the slab walk on one thread, with the tallies of a typical grid.

use std::hint::black_box;

use alabaster::slab::{Grid, Layer, LayerStack, Pieces, Roulette, Scores, Source, Tally, Walk};
use criterion::{Criterion, Throughput};

/// Photons of one iteration.
const PHOTONS: u64 = 10_000;

fn main() {
    let mut criterion = Criterion::default().sample_size(20).configure_from_args();
    let mut group = criterion.benchmark_group("slab");
    group.throughput(Throughput::Elements(PHOTONS));
    for (name, stack, grid) in cases() {
        let walk = Walk::new(&stack, Source::Pencil { cosine: 1.0 }, Roulette::default());
        let pieces = Pieces::new(&stack, grid);
        let mut tally = Tally::new(&pieces);
        let mut stream = 0;
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                walk.run(PHOTONS, 1, stream, &mut tally);
                stream += 1;
            });
        });
        black_box(tally.sums());
    }
    group.finish();
    criterion.final_summary();
}

/// The cases of Wang, Jacques and Zheng 1995, lengths in centimetres; and skin, where photons collide a thousand times.
fn cases() -> [(&'static str, LayerStack, Grid); 3] {
    let grid =
        |step, radial, depth, angular| Grid { radial_step: step, radial, depth_step: step, depth, angular };
    let slab = |ior, sigma_a, sigma_s, g, thickness| {
        LayerStack::new(1.0, vec![Layer { ior, sigma_a, sigma_s, g, thickness }], 1.0).unwrap()
    };
    [
        ("van de Hulst", slab(1.0, 10.0, 90.0, 0.75, 0.02), grid(0.001, 50, 20, 30)),
        ("Giovanelli", slab(1.5, 10.0, 90.0, 0.0, 1e8), grid(0.002, 50, 50, 30)),
        ("skin", slab(1.4, 0.1, 100.0, 0.9, 1e8), grid(0.01, 100, 100, 30)),
    ]
}
