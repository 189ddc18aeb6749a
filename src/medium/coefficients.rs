//! Absorption and scattering coefficients, and the order-1 similarity that removes the phase function.

use crate::radiometry::Spectrum;

/// A homogeneous scattering medium with a Henyey–Greenstein phase function.
///
/// Absorption and scattering are kept apart: 1 − albedo would lose its digits where a medium
/// absorbs little.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium<const N: usize = 3> {
    /// Absorption coefficient σ_a, 1/m.
    pub sigma_a: Spectrum<N>,
    /// Scattering coefficient σ_s, 1/m.
    pub sigma_s: Spectrum<N>,
    /// Mean cosine g of the phase function, in (−1, 1).
    pub g: f32,
}

impl<const N: usize> Medium<N> {
    /// A medium that absorbs and does not scatter.
    pub fn clear(sigma_a: Spectrum<N>) -> Self {
        Self { sigma_a, sigma_s: Spectrum::ZERO, g: 0.0 }
    }

    /// Some of its channels.
    pub fn channels<const K: usize>(&self, channels: [usize; K]) -> Medium<K> {
        let of = |values: Spectrum<N>| Spectrum(channels.map(|c| values[c]));
        Medium { sigma_a: of(self.sigma_a), sigma_s: of(self.sigma_s), g: self.g }
    }

    /// True if some channel scatters.
    pub fn scatters(&self) -> bool {
        !self.sigma_s.is_black()
    }

    /// Extinction coefficient σ_t = σ_a + σ_s, 1/m.
    pub fn sigma_t(&self) -> Spectrum<N> {
        self.sigma_a + self.sigma_s
    }

    /// Reduced scattering coefficient σ_s' = σ_s (1 − g), 1/m: isotropic scattering that spreads
    /// light alike (van de Hulst 1980, similarity of order 1).
    pub fn sigma_s_reduced(&self) -> Spectrum<N> {
        self.sigma_s * (1.0 - self.g)
    }

    /// Reduced extinction coefficient σ_t' = σ_a + σ_s', 1/m.
    pub fn sigma_t_reduced(&self) -> Spectrum<N> {
        self.sigma_a + self.sigma_s_reduced()
    }

    /// The medium of reduced coefficients: isotropic scattering that spreads light alike over many collisions.
    pub fn similar(&self) -> Self {
        Self { sigma_a: self.sigma_a, sigma_s: self.sigma_s_reduced(), g: 0.0 }
    }

    /// The share absorbed at a collision of the reduced medium, σ_a/σ_t' = 1 − α'; 0 in vacuum.
    pub fn absorbed_share_reduced(&self) -> Spectrum<N> {
        self.sigma_a.zip(self.sigma_t_reduced(), |a, t| if t > 0.0 { a / t } else { 0.0 })
    }
}
