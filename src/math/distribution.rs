//! Tabulated distributions: discrete, and piecewise constant over the unit square.

/// A discrete distribution over 0..n in proportion to given weights.
#[derive(Clone, Debug, Default)]
pub struct Discrete {
    /// Running sums scaled to end at 1; empty if all weights are zero.
    cumulative: Vec<f32>,
}

impl Discrete {
    /// From weights, not negative and finite.
    pub fn new(weights: impl IntoIterator<Item = f32>) -> Self {
        let mut sum = 0.0_f64;
        let sums: Vec<f64> = weights
            .into_iter()
            .map(|w| {
                sum += f64::from(w);
                sum
            })
            .collect();
        if sum <= 0.0 {
            return Self::default();
        }
        Self { cumulative: sums.into_iter().map(|s| (s / sum) as f32).collect() }
    }

    /// True if nothing can be drawn.
    pub fn is_empty(&self) -> bool {
        self.cumulative.is_empty()
    }

    /// Probability of `index`.
    pub fn probability(&self, index: usize) -> f32 {
        let below = if index == 0 { 0.0 } else { self.cumulative[index - 1] };
        self.cumulative[index] - below
    }

    /// Draws an index with `u` in [0, 1); also returns its probability and `u` rescaled to [0, 1)
    /// within it, to be used again.
    pub fn sample(&self, u: f32) -> Option<(usize, f32, f32)> {
        let last = self.cumulative.len().checked_sub(1)?;
        let index = self.cumulative.partition_point(|&c| c <= u).min(last);
        let below = if index == 0 { 0.0 } else { self.cumulative[index - 1] };
        let probability = self.cumulative[index] - below;
        if probability <= 0.0 {
            return None;
        }
        Some((index, probability, ((u - below) / probability).clamp(0.0, 1.0 - f32::EPSILON / 2.0)))
    }
}

/// A density over the unit square, constant in each cell of a grid.
#[derive(Clone, Debug)]
pub struct Piecewise2d {
    width: usize,
    height: usize,
    rows: Discrete,
    columns: Vec<Discrete>,
}

impl Piecewise2d {
    /// From row-major weights, not negative and finite.
    pub fn new(width: usize, height: usize, weights: &[f32]) -> Self {
        let sums =
            weights.chunks_exact(width).map(|row| row.iter().map(|&w| f64::from(w)).sum::<f64>() as f32);
        let columns = weights.chunks_exact(width).map(|row| Discrete::new(row.iter().copied())).collect();
        Self { width, height, rows: Discrete::new(sums), columns }
    }

    /// True if nothing can be drawn.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Draws a point (x, y) of the unit square; also returns its density.
    pub fn sample(&self, u: f32, v: f32) -> Option<(f32, f32, f32)> {
        let (row, row_probability, v) = self.rows.sample(v)?;
        let (column, column_probability, u) = self.columns[row].sample(u)?;
        let density = row_probability * column_probability * (self.width * self.height) as f32;
        Some(((column as f32 + u) / self.width as f32, (row as f32 + v) / self.height as f32, density))
    }

    /// Density at (x, y).
    pub fn density(&self, x: f32, y: f32) -> f32 {
        if self.is_empty() {
            return 0.0;
        }
        let column = ((x * self.width as f32) as usize).min(self.width - 1);
        let row = ((y * self.height as f32) as usize).min(self.height - 1);
        if self.columns[row].is_empty() {
            return 0.0;
        }
        self.rows.probability(row) * self.columns[row].probability(column) * (self.width * self.height) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sampler::HashGenerator;

    #[test]
    fn frequencies_follow_the_weights_and_zero_is_never_drawn() {
        let weights = [0.0, 3.0, 0.0, 1.0, 6.0, 0.0];
        let distribution = Discrete::new(weights);
        let mut counts = [0_u32; 6];
        let mut generator = HashGenerator::new(3);
        let n = 100_000;
        for _ in 0..n {
            counts[distribution.sample(generator.next_f32()).unwrap().0] += 1;
        }
        for (count, weight) in counts.iter().zip(weights) {
            let p = f64::from(weight) / 10.0;
            let sigma = (f64::from(n) * p * (1.0 - p)).sqrt();
            assert!((f64::from(*count) - f64::from(n) * p).abs() <= 4.0 * sigma);
        }
        assert!(Discrete::new([0.0, 0.0]).sample(0.5).is_none());
    }

    #[test]
    fn sampled_density_is_the_density_there() {
        let weights = [1.0, 0.0, 2.0, 5.0, 1.0, 0.0];
        let distribution = Piecewise2d::new(3, 2, &weights);
        let mut generator = HashGenerator::new(5);
        for _ in 0..1000 {
            let (x, y, density) = distribution.sample(generator.next_f32(), generator.next_f32()).unwrap();
            // Probabilities are differences of running sums: a few ulps of 1, times 6 cells.
            assert!((distribution.density(x, y) - density).abs() < 6.0 * 4.0 * f32::EPSILON);
        }
    }
}
