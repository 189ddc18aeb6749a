//! Any radial profile in tabulated form: fast enough for a renderer, with its energy exact by construction.
//!
//! The share F(r) of the energy within radius r is kept as its logit, s = ln(F/(1 − F)), over ℓ = ln r. In these
//! variables a profile is nearly a straight line: a pole R ~ 1/r at the centre gives s' = 1, a finite value s' = 2,
//! a power-law tail R ~ 1/r³ gives s' = 1, an exponential tail s ~ r. A monotone cubic through a few knots per decade
//! is then accurate, F runs from 0 to 1 whatever the knots are, the density is its exact derivative,
//!
//! R(r) = F(1 − F) s'(ℓ) / (2π r²),
//!
//! and sampling is its exact inverse. Rows for several absorptions are blended linearly, which keeps all of this.

use std::f32::consts::{LN_10, TAU};

use super::Profile;

/// Knots per decade of radius.
pub const KNOTS_PER_DECADE: usize = 6;
/// Radius of the first knot, in reduced mean free paths. Within it F is continued as a power of r.
pub const FIRST_KNOT: f64 = 1e-3;
/// Number of knots: six decades.
pub const KNOTS: usize = 6 * KNOTS_PER_DECADE + 1;
/// ℓ of the first knot, ln 10⁻³.
const FIRST: f32 = -3.0 * LN_10;
/// Distance of knots in ℓ.
const STEP: f32 = LN_10 / KNOTS_PER_DECADE as f32;

/// Radius of knot `i`, in reduced mean free paths.
pub fn knot_radius(i: usize) -> f64 {
    FIRST_KNOT * 10.0_f64.powf(i as f64 / KNOTS_PER_DECADE as f64)
}

/// Radii of the knots, in reduced mean free paths.
static KNOT_RADII: [f32; KNOTS] = {
    // 10^(i/6).
    let sixths = [
        1.0,
        1.467_799_267_622_069_5,
        2.154_434_690_031_884,
        3.162_277_660_168_379_5,
        4.641_588_833_612_779,
        6.812_920_690_579_611,
    ];
    let (mut radii, mut decade, mut i) = ([0.0; KNOTS], FIRST_KNOT, 0);
    while i < KNOTS {
        radii[i] = (decade * sixths[i % KNOTS_PER_DECADE]) as f32;
        i += 1;
        if i.is_multiple_of(KNOTS_PER_DECADE) {
            decade *= 10.0;
        }
    }
    radii
};

/// Value of s at a knot and its slope per knot distance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Knot {
    value: f32,
    slope: f32,
}

/// Profiles of one boundary and phase function for every absorption, in reduced mean free paths.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeTable {
    /// Rows for √(1 − α') = i/(n − 1): the inverse length of the tail is nearly proportional to it.
    rows: Vec<[Knot; KNOTS]>,
}

/// Closest that two knots may be in s, and farthest: R stays positive and finite.
const LEAST_RISE: f64 = 1e-4;

impl ShapeTable {
    /// From the logits of F at [`knot_radius`], in rows for √(1 − α') = i/(n − 1); at least two rows.
    /// Where they do not rise they are made to.
    pub fn new(logits: &[[f64; KNOTS]]) -> Self {
        let mut rows: Vec<_> = logits.iter().map(row).collect();
        while rows.len() < 2 {
            rows.push(rows.first().copied().unwrap_or([Knot::default(); KNOTS]));
        }
        Self { rows }
    }

    /// The profile of a medium of which the share `absorbed_share` = 1 − α' is absorbed at a collision of the
    /// reduced medium, whose mean free path 1/σ_t' is `mean_free_path` (m; positive).
    pub fn shape(&self, absorbed_share: f32, mean_free_path: f32) -> Shape<'_> {
        let position = absorbed_share.clamp(0.0, 1.0).sqrt() * (self.rows.len() - 1) as f32;
        let i = (position as usize).min(self.rows.len() - 2);
        Shape {
            rows: [&self.rows[i], &self.rows[i + 1]],
            fraction: position - i as f32,
            mean_free_path,
            inverse: 1.0 / mean_free_path,
        }
    }
}

