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

/// Seconds that all threads of this program have been running on processors, those that have ended included; to a hundredth.
/// Where the system does not tell, seconds of the wall clock.
pub fn process_seconds() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    process_ticks().map_or_else(|| START.elapsed().as_secs_f64(), |ticks| ticks as f64 * 1e-2)
}

/// The 14th and 15th field of `stat`: time in the program and in the system for it, in ticks of 1/100 s (Linux, proc(5)).
fn process_ticks() -> Option<u64> {
    let stat = fs::read_to_string("/proc/self/stat").ok()?;
    // The name, the second field, may contain blanks; it ends with the last bracket.
    let mut fields = stat[stat.rfind(')')? + 1..].split_whitespace().skip(11);
    Some(fields.next()?.parse::<u64>().ok()? + fields.next()?.parse::<u64>().ok()?)
}

/// First number of `schedstat`: time spent on the processor, ns (Linux, Documentation/scheduler/sched-stats).
fn scheduled_nanoseconds() -> Option<u64> {
    let statistics = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    statistics.split_whitespace().next()?.parse().ok()
}
