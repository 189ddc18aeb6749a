//! Writes the output files of MCML, `.mco` (Wang, Jacques and Zheng 1995), as its version 1.2 does:
//! the same sections in the same order, line for line, and the same conventions:
//!
//! - the last cell of a grid holds what lies beyond it too: the last ring what is outside, the last sheet what is below;
//! - transmittance includes the unscattered beam, where it leaves: at r = 0, α = 0 for a beam straight down;
//! - by radius and angle light is divided by the area that it sees, that of the ring times cos α;
//! - the solid angle of an angular bin is 2π sin α Δα at its middle in `Rd_a` and `Tt_a`, and exact in `Rd_ra`
//!   and `Tt_ra`.
//!
//! One thing differs: absorption by layer is counted in the layers themselves, not made of the sheets whose middle is in them.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::io::{self, Write};
use std::path::Path;

use super::estimate::Estimate;
use super::layers::{Layer, LayerStack};
use super::scattered::{Inside, Leaving, Scattered};
use super::tally::Grid;
use super::walk::Source;

/// Values on a line of a two-dimensional array.
const VALUES_PER_LINE: usize = 5;

/// What the file says about how it came to be.
#[derive(Clone, Copy, Debug)]
pub struct Header<'a> {
    /// Name of the output file in the input file.
    pub output: &'a Path,
    /// Photon packets that were walked.
    pub photons: u64,
    /// Seconds that it took.
    pub seconds: f64,
    /// Seed of the random numbers.
    pub seed: u64,
    /// How light entered.
    pub source: Source,
}

/// Writes `result`, the light scattered by `stack`, whose lengths are centimetres.
///
/// # Errors
/// If `out` cannot be written to.
pub fn write_mco(
    out: &mut impl Write,
    header: &Header,
    stack: &LayerStack,
    result: &Scattered,
) -> io::Result<()> {
    write_header(out, header)?;
    write_input(out, header, stack, &result.grid)?;
    write_totals(out, result)?;
    let grid = &result.grid;
    let absorbed = absorbed_cells(grid, &result.absorption);
    let reflected = leaving_cells(grid, &result.reflected, &[]);
    let transmitted = leaving_cells(grid, &result.leaving_below, &result.unscattered_below);

    write_list(out, "A_l # absorbed, by layer [-]", result.absorbed_by_layer.iter().map(|a| a.value))?;
    let by_depth = columns(&absorbed, grid.depth).map(|sum| sum / grid.depth_step);
    write_list(out, "A_z # absorbed, by depth, nz values [1/cm]", by_depth)?;
    for (cells, name, what) in
        [(&reflected, "Rd", "reflected diffusely"), (&transmitted, "Tt", "transmitted")]
    {
        let by_radius = rows(cells, grid.angular).enumerate().map(|(i, sum)| sum / grid.ring_area(i));
        write_list(out, &format!("{name}_r # {what}, by radius, nr values [1/cm2]"), by_radius)?;
        let by_angle =
            columns(cells, grid.angular).enumerate().map(|(i, sum)| sum / middle_solid_angle(grid, i));
        write_list(out, &format!("{name}_a # {what}, by angle, na values [1/sr]"), by_angle)?;
    }

    let volume = |i: usize| grid.ring_area(i / grid.depth) * grid.depth_step;
    write_array(out, "absorbed, by radius and depth [1/cm3]", "nz", "A_rz", &absorbed, volume)?;
    let seen = |i: usize| {
        let (ring, angle) = (i / grid.angular, i % grid.angular);
        grid.ring_area(ring) * middle(grid, angle).cos() * grid.solid_angle(angle)
    };
    for (cells, name, what) in
        [(&reflected, "Rd_ra", "reflected diffusely"), (&transmitted, "Tt_ra", "transmitted")]
    {
        write_array(out, &format!("{what}, by radius and angle [1/(cm2 sr)]"), "na", name, cells, seen)?;
    }
    Ok(())
}

fn write_header(out: &mut impl Write, header: &Header) -> io::Result<()> {
    write!(out, "A1 \t# version of the format\n\n####\n")?;
    write!(out, "# Sections, in this order:\n# InParm, RAT,\n")?;
    write!(out, "# A_l, A_z, Rd_r, Rd_a, Tt_r, Tt_a,\n# A_rz, Rd_ra, Tt_ra\n####\n\n")?;
    let Header { seconds, seed, .. } = header;
    let source = match header.source {
        Source::Pencil { cosine } => format!("pencil beam of cosine {cosine}"),
        Source::Diffuse => "diffuse light".into(),
    };
    write!(out, "# alabaster {}: {seconds:.2} s, seed {seed}, {source}\n\n", env!("CARGO_PKG_VERSION"))
}