fn row(logits: &[f64; KNOTS]) -> [Knot; KNOTS] {
    let mut s = *logits;
    for i in 1..KNOTS {
        s[i] = s[i].max(s[i - 1] + LEAST_RISE);
    }
    std::array::from_fn(|i| Knot { value: s[i] as f32, slope: slope(&s, i) as f32 })
}

/// Slope at knot `i`, by the difference of fourth order (at the ends, of first and second), limited so that the cubic is
/// monotone (Fritsch and Carlson 1980).
fn slope(s: &[f64; KNOTS], i: usize) -> f64 {
    let secant = |j: usize| s[j + 1] - s[j];
    const LAST: usize = KNOTS - 1;
    match i {
        0 => secant(0),
        LAST => secant(LAST - 1),
        _ => {
            let central = 0.5 * (s[i + 1] - s[i - 1]);
            let slope = if (2..LAST - 1).contains(&i) {
                (8.0 * (s[i + 1] - s[i - 1]) - (s[i + 2] - s[i - 2])) / 12.0
            } else {
                central
            };
            let limit = 3.0 * secant(i - 1).min(secant(i));
            // A slope of 0 would be a hole in the profile.
            slope.clamp(0.1 * limit, limit)
        }
    }
}

/// One profile: two rows of a table, blended.
///
/// Two are equal if they are the same blend of the same rows, at the same scale.
#[derive(Clone, Copy, Debug)]
pub struct Shape<'a> {
    rows: [&'a [Knot; KNOTS]; 2],
    fraction: f32,
    mean_free_path: f32,
    inverse: f32,
}

impl PartialEq for Shape<'_> {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.rows[0], other.rows[0])
            && self.fraction == other.fraction
            && self.mean_free_path == other.mean_free_path
    }
}

impl Shape<'_> {
    fn knot(&self, i: usize) -> Knot {
        let [a, b] = [self.rows[0][i], self.rows[1][i]];
        Knot {
            value: a.value + self.fraction * (b.value - a.value),
            slope: a.slope + self.fraction * (b.slope - a.slope),
        }
    }

    /// Where `radius` lies among the knots.
    fn position(&self, radius: f32) -> f32 {
        ((radius * self.inverse).ln() - FIRST) * (1.0 / STEP)
    }

    /// s and ds/dℓ at ℓ = ln(`radius`/ℓ').
    fn logit(&self, radius: f32) -> (f32, f32) {
        let position = self.position(radius);
        if position <= 0.0 {
            let first = self.knot(0);
            return (first.value + first.slope * position, first.slope * (1.0 / STEP));
        }
        let i = position as usize;
        if i >= KNOTS - 1 {
            // On as at the end: in proportion to r where the tail is exponential.
            let last = self.knot(KNOTS - 1);
            let ratio = (position - (KNOTS - 1) as f32) * STEP;
            let grown = ratio.exp();
            return (last.value + last.slope * (grown - 1.0) / STEP, last.slope * grown / STEP);
        }
        let (s, slope) = hermite(self.knot(i), self.knot(i + 1), position - i as f32);
        (s, slope * (1.0 / STEP))
    }
}

/// R = F(1 − F) s'/(2πr²).
fn density_of_logit(s: f32, slope: f32, radius: f32) -> f32 {
    // F(1 − F), without cancellation at either end; divided twice, as r² may underflow.
    let e = (-s.abs()).exp();
    e / radius * slope / ((1.0 + e) * (1.0 + e) * TAU * radius)
}

