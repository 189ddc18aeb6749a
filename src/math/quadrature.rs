//! Gauss–Legendre quadrature.

use std::f64::consts::PI;

/// The `n` nodes and weights of Gauss–Legendre quadrature on (0, 1), by Newton's iteration on the
/// Legendre polynomial from Tricomi's estimate of its roots.
pub fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    (0..n)
        .map(|i| {
            let mut x = (PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..100 {
                let (value, derivative) = legendre(n, x);
                slope = derivative;
                let step = value / derivative;
                x -= step;
                if step.abs() < 1e-16 {
                    break;
                }
            }
            (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// P_n(x) and its derivative.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut previous, mut value) = (1.0, x);
    for k in 2..=n {
        let k = k as f64;
        (previous, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * previous) / k);
    }
    (value, n as f64 * (x * value - previous) / (x * x - 1.0))
}

#[cfg(test)]
mod tests {
    use super::gauss_legendre;

    #[test]
    fn integrates_polynomials_up_to_twice_its_order_exactly() {
        let rule = gauss_legendre(8);
        for power in 0..16 {
            let integral: f64 = rule.iter().map(|(x, w)| w * x.powi(power)).sum();
            assert!((integral - 1.0 / f64::from(power + 1)).abs() < 1e-15);
        }
    }
}
