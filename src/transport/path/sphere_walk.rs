//! Steps of a walk on spheres: from a collision to the surface of a sphere in free space, in the place of the collisions
//! in between.
//!
//! What light does in the sphere is drawn from the exact law ([`crate::medium::sphere_step`]); beyond it a fresh free
//! flight begins. Nothing is approximated. Light that scattered in the sphere is met neither by a camera nor by a light there.
//!
//! **Direct light.** Where a walk draws light directly at every collision, it has to be drawn for those in the sphere too. What leaves
//! it unscattered is light of the collision at its centre, drawn there as ever. All the rest leaves the sphere at a place that does not depend on the
//! direction, with the density D_c(θ)/(2π sin θ) per solid angle: a phase function at the place of exit, by which light
//! is drawn directly and weighted against light found by going on.

use std::f32::consts::TAU;

use glam::Vec3;

use super::{Next, Origin, Path};
use crate::math::{Frame, warp};
use crate::medium::sphere_step::Exit;
use crate::optics::phase::HenyeyGreenstein;
use crate::radiometry::Spectrum;
use crate::raycast::RayCaster;
use crate::transport::basis::Basis;
use crate::transport::clearance::Clearance;
use crate::transport::entry::Response;
use crate::transport::interiors::Interior;
use crate::transport::light_choice::Receiver;
use crate::transport::spheres::{Departures, Similarity, Spheres};
use crate::transport::substance::Substance;

/// What is known of the free space around a walk.
#[derive(Clone, Copy)]
pub(super) struct FreeSpace<'a, const N: usize> {
    clearance: Option<&'a Clearance>,
    spheres: Option<Spheres<'a, N>>,
}

impl<const N: usize> FreeSpace<'_, N> {
    /// The medium that stands for the body's own far from surfaces, if one may.
    pub(super) fn similarity(&self) -> Option<Similarity<N>> {
        self.spheres.as_ref().and_then(Spheres::similarity)
    }
}

impl<'a, C: RayCaster, B: Basis<N>, const N: usize, const CAN: u32> Path<'a, C, B, N, CAN> {
    /// What is known of the free space in `body`.
    pub(super) fn free_space(&self, body: &Interior<N>) -> FreeSpace<'a, N> {
        let clearance = self.renderer.clearance(body.instance);
        // Light from inside a sphere would be drawn for its centre only.
        let spheres = clearance.filter(|_| !self.renderer.is_lit_inside(body.instance));
        let spheres = spheres.and_then(|_| self.spheres(body));
        // Light drawn at collisions would come through the body's own medium.
        let spheres = spheres.filter(|spheres| !spheres.are_similar() || !self.draws_light_in(body));
        FreeSpace { clearance, spheres }
    }

    fn spheres(&self, body: &Interior<N>) -> Option<Spheres<'a, N>> {
        let renderer = self.renderer;
        let Substance::Material(material) = renderer.world.substance(body.instance) else { return None };
        let around = self.interiors.ior_around(body.instance);
        let spheres = self.basis.spheres(renderer.scatterers[material].as_ref()?.immersed(around))?;
        // What the path entered may have been inside something else.
        (*spheres.body() == body.medium).then_some(spheres)
    }

    /// A distance, m, from `point` within which there is no surface; 0 or less where none is known.
    pub(super) fn clear_distance(&self, space: FreeSpace<N>, point: Vec3) -> f32 {
        space.clearance.map_or(0.0, |clearance| clearance.around(point))
    }

    /// After a collision in the medium of the spheres at `center`, `clear` away from any surface: to the surface of a sphere of that radius. `None` if it would
    /// not pay.
    pub(super) fn cross_sphere(
        &mut self,
        space: FreeSpace<N>,
        center: Vec3,
        clear: f32,
        draws_light: bool,
    ) -> Option<Next> {
        let spheres = space.spheres.filter(|spheres| clear >= spheres.least_radius(self.throughput))?;
        self.counters.sphere_steps += 1;
        let departures = spheres.departures(clear, self.throughput);
        let normal = warp::square_to_cone(self.random.next_f32(), self.random.next_f32(), 2.0);
        let place = center + normal * clear;
        if draws_light {
            self.add_direct_inside(&at(center), clear, |_| isotropic());
            let beyond = self.clear_distance(space, place);
            self.add_direct_inside(&at(place), beyond, |direction| {
                let (sin, cos) = (normal.cross(direction).length(), normal.dot(direction));
                per_solid_angle(&departures, sin.atan2(cos), sin)
            });
        }
        let exit = departures.sample(&mut self.random);
        let direction = match exit {
            Exit::Straight => normal,
            Exit::Oblique { angle } => {
                let (sin, cos) = angle.sin_cos();
                let (y, x) = (TAU * self.random.next_f32()).sin_cos();
                Frame::from_normal(normal).to_world(Vec3::new(sin * x, sin * y, cos)).normalize()
            }
        };
        self.scattered_from = draws_light.then(|| match exit {
            Exit::Straight => Origin { receiver: at(center), density: ISOTROPIC.density(0.0) as f32 },
            Exit::Oblique { angle } => {
                let density = per_solid_angle(&departures, angle, angle.sin()).density;
                Origin { receiver: at(place), density }
            }
        });
        self.throughput = departures.carried(exit);
        Some(Next { origin: place, direction })
    }
}

const ISOTROPIC: HenyeyGreenstein = HenyeyGreenstein { g: 0.0 };

fn isotropic<const N: usize>() -> Response<N> {
    let density = ISOTROPIC.density(0.0) as f32;
    Response { value: Spectrum::splat(density), density }
}

/// A point in the medium that light reaches from all sides.
fn at(position: Vec3) -> Receiver {
    Receiver { position, normal: None }
}

/// What leaves a sphere scattered at `angle` to the normal, whose sine is `sin`: per solid angle.
fn per_solid_angle<const N: usize>(departures: &Departures<N>, angle: f32, sin: f32) -> Response<N> {
    // In the direction of the normal, which has no solid angle, nothing.
    if !(0.0..=std::f32::consts::FRAC_PI_2).contains(&angle) || sin == 0.0 {
        return Response { value: Spectrum::ZERO, density: 0.0 };
    }
    let densities = departures.densities(Exit::Oblique { angle });
    let around = 1.0 / (TAU * sin);
    Response { value: densities * around, density: departures.sampled(densities) * around }
}
