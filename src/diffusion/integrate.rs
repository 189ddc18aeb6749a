//! Energy of any diffusion model between two radii, by quadrature.

use std::f64::consts::TAU;
use std::sync::LazyLock;

use super::DiffusionModel;
use crate::math::quadrature::GaussLegendre;

/// How far, in units of the length on which a profile changes, its ends are integrated. A profile has
/// at most a pole 1/r and falls at least as 1/r³ in the end, so that less than 10⁻¹² of the energy is left.
const REACH: f64 = 1e13;

/// ∫ R(r) 2πr dr over radii from `from` to `to`, m; both finite, 0 ≤ `from` ≤ `to`; 0 if the range is empty.
///
/// Gauss–Legendre of 16 nodes in ln r on panels of at most one e-fold: power laws and exponentials are
/// integrated to about 10⁻¹⁴. From 0, the integral starts at 10⁻¹³ of `to`.
pub fn energy_between(model: &(impl DiffusionModel + ?Sized), from: f64, to: f64) -> f64 {
    static RULE: LazyLock<GaussLegendre> = LazyLock::new(|| GaussLegendre::new(16));
    energy_by(&RULE, model, from, to)
}

/// [`energy_between`] with the nodes of `rule` on each panel, for models that take long to evaluate.
pub fn energy_by(rule: &GaussLegendre, model: &(impl DiffusionModel + ?Sized), from: f64, to: f64) -> f64 {
    let from = if from > 0.0 { from } else { to / REACH };
    if from >= to || to.is_nan() {
        return 0.0;
    }
    let (start, end) = (from.ln(), to.ln());
    let panels = (end - start).ceil().max(1.0);
    let width = (end - start) / panels;
    (0..panels as usize)
        .map(|i| {
            let left = start + width * i as f64;
            rule.integrate(left, left + width, |log_radius| {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diffusion::{BetterDipole, Dipole, Fit, HalfSpace, NormalizedDiffusionModel};

    fn check(name: &str, model: &dyn DiffusionModel, beyond: &dyn Fn(f64) -> f64) {
        let total = model.albedo();
        assert!((beyond(0.0) / total - 1.0).abs() < 1e-14, "{name}");
        // The reach leaves out 10⁻¹³ at either end, and a thousand nodes are summed.
        assert!((total_energy(model, 1.0) / total - 1.0).abs() < 1e-12, "{name}");
        for (from, to) in [(0.0, 1e-3), (1e-3, 0.1), (0.1, 1.0), (1.0, 30.0)] {
            let exact = beyond(from) - beyond(to);
            // The closed forms cancel: a few ulps of the total.
            let error = energy_between(model, from, to) - exact;
            assert!(error.abs() < 1e-12 * exact + 1e-15 * total, "{name} {from} {to}: {error}");
        }
    }

    #[test]
    fn closed_forms_are_met() {
        for (sigma_a, sigma_s, eta) in [(0.1, 0.9, 1.5), (0.0, 1.0, 1.33), (1e-6, 1.0, 1.0), (0.8, 0.2, 0.8)]
        {
            let half_space = HalfSpace::new(sigma_a, sigma_s, 0.0, eta).unwrap();
            let dipole = Dipole::new(&half_space);
            check("dipole", &dipole, &|radius| dipole.energy_beyond(radius));
            let better = BetterDipole::new(&half_space);
            check("better dipole", &better, &|radius| better.energy_beyond(radius));
        }
        let normalized = NormalizedDiffusionModel::new(Fit::Searchlight, 0.7, 1.0);
        check("normalized diffusion", &normalized, &|radius| normalized.energy_beyond(radius));
    }

    #[test]
    fn empty_ranges_hold_nothing() {
        let model = NormalizedDiffusionModel::new(Fit::Searchlight, 0.7, 1.0);
        assert_eq!(energy_between(&model, 0.0, 0.0), 0.0);
        assert_eq!(energy_between(&model, 2.0, 2.0), 0.0);
    }
}
