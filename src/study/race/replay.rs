//! How fast rays are cast.

use std::time::Instant;

use rayon::prelude::*;

use super::Kind;
use super::record::Query;
use crate::raycast::{Hit, RayCaster};

/// Rays that a thread casts at a time.
const CHUNK: usize = 1 << 14;

/// Seconds that `caster` takes for all of `queries`, on this thread.
pub fn seconds(caster: &impl RayCaster, kind: Kind, queries: &[Query]) -> f64 {
    let start = Instant::now();
    std::hint::black_box(cast(caster, kind, queries));
    start.elapsed().as_secs_f64()
}

/// Seconds that `caster` takes for all of `queries`, on all threads.
pub fn seconds_on_all_threads(caster: &impl RayCaster, kind: Kind, queries: &[Query]) -> f64 {
    let start = Instant::now();
    let found: usize = queries.par_chunks(CHUNK).map(|chunk| cast(caster, kind, chunk)).sum();
    std::hint::black_box(found);
    start.elapsed().as_secs_f64()
}

/// How many hits there are.
fn cast(caster: &impl RayCaster, kind: Kind, queries: &[Query]) -> usize {
    let mut hits: Vec<Hit> = Vec::new();
    let count = |query: &Query| match kind {
        Kind::Camera | Kind::Bounce => usize::from(caster.closest(&query.ray).is_some()),
        Kind::Shadow => usize::from(caster.occluded(&query.ray)),
        Kind::Probe => {
            caster.all_hits(&query.ray, query.instance, &mut hits);
            hits.len()
        }
    };
    queries.iter().map(count).sum()
}

/// The median of some measurements, and how far from it half of them are at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// The median.
    pub median: f64,
    /// The median distance from it.
    pub deviation: f64,
}

impl Spread {
    /// Of `values`, of which there is at least one.
    pub fn of(values: &[f64]) -> Self {
        let median = median(values.to_vec());
        Self { median, deviation: self::median(values.iter().map(|value| (value - median).abs()).collect()) }
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() % 2 {
        _ if values.is_empty() => f64::NAN,
        1 => values[middle],
        _ => 0.5 * (values[middle - 1] + values[middle]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_all_lie_within_the_deviation() {
        let spread = Spread::of(&[1.0, 9.0, 2.0, 3.0, 2.5]);
        assert_eq!(spread, Spread { median: 2.5, deviation: 0.5 });
        assert_eq!(Spread::of(&[1.0, 3.0]), Spread { median: 2.0, deviation: 1.0 });
    }
}
