//! Whether two ray casters give the same answers.

use glam::{DVec3, Vec3};
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
    /// Of those, rays for which no cause is known: neither is a hit in question at an edge of its triangle or an end of the ray, nor
    /// are there two at the same place.
    pub unexplained: u64,
    /// The first disagreements, before all those without a cause.
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
    /// Why they may differ.
    pub cause: Cause,
}

/// Why two casters that both round may differ about a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// The ray passes an edge of the triangle more closely than positions are known.
    Edge,
    /// The triangle is met at an end of the ray.
    End,
    /// Two triangles are met at the same place.
    Tie,
    /// None of these.
    Unknown,
}

impl Cause {
    /// In words, for reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Edge => "at an edge",
            Self::End => "at an end of the ray",
            Self::Tie => "two at the same place",
            Self::Unknown => "unexplained",
        }
    }
}

/// The corners of the triangle of a hit, in the world.
pub type Corners<'a> = dyn Fn(&Hit) -> [Vec3; 3] + Sync + 'a;

impl Agreement {
    /// Compares `first` and `second` on rays of one kind, in a scene of triangles with such corners.
    pub fn of(
        first: &impl RayCaster,
        second: &impl RayCaster,
        corners: &Corners,
        kind: Kind,
        queries: &[Query],
    ) -> Self {
        queries
            .par_chunks(CHUNK)
            .map(|chunk| {
                let mut agreement = Self::default();
                chunk.iter().for_each(|query| agreement.compare(first, second, corners, kind, query));
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
        self.unexplained += other.unexplained;
        self.examples.extend(other.examples);
        self.examples.sort_by_key(|example| example.cause != Cause::Unknown);
        self.examples.truncate(EXAMPLES);
        self
    }

    fn compare(
        &mut self,
        first: &impl RayCaster,
        second: &impl RayCaster,
        corners: &Corners,
        kind: Kind,
        query: &Query,
    ) {
        let (a, b) = (hits(first, kind, query), hits(second, kind, query));
        self.rays += 1;
        if a == b {
            self.identical += 1;
            return;
        }
        let lacking = |others, hits| lacking(&query.ray, corners, others, hits);
        let (missing, extra) = (lacking(&b, &a), lacking(&a, &b));
        if missing.is_none() && extra.is_none() {
            self.within_rounding += 1;
        } else {
            self.missing += u64::from(missing.is_some());
            self.extra += u64::from(extra.is_some());
            // Where something hides a light is not told: the nearest that does.
            let disputed = |hit: Hit| match kind {
                Kind::Shadow => first.closest(&query.ray).or_else(|| second.closest(&query.ray)),
                _ => Some(hit),
            };
            // What is nearer was missed by the other, which then went on.
            let nearer = missing.into_iter().chain(extra).min_by(|a, b| a.t.total_cmp(&b.t));
            let disputed = nearer.and_then(disputed);
            let cause =
                disputed.map_or(Cause::Unknown, |hit| cause(&query.ray, &hit, [&a, &b], corners(&hit)));
            self.unexplained += u64::from(cause == Cause::Unknown);
            if self.examples.len() < EXAMPLES || cause == Cause::Unknown {
                self.examples.push(Disagreement { kind, ray: query.ray, first: a, second: b, cause });
            }
        }
    }
}

/// The first of `hits` that is not among `others`.
fn lacking(ray: &Ray, corners: &Corners, others: &[Hit], hits: &[Hit]) -> Option<Hit> {
    let rounding = |hit: &Hit| rounding(ray, hit, corners(hit));
    let is_same = |hit: &Hit, other: &Hit| {
        let distance = f64::from((hit.t - other.t).abs());
        hit.instance == other.instance && distance <= rounding(hit) + rounding(other)
    };
    hits.iter().find(|hit| !others.iter().any(|other| is_same(hit, other))).copied()
}

/// Why casters may differ about `hit` with the triangle of these corners, among all `hits` of both.
fn cause(ray: &Ray, hit: &Hit, hits: [&[Hit]; 2], corners: [Vec3; 3]) -> Cause {
    if passes_edge(ray, corners) {
        return Cause::Edge;
    }
    let rounding = rounding(ray, hit, corners);
    if f64::from(hit.t) <= rounding || f64::from(hit.t) >= f64::from(ray.t_max) - rounding {
        return Cause::End;
    }
    let is_other = |other: &Hit| (other.instance, other.primitive) != (hit.instance, hit.primitive);
    let is_there = |other: &Hit| f64::from((other.t - hit.t).abs()) <= rounding;
    match hits.into_iter().flatten().any(|other| is_other(other) && is_there(other)) {
        true => Cause::Tie,
        false => Cause::Unknown,
    }
}

/// Roundings that the test of a triangle makes, at most.
const ROUNDINGS: f64 = 16.0;

/// A ray and a triangle as the test of both sees them: the six-fold volumes that the direction spans with the edges.
struct Volumes {
    of_edges: [f64; 3],
    /// How far each may be off in single precision: no position is known better than the largest coordinate rounds.
    errors: [f64; 3],
}

impl Volumes {
    fn new(ray: &Ray, corners: [Vec3; 3]) -> Self {
        let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let [a, b, c] = corners.map(|corner| corner.as_dvec3() - origin);
        let edges: [(DVec3, DVec3); 3] = [(a, b), (b, c), (c, a)];
        let position = ROUNDINGS * f64::from(f32::EPSILON) * largest(ray, corners);
        Self {
            of_edges: edges.map(|(p, q)| direction.dot(p.cross(q))),
            errors: edges.map(|(p, q)| position * (p.length() + q.length()) * direction.length()),
        }
    }

    /// How far a weight of a corner may be off, at most 1.
    fn weight_error(&self) -> f64 {
        let whole: f64 = self.of_edges.iter().sum();
        (self.errors.iter().sum::<f64>() / whole.abs()).min(1.0)
    }
}

/// True if the ray passes an edge of the triangle, or the line through it, within the rounding of positions in single precision.
fn passes_edge(ray: &Ray, corners: [Vec3; 3]) -> bool {
    let Volumes { of_edges, errors } = Volumes::new(ray, corners);
    of_edges.iter().zip(errors).any(|(volume, error)| volume.abs() <= error)
}

/// How far the parameter of `hit` with the triangle of these corners may be off. It is the mean of those of the corners by their weights, which of a
/// sliver are hardly known.
fn rounding(ray: &Ray, hit: &Hit, corners: [Vec3; 3]) -> f64 {
    let direction = ray.direction.as_dvec3();
    let t = f64::from(hit.t);
    let from_hit = |corner: Vec3| {
        ((corner - ray.origin).as_dvec3().dot(direction) / direction.length_squared() - t).abs()
    };
    let spread = corners.map(from_hit).into_iter().fold(0.0, f64::max);
    let reach = largest(ray, corners) / direction.length();
    ROUNDINGS * f64::from(f32::EPSILON) * reach.max(t.abs())
        + Volumes::new(ray, corners).weight_error() * spread
}

/// The largest coordinate that the test of a triangle starts from.
fn largest(ray: &Ray, corners: [Vec3; 3]) -> f64 {
    corners.iter().fold(ray.origin.abs(), |size, corner| size.max(corner.abs())).max_element().into()
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

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [Vec3; 3] = [Vec3::ZERO, Vec3::X, Vec3::Y];

    fn hit(t: f32, primitive: u32) -> Hit {
        Hit { t, u: 0.0, v: 0.0, instance: 0, primitive }
    }

    fn cause_of(x: f32, t_max: f32, others: &[Hit]) -> Cause {
        let ray = Ray { origin: Vec3::new(x, 0.25, 1.0), direction: Vec3::NEG_Z, t_max };
        cause(&ray, &hit(1.0, 0), [&[hit(1.0, 0)], others], CORNERS)
    }

    #[test]
    fn differences_have_causes() {
        assert_eq!(cause_of(0.2, 2.0, &[]), Cause::Unknown);
        assert_eq!(cause_of(0.2, 2.0, &[hit(1.1, 1)]), Cause::Unknown);
        assert_eq!(cause_of(0.2, 2.0, &[hit(1.0, 1)]), Cause::Tie);
        assert_eq!(cause_of(0.2, 1.0, &[]), Cause::End);
        assert_eq!(cause_of(1e-7, 2.0, &[]), Cause::Edge);
        assert_eq!(cause_of(1e-4, 2.0, &[]), Cause::Unknown);
    }
}
