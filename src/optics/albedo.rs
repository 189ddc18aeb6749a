//! Directional albedos of GGX reflection, by deterministic quadrature over the very sampling that is
//! used for rendering, so that energy closes.

use std::array;
use std::sync::LazyLock;

use glam::Vec3;

use super::fresnel::schlick_weight;
use super::microfacet::{Ggx, SMOOTH_ALPHA, is_smooth};
use crate::math::monotone_cubic::MonotoneCubic;
use crate::math::quadrature::GaussLegendre;
use crate::math::robust::safe_sqrt;

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
const AZIMUTHS: usize = 48;

/// A function of the cosine μ with the normal, tabulated densely towards grazing, where Fresnel is
/// steep, and on both sides of a critical cosine, where it has a kink.
#[derive(Clone, Debug)]
pub struct CosineTable {
    /// Over the position x of [`Self::position`].
    values: MonotoneCubic,
    /// Critical cosine; 0 if there is none.
    critical: f32,
}

/// Parts of the range of μ when there is a critical cosine.
const PIECES: usize = 3;

impl CosineTable {
    /// Tabulates the K functions in `f` at about `count` cosines, `critical` being the cosine of total
    /// reflection or 0.
    pub fn tabulate<const K: usize>(count: usize, critical: f32, f: impl Fn(f32) -> [f64; K]) -> [Self; K] {
        let intervals = count.max(PIECES + 1) / PIECES * PIECES;
        let node = |i: usize| f(cosine(i as f64 / intervals as f64, critical).0 as f32);
        let values: Vec<[f64; K]> = (0..=intervals).map(node).collect();
        array::from_fn(|k| {
            let values: Vec<f64> = values.iter().map(|value| value[k]).collect();
            Self { values: MonotoneCubic::new(&values), critical }
        })
    }

    /// The value at cosine `mu` in [0, 1].
    pub fn evaluate(&self, mu: f32) -> f32 {
        self.values.evaluate(self.position(mu))
    }

    /// 2 ∫ f(μ) μ dμ, exactly for the interpolant: between nodes f is cubic, μ quadratic and dμ/dx
    /// linear in the position x.
    pub fn hemispherical_mean(&self) -> f64 {
        let rule = GaussLegendre::new(4);
        let intervals = self.values.node_count() - 1;
        let node = |i: usize| i as f64 / intervals as f64;
        let integrand = |x: f64| {
            let (mu, slope) = cosine(x, self.critical);
            2.0 * mu * slope * f64::from(self.values.evaluate(x as f32))
        };
        (0..intervals).map(|i| rule.integrate(node(i), node(i + 1), integrand)).sum()
    }

    /// The place x of `mu` in the table, the inverse of [`cosine`]: √μ without a critical cosine.
    fn position(&self, mu: f32) -> f32 {
        let half = 0.5 * self.critical;
        let third = 1.0 / PIECES as f32;
        if half <= 0.0 {
            safe_sqrt(mu)
        } else if mu < half {
            third * safe_sqrt(mu / half)
        } else if mu < self.critical {
            third * (2.0 - safe_sqrt((self.critical - mu) / half))
        } else {
            third * (2.0 + safe_sqrt((mu - self.critical) / (1.0 - self.critical)))
        }
    }
}

/// The cosine at position `x` in [0, 1] of a table, and dμ/dx.
fn cosine(x: f64, critical: f32) -> (f64, f64) {
    let critical = f64::from(critical);
    if critical <= 0.0 {
        return (x * x, 2.0 * x);
    }
    let pieces = PIECES as f64;
    let t = pieces * x;
    let (half, rest) = (0.5 * critical, 1.0 - critical);
    if t < 1.0 {
        (half * t * t, 2.0 * pieces * half * t)
    } else if t < 2.0 {
        (critical - half * (2.0 - t).powi(2), 2.0 * pieces * half * (2.0 - t))
    } else {
        (critical + rest * (t - 2.0).powi(2), 2.0 * pieces * rest * (t - 2.0))
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

    /// Bound on the error of [`Self::directional`] from interpolation, relative to 1 − E (measured
    /// against direct quadrature, see the tests): towards grazing the albedo changes within μ ≈ α.
    pub fn relative_error(mu: f32, alpha: f32) -> f32 {
        if is_smooth(alpha) { 0.0 } else { (2e-4 + 3e-4 / mu).min(1.0) }
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
    let [scale, offset] = CosineTable::tabulate(ROW_COSINES, 0.0, |mu| {
        directional_albedo(&ggx, mu, |cos| {
            let weight = f64::from(schlick_weight(cos));
            [1.0 - weight, weight]
        })
    });
    let mean = [scale.hemispherical_mean() as f32, offset.hemispherical_mean() as f32];
    SchlickRow { scale, offset, mean }
}
