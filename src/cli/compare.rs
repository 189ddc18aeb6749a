//! `alabaster compare`.

use std::path::{Path, PathBuf};

use clap::Args;

use super::choice::not_negative;
use super::compare_report;
use super::console::{print_line, say};
use super::error::CliError;
use crate::film::exr::{self, PictureFile};
use crate::film::output::{Format, check_writable, replace};
use crate::film::png;
use crate::study::image::flip::{Flip, flip};
use crate::study::image::heat_map::{Scale, errors};
use crate::study::image::overlap::{crop, overlap};
use crate::study::image::{Comparison, Estimate, compare, legend};

/// Arguments of `compare`.
#[derive(Args)]
pub struct CompareArgs {
    /// Picture to judge, .exr
    a: PathBuf,
    /// Reference, .exr, of the same size
    b: PathBuf,
    /// Fail, with exit code 1, if relMSE is larger than this
    #[arg(long, value_name = "X", value_parser = not_negative, allow_negative_numbers = true)]
    max_relmse: Option<f64>,
    /// Write a picture, .png, of the relative squared error of each pixel
    #[arg(long, value_name = "FILE")]
    heat_map: Option<PathBuf>,
    /// Leave out HDR-FLIP, which takes most of the time
    #[arg(long)]
    no_flip: bool,
    /// Print nothing but warnings and errors
    #[arg(long)]
    quiet: bool,
    /// Print what was found as JSON on standard output
    #[arg(long)]
    json: bool,
}

/// Compares two pictures, and says what was found.
pub fn run(args: &CompareArgs) -> Result<(), CliError> {
    if let Some(path) = &args.heat_map {
        check_heat_map(path)?;
    }
    let (a, b) = read_both(&args.a, &args.b)?;
    let found = compare(&a, &b).map_err(|problem| {
        CliError::input(format!("{} and {}: {problem}", args.a.display(), args.b.display()))
    })?;
    warn_of_nonfinite(args, &found);
    let flip = if args.no_flip { None } else { flip_or_say(&a, &b) };
    let scale = args.heat_map.as_ref().map(|path| write_heat_map(path, &a, &b)).transpose()?;
    if args.json {
        print_line(&compare_report::json(&found, flip.as_ref(), scale).to_string())?;
    } else if !args.quiet {
        let heading = format!("{} against {}", args.a.display(), args.b.display());
        print_line(&compare_report::table(&heading, &found, flip.as_ref()))?;
    }
    check_limit(args.max_relmse, &found)
}

fn check_heat_map(path: &Path) -> Result<(), CliError> {
    if Format::of(path)? != Format::Png {
        return Err(CliError::input(format!("{}: a heat map is written as .png", path.display())));
    }
    Ok(check_writable(path)?)
}

/// The pixels that both files have of the same frame.
fn read_both(path_a: &Path, path_b: &Path) -> Result<(Estimate, Estimate), CliError> {
    let read = |path: &Path| {
        exr::read(path).map_err(|error| CliError::input(format!("{}: {error}", path.display())))
    };
    let (a, b) = (read(path_a)?, read(path_b)?);
    if a.frame != b.frame {
        let size = |file: &PictureFile| format!("{} × {} pixels", file.frame[0], file.frame[1]);
        return Err(CliError::input(format!(
            "{} is a picture of {}, {} of {}; render one of them again at the size of the other",
            path_a.display(),
            size(&a),
            path_b.display(),
            size(&b),
        )));
    }
    let Some(part) = overlap(&a, &b) else {
        return Err(CliError::input(format!(
            "{} and {} show different parts of a frame (their data windows do not meet); there is nothing to compare",
            path_a.display(),
            path_b.display(),
        )));
    };
    let whole = |file: &PictureFile| part.size == [file.picture.width, file.picture.height];
    if !whole(&a) || !whole(&b) {
        let ([width, height], [x, y]) = (part.size, part.position);
        say(&format!(
            "warning: the files hold different parts of their frame; only what both have is compared, {width} × {height} pixels from column {x}, row {y}"
        ));
    }
    Ok((crop(a, part), crop(b, part)))
}

fn warn_of_nonfinite(args: &CompareArgs, found: &Comparison) {
    for (path, count) in [(&args.a, found.nonfinite_a), (&args.b, found.nonfinite_b)] {
        if count > 0 {
            say(&format!(
                "warning: {}: {count} pixels are not finite; they are left out of every number",
                path.display()
            ));
        }
    }
}

/// FLIP is not to be had of every pair; the other numbers are.
fn flip_or_say(a: &Estimate, b: &Estimate) -> Option<Flip> {
    flip(&a.picture, &b.picture).map_err(|problem| say(&format!("warning: no FLIP: {problem}"))).ok()
}

fn write_heat_map(path: &Path, a: &Estimate, b: &Estimate) -> Result<Scale, CliError> {
    let errors = errors(&a.picture, &b.picture);
    let scale = Scale::of(&errors);
    let bitmap = legend::draw(&errors, a.picture.width as usize, scale);
    let size = [bitmap.width, bitmap.height].map(|length| length as u32);
    replace(path, |file| png::write_srgb(file, size, bitmap.pixels.as_flattened()))?;
    let [low, high] = scale.ends();
    say(&format!(
        "{}: relative squared error from {low:e} (dark) to {high:e} (yellow), logarithmic; what is not finite is magenta",
        path.display()
    ));
    Ok(scale)
}

fn check_limit(limit: Option<f64>, found: &Comparison) -> Result<(), CliError> {
    match limit {
        Some(limit) if found.relmse > limit => {
            Err(CliError::Failed(format!("relMSE {:.6e} is above --max-relmse {limit:e}", found.relmse)))
        }
        _ => Ok(()),
    }
}
