//! Signed distance fields: negative inside, close to the distance in length units near the surface.
//!
//! Only IEEE-exact operations (+ − × ÷ √) and the `libm` crate are used, never the system's
//! mathematics library, so that every machine makes the same meshes bit for bit.

use glam::{DVec2, DVec3, DVec4};

/// A body given by its signed distance field.
pub type Field<'a> = dyn Fn(DVec3) -> f64 + Sync + 'a;

/// Union of `a` and `b` with a fillet about `k` wide: the quadratic polynomial of Quilez.
pub fn smooth_union(a: f64, b: f64, k: f64) -> f64 {
    let h = (k - (a - b).abs()).max(0.0) / k;
    a.min(b) - 0.25 * h * h * k
}

/// Intersection of `a` and `b` with an edge rounded about `k` wide.
pub fn smooth_intersection(a: f64, b: f64, k: f64) -> f64 {
    -smooth_union(-a, -b, k)
}

/// Hermite step from 0 at `from` to 1 at `to`.
pub fn smooth_step(from: f64, to: f64, x: f64) -> f64 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Box of half extents `half`, its edges rounded by `radius`, about the origin.
pub fn rounded_box(p: DVec3, half: DVec3, radius: f64) -> f64 {
    let q = p.abs() - half + radius;
    q.max(DVec3::ZERO).length() + q.max_element().min(0.0) - radius
}

/// Ellipsoid of semi-axes `axes` about the origin, to first order in the distance.
pub fn ellipsoid(p: DVec3, axes: DVec3) -> f64 {
    let scaled = (p / axes).length();
    let gradient = (p / (axes * axes)).length().max(1e-9);
    scaled * (scaled - 1.0) / gradient
}

/// A uniform cubic B-spline of points with a radius each (w): the axis of a tube of varying girth.
/// It starts at the first and ends at the last control point.
#[derive(Clone)]
pub struct Tube {
    control: Vec<DVec4>,
    /// Points of the axis at every `1 / SAMPLES_PER_SPAN` of the parameter.
    samples: Vec<DVec4>,
    /// Ball around the tube: centre and radius.
    ball: (DVec3, f64),
}

const SAMPLES_PER_SPAN: usize = 3;

/// The ball of a tube nearest to a given point.
#[derive(Clone, Copy)]
pub struct Nearest {
    /// Point on the axis.
    pub point: DVec3,
    /// Radius there.
    pub radius: f64,
    /// Derivative of the curve by its parameter.
    pub tangent: DVec3,
    /// Share of the curve's parameter range, in [0, 1].
    pub share: f64,
    /// Distance to the axis.
    pub distance: f64,
}

impl Tube {
    /// Through control points (x, y, z, radius).
    pub fn new(points: &[[f64; 4]]) -> Self {
        let inner: Vec<DVec4> = points.iter().copied().map(DVec4::from_array).collect();
        // The mirror image of the second point at the first makes the spline start at the first.
        let before = 2.0 * inner[0] - inner[1];
        let after = 2.0 * inner[inner.len() - 1] - inner[inner.len() - 2];
        let control = [&[before], inner.as_slice(), &[after]].concat();
        let mut tube = Self { control, samples: Vec::new(), ball: (DVec3::ZERO, 0.0) };
        let count = (tube.control.len() - 3) * SAMPLES_PER_SPAN;
        tube.samples = (0..=count).map(|i| tube.evaluate(i as f64 / SAMPLES_PER_SPAN as f64).0).collect();
        let center = tube.samples[0].lerp(tube.samples[count], 0.5).truncate();
        let radius = tube.control.iter().map(|c| c.truncate().distance(center) + c.w).fold(0.0, f64::max);
        tube.ball = (center, radius);
        tube
    }

    /// Lower bound of the distance.
    pub fn at_least(&self, p: DVec3) -> f64 {
        p.distance(self.ball.0) - self.ball.1
    }

