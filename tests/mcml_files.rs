//! MCML's files: what is read, what is refused and how, what is written.

mod mcml;

use std::path::Path;

use alabaster::slab::csv::write_csv;
use alabaster::slab::mci::parse_mci;
use alabaster::slab::{Grid, MciRun, Source};
use mcml::{GOOD, good, mco, simulate, with_line};
use proptest::prelude::*;

#[test]
fn a_file_is_read() {
    let runs = good();
    let [first, second] = runs.as_slice() else { panic!("{runs:?}") };
    assert_eq!((first.output.as_path(), first.line, first.photons), (Path::new("a.mco"), 7, 1000));
    let grid = Grid { radial_step: 0.02, radial: 4, depth_step: 0.01, depth: 3, angular: 2 };
    assert_eq!(first.grid, grid);
    assert_eq!((first.stack.ior_above(), first.stack.ior_below()), (1.0, 1.2));
    let [upper, lower] = first.stack.layers() else { panic!() };
    assert_eq!(
        (upper.ior, upper.sigma_a, upper.sigma_s, upper.g, upper.thickness),
        (1.4, 1.0, 100.0, 0.9, 0.1)
    );
    assert_eq!(
        (lower.ior, lower.sigma_a, lower.sigma_s, lower.g, lower.thickness),
        (1.5, 2.0, 50.0, 0.0, 1e8)
    );
    assert_eq!((second.photons, second.grid.depth_step, second.stack.layers()[0].g), (2000, 0.002, -0.7));
}

#[test]
fn what_does_not_matter_is_not_minded() {
    let dos = GOOD.replace('\n', "\r\n");
    assert_eq!(parse_mci(&dos).unwrap(), good());
    assert_eq!(parse_mci(&format!("\u{feff}{GOOD}   # the end")).unwrap(), good());
    for version in ["1", "1.0", "1.2", "1.2.2", "2.0"] {
        assert_eq!(parse_mci(&GOOD.replacen("1.0", version, 1)).unwrap(), good());
    }
    // A folder below is inside.
    assert_eq!(parse_mci(&GOOD.replace("a.mco", "out/a.mco")).unwrap()[0].output, Path::new("out/a.mco"));
}

#[track_caller]
fn is_refused(text: &str, parts: &[&str]) {
    let error = parse_mci(text).unwrap_err().to_string();
    for part in parts {
        assert!(error.contains(part), "no {part:?} in {error:?}");
    }
}

#[test]
fn wrong_values_are_refused_by_line_and_field() {
    let cases: [(usize, &str, &[&str]); 41] = [
        (3, "1.3", &["line 3: file version", "\"1.3\" is not supported", "MCML 1"]),
        (3, "3", &["file version", "not supported"]),
        (3, "mcmli2.0", &["line 3: file version", "named media"]),
        (3, "A1", &["line 3", "output file, .mco"]),
        (3, "1.0 2", &["line 3: file version: 2 values stand here where 1 should"]),
        (4, "0", &["line 4: number of runs", "is 0"]),
        (4, "two", &["line 4: number of runs", "\"two\"", "not a whole number"]),
        (4, "-1", &["line 4: number of runs", "\"-1\""]),
        (4, "1.5", &["line 4: number of runs", "\"1.5\""]),
        (4, "1", &["line 17: end of the file", "more after the last run", "line 4, which is 1"]),
        (4, "3", &["line 24: output file", "file ends"]),
        (4, "18446744073709551615", &["line 24: output file", "file ends"]),
        (7, "a.mco", &["line 7: output file: 1 value stands here where 2 should: file name A"]),
        (7, "a.mco B", &["line 7: output file", "binary", "write A"]),
        (7, "a.mco C", &["line 7: output file", "format \"C\""]),
        (7, "../a.mco A", &["line 7: output file", "\"../a.mco\" is refused"]),
        (7, "out/../../a.mco A", &["line 7", "is refused"]),
        (7, "/tmp/a.mco A", &["line 7", "is refused", "plain name"]),
        (7, "C:\\a.mco A", &["line 7", "is refused"]),
        (7, ".profile A", &["line 7", "is refused", "hidden"]),
        (7, "out/ A", &["line 7", "is refused"]),
        (17, "a.mco A", &["line 17: output file", "run on line 7"]),
        (8, "0", &["line 8: number of photons", "at least one"]),
        (8, "1e30", &["line 8: number of photons", "\"1e30\""]),
        (8, "2000000000000", &["line 8: number of photons", "the most is 1000000000000"]),
        (8, "1000 0:30", &["line 8: number of photons", "limits of time are not supported"]),
        (8, "5:10", &["line 8: number of photons", "limits of time"]),
        (9, "0.01", &["line 9: grid steps dz dr", "1 value stands here where 2 should: dz dr"]),
        (9, "0 0.02", &["line 9: grid steps", "dz is 0 cm"]),
        (9, "0.01 -1", &["line 9", "dr is -1 cm"]),
        (9, "0.01 nan", &["line 9", "dr is nan", "finite"]),
        (10, "3 4 2 5", &["line 10: numbers of bins nz nr na", "4 values stand here where 3 should"]),
        (10, "3 0 2", &["line 10", "nr is 0"]),
        (10, "2000 2000 2", &["line 10", "too large", "take fewer bins"]),
        (10, "1 100000 100", &["line 10", "too large"]),
        (10, "99999999999999 1 1", &["line 10", "nz is 99999999999999; the most is"]),
        (12, "0", &["line 12: number of layers", "at least one layer"]),
        (13, "0", &["line 13: n of the medium above", "the index of refraction is 0"]),
        (13, "x", &["line 13: n of the medium above", "\"x\"", "not a number"]),
        (16, "-1", &["line 16: n of the medium below", "medium below", "-1"]),
        (16, "1.2 # n\n1.0", &["line 17: output file"]),
    ];
    for (line, text, parts) in cases {
        is_refused(&with_line(line, text), parts);
    }
}

