//! The form of an analytic model as a [`ShapeTable`], for use at every point of a surface.
//!
//! Only the form is kept. The models' total albedos are wrong by up to a third, which would break both the
//! conservation of energy and the reflectance asked for; the albedo comes from transport theory.

use rayon::prelude::*;

use super::integrate::energy_by;
use super::shape::{KNOTS, KNOTS_PER_DECADE, ShapeTable, knot_radius};
use super::{DiffusionModel, HalfSpace, HalfSpaceError};
use crate::math::quadrature::GaussLegendre;

/// Rows over √(1 − α').
const ROWS: usize = 41;

/// Nodes of the quadrature on each panel.
const NODES: usize = 4;

/// e-folds of radius to which the energy within the first knot, and beyond the last, is integrated. The profile has
/// at most a pole 1/r and falls at least as 1/r³, so that less than 10⁻⁴ of this energy is left out.
const FOLDS: i32 = 10;

/// Share of the energy below which its logarithm is not that of the model any more.
const LEAST_SHARE: f64 = 1e-250;

impl ShapeTable {
    /// The form of a model in half-spaces of relative index `eta` and mean cosine `g` of every albedo; `model`
    /// makes it for one of them. Takes some 10⁴ evaluations of the model, on all threads.
    ///
    /// # Errors
    /// Those of [`HalfSpace::new`], for an index or a mean cosine that no half-space has.
    pub fn of_model<M: DiffusionModel>(
        eta: f64,
        g: f64,
        model: impl Fn(&HalfSpace) -> M + Sync,
    ) -> Result<Self, HalfSpaceError> {
        let rule = GaussLegendre::new(NODES);
        let row = |i: usize| {
            let root = i as f64 / (ROWS - 1) as f64;
            Ok(logits(&rule, &model(&reduced_half_space(root * root, g, eta)?), 1.0))
        };
        Ok(Self::new(&(0..ROWS).into_par_iter().map(row).collect::<Result<Vec<_>, _>>()?))
    }

    /// The form of `model` alone, which is that of one medium, of reduced mean free path `length`: the same for every
    /// albedo.
    pub fn of_one(model: &dyn DiffusionModel, length: f64) -> Self {
        Self::new(&[logits(&GaussLegendre::new(NODES), model, length)])
    }
}

/// The half-space of reduced mean free path 1 that absorbs the share `absorbed_share` = 1 − α'.
pub(super) fn reduced_half_space(absorbed_share: f64, g: f64, eta: f64) -> Result<HalfSpace, HalfSpaceError> {
    // Where nothing scatters there is no profile: what is left is the form it has in the limit.
    let sigma_a = absorbed_share.min(1.0 - 1e-7);
    HalfSpace::new(sigma_a, (1.0 - sigma_a) / (1.0 - g), g, eta)
}

/// Logits of the share of energy within each knot, for reduced mean free path `length`. Both shares are sums of their own parts, so that neither
/// loses its digits where it is small.
fn logits(rule: &GaussLegendre, model: &(impl DiffusionModel + ?Sized), length: f64) -> [f64; KNOTS] {
    let fold = |i: i32| f64::from(i).exp();
    let radius = |i: usize| length * knot_radius(i);
    let (first, last) = (radius(0), radius(KNOTS - 1));
    let mut parts: [f64; KNOTS + 1] = std::array::from_fn(|i| match i {
        0 => energy_by(rule, model, first * fold(-FOLDS), first),
        KNOTS => 0.0,
        _ => energy_by(rule, model, radius(i - 1), radius(i)),
    });
    // An exponential tail has ended long before the last knot.
    if parts[KNOTS - 1] > 0.0 {
        parts[KNOTS] = energy_by(rule, model, last, last * fold(FOLDS));
    }
    logits_of_parts(&parts)
}

fn logits_of_parts(parts: &[f64; KNOTS + 1]) -> [f64; KNOTS] {
    let total: f64 = parts.iter().sum();
    let (mut inside, mut outside) = ([0.0; KNOTS], [0.0; KNOTS]);
    let (mut from_inside, mut from_outside) = (0.0, 0.0);
    for i in 0..KNOTS {
        from_inside += parts[i];
        from_outside += parts[KNOTS - i];
        inside[i] = from_inside;
        outside[KNOTS - 1 - i] = from_outside;
    }
    let mut logits: [f64; KNOTS] =
        std::array::from_fn(|i| (inside[i].max(LEAST_SHARE * total) / outside[i]).ln());
    // Where nothing is left outside, the logit goes on in proportion to the radius, as in an exponential tail.
    let growth = 10.0_f64.powf(1.0 / KNOTS_PER_DECADE as f64);
    for i in 2..KNOTS {
        if outside[i] <= LEAST_SHARE * total {
            logits[i] = logits[i - 1] + growth * (logits[i - 1] - logits[i - 2]);
        }
    }
    logits
}
