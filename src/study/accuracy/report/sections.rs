//! The sections of the report.

use super::super::jackknife::SIGMAS;
use super::super::maps;
use super::super::parts::SAMPLING_SECONDS;
use super::super::plan::PARTS_OF_HALF;
use super::super::results::{CandidateResult, ErrorPart, PartKind, Results};
use super::super::tables::{COLUMNS, bias, cells, time_of_effect, with_error};
use super::{ReportError, escaped, figures, pictures};
use crate::study::numbers::{percent, seconds_in_words, two_digits};
use crate::study::plot::{Style, chart};

/// What to use.
pub fn answers(advice: &[String], warnings: &[String], complete: bool) -> String {
    let list = |sentences: &[String]| -> String {
        sentences.iter().map(|sentence| format!("<li>{}</li>", escaped(sentence))).collect()
    };
    let missing = if complete {
        ""
    } else {
        "<p class=\"warning\">The study is not finished: call it again with the same settings and it goes on.</p>"
    };
    let warned = if warnings.is_empty() {
        String::new()
    } else {
        format!("<h3>Before you rely on it</h3><ul class=\"warning\">{}</ul>", list(warnings))
    };
    format!(
        "<section id=\"answers\"><h2>What to use</h2>{missing}<ul class=\"advice\">{}</ul>{warned}</section>\n",
        list(advice)
    )
}

/// Reference and candidate on top of each other, and a slider.
pub fn wipe(results: &Results) -> Result<String, ReportError> {
    let reference = pictures::shown(&results.reference.picture)?;
    let mut options = String::new();
    let mut stock = String::new();
    for result in &results.candidates {
        let name = result.candidate.name();
        options.push_str(&format!("<option>{name}</option>"));
        let picture = pictures::shown(&result.picture)?;
        stock.push_str(&format!("<img data-name=\"{name}\" src=\"{picture}\" alt=\"\">"));
    }
    let first = results.candidates.first().map_or_else(String::new, |first| first.candidate.name());
    Ok(format!(
        "<section id=\"pictures\"><h2>Side by side</h2>\n\
         <p>Left of the line the reference, right of it the mean of all runs of <select id=\"wipe-choice\" aria-label=\"method\">{options}</select></p>\n\
         <div class=\"wipe\" id=\"wipe\"><img src=\"{reference}\" alt=\"reference\"><img id=\"wipe-over\" alt=\"{first}\"><span></span></div>\n\
         <input id=\"wipe-at\" type=\"range\" min=\"0\" max=\"100\" value=\"50\" aria-label=\"where the line is\">\n\
         <div id=\"stock\" hidden>{stock}</div></section>\n"
    ))
}

/// Error over time, and time over error.
pub fn curves(results: &Results) -> Result<String, ReportError> {
    let mut content = String::new();
    for r in results.reported_regions() {
        for panel in [figures::error_over_time(results, r), figures::time_over_error(results, r)] {
            content.push_str(&format!("<figure class=\"plot\">{}</figure>\n", chart(&panel)?));
        }
    }
    let legend: String = results.candidates.iter().map(legend_entry).collect();
    Ok(format!(
        "<section id=\"curves\"><h2>Error and time</h2>\n\
         <p>Dots are measured, with 95 % bars; lines are √(B² + V/T), on beyond what was measured. A line that levels off has reached its bias: more time does not help. \
         The second chart reads the other way round: how long an error takes.</p>\n\
         <ul class=\"legend\">{legend}</ul>\n<div class=\"plots\">{content}</div></section>\n"
    ))
}

/// Error over time in one region.
pub fn error_chart(results: &Results, region: usize) -> Result<String, ReportError> {
    Ok(chart(&figures::error_over_time(results, region))?)
}

fn legend_entry(result: &CandidateResult) -> String {
    let Style { color: [r, g, b], dashes } = result.candidate.style();
    format!(
        "<li><svg width=\"40\" height=\"8\" aria-hidden=\"true\"><line x1=\"0\" y1=\"4\" x2=\"40\" y2=\"4\" stroke=\"#{r:02x}{g:02x}{b:02x}\" stroke-width=\"3\" stroke-dasharray=\"{dashes}\"/></svg>{}</li>",
        result.candidate.name()
    )
}

