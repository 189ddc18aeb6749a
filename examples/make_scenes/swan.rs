//! The main figure: a swan with raised wings, 12 cm high. Lengths here are centimetres; the swan
//! looks along +x, y is up, and it is mirrored at the plane z = 0.

use glam::{DVec2, DVec3};

use super::distance::{Tube, ellipsoid, smooth_intersection, smooth_step, smooth_union};
use super::polygonise::polygonise;
use super::remesh::{Fineness, Shaded, remesh};

/// The swan in centimetres.
pub fn swan() -> Shaded {
    let swan = Swan::new();
    let field = |p: DVec3| swan.distance(p);
    let rough = polygonise(&field, DVec3::new(-9.6, -0.6, -6.4), DVec3::new(8.6, 13.4, 6.4), 0.1);
    remesh(rough, &field, Fineness { deviation: 0.0025, shortest: 0.085, longest: 0.45 })
}

struct Swan {
    body: Tube,
    neck: Tube,
    beak: Tube,
    arm: Tube,
    feathers: Vec<Feather>,
}

/// A blade on the curved sheet of a wing: its axis and half width in the plane of the sheet, and
/// how far it lies above the sheet.
#[derive(Clone)]
struct Feather {
    axis: Tube,
    lift: f64,
    /// Half the thickness of the quill at the root.
    thickness: f64,
}

impl Swan {
    fn new() -> Self {
        Self {
            body: Tube::new(&[
                [3.9, 3.1, 0.0, 1.3],
                [2.4, 2.6, 0.0, 2.3],
                [0.4, 2.4, 0.0, 2.75],
                [-2.0, 2.6, 0.0, 2.4],
                [-4.2, 3.1, 0.0, 1.5],
                [-5.6, 3.9, 0.0, 0.7],
                [-6.8, 4.9, 0.0, 0.25],
            ]),
            neck: Tube::new(&[
                [2.4, 3.0, 0.0, 1.7],
                [4.3, 3.9, 0.0, 1.25],
                [5.7, 5.8, 0.0, 0.85],
                [4.2, 8.0, 0.0, 0.66],
                [2.6, 9.9, 0.0, 0.58],
                [3.3, 12.3, 0.0, 0.56],
                [5.1, 12.2, 0.0, 0.62],
                [5.9, 11.0, 0.0, 0.5],
            ]),
            beak: Tube::new(&[
                [5.5, 11.5, 0.0, 0.5],
                [6.1, 10.9, 0.0, 0.34],
                [6.7, 10.35, 0.0, 0.24],
                [7.1, 9.95, 0.0, 0.17],
            ]),
            arm: Tube::new(&[
                [2.6, 3.4, 1.5, 0.75],
                on_sheet(2.6, 4.8, 0.66),
                on_sheet(2.0, 6.5, 0.5),
                on_sheet(0.4, 8.1, 0.38),
                on_sheet(-2.0, 9.2, 0.28),
                on_sheet(-3.8, 10.3, 0.2),
            ]),
            feathers: feathers(),
        }
    }

    fn distance(&self, p: DVec3) -> f64 {
        let p = DVec3::new(p.x, p.y, p.z.abs());
        // The swan rests on the plane y = 0.
        smooth_intersection(self.join_wing(self.bird(p), p), -p.y, 0.4)
    }

    /// Body, neck, head and beak.
    fn bird(&self, p: DVec3) -> f64 {
        let flat = DVec3::new(p.x, p.y, p.z / 1.12);
        let d = self.neck.join(self.body.distance(flat), p, 1.6);
        let from_head = p - DVec3::new(5.35, 11.55, 0.0);
        if from_head.length() > d + 3.5 {
            return d;
        }
        let d = smooth_union(d, ellipsoid(turned(from_head), DVec3::new(0.95, 0.68, 0.62)), 0.5);
        let d = self.beak.join(d, DVec3::new(p.x, p.y, p.z / 1.15), 0.12);
        // Knob above the beak, and the eyes.
        let d = smooth_union(d, (p - DVec3::new(6.02, 11.38, 0.0)).length() - 0.2, 0.2);
        smooth_union(d, (p - DVec3::new(5.62, 11.66, 0.55)).length() - 0.1, 0.06)
    }

