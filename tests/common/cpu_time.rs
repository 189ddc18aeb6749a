//! Processor time, which other programs on the same machine disturb less than the wall clock.

use std::fs;
use std::sync::LazyLock;
use std::time::Instant;

/// Seconds that the calling thread has been running on a processor. Where the system does not tell
/// (it does on Linux), seconds of the wall clock instead; only differences mean anything.
pub fn thread_seconds() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    scheduled_nanoseconds().map_or_else(|| START.elapsed().as_secs_f64(), |ns| ns as f64 * 1e-9)
}

/// First number of `schedstat`: time spent on the processor, ns (Linux, Documentation/scheduler/sched-stats).
fn scheduled_nanoseconds() -> Option<u64> {
    let statistics = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    statistics.split_whitespace().next()?.parse().ok()
}
