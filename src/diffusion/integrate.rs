//! Energy of any diffusion model between two radii, by quadrature.

use std::f64::consts::TAU;
use std::sync::LazyLock;

use super::DiffusionModel;
use crate::math::quadrature::GaussLegendre;

/// How far, in units of the length on which a profile changes, its ends are integrated. A profile has
/// at most a pole 1/r and falls at least as 1/r³ in the end, so that less than 10⁻¹² of the energy is left.
const REACH: f64 = 1e13;

/// ∫ R(r) 2πr dr over radii from `from` to `to`, m; both finite, 0 ≤ `from` ≤ `to`.
///
/// Gauss–Legendre of 16 nodes in ln r on panels of at most one e-fold: power laws and exponentials are
/// integrated to about 10⁻¹⁴. From 0, the integral starts at 10⁻¹³ of `to`.
pub fn energy_between(model: &(impl DiffusionModel + ?Sized), from: f64, to: f64) -> f64 {
    static RULE: LazyLock<GaussLegendre> = LazyLock::new(|| GaussLegendre::new(16));
    let from = if from > 0.0 { from } else { to / REACH };
    if !(to > from) {
        return 0.0;
    }
    let (start, end) = (from.ln(), to.ln());
    let panels = (end - start).ceil().max(1.0);
    let width = (end - start) / panels;
    (0..panels as usize)
        .map(|i| {
            let left = start + width * i as f64;
            RULE.integrate(left, left + width, |log_radius| {
                let radius = log_radius.exp();
                model.reflectance(radius) * TAU * radius * radius
            })
        })
        .sum()
}

/// ∫₀^∞ R(r) 2πr dr of a model that changes on the scale of `length`, m (the mean free path).
pub fn total_energy(model: &(impl DiffusionModel + ?Sized), length: f64) -> f64 {
    energy_between(model, length / REACH, length * REACH)
}
