//! The albedo of a thick flat body as a table, for use at every point of a surface.

use super::Entry;
use super::albedo_inversion::{AlbedoInversion, LossScale, unreduced_share};
use super::plane_parallel::PlaneParallel;
use crate::math::monotone_cubic::MonotoneCubic;

/// Share of the flux that entered a half-space from uniform surroundings which leaves it again, for one
/// relative index and phase function.
///
/// This is the number by which a separable BSSRDF S = (1 − F_o) R(r) S_w must scale its profile,
/// ∫R dA = albedo, to be right on a plane. Exact to 10⁻⁴.
#[derive(Clone, Debug)]
pub struct PlanarAlbedo {
    scale: LossScale,
    /// 1 − albedo over the variable of [`LossScale`].
    loss: MonotoneCubic,
}

const TABLE_SIZE: usize = 129;

/// Quadrature nodes; 10⁻⁵ for |g| ≤ 0.95.
const NODES: usize = 32;

impl PlanarAlbedo {
    /// Tabulates for relative index `eta` = n_inside/n_outside > 0 and mean cosine `g` in (−1, 1).
    pub fn new(eta: f32, g: f32) -> Self {
        let (eta, g) = (f64::from(eta), f64::from(g));
        let exact = AlbedoInversion::of(PlaneParallel::with_nodes(eta, g, NODES), g, Entry::Diffuse);
        let scale = exact.scale();
        let loss: Vec<_> = (0..TABLE_SIZE)
            .map(|i| {
                let reduced = scale.reduced_share(i as f64 / (TABLE_SIZE - 1) as f64);
                1.0 - exact.albedo(unreduced_share(reduced, g))
            })
            .collect();
        Self { scale, loss: MonotoneCubic::new(&loss) }
    }

    /// Albedo where the share `absorbed_share` = σ_a/σ_t' of the *reduced* medium is absorbed.
    pub fn albedo(&self, absorbed_share: f32) -> f32 {
        1.0 - self.loss.evaluate(self.scale.loss(f64::from(absorbed_share.clamp(0.0, 1.0))) as f32)
    }

    /// The absorbed share σ_a/σ_t' of the reduced medium whose albedo is `albedo`: the inverse of
    /// [`Self::albedo`].
    pub fn absorbed_share(&self, albedo: f32) -> f32 {
        let loss = self.loss.inverse(1.0 - albedo.clamp(0.0, 1.0));
        self.scale.reduced_share(f64::from(loss)) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probe() {
        for eta in [0.5, 0.75, 1.0, 1.33, 1.5, 2.0, 3.0] {
            for g in [-0.9, -0.5, 0.0, 0.5, 0.8, 0.9, 0.95] {
                let start = std::time::Instant::now();
                let table = PlanarAlbedo::new(eta, g);
                let t0 = start.elapsed();
                let exact = AlbedoInversion::new(f64::from(eta), f64::from(g), Entry::Diffuse);
                let mut worst = (0.0_f32, 0.0);
                let n = 203;
                for i in 0..=n {
                    let x = exact.scale().reduced_share(i as f64 / n as f64) as f32;
                    let e = exact.albedo(unreduced_share(f64::from(x), f64::from(g))) as f32;
                    let err = (table.albedo(x) - e).abs();
                    if err > worst.0 {
                        worst = (err, i as f64 / n as f64);
                    }
                }
                println!("{eta} {g}: {t0:?} worst {worst:?}");
            }
        }
    }
}
