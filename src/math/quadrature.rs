//! Gauss–Legendre quadrature in double precision.

use std::f64::consts::PI;

/// Nodes and weights of the Gauss–Legendre rule, on [0, 1].
#[derive(Clone, Debug)]
pub struct GaussLegendre {
    nodes: Vec<(f64, f64)>,
}

impl GaussLegendre {
    /// The rule of `count` nodes: exact for polynomials of degree 2·`count` − 1.
    ///
    /// The roots of P_n by Newton's method from Tricomi's estimate (Davis and Rabinowitz 1984,
    /// section 2.7).
    pub fn new(count: usize) -> Self {
        let node = |i: usize| {
            let mut x = (PI * (i as f64 + 0.75) / (count as f64 + 0.5)).cos();
            let mut derivative = 1.0;
            for _ in 0..NEWTON_STEPS {
                let (value, slope) = legendre(count, x);
                derivative = slope;
                x -= value / slope;
            }
            (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * derivative * derivative))
        };
        Self { nodes: (0..count).map(node).collect() }
    }

    /// The nodes in [0, 1] with their weights, which sum to 1.
    pub fn nodes(&self) -> &[(f64, f64)] {
        &self.nodes
    }

    /// ∫ `f` over [`from`, `to`].
    pub fn integrate(&self, from: f64, to: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
        let length = to - from;
        length * self.nodes.iter().map(|&(x, weight)| weight * f(from + length * x)).sum::<f64>()
    }
}

/// Converges quadratically; the estimate is good to four digits or more, so this is ample.
const NEWTON_STEPS: usize = 5;

/// P_n(x) and its derivative, by the three-term recurrence.
fn legendre(degree: usize, x: f64) -> (f64, f64) {
    let (mut previous, mut current) = (0.0, 1.0);
    for n in 0..degree {
        let n = n as f64;
        let next = ((2.0 * n + 1.0) * x * current - n * previous) / (n + 1.0);
        (previous, current) = (current, next);
    }
    (current, degree as f64 * (x * current - previous) / (x * x - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_up_to_twice_the_count_are_exact() {
        for count in [1, 4, 33, 128] {
            let rule = GaussLegendre::new(count);
            for degree in [0, 1, 2 * count - 1] {
                let integral = rule.integrate(0.0, 1.0, |x| x.powi(degree as i32));
                let exact = 1.0 / (degree as f64 + 1.0);
                // Sum of `count` rounded terms.
                assert!((integral - exact).abs() <= exact * count as f64 * 4.0 * f64::EPSILON);
            }
        }
    }
}
