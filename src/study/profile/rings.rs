//! Rings on a flat surface, two of [`white`] in one but for the first and the last, and light counted in them.

use crate::diffusion::DiffusionModel;
use crate::diffusion::integrate::energy_between;
use crate::slab::Estimate;
use crate::slab::white::{self, DECADES};

/// Rings per decade of radius.
pub const RINGS_PER_DECADE: usize = white::RINGS_PER_DECADE / 2;
/// Rings: one to the axis, the logarithmic ones, one without end.
pub const RINGS: usize = DECADES * RINGS_PER_DECADE + 2;
/// The rings between 10⁻³ and 100 mean free paths, over which errors are summed.
pub const COMPARED: std::ops::Range<usize> = 2 * RINGS_PER_DECADE + 1..7 * RINGS_PER_DECADE + 1;

/// Inner radius of ring `i`, in mean free paths.
pub fn inner_radius(i: usize) -> f64 {
    i.checked_sub(1).map_or(0.0, outer_radius)
}

/// Outer radius of ring `i`, in mean free paths; infinite for the last one.
pub fn outer_radius(i: usize) -> f64 {
    if i + 1 == RINGS {
        return f64::INFINITY;
    }
    white::ring_edge(2 * i)
}

/// Geometric mean of both radii of ring `i`; 0 for the first.
pub fn middle_radius(i: usize) -> f64 {
    (inner_radius(i) * outer_radius(i)).sqrt()
}

/// Area of ring `i`, in squared mean free paths.
pub fn area(i: usize) -> f64 {
    let (inner, outer) = (inner_radius(i), outer_radius(i));
    std::f64::consts::PI * (outer - inner) * (outer + inner)
}

/// The ring that holds points at this squared distance from the axis.
pub fn ring_at(radius_squared: f64) -> usize {
    white::ring(radius_squared).div_ceil(2)
}

/// Light in rings, per unit flux that entered.
#[derive(Clone, Debug, PartialEq)]
pub struct Rings {
    /// In each ring.
    pub flux: Vec<Estimate>,
    /// Within the outer radius of each ring; the last one is the total.
    pub inside: Vec<Estimate>,
}

impl Rings {
    /// What `model` puts there; it is given in mean free paths.
    pub fn of_model(model: &dyn DiffusionModel) -> Self {
        let exact = |value| Estimate { value, standard_error: 0.0 };
        let total = model.albedo();
        let mut flux: Vec<f64> =
            (0..RINGS - 1).map(|i| energy_between(model, inner_radius(i), outer_radius(i))).collect();
        flux.push((total - flux.iter().sum::<f64>()).max(0.0));
        let inside = flux.iter().scan(0.0, |sum, x| {
            *sum += x;
            Some(exact(*sum))
        });
        Self { inside: inside.collect(), flux: flux.iter().copied().map(exact).collect() }
    }

    /// As many times as much light.
    pub fn scaled(&self, factor: f64) -> Self {
        let all = |rings: &[Estimate]| rings.iter().map(|&e| e * factor).collect();
        Self { flux: all(&self.flux), inside: all(&self.inside) }
    }

    /// All of it.
    pub fn total(&self) -> Estimate {
        self.inside.last().copied().unwrap_or_default()
    }

    /// Mean density in ring `i`, per squared mean free path.
    pub fn density(&self, i: usize) -> Estimate {
        self.flux[i] * (1.0 / area(i))
    }

    /// What leaves farther away than `radius`. Inside of a ring the logit of the share within r is taken to be linear in
    /// ln r. With h = ln(10)/12 this errs by h/2e or 3.5 % of the light in that ring at most where the tail is exponential.
    pub fn beyond(&self, radius: f64) -> f64 {
        let ring = ring_at(radius * radius);
        let (inner, outer) = (inner_radius(ring), outer_radius(ring));
        let total = self.total().value;
        let (high, flux) = (self.inside[ring].value, self.flux[ring].value);
        let low = high - flux;
        let position = match () {
            _ if outer.is_infinite() => 0.0,
            _ if inner == 0.0 => radius / outer,
            _ => ((radius / inner).ln() / (outer / inner).ln()).clamp(0.0, 1.0),
        };
        if low > 0.0 && high < total {
            let logit = |inside: f64| (inside / (total - inside)).ln();
            return total / (1.0 + (logit(low) + position * (logit(high) - logit(low))).exp());
        }
        total - low - position * flux
    }

    /// The light in `rings`.
    pub fn sum(&self, rings: std::ops::Range<usize>) -> f64 {
        self.flux[rings].iter().map(|e| e.value).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diffusion::{Fit, NormalizedDiffusionModel};

    #[test]
    fn rings_meet_and_radii_fall_into_them() {
        for i in 1..RINGS - 1 {
            assert_eq!(inner_radius(i), outer_radius(i - 1));
            assert_eq!(ring_at(middle_radius(i).powi(2)), i);
        }
        assert_eq!((ring_at(0.0), ring_at(f64::INFINITY)), (0, RINGS - 1));
        // Rounding of the powers.
        assert!((inner_radius(COMPARED.start) / 1e-3 - 1.0).abs() < 1e-14);
        assert!((outer_radius(COMPARED.end - 1) / 100.0 - 1.0).abs() < 1e-14);
    }

    #[test]
    fn rings_of_a_model_hold_its_energy() {
        let model = NormalizedDiffusionModel::new(Fit::Searchlight, 0.7, 1.0);
        let rings = Rings::of_model(&model);
        // A hundred roundings.
        assert!((rings.total().value - 0.7).abs() < 1e-14);
        for radius in [1e-7, 3e-3, 0.1, 1.0, 2.2, 40.0, 5e3] {
            let ring = rings.flux[ring_at(radius * radius)].value;
            let error = rings.beyond(radius) - model.energy_beyond(radius);
            assert!(error.abs() <= 0.0353 * ring + 1e-14, "{radius}: {error:e} of {ring:e}");
        }
    }
}
