//! Observers of a walk that count one thing.

use alabaster::slab::{Face, Observer, Photon, Scores};

/// Counts collisions.
#[derive(Default)]
pub struct Collisions(f64);

impl Observer for Collisions {
    fn collide(&mut self, photon: &Photon) {
        self.0 += photon.weight;
    }

    fn leave(&mut self, _photon: &Photon, _face: Face) {}

    fn reflect_at_entry(&mut self, _weight: f64, _cosine: f64) {}
}

impl Scores for Collisions {
    fn sums(&self) -> Vec<f64> {
        vec![self.0]
    }
}

/// Light that leaves at the top by ring: all of it, then what collided once.
pub struct Rings<'a> {
    /// Outer edges.
    edges: &'a [f64],
    left: Vec<f64>,
}

impl<'a> Rings<'a> {
    pub fn new(edges: &'a [f64]) -> Self {
        Self { edges, left: vec![0.0; 2 * edges.len()] }
    }
}

impl Observer for Rings<'_> {
    fn collide(&mut self, _photon: &Photon) {}

    fn leave(&mut self, photon: &Photon, _face: Face) {
        let ring = self.edges.partition_point(|edge| edge * edge <= photon.radius_squared());
        if ring < self.edges.len() {
            self.left[ring] += photon.weight;
            if photon.collisions == 1 {
                self.left[self.edges.len() + ring] += photon.weight;
            }
        }
    }

    fn reflect_at_entry(&mut self, _weight: f64, _cosine: f64) {}
}

impl Scores for Rings<'_> {
    fn sums(&self) -> Vec<f64> {
        self.left.clone()
    }
}