    /// Evenly spaced points of the axis, `per_span` between control points, with the derivatives.
    pub fn points(&self, per_span: usize) -> impl Iterator<Item = (DVec3, DVec3)> + '_ {
        (0..=per_span * (self.control.len() - 3)).map(move |i| {
            let (point, slope) = self.evaluate(i as f64 / per_span as f64);
            (point.truncate(), slope.truncate())
        })
    }

    fn spans(&self) -> f64 {
        (self.control.len() - 3) as f64
    }

    /// Point with radius, and first derivative, at parameter `t` in [0, spans].
    fn evaluate(&self, t: f64) -> (DVec4, DVec4) {
        let span = (t as usize).min(self.control.len() - 4);
        let u = t - span as f64;
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| self.control[span + i]);
        let v = 1.0 - u;
        let point = a * (v * v * v / 6.0)
            + b * ((3.0 * u * u * u - 6.0 * u * u + 4.0) / 6.0)
            + c * ((3.0 * v * v * v - 6.0 * v * v + 4.0) / 6.0)
            + d * (u * u * u / 6.0);
        let slope = (b - a) * (0.5 * v * v) + (c - b) * (0.5 + u * v) + (d - c) * (0.5 * u * u);
        (point, slope)
    }

    /// The point of the axis whose ball is nearest: the best of a few samples, refined by stepping
    /// to where the cone that touches the tube there is nearest.
    pub fn nearest(&self, p: DVec3) -> Nearest {
        let mut best = (f64::INFINITY, 0);
        for (i, sample) in self.samples.iter().enumerate() {
            let distance = sample.truncate().distance(p) - sample.w;
            if distance < best.0 {
                best = (distance, i);
            }
        }
        let mut t = best.1 as f64 / SAMPLES_PER_SPAN as f64;
        for _ in 0..3 {
            let (point, slope) = self.evaluate(t);
            let speed = slope.truncate().length().max(1e-9);
            let offset = p - point.truncate();
            let along = offset.dot(slope.truncate()) / speed;
            let aside = (offset.length_squared() - along * along).max(0.0).sqrt();
            let widening = (slope.w / speed).clamp(-0.9, 0.9);
            let shift = along + aside * widening / (1.0 - widening * widening).sqrt();
            t = (t + (shift / speed).clamp(-0.3, 0.3)).clamp(0.0, self.spans());
        }
        let (point, slope) = self.evaluate(t);
        Nearest {
            point: point.truncate(),
            radius: point.w,
            tangent: slope.truncate(),
            share: t / self.spans(),
            distance: (p - point.truncate()).length(),
        }
    }

    /// Distance to the tube.
    pub fn distance(&self, p: DVec3) -> f64 {
        let nearest = self.nearest(p);
        nearest.distance - nearest.radius
    }

    /// Smooth union of the tube with a body at distance `d`.
    pub fn join(&self, d: f64, p: DVec3, k: f64) -> f64 {
        if self.at_least(p) > d + k { d } else { smooth_union(d, self.distance(p), k) }
    }
}

/// Value and gradient of the field at `p` from the corners of a tetrahedron, `step` off on each axis.
fn value_and_gradient(field: &Field, p: DVec3, step: f64) -> (f64, DVec3) {
    const CORNERS: [DVec3; 4] = [
        DVec3::new(1.0, 1.0, 1.0),
        DVec3::new(1.0, -1.0, -1.0),
        DVec3::new(-1.0, 1.0, -1.0),
        DVec3::new(-1.0, -1.0, 1.0),
    ];
    let values = CORNERS.map(|corner| field(p + corner * step));
    let gradient: DVec3 = CORNERS.iter().zip(values).map(|(&corner, value)| corner * value).sum();
    (values.iter().sum::<f64>() / 4.0, gradient / (4.0 * step))
}

/// Moves `p` onto the surface by Newton steps along the gradient, each at most `reach` long, and
/// returns it with the unit normal.
pub fn project(field: &Field, mut p: DVec3, reach: f64) -> (DVec3, DVec3) {
    let mut normal = DVec3::ZERO;
    for _ in 0..4 {
        let (value, gradient) = value_and_gradient(field, p, 0.03 * reach);
        normal = gradient.normalize_or_zero();
        if value.abs() < 1e-3 * reach {
            break;
        }
        p -= (gradient * (value / gradient.length_squared().max(1e-6))).clamp_length_max(reach);
    }
    (p, normal)
}

/// Distance of a point of the plane to the polyline through `points`.
pub fn distance_to_polyline(p: DVec2, points: &[DVec2]) -> f64 {
    let squared = points.windows(2).map(|pair| {
        let (along, to) = (pair[1] - pair[0], p - pair[0]);
        let t = (to.dot(along) / along.length_squared()).clamp(0.0, 1.0);
        (to - along * t).length_squared()
    });
    squared.fold(f64::INFINITY, f64::min).sqrt()
}
