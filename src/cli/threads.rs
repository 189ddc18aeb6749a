//! The threads that do the work.

use clap::Args;

use super::error::CliError;

/// How many threads.
#[derive(Args)]
pub struct ThreadArgs {
    /// Threads [default: as many as the machine has]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

impl ThreadArgs {
    /// Starts them.
    pub fn start(&self) -> Result<(), CliError> {
        rayon::ThreadPoolBuilder::new()
            // 0: as many as the machine has.
            .num_threads(self.threads.unwrap_or(0).into())
            .build_global()
            .map_err(|error| CliError::machine(format!("threads cannot be started: {error}")))
    }
}
