//! The Henyey–Greenstein phase function, in forms without cancellation for every |g| < 1.

use std::f64::consts::PI;

/// The phase function of Henyey and Greenstein (1941) with mean cosine `g` in (−1, 1):
/// p(cosθ) = (1 − g²) / (4π (1 + g² − 2g cosθ)^(3/2)), where cosθ = 1 is straight on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HenyeyGreenstein {
    /// Mean cosine of the angle of deflection.
    pub g: f64,
}

/// A direction of scattering relative to the direction before: cosine and sine of the deflection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deflection {
    /// Cosine.
    pub cos: f64,
    /// Sine, with its own digits near 0.
    pub sin: f64,
}

impl HenyeyGreenstein {
    /// Phase function p(`cos`), 1/sr; its integral over the sphere is 1.
    pub fn density(self, cos: f64) -> f64 {
        let g = self.g;
        // 1 + g² − 2g cos = (1 − |g|)² + 2|g|(1 − cos·sign g): a sum of non-negative terms.
        let forward = 1.0 - cos * 1.0_f64.copysign(g);
        let spread = (1.0 - g.abs()) * (1.0 - g.abs()) + 2.0 * g.abs() * forward.max(0.0);
        (1.0 - g) * (1.0 + g) / (4.0 * PI * spread * spread.sqrt())
    }

    /// The deflection below which the share `xi` in [0, 1] of the *backward* to forward range lies.
    ///
    /// The usual inverse, cosθ = (1 + g² − ((1 − g²)/(1 − g + 2gξ))²)/(2g), divides 0 by 0 as g → 0 and
    /// loses the digits of 1 − cosθ as g → 1. Writing it over one denominator, the factor g divides out and
    ///
    /// 1 − cosθ = 2(1 − ξ)(1 − g)²(1 + gξ)/(1 − g + 2gξ)²,
    /// 1 + cosθ = 2ξ(1 + g)²(1 − g(1 − ξ))/(1 − g + 2gξ)²:
    ///
    /// products of positive factors for every g, whose root is the sine.
    pub fn sample(self, xi: f64) -> Deflection {
        let g = self.g;
        let rest = 1.0 - xi;
        let denominator = (1.0 - g) * rest + (1.0 + g) * xi;
        let scale = 2.0 / (denominator * denominator);
        let below_one = scale * rest * (1.0 - g) * (1.0 - g) * (1.0 + g * xi);
        let above_minus_one = scale * xi * (1.0 + g) * (1.0 + g) * (1.0 - g * rest);
        let cos = if below_one < 1.0 { 1.0 - below_one } else { above_minus_one - 1.0 };
        Deflection { cos, sin: (below_one * above_minus_one).sqrt() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::quadrature::GaussLegendre;

    /// The textbook inverse, which fails at both ends of g.
    fn textbook(g: f64, xi: f64) -> f64 {
        let ratio = (1.0 - g * g) / (1.0 - g + 2.0 * g * xi);
        (1.0 + g * g - ratio * ratio) / (2.0 * g)
    }

    #[test]
    fn integrates_to_one_with_mean_cosine_g() {
        let rule = GaussLegendre::new(200);
        for g in [-0.8, -0.3, 0.0, 1e-9, 0.5, 0.9] {
            let phase = HenyeyGreenstein { g };
            let moment = |k: i32| rule.integrate(-1.0, 1.0, |mu| 2.0 * PI * phase.density(mu) * mu.powi(k));
            // 200 Gauss nodes resolve the peak of g = 0.9 to rounding.
            assert!((moment(0) - 1.0).abs() < 1e-12, "g {g}: {}", moment(0));
            assert!((moment(1) - g).abs() < 1e-12, "g {g}: {}", moment(1));
        }
    }

    #[test]
    fn sampling_inverts_the_cumulative_distribution_for_every_g() {
        let rule = GaussLegendre::new(400);
        for g in [-0.9, -0.5, -1e-12, 0.0, 1e-12, 1e-5, 0.5, 0.9] {
            let phase = HenyeyGreenstein { g };
            for xi in [1e-6, 0.01, 0.3, 0.5, 0.77, 0.999] {
                let cos = phase.sample(xi).cos;
                let below = rule.integrate(-1.0, cos, |mu| 2.0 * PI * phase.density(mu));
                assert!((below - xi).abs() < 1e-12, "g {g} xi {xi}: {below}");
            }
        }
    }

    #[test]
    fn the_sine_keeps_its_digits_where_the_textbook_form_has_none() {
        // g = 1 − 2⁻⁴⁰, exactly representable. Half the photons are deflected by less than the angle of
        // the median, 1 − cosθ = 2·½(1 − g)²(1 + g/2)/(1) with 1 − g + g = 1.
        let step = 2.0_f64.powi(-40);
        let g = 1.0 - step;
        let exact = step * step * (1.0 + 0.5 * g);
        let sine = HenyeyGreenstein { g }.sample(0.5).sin;
        let expected = (exact * (2.0 - exact)).sqrt();
        assert!((sine / expected - 1.0).abs() < 8.0 * f64::EPSILON, "{sine} against {expected}");
        let cos = textbook(g, 0.5);
        let naive = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
        assert!((naive / expected - 1.0).abs() > 0.1, "the textbook form has become usable: {naive}");
        // And at the other end: the textbook form is off by percents at g = 10⁻¹⁵.
        let tiny = 1e-15;
        let (ours, naive) = (HenyeyGreenstein { g: tiny }.sample(0.3).cos, textbook(tiny, 0.3));
        assert!((ours + 0.4).abs() < 1e-14 && (naive + 0.4).abs() > 1e-3, "{ours} {naive}");
    }
}
