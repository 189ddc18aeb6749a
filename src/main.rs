//! The `alabaster` command.

fn main() -> std::process::ExitCode {
    alabaster::cli::main()
}
