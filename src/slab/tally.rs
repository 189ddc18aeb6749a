//! What is counted in a slab: reflectance and transmittance by radius and angle, absorption and fluence by
//! depth and radius, path lengths, collisions.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::estimate::Scores;
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

    /// The bins.
    pub fn grid(&self) -> Grid {
        self.grid
    }

    /// Number of layers.
    pub fn layers(&self) -> usize {
        self.constants.len()
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
pub(super) enum Total {
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
    Accounted,
}

pub(super) const TOTALS: usize = 11;

/// Counts of one batch.
#[derive(Clone, Debug)]
pub struct Tally<'a> {
    pieces: &'a Pieces,
    totals: [f64; TOTALS],
    /// [ring, overflow included][angle], ring-major: what left at the top, and at the bottom.
    reflected: Vec<f64>,
    transmitted: Vec<f64>,
    /// [ring, overflow included][angle]: what left at the bottom without a collision.
    unscattered: Vec<f64>,
    /// By ring: what left at the top after one collision.
    single: Vec<f64>,
    /// Weight that collided, by piece and, within it, ring, overflow included.
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
            unscattered: vec![0.0; (radial + 1) * angular],
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
                    0 => self.add(Total::Unscattered, weight),
                    1 => self.add(Total::SingleTransmitted, weight),
                    _ => {}
                }
                // The unscattered beam is a line, not a density: it is kept apart.
                let cells = if collisions > 0 { &mut self.transmitted } else { &mut self.unscattered };
                cells[cell] += weight;
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
        let fates = [Total::Specular, Total::Diffuse, Total::Transmitted, Total::Absorbed];
        totals[Total::Accounted as usize] = fates.map(|fate| totals[fate as usize]).iter().sum();
        let mut sums = totals.to_vec();
        sums.extend(layer_absorbed);
        for cells in [&self.reflected, &self.transmitted] {
            sums.extend(cells.chunks(grid.angular).map(|row| row.iter().sum::<f64>()));
            sums.extend(column_sums(cells, grid.angular));
            sums.extend(cells);
        }
        sums.extend(&self.unscattered);
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
