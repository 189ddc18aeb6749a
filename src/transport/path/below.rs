//! Light under the surface of a translucent body by the area integral.

use super::{Next, Origin, Path, leave, place};
use crate::diffusion::Profile;
use crate::math::Frame;
use crate::radiometry::Spectrum;
use crate::raycast::RayCaster;
use crate::scene::Method;
use crate::transport::area_integral::{AreaIntegral, EntryPoint};
use crate::transport::basis::Basis;
use crate::transport::entry::{DirectionDependence, Entry, Response};
use crate::transport::renderer::Renderer;
use crate::transport::scatterer::Scattering;
use crate::transport::shading::Orientation;
use crate::transport::spread::{Channels, Spread, Spreading};
use crate::transport::world::SurfacePoint;
use glam::Vec3;

impl<'a, C: RayCaster, B: Basis<N>, const N: usize, const CAN: u32> Path<'a, C, B, N, CAN> {
    /// At a translucent body light is reflected by the boundary, or comes from under the surface.
    pub(super) fn scatter_translucent(
        &mut self,
        material: usize,
        surface: &SurfacePoint,
        wo: Vec3,
    ) -> Option<Next> {
        let scene = self.renderer.world.scene();
        let orientation = Orientation::new::<CAN>(scene, material, surface, wo, true);
        let scattering = self.scattering(material, surface)?;
        let boundary = scattering.boundary;
        let frame = Frame::from_normal(orientation.shading);
        let local_wo = frame.to_local(wo);
        let respond = |wi: Vec3| {
            let lobe = |wi| boundary.evaluate_reflection(local_wo, frame.to_local(wi));
            let value: f32 = orientation.unfolded(wi).map(lobe).sum();
            Response { value: Spectrum::splat(value), density: value }
        };
        let receiver = orientation.receiver(surface);
        if !boundary.is_smooth() {
            self.add_direct(place::LIGHT, surface, &receiver, respond);
        }
        // A reflection is drawn and kept with its weight as probability, so that the share E is
        // reflected and 1 − E enters, both with weight 1, and the density of a direction kept is the lobe's value.
        let [lobe, u, v, _] = self.stream.quad(self.set(place::SCATTER));
        let Some(sample) = boundary.sample_reflection(local_wo, [u, v]).filter(|s| lobe < s.weight) else {
            return self.scatter_below(material, surface, &orientation, &scattering);
        };
        let mut direction = frame.to_world(sample.direction);
        if direction.dot(orientation.geometric) <= 0.0 {
            // Below the surface by the interpolated normal only: mirror it up, losing nothing.
            direction = orientation.mirrored(direction);
        }
        self.scattered_from =
            (!boundary.is_smooth()).then(|| Origin { receiver, density: respond(direction).density });
        Some(Next { origin: leave(surface, direction), direction })
    }

    fn scattering(&self, material: usize, surface: &SurfacePoint) -> Option<Scattering<'a, N>> {
        let Renderer { world, scatterers, .. } = self.renderer;
        Some(scatterers[material].as_ref()?.at(
            &self.basis,
            self.ior(),
            world.diameter(surface.instance),
            |input| self.wanted_albedo(material, input, surface),
        ))
    }

    /// The area integral: finds where the light came in, and follows it from there.
    fn scatter_below(
        &mut self,
        material: usize,
        surface: &SurfacePoint,
        orientation: &Orientation,
        scattering: &Scattering<'a, N>,
    ) -> Option<Next> {
        self.throughput *= scattering.local.albedo;
        if self.throughput.is_black() {
            return None;
        }
        let entry = self.find_entry(material, surface, orientation, scattering)?;
        self.add_direct(place::ENTRY_LIGHT, &entry.point, &entry.receiver(), |wi| entry.respond(wi));
        Some(self.leave_entry(&entry))
    }

    /// Draws where the light that leaves at `surface` came in; the throughput takes its weight.
    fn find_entry(
        &mut self,
        material: usize,
        surface: &SurfacePoint,
        orientation: &Orientation,
        scattering: &Scattering<'a, N>,
    ) -> Option<Entry<'a, N>> {
        let renderer = self.renderer;
        let world = &renderer.world;
        let here = Entry {
            point: *surface,
            orientation: *orientation,
            boundary: scattering.boundary,
            dependence: None,
        };
        if world.method(surface.instance) == Some(Method::Diffuse) {
            return Some(here);
        }
        let drawn = match &scattering.spreading {
            Spreading::Normalized(spread) => self.draw_entry(spread, surface, orientation.geometric),
            Spreading::Shaped(spread) => self.draw_entry(spread, surface, orientation.geometric),
        };
        self.throughput *= drawn.weight;
        let Some(hit) = drawn.hit else { return Some(here) };
        let point = world.surface::<CAN>(&hit);
        let orientation = Orientation::on_side::<CAN>(world.scene(), material, &point, orientation.flipped);
        if Self::INTERIORS && world.has_interiors() {
            self.interiors = renderer.interiors_at(
                &self.basis,
                leave(&point, orientation.geometric),
                orientation.geometric,
            );
        }
        let immersed = renderer.scatterers[material].as_ref()?.immersed(self.ior());
        let offset = surface.position - point.position;
        let dependence = immersed.directional().and_then(|table| {
            DirectionDependence::new(table, &scattering.local, offset, orientation.shading)
        });
        Some(Entry { point, orientation, boundary: immersed.boundary(), dependence })
    }

    /// Draws from the area integral around `surface`.
    fn draw_entry<P: Profile + Copy>(
        &mut self,
        spread: &Spread<P, N>,
        surface: &SurfacePoint,
        normal: Vec3,
    ) -> EntryPoint<N> {
        let world = &self.renderer.world;
        let integral = AreaIntegral {
            caster: world.caster(),
            geometric_normal: |hit: &_| world.geometric_normal(hit),
            instance: surface.instance,
            spread,
            channels: Channels::of(self.throughput),
            position: surface.position,
            position_error: surface.error.max_element(),
            normal,
        };
        self.counters.area_integrals += 1;
        integral.sample(&self.stream, self.set(place::PROBE), &mut self.counters.probes)
    }

    /// Follows the light that came in at `entry` to where it came from.
    fn leave_entry(&mut self, entry: &Entry<N>) -> Next {
        let Entry { point, orientation, boundary, .. } = entry;
        let [u, v, _, _] = self.stream.quad(self.set(place::ENTRY));
        let mut direction = Frame::from_normal(orientation.shading).to_world(boundary.sample_exit([u, v]));
        if direction.dot(orientation.geometric) < 0.0 {
            direction = orientation.mirrored(direction);
        }
        let Response { value, density } = entry.respond(direction);
        self.throughput *= if density > 0.0 { value / density } else { Spectrum::ZERO };
        self.scattered_from = Some(Origin { receiver: entry.receiver(), density });
        Next { origin: leave(point, direction), direction }
    }
}
