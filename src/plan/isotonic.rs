//! The falling sequence nearest to measured numbers.

/// A number with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Its standard error, above 0.
    pub sigma: f64,
}

/// The sequence that nowhere rises and has the least squares of distances to `measured`, weighted by 1/σ²: neighbours that
/// rise are pooled (pool adjacent violators: Ayer et al. 1955, Ann. Math. Statist. 26). Each has the standard error of its pool.
pub fn falling(measured: &[Estimate]) -> Vec<Estimate> {
    struct Pool {
        weighted: f64,
        weight: f64,
        count: usize,
    }
    let mut pools: Vec<Pool> = Vec::new();
    for estimate in measured {
        let weight = estimate.sigma.powi(-2);
        let mut pool = Pool { weighted: estimate.value * weight, weight, count: 1 };
        while let Some(before) =
            pools.pop_if(|before| before.weighted * pool.weight < pool.weighted * before.weight)
        {
            pool.weighted += before.weighted;
            pool.weight += before.weight;
            pool.count += before.count;
        }
        pools.push(pool);
    }
    let of_pool = |pool: &Pool| {
        let estimate = Estimate { value: pool.weighted / pool.weight, sigma: pool.weight.sqrt().recip() };
        std::iter::repeat_n(estimate, pool.count)
    };
    pools.iter().flat_map(of_pool).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_rises_is_pooled_and_what_falls_is_kept() {
        let estimates = |values: &[(f64, f64)]| {
            values.iter().map(|&(value, sigma)| Estimate { value, sigma }).collect::<Vec<_>>()
        };
        let falls = estimates(&[(3.0, 1.0), (2.0, 0.5), (-1.0, 2.0)]);
        assert_eq!(falling(&falls), falls);
        // (1 · 4 + 6 · 1)/5, and that pools with the first.
        let pooled = falling(&estimates(&[(1.5, 1.0), (1.0, 0.5), (6.0, 1.0), (0.0, 1.0)]));
        let expected = (1.5 + 4.0 + 6.0) / 6.0;
        for estimate in &pooled[..3] {
            assert!((estimate.value - expected).abs() < 1e-12);
            assert!((estimate.sigma - 6.0_f64.sqrt().recip()).abs() < 1e-12);
        }
        assert_eq!(pooled[3].value, 0.0);
        assert!(falling(&[]).is_empty());
    }
}
