//! What a study found, as tables for people, and as CSV for programs.

use std::fmt::Write;

use super::advice::{WANTED, advice};
use super::crossover::Crossover;
use super::jackknife::SIGMAS;
use super::results::{CandidateResult, RegionResult, Results};
use super::store::Store;
use crate::slab::Estimate;
use crate::study::numbers::{seconds_in_words, significant, two_digits};

/// Columns of the table of candidates.
pub const COLUMNS: [&str; 8] = [
    "method",
    "bias B [%]",
    "noise after 1 s [%]",
    "time to 1 %",
    "walk better after",
    "efficiency 1/V [1/s]",
    "setup [s]",
    "tail index",
];

/// The cells of a candidate in a region, in the order of [`COLUMNS`].
pub fn cells(result: &CandidateResult, region: &RegionResult) -> [String; 8] {
    let noise = root(region.variance_seconds);
    let time = region.curve().seconds_until(WANTED * WANTED);
    let efficiency = 1.0 / region.variance_seconds.value;
    let relative = region.variance_seconds.standard_error / region.variance_seconds.value;
    [
        result.candidate.name(),
        bias(region.bias_squared),
        with_error(100.0 * noise.value, SIGMAS * 100.0 * noise.standard_error),
        time.map_or_else(|| "never".into(), seconds_in_words),
        walk_better_after(region.crossover.as_ref()),
        with_error(efficiency, SIGMAS * efficiency * relative),
        two_digits(result.setup_seconds),
        result.tail.map_or_else(|| "–".into(), |tail| format!("{:.1}", tail.index)),
    ]
}

/// √x with its standard error, for x well above 0.
fn root(x: Estimate) -> Estimate {
    let value = x.value.max(0.0).sqrt();
    Estimate { value, standard_error: if value > 0.0 { 0.5 * x.standard_error / value } else { 0.0 } }
}

/// The root of B² in percent with its 95 % interval; an upper limit where it is not told from 0.
pub fn bias(square: Estimate) -> String {
    let half = SIGMAS * square.standard_error;
    let [low, high] = [square.value - half, square.value.max(0.0) + half].map(|x| 100.0 * x.max(0.0).sqrt());
    if low == 0.0 {
        return format!("< {}", two_digits(high));
    }
    with_error(100.0 * square.value.sqrt(), 0.5 * (high - low))
}

/// A value and half its interval, with as many digits as that has meaning.
pub fn with_error(value: f64, half: f64) -> String {
    if !half.is_finite() || half <= 0.0 {
        return significant(value);
    }
    let digits = (1.0 - half.log10().floor()).clamp(0.0, 12.0) as usize;
    format!("{value:.digits$} ± {half:.digits$}")
}

/// When the walk is the better buy, in words.
pub fn walk_better_after(crossover: Option<&Crossover>) -> String {
    match crossover {
        None => "–".into(),
        Some(Crossover::Always) => "always".into(),
        Some(Crossover::Never { not_before }) => {
            format!("no bias found (not before {})", seconds_in_words(*not_before))
        }
        Some(Crossover::At { seconds, interval }) => {
            let high = interval.high;
            let high = if high.is_finite() { seconds_in_words(high) } else { "∞".into() };
            format!("{} ({} to {high})", seconds_in_words(*seconds), seconds_in_words(interval.low))
        }
    }
}

