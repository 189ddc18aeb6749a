//! A rough dielectric interface that loses no light, for walks inside a body.

use glam::Vec3;

use super::albedo::CosineTable;
use super::bsdf::BsdfSample;
use super::dielectric::Dielectric;
use crate::math::quadrature::GaussLegendre;
use crate::math::robust::safe_sqrt;
use crate::radiometry::Spectrum;

/// A [`Dielectric`] whose lobes are divided by the share that they keep of light from each direction, so that none is
/// lost: what single scattering at microfacets drops is distributed like what it keeps. A walk meets the boundary of its
/// body many times; without this, each would lose some percent at high roughness.
///
/// Drawing is exact (what is dropped is drawn anew); the share in [`Self::evaluate`] and [`Self::density`] is
/// tabulated. The model is not reciprocal: uniform light stays uniform, but the two ways of light through a pair
/// of directions differ by the ratio of the shares.
#[derive(Clone, Debug)]
pub struct Interface {
    /// Of one channel: it has no colour.
    dielectric: Dielectric<1>,
    /// Shares kept of light seen from outside and from inside, over the cosine; `None` if smooth, where none is lost.
    kept: Option<[CosineTable; 2]>,
}

/// Nodes of the share over the cosine.
const NODES: usize = 192;

/// Draws before light is given up: of the roughest surfaces less than half is dropped each time.
const MOST_DRAWS: usize = 64;

impl Interface {
    /// The interface of relative index `eta` = n_inside/n_outside and GGX width `alpha`. A rough one tabulates its shares
    /// (some 0.1 s).
    pub fn new(eta: f32, alpha: f32) -> Self {
        let dielectric = Dielectric { eta, alpha, tint: Spectrum::ONE };
        let table = |side: f32| {
            // Seen from the denser side light is totally reflected below the critical cosine.
            let relative = if side < 0.0 { 1.0 / eta } else { eta };
            let critical = safe_sqrt((1.0 - relative) * (1.0 + relative));
            let [table] = CosineTable::tabulate(NODES, critical, |mu| [share_kept(&dielectric, mu, side)]);
            table
        };
        let kept = (!dielectric.is_smooth()).then(|| [table(1.0), table(-1.0)]);
        Self { dielectric, kept }
    }

    /// True if both lobes are delta lobes.
    pub fn is_smooth(&self) -> bool {
        self.kept.is_none()
    }

    /// f·|cos_i|, 1/sr, for radiance.
    pub fn evaluate(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.dielectric.evaluate(wo, wi)[0] / self.share_kept(wo)
    }

    /// Density of [`Self::sample`] per solid angle.
    pub fn density(&self, wo: Vec3, wi: Vec3) -> f32 {
        // What is drawn has a weight of 1 in power.
        self.evaluate(wo, wi) * self.power_per_radiance(wo, wo.z * wi.z < 0.0)
    }

    /// Draws where light that leaves along `wo` comes from; `draw` gives numbers in [0, 1).
    pub fn sample<const N: usize>(&self, wo: Vec3, mut draw: impl FnMut() -> f32) -> Option<BsdfSample<N>> {
        if self.is_smooth() {
            return self.dielectric.sample(wo, [0.0, 0.0, draw()]).map(BsdfSample::splat);
        }
        for _ in 0..MOST_DRAWS {
            let Some(sample) = self.dielectric.sample(wo, [draw(), draw(), draw()]) else { continue };
            let power = self.power_per_radiance(wo, sample.transmitted);
            if draw() < sample.weight[0] * power {
                let density = self.density(wo, sample.direction);
                let weight = Spectrum([1.0 / power]);
                return Some(BsdfSample { weight, density, ..sample }.splat());
            }
        }
        None
    }

    /// (n_i/n_o)², by which a transmission changes radiance.
    fn power_per_radiance(&self, wo: Vec3, transmitted: bool) -> f32 {
        if transmitted { self.dielectric.relative_eta(wo).powi(2) } else { 1.0 }
    }

