//! The size and shape of a body, as far as they tell how well an approximation does.

use std::collections::HashMap;

use glam::{Affine3A, DVec3, Vec3};

use super::solid::places;
use crate::scene::{Camera, FilmSettings, Mesh};

/// Below this product of mean curvature and mean chord the faces of a body are wide against its thickness. A sheet
/// twenty times as wide as thick has 0.27, a cube 1.05, a sphere 4/3.
const FLAT: f64 = 0.5;
/// Edges between normals further apart than this are sharp, rad.
const SHARP_ANGLE: f64 = 0.5;
/// A body is smooth if less than this share of its curvature is in sharp edges.
const SMOOTH: f64 = 0.1;

/// A body in numbers; those that do not exist are not finite.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    /// Volume, m³; that behind holes is closed by a cone to the middle.
    pub volume: f64,
    /// Area of the surface, m².
    pub area: f64,
    /// Mean over the surface of the absolute mean curvature, 1/m; 1/R on a sphere.
    pub curvature: f64,
    /// Share of it that is in sharp edges.
    pub sharp: f64,
    /// Lowest and highest corner of the bounding box, m.
    pub bounds: [Vec3; 2],
}

impl Body {
    /// Measures `mesh` placed by `transform`. Of triangles meshes with edges l and angles θ between normals, ∫|H| dA = Σ l|θ|/2
    /// (Steiner's formula).
    pub fn new(mesh: &Mesh, transform: &Affine3A) -> Self {
        let positions: Vec<Vec3> = mesh.positions.iter().map(|p| transform.transform_point3(*p)).collect();
        let used = || mesh.triangles.iter().flatten().map(|&v| positions[v as usize]);
        let low = used().reduce(Vec3::min).unwrap_or_default();
        let high = used().reduce(Vec3::max).unwrap_or_default();
        let middle = 0.5 * (low.as_dvec3() + high.as_dvec3());
        let places = places(mesh);
        let mut normals: HashMap<(usize, usize), DVec3> =
            HashMap::with_capacity(mesh.triangles.len() * 3 / 2);
        let (mut volume, mut area, mut bend, mut sharp) = (0.0, 0.0, 0.0, 0.0);
        for triangle in &mesh.triangles {
            let vertices = triangle.map(|v| v as usize);
            let corners = vertices.map(|v| positions[v].as_dvec3() - middle);
            let twice_area = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            volume += corners[0].dot(twice_area) / 6.0;
            area += 0.5 * twice_area.length();
            let Some(normal) = twice_area.try_normalize() else { continue };
            for (i, j) in [(0, 1), (1, 2), (2, 0)] {
                let (a, b) = (places[vertices[i]], places[vertices[j]]);
                let edge = (a.min(b), a.max(b));
                match normals.remove(&edge) {
                    Some(other) => {
                        let angle = angle(normal, other);
                        let here = 0.5 * corners[i].distance(corners[j]) * angle;
                        bend += here;
                        sharp += if angle > SHARP_ANGLE { here } else { 0.0 };
                    }
                    None => drop(normals.insert(edge, normal)),
                }
            }
        }
        Self { volume: volume.abs(), area, curvature: bend / area, sharp: sharp / bend, bounds: [low, high] }
    }

    /// The body `factor` times as large, with the bounds of another place.
    pub fn scaled(&self, factor: f64, bounds: [Vec3; 2]) -> Self {
        let (volume, area) = (self.volume * factor.powi(3), self.area * factor.powi(2));
        Self { volume, area, curvature: self.curvature / factor, bounds, ..*self }
    }

    /// Mean length of chords 4V/S (Cauchy), m: 4/3 of a sphere's radius, twice the thickness of a sheet.
    pub fn mean_chord(&self) -> f64 {
        4.0 * self.volume / self.area
    }

    /// True if faces are wide against the thickness.
    pub fn is_flat(&self) -> bool {
        self.curvature * self.mean_chord() < FLAT
    }