/// All of it for a terminal.
pub fn text(results: &Results) -> String {
    let mut text = String::new();
    let settings = &results.plan.settings;
    // Writing to a string does not fail.
    let _ = writeln!(
        text,
        "{} × {} pixels, {} threads, {}; reference {}, {} spp in {}, its noise {} %",
        settings.width,
        settings.height,
        settings.threads,
        settings.backend,
        results.reference.candidate.name(),
        results.reference.spp,
        seconds_in_words(results.reference.seconds),
        two_digits(100.0 * results.reference.noise[0].sqrt()),
    );
    for r in results.reported_regions() {
        let region = &results.regions[r];
        let _ = writeln!(
            text,
            "\n{}, {} pixels: relMSE after T seconds is B² + V/T",
            region.name,
            region.pixels.len()
        );
        let mut rows = vec![COLUMNS.map(String::from)];
        rows.extend(results.candidates.iter().map(|result| cells(result, &result.by_region[r])));
        text.push_str(&aligned(&rows));
    }
    if !results.effects.is_empty() {
        let _ = writeln!(text, "\nwithout an effect, at equal samples, on translucent bodies");
        let mut rows = vec![["effect off", "time", "rms error [%]", "bias R G B [%]"].map(String::from)];
        rows.extend(results.effects.iter().map(|effect| {
            [
                effect.effect.name().into(),
                time_of_effect(effect.seconds),
                bias(effect.square),
                effect.bias.map(|bias| format!("{:+.1}", 100.0 * bias.value)).join(" "),
            ]
        }));
        text.push_str(&aligned(&rows));
    }
    text.push_str("\n± and ranges hold 95 %\n\n");
    advice(results).iter().for_each(|sentence| text.push_str(&format!("{sentence}\n")));
    text.trim_end().into()
}

/// How the time changes, in words.
pub fn time_of_effect([with, without]: [f64; 2]) -> String {
    format!("{:+.0} %", 100.0 * (without / with - 1.0))
}

fn aligned<const N: usize>(rows: &[[String; N]]) -> String {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let line = |row: &[String; N]| {
        let cells = row.iter().enumerate().map(|(c, cell)| {
            let pad = width(c) - cell.chars().count();
            format!("{cell}{}", " ".repeat(pad + 2))
        });
        format!("{}\n", cells.collect::<String>().trim_end())
    };
    rows.iter().map(line).collect()
}

/// Every point of every run.
pub fn csv(results: &Results, store: &Store) -> String {
    let mut csv = String::from("region,method,profile,run,seed,spp,seconds,relmse\n");
    for result in &results.candidates {
        let name = result.candidate.name();
        for run in 0..results.plan.settings.seeds {
            let Some(done) = store.run(&name, run) else { continue };
            for point in &done.record.points {
                for (region, relmse) in results.regions.iter().zip(&point.relmse) {
                    let _ = writeln!(
                        csv,
                        "{},{},{},{run},{},{},{:.6},{relmse:e}",
                        quoted(&region.name),
                        result.candidate.method_name(),
                        result.candidate.profile_name().unwrap_or(""),
                        done.record.seed,
                        point.spp,
                        point.seconds,
                    );
                }
            }
        }
    }
    csv
}

/// A field of a CSV file (RFC 4180).
fn quoted(text: &str) -> String {
    if text.contains(['"', ',', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_have_the_digits_that_mean_something() {
        assert_eq!(with_error(12.3456, 0.123), "12.35 ± 0.12");
        assert_eq!(with_error(1234.5, 56.0), "1234 ± 56");
        let estimate = |value, standard_error| Estimate { value, standard_error };
        assert_eq!(bias(estimate(4e-4, 1e-5)), "2.000 ± 0.049");
        // √(1e-6 + 1.96·2e-6).
        assert_eq!(bias(estimate(1e-6, 2e-6)), "< 0.22");
        // √(1.96·2e-6): noise below 0 is no knowledge.
        assert_eq!(bias(estimate(-9e-6, 2e-6)), "< 0.2");
    }

    #[test]
    fn names_with_commas_stay_one_field() {
        assert_eq!(quoted("a, \"b\""), "\"a, \"\"b\"\"\"");
        assert_eq!(quoted("wax"), "wax");
    }

    #[test]
    fn columns_stand_below_each_other() {
        let rows = [["a".to_string(), "µm".into()], ["long".into(), "x".into()]];
        assert_eq!(aligned(&rows), "a     µm\nlong  x\n");
    }
}
