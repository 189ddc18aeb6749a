//! What is counted in a slab: reflectance and transmittance by radius and angle, absorption and fluence by
//! depth and radius, path lengths, collisions.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::estimate::{Estimate, Scores};
use super::layers::LayerStack;
use super::walk::{Face, Observer, Photon};

/// Bins: `radial` rings of width `radial_step`, `depth` sheets of thickness `depth_step`, and `angular`
/// bins between the normal and the surface. What lies beyond the last ring or sheet is counted apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Width of a ring, length.
    pub radial_step: f64,
    /// Number of rings.
    pub radial: usize,
    /// Thickness of a sheet, length.
    pub depth_step: f64,
    /// Number of sheets.
    pub depth: usize,
    /// Number of angular bins over [0, π/2].
    pub angular: usize,
}

impl Grid {
    /// Area of ring `i`.
    pub fn ring_area(&self, i: usize) -> f64 {
        PI * self.radial_step * self.radial_step * (2 * i + 1) as f64
    }

    /// Solid angle of angular bin `i`, sr.
    pub fn solid_angle(&self, i: usize) -> f64 {
        let step = FRAC_PI_2 / self.angular as f64;
        TAU * ((i as f64 * step).cos() - ((i + 1) as f64 * step).cos())
    }

    fn ring(&self, radius: f64) -> usize {
        ((radius / self.radial_step) as usize).min(self.radial)
    }

    fn sheet(&self, z: f64) -> usize {
        ((z / self.depth_step) as usize).min(self.depth)
    }

    fn angle(&self, cosine: f64) -> usize {
        let position = cosine.acos() * (self.angular as f64 / FRAC_PI_2);
        (position as usize).min(self.angular - 1)
    }
}

/// The part of a layer within one sheet, or below all sheets.
#[derive(Clone, Copy, Debug)]
struct Piece {
    layer: usize,
    sheet: usize,
}

/// The pieces into which layers and sheets cut a stack. Each lies in one layer, so absorption and fluence are
/// its collisions times a constant, and one number is enough for both.
#[derive(Clone, Debug)]
pub struct Pieces {
    grid: Grid,
    pieces: Vec<Piece>,
    /// By layer: index of its first piece, and the sheet that this is in.
    first: Vec<(usize, usize)>,
    /// By layer: absorbed share of a collision, and 1/σ_t.
    constants: Vec<(f64, f64)>,
}

impl Pieces {
    /// Cuts `stack` by the sheets of `grid`.
    pub fn new(stack: &LayerStack, grid: Grid) -> Self {
        let mut pieces = Vec::new();
        let mut first = Vec::new();
        let mut top = 0.0;
        for (layer, l) in stack.layers().iter().enumerate() {
            let bottom = top + l.thickness;
            let sheets = grid.sheet(top)..=grid.sheet(bottom);
            first.push((pieces.len(), *sheets.start()));
            pieces.extend(sheets.map(|sheet| Piece { layer, sheet }));
            top = bottom;
        }
        let constants = stack.layers().iter().map(|l| match l.sigma_t() {
            0.0 => (0.0, 0.0),
            sigma_t => (l.sigma_a / sigma_t, 1.0 / sigma_t),
        });
        Self { grid, pieces, first, constants: constants.collect() }
    }

    fn index(&self, layer: usize, z: f64) -> usize {
        let (first, sheet) = self.first[layer];
        // Rounding at the upper face may point to the sheet above.
        let last = self.first.get(layer + 1).map_or(self.pieces.len(), |next| next.0) - 1;
        (first + self.grid.sheet(z).saturating_sub(sheet)).min(last)
    }
}

/// Where single numbers stand in the sums.
#[derive(Clone, Copy)]
enum Total {
    Specular,
    Diffuse,
    SingleDiffuse,
    Transmitted,
    Unscattered,
    SingleTransmitted,
    Absorbed,
    Collisions,
    DiffusePath,
    TransmittedPath,
}

const TOTALS: usize = 10;

