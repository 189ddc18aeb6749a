//! Where bodies touch: boundaries that lie in one place are crossed as one.
//!
//! A path that crosses a surface goes on at a distance beyond it that is larger than the rounding of where it lies. If another body
//! begins or ends within that distance, the next ray would not meet its boundary. So it is crossed along with the surface, and light
//! is refracted once, by the index of what is before all of these boundaries and that of what is behind them.

use std::cell::RefCell;

use arrayvec::ArrayVec;

use super::{Path, leave};
use crate::raycast::{Hit, Ray, RayCaster};
use crate::transport::basis::Basis;
use crate::transport::interiors::Interiors;
use crate::transport::world::SurfacePoint;

/// Bodies that meet in one place, at most: what else is there is not crossed.
const MOST: usize = 4;

/// A boundary that is crossed along with another.
#[derive(Clone, Copy)]
pub(super) struct Contact {
    pub surface: SurfacePoint,
    pub inwards: bool,
}

thread_local! {
    static HITS: RefCell<Vec<Hit>> = const { RefCell::new(Vec::new()) };
}

impl<C: RayCaster, B: Basis<N>, const N: usize, const CAN: u32> Path<'_, C, B, N, CAN> {
    /// The boundaries of other bodies that a path which goes through `surface`, into its body if `inwards`, crosses there.
    pub(super) fn contacts(&self, surface: &SurfacePoint, inwards: bool) -> ArrayVec<Contact, MOST> {
        let mut contacts = ArrayVec::new();
        let world = &self.renderer.world;
        let neighbours = if Self::WALKS { world.neighbours(surface.instance) } else { &[] };
        let near = |&&body: &&u32| self.bounds_of(body).contains(surface.position);
        for &body in neighbours.iter().filter(near) {
            if !contacts.is_full() {
                contacts.extend(self.contact(surface, inwards, body));
            }
        }
        contacts
    }

    /// The boundary of `body` that the path crosses with `surface`, if it then is on another side of it than before.
    fn contact(&self, surface: &SurfacePoint, inwards: bool, body: u32) -> Option<Contact> {
        let world = &self.renderer.world;
        let inward = -surface.geometric_normal;
        let ahead = if inwards { inward } else { -inward };
        let (before, behind) = (leave(surface, -ahead), leave(surface, ahead));
        let ray = Ray { origin: before, direction: behind - before, t_max: 1.0 };
        HITS.with_borrow_mut(|hits| {
            world.caster().all_hits(&ray, body, hits);
            hits.sort_unstable_by(|a, b| a.t.total_cmp(&b.t));
            let was_inside = self.interiors.depth_in(body) > 0;
            let (mut is_inside, mut last) = (was_inside, None);
            for hit in hits.iter() {
                let enters = world.geometric_normal(hit).dot(ahead) < 0.0;
                // A crossing in an edge comes twice, one that contradicts where the path is not at all.
                if enters != is_inside {
                    (is_inside, last) = (enters, Some(*hit));
                }
            }
            let hit = last.filter(|_| is_inside != was_inside)?;
            Some(Contact { surface: world.surface::<CAN>(&hit), inwards: is_inside })
        })
    }

    /// The bodies that the path is inside of beyond `surface`.
    pub(super) fn interiors_beyond(&self, surface: &SurfacePoint, inwards: bool) -> Interiors<N> {
        let mut interiors = self.interiors;
        self.cross_in(&mut interiors, surface, inwards);
        interiors
    }

    /// Index of refraction on the outside of the boundary at `surface`, to which the path comes from inside if it goes outwards.
    pub(super) fn ior_outside(&self, surface: &SurfacePoint, inwards: bool) -> f32 {
        if Self::WALKS && !inwards && !self.contacts(surface, inwards).is_empty() {
            return self.interiors_beyond(surface, inwards).ior();
        }
        self.ior_around(surface.instance)
    }
}
