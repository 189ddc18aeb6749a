//! The laws that lead from one quantity of light to another. What is not physics does not compile.
//!
//! ```
//! use std::time::Duration;
//! use alabaster::radiometry::{Area, Irradiance, ProjectedSolidAngle, Radiance, RadiantEnergy, RadiantFlux, Wavelength};
//!
//! // E = ∫ L cosθ dω of a sky of the same radiance everywhere, Φ = ∫ E dA, Q = ∫ Φ dt.
//! let irradiance: Irradiance = Radiance(2.0).irradiance(ProjectedSolidAngle::HEMISPHERE);
//! let flux: RadiantFlux = irradiance * Area(0.5);
//! let energy: RadiantEnergy = flux * Duration::from_secs(3);
//! let photons = energy / Wavelength::from_nanometres(550.0)?.photon_energy();
//! assert!((energy.0 - 3.0 * std::f64::consts::PI).abs() < 1e-15 * 30.0 && photons > 2e19);
//! # Ok::<(), alabaster::radiometry::WavelengthError>(())
//! ```
//!
//! A solid angle is not a projected one: the cosine must be said.
//! ```compile_fail,E0308
//! # use alabaster::radiometry::*;
//! let irradiance = Radiance(2.0).irradiance(SolidAngle::HEMISPHERE);
//! ```
//! Radiance times area is no power: that takes a solid angle too.
//! ```compile_fail,E0277
//! # use alabaster::radiometry::*;
//! let flux: RadiantFlux = Radiance(2.0) * Area(1.0);
//! ```
//! Light that arrives is not light that leaves.
//! ```compile_fail,E0308
//! # use alabaster::radiometry::*;
//! let sum = Irradiance(1.0) + Exitance(1.0);
//! ```
//! An intensity is not a radiance: a point has no area.
//! ```compile_fail,E0308
//! # use alabaster::radiometry::*;
//! let radiance: Radiance = RadiantIntensity(1.0);
//! ```
//! Power is energy only over a time, and a spectral quantity a whole one only over an interval of wavelengths.
//! ```compile_fail,E0308
//! # use alabaster::radiometry::*;
//! let energy: RadiantEnergy = RadiantFlux(1.0);
//! ```
//! ```compile_fail,E0308
//! # use alabaster::radiometry::*;
//! let flux: RadiantFlux = SpectralFlux(1.0) * 2.0;
//! ```
//! Photons are counted in an energy, not in a power.
//! ```compile_fail,E0277
//! # use alabaster::radiometry::*;
//! # fn count(green: PhotonEnergy) {
//! let photons = RadiantFlux(1.0) / green;
//! # }
//! ```

use std::ops::{Div, Mul};
use std::time::Duration;

use super::quantity::{
    Amount, Area, Bandwidth, Exitance, Irradiance, PhotonEnergy, ProjectedArea, Radiance, RadiantEnergy,
    RadiantFlux, RadiantIntensity, SpectralEnergy, SpectralFlux, SpectralRadiance,
};
use super::solid_angle::{ProjectedSolidAngle, SolidAngle};

/// A density times what it is the density over.
macro_rules! product {
    ($density:ident * $extent:ident = $total:ident) => {
        impl<A: Amount> Mul<$extent> for $density<A> {
            type Output = $total<A>;

            #[inline]
            fn mul(self, extent: $extent) -> $total<A> {
                $total(self.0.scaled(extent.0))
            }
        }
    };
}

/// A total over the extent that it is spread over: its mean density.
macro_rules! quotient {
    ($total:ident / $extent:ident = $density:ident) => {
        impl<A: Amount> Div<$extent> for $total<A> {
            type Output = $density<A>;

            #[inline]
            fn div(self, extent: $extent) -> $density<A> {
                $density(self.0.scaled(1.0 / extent.0))
            }
        }
    };
}

product!(Irradiance * Area = RadiantFlux);
product!(Exitance * Area = RadiantFlux);
product!(RadiantIntensity * SolidAngle = RadiantFlux);
quotient!(RadiantFlux / SolidAngle = RadiantIntensity);
product!(Radiance * ProjectedArea = RadiantIntensity);
quotient!(Irradiance / ProjectedSolidAngle = Radiance);
quotient!(Exitance / ProjectedSolidAngle = Radiance);
product!(SpectralRadiance * Bandwidth = Radiance);
product!(SpectralFlux * Bandwidth = RadiantFlux);
product!(SpectralEnergy * Bandwidth = RadiantEnergy);

impl<A: Amount> Mul<Duration> for RadiantFlux<A> {
    type Output = RadiantEnergy<A>;

    /// Q = Φ Δt.
    fn mul(self, time: Duration) -> RadiantEnergy<A> {
        RadiantEnergy(self.0.scaled(time.as_secs_f64()))
    }
}

impl<A: Amount> Mul<Duration> for SpectralFlux<A> {
    type Output = SpectralEnergy<A>;

    /// Q_λ = Φ_λ Δt.
    fn mul(self, time: Duration) -> SpectralEnergy<A> {
        SpectralEnergy(self.0.scaled(time.as_secs_f64()))
    }
}

impl Div<PhotonEnergy> for RadiantEnergy {
    type Output = f64;

    /// Number of photons that make up the energy.
    fn div(self, photon: PhotonEnergy) -> f64 {
        self.0 / photon.0
    }
}

impl<A: Amount> Radiance<A> {
    /// E = ∫ L cosθ dω of light that arrives with this radiance from all of `extent`.
    #[inline]
    pub fn irradiance(self, extent: ProjectedSolidAngle) -> Irradiance<A> {
        Irradiance(self.0.scaled(extent.0))
    }

