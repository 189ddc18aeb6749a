//! Scattering at surfaces that act where they are hit.

use glam::Vec3;

use super::{Entrance, Next, Origin, Path, leave, place};
use crate::math::Frame;
use crate::radiometry::Spectrum;
use crate::raycast::RayCaster;
use crate::scene::ScatteringInput;
use crate::transport::basis::Basis;
use crate::transport::entry::Response;
use crate::transport::light_choice::Receiver;
use crate::transport::renderer::Renderer;
use crate::transport::shading::{Lobes, Orientation, color, resolve_bsdf};
use crate::transport::spectra::Part;
use crate::transport::world::SurfacePoint;

impl<'a, C: RayCaster, B: Basis<N>, const N: usize, const CAN: u32> Path<'a, C, B, N, CAN> {
    /// Scatters at a surface that acts where it is hit.
    pub(super) fn scatter_bsdf(&mut self, material: usize, surface: &SurfacePoint, wo: Vec3) -> Option<Next> {
        let world = &self.renderer.world;
        let around = self.ior_outside(surface, wo.dot(surface.geometric_normal) > 0.0);
        let bsdf = self.lobes(material, surface, around);
        let disperses = B::DISPERSES && !self.is_alone && self.basis.is_dispersive(material);
        if disperses && !bsdf.is_smooth_dielectric() {
            self.leave_others();
        }
        // Only the boundary of a body knows inside from outside.
        let two_sided = !Self::INTERIORS || world.interior(surface.instance).is_none();
        let mut orientation = Orientation::new::<CAN>(world.scene(), material, surface, wo, two_sided);
        let frame = Frame::from_normal(orientation.shading);
        let local_wo = frame.to_local(wo);
        let receiver = Receiver {
            position: surface.position,
            normal: (!bsdf.transmits()).then_some(orientation.geometric),
        };
        if !bsdf.is_delta_only() {
            self.add_direct(place::LIGHT, surface, &receiver, |wi| {
                response(&bsdf, &orientation, &frame, local_wo, wi)
            });
        }
        let [mut lobe, u, v, _] = self.stream.quad(self.set(place::SCATTER));
        if disperses && !self.is_alone {
            lobe = self.disperse(material, around, local_wo.z, lobe);
        }
        let mut sample = bsdf.sample(local_wo, [u, v, lobe], &mut self.random)?;
        let mut direction = frame.to_world(sample.direction);
        if sample.delta && !orientation.agree(direction) {
            // The interpolated normal sends light through the wrong side: use the triangle's own.
            orientation.shading = orientation.geometric;
            let frame = Frame::from_normal(orientation.geometric);
            sample = bsdf.sample(frame.to_local(wo), [u, v, lobe], &mut self.random)?;
            direction = frame.to_world(sample.direction);
        } else if !sample.delta && orientation.folds(direction) {
            if !orientation.agree(direction) {
                direction = orientation.mirrored(direction);
            }
            let Response { value, density } = response(&bsdf, &orientation, &frame, local_wo, direction);
            sample.weight = if density > 0.0 { value / density } else { Spectrum::ZERO };
            sample.density = density;
        }
        if direction.dot(orientation.geometric) == 0.0 {
            self.counters.rejected += 1;
            return None;
        }
        self.throughput *= sample.weight;
        self.scattered_from = (!sample.delta).then_some(Origin { receiver, density: sample.density });
        if Self::INTERIORS && sample.crosses_boundary {
            self.cross(surface, wo.dot(surface.geometric_normal) > 0.0);
        }
        let next = Next { origin: leave(surface, direction), direction };
        if Self::WALKS {
            self.entrance = Some(Entrance::new(surface, next.origin));
        }
        Some(next)
    }

    /// The albedo asked for at a point, where the input is one.
    pub(super) fn wanted_albedo(
        &self,
        material: usize,
        input: &ScatteringInput,
        surface: &SurfacePoint,
    ) -> Spectrum<N> {
        match input {
            ScatteringInput::Albedo { albedo, .. } => {
                let rgb = color::<CAN>(self.renderer.world.scene(), albedo, surface);
                self.basis.share(material, Part::Surface, albedo, rgb)
            }
            ScatteringInput::Coefficients { .. } | ScatteringInput::Spectral { .. } => Spectrum::ZERO,
        }
    }

    /// What scatters light at a surface that acts where it is hit.
    fn lobes(&self, material: usize, surface: &SurfacePoint, around: f32) -> Lobes<'a, N> {
        let Renderer { world, scatterers, .. } = self.renderer;
        let walked = if Self::WALKS { scatterers[material].as_ref() } else { None };
        let interface = walked.and_then(|scatterer| scatterer.immersed(around).interface());
        match interface.filter(|interface| !interface.is_smooth()) {
            Some(interface) => Lobes::Interface(interface),
            None => {
                Lobes::Bsdf(resolve_bsdf::<_, _, CAN>(&self.basis, world.scene(), material, surface, around))
            }
        }
    }
}

/// The BSDF towards `wi` and the density that samples it, around the shading normal `frame` and folded by
/// the plane of the triangle.
fn response<const N: usize>(
    bsdf: &Lobes<N>,
    orientation: &Orientation,
    frame: &Frame,
    local_wo: Vec3,
    wi: Vec3,
) -> Response<N> {
    let mut response = Response { value: Spectrum::ZERO, density: 0.0 };
    for direction in orientation.unfolded(wi) {
        let local = frame.to_local(direction);
        response.value += bsdf.evaluate(local_wo, local);
        response.density += bsdf.density(local_wo, local);
    }
    response
}
