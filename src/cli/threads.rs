//! The threads that do the work.

use super::error::CliError;

/// Starts so many threads; `None`: as many as the machine has.
pub fn start_threads(threads: Option<u16>) -> Result<(), CliError> {
    rayon::ThreadPoolBuilder::new()
        // 0: as many as the machine has.
        .num_threads(threads.unwrap_or(0).into())
        .build_global()
        .map_err(|error| CliError::machine(format!("threads cannot be started: {error}")))
}
