//! Writes everything that was estimated as one long table of comma-separated values.
//!
//! A row is one estimate: what it is, its unit, the layer or the bin that it belongs to, its value and its standard error
//! (one σ). Edges of bins are empty where a quantity is not divided that way, and infinite beyond the last bin.

use std::f64::consts::FRAC_PI_2;
use std::io::{self, Write};

use super::estimate::Estimate;
use super::scattered::{Inside, Leaving, Scattered};
use super::tally::Grid;

/// Names of the columns.
const HEADER: &str =
    "quantity,unit,layer,r_min_cm,r_max_cm,z_min_cm,z_max_cm,angle_min_rad,angle_max_rad,value,stderr";

/// An interval, where a quantity is divided by it.
type Interval = Option<(f64, f64)>;

/// Where a row belongs.
#[derive(Clone, Copy, Default)]
struct Bin {
    /// From 1.
    layer: Option<usize>,
    radius: Interval,
    depth: Interval,
    angle: Interval,
}

struct Table<'a, W> {
    out: &'a mut W,
    grid: Grid,
}

/// Writes `result`, whose lengths are centimetres.
///
/// # Errors
/// If `out` cannot be written to.
pub fn write_csv(out: &mut impl Write, result: &Scattered) -> io::Result<()> {
    writeln!(out, "{HEADER}")?;
    let mut table = Table { out, grid: result.grid };
    table.totals(result)?;
    table.leaving("reflected", &result.reflected)?;
    table.by_radius("reflected_single_scattering", &result.single_by_radius)?;
    table.leaving("transmitted_scattered", &result.leaving_below)?;
    table.unscattered(&result.unscattered_below)?;
    table.inside("absorbed", ["1", "1/cm", "1/cm3"], &result.absorption)?;
    table.inside("fluence", ["cm", "1", "1/cm2"], &result.fluence)
}

impl<W: Write> Table<'_, W> {
    fn row(&mut self, quantity: &str, unit: &str, bin: Bin, estimate: &Estimate) -> io::Result<()> {
        write!(self.out, "{quantity},{unit},")?;
        if let Some(layer) = bin.layer {
            write!(self.out, "{layer}")?;
        }
        for interval in [bin.radius, bin.depth, bin.angle] {
            match interval {
                Some((low, high)) => write!(self.out, ",{low:?},{high:?}")?,
                None => write!(self.out, ",,")?,
            }
        }
        writeln!(self.out, ",{:?},{:?}", estimate.value, estimate.standard_error)
    }

    fn totals(&mut self, result: &Scattered) -> io::Result<()> {
        let totals = [
            ("specular", "1", result.specular),
            ("diffuse_reflectance", "1", result.diffuse_reflectance),
            ("single_scattering_reflectance", "1", result.single_scattering_reflectance),
            ("transmitted", "1", result.transmitted),
            ("unscattered_transmittance", "1", result.unscattered_transmittance),
            ("single_scattering_transmittance", "1", result.single_scattering_transmittance),
            ("absorbed", "1", result.absorbed),
            ("accounted", "1", result.accounted),
            ("collisions_per_photon", "1", result.collisions_per_photon),
            ("reflected_path_length", "cm", result.reflected_path_length),
            ("transmitted_path_length", "cm", result.transmitted_path_length),
        ];
        for (name, unit, total) in &totals {
            self.row(name, unit, Bin::default(), total)?;
        }
        for (i, absorbed) in result.absorbed_by_layer.iter().enumerate() {
            self.row("absorbed", "1", Bin { layer: Some(i + 1), ..Bin::default() }, absorbed)?;
        }
        Ok(())
    }

    fn by_radius(&mut self, name: &str, rings: &[Estimate]) -> io::Result<()> {
        for (i, density) in rings.iter().enumerate() {
            self.row(name, "1/cm2", Bin { radius: self.ring(i), ..Bin::default() }, density)?;
        }
        Ok(())
    }

    fn leaving(&mut self, name: &str, leaving: &Leaving) -> io::Result<()> {
        let Grid { radial, angular, .. } = self.grid;
        self.by_radius(name, &leaving.by_radius)?;
        self.row(name, "1", Bin { radius: self.ring(radial), ..Bin::default() }, &leaving.beyond)?;
        for (i, density) in leaving.by_angle.iter().enumerate() {
            self.row(name, "1/sr", Bin { angle: self.angle(i), ..Bin::default() }, density)?;
        }
        for (i, density) in leaving.by_radius_and_angle.iter().enumerate() {
            self.row(name, "1/(cm2 sr)", self.ring_and_angle(i / angular, i % angular), density)?;
        }
        for (i, share) in leaving.beyond_by_angle.iter().enumerate() {
            self.row(name, "1", self.ring_and_angle(radial, i), share)?;
        }
        Ok(())
    }

    /// Shares; a beam has no density. Cells that it does not meet are left out.
    fn unscattered(&mut self, cells: &[Estimate]) -> io::Result<()> {
        let angular = self.grid.angular;
        for (i, share) in cells.iter().enumerate().filter(|(_, share)| share.value != 0.0) {
            self.row("transmitted_unscattered", "1", self.ring_and_angle(i / angular, i % angular), share)?;
        }
        Ok(())
    }

    /// `units`: of a total, by depth, by depth and radius.
    fn inside(&mut self, name: &str, units: [&str; 3], inside: &Inside) -> io::Result<()> {
        let Grid { radial, depth, .. } = self.grid;
        let [total, by_depth, by_volume] = units;
        for (i, density) in inside.by_depth.iter().enumerate() {
            self.row(name, by_depth, Bin { depth: self.sheet(i), ..Bin::default() }, density)?;
        }
        self.row(name, total, Bin { depth: self.sheet(depth), ..Bin::default() }, &inside.below)?;
        for (i, density) in inside.by_depth_and_radius.iter().enumerate() {
            self.row(name, by_volume, self.sheet_and_ring(i / radial, i % radial), density)?;
        }
        for (i, share) in inside.outside_by_depth.iter().enumerate() {
            self.row(name, total, self.sheet_and_ring(i, radial), share)?;
        }
        for (i, share) in inside.below_by_radius.iter().enumerate() {
            self.row(name, total, self.sheet_and_ring(depth, i), share)?;
        }
        Ok(())
    }

    fn ring(&self, i: usize) -> Interval {
        interval(i, self.grid.radial, self.grid.radial_step)
    }

    fn sheet(&self, i: usize) -> Interval {
        interval(i, self.grid.depth, self.grid.depth_step)
    }

    fn angle(&self, i: usize) -> Interval {
        interval(i, usize::MAX, FRAC_PI_2 / self.grid.angular as f64)
    }

    fn ring_and_angle(&self, ring: usize, angle: usize) -> Bin {
        Bin { radius: self.ring(ring), angle: self.angle(angle), ..Bin::default() }
    }

    fn sheet_and_ring(&self, sheet: usize, ring: usize) -> Bin {
        Bin { radius: self.ring(ring), depth: self.sheet(sheet), ..Bin::default() }
    }
}

/// Bin `i` of `count`; the one after the last has no end.
fn interval(i: usize, count: usize, step: f64) -> Interval {
    let high = if i < count { (i + 1) as f64 * step } else { f64::INFINITY };
    Some((i as f64 * step, high))
}
