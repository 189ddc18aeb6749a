//! Standard output for results, standard error for everything else.

use std::io::{self, Write};

use super::error::CliError;
use crate::scene::error::printable;

/// Writes a result to standard output. A reader that has gone away (`| head`) is no error.
pub fn print_line(line: &str) -> Result<(), CliError> {
    match writeln!(io::stdout(), "{line}") {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(CliError::machine(format!("standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Writes a line to standard error, without what a terminal would obey. Where that is closed there is nobody to tell, and no reason to
/// give up the work.
pub fn say(line: &str) {
    let _ = writeln!(io::stderr(), "{}", printable(line));
}

/// Writes what is strange to standard error.
pub fn warn(warnings: &[String]) {
    warnings.iter().for_each(|warning| say(&format!("warning: {warning}")));
}
