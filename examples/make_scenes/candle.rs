//! The candle and its wick, in centimetres, standing on y = 0.

use glam::{DVec2, DVec3};

use super::distance::{Tube, smooth_intersection, smooth_step, smooth_union};
use super::polygonise::polygonise;
use super::remesh::{Fineness, Shaded, remesh};

/// Radius of the candle.
const RADIUS: f64 = 2.4;

/// Level of the molten wax.
pub const POOL: f64 = 7.0;

/// The wax: a cylinder with a molten pool, an uneven rim and drips that ran down.
pub fn wax() -> Shaded {
    let drips = [
        drip(DVec2::new(0.6, 0.8), 3.9, 0.30),
        drip(DVec2::new(0.28, 0.96), 5.6, 0.22),
        drip(DVec2::new(-0.8, 0.6), 5.0, 0.28),
        drip(DVec2::new(0.96, -0.28), 2.2, 0.26),
        drip(DVec2::new(-0.28, -0.96), 4.4, 0.30),
    ];
    let field = |p: DVec3| {
        let mut d = cylinder(p);
        for drip in &drips {
            d = drip.join(d, p, 0.3);
        }
        d
    };
    let rough = polygonise(&field, DVec3::new(-3.8, -0.5, -3.8), DVec3::new(3.8, 8.8, 3.8), 0.13);
    remesh(rough, &field, Fineness { deviation: 0.004, shortest: 0.11, longest: 0.5 })
}

fn cylinder(p: DVec3) -> f64 {
    let flat = DVec2::new(p.x, p.z);
    let radius = flat.length();
    let DVec2 { x, y: z } = flat / radius.max(0.5);
    // cos 2θ, cos 3θ and sin 3θ.
    let (c2, c3, s3) = (x * x - z * z, x * (x * x - 3.0 * z * z), z * (3.0 * x * x - z * z));
    let rim = 0.55 + 0.13 * c2 + 0.10 * s3 - 0.06 * c3;
    let top =
        POOL + rim * smooth_step(RADIUS - 1.0, RADIUS - 0.15, radius) + 0.25 * smooth_step(0.35, 0.0, radius);
    let side = radius - RADIUS - 0.04 * c3 - 0.03 * c2;
    let body = smooth_intersection(side, 0.75 * (p.y - top), 0.35);
    // Wax that ran down has set around the foot.
    let puddle = (DVec2::new((radius - 2.6 - 0.25 * c3 + 0.15 * c2).max(0.0), p.y)).length() - 0.3;
    smooth_intersection(smooth_union(body, puddle, 0.5), -p.y, 0.1)
}

/// Wax that ran down from the rim in the direction `out` to height `end`.
fn drip(out: DVec2, end: f64, girth: f64) -> Tube {
    let at = |r: f64, y: f64, share: f64| [out.x * r, y, out.y * r, girth * share];
    Tube::new(&[
        at(RADIUS - 0.35, 7.3, 0.9),
        at(RADIUS - 0.05, 7.1, 0.75),
        at(RADIUS - 0.02, 0.5 * (6.9 + end), 0.7),
        at(RADIUS, end + 0.8, 0.8),
        at(RADIUS + 0.02, end, 1.15),
    ])
}

/// The wick: upright from the pool, its end bent over.
pub fn wick() -> Shaded {
    let wick = Tube::new(&[
        [0.0, POOL - 0.6, 0.0, 0.09],
        [0.0, POOL + 0.4, 0.0, 0.09],
        [0.02, POOL + 0.9, 0.0, 0.085],
        [0.16, POOL + 1.25, 0.02, 0.07],
    ]);
    let field = |p: DVec3| wick.distance(p);
    let rough =
        polygonise(&field, DVec3::new(-0.3, POOL - 0.9, -0.3), DVec3::new(0.5, POOL + 1.6, 0.3), 0.05);
    remesh(rough, &field, Fineness { deviation: 0.002, shortest: 0.04, longest: 0.2 })
}
