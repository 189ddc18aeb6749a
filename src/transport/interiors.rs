//! Which bodies a path is inside of.

use std::cmp::Ordering;

use crate::medium::Medium;

/// The inside of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interior<const N: usize = 3> {
    /// The body.
    pub instance: u32,
    /// Its diameter, m: where bodies overlap, the smallest counts.
    pub diameter: f32,
    /// Index of refraction.
    pub ior: f32,
    /// What fills it.
    pub medium: Medium<N>,
}

impl<const N: usize> Interior<N> {
    /// Greater is what displaces the other.
    fn precedence<const M: usize>(&self, other: &Interior<M>) -> Ordering {
        other.diameter.total_cmp(&self.diameter).then(self.instance.cmp(&other.instance))
    }
}

/// Bodies nested deeper than this are not told apart.
const DEPTH: usize = 8;

/// The bodies a path is inside of, the one that fills the point last. Where bodies overlap it is the smallest, so
/// that milk that reaches into its glass is milk there, whatever way a path came.
#[derive(Clone, Copy, Debug)]
pub struct Interiors<const N: usize = 3> {
    bodies: [Option<Interior<N>>; DEPTH],
    count: usize,
}

impl<const N: usize> Default for Interiors<N> {
    fn default() -> Self {
        Self { bodies: [None; DEPTH], count: 0 }
    }
}

impl<const N: usize> Interiors<N> {
    /// The path enters a body.
    pub fn enter(&mut self, interior: Interior<N>) {
        if self.count < DEPTH {
            let place = self.iter().take_while(|body| body.precedence(&interior).is_le()).count();
            self.bodies.copy_within(place..self.count, place + 1);
            self.bodies[place] = Some(interior);
            self.count += 1;
        }
    }

    /// The path leaves a body; nothing happens if it was not inside.
    pub fn leave(&mut self, instance: u32) {
        let found = (0..self.count).rev().find(|&i| self.bodies[i].is_some_and(|b| b.instance == instance));
        if let Some(i) = found {
            self.bodies.copy_within(i + 1..self.count, i);
            self.count -= 1;
        }
    }

    /// The bodies, the one that fills the point last.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &Interior<N>> {
        self.bodies[..self.count].iter().flatten()
    }

    /// The same bodies, each through `f`.
    pub fn map<const M: usize>(&self, f: impl Fn(&Interior<N>) -> Interior<M>) -> Interiors<M> {
        Interiors { bodies: self.bodies.each_ref().map(|body| body.as_ref().map(&f)), count: self.count }
    }

    /// The body that fills the point.
    pub fn current(&self) -> Option<Interior<N>> {
        self.count.checked_sub(1).and_then(|i| self.bodies[i])
    }

    /// Index of refraction of what fills the point.
    pub fn ior(&self) -> f32 {
        self.current().map_or(1.0, |body| body.ior)
    }

    /// Index of refraction around the boundary of `instance`, as if the path were outside of it.
    pub fn ior_around(&self, instance: u32) -> f32 {
        self.iter().rev().find(|body| body.instance != instance).map_or(1.0, |body| body.ior)
    }

    /// How many times the path has entered `instance` and not left it: more than once where the parts of a mesh overlap.
    pub fn depth_in(&self, instance: u32) -> usize {
        self.iter().filter(|body| body.instance == instance).count()
    }

    /// The bodies that displace `interior`.
    pub fn displacing<const M: usize>(&self, interior: Interior<M>) -> impl Iterator<Item = &Interior<N>> {
        let displaces = move |body: &&Interior<N>| body.precedence(&interior).is_gt();
        self.iter().filter(displaces).filter(move |body| body.instance != interior.instance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::radiometry::Rgb;

    fn body(instance: u32, diameter: f32, ior: f32) -> Interior {
        Interior { instance, diameter, ior, medium: Medium::clear(Rgb::ZERO) }
    }

    #[test]
    fn the_smallest_body_counts_in_whatever_order_bodies_are_entered_and_left() {
        let (glass, milk) = (body(1, 2.0, 1.5), body(2, 1.0, 1.33));
        for order in [[glass, milk], [milk, glass]] {
            let mut interiors = Interiors::default();
            order.into_iter().for_each(|body| interiors.enter(body));
            assert_eq!(interiors.current(), Some(milk));
            assert_eq!(interiors.ior_around(2), 1.5);
            assert_eq!(interiors.displacing(glass).count(), 1);
            assert_eq!(interiors.displacing(milk).count(), 0);
            interiors.leave(1);
            assert_eq!(interiors.current(), Some(milk));
            assert_eq!(interiors.ior_around(2), 1.0);
            interiors.leave(1);
            interiors.leave(2);
            assert!(interiors.current().is_none());
        }
    }

    #[test]
    fn overlapping_parts_of_one_body_are_counted() {
        let mut interiors = Interiors::default();
        let (part, other) = (body(1, 1.0, 1.5), body(2, 1.0, 1.2));
        [part, other, part].into_iter().for_each(|body| interiors.enter(body));
        assert_eq!((interiors.depth_in(1), interiors.depth_in(2)), (2, 1));
        assert_eq!(interiors.displacing(part).count(), 1, "of two as large, the later one");
        interiors.leave(1);
        assert_eq!(interiors.depth_in(1), 1);
    }
}
