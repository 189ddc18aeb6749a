//! What light goes straight through: surfaces that are not there or bend nothing, and what lies between them.

use glam::Vec3;

use super::contact::Contact;
use super::{Entrance, Next, Path, leave, place};
use crate::medium::Medium;
use crate::radiometry::Spectrum;
use crate::raycast::{Ray, RayCaster};
use crate::transport::basis::Basis;
use crate::transport::contact::margin;
use crate::transport::interiors::{Interior, Interiors};
use crate::transport::shading::is_covered;
use crate::transport::substance::Substance;
use crate::transport::world::SurfacePoint;

/// Surfaces with partial coverage that one path may pass.
const MOST_PASSED: u32 = 256;

/// Surfaces that one shadow ray may pass.
const MOST_CROSSED: u32 = 256;

impl<C: RayCaster, B: Basis<N>, const N: usize, const CAN: u32> Path<'_, C, B, N, CAN> {
    /// True if the surface is there, where it is there in part.
    pub(super) fn covers(&mut self, material: usize, surface: &SurfacePoint) -> bool {
        self.passed += 1;
        if self.passed > MOST_PASSED {
            return true;
        }
        let u = self.stream.quad(place::COVERAGE + self.passed)[0];
        is_covered::<CAN>(self.renderer.world.scene(), material, surface, u)
    }

    /// True if a ray in `direction` goes straight through the boundary at `surface`: where indices are equal, beyond all
    /// boundaries that lie in one place with it, where another body displaces the one that ends here, and where the path is not on the side that it comes from, because
    /// parts of a mesh overlap or have holes.
    pub(super) fn passes(&self, surface: &SurfacePoint, direction: Vec3) -> bool {
        let world = &self.renderer.world;
        let Some(body) = world.interior(surface.instance) else { return false };
        let inwards = direction.dot(surface.geometric_normal) < 0.0;
        let depth = self.interiors.depth_in(surface.instance);
        let expected = if inwards { 0 } else { 1 };
        if depth == expected && !self.contacts(surface, inwards).is_empty() {
            return self.interiors.ior() == self.interiors_beyond(surface, inwards).ior();
        }
        let bends_nothing = || body.ior == self.interiors.ior_around(surface.instance);
        if world.is_walked(surface.instance) && (depth != expected || bends_nothing()) {
            return true;
        }
        self.interiors.displacing(body).any(|other| self.bounds(other).contains(surface.position))
    }

    /// Follows a ray in `direction` straight through the boundary at `surface`.
    pub(super) fn pass(&mut self, surface: &SurfacePoint, direction: Vec3) -> Option<Next> {
        self.counts_flight()?;
        let next = Next { origin: leave(surface, direction), direction };
        self.entrance = Some(Entrance::new(surface, next.origin));
        self.cross(surface, direction.dot(surface.geometric_normal) < 0.0);
        Some(next)
    }

    /// Enters or leaves the body of `surface`, and those whose boundary lies in the same place.
    pub(super) fn cross(&mut self, surface: &SurfacePoint, inwards: bool) {
        let mut interiors = self.interiors;
        self.cross_in(&mut interiors, surface, inwards);
        self.interiors = interiors;
    }

    /// The same with `interiors` in the place of the path's own.
    pub(super) fn cross_in(&self, interiors: &mut Interiors<N>, surface: &SurfacePoint, inwards: bool) {
        let contacts = self.contacts(surface, inwards);
        let here = Contact { surface: *surface, inwards };
        let crossed = || contacts.iter().chain([&here]);
        // Bodies are left before others are entered, whose medium may depend on what is around them.
        for Contact { surface, inwards } in crossed() {
            if !inwards || self.renderer.world.interior(surface.instance).is_none() {
                interiors.leave(surface.instance);
            }
        }
        for Contact { surface, .. } in crossed().filter(|contact| contact.inwards) {
            if let Some(interior) = self.interior(surface, interiors) {
                interiors.enter(interior);
            }
        }
    }

    /// The inside of the body of `surface` amid `interiors`, if paths go there.
    fn interior(&self, surface: &SurfacePoint, interiors: &Interiors<N>) -> Option<Interior<N>> {
        let Interior { instance, diameter, ior, medium } = self.renderer.world.interior(surface.instance)?;
        let scattering = if Self::WALKS { self.medium_inside(surface, interiors) } else { None };
        let Substance::Material(material) = self.renderer.world.substance(instance) else { return None };
        let clear = || Medium::clear(self.basis.absorption(material, medium.sigma_a));
        let medium = scattering.unwrap_or_else(clear);
        Some(Interior { instance, diameter, ior: self.basis.ior(material, ior, 0), medium })
    }

    /// What scatters in the body of `surface` amid `interiors`, if paths walk there. Textures are looked up where light enters.
    fn medium_inside(&self, surface: &SurfacePoint, interiors: &Interiors<N>) -> Option<Medium<N>> {
        let world = &self.renderer.world;
        if !world.is_walked(surface.instance) {
            return None;
        }
        let Substance::Material(material) = world.substance(surface.instance) else { return None };
        let around = interiors.ior_around(surface.instance);
        let scatterer = self.renderer.scatterers[material].as_ref()?;
        Some(scatterer.medium(&self.basis, around, |input| self.wanted_albedo(material, input, surface)))
    }

    pub(super) fn bounds(&self, body: &Interior<N>) -> Bounds {
        self.bounds_of(body.instance)
    }

    pub(super) fn bounds_of(&self, instance: u32) -> Bounds {
        let (low, high) = self.renderer.world.bounds(instance);
        Bounds { low, high }
    }

    /// Share of light from `direction`, `distance` away, that arrives at `surface`, on whichever side.
    pub(super) fn arrival(&mut self, surface: &SurfacePoint, direction: Vec3, distance: f32) -> Spectrum<N> {
        let origin = leave(surface, direction);
        let world = &self.renderer.world;
        let inwards = direction.dot(surface.geometric_normal) < 0.0;
        let crosses = Self::INTERIORS
            && world.has_interiors()
            && world.interior(surface.instance).is_some()
            && inwards != (self.interiors.depth_in(surface.instance) > 0);
        if !crosses {
            return self.transmittance(origin, direction, distance);
        }
        let here = self.interiors;
        self.cross(surface, inwards);
        let arrives = self.transmittance(origin, direction, distance);
        self.interiors = here;
        arrives
    }

    /// Share of light that arrives unscattered over `distance`.
    pub(super) fn transmittance(&mut self, origin: Vec3, direction: Vec3, distance: f32) -> Spectrum<N> {
        let world = &self.renderer.world;
        // Short of the light, whose own surface would occlude it.
        let ray = Ray { origin, direction, t_max: distance * (1.0 - 1e-4) };
        let may_pass =
            Self::COVERAGE && world.has_partial_coverage() || Self::WALKS && self.renderer.has_passages;
        if may_pass {
            let here = self.interiors;
            let arrives = self.transmittance_through(ray, distance);
            self.interiors = here;
            return arrives.unwrap_or(Spectrum::ZERO);
        }
        self.counters.rays += 1;
        if world.caster().occluded(&ray) {
            return Spectrum::ZERO;
        }
        self.attenuation(distance)
    }

    /// The same through surfaces that light passes; the path's interiors become those at its end.
    fn transmittance_through(&mut self, mut ray: Ray, distance: f32) -> Option<Spectrum<N>> {
        let world = &self.renderer.world;
        let (direction, end) = (ray.direction, ray.at(ray.t_max));
        let mut arrives = Spectrum::ONE;
        let mut rest = distance;
        for _ in 0..MOST_CROSSED {
            self.counters.rays += 1;
            let Some(hit) = world.caster().closest(&ray) else {
                return Some(arrives * self.last_attenuation(ray.origin, direction, rest)?);
            };
            let surface = world.surface::<CAN>(&hit);
            let Substance::Material(material) = world.substance(hit.instance) else { return None };
            arrives *= self.attenuation(hit.t);
            if Self::COVERAGE && world.has_partial_coverage() && !self.covers(material, &surface) {
                // Nothing is there.
            } else if Self::WALKS && self.renderer.has_passages && self.passes(&surface, direction) {
                self.cross(&surface, direction.dot(surface.geometric_normal) < 0.0);
            } else {
                return None;
            }
            ray.origin = leave(&surface, direction);
            rest -= hit.t;
            if distance.is_finite() {
                ray.t_max = (end - ray.origin).dot(direction);
            }
        }
        None
    }

    /// Attenuation from `origin` to the end of a ray that nothing is in the way of any more.
    fn last_attenuation(&self, origin: Vec3, direction: Vec3, distance: f32) -> Option<Spectrum<N>> {
        let Some(body) = self.interiors.current().filter(|body| Self::WALKS && body.medium.scatters()) else {
            return Some(self.attenuation(distance));
        };
        let reach = self.bounds(&body).exit(origin, direction);
        if distance > reach && body.ior != self.interiors.ior_around(body.instance) {
            // Through a hole of a body that refracts. Walks find that light.
            return None;
        }
        Some(self.attenuation(distance.min(reach)))
    }

    /// Share of light that goes on unscattered over `distance` where the path is.
    fn attenuation(&self, distance: f32) -> Spectrum<N> {
        let body = if Self::INTERIORS { self.interiors.current() } else { None };
        match body {
            Some(body) => body.medium.sigma_t().map(|s| if s > 0.0 { (-s * distance).exp() } else { 1.0 }),
            None => Spectrum::ONE,
        }
    }
}

/// The bounding box of a body.
#[derive(Clone, Copy)]
pub(super) struct Bounds {
    low: Vec3,
    high: Vec3,
}

impl Bounds {
    /// True if `position` is inside, up to the rounding of a flight that ends at a face.
    pub fn contains(&self, position: Vec3) -> bool {
        let margin = self.margin();
        position.cmpge(self.low - margin).all() && position.cmple(self.high + margin).all()
    }

    /// Distance along unit `direction` at which a ray from inside leaves.
    pub fn exit(&self, origin: Vec3, direction: Vec3) -> f32 {
        let face = Vec3::select(direction.cmpgt(Vec3::ZERO), self.high, self.low);
        // A direction along a face never meets it: 0/0 is left out by `min`.
        let distances = (face - origin) / direction;
        distances.to_array().into_iter().fold(f32::INFINITY, f32::min).max(0.0)
    }

    /// The shortest side, m.
    pub fn width(&self) -> f32 {
        (self.high - self.low).min_element()
    }

    /// More than the rounding of a position in it, m.
    pub fn margin(&self) -> f32 {
        margin(self.low, self.high)
    }
}
