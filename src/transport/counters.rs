//! What happened on the way: counted in every render, printed where it matters.

use serde::Serialize;

/// Counts of probe rays for the area integral.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ProbeCounters {
    /// Probe segments cast.
    pub cast: u64,
    /// Probe segments that crossed nothing.
    pub missed: u64,
    /// Crossings found.
    pub hits: u64,
    /// Area integrals in which no probe found the body; light then leaves where it entered.
    pub overflowed: u64,
}

/// Counts over all samples of a render.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counters {
    /// Directions drawn and discarded because density or geometry left no valid one.
    pub rejected: u64,
    /// Paths cut by a limit on their length instead of ended by roulette or escape.
    pub capped_paths: u64,
    /// Collisions inside scattering bodies.
    pub collisions: u64,
    /// Steps to the surface of a sphere, each in the place of many collisions.
    pub sphere_steps: u64,
    /// Walks that left a body where its mesh has no surface.
    pub open_walks: u64,
    /// Area integrals evaluated.
    pub area_integrals: u64,
    /// Ray queries that were not probes.
    pub rays: u64,
    /// Probe rays.
    pub probes: ProbeCounters,
}

impl Counters {
    /// Adds the counts of `other`.
    pub fn merge(&mut self, other: &Self) {
        self.rejected += other.rejected;
        self.capped_paths += other.capped_paths;
        self.collisions += other.collisions;
        self.sphere_steps += other.sphere_steps;
        self.open_walks += other.open_walks;
        self.area_integrals += other.area_integrals;
        self.rays += other.rays;
        self.probes.cast += other.probes.cast;
        self.probes.missed += other.probes.missed;
        self.probes.hits += other.probes.hits;
        self.probes.overflowed += other.probes.overflowed;
    }
}
