//! Surfaces swept by a curve: turned bodies and the torus knot.

use std::f64::consts::TAU;

use glam::DVec3;
use libm::{cos, sin};

use super::distance::Tube;
use super::polygonise::Surface;
use super::remesh::Shaded;

/// Turns a profile about the y axis. The profile is a B-spline through (radius, height) from the
/// axis back to the axis; the body lies to the right of its course.
pub fn revolve(profile: &[[f64; 2]], per_span: usize, segments: usize) -> Shaded {
    let control: Vec<[f64; 4]> = profile.iter().map(|&[r, y]| [r, y, 0.0, 0.0]).collect();
    let points: Vec<(DVec3, DVec3)> = Tube::new(&control).points(per_span).collect();
    let last = points.len() - 1;

    let mut body = Shaded::default();
    let mut push = |position: DVec3, normal: DVec3| {
        body.surface.positions.push(position);
        body.normals.push(normal);
    };
    push(points[0].0.with_x(0.0), DVec3::Y);
    for (point, slope) in &points[1..last] {
        for segment in 0..segments {
            let angle = TAU * segment as f64 / segments as f64;
            let around = |r: f64, y: f64| DVec3::new(r * cos(angle), y, r * sin(angle));
            push(around(point.x, point.y), around(-slope.y, slope.x).normalize());
        }
    }
    push(points[last].0.with_x(0.0), DVec3::NEG_Y);

    let rings = last - 1;
    let at = |ring: usize, segment: usize| (1 + ring * segments + segment % segments) as u32;
    let end = (1 + rings * segments) as u32;
    for s in 0..segments {
        body.surface.triangles.push([0, at(0, s + 1), at(0, s)]);
        for ring in 0..rings - 1 {
            let [a, b] = [at(ring, s), at(ring, s + 1)];
            let [c, d] = [at(ring + 1, s), at(ring + 1, s + 1)];
            body.surface.triangles.extend([[a, b, d], [a, d, c]]);
        }
        body.surface.triangles.push([end, at(rings - 1, s), at(rings - 1, s + 1)]);
    }
    body
}

/// A tube of radius `girth` along the (2, 3) torus knot on a torus of radii `major` and `minor`
/// that lies in the plane of x and y.
pub fn torus_knot(major: f64, minor: f64, girth: f64, along: usize, around: usize) -> Shaded {
    let mut body = Shaded::default();
    for i in 0..along {
        let t = TAU * i as f64 / along as f64;
        let (c2, s2, c3, s3) = (cos(2.0 * t), sin(2.0 * t), cos(3.0 * t), sin(3.0 * t));
        let ring = major + minor * c3;
        let center = DVec3::new(ring * c2, ring * s2, minor * s3);
        let slope = DVec3::new(-3.0 * minor * s3 * c2, -3.0 * minor * s3 * s2, 3.0 * minor * c3)
            + DVec3::new(-s2, c2, 0.0) * (2.0 * ring);
        // The torus's own normal is a frame that closes without twist.
        let outward = DVec3::new(c3 * c2, c3 * s2, s3);
        let side = slope.normalize().cross(outward);
        for j in 0..around {
            let angle = TAU * j as f64 / around as f64;
            let normal = outward * cos(angle) + side * sin(angle);
            body.surface.positions.push(center + normal * girth);
            body.normals.push(normal);
        }
    }
    let at = |i: usize, j: usize| ((i % along) * around + j % around) as u32;
    for (i, j) in (0..along).flat_map(|i| (0..around).map(move |j| (i, j))) {
        let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)];
        body.surface.triangles.extend([[a, d, c], [a, b, d]]);
    }
    body
}

/// A square in the plane y = 0, facing up, of side `side`.
pub fn square(side: f64) -> Shaded {
    let half = 0.5 * side;
    let positions = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];
    let positions = positions.map(|[x, z]| DVec3::new(x * half, 0.0, z * half)).to_vec();
    Shaded {
        surface: Surface { positions, triangles: vec![[0, 1, 2], [0, 2, 3]] },
        normals: vec![DVec3::Y; 4],
    }
}