#[test]
fn wrong_layers_are_refused_by_line_and_field() {
    let cases: [(&str, &[&str]); 13] = [
        ("1.4 -1 100 0.9 0.1", &["line 14", "layer 1", "mua is -1"]),
        ("1.4 1 -100 0.9 0.1", &["line 14", "layer 1", "mus is -100"]),
        ("1.4 1 100 1 0.1", &["line 14", "the mean cosine g is 1;", "between -1 and 1"]),
        ("1.4 1 100 -1.5 0.1", &["line 14", "the mean cosine g is -1.5"]),
        ("1.4 1 100 0.9 0", &["line 14", "the thickness d is 0"]),
        ("1.4 1 100 0.9 -1", &["line 14", "the thickness d is -1"]),
        ("-1.4 1 100 0.9 0.1", &["line 14", "the index of refraction is -1.4"]),
        ("1.4 1 100 0.9 inf", &["line 14", "d is inf", "1e8"]),
        ("1.4 nan 100 0.9 0.1", &["line 14", "mua is nan"]),
        ("1.4 1 1e31 0.9 0.1", &["line 14", "mus is 1e31"]),
        ("1.4 1 100 0,9 0.1", &["line 14", "g is \"0,9\", which is not a number"]),
        (
            "1.4 1 100 0.9 0.1 epidermis",
            &["line 14", "6 values stand here where 5 should: n mua mus g d", "further columns"],
        ),
        ("1.4 1 100 0.9", &["line 14", "4 values stand here", "number of layers on line 12, 2, wrong?"]),
    ];
    for (text, parts) in cases {
        is_refused(&with_line(14, text), parts);
    }
    // Too many layers announced, and too few.
    is_refused(&with_line(12, "3"), &["line 16: layer", "number of layers on line 12, 3, wrong?"]);
    is_refused(
        &with_line(12, "1"),
        &["line 15: n of the medium below", "number of layers on line 12, 1, wrong?"],
    );
}

/// However short the file is cut, it is either complete or refused.
#[test]
fn cut_files_are_refused() {
    let lines: Vec<&str> = GOOD.lines().collect();
    for count in 0..lines.len() {
        let cut = lines[..count].join("\n");
        let error = parse_mci(&cut).unwrap_err().to_string();
        assert!(error.contains("the file ends"), "{count} lines: {error}");
    }
}

fn damage() -> impl Strategy<Value = (usize, u8)> {
    (0..GOOD.len(), any::<u8>())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    /// Whatever bytes are changed: runs whose values are in range, or an error with a line.
    #[test]
    fn damaged_files_never_panic(damages in prop::collection::vec(damage(), 1..6)) {
        let mut bytes = GOOD.as_bytes().to_vec();
        damages.iter().for_each(|&(position, value)| bytes[position] = value);
        match parse_mci(&String::from_utf8_lossy(&bytes)) {
            Ok(runs) => prop_assert!(runs.iter().all(|run| run.photons >= 1 && !run.stack.layers().is_empty())),
            Err(error) => prop_assert!(error.to_string().starts_with("line ")),
        }
    }
}