    /// M = ∫ L cosθ dω of light that leaves with this radiance to all of `extent`.
    #[inline]
    pub fn exitance(self, extent: ProjectedSolidAngle) -> Exitance<A> {
        Exitance(self.0.scaled(extent.0))
    }
}

impl<A: Amount> RadiantIntensity<A> {
    /// E = I cosθ / r² on a surface `distance` (m) away whose normal makes an angle of cosine `cos` with the
    /// direction to the point: the inverse-square law with Lambert's cosine.
    #[inline]
    pub fn irradiance(self, distance: f64, cos: f64) -> Irradiance<A> {
        Irradiance(self.0.scaled(cos.max(0.0) / (distance * distance)))
    }
}

impl<A: Amount> Irradiance<A> {
    /// What a surface of the given reflectance sends back of it: M = ϱ E.
    #[inline]
    pub fn reflected(self, reflectance: f64) -> Exitance<A> {
        Exitance(self.0.scaled(reflectance))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sampler::HashGenerator;
    use crate::radiometry::{Rgb, Wavelength};
    use std::f64::consts::PI;
    use std::mem::size_of;

    #[test]
    fn a_quantity_is_laid_out_as_its_amount() {
        assert_eq!(size_of::<Radiance>(), size_of::<f64>());
        assert_eq!(size_of::<Irradiance<f32>>(), size_of::<f32>());
        assert_eq!(size_of::<RadiantFlux<Rgb>>(), size_of::<Rgb>());
        assert_eq!(Radiance(1.5).to_string(), "1.5 W/(m² sr)");
    }

    /// A photon of 550 nm, and how many make a watt: by the exact constants of the SI in 30 digits.
    #[test]
    fn photons_are_counted_by_their_energy() {
        let green = Wavelength::from_nanometres(550.0).unwrap().photon_energy();
        assert!((green.0 / 3.611_719_740_270_779e-19 - 1.0).abs() < 4.0 * f64::EPSILON);
        let a_second = RadiantFlux(1.0) * Duration::from_secs(1);
        let photons = a_second / green;
        assert!((photons / 2.768_764_112_148_49e18 - 1.0).abs() < 1e-14, "{photons}");
        assert!((green.of_photons(photons) / a_second - 1.0).abs() < 2.0 * f64::EPSILON);
        for nanometres in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Wavelength::from_nanometres(nanometres).is_err());
        }
    }

    /// E = ∫ L cosθ dω over the hemisphere, by pieces: π L of uniform light.
    #[test]
    fn uniform_light_gives_pi_times_its_radiance() {
        let (rings, radiance) = (1000, Radiance(3.0));
        // Rings of equal steps in cosθ; the midpoint rule is exact for a linear integrand.
        let ring = SolidAngle::HEMISPHERE * (1.0 / f64::from(rings));
        let irradiance: Irradiance = (0..rings)
            .map(|i| radiance.irradiance(ring.projected((f64::from(i) + 0.5) / f64::from(rings))))
            .sum();
        assert!((irradiance.0 / (3.0 * PI) - 1.0).abs() < 1e-13, "{irradiance}");
        assert!((irradiance / ProjectedSolidAngle::HEMISPHERE - radiance).0.abs() < 1e-12);
    }

    /// All the power of a point goes through every sphere around it: Φ = ∫ E dA with E = Φ/(4πr²).
    #[test]
    fn the_flux_through_a_sphere_does_not_depend_on_its_radius() {
        let flux = RadiantFlux(7.0);
        for radius in [1e-3, 1.0, 250.0] {
            let irradiance = (flux / SolidAngle::SPHERE).irradiance(radius, 1.0);
            let through = irradiance * Area(4.0 * PI * radius * radius);
            assert!((through / flux - 1.0).abs() < 4.0 * f64::EPSILON, "{radius}: {through}");
        }
    }

    /// What one small surface sends to another is the same from both ends: L A cosθ ω, étendue.
    #[test]
    fn radiance_is_the_same_at_both_ends_of_a_ray() {
        let mut random = HashGenerator::new(5);
        for _ in 0..100 {
            let mut draw = || 0.1 + f64::from(random.next_f32());
            let (radiance, distance) = (Radiance(draw()), 100.0 * draw());
            let (sender, receiver) = (Area(1e-4 * draw()), Area(1e-4 * draw()));
            let (cos_sent, cos_received) = (draw().min(1.0), draw().min(1.0));
            let seen = |area: ProjectedArea| SolidAngle(area.0 / (distance * distance));
            let sent = radiance * sender.projected(cos_sent) * seen(receiver.projected(cos_received));
            let from = seen(sender.projected(cos_sent)).projected(cos_received);
            let received = radiance.irradiance(from) * receiver;
            assert!((sent / received - 1.0).abs() < 8.0 * f64::EPSILON, "{sent} {received}");
        }
    }

    #[test]
    fn spectral_quantities_add_up_over_wavelengths() {
        let nanometres = |w: f64| Wavelength::from_nanometres(w).unwrap();
        let band = nanometres(600.0) - nanometres(500.0);
        assert_eq!(SpectralFlux(0.02) * band, RadiantFlux(2.0));
        assert_eq!(SpectralFlux(0.02) * Duration::from_secs(2) * band, RadiantEnergy(4.0));
        assert_eq!(SpectralRadiance(0.5) * band, Radiance(50.0));
        let by_channel = Radiance(Rgb::new(1.0, 2.0, 4.0)).irradiance(ProjectedSolidAngle(0.5));
        assert_eq!(by_channel.reflected(0.5), Exitance(Rgb::new(0.25, 0.5, 1.0)));
    }
}
