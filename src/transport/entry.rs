//! Where light enters a translucent body, and how it is distributed there.

use glam::{DVec3, Vec3};

use super::light_choice::Receiver;
use super::scatterer::Local;
use super::shading::Orientation;
use super::world::SurfacePoint;
use crate::diffusion::{DirectionalWeight, DirectionalWeightTable};
use crate::math::Frame;
use crate::optics::Boundary;
use crate::radiometry::Spectrum;

/// A lobe's value (BSDF times cosine) and density in a direction.
pub(super) struct Response<const N: usize = 3> {
    pub value: Spectrum<N>,
    pub density: f32,
}

/// A point of entry.
pub(super) struct Entry<'a, const N: usize = 3> {
    pub point: SurfacePoint,
    pub orientation: Orientation,
    pub boundary: &'a Boundary,
    /// Of what leaves at x_o on the direction of entry, where the profile has one.
    pub dependence: Option<DirectionDependence<'a, N>>,
}

impl<const N: usize> Entry<'_, N> {
    /// The outside of the point.
    pub fn receiver(&self) -> Receiver {
        self.orientation.receiver(&self.point)
    }

    /// The lobe S_w cosθ around the shading normal and the density that samples it, folded by the plane
    /// of the triangle.
    pub fn respond(&self, wi: Vec3) -> Response<N> {
        let mut response = Response { value: Spectrum::ZERO, density: 0.0 };
        if wi.dot(self.orientation.geometric) > 0.0 {
            for direction in self.orientation.unfolded(wi) {
                let cos = direction.dot(self.orientation.shading);
                let lobe = Spectrum::splat(self.boundary.exit_lobe(cos) * cos);
                response.value += match &self.dependence {
                    None => lobe,
                    Some(dependence) => lobe * dependence.weight(direction),
                };
                response.density += self.boundary.exit_density(cos);
            }
        }
        response
    }
}

/// The weights of directions of entry by channel, of mean 1 over the lobe of the boundary.
pub(super) struct DirectionDependence<'a, const N: usize = 3> {
    table: &'a DirectionalWeightTable,
    weights: [DirectionalWeight; N],
    /// z is the shading normal at the point of entry, x points to where the light leaves.
    frame: Frame,
}

impl<'a, const N: usize> DirectionDependence<'a, N> {
    /// For light that leaves `offset` away from where it entered, at a point of unit normal `normal`, in a medium
    /// whose lengths are the reduced mean free paths of `local`.
    pub fn new(
        table: &'a DirectionalWeightTable,
        local: &Local<N>,
        offset: Vec3,
        normal: Vec3,
    ) -> Option<Self> {
        let distance = offset.length();
        let at = |c: usize| table.at(local.absorbed[c], distance / local.length[c]);
        let mut weights = [at(0)?; N];
        for (c, weight) in weights.iter_mut().enumerate().skip(1) {
            *weight = at(c)?;
        }
        let mut frame = Frame::from_normal(normal);
        let tangent = (offset - normal * offset.dot(normal)).normalize_or(frame.tangent);
        (frame.tangent, frame.bitangent) = (tangent, normal.cross(tangent));
        Some(Self { table, weights, frame })
    }

    /// The weight of light from unit direction `wi`.
    pub fn weight(&self, wi: Vec3) -> Spectrum<N> {
        let w12: DVec3 = self.table.refracted(self.frame.to_local(wi));
        Spectrum(self.weights.map(|weight| weight.of(w12)))
    }
}
