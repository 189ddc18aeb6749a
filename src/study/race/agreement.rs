//! Whether two ray casters give the same answers.

use rayon::prelude::*;

use super::Kind;
use super::record::Query;
use crate::raycast::{Hit, Ray, RayCaster};

/// Rays of a thread at a time.
const CHUNK: usize = 1 << 12;

/// Disagreements that are kept as examples.
const EXAMPLES: usize = 8;

/// How answers of one caster compare with those of another.
#[derive(Clone, Debug, Default)]
pub struct Agreement {
    /// Rays compared.
    pub rays: u64,
    /// Rays with the same hits at the same places, to the bit.
    pub identical: u64,
    /// Rays with the same hits, or with one at the same place of a neighbouring triangle, but for rounding.
    pub within_rounding: u64,
    /// Rays of which the second caster does not have a hit that the first has.
    pub missing: u64,
    /// Rays of which the second caster has a hit that the first does not have.
    pub extra: u64,
    /// The first disagreements.
    pub examples: Vec<Disagreement>,
}

/// A ray about which two casters disagree.
#[derive(Clone, Debug)]
pub struct Disagreement {
    /// What it was cast for.
    pub kind: Kind,
    /// The ray.
    pub ray: Ray,
    /// Hits that the first has.
    pub first: Vec<Hit>,
    /// Hits that the second has.
    pub second: Vec<Hit>,
}

impl Agreement {
    /// Compares `first` and `second` on rays of one kind.
    pub fn of(first: &impl RayCaster, second: &impl RayCaster, kind: Kind, queries: &[Query]) -> Self {
        queries
            .par_chunks(CHUNK)
            .map(|chunk| {
                let mut agreement = Self::default();
                chunk.iter().for_each(|query| agreement.compare(first, second, kind, query));
                agreement
            })
            .reduce(Self::default, Self::and)
    }

    /// Both together.
    pub fn and(mut self, other: Self) -> Self {
        self.rays += other.rays;
        self.identical += other.identical;
        self.within_rounding += other.within_rounding;
        self.missing += other.missing;
        self.extra += other.extra;
        self.examples.extend(other.examples);
        self.examples.truncate(EXAMPLES);
        self
    }

    fn compare(&mut self, first: &impl RayCaster, second: &impl RayCaster, kind: Kind, query: &Query) {
        let (a, b) = (hits(first, kind, query), hits(second, kind, query));
        self.rays += 1;
        let lacks = |these: &[Hit], those: &[Hit]| {
            these.iter().any(|hit| !those.iter().any(|other| is_same(&query.ray, hit, other)))
        };
        let (missing, extra) = (lacks(&a, &b), lacks(&b, &a));
        if a == b {
            self.identical += 1;
        } else if !missing && !extra {
            self.within_rounding += 1;
        } else {
            self.missing += u64::from(missing);
            self.extra += u64::from(extra);
            if self.examples.len() < EXAMPLES {
                self.examples.push(Disagreement { kind, ray: query.ray, first: a, second: b });
            }
        }
    }
}

/// What `caster` answers, in the order of the triangles.
fn hits(caster: &impl RayCaster, kind: Kind, query: &Query) -> Vec<Hit> {
    let mut hits = Vec::new();
    match kind {
        Kind::Camera | Kind::Bounce => hits.extend(caster.closest(&query.ray)),
        // Where it is hidden does not matter.
        Kind::Shadow => {
            let hit = Hit { t: 0.0, u: 0.0, v: 0.0, instance: 0, primitive: 0 };
            hits.extend(caster.occluded(&query.ray).then_some(hit));
        }
        Kind::Probe => caster.all_hits(&query.ray, query.instance, &mut hits),
    }
    hits.sort_unstable_by_key(|hit| (hit.instance, hit.primitive));
    hits
}

/// True if both are at the same place but for rounding: of the same triangle, or of two that meet there.
fn is_same(ray: &Ray, a: &Hit, b: &Hit) -> bool {
    let reach = ray.origin.abs().max((ray.at(a.t)).abs()).max_element() / ray.direction.abs().max_element();
    let rounding = 32.0 * f32::EPSILON * reach.max(a.t.abs());
    a.instance == b.instance && (a.t - b.t).abs() <= rounding
}