/// MCML's own example, of 1991, with a million photons: three layers.
const EXAMPLE: &str = "1.0\n1\nexample.mco A\n200000\n0.01 0.01\n40 50 1\n3\n1.0\n1.37 1 100 0.90 0.1\n\
                       1.37 1 10 0 0.1\n1.37 2 10 0.70 0.2\n1.0\n";

/// Values of the section that begins with `name`.
fn section(mco: &str, name: &str) -> Vec<f64> {
    let mut lines = mco.lines().skip_while(|line| line.split_whitespace().next() != Some(name));
    lines.next().unwrap();
    let values = lines.take_while(|line| !line.is_empty() && !line.starts_with('#'));
    values
        .flat_map(|line| line.split('#').next().unwrap().split_whitespace())
        .map(|word| word.parse().unwrap())
        .collect()
}

/// Numbers from the output file that comes with MCML (example.mco), of a million photons.
#[test]
fn the_example_of_mcml_is_reproduced() {
    let run = &parse_mci(EXAMPLE).unwrap()[0];
    let result = simulate(run, Source::Pencil { cosine: 1.0 });
    let text = mco(run, &result);
    // Its standard errors are those of this simulation but for the number of photons.
    let both = (1.0 + run.photons as f64 / 1e6).sqrt();
    let close = |found: f64, sigma: f64, published: f64, rounding: f64| {
        let bound = 3.5 * both * sigma + rounding;
        assert!((found - published).abs() < bound, "{found} ± {sigma}, published {published}");
    };
    let rat = section(&text, "RAT");
    assert!((rat[0] - 0.0243729).abs() < 1e-7);
    close(rat[1], result.diffuse_reflectance.standard_error, 0.237544, 1e-6);
    close(rat[2], result.absorbed.standard_error, 0.641594, 1e-6);
    close(rat[3], result.transmitted.standard_error, 0.0964896, 1e-6);
    for (i, published) in [0.2612, 0.1488, 0.2316].into_iter().enumerate() {
        close(section(&text, "A_l")[i], result.absorbed_by_layer[i].standard_error, published, 1e-4);
    }
    let depth = section(&text, "A_z");
    for (i, published) in [(0, 2.7990), (10, 2.0549), (19, 0.95971), (20, 1.7314), (39, 0.83724)] {
        close(depth[i], result.absorption.by_depth[i].standard_error, published, 1e-4);
    }
    let (reflected, transmitted) = (section(&text, "Rd_r"), section(&text, "Tt_r"));
    for (i, r, t) in
        [(0, 30.924, 0.58942), (1, 10.071, 0.60085), (20, 0.37759, 0.21004), (40, 0.045503, 0.036332)]
    {
        close(reflected[i], result.reflected.by_radius[i].standard_error, r, 1e-3 * r);
        close(transmitted[i], result.leaving_below.by_radius[i].standard_error, t, 1e-3 * t);
    }
    // The last ring holds what is beyond.
    let ring = run.grid.ring_area(49);
    close(reflected[49], result.reflected.beyond.standard_error / ring, 0.31424, 1e-4);
    close(transmitted[49], result.leaving_below.beyond.standard_error / ring, 0.33392, 1e-4);
    // One bin of angles, whose solid angle is that of its middle.
    close(section(&text, "Rd_a")[0], result.diffuse_reflectance.standard_error / 6.98, 0.034038, 1e-6);
    close(section(&text, "Tt_a")[0], result.transmitted.standard_error / 6.98, 0.013826, 1e-6);
    // A[0][0], A[0][1] and A[1][0] of A_rz.
    let absorbed = section(&text, "A_rz");
    let inside = &result.absorption.by_depth_and_radius;
    for (i, cell, published) in [(0, 0, 3294.8), (1, 50, 3038.6), (40, 1, 77.127)] {
        close(absorbed[i], inside[cell].standard_error, published, 1e-3 * published);
    }
}

