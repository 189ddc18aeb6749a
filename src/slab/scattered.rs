//! The estimates of everything that is counted in a slab.

use super::estimate::Estimate;
use super::tally::{Grid, Pieces, TOTALS, Total};

/// Light that left through one face, per photon sent in.
#[derive(Clone, Debug, PartialEq)]
pub struct Leaving {
    /// By ring, per area; the unscattered beam is not in it.
    pub by_radius: Vec<Estimate>,
    /// By angular bin, per solid angle (1/sr).
    pub by_angle: Vec<Estimate>,
    /// By ring and, within it, angular bin, per area and solid angle.
    pub by_radius_and_angle: Vec<Estimate>,
    /// What left beyond the last ring.
    pub beyond: Estimate,
    /// The same by angular bin.
    pub beyond_by_angle: Vec<Estimate>,
}

/// A quantity inside, per photon sent in.
#[derive(Clone, Debug, PartialEq)]
pub struct Inside {
    /// By sheet, integrated over the plane, per depth.
    pub by_depth: Vec<Estimate>,
    /// By sheet and, within it, ring, per volume.
    pub by_depth_and_radius: Vec<Estimate>,
    /// What lies below the last sheet, at any radius.
    pub below: Estimate,
    /// The same by ring; the last entry lies beyond the last ring.
    pub below_by_radius: Vec<Estimate>,
    /// What lies beyond the last ring, by sheet.
    pub outside_by_depth: Vec<Estimate>,
}

/// Everything that was estimated, per photon sent in.
#[derive(Clone, Debug, PartialEq)]
pub struct Scattered {
    /// The bins.
    pub grid: Grid,
    /// Reflected before any layer that absorbs or scatters was met.
    pub specular: Estimate,
    /// Left at the top otherwise.
    pub diffuse_reflectance: Estimate,
    /// The part of it that collided once.
    pub single_scattering_reflectance: Estimate,
    /// Left at the bottom, the unscattered beam included.
    pub transmitted: Estimate,
    /// The part of it that did not collide.
    pub unscattered_transmittance: Estimate,
    /// The part of it that collided once.
    pub single_scattering_transmittance: Estimate,
    /// Absorbed.
    pub absorbed: Estimate,
    /// Absorbed, by layer.
    pub absorbed_by_layer: Vec<Estimate>,
    /// Specular, diffuse reflectance, transmitted and absorbed together: 1, but for what roulette takes and gives.
    pub accounted: Estimate,
    /// Mean number of collisions of a photon (an analog one: the weights that collided, added up).
    pub collisions_per_photon: Estimate,
    /// Mean length of the way of what left at the top, times its share; divide by the share for the mean.
    pub reflected_path_length: Estimate,
    /// The same at the bottom.
    pub transmitted_path_length: Estimate,
    /// What left at the top.
    pub reflected: Leaving,
    /// By ring, per area: what left at the top after one collision.
    pub single_by_radius: Vec<Estimate>,
    /// What left at the bottom, without the unscattered beam.
    pub leaving_below: Leaving,
    /// The unscattered beam at the bottom, as shares: [ring, one more for what is beyond the last][angular bin].
    pub unscattered_below: Vec<Estimate>,
    /// Absorbed light; by depth 1/length, by depth and radius 1/length³.
    pub absorption: Inside,
    /// Fluence; by depth without unit, by depth and radius 1/length².
    pub fluence: Inside,
}

/// Takes the estimates apart in the order in which `Tally::sums` put the sums together.
struct Reader<'a> {
    rest: &'a [Estimate],
}

impl Reader<'_> {
    fn take(&mut self, count: usize) -> Vec<Estimate> {
        let (taken, rest) = self.rest.split_at(count.min(self.rest.len()));
        self.rest = rest;
        let mut taken = taken.to_vec();
        // Nothing was estimated: no packet was walked.
        taken.resize(count, Estimate::default());
        taken
    }

    /// `count` estimates and one more.
    fn take_with_beyond(&mut self, count: usize) -> (Vec<Estimate>, Estimate) {
        let mut taken = self.take(count + 1);
        let beyond = taken.pop().unwrap_or_default();
        (taken, beyond)
    }

    fn leaving(&mut self, grid: &Grid) -> Leaving {
        let per_area = |i: usize| 1.0 / grid.ring_area(i);
        let per_angle = |i: usize| 1.0 / grid.solid_angle(i);
        let (by_radius, beyond) = self.take_with_beyond(grid.radial);
        let by_angle = self.take(grid.angular);
        let mut cells = self.take((grid.radial + 1) * grid.angular);
        let beyond_by_angle = cells.split_off(grid.radial * grid.angular);
        let cell = |i: usize| per_area(i / grid.angular) * per_angle(i % grid.angular);
        Leaving {
            by_radius: scaled(by_radius, per_area),
            by_angle: scaled(by_angle, per_angle),
            by_radius_and_angle: scaled(cells, cell),
            beyond,
            beyond_by_angle,
        }
    }

    fn inside(&mut self, grid: &Grid) -> Inside {
        let (by_depth, below) = self.take_with_beyond(grid.depth);
        let mut rows = self.take((grid.depth + 1) * (grid.radial + 1));
        let below_by_radius = rows.split_off(grid.depth * (grid.radial + 1));
        let rows = || rows.chunks(grid.radial + 1);
        let cells = rows().flat_map(|row| &row[..grid.radial]).copied().collect();
        let per_depth = 1.0 / grid.depth_step;
        Inside {
            by_depth: scaled(by_depth, |_| per_depth),
            by_depth_and_radius: scaled(cells, |i| per_depth / grid.ring_area(i % grid.radial)),
            below,
            below_by_radius,
            outside_by_depth: rows().map(|row| row[grid.radial]).collect(),
        }
    }
}

fn scaled(estimates: Vec<Estimate>, factor: impl Fn(usize) -> f64) -> Vec<Estimate> {
    estimates.into_iter().enumerate().map(|(i, estimate)| estimate * factor(i)).collect()
}

impl Scattered {
    /// From the estimates of the sums of a [`Tally`](super::tally::Tally).
    pub fn new(pieces: &Pieces, estimates: &[Estimate]) -> Self {
        let grid = pieces.grid();
        let mut reader = Reader { rest: estimates };
        let totals = reader.take(TOTALS);
        let total = |which: Total| totals[which as usize];
        let absorbed_by_layer = reader.take(pieces.layers());
        let reflected = reader.leaving(&grid);
        let leaving_below = reader.leaving(&grid);
        let unscattered_below = reader.take((grid.radial + 1) * grid.angular);
        let (single, _) = reader.take_with_beyond(grid.radial);
        let absorption = reader.inside(&grid);
        let fluence = reader.inside(&grid);
        Self {
            grid,
            specular: total(Total::Specular),
            diffuse_reflectance: total(Total::Diffuse),
            single_scattering_reflectance: total(Total::SingleDiffuse),
            transmitted: total(Total::Transmitted),
            unscattered_transmittance: total(Total::Unscattered),
            single_scattering_transmittance: total(Total::SingleTransmitted),
            absorbed: total(Total::Absorbed),
            absorbed_by_layer,
            accounted: total(Total::Accounted),
            collisions_per_photon: total(Total::Collisions),
            reflected_path_length: total(Total::DiffusePath),
            transmitted_path_length: total(Total::TransmittedPath),
            reflected,
            single_by_radius: scaled(single, |i| 1.0 / grid.ring_area(i)),
            leaving_below,
            unscattered_below,
            absorption,
            fluence,
        }
    }
}