/// Counts of one batch.
#[derive(Clone, Debug)]
pub struct Tally<'a> {
    pieces: &'a Pieces,
    totals: [f64; TOTALS],
    /// [ring, overflow included][angle], ring-major: what left at the top, and at the bottom.
    reflected: Vec<f64>,
    transmitted: Vec<f64>,
    /// By ring: what left at the top after one collision.
    single: Vec<f64>,
    /// [piece][ring, overflow included]: weight that collided.
    collided: Vec<f64>,
}

impl<'a> Tally<'a> {
    /// An empty tally.
    pub fn new(pieces: &'a Pieces) -> Self {
        let Grid { radial, angular, .. } = pieces.grid;
        Self {
            pieces,
            totals: [0.0; TOTALS],
            reflected: vec![0.0; (radial + 1) * angular],
            transmitted: vec![0.0; (radial + 1) * angular],
            single: vec![0.0; radial + 1],
            collided: vec![0.0; pieces.pieces.len() * (radial + 1)],
        }
    }

    #[inline]
    fn add(&mut self, total: Total, amount: f64) {
        self.totals[total as usize] += amount;
    }
}

impl Observer for Tally<'_> {
    #[inline]
    fn collide(&mut self, photon: &Photon) {
        let grid = &self.pieces.grid;
        let ring = grid.ring(photon.radius_squared().sqrt());
        let piece = self.pieces.index(photon.layer, photon.position[2]);
        self.collided[piece * (grid.radial + 1) + ring] += photon.weight;
    }

    fn leave(&mut self, photon: &Photon, face: Face) {
        let grid = self.pieces.grid;
        let Photon { weight, collisions, path_length, direction, .. } = *photon;
        let ring = grid.ring(photon.radius_squared().sqrt());
        let cell = ring * grid.angular + grid.angle(direction[2].abs());
        match face {
            Face::Top if !photon.met_medium => self.add(Total::Specular, weight),
            Face::Top => {
                self.reflected[cell] += weight;
                self.add(Total::Diffuse, weight);
                self.add(Total::DiffusePath, weight * path_length);
                if collisions == 1 {
                    self.single[ring] += weight;
                    self.add(Total::SingleDiffuse, weight);
                }
            }
            Face::Bottom => {
                self.add(Total::Transmitted, weight);
                self.add(Total::TransmittedPath, weight * path_length);
                match collisions {
                    // The unscattered beam is a line, not a density.
                    0 => self.add(Total::Unscattered, weight),
                    1 => self.add(Total::SingleTransmitted, weight),
                    _ => {}
                }
                if collisions > 0 {
                    self.transmitted[cell] += weight;
                }
            }
        }
    }

    fn reflect_at_entry(&mut self, weight: f64, _cosine: f64) {
        self.add(Total::Specular, weight);
    }
}

impl Scores for Tally<'_> {
    fn sums(&self) -> Vec<f64> {
        let Pieces { grid, pieces, constants, .. } = self.pieces;
        let rings = grid.radial + 1;
        let mut layer_absorbed = vec![0.0; constants.len()];
        let mut absorbed = vec![0.0; (grid.depth + 1) * rings];
        let mut fluence = vec![0.0; (grid.depth + 1) * rings];
        let mut collisions = 0.0;
        for (piece, row) in pieces.iter().zip(self.collided.chunks(rings)) {
            let (absorbed_share, free_path) = constants[piece.layer];
            for (ring, weight) in row.iter().enumerate() {
                let cell = piece.sheet * rings + ring;
                absorbed[cell] += weight * absorbed_share;
                fluence[cell] += weight * free_path;
                layer_absorbed[piece.layer] += weight * absorbed_share;
                collisions += weight;
            }
        }
        let mut totals = self.totals;
        totals[Total::Absorbed as usize] = layer_absorbed.iter().sum();
        totals[Total::Collisions as usize] = collisions;
        let mut sums = totals.to_vec();
        sums.extend(layer_absorbed);
        for cells in [&self.reflected, &self.transmitted] {
            sums.extend(cells.chunks(grid.angular).map(|row| row.iter().sum::<f64>()));
            sums.extend(column_sums(cells, grid.angular));
            sums.extend(cells);
        }
        sums.extend(&self.single);
        for cells in [&absorbed, &fluence] {
            sums.extend(cells.chunks(rings).map(|row| row.iter().sum::<f64>()));
            sums.extend(cells);
        }
        sums
    }
}