/// Value and slope (per knot distance) between two knots.
fn hermite(a: Knot, b: Knot, t: f32) -> (f32, f32) {
    let rise = b.value - a.value;
    let second = 3.0 * rise - 2.0 * a.slope - b.slope;
    let third = a.slope + b.slope - 2.0 * rise;
    (a.value + t * (a.slope + t * (second + t * third)), a.slope + t * (2.0 * second + t * 3.0 * third))
}

/// t in [0, 1] at which the monotone cubic between two knots is `s`: Newton's method held inside a bracket.
fn inverse_hermite(a: Knot, b: Knot, s: f32) -> f32 {
    let (mut low, mut high) = (0.0_f32, 1.0_f32);
    let mut t = ((s - a.value) / (b.value - a.value)).clamp(0.0, 1.0);
    for _ in 0..24 {
        let (value, slope) = hermite(a, b, t);
        let error = value - s;
        if error > 0.0 {
            high = t
        } else {
            low = t
        }
        let newton = t - error / slope;
        let next = if newton >= low && newton <= high { newton } else { 0.5 * (low + high) };
        if (next - t).abs() <= f32::EPSILON {
            return next;
        }
        t = next;
    }
    t
}

impl Profile for Shape<'_> {
    fn density(&self, radius: f32) -> f32 {
        let radius = radius.max(f32::MIN_POSITIVE);
        let (s, slope) = self.logit(radius);
        density_of_logit(s, slope, radius)
    }

    fn cumulative(&self, radius: f32) -> f32 {
        1.0 / (1.0 + (-self.logit(radius).0).exp())
    }

    fn sample_radius(&self, xi: f32) -> f32 {
        // The largest float below 1 bounds the tail: beyond it lies 6·10⁻⁸ of the energy.
        let rest = (1.0 - xi).max(f32::EPSILON / 4.0);
        let s = (xi / rest).ln();
        let first = self.knot(0);
        let last = self.knot(KNOTS - 1);
        let position = if s <= first.value {
            (s - first.value) / first.slope
        } else if s >= last.value {
            (KNOTS - 1) as f32 + ((s - last.value) * STEP / last.slope).ln_1p() / STEP
        } else {
            // The first knot above s; there is one, and it is not the first of all.
            let (mut below, mut above) = (0, KNOTS - 1);
            while above - below > 1 {
                let middle = (below + above) / 2;
                if self.knot(middle).value <= s { below = middle } else { above = middle }
            }
            below as f32 + inverse_hermite(self.knot(below), self.knot(above), s)
        };
        self.mean_free_path * (FIRST + position * STEP).exp()
    }

    fn radius_of_ratio(&self, radius: f32, ratio: f32) -> f32 {
        let position = self.position(radius);
        if position < 0.0 {
            // R falls at least as the power law that continues F.
            let fall = 2.0 - self.knot(0).slope / STEP;
            let bound = if fall > 0.25 { radius * ratio.powf(-1.0 / fall) } else { f32::INFINITY };
            if bound * self.inverse <= KNOT_RADII[0] {
                return bound;
            }
        }
        // From knot to knot outwards: R falls.
        let target = ratio * self.density(radius) / (self.inverse * self.inverse);
        let next = (position + 1.0).max(0.0) as usize;
        for (i, &knot_radius) in KNOT_RADII.iter().enumerate().skip(next) {
            let Knot { value, slope } = self.knot(i);
            if density_of_logit(value, slope / STEP, knot_radius) <= target {
                return knot_radius * self.mean_free_path;
            }
        }
        // Beyond the knots s rises by k r, and R = e^(−s) (1 + e^(−s))⁻² k/(2πr).
        let last = self.knot(KNOTS - 1);
        let start = radius.max(KNOT_RADII[KNOTS - 1] * self.mean_free_path);
        let rate = last.slope / (STEP * KNOT_RADII[KNOTS - 1]) * self.inverse;
        let fall = (self.density(start) / self.density(radius) / ratio).ln().max(0.0);
        start + (fall + 2.0 * (-self.logit(start).0).exp().ln_1p()) / rate
    }
}
