//! The albedo of a thick flat body as a table, for use at every point of a surface.

use std::sync::LazyLock;

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

    /// That of matched indices and isotropic scattering, which normalized diffusion was fitted to. Tabulated once (some 0.1 s).
    pub fn matched() -> &'static Self {
        static MATCHED: LazyLock<PlanarAlbedo> = LazyLock::new(|| PlanarAlbedo::new(1.0, 0.0));
        &MATCHED
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
    fn the_table_is_right_between_its_nodes() {
        for eta in [0.5, 1.0, 1.33, 2.0, 3.0] {
            for g in [-0.9, 0.0, 0.5, 0.8, 0.95] {
                let table = PlanarAlbedo::new(eta, g);
                let exact = AlbedoInversion::new(f64::from(eta), f64::from(g), Entry::Diffuse);
                assert_eq!(table.albedo(0.0), 1.0);
                // 67 steps share no node but the ends with the table's 128.
                for i in 0..=67 {
                    let reduced = exact.scale().reduced_share(f64::from(i) / 67.0) as f32;
                    let albedo = exact.albedo(unreduced_share(f64::from(reduced), f64::from(g)));
                    let error = (f64::from(table.albedo(reduced)) - albedo).abs();
                    assert!(error < 1e-4, "eta {eta} g {g} share {reduced}: {error:e}");
                }
            }
        }
    }

    #[test]
    fn the_table_falls_and_is_inverted() {
        for (eta, g) in [(0.75, 0.0), (1.0, 0.9), (1.5, 0.0), (3.0, 0.8), (1.5, 0.999), (1.5, -0.99)] {
            let table = PlanarAlbedo::new(eta, g);
            assert_eq!((table.absorbed_share(1.0), table.absorbed_share(0.0)), (0.0, 1.0));
            let mut above = 0.0;
            for i in 1..1000 {
                let albedo = 1.0 - i as f32 / 1000.0;
                let share = table.absorbed_share(albedo);
                assert!(share > above && share < 1.0, "eta {eta} g {g} albedo {albedo}: {share}");
                above = share;
                // Near black the albedo is (1 − share) times up to η² κ/(1 − g), and 1 − share has
                // the digits of numbers near 1.
                let error = (table.albedo(share) - albedo).abs();
                assert!(error < 1e-5, "eta {eta} g {g} albedo {albedo}: {error:e}");
            }
        }
    }
}