    /// True if there are hardly any sharp edges.
    pub fn is_smooth(&self) -> bool {
        self.sharp < SMOOTH
    }

    /// The length that stands for the body's size in the table of errors, m: its mean chord; if it bends more than a sphere of
    /// that chord does, the chord 4/(3|H|) of a sphere that bends as much.
    pub fn scale(&self) -> f64 {
        self.mean_chord().min(4.0 / (3.0 * self.curvature))
    }

    /// Width of what a pixel shows of the body where it is nearest to `camera`, m; 0 with the camera in its bounding box.
    pub fn pixel_footprint(&self, camera: &Camera, film: &FilmSettings) -> f64 {
        let [low, high] = self.bounds;
        let distance = camera.position.distance(camera.position.clamp(low, high));
        2.0 * f64::from((0.5 * camera.vertical_fov).tan() * distance) / f64::from(film.height)
    }
}

/// Between unit vectors; exact for small ones, too.
fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;
    use crate::scene::shape;

    fn body(mesh: &Mesh) -> Body {
        Body::new(mesh, &Affine3A::IDENTITY)
    }

    #[test]
    fn a_box_is_exact() {
        let (x, y, z) = (2.0, 3.0, 0.5);
        let found = body(&shape::cuboid(Vec3::splat(7.0), Vec3::new(x as f32, y as f32, z as f32)));
        let area = 2.0 * (x * y + y * z + z * x);
        // Twelve edges with an angle of 90°.
        let bend = 4.0 * (x + y + z) * FRAC_PI_2 / 2.0;
        assert!((found.volume - x * y * z).abs() < 1e-5);
        assert!((found.area - area).abs() < 1e-5);
        assert!((found.curvature - bend / area).abs() < 1e-6);
        assert!(!found.is_flat() && !found.is_smooth() && (found.sharp - 1.0).abs() < 1e-9);
        assert!(body(&shape::cuboid(Vec3::ZERO, Vec3::new(4.0, 4.0, 0.2))).is_flat());
    }

    /// A polyhedron inscribed in a sphere lacks a share of its area and volume in the order of the squared edge over the
    /// radius, 0.02² here.
    #[test]
    fn a_sphere_has_the_chord_and_curvature_of_one() {
        let found = body(&shape::sphere(Vec3::ONE, 2.0, 6));
        assert!((found.mean_chord() / (4.0 / 3.0 * 2.0) - 1.0).abs() < 1e-3);
        assert!((found.curvature * 2.0 - 1.0).abs() < 1e-3);
        assert!((found.scale() / found.mean_chord() - 1.0).abs() < 2e-3);
        assert!((found.area / (16.0 * PI) - 1.0).abs() < 1e-3);
        assert!(found.is_smooth() && found.sharp == 0.0);
    }

    #[test]
    fn placing_counts_and_nothing_is_nothing() {
        let twice = Affine3A::from_scale(Vec3::splat(-2.0));
        let found = Body::new(&shape::cuboid(Vec3::ZERO, Vec3::ONE), &twice);
        assert_eq!((found.volume, found.area), (8.0, 24.0));
        let nothing = body(&Mesh::default());
        assert!(nothing.mean_chord().is_nan() && !nothing.is_flat() && !nothing.is_smooth());
    }

    #[test]
    fn a_pixel_shows_as_much_as_the_camera_says() {
        let found = body(&shape::cuboid(Vec3::ZERO, Vec3::splat(2.0)));
        let film = FilmSettings { height: 100, ..FilmSettings::default() };
        let camera = |z| Camera {
            position: Vec3::new(0.0, 0.0, z),
            vertical_fov: FRAC_PI_2 as f32,
            ..Camera::default()
        };
        assert!((found.pixel_footprint(&camera(5.0), &film) - 2.0 * 4.0 / 100.0).abs() < 1e-6);
        assert_eq!(found.pixel_footprint(&camera(0.5), &film), 0.0);
    }
}