fn column_sums(cells: &[f64], columns: usize) -> impl Iterator<Item = f64> {
    (0..columns).map(move |c| cells.iter().skip(c).step_by(columns).sum())
}

/// Light that left through one face, per photon sent in.
#[derive(Clone, Debug, PartialEq)]
pub struct Leaving {
    /// By ring, per area; the unscattered beam is not in it.
    pub by_radius: Vec<Estimate>,
    /// By angular bin, per solid angle (1/sr).
    pub by_angle: Vec<Estimate>,
    /// [ring][angular bin], per area and solid angle.
    pub by_radius_and_angle: Vec<Estimate>,
    /// What left beyond the last ring.
    pub beyond: Estimate,
}

/// A quantity inside, per photon sent in.
#[derive(Clone, Debug, PartialEq)]
pub struct Inside {
    /// By sheet, integrated over the plane, per depth.
    pub by_depth: Vec<Estimate>,
    /// [sheet][ring], per volume.
    pub by_depth_and_radius: Vec<Estimate>,
    /// What lies below the last sheet.
    pub beyond: Estimate,
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
    /// What left at the bottom.
    pub leaving_below: Leaving,
    /// Absorbed light; by depth 1/length, by depth and radius 1/length³.
    pub absorption: Inside,
    /// Fluence; by depth without unit, by depth and radius 1/length².
    pub fluence: Inside,
}

/// Takes the estimates apart in the order in which [`Tally::sums`] put the sums together.
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
        cells.truncate(grid.radial * grid.angular);
        let cell = |i: usize| per_area(i / grid.angular) * per_angle(i % grid.angular);
        Leaving {
            by_radius: scaled(by_radius, per_area),
            by_angle: scaled(by_angle, per_angle),
            by_radius_and_angle: scaled(cells, cell),
            beyond,
        }
    }

    fn inside(&mut self, grid: &Grid) -> Inside {
        let (by_depth, beyond) = self.take_with_beyond(grid.depth);
        let rows = self.take((grid.depth + 1) * (grid.radial + 1));
        let cells: Vec<Estimate> = rows
            .chunks(grid.radial + 1)
            .take(grid.depth)
            .flat_map(|row| &row[..grid.radial])
            .copied()
            .collect();
        let per_depth = 1.0 / grid.depth_step;
        Inside {
            by_depth: scaled(by_depth, |_| per_depth),
            by_depth_and_radius: scaled(cells, |i| per_depth / grid.ring_area(i % grid.radial)),
            beyond,
        }
    }
}

fn scaled(estimates: Vec<Estimate>, factor: impl Fn(usize) -> f64) -> Vec<Estimate> {
    estimates.into_iter().enumerate().map(|(i, estimate)| estimate * factor(i)).collect()
}

impl Scattered {
    /// From the estimates of [`Tally`]'s sums.
    pub fn new(pieces: &Pieces, estimates: &[Estimate]) -> Self {
        let grid = pieces.grid;
        let mut reader = Reader { rest: estimates };
        let totals = reader.take(TOTALS);
        let total = |which: Total| totals[which as usize];
        let absorbed_by_layer = reader.take(pieces.constants.len());
        let reflected = reader.leaving(&grid);
        let leaving_below = reader.leaving(&grid);
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
            collisions_per_photon: total(Total::Collisions),
            reflected_path_length: total(Total::DiffusePath),
            transmitted_path_length: total(Total::TransmittedPath),
            reflected,
            single_by_radius: scaled(single, |i| 1.0 / grid.ring_area(i)),
            leaving_below,
            absorption,
            fluence,
        }
    }
}
