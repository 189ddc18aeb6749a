//! Where light of different wavelengths parts.
//!
//! A path that carries several wavelengths goes where the first of them goes, the hero, which is any of them with the same probability. At the
//! boundary of a body whose index of refraction depends on the wavelength, the others would be refracted elsewhere: they end, and the hero
//! weighs as much as all. That is the balance heuristic over the wavelengths that could have been the hero: none of the others could have gone
//! this way (Wilkie et al. 2014, "Hero Wavelength Spectral Sampling"). What is reflected goes the same way at each, so that the path is kept together:
//! whether light is reflected is decided by the mean of the reflectances, which all of them could have done alike.

use super::Path;
use crate::optics::fresnel_dielectric;
use crate::radiometry::Spectrum;
use crate::raycast::RayCaster;
use crate::transport::basis::Basis;
use crate::transport::substance::Substance;

/// The largest number below 1.
const ONE_BELOW: f32 = 1.0 - 0.5 * f32::EPSILON;

impl<C: RayCaster, B: Basis<N>, const N: usize, const CAN: u32> Path<'_, C, B, N, CAN> {
    /// Only the first channel goes on, and stands for all.
    pub(super) fn leave_others(&mut self) {
        self.is_alone = true;
        let first = self.throughput[0] * N as f32;
        self.throughput = Spectrum::from_fn(|c| if c == 0 { first } else { 0.0 });
    }

    /// True if the index of refraction around the path depends on the wavelength.
    pub(super) fn is_in_dispersive_body(&self) -> bool {
        let world = &self.renderer.world;
        let is_dispersive = |instance: u32| match world.substance(instance) {
            Substance::Material(material) => self.basis.is_dispersive(material),
            Substance::Light(_) => false,
        };
        self.interiors.iter().any(|body| is_dispersive(body.instance))
    }

    /// Decides by `lobe`, a number in [0, 1), whether light is reflected by the smooth boundary of `material`, which is surrounded by index
    /// `around` and seen under the cosine `cosine`; returns the number by which its lobes decide alike.
    pub(super) fn disperse(&mut self, material: usize, around: f32, cosine: f32, lobe: f32) -> f32 {
        let reflectance = |c: usize| {
            let eta = self.basis.ior(material, 1.0, c) / around;
            fresnel_dielectric(cosine, eta).reflectance
        };
        let reflectances = Spectrum::<N>::from_fn(reflectance);
        let mean = reflectances.mean();
        if lobe < mean && reflectances[0] > 0.0 {
            self.throughput *= reflectances / mean;
            return 0.0;
        }
        self.leave_others();
        // Where the hero is totally reflected nothing of it is left, and the lobes, which cannot do otherwise, reflect it with no weight.
        self.throughput *= (1.0 - reflectances[0]) / (1.0 - mean).max(f32::MIN_POSITIVE);
        ONE_BELOW
    }
}
