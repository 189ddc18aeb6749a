//! A good input file, and what comes of it.
#![allow(dead_code)]

use std::sync::atomic::AtomicBool;

use alabaster::slab::mci::parse_mci;
use alabaster::slab::mco::{Header, write_mco};
use alabaster::slab::{MciRun, Scattered, Simulation, Source};

/// Two runs; line 7 begins the first, line 17 the second.
pub const GOOD: &str = "\
# notes, then the version

1.0     # version
2       # runs

### first
a.mco A
1000    # photons
0.01 0.02
3 4 2

2
1.0
1.4 1 100 0.9 0.1
1.5 2 50 0.0 1e8
1.2
b.mco a
2e3
20E-4\t20E-4
5 6 7
1
1
1.3 20 200 -0.7 1E+8
1.0
";

pub fn good() -> Vec<MciRun> {
    parse_mci(GOOD).unwrap()
}

/// Line `number` of [`GOOD`] replaced by `text`; more than one line if `text` has them, none if it is empty.
pub fn with_line(number: usize, text: &str) -> String {
    let line = |(i, line)| if i + 1 == number { text } else { line };
    GOOD.lines().enumerate().map(line).collect::<Vec<_>>().join("\n")
}

pub fn simulate(run: &MciRun, source: Source) -> Scattered {
    let (stack, grid) = (run.stack.clone(), run.grid);
    let simulation = Simulation { stack, source, grid, photons: run.photons, seed: 7 };
    simulation.run(|_| {}, &AtomicBool::new(false)).0
}

/// The .mco of `run`.
pub fn mco(run: &MciRun, result: &Scattered) -> String {
    let source = Source::Pencil { cosine: 1.0 };
    let header = Header { output: &run.output, photons: run.photons, seconds: 1.0, seed: 7, source };
    let mut bytes = Vec::new();
    write_mco(&mut bytes, &header, &run.stack, result).unwrap();
    String::from_utf8(bytes).unwrap()
}