    /// Union of `body` with the wing.
    fn join_wing(&self, body: f64, p: DVec3) -> f64 {
        if (p - DVec3::new(-2.5, 7.5, 3.0)).length() - 8.0 > body + 0.4 {
            return body;
        }
        let (height, steepness) = sheet(p.x, p.y);
        let above = (p.z - height) / steepness;
        let flat = DVec3::new(p.x, p.y, 0.0);
        let mut d = self.arm.distance(p);
        for feather in &self.feathers {
            if feather.axis.at_least(flat).max(above.abs() - 0.7) < d + 0.12 {
                d = smooth_union(d, feather.distance(flat, above), 0.12);
            }
        }
        smooth_union(body, d, 0.35)
    }
}

/// Coordinates along and across the head, which is bent down a little.
fn turned(p: DVec3) -> DVec3 {
    let (cosine, sine) = (0.8, -0.6);
    DVec3::new(cosine * p.x + sine * p.y, -sine * p.x + cosine * p.y, p.z)
}

/// The wing's sheet z(x, y), and the length of (∂z/∂x, ∂z/∂y, 1).
fn sheet(x: f64, y: f64) -> (f64, f64) {
    let (u, v) = (x + 1.0, y - 4.0);
    let height = 1.95 + 0.52 * v - 0.042 * v * v - 0.02 * u * u - 0.01 * u;
    let slope = DVec2::new(-0.04 * u - 0.01, 0.52 - 0.084 * v);
    (height, (1.0 + slope.length_squared()).sqrt())
}

/// A control point on the sheet of the wing.
fn on_sheet(x: f64, y: f64, radius: f64) -> [f64; 4] {
    [x, y, sheet(x, y).0, radius]
}

/// Flight feathers in a fan from the arm, shorter coverts over their roots.
fn feathers() -> Vec<Feather> {
    let roots = [DVec2::new(2.25, 5.2), DVec2::new(2.6, 7.3), DVec2::new(-1.6, 9.0)];
    let long = [DVec2::new(-4.6, 5.0), DVec2::new(-9.6, 6.2), DVec2::new(-6.0, 12.4)];
    let middle = [DVec2::new(-1.9, 5.0), DVec2::new(-5.0, 6.4), DVec2::new(-4.0, 10.6)];
    let short = [DVec2::new(0.2, 5.0), DVec2::new(-1.2, 6.6), DVec2::new(-2.6, 9.6)];
    [
        row(9, roots, long, 0.10, [0.74, 0.62], [0.0, 0.22]),
        row(8, roots, middle, 0.08, [0.72, 0.52], [0.07, 0.25]),
        row(7, roots, short, 0.05, [0.66, 0.46], [0.12, 0.29]),
    ]
    .concat()
}

/// `count` feathers whose roots and tips lie evenly on two quadratic curves, their axes bowed
/// upwards by the share `bow` of their length.
fn row(
    count: usize,
    roots: [DVec2; 3],
    tips: [DVec2; 3],
    bow: f64,
    half_width: [f64; 2],
    [lift, thickness]: [f64; 2],
) -> Vec<Feather> {
    let feather = |i: usize| {
        let t = i as f64 / (count - 1) as f64;
        let (root, tip) = (quadratic(roots, t), quadratic(tips, t));
        let bend = root.midpoint(tip) - (tip - root).perp() * bow;
        let width = half_width[0] + (half_width[1] - half_width[0]) * t;
        let at = |p: DVec2, share: f64| [p.x, p.y, 0.0, width * share];
        let axis = Tube::new(&[
            at(root, 0.55),
            at(root.lerp(bend, 0.6), 0.85),
            at(bend, 1.0),
            at(bend.lerp(tip, 0.6), 1.0),
            at(tip, 0.62),
        ]);
        Feather { axis, lift, thickness }
    };
    (0..count).map(feather).collect()
}

fn quadratic([a, b, c]: [DVec2; 3], t: f64) -> DVec2 {
    a.lerp(b, t).lerp(b.lerp(c, t), t)
}

impl Feather {
    /// Distance from a point given by its place in the sheet's plane and its height `above` it.
    fn distance(&self, flat: DVec3, above: f64) -> f64 {
        let nearest = self.axis.nearest(flat);
        let side = nearest.tangent.truncate().normalize_or_zero().perp_dot((flat - nearest.point).truncate());
        // Thinner towards edge and tip; the coverts rise from the arm and lie down again.
        let across = (nearest.distance / nearest.radius).min(1.3);
        let share = nearest.share;
        let quill = self.thickness * (1.0 - 0.35 * share) * smooth_step(-0.3, 0.25, share);
        let thickness = quill * (1.0 - 0.4 * across * across);
        let off_middle = above - self.lift * 3.0 * share * (1.2 - share) - 0.05 * side;
        smooth_intersection(nearest.distance - nearest.radius, off_middle.abs() - thickness, 0.2)
    }
}
