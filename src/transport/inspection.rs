//! Materials as the renderer uses them, for whoever looks at one alone.

use glam::{Vec2, Vec3, Vec4};

use super::basis::Tristimulus;
use super::entry::DirectionDependence;
use super::renderer::{Renderer, albedo_factor};
use super::scatterer::{Scatterer, ScattererError, Scattering, Uses};
use super::shading::{Lobes, resolve_bsdf};
use super::spread::Spreading;
use super::world::SurfacePoint;
use crate::diffusion::{Profile, ProfileKind};
use crate::plan::Kernel;
use crate::radiometry::Rgb;
use crate::raycast::RayCaster;
use crate::scene::Method;

/// What a material does to light at a point of its surface.
pub struct Boundaries<'a> {
    /// Where light is scattered where it is met, or enters a body that paths walk in.
    pub lobes: Option<Lobes<'a>>,
    /// Relative index of what is behind, where light that passes the surface changes the medium.
    pub eta: f32,
    /// The same lobes hold light of more than one law of reciprocity, which cannot be told apart.
    pub is_mixed: bool,
    /// True if light leaves the body elsewhere than where it entered.
    pub has_bssrdf: bool,
}

impl<C: RayCaster> Renderer<C> {
    /// What `material` does, in air, where its textures have the coordinates `at` in both sets and vertices are white.
    pub fn boundaries(&self, material: usize, at: Vec2) -> Boundaries<'_> {
        const CAN: u32 = Kernel::Generic.abilities().bits();
        let methods: Vec<Method> = self.world.methods_of(material).collect();
        let is_walked = methods.contains(&Method::Walk);
        let scatterer = self.scatterers[material].as_ref();
        let interface = scatterer.and_then(|scatterer| scatterer.immersed(1.0).interface());
        let has_bssrdf = scatterer.is_some() && methods.iter().any(|&method| method != Method::Walk);
        let bsdf = || resolve_bsdf::<_, _, CAN>(&Tristimulus, self.scene(), material, &surface(at), 1.0);
        let lobes = match interface.filter(|interface| !interface.is_smooth()) {
            _ if scatterer.is_some() && !is_walked => None,
            Some(interface) => Some(Lobes::Interface(interface)),
            None => Some(Lobes::Bsdf(bsdf())),
        };
        let surface = &self.scene().materials[material].surface;
        Boundaries { lobes, eta: surface.eta(), is_mixed: surface.is_mixed(), has_bssrdf }
    }

    /// The BSSRDF of translucent `material` in air under the profile `kind` on a plane; `None` if it has
    /// none. Where its albedo is textured, its factor stands for it.
    ///
    /// # Errors
    /// If there is no such profile of the material.
    pub fn plane_bssrdf(
        &self,
        material: usize,
        kind: ProfileKind,
    ) -> Result<Option<PlaneBssrdf>, ScattererError> {
        let uses = Uses { profile: Some(kind), walked: false, walks: false };
        Ok(Scatterer::new(self.scene(), material, &uses)?.map(|scatterer| PlaneBssrdf { scatterer }))
    }

    /// Profiles that light under the surface of `material` is spread by.
    pub fn profile_of(&self, material: usize) -> Option<ProfileKind> {
        self.scatterers[material].as_ref().and_then(|scatterer| scatterer.profiles().next())
    }
}

/// Diameter of the plane in reduced mean free paths: less than 10⁻³ of the light leaves beyond it, even where nothing is absorbed.
const DIAMETERS: f32 = 1e4;

/// The BSSRDF of a half-space.
pub struct PlaneBssrdf {
    scatterer: Scatterer,
}

impl PlaneBssrdf {
    /// S(x_o, `wo`; x_i, `wi`), 1/(m² sr), by channel, of a plane of normal z with x_o at `offset` (m) from x_i. Both
    /// directions point away from the surface.
    pub fn value(&self, wo: Vec3, wi: Vec3, offset: Vec3) -> Rgb {
        let scattering = self.scattering();
        let Scattering { boundary, local, spreading } = &scattering;
        let distance = offset.length();
        let profile = Rgb::from_fn(|c| match spreading {
            Spreading::Normalized(spread) => spread.profile(c).density(distance),
            Spreading::Shaped(spread) => spread.profile(c).density(distance),
        });
        let table = self.scatterer.immersed(1.0).directional();
        let dependence = table.and_then(|table| DirectionDependence::new(table, local, offset, Vec3::Z));
        let weight = dependence.map_or(Rgb::ONE, |dependence| dependence.weight(wi));
        local.albedo * profile * weight * (boundary.transmittance(wo.z) * boundary.exit_lobe(wi.z))
    }

    /// The distance (m) within which the share `xi` of the light of channel `channel` leaves.
    pub fn sample_distance(&self, channel: usize, xi: f32) -> f32 {
        match self.scattering().spreading {
            Spreading::Normalized(spread) => spread.profile(channel).sample_radius(xi),
            Spreading::Shaped(spread) => spread.profile(channel).sample_radius(xi),
        }
    }

    /// Share of the light that arrives with cosine `mu` that is sent back in all: reflected, or from under the surface.
    pub fn albedo(&self, mu: f32) -> Rgb {
        let scattering = self.scattering();
        let boundary = scattering.boundary;
        Rgb::splat(boundary.reflectance(mu)) + scattering.local.albedo * boundary.transmittance(mu)
    }

    fn scattering(&self) -> Scattering<'_> {
        let thinnest =
            self.scatterer.medium(&Tristimulus, 1.0, albedo_factor).sigma_t_reduced().min_component();
        let diameter = (DIAMETERS / thinnest).clamp(f32::MIN_POSITIVE, f32::MAX);
        self.scatterer.at(&Tristimulus, 1.0, diameter, albedo_factor)
    }
}

/// A point that faces z, where textures have the coordinates `at`.
fn surface(at: Vec2) -> SurfacePoint {
    SurfacePoint {
        position: Vec3::ZERO,
        error: Vec3::ZERO,
        geometric_normal: Vec3::Z,
        shading_normal: Vec3::Z,
        tangent: Vec4::ZERO,
        texture_coordinates: [at; 2],
        color: Vec4::ONE,
        instance: 0,
    }
}