fn write_input(out: &mut impl Write, header: &Header, stack: &LayerStack, grid: &Grid) -> io::Result<()> {
    let Grid { radial_step, radial, depth_step, depth, angular } = grid;
    writeln!(out, "InParm \t# input; lengths in cm")?;
    writeln!(out, "{} \tA\t# output file, text", header.output.display())?;
    writeln!(out, "{} \t# photons", header.photons)?;
    writeln!(out, "{depth_step:?}\t{radial_step:?}\t# dz, dr [cm]")?;
    writeln!(out, "{depth}\t{radial}\t{angular}\t# nz, nr, na\n")?;
    writeln!(out, "{}\t# layers", stack.layers().len())?;
    writeln!(out, "#n\tmua\tmus\tg\td\t# a line for each layer")?;
    writeln!(out, "{:?}\t# n of the medium above", stack.ior_above())?;
    for (i, layer) in stack.layers().iter().enumerate() {
        let Layer { ior, sigma_a, sigma_s, g, thickness } = layer;
        writeln!(out, "{ior:?}\t{sigma_a:?}\t{sigma_s:?}\t{g:?}\t{thickness:?}\t# layer {}", i + 1)?;
    }
    writeln!(out, "{:?}\t# n of the medium below\n", stack.ior_below())
}

fn write_totals(out: &mut impl Write, result: &Scattered) -> io::Result<()> {
    writeln!(out, "RAT # reflected, absorbed, transmitted, ± standard error")?;
    let totals = [
        (result.specular, "specular reflectance"),
        (result.diffuse_reflectance, "diffuse reflectance"),
        (result.absorbed, "absorbed"),
        (result.transmitted, "transmittance"),
    ];
    for (total, name) in totals {
        writeln!(out, "{:<14.7} \t# {name} [-] ± {:.1e}", total.value, total.standard_error)?;
    }
    writeln!(out)
}

/// A section of one value a line.
fn write_list(out: &mut impl Write, title: &str, values: impl Iterator<Item = f64>) -> io::Result<()> {
    writeln!(out, "{title}")?;
    for value in values {
        writeln!(out, "{}", scientific(value))?;
    }
    writeln!(out)
}

/// A section of shares, each divided by its `measure`.
fn write_array(
    out: &mut impl Write,
    what: &str,
    columns: &str,
    name: &str,
    shares: &[f64],
    measure: impl Fn(usize) -> f64,
) -> io::Result<()> {
    writeln!(out, "# {what}\n# [0][0], [0][1], .. [0][{columns}-1]\n# [1][0], [1][1], .. [1][{columns}-1]")?;
    writeln!(out, "# ...\n# [nr-1][0], [nr-1][1], .. [nr-1][{columns}-1]\n{name}")?;
    for (i, share) in shares.iter().enumerate() {
        write!(out, "{} ", scientific(share / measure(i)))?;
        if (i + 1) % VALUES_PER_LINE == 0 {
            writeln!(out)?;
        }
    }
    writeln!(out)
}

/// As C writes it by `%12.4E`.
fn scientific(value: f64) -> String {
    let text = format!("{value:.4E}");
    let (digits, exponent) = text.split_once('E').unwrap_or((&text, "0"));
    let exponent: i32 = exponent.parse().unwrap_or_default();
    let sign = if exponent < 0 { '-' } else { '+' };
    format!("{:>12}", format!("{digits}E{sign}{:02}", exponent.abs()))
}

/// Middle of an angular bin.
fn middle(grid: &Grid, angle: usize) -> f64 {
    (angle as f64 + 0.5) * FRAC_PI_2 / grid.angular as f64
}

/// Solid angle of an angular bin by the midpoint rule.
fn middle_solid_angle(grid: &Grid, angle: usize) -> f64 {
    TAU * middle(grid, angle).sin() * FRAC_PI_2 / grid.angular as f64
}

/// Shares absorbed, [ring][sheet], the last of each with what lies beyond.
fn absorbed_cells(grid: &Grid, inside: &Inside) -> Vec<f64> {
    let Grid { radial, depth, .. } = *grid;
    let mut cells = vec![0.0; radial * depth];
    let index = |ring: usize, sheet: usize| ring.min(radial - 1) * depth + sheet.min(depth - 1);
    for (i, density) in inside.by_depth_and_radius.iter().enumerate() {
        let (sheet, ring) = (i / radial, i % radial);
        cells[index(ring, sheet)] += density.value * grid.ring_area(ring) * grid.depth_step;
    }
    for (sheet, share) in inside.outside_by_depth.iter().enumerate() {
        cells[index(radial, sheet)] += share.value;
    }
    for (ring, share) in inside.below_by_radius.iter().enumerate() {
        cells[index(ring, depth)] += share.value;
    }
    cells
}

/// Shares that left, [ring][angle], the last ring with what lies beyond, and with what is `unscattered`.
fn leaving_cells(grid: &Grid, leaving: &Leaving, unscattered: &[Estimate]) -> Vec<f64> {
    let Grid { radial, angular, .. } = *grid;
    let densities = leaving.by_radius_and_angle.iter().enumerate();
    let mut cells: Vec<f64> = densities
        .map(|(i, density)| density.value * grid.ring_area(i / angular) * grid.solid_angle(i % angular))
        .collect();
    let last = (radial - 1) * angular;
    for (cell, share) in cells[last..].iter_mut().zip(&leaving.beyond_by_angle) {
        *cell += share.value;
    }
    for (i, share) in unscattered.iter().enumerate() {
        cells[(i / angular).min(radial - 1) * angular + i % angular] += share.value;
    }
    cells
}

fn rows(cells: &[f64], columns: usize) -> impl Iterator<Item = f64> {
    cells.chunks(columns).map(|row| row.iter().sum())
}

fn columns(cells: &[f64], columns: usize) -> impl Iterator<Item = f64> {
    (0..columns).map(move |column| cells.iter().skip(column).step_by(columns).sum())
}
