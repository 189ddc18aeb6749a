//! The area integral over a mesh, by probes.

use alabaster::diffusion::NormalizedDiffusion;
use alabaster::math::sampler::HashGenerator;
use alabaster::radiometry::Rgb;
use alabaster::raycast::bvh::BvhCaster;
use alabaster::raycast::{Backend, Geometry, Hit, MeshInstance, RayCaster, TriangleMesh};
use alabaster::scene::Mesh;
use alabaster::transport::area_integral::{AreaIntegral, Crossing};
use alabaster::transport::spread::{Channels, Spread};
use glam::{Affine3A, Vec3};

use super::scenes::{self, Caster};

/// A caster for `mesh` alone, to be probed.
pub fn caster(mesh: &Mesh) -> Caster {
    with_geometry(mesh, |geometry| scenes::caster(geometry).unwrap())
}

/// Calls `build` with the geometry of `mesh` alone, to be probed.
pub fn with_geometry<T>(mesh: &Mesh, build: impl FnOnce(&Geometry) -> T) -> T {
    let meshes = [TriangleMesh { positions: &mesh.positions, triangles: &mesh.triangles }];
    let instances = [MeshInstance { mesh: 0, transform: Affine3A::IDENTITY, probed: true }];
    build(&Geometry { meshes: &meshes, instances: &instances })
}

/// Unit normal of the triangle hit; +z if it has no area.
pub fn normal_of(mesh: &Mesh, hit: &Hit) -> Vec3 {
    let [a, b, c] = mesh.triangles[hit.primitive as usize].map(|i| mesh.positions[i as usize].as_dvec3());
    (b - a).cross(c - a).normalize_or(glam::DVec3::Z).as_vec3()
}

/// Calls `visit` with the crossings that each of `draws` lines around `position` finds, by normalized diffusion of scales `d`.
pub fn for_each_line(
    caster: &impl RayCaster,
    mesh: &Mesh,
    d: Rgb,
    (position, normal): (Vec3, Vec3),
    draws: u32,
    mut visit: impl FnMut(&[Crossing]),
) {
    let spread = Spread::new(d.0.map(|d| NormalizedDiffusion { d }), 1e3);
    let integral = AreaIntegral {
        caster,
        geometric_normal: |hit: &Hit| normal_of(mesh, hit),
        instance: 0,
        spread: &spread,
        channels: Channels::of(Rgb::ONE),
        position,
        position_error: 1e-6,
        normal,
    };
    let mut generator = HashGenerator::new(11);
    let mut found = Vec::new();
    for _ in 0..draws {
        found.clear();
        integral.crossings(&mut generator, &mut found);
        visit(&found);
    }
}

/// What `visit` gathers of the same lines with every backend that pictures are made with, and the name of each.
pub fn lines_on_backends<S: Default>(
    mesh: &Mesh,
    d: Rgb,
    place: (Vec3, Vec3),
    draws: u32,
    visit: impl Fn(&mut S, &[Crossing]),
) -> Vec<(&'static str, S)> {
    let with = |backend: &Backend| {
        let mut gathered = S::default();
        let gather = |found: &[Crossing]| visit(&mut gathered, found);
        match backend {
            Backend::Embree => for_each_line(&caster(mesh), mesh, d, place, draws, gather),
            _ => {
                let caster = with_geometry(mesh, |geometry| BvhCaster::new(geometry).unwrap());
                for_each_line(&caster, mesh, d, place, draws, gather);
            }
        }
        (backend.name(), gathered)
    };
    Backend::available().iter().filter(|backend| **backend != Backend::Obvhs).map(with).collect()
}