/// The figures of every candidate.
pub fn tables(results: &Results) -> String {
    let mut content = String::new();
    for r in results.reported_regions() {
        let region = &results.regions[r];
        let head: Vec<String> = COLUMNS.map(String::from).to_vec();
        let rows = results.candidates.iter().map(|result| cells(result, &result.by_region[r]).to_vec());
        content.push_str(&format!("<h3>{}, {} pixels</h3>", escaped(&region.name), region.pixels.len()));
        content.push_str(&table(&head, rows));
    }
    let checks = results.candidates.iter().map(|result| {
        let region = &result.by_region[0];
        vec![
            result.candidate.name(),
            format!(
                "{:.3e} ± {:.1e}",
                region.bias_squared.value,
                SIGMAS * region.bias_squared.standard_error
            ),
            format!("{:.3e} ± {:.1e}", region.fitted[0].value, SIGMAS * region.fitted[0].standard_error),
            format!(
                "{:.3e} ± {:.1e}",
                region.variance_seconds.value,
                SIGMAS * region.variance_seconds.standard_error
            ),
            format!("{:.3e} ± {:.1e}", region.fitted[1].value, SIGMAS * region.fitted[1].standard_error),
            if region.falls_as.is_finite() { format!("{:.2}", region.falls_as) } else { "–".into() },
            percent(result.firefly_share),
            format!("{} × {} spp, {}", result.runs, result.spp, seconds_in_words(result.seconds)),
        ]
    });
    let head = [
        "method",
        "B²",
        "B² fitted",
        "V [s]",
        "V fitted [s]",
        "noise falls as 1/T^",
        "noise in noisiest 0.1 %",
        "runs",
    ];
    format!(
        "<section id=\"tables\"><h2>The figures</h2>{content}\n\
         <p>B is the bias, the error that stays however long one renders; noise after 1 s is √V. Efficiency is 1/V. \"Walk better after\" is the time T* = (V<sub>walk</sub> − V)/B² \
         after which the random walk has the smaller error. Setup is once per picture and in none of the times. A tail index below 2 means that rare bright samples decide. ± and ranges hold 95 %.</p>\n\
         <details><summary>Checks: the same by another way, whole picture</summary>{}\
         <p>B² and V come from the spread of the runs and their mean; \"fitted\" are those of the curve through the dots. Where noise falls faster than 1/T (evenly spread samples), V is that of the longest runs.</p></details></section>\n",
        table(&head.map(String::from), checks)
    )
}

fn table(head: &[String], rows: impl Iterator<Item = Vec<String>>) -> String {
    let cell = |tag: &str, text: &String| format!("<{tag}>{}</{tag}>", escaped(text));
    let heading: String = head.iter().map(|text| cell("th", text)).collect();
    let body: String = rows
        .map(|row| {
            let cells: String = row.iter().map(|text| cell("td", text)).collect();
            format!("<tr>{cells}</tr>")
        })
        .collect();
    format!(
        "<div class=\"scroll\"><table><thead><tr>{heading}</tr></thead><tbody>{body}</tbody></table></div>\n"
    )
}

/// Where each part of the error is.
pub fn maps(results: &Results) -> Result<String, ReportError> {
    let mut content = String::new();
    for (kind, explanation) in [
        (PartKind::Geometry, "The profile is exact on a plane; what is left is that the body is none."),
        (PartKind::Profile, "A model's profile in place of the exact one of a plane."),
        (PartKind::Direction, "What the direction changes in which light enters."),
        (PartKind::Sampling, "Noise in equal time, one standard deviation."),
    ] {
        let parts: Vec<&ErrorPart> = results.parts.iter().filter(|part| part.kind == kind).collect();
        if !parts.is_empty() {
            content.push_str(&format!("<h3>{}</h3><p>{explanation}</p>", kind.name()));
            content.push_str(&maps_of_kind(results, kind, &parts)?);
        }
    }
    Ok(format!(
        "<section id=\"maps\"><h2>Where the error is</h2>\
         <p>The error is taken apart by exchanging one approximation at a time. Maps show the relative error of each pixel, (a − b)/√(r² + 0.01), mean of the channels; \
         their own noise is in them, but not in the numbers below them.</p>\n{content}</section>\n",
    ))
}

