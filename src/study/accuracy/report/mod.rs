//! The report: one HTML file that needs nothing else.

mod figures;
mod pictures;
mod sections;

use super::advice::advice;
use super::results::Results;
use crate::study::numbers::{seconds_in_words, two_digits};
use crate::study::plot::PlotError;
use pictures::PictureError;

use thiserror::Error;

/// Why a report cannot be made.
#[derive(Debug, Error)]
pub enum ReportError {
    /// A chart cannot be drawn.
    #[error("a chart cannot be drawn: {0}")]
    Plot(#[from] PlotError),
    /// A picture cannot be encoded.
    #[error(transparent)]
    Picture(#[from] PictureError),
}

/// The report on a study of the scene called `title`. `complete`: nothing is missing.
///
/// # Errors
/// See [`ReportError`].
pub fn html(results: &Results, title: &str, complete: bool) -> Result<String, ReportError> {
    let title = escaped(title);
    let body = [
        sections::answers(&advice(results), &results.warnings, complete),
        sections::wipe(results)?,
        sections::curves(results)?,
        sections::tables(results),
        sections::maps(results)?,
        sections::effects(results),
        sections::collisions(results),
        sections::method(results),
    ];
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>What accuracy costs: {title}</title>\n<link rel=\"icon\" href=\"data:,\">\n<style>\n{}</style>\n</head>\n<body>\n<main>\n\
         <h1>What accuracy costs in time: {title}</h1>\n<p class=\"facts\">{}</p>\n{}\n</main>\n<script>\n{}</script>\n</body>\n</html>\n",
        include_str!("report.css"),
        escaped(&facts(results)),
        body.concat(),
        include_str!("report.js"),
    ))
}

/// The charts of the error over time, as files of their own: names and contents (SVG), of the whole picture and of each material.
///
/// # Errors
/// See [`ReportError`].
pub fn charts(results: &Results) -> Result<Vec<(String, String)>, ReportError> {
    let chart = |region: usize| {
        let svg = sections::error_chart(results, region)?;
        let name = match region {
            0 => "error.svg".into(),
            _ => format!("error-{}.svg", file_name(&results.regions[region].name)),
        };
        Ok((name, svg))
    };
    results.reported_regions().map(chart).collect()
}

/// What may be part of the name of a file anywhere.
fn file_name(text: &str) -> String {
    text.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect()
}

fn facts(results: &Results) -> String {
    let settings = &results.plan.settings;
    format!(
        "{} × {} pixels, {} threads, {}, alabaster {}. {} independent runs a method. Reference: {}, {} samples a pixel in {}; its own noise, {} %, is subtracted.",
        settings.width,
        settings.height,
        settings.threads,
        settings.backend,
        settings.version,
        settings.seeds,
        results.reference.candidate.name(),
        results.reference.spp,
        seconds_in_words(results.reference.seconds),
        two_digits(100.0 * results.reference.noise[0].sqrt()),
    )
}

/// Text for HTML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
