//! A bar of soap, 8.6 cm long, with a sprig of leaves embossed; centimetres, lying on y = 0.

use glam::{DVec2, DVec3};

use super::distance::{distance_to_polyline, rounded_box, smooth_step};
use super::polygonise::polygonise;
use super::remesh::{Fineness, Shaded, remesh};

/// Half the extents of the bar.
const HALF: DVec3 = DVec3::new(4.3, 1.3, 2.8);

/// The bar.
pub fn soap() -> Shaded {
    let field = |p: DVec3| bar(p - DVec3::Y * HALF.y);
    let rough = polygonise(&field, DVec3::new(-4.8, -0.5, -3.3), DVec3::new(4.8, 3.1, 3.3), 0.08);
    remesh(rough, &field, Fineness { deviation: 0.002, shortest: 0.07, longest: 0.45 })
}

fn bar(p: DVec3) -> f64 {
    // Bulging faces, as pressed in a mould.
    let bulge = DVec3::new(p.x, p.y * (1.0 + 0.012 * (p.x * p.x + p.z * p.z) * 0.6), p.z);
    let body = rounded_box(bulge, HALF, 1.15);
    let above = smooth_step(0.2, 0.7, p.y);
    if above == 0.0 {
        return body;
    }
    let at = DVec2::new(p.x, p.z);
    // An oval field, sunk; the sprig stands in it.
    let oval = ((at / DVec2::new(3.05, 1.75)).length() - 1.0) * 1.9;
    let sunk = 0.11 * smooth_step(0.1, -0.1, oval);
    let raised = 0.14 * smooth_step(0.09, -0.16, sprig(at));
    body + above * (sunk - raised)
}

/// Distance in the plane to a bowed stem with leaves in pairs.
fn sprig(p: DVec2) -> f64 {
    let stem: Vec<DVec2> = (0..=8).map(|i| stem_at(-2.2 + 0.5 * f64::from(i))).collect();
    let mut d = distance_to_polyline(p, &stem) - 0.09;
    for i in 0..4 {
        let x = -1.7 + 0.95 * f64::from(i);
        for side in [-1.0, 1.0] {
            let root = stem_at(x + 0.12 * side);
            let length = 1.15 - 0.1 * f64::from(i);
            d = d.min(leaf(p, root, DVec2::new(0.72, 0.69 * side), length));
        }
    }
    d.min(leaf(p, stem_at(1.75), DVec2::new(1.0, -0.05).normalize(), 1.0))
}

fn stem_at(x: f64) -> DVec2 {
    DVec2::new(x, 0.12 - 0.05 * x * x)
}

/// Distance to a leaf from `root` along the unit vector `along`: where two disks overlap.
fn leaf(p: DVec2, root: DVec2, along: DVec2, length: f64) -> f64 {
    const SLENDERNESS: f64 = 1.05;
    let q = p - root;
    let (x, y) = (q.dot(along) - 0.5 * length, q.perp_dot(along).abs());
    // Disks of radius r whose centres lie `offset` off the axis and that meet at both ends.
    let offset = 0.5 * length * SLENDERNESS;
    let r = (offset * offset + 0.25 * length * length).sqrt();
    DVec2::new(x, y + offset).length() - r
}
