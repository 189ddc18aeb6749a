//! Damaged files of every format that is read: no panic, no hang, no memory beyond what the input is worth, but what was read or one
//! message that says what is wrong.
//!
//! Each target mutates small files (`tests/data/fuzz/`, some made in code, and broken files of others where they are at hand) by bytes and
//! by structure, from fixed seeds. With `ALABASTER_FUZZ_SECONDS=600` each target goes on for ten minutes, from the seed
//! `ALABASTER_FUZZ_SEED`. What breaks the law is kept in the folder that the message names; mended, it belongs into
//! `tests/data/fuzz/regressions/`, all of which every run reads first.

#[path = "../common/assets.rs"]
mod assets;
#[path = "../gltf_reader/builder.rs"]
#[allow(dead_code)]
mod builder;

mod law;
mod mutation;
mod seeds;
mod structure;
mod trial;

use std::path::Path;
use std::time::{Duration, Instant};
use std::{env, fs};

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use seeds::Seed;
use trial::Trials;

/// Inputs by target in a run of the suite.
const INPUTS: u64 = 3000;

/// Findings after which a target stops.
const MOST_FINDINGS: usize = 10;

/// What is asked of one file: whether it was read or refused, or what is wrong with the answer.
type Law = fn(&Path) -> Result<bool, String>;

fn number(variable: &str) -> Option<u64> {
    env::var(variable).ok().map(|text| text.parse().unwrap_or_else(|_| panic!("{variable}={text}")))
}

/// Holds `law` for the files with one of `endings`, and for mutations of them.
#[track_caller]
fn fuzz(target: &str, endings: &[&str], law: Law) {
    let seeds = seeds::seeds(endings);
    let mut trials = Trials::new(target, law);
    for seed in &seeds {
        trials.hold(seed.ending(), &seed.bytes);
    }
    let time = number("ALABASTER_FUZZ_SECONDS").map(Duration::from_secs);
    let mut random = Pcg64::seed_from_u64(number("ALABASTER_FUZZ_SEED").unwrap_or(1));
    let begin = Instant::now();
    let mut inputs = 0_u64;
    while time.map_or(inputs < INPUTS, |time| begin.elapsed() < time) && trials.findings() < MOST_FINDINGS {
        let seed = &seeds[random.random_range(0..seeds.len())];
        trials.hold(seed.ending(), &mutated(seed, &seeds, &mut random));
        inputs += 1;
    }
    println!(
        "{target}: {} seeds, {inputs} mutations, {} read, {} refused, in {:.1} s; at most {} MiB, {:.2} s",
        seeds.len(),
        trials.read,
        trials.refused,
        begin.elapsed().as_secs_f64(),
        trials.most_memory >> 20,
        trials.longest.as_secs_f64()
    );
    // A target whose mutations are all refused at the door, or all read, tests nothing.
    assert!(
        trials.read > 0 && trials.refused > 0,
        "{target}: {} read, {} refused",
        trials.read,
        trials.refused
    );
    trials.finish();
}

fn mutated(seed: &Seed, seeds: &[Seed], random: &mut Pcg64) -> Vec<u8> {
    let other = &seeds[random.random_range(0..seeds.len())].bytes;
    let structured = random.random_bool(0.5).then(|| structure::mutated(seed, random)).flatten();
    structured.unwrap_or_else(|| {
        let mut bytes = seed.bytes.clone();
        for _ in 0..random.random_range(1..=6) {
            mutation::mutate(&mut bytes, other, random);
        }
        bytes
    })
}

#[test]
fn models() {
    fuzz("models", &["gltf", "glb"], law::scene);
}

#[test]
fn scene_files() {
    fuzz("scene files", &["toml"], law::scene);
}

#[test]
fn environment_maps() {
    fuzz("environment maps", &["hdr", "exr"], law::environment);
}

#[test]
fn layered_slabs() {
    fuzz("layered slabs", &["mci"], law::layers);
}

#[test]
fn media_by_wavelength() {
    fuzz("media by wavelength", &["csv"], law::medium);
}

/// What mutations begin with gets past the readers.
#[test]
fn whole_files_are_read() {
    let laws: [(&[&str], Law); 5] = [
        (&["gltf", "glb"], law::scene),
        (&["toml"], law::scene),
        (&["hdr", "exr"], law::environment),
        (&["mci"], law::layers),
        (&["csv"], law::medium),
    ];
    let folder = tempfile::tempdir().unwrap();
    seeds::put_beside(folder.path());
    for (endings, law) in laws {
        for seed in seeds::seeds(endings).iter().filter(|seed| seed.is_whole()) {
            let path = folder.path().join(format!("input.{}", seed.ending()));
            fs::write(&path, &seed.bytes).unwrap();
            assert_eq!(law(&path), Ok(true), "{}", seed.name);
        }
    }
}

/// The harness itself: each way to break the law is a finding.
#[test]
fn what_breaks_the_law_is_found() {
    let broken: [(&str, Law); 4] = [
        ("panic", |_| panic!("on purpose")),
        ("hang", |_| {
            loop {
                std::thread::sleep(Duration::from_secs(1));
            }
        }),
        ("memory", |_| {
            let pages = vec![1_u8; (trial::MOST_MEMORY + (64 << 20)) as usize];
            Ok(std::hint::black_box(pages)[7] == 1)
        }),
        ("answer", |_| Err("a scene without sense".into())),
    ];
    for (name, law) in broken {
        if name == "memory" && !Path::new("/proc/self/status").exists() {
            continue;
        }
        let mut trials = Trials::new(name, law);
        if name == "hang" {
            trials.patience = Duration::from_millis(300);
        }
        trials.hold("txt", b"anything");
        assert_eq!(trials.findings(), 1, "{name}");
        assert_eq!(fs::read(trials.kept(0)).unwrap(), b"anything");
    }
}
