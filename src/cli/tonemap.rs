//! `alabaster tonemap`.

use std::path::PathBuf;

use clap::Args;

use super::choice::{ViewChoice, finite};
use super::error::CliError;
use crate::film::exr::read_picture;
use crate::film::output::{Format, check_writable, replace};
use crate::film::png;

/// Arguments of `tonemap`.
#[derive(Args)]
pub struct TonemapArgs {
    /// Picture to read, .exr
    input: PathBuf,
    /// Picture to write, .png
    output: PathBuf,
    /// How radiance is shown
    #[arg(long, value_enum, default_value_t)]
    view: ViewChoice,
    /// Exposure in EV: each one doubles
    #[arg(long, value_name = "EV", default_value_t = 0.0, value_parser = finite, allow_negative_numbers = true)]
    exposure: f32,
}

/// Writes a picture for people.
pub fn run(args: &TonemapArgs) -> Result<(), CliError> {
    if Format::of(&args.output)? != Format::Png {
        return Err(CliError::input(format!("{}: tonemap writes .png", args.output.display())));
    }
    check_writable(&args.output)?;
    let picture = read_picture(&args.input)
        .map_err(|error| CliError::input(format!("{}: {error}", args.input.display())))?;
    replace(&args.output, |file| png::write(file, &picture, args.view.into(), args.exposure))?;
    Ok(())
}