fn maps_of_kind(results: &Results, kind: PartKind, parts: &[&ErrorPart]) -> Result<String, ReportError> {
    let size = [results.reference.picture.width, results.reference.picture.height];
    let scale = maps::scale(parts.iter().map(|part| &part.map));
    let end = percent(scale);
    let mut content = if kind == PartKind::Sampling {
        format!(
            "<p class=\"scale\"><span>0</span><i class=\"sequential\"></i><span>{end}</span> <em>after {SAMPLING_SECONDS:.0} s</em></p>"
        )
    } else {
        format!(
            "<p class=\"scale\"><span>−{end}</span><i class=\"diverging\"></i><span>+{end}</span> <em>blue too dark, red too bright</em></p>"
        )
    };
    content.push_str("<div class=\"maps\">");
    for part in parts {
        let (pixels, rms) = if kind == PartKind::Sampling {
            (maps::unsigned(&part.map, scale), percent(part.square.value.max(0.0).sqrt()))
        } else {
            (maps::signed(&part.map, scale), format!("{} %", bias(part.square)))
        };
        content.push_str(&format!(
            "<figure><img src=\"{}\" alt=\"\"><figcaption>{}<br>{rms} rms on translucent bodies</figcaption></figure>",
            pictures::map(size, &pixels)?,
            escaped(&part.title),
        ));
    }
    content.push_str("</div>");
    Ok(content)
}

/// What effects cost, and what they are worth.
pub fn effects(results: &Results) -> String {
    if results.effects.is_empty() {
        return String::new();
    }
    let rows = results.effects.iter().map(|effect| {
        let [with, without] = effect.seconds;
        let saved = with - without;
        let mut cells = vec![
            effect.effect.name().into(),
            effect.effect.in_words().into(),
            format!("{} ({})", time_of_effect(effect.seconds), seconds_saved(saved)),
            bias(effect.square),
        ];
        cells.extend(
            effect.bias.map(|bias| with_error(100.0 * bias.value, SIGMAS * 100.0 * bias.standard_error)),
        );
        cells
    });
    let head = ["off", "what is done instead", "time", "rms error [%]", "bias red [%]", "green", "blue"];
    format!(
        "<section id=\"effects\"><h2>What effects cost, and what they are worth</h2>\
         <p>The scene with one effect off, by the method of the reference, {} samples a pixel each. Errors are those on translucent bodies.</p>{}</section>\n",
        results.effects[0].spp,
        table(&head.map(String::from), rows)
    )
}

fn seconds_saved(saved: f64) -> String {
    if saved >= 0.0 {
        format!("{} s saved", two_digits(saved))
    } else {
        format!("{} s more", two_digits(-saved))
    }
}

/// How many collisions a walk is expected to have.
pub fn collisions(results: &Results) -> String {
    if results.collisions.is_empty() {
        return String::new();
    }
    let rows = results.collisions.iter().map(|expected| {
        let free_path = expected.mean_free_path.map(|l| two_digits(1e3 * l)).join(" ");
        let count = |n: Option<f64>| n.map_or_else(|| "∞".into(), two_digits);
        vec![expected.material.clone(), free_path, expected.collisions.map(count).join(" ")]
    });
    let measured = results.reference.collisions.map_or_else(String::new, |count| {
        format!(
            "<p>Measured: {} collisions for each sample of a pixel that shows a translucent body. (A part of the light is reflected before it enters; a part enters again; \
             and the walk follows all three channels at once, weighting what is absorbed, and is guided to where light leaves if that pays.)</p>",
            two_digits(count)
        )
    });
    let head = ["material", "mean free path R G B [mm]", "collisions of a photon that enters, R G B"]
        .map(String::from);
    format!(
        "<section id=\"collisions\"><h2>Why the walk costs what it costs</h2>\
         <p>Each collision absorbs a share 1 − ω of the light, so a photon has P(absorbed)/(1 − ω) of them in the mean, whatever the body; here P is that of a thick flat one, thin ones have fewer.</p>{}{measured}</section>\n",
        table(&head, rows)
    )
}

/// How it was done.
pub fn method(results: &Results) -> String {
    let settings = &results.plan.settings;
    format!(
        "<section id=\"method\"><h2>How it was done</h2>\
         <p>Errors are relMSE, the mean of (a − r)²/(r² + 0.01) over pixels and channels, against a reference r of two independent halves, each of {PARTS_OF_HALF} parts. \
         The noise of each half is known from its parts and subtracted, and each half is weighted by the other, so that noise of the reference does not pass for error. Of the mean ā of {} runs with variance s², \
         the square of its error less s²/{} is the bias alone, and s² is the noise. Intervals come from leaving out one run after another (jackknife), that of B² also from the noise of the reference. \
         Candidates took turns, so what else the machine did fell on all alike. Times are those of rendering, on {} threads, at {} × {} pixels; they grow in proportion to the pixels.</p>\
         <p>Beside this file: <code>data.csv</code> (every point of every run), <code>summary.json</code>, and the mean pictures as <code>.exr</code> with their variance, for <code>alabaster compare</code>.</p></section>\n",
        settings.seeds, settings.seeds, settings.threads, settings.width, settings.height
    )
}