    fn share_kept(&self, wo: Vec3) -> f32 {
        match &self.kept {
            None => 1.0,
            Some([outside, inside]) => (if wo.z < 0.0 { inside } else { outside }).evaluate(wo.z.abs()),
        }
    }
}

/// The share of light kept by `dielectric` of what it scatters towards cosine `mu` on the side `side` (±1).
fn share_kept(dielectric: &Dielectric<1>, mu: f32, side: f32) -> f64 {
    const RADII: usize = 32;
    const AZIMUTHS: usize = 48;
    let rule = GaussLegendre::new(RADII);
    let wo = Vec3::new(safe_sqrt(1.0 - mu * mu), 0.0, mu.max(1e-6) * side);
    let ring = |v: f64| {
        // Midpoints of half the circle; the other half is its mirror image.
        let azimuth = |j: usize| (j as f32 + 0.5) / (2 * AZIMUTHS) as f32;
        let kept = |j: usize| f64::from(dielectric.share_kept(wo, [azimuth(j), v as f32]));
        (0..AZIMUTHS).map(kept).sum::<f64>() / AZIMUTHS as f64
    };
    rule.integrate(0.0, 1.0, ring)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sampler::HashGenerator;

    /// ∫ density over the sphere by the density of a uniform draw, against 1, where nothing but the table errs.
    #[test]
    fn the_density_is_that_of_the_draws() {
        let mut random = HashGenerator::new(1);
        for (eta, alpha) in [(1.5, 0.25), (1.0 / 1.33, 0.25), (1.33, 0.7)] {
            let interface = Interface::new(eta, alpha);
            for cos in [0.95_f32, 0.5, 0.15, -0.15, -0.5, -0.95] {
                let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
                // Directions drawn fall into the upper half as often as the density says.
                const DRAWS: usize = 20_000;
                let (mut up, mut integral, mut squares) = (0.0, 0.0, 0.0);
                for _ in 0..DRAWS {
                    let sample: BsdfSample =
                        interface.sample(wo, || random.next_f32()).expect("half is kept of each draw");
                    // E[1_up(wi)] by the draws, and by the density of draws of the single-scattering lobe.
                    up += f64::from(u8::from(sample.direction.z > 0.0)) / DRAWS as f64;
                    let u = [random.next_f32(), random.next_f32(), random.next_f32()];
                    let value = interface.dielectric.sample(wo, u).map_or(0.0, |single| {
                        let ratio = interface.density(wo, single.direction) / single.density;
                        if single.direction.z > 0.0 { f64::from(ratio) } else { 0.0 }
                    });
                    integral += value / DRAWS as f64;
                    squares += value * value / DRAWS as f64;
                }
                let variance = (squares - integral * integral + up * (1.0 - up)).max(0.0) / DRAWS as f64;
                // 18 comparisons: 4σ, and the error of the table at the kink of total reflection.
                let allowed = 4.0 * variance.sqrt() + 1e-3;
                assert!((up - integral).abs() < allowed, "eta {eta} cos {cos}: {up} against {integral}");
            }
        }
    }

    #[test]
    fn the_table_gives_the_share_kept() {
        for (eta, alpha) in [(1.5, 0.01), (1.5, 0.25), (1.0 / 1.33, 0.25), (1.33, 1.0)] {
            let interface = Interface::new(eta, alpha);
            for i in 1..100 {
                let mu = i as f32 / 100.0;
                for side in [1.0, -1.0] {
                    let table = interface.share_kept(Vec3::new(safe_sqrt(1.0 - mu * mu), 0.0, mu * side));
                    let exact = share_kept(&interface.dielectric, mu, side);
                    let error = (f64::from(table) - exact).abs();
                    assert!(error < 1e-3, "eta {eta} alpha {alpha} mu {mu} side {side}: {error}");
                }
            }
        }
    }
}
