//! The classical dipole (Jensen et al. 2001, "A Practical Model for Subsurface Light Transport").

use glam::DVec3;

use super::mirrored_source::MirroredSource;
use super::{DiffusionModel, HalfSpace};

/// An isotropic source one mean free path below the surface, and its mirror image. Multiple
/// scattering only; the light of a single scattering event is not in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dipole {
    source: MirroredSource,
    /// z_r = 1/σ_t', m.
    depth: f64,
    /// α'.
    strength: f64,
}

impl Dipole {
    /// The dipole of `half_space`.
    pub fn new(half_space: &HalfSpace) -> Self {
        Self {
            source: MirroredSource::classical(half_space),
            depth: half_space.mean_free_path_reduced(),
            strength: half_space.albedo_reduced(),
        }
    }

    /// Exitance (1/m² per unit flux) of a surface element of unit `normal_out`, `offset` (m) away from
    /// the point of entry of unit `normal_in`, on a body of any shape. Never negative.
    pub fn reflectance_between(&self, offset: DVec3, normal_in: DVec3, normal_out: DVec3) -> f64 {
        self.strength * self.source.exitance_between(offset, normal_in, normal_out, self.depth)
    }

    /// Energy farther than `radius`, ∫_r^∞ R 2πr' dr'. It is also the light through a body of thickness
    /// t = `radius` in the form ∫₀^∞ R(√(r² + t²)) 2πr dr, as both integrals are the same.
    pub fn energy_beyond(&self, radius: f64) -> f64 {
        self.strength * self.source.exitance_beyond(radius, self.depth)
    }
}

impl DiffusionModel for Dipole {
    fn reflectance(&self, radius: f64) -> f64 {
        self.strength * self.source.exitance(radius, self.depth)
    }

    /// α'/2 (1 + e^(−4/3 A √(3(1−α')))) e^(−√(3(1−α'))).
    fn albedo(&self) -> f64 {
        self.energy_beyond(0.0)
    }
}
