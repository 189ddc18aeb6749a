//! Many comparisons with one bound, so that chance fails the whole as rarely as it fails one at 3σ.

use alabaster::slab::Estimate;

/// Chance that a normal number is off by more than 3σ.
const CHANCE: f64 = 0.0027;

/// An estimate and what it should be.
pub struct Comparison {
    pub name: String,
    pub found: Estimate,
    pub exact: f64,
    /// Bound of what `exact` itself may be off.
    pub allowance: f64,
}

/// Comparisons that are judged together.
pub struct Family {
    largest: f64,
    comparisons: Vec<Comparison>,
}

impl Family {
    /// No comparison yet; none is to be off by more than `largest`.
    pub fn new(largest: f64) -> Self {
        Self { largest, comparisons: Vec::new() }
    }

    pub fn add(&mut self, name: String, found: Estimate, exact: f64) {
        // The planar tables are right to 10⁻⁶.
        self.push(Comparison { name, found, exact, allowance: 1e-6 });
    }

    pub fn push(&mut self, comparison: Comparison) {
        self.comparisons.push(comparison);
    }

    pub fn len(&self) -> usize {
        self.comparisons.len()
    }

    /// Asserts the bounds.
    pub fn check(&self) {
        let n = self.len() as f64;
        let bound = quantile(CHANCE / n);
        let mut failures = Vec::new();
        let mut squares = 0.0;
        for Comparison { name, found, exact, allowance } in &self.comparisons {
            let off = ((found.value - exact).abs() - allowance).max(0.0);
            let sigmas = off / found.standard_error;
            squares += sigmas * sigmas;
            if !(sigmas <= bound && off <= self.largest) {
                failures.push(format!("{name}: {found:?}, exact {exact}: {sigmas:.2} σ"));
            }
        }
        println!("{n} comparisons within {bound:.2} σ; mean square {:.3}", squares / n);
        assert!(failures.is_empty(), "beyond {bound:.2} σ or {}:\n{}", self.largest, failures.join("\n"));
        let highest = n + 3.0 * (2.0 * n).sqrt();
        assert!(squares <= highest, "sum of squares {squares}, at most {highest}");
    }
}

/// How many σ a normal number exceeds, to either side, with probability `chance`.
fn quantile(chance: f64) -> f64 {
    let (mut low, mut high) = (0.0, 40.0);
    for _ in 0..60 {
        let middle: f64 = 0.5 * (low + high);
        if libm::erfc(middle / 2.0_f64.sqrt()) > chance { low = middle } else { high = middle }
    }
    high
}