/// Every section sums to its total, the last cells holding what lies beyond; digits are those of the format.
#[test]
fn every_section_sums_to_its_total() {
    let run = &good()[0];
    for source in [Source::Pencil { cosine: 1.0 }, Source::Pencil { cosine: 0.4 }, Source::Diffuse] {
        let result = simulate(run, source);
        let text = mco(run, &result);
        let grid = run.grid;
        let angle_step = std::f64::consts::FRAC_PI_2 / grid.angular as f64;
        let middle = |i: usize| (i as f64 + 0.5) * angle_step;
        let solid_angle = |i: usize| std::f64::consts::TAU * middle(i).sin() * angle_step;
        let [_, reflected, absorbed, transmitted] = section(&text, "RAT")[..] else { panic!("{text}") };
        let sum = |name: &str, count: usize, measure: &dyn Fn(usize) -> f64, total: f64| {
            let values = section(&text, name);
            assert_eq!(values.len(), count, "{name}");
            let sum: f64 = values.iter().enumerate().map(|(i, value)| value * measure(i)).sum();
            // Five digits are written.
            assert!((sum - total).abs() <= 0.6e-4 * total + 1e-7, "{name}: {sum} of {total}");
        };
        sum("A_l", 2, &|_| 1.0, absorbed);
        sum("A_z", grid.depth, &|_| grid.depth_step, absorbed);
        let volume = |i: usize| grid.ring_area(i / grid.depth) * grid.depth_step;
        sum("A_rz", grid.depth * grid.radial, &volume, absorbed);
        for (name, total) in [("Rd", reflected), ("Tt", transmitted)] {
            sum(&format!("{name}_r"), grid.radial, &|i| grid.ring_area(i), total);
            sum(&format!("{name}_a"), grid.angular, &solid_angle, total);
            let cell = |i: usize| {
                let (ring, angle) = (i / grid.angular, i % grid.angular);
                grid.ring_area(ring) * grid.solid_angle(angle) * middle(angle).cos()
            };
            sum(&format!("{name}_ra"), grid.radial * grid.angular, &cell, total);
        }
    }
}

/// The unscattered beam straight down is in the first ring and the first bin of angles.
#[test]
fn the_unscattered_beam_is_on_the_axis() {
    let clear = EXAMPLE.replace("200000", "1000").replace("100 0.90", "0 0").replace("10 0", "0 0");
    let run = &parse_mci(&clear).unwrap()[0];
    let result = simulate(run, Source::Pencil { cosine: 1.0 });
    let text = mco(run, &result);
    let rings = section(&text, "Tt_r");
    assert!((rings[0] * run.grid.ring_area(0) / result.transmitted.value - 1.0).abs() < 1e-4);
    assert!(rings[1..].iter().all(|&ring| ring == 0.0));
    assert!(result.leaving_below.by_radius.iter().all(|ring| ring.value == 0.0));
}

/// The input that an output repeats is the input it was made from.
#[test]
fn the_output_repeats_the_input() {
    for run in good() {
        let text = mco(&run, &simulate(&run, Source::Diffuse));
        let input: Vec<&str> = text.lines().skip_while(|line| !line.starts_with("InParm")).skip(1).collect();
        let end = input.iter().position(|line| line.starts_with("RAT")).unwrap();
        let again = parse_mci(&format!("1.0\n1\n{}", input[..end].join("\n"))).unwrap();
        assert_eq!(again.len(), 1);
        assert_eq!(again[0], MciRun { line: again[0].line, ..run });
    }
}

#[test]
fn the_table_has_a_row_for_each_estimate() {
    let run = &good()[0];
    let result = simulate(run, Source::Pencil { cosine: 1.0 });
    let mut bytes = Vec::new();
    write_csv(&mut bytes, &result).unwrap();
    let text = String::from_utf8(bytes).unwrap();
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    assert!(rows.iter().all(|row| row.len() == 11), "{text}");
    let header = &rows[0];
    assert_eq!((header[0], header[1], header[9], header[10]), ("quantity", "unit", "value", "stderr"));
    let (nr, nz, na) = (4, 3, 2);
    let count = |name: &str| rows.iter().filter(|row| row[0] == name).count();
    for name in ["reflected", "transmitted_scattered"] {
        assert_eq!(count(name), nr + 1 + na + (nr + 1) * na);
    }
    assert_eq!(count("reflected_single_scattering"), nr);
    assert_eq!(count("fluence"), nz + 1 + (nz + 1) * (nr + 1));
    assert_eq!(count("absorbed"), nz + 1 + (nz + 1) * (nr + 1) + 1 + 2);
    let row = rows.iter().find(|row| row[0] == "diffuse_reflectance").unwrap();
    assert_eq!(row[9].parse::<f64>().unwrap(), result.diffuse_reflectance.value);
    assert_eq!(row[10].parse::<f64>().unwrap(), result.diffuse_reflectance.standard_error);
}

#[test]
fn the_sample_in_the_repository_is_read() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/skin.mci");
    let runs = alabaster::slab::read_mci(&path).unwrap();
    assert_eq!((runs.len(), runs[0].stack.layers().len()), (1, 2));
}
