//! How many samples to take next, and when to stop.
//!
//! Samples are taken in passes over the whole film. The first passes double what is there (1, 1, 2,
//! 4, … samples), so that a picture and an error estimate exist early; later ones are bounded in
//! time. Since accumulation is exact, the picture does not depend on how the passes were cut.

use super::accumulator::MAX_SAMPLES;

/// Longest pass, seconds, as far as one sample per pixel permits.
const MAX_PASS_SECONDS: f64 = 5.0;

/// Fewest samples per pixel before an error estimate is believed: with fewer, a pixel that has met
/// no light yet passes for one without noise.
const MIN_SAMPLES_FOR_ERROR: u64 = 16;

/// When to stop: at whichever comes first.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// Samples per pixel.
    pub samples: Option<u64>,
    /// Seconds.
    pub seconds: Option<f64>,
    /// Estimated relative error, see [`super::Film::relative_error`].
    pub relative_error: Option<f64>,
}

/// What has been done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Status {
    /// Samples per pixel.
    pub samples: u64,
    /// Seconds spent on them.
    pub seconds: f64,
    /// Estimated relative error; infinite while unknown.
    pub relative_error: f64,
}

impl Limits {
    /// Samples per pixel of the next pass; `None`: a limit is reached. The first pass is always of
    /// one sample, so that there is a picture.
    pub fn next_pass(&self, status: &Status) -> Option<u64> {
        let most = self.samples.unwrap_or(MAX_SAMPLES).min(MAX_SAMPLES);
        if status.samples == 0 {
            return (most > 0).then_some(1);
        }
        let missing = most.saturating_sub(status.samples);
        let seconds_left = self.seconds.map_or(f64::INFINITY, |limit| limit - status.seconds);
        let more_for_error = self.samples_until_error(status);
        if missing == 0 || seconds_left <= 0.0 || more_for_error == 0 {
            return None;
        }
        let samples_per_second = status.samples as f64 / status.seconds.max(1e-9);
        let in_time = (seconds_left.min(MAX_PASS_SECONDS) * samples_per_second) as u64;
        Some(status.samples.min(missing).min(more_for_error).min(in_time).max(1))
    }

    /// Samples per pixel still wanted for the error limit, if the error falls as 1/√samples.
    fn samples_until_error(&self, status: &Status) -> u64 {
        let Some(limit) = self.relative_error else { return u64::MAX };
        if status.samples < MIN_SAMPLES_FOR_ERROR {
            return MIN_SAMPLES_FOR_ERROR - status.samples;
        }
        let factor = (status.relative_error / limit).powi(2);
        if factor <= 1.0 { 0 } else { ((factor - 1.0) * status.samples as f64).ceil() as u64 }
    }

    /// Share of the work that is done, in [0, 1], by the limit that seems to come first.
    pub fn fraction(&self, status: &Status) -> f64 {
        let samples = self.samples.map_or(0.0, |limit| status.samples as f64 / limit.max(1) as f64);
        let seconds = self.seconds.map_or(0.0, |limit| status.seconds / limit);
        let error = self.relative_error.map_or(0.0, |limit| (limit / status.relative_error).powi(2));
        samples.max(seconds).max(error).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sample counts after each pass of a renderer that takes `seconds_per_sample` and whose error is 1/√samples.
    fn run(limits: Limits, seconds_per_sample: f64) -> Vec<u64> {
        let mut counts = vec![];
        let mut status = Status { samples: 0, seconds: 0.0, relative_error: f64::INFINITY };
        while let Some(pass) = limits.next_pass(&status) {
            status.samples += pass;
            status.seconds += pass as f64 * seconds_per_sample;
            status.relative_error = 1.0 / (status.samples as f64).sqrt();
            counts.push(status.samples);
        }
        counts
    }

    #[test]
    fn samples_double_up_to_the_limit() {
        let limits = Limits { samples: Some(50), ..Limits::default() };
        assert_eq!(run(limits, 1e-6), [1, 2, 4, 8, 16, 32, 50]);
    }

    #[test]
    fn passes_are_bounded_in_time() {
        let limits = Limits { samples: Some(16), ..Limits::default() };
        assert_eq!(run(limits, 2.0), [1, 2, 4, 6, 8, 10, 12, 14, 16]);
    }

    #[test]
    fn time_is_filled_but_the_first_pass_always_done() {
        let limits = Limits { seconds: Some(8.5), ..Limits::default() };
        assert_eq!(run(limits, 1.0), [1, 2, 4, 8, 9]);
        assert_eq!(run(limits, 100.0), [1]);
    }

    #[test]
    fn error_stops_as_soon_as_it_is_reached() {
        let limits = Limits { relative_error: Some(0.1), ..Limits::default() };
        // 1/√100, but √ rounds: one sample more is allowed for.
        assert!(matches!(run(limits, 1e-6).last(), Some(100 | 101)));
        let easy = Limits { relative_error: Some(10.0), ..Limits::default() };
        assert_eq!(run(easy, 1e-6).last(), Some(&MIN_SAMPLES_FOR_ERROR));
    }

    #[test]
    fn whichever_limit_comes_first() {
        let limits = Limits { samples: Some(40), seconds: Some(1e9), relative_error: Some(0.1) };
        assert_eq!(run(limits, 1e-6).last(), Some(&40));
        let status = Status { samples: 10, seconds: 5e8, relative_error: 1.0 };
        assert_eq!(limits.fraction(&status), 0.5);
    }
}
