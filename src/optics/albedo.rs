//! Directional albedos of GGX reflection, by deterministic quadrature over the very sampling that is
//! used for rendering, so that energy closes.

use std::sync::LazyLock;

use super::fresnel::schlick_weight;
use super::microfacet::{Ggx, SMOOTH_ALPHA, is_smooth};
use crate::math::monotone_cubic::MonotoneCubic;
use crate::math::quadrature::GaussLegendre;
use crate::math::robust::safe_sqrt;
use glam::Vec3;

/// ∫ `fresnel`(cos with the microfacet) · G₂/G₁ over visible microfacets, seen from cosine `mu`: the
/// directional albedo of the reflection for each of the K Fresnel terms.
pub fn directional_albedo<const K: usize>(ggx: &Ggx, mu: f32, fresnel: impl Fn(f32) -> [f64; K]) -> [f64; K] {
    static RADIAL: LazyLock<GaussLegendre> = LazyLock::new(|| GaussLegendre::new(RADIAL_NODES));
    let wo = Vec3::new(safe_sqrt(1.0 - mu * mu), 0.0, mu);
    let mut albedo = [0.0; K];
    for &(v, weight) in RADIAL.nodes() {
        for j in 0..AZIMUTHS {
            // Midpoints of half the circle; the other half is its mirror image.
            let u = (j as f32 + 0.5) / (2 * AZIMUTHS) as f32;
            let Some(sample) = ggx.sample_reflection(wo, [u, v as f32]) else { continue };
            let share = weight * f64::from(sample.weight) / AZIMUTHS as f64;
            for (sum, f) in albedo.iter_mut().zip(fresnel(sample.cos_microfacet)) {
                *sum += share * f;
            }
        }
    }
    albedo
}

const RADIAL_NODES: usize = 32;
const AZIMUTHS: usize = 32;

/// A function of the cosine with the normal, tabulated in √μ where Fresnel is steep near grazing.
#[derive(Clone, Debug)]
pub struct CosineTable(MonotoneCubic);

impl CosineTable {
    /// Tabulates `f` at `count` cosines.
    pub fn new(count: usize, f: impl Fn(f32) -> f64) -> Self {
        let node = |i: usize| {
            let x = i as f32 / (count - 1) as f32;
            f(x * x)
        };
        Self(MonotoneCubic::new(&(0..count).map(node).collect::<Vec<_>>()))
    }

    /// The value at cosine `mu` in [0, 1].
    pub fn evaluate(&self, mu: f32) -> f32 {
        self.0.evaluate(safe_sqrt(mu))
    }

    /// 2 ∫ f(μ) μ dμ, exactly for the interpolant: 4 ∫ f x³ dx has degree 6 in x = √μ between nodes.
    pub fn hemispherical_mean(&self) -> f64 {
        let rule = GaussLegendre::new(4);
        let intervals = self.0.node_count() - 1;
        let interval = |i: usize| {
            let node = |i: usize| i as f64 / intervals as f64;
            rule.integrate(node(i), node(i + 1), |x| 4.0 * x.powi(3) * f64::from(self.0.evaluate(x as f32)))
        };
        (0..intervals).map(interval).sum()
    }
}

/// Directional albedo of a GGX reflection under Schlick's Fresnel factor, split into the part that
/// multiplies the normal-incidence reflectance F₀ and the rest: E = F₀·`scale` + `offset`
/// (Karis 2013, "Real Shading in Unreal Engine 4", in a different notation).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SchlickAlbedo {
    /// ∫ (1 − (1−c)⁵) over the lobe.
    pub scale: f32,
    /// ∫ (1−c)⁵ over the lobe.
    pub offset: f32,
}

impl SchlickAlbedo {
    /// Seen from cosine `mu`.
    pub fn directional(mu: f32, alpha: f32) -> Self {
        if is_smooth(alpha) {
            let offset = schlick_weight(mu);
            return Self { scale: 1.0 - offset, offset };
        }
        Self::between_rows(alpha, |row| [row.scale.evaluate(mu), row.offset.evaluate(mu)])
    }

    /// 2 ∫ E(μ) μ dμ.
    pub fn mean(alpha: f32) -> Self {
        if is_smooth(alpha) {
            // 2 ∫ μ (1−μ)⁵ dμ = 1/21.
            return Self { scale: 20.0 / 21.0, offset: 1.0 / 21.0 };
        }
        Self::between_rows(alpha, |row| row.mean)
    }

    /// E at normal-incidence reflectance `f0`.
    pub fn at(&self, f0: f32) -> f32 {
        (f0 * self.scale + self.offset).min(1.0)
    }

    fn between_rows(alpha: f32, f: impl Fn(&SchlickRow) -> [f32; 2]) -> Self {
        let position = row_position(alpha).clamp(0.0, (ROWS - 1) as f32);
        let i = (position as usize).min(ROWS - 2);
        let t = position - i as f32;
        let (p, q) = (f(&SCHLICK_ROWS[i]), f(&SCHLICK_ROWS[i + 1]));
        Self { scale: p[0] + t * (q[0] - p[0]), offset: p[1] + t * (q[1] - p[1]) }
    }
}

/// One α of the table behind [`SchlickAlbedo`].
struct SchlickRow {
    scale: CosineTable,
    offset: CosineTable,
    mean: [f32; 2],
}

const ROWS: usize = 32;
const ROW_COSINES: usize = 32;

/// Rows are spaced evenly in the logarithm of α, from the smooth limit to 1: the lobe's behaviour
/// near grazing depends on the ratio of cosine and α.
fn row_position(alpha: f32) -> f32 {
    (alpha / SMOOTH_ALPHA).ln() / (1.0 / SMOOTH_ALPHA).ln() * (ROWS - 1) as f32
}

static SCHLICK_ROWS: LazyLock<Vec<SchlickRow>> = LazyLock::new(|| (0..ROWS).map(schlick_row).collect());

fn schlick_row(i: usize) -> SchlickRow {
    let ggx = Ggx { alpha: SMOOTH_ALPHA.powf(1.0 - i as f32 / (ROWS - 1) as f32) };
    let albedo = |mu: f32| {
        directional_albedo(&ggx, mu, |cos| {
            let weight = f64::from(schlick_weight(cos));
            [1.0 - weight, weight]
        })
    };
    let scale = CosineTable::new(ROW_COSINES, |mu| albedo(mu)[0]);
    let offset = CosineTable::new(ROW_COSINES, |mu| albedo(mu)[1]);
    let mean = [scale.hemispherical_mean() as f32, offset.hemispherical_mean() as f32];
    SchlickRow { scale, offset, mean }
}
