//! The better dipole (d'Eon 2012, "A Better Dipole").

use glam::DVec3;

use super::mirrored_source::MirroredSource;
use super::{DiffusionModel, HalfSpace};

/// The dipole with Grosjean's diffusion coefficient and an exitance of fluence and flux. Multiple
/// scattering only, hence α'²: one event puts the light at the source, another lets it spread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BetterDipole {
    source: MirroredSource,
    /// z_r = 1/σ_t', m.
    depth: f64,
    /// α'².
    strength: f64,
}

impl BetterDipole {
    /// The better dipole of `half_space`.
    pub fn new(half_space: &HalfSpace) -> Self {
        Self {
            source: MirroredSource::grosjean(half_space),
            depth: half_space.mean_free_path_reduced(),
            strength: half_space.albedo_reduced().powi(2),
        }
    }

    /// Exitance (1/m² per unit flux) of a surface element of unit `normal_out`, `offset` (m) away from
    /// the point of entry of unit `normal_in`, on a body of any shape. Negative values clamp to 0.
    pub fn reflectance_between(&self, offset: DVec3, normal_in: DVec3, normal_out: DVec3) -> f64 {
        self.strength * self.source.exitance_between(offset, normal_in, normal_out, self.depth)
    }

    /// Energy farther than `radius`, ∫_r^∞ R 2πr' dr', which is also ∫₀^∞ R(√(r² + t²)) 2πr dr with
    /// t = `radius`: the light through a body of that thickness.
    pub fn energy_beyond(&self, radius: f64) -> f64 {
        self.strength * self.source.exitance_beyond(radius, self.depth)
    }
}

impl DiffusionModel for BetterDipole {
    fn reflectance(&self, radius: f64) -> f64 {
        self.strength * self.source.exitance(radius, self.depth)
    }

    fn albedo(&self) -> f64 {
        self.energy_beyond(0.0)
    }
}
