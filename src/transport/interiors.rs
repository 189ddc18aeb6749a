//! Which dielectric bodies a path is inside of.

use crate::radiometry::Rgb;

/// The inside of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interior {
    /// The body.
    pub instance: u32,
    /// Index of refraction.
    pub ior: f32,
    /// Absorption coefficient, 1/m.
    pub sigma_a: Rgb,
}

/// Bodies nested deeper than this are not told apart.
const DEPTH: usize = 8;

/// The bodies a path is inside of, outermost first. A body entered later displaces the ones around it,
/// so the last counts: milk that reaches into its glass is milk there.
#[derive(Clone, Copy, Debug, Default)]
pub struct Interiors {
    bodies: [Option<Interior>; DEPTH],
    count: usize,
}

impl Interiors {
    /// The path enters a body.
    pub fn enter(&mut self, interior: Interior) {
        if self.count < DEPTH {
            self.bodies[self.count] = Some(interior);
            self.count += 1;
        }
    }

    /// Adds a body around all others.
    pub fn surround(&mut self, interior: Option<Interior>) {
        if interior.is_some() && self.count < DEPTH {
            self.bodies.copy_within(0..self.count, 1);
            self.bodies[0] = interior;
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

    /// The body that fills the point.
    pub fn current(&self) -> Option<Interior> {
        self.count.checked_sub(1).and_then(|i| self.bodies[i])
    }

    /// Index of refraction around the boundary of `instance`, as if the path were outside of it.
    pub fn ior_around(&self, instance: u32) -> f32 {
        let around = self.bodies[..self.count].iter().rev().flatten().find(|b| b.instance != instance);
        around.map_or(1.0, |b| b.ior)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body(instance: u32, ior: f32) -> Interior {
        Interior { instance, ior, sigma_a: Rgb::ZERO }
    }

    #[test]
    fn overlapping_bodies_are_left_in_any_order() {
        let mut interiors = Interiors::default();
        interiors.enter(body(1, 1.5));
        interiors.enter(body(2, 1.33));
        assert_eq!(interiors.current().map(|b| b.instance), Some(2));
        assert_eq!(interiors.ior_around(2), 1.5);
        interiors.leave(1);
        assert_eq!(interiors.current().map(|b| b.instance), Some(2));
        assert_eq!(interiors.ior_around(2), 1.0);
        interiors.leave(1);
        interiors.leave(2);
        assert!(interiors.current().is_none());
    }
}
