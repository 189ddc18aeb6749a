//! Distances on a grid: from the centre of each cell to the nearest cell that is marked.
//!
//! By axes (Felzenszwalb and Huttenlocher 2012, "Distance Transforms of Sampled Functions"), in time that is linear
//! in the number of cells. The distance is to the marked *cell*, not to its centre: along one axis to the interval of a cell,
//! which is to the nearer of its ends, or 0 in it.

use rayon::prelude::*;

/// The squares of the distances, in edges of a cell, by cell: x fastest, z slowest, `counts` cells along each. Infinite
/// if no cell is marked. Exact if no count is above 1024.
pub fn squared_distances(marked: &[bool], counts: [usize; 3]) -> Vec<f32> {
    let [nx, ny, nz] = counts;
    let at = |x: usize, y: usize, z: usize| (z * ny + y) * nx + x;
    // Each pass writes its lines one after another, so that threads share nothing, and reads across.
    let along_z =
        lines(nz, nx * ny, |line, z| if marked[at(line % nx, line / nx, z)] { 0.0 } else { f32::INFINITY });
    let along_y = lines(ny, nx * nz, |line, y| along_z[(y * nx + line % nx) * nz + line / nx]);
    lines(nx, ny * nz, |line, x| along_y[(line / ny * nx + x) * ny + line % ny])
}

/// `count` lines of `length`, each transformed from its values `value(line, place)`.
fn lines(length: usize, count: usize, value: impl Fn(usize, usize) -> f32 + Sync) -> Vec<f32> {
    let mut distances = vec![0.0; length * count];
    distances.par_chunks_mut(length).enumerate().for_each_init(Envelope::default, |envelope, (line, out)| {
        for (place, x) in out.iter_mut().enumerate() {
            *x = value(line, place);
        }
        envelope.transform(out);
    });
    distances
}

/// The lower envelope of parabolas s + (x − p)², at the ends p of the cells.
#[derive(Default)]
struct Envelope {
    /// Parabolas by place p, with their s, each with the place from which on it is the lowest.
    parabolas: Vec<(f32, f32, f32)>,
}

impl Envelope {
    /// From squared distances to marked cells of the same line alone, plus `line`, to the least of them.
    fn transform(&mut self, line: &mut [f32]) {
        self.parabolas.clear();
        let mut before = f32::INFINITY;
        for (end, &value) in line.iter().chain([&f32::INFINITY]).enumerate() {
            self.add(end as f32, before.min(value));
            before = value;
        }
        let mut lowest = 0;
        for (cell, value) in line.iter_mut().enumerate() {
            let center = cell as f32 + 0.5;
            while lowest + 1 < self.parabolas.len() && self.parabolas[lowest + 1].2 <= center {
                lowest += 1;
            }
            if let Some((place, offset, _)) = self.parabolas.get(lowest) {
                *value = value.min(offset + (center - place) * (center - place));
            }
        }
    }

    fn add(&mut self, place: f32, offset: f32) {
        if offset == f32::INFINITY {
            return;
        }
        let mut from = f32::NEG_INFINITY;
        while let Some(&(other, its, since)) = self.parabolas.last() {
            from = 0.5 * ((offset - its) / (place - other) + place + other);
            if from > since {
                break;
            }
            self.parabolas.pop();
            from = f32::NEG_INFINITY;
        }
        self.parabolas.push((place, offset, from));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sampler::HashGenerator;

    #[test]
    fn distances_are_those_to_the_nearest_marked_cell() {
        let mut random = HashGenerator::new(1);
        for (counts, share) in [([7, 5, 9], 0.02), ([16, 16, 16], 0.002), ([1, 30, 4], 0.1), ([5, 5, 5], 0.5)]
        {
            let [nx, ny, nz] = counts;
            let cells: Vec<[usize; 3]> =
                (0..nz).flat_map(|z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z]))).collect();
            let marked: Vec<bool> = cells.iter().map(|_| random.next_f32() < share).collect();
            let found = squared_distances(&marked, counts);
            for (cell, found) in cells.iter().zip(found) {
                let to = |other: &[usize; 3]| -> f32 {
                    let gap = |axis: usize| (cell[axis].abs_diff(other[axis]) as f32 - 0.5).max(0.0);
                    (0..3).map(|axis| gap(axis) * gap(axis)).sum()
                };
                let marked = cells.iter().zip(&marked).filter(|(_, marked)| **marked);
                let exact = marked.map(|(other, _)| to(other)).fold(f32::INFINITY, f32::min);
                assert_eq!(found, exact, "{counts:?} {cell:?}");
            }
        }
    }
}
