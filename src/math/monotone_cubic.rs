//! Interpolation that never overshoots its data.

/// Piecewise cubic through values at equally spaced nodes of [0, 1], monotone wherever the data are
/// (Fritsch and Butland 1984, "A Method for Constructing Local Monotone Piecewise Cubic
/// Interpolants"): it stays within the values of the two nodes around it.
#[derive(Clone, Debug)]
pub struct MonotoneCubic {
    /// Value and slope (per node spacing) at each node.
    nodes: Vec<[f32; 2]>,
}

impl MonotoneCubic {
    /// Through `values`, of which there must be at least two (with fewer, the constant they give or 0).
    pub fn new(values: &[f64]) -> Self {
        let node = |i: usize| [values[i] as f32, slope(values, i) as f32];
        let mut nodes: Vec<_> = (0..values.len()).map(node).collect();
        while nodes.len() < 2 {
            nodes.push(nodes.first().copied().unwrap_or([0.0; 2]));
        }
        Self { nodes }
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.nodes.len()
    }

    /// The value at `x`, clamped to [0, 1].
    pub fn evaluate(&self, x: f32) -> f32 {
        let intervals = self.nodes.len() - 1;
        let position = x.clamp(0.0, 1.0) * intervals as f32;
        let i = (position as usize).min(intervals - 1);
        self.within(i, position - i as f32)[0]
    }

    /// The `x` in [0, 1] at which rising data come nearest to `value`: the inverse of [`Self::evaluate`].
    pub fn inverse(&self, value: f32) -> f32 {
        let intervals = self.nodes.len() - 1;
        let i = self.nodes.partition_point(|node| node[0] <= value).clamp(1, intervals) - 1;
        (i as f32 + self.inverse_within(i, value)) / intervals as f32
    }

    /// Value and slope at the share `t` of the way from node `i` to the next.
    fn within(&self, i: usize, t: f32) -> [f32; 2] {
        let ([p, dp], [q, dq]) = (self.nodes[i], self.nodes[i + 1]);
        let rise = q - p;
        let (square, cube) = (3.0 * rise - 2.0 * dp - dq, dp + dq - 2.0 * rise);
        // Hermite form around p: exact at t = 0, and no large terms that cancel.
        [p + t * (dp + t * (square + t * cube)), dp + t * (2.0 * square + 3.0 * t * cube)]
    }

    /// The share of the way from node `i` to the next at which rising data reach `value`: Newton's
    /// method, and bisection where that leaves the bracket.
    fn inverse_within(&self, i: usize, value: f32) -> f32 {
        let (p, q) = (self.nodes[i][0], self.nodes[i + 1][0]);
        if value <= p {
            return 0.0;
        }
        if value >= q {
            return 1.0;
        }
        let (mut low, mut high) = (0.0, 1.0);
        let mut t = (value - p) / (q - p);
        // Bisection alone would find the last bit in so many steps.
        for _ in 0..f32::MANTISSA_DIGITS {
            let [y, slope] = self.within(i, t);
            if y <= value {
                low = t;
            } else {
                high = t;
            }
            let newton = t - (y - value) / slope;
            let next = if newton >= low && newton <= high { newton } else { 0.5 * (low + high) };
            if (next - t).abs() < f32::EPSILON {
                break;
            }
            t = next;
        }
        t
    }
}

/// Slope at node `i`: inside, the harmonic mean of the two secants (0 at an extremum); at an end, the
/// three-point difference limited to three times the secant.
fn slope(values: &[f64], i: usize) -> f64 {
    let secant = |j: usize| values[j + 1] - values[j];
    let last = values.len() - 1;
    match (i, last) {
        (_, 0) => 0.0,
        (_, 1) => secant(0),
        (0, _) => end_slope(secant(0), secant(1)),
        _ if i == last => end_slope(secant(last - 1), secant(last - 2)),
        _ => {
            let (a, b) = (secant(i - 1), secant(i));
            if a * b > 0.0 { 2.0 * a * b / (a + b) } else { 0.0 }
        }
    }
}

fn end_slope(nearest: f64, next: f64) -> f64 {
    let slope = 1.5 * nearest - 0.5 * next;
    if slope * nearest <= 0.0 { 0.0 } else { slope.abs().min(3.0 * nearest.abs()).copysign(nearest) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stays_between_its_nodes_and_hits_them() {
        let values = [1.0, 0.9, 0.1, 0.1, 0.5, 0.45, 0.0];
        let table = MonotoneCubic::new(&values);
        for i in 0..values.len() - 1 {
            let (low, high) = (values[i].min(values[i + 1]) as f32, values[i].max(values[i + 1]) as f32);
            for step in 0..=100 {
                let x = (i as f32 + step as f32 / 100.0) / 6.0;
                let y = table.evaluate(x);
                assert!(y >= low - 4.0 * f32::EPSILON && y <= high + 4.0 * f32::EPSILON, "{x}: {y}");
            }
            assert!((table.evaluate(i as f32 / 6.0) - values[i] as f32).abs() <= 4.0 * f32::EPSILON);
        }
    }

    #[test]
    fn rising_data_are_inverted() {
        let table = MonotoneCubic::new(&[0.0, 1e-3, 0.4, 0.5, 0.9, 1.0]);
        for step in 0..=1000 {
            let value = step as f32 / 1000.0;
            // The position is known to 2⁻²³ at most, and no value rises faster than 3·0.4·5.
            let found = table.evaluate(table.inverse(value));
            assert!((found - value).abs() <= 6.0 * 2.0 * f32::EPSILON, "{value}: {found}");
        }
        assert_eq!((table.inverse(-1.0), table.inverse(2.0)), (0.0, 1.0));
    }
}
