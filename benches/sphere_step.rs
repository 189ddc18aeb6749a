//! What a step on a sphere costs: the distance to the surface, the table; and the walk that it replaces. Last, both walks
//! of a photon through a whole body.

use std::f32::consts::TAU;
use std::hint::black_box;

use alabaster::math::Frame;
use alabaster::math::sampler::HashGenerator;
use alabaster::medium::SphereStep;
use alabaster::medium::sphere_step::Exit;
use alabaster::raycast::bvh::BvhCaster;
use alabaster::raycast::embree::EmbreeCaster;
use alabaster::raycast::{DistanceQuery, Geometry, MeshInstance, Ray, RayCaster, TriangleMesh};
use alabaster::scene::shape;
use criterion::Criterion;
use glam::{Affine3A, Vec3};

/// Points that the benches go round; a power of two.
const POINTS: usize = 1 << 14;

fn main() {
    let mut criterion = Criterion::default().sample_size(20).configure_from_args();
    for (name, levels) in [("82 k", 6), ("1.3 M", 8)] {
        bench_distance(&mut criterion, name, levels);
    }
    bench_table(&mut criterion);
    bench_walk(&mut criterion);
    bench_body(&mut criterion);
    criterion.final_summary();
}

/// Distance queries and, for comparison, rays, from points spread over the inside of a bumpy sphere of `name` triangles.
fn bench_distance(criterion: &mut Criterion, name: &str, levels: u32) {
    let mut mesh = shape::sphere(Vec3::ZERO, 1.0, levels);
    let bump = |p: Vec3| p * (1.0 + 0.05 * (9.0 * p.x).sin() * (7.0 * p.y + p.z).cos());
    mesh.positions.iter_mut().for_each(|position| *position = bump(*position));
    let view = TriangleMesh { positions: &mesh.positions, triangles: &mesh.triangles };
    let instance = MeshInstance { mesh: 0, transform: Affine3A::IDENTITY, probed: true };
    let geometry = Geometry { meshes: &[view], instances: &[instance] };
    let mut random = HashGenerator::new(1);
    // Uniform over the ball; and, as walks spend their time there too, within a hundredth of the surface.
    let inside: Vec<_> =
        (0..POINTS).map(|_| direction(&mut random) * 0.93 * random.next_f32().cbrt()).collect();
    let near: Vec<_> =
        (0..POINTS).map(|_| bump(direction(&mut random)) * (1.0 - 0.01 * random.next_f32())).collect();
    let embree = EmbreeCaster::new(&geometry, 1).unwrap();
    let bvh = BvhCaster::new(&geometry).unwrap();
    let mut bench = |backend: &str, caster: &dyn RayCaster| {
        for (place, points) in [("inside", &inside), ("near the surface", &near)] {
            let mut next = 0;
            for (tolerance, least) in [(0.0, 0.0), (0.1, 0.0), (0.3, 0.0), (0.3, 0.02)] {
                let label =
                    format!("distance to {tolerance} if above {least}, {backend}, {name} triangles, {place}");
                criterion.bench_function(&label, |bencher| {
                    bencher.iter(|| {
                        next = (next + 1) % POINTS;
                        let query = DistanceQuery { tolerance, least, ..DistanceQuery::exact(points[next]) };
                        caster.distance_to_nearest(&query, 0)
                    });
                });
            }
            criterion.bench_function(&format!("ray, {backend}, {name} triangles, {place}"), |bencher| {
                bencher.iter(|| {
                    next = (next + 1) % POINTS;
                    caster.closest(&Ray::new(points[next], direction(&mut random)))
                });
            });
        }
    };
    bench("embree", &embree);
    bench("bvh", &bvh);
}

/// One exit with the densities of three wavelengths; radii that change from step to step, as they do.
fn bench_table(criterion: &mut Criterion) {
    criterion.bench_function("sphere step, table of a medium", |bencher| {
        bencher.iter(|| SphereStep::new(black_box(0.001)));
    });
    let steps = [0.0001, 0.001, 0.01].map(|share| SphereStep::new(share).unwrap());
    let mut random = HashGenerator::new(2);
    criterion.bench_function("sphere step, exit of one wavelength", |bencher| {
        bencher.iter(|| {
            let departure = steps[0].departure(1.0 + 30.0 * random.next_f32());
            departure.sample(random.next_f32()).cosine() * departure.survival()
        });
    });
    criterion.bench_function("sphere step, exit and densities of three wavelengths", |bencher| {
        bencher.iter(|| {
            let radius = 1.0 + 30.0 * random.next_f32();
            let departures = [(0, 1.0), (1, 1.2), (2, 1.4)].map(|(i, s)| steps[i].departure(radius * s));
            let exit = departures[1].sample(random.next_f32());
            departures.map(|departure| departure.density(exit)).iter().sum::<f32>() * exit.cosine()
        });
    });
}

/// Plain steps from the centre of a sphere to its surface, in a medium that absorbs nothing.
fn bench_walk(criterion: &mut Criterion) {
    let mut random = HashGenerator::new(3);
    for radius in [1.0_f32, 2.0, 3.0, 5.0, 10.0, 30.0, 100.0] {
        criterion.bench_function(&format!("walk, optical radius {radius}"), |bencher| {
            bencher.iter(|| {
                let mut position = Vec3::ZERO;
                loop {
                    let flight = -(1.0 - random.next_f32()).ln();
                    position += direction(&mut random) * flight;
                    if position.length_squared() > radius * radius {
                        return position;
                    }
                }
            });
        });
    }
}

/// A photon that enters a sphere of 82 k triangles and radius 1 and leaves it or is absorbed.
fn bench_body(criterion: &mut Criterion) {
    let mesh = shape::sphere(Vec3::ZERO, 1.0, 6);
    let view = TriangleMesh { positions: &mesh.positions, triangles: &mesh.triangles };
    let instance = MeshInstance { mesh: 0, transform: Affine3A::IDENTITY, probed: true };
    let geometry = Geometry { meshes: &[view], instances: &[instance] };
    let embree = EmbreeCaster::new(&geometry, 1).unwrap();
    let bvh = BvhCaster::new(&geometry).unwrap();
    let absorbed_share = 1e-4;
    let step = SphereStep::new(absorbed_share).unwrap();
    for sigma_t in [30.0, 100.0, 1000.0] {
        let mut bench = |name: &str, least: f32, patience: u32, caster: &dyn RayCaster| {
            let body = Body { caster, rays: &embree, sigma_t, absorbed_share, step: &step, least, patience };
            let mut random = HashGenerator::new(4);
            criterion.bench_function(&format!("body {} mfp thick, {name}", 2.0 * sigma_t), |bencher| {
                bencher.iter(|| body.walk(&mut random));
            });
        };
        bench("plain", f32::INFINITY, 0, &embree);
        for (least, patience) in [(3.0, 0), (3.0, 8), (3.0, 32), (6.0, 64), (12.0, 256)] {
            bench(&format!("spheres from {least} mfp after {patience}, embree"), least, patience, &embree);
            bench(&format!("spheres from {least} mfp after {patience}, bvh"), least, patience, &bvh);
        }
    }
}

struct Body<'a> {
    /// Answers how far the surface is.
    caster: &'a dyn RayCaster,
    rays: &'a EmbreeCaster,
    sigma_t: f32,
    absorbed_share: f32,
    step: &'a SphereStep,
    /// The least optical radius of a sphere; infinite for a plain walk.
    least: f32,
    /// Collisions after entry, or after the surface was too near for a sphere, before it is asked for.
    patience: u32,
}

impl Body<'_> {
    /// The weight that leaves.
    fn walk(&self, random: &mut HashGenerator) -> f32 {
        let mut ray = Ray::new(Vec3::new(0.0, 0.0, 0.999), -Vec3::Z);
        let mut weight = 1.0_f32;
        let mut wait = self.patience;
        loop {
            ray.t_max = -(1.0 - random.next_f32()).ln() / self.sigma_t;
            if self.rays.closest(&ray).is_some() {
                return weight;
            }
            ray.origin = ray.at(ray.t_max);
            weight *= 1.0 - self.absorbed_share;
            ray.direction = direction(random);
            wait = wait.saturating_sub(1);
            if self.least.is_finite() && wait == 0 && !self.cross_sphere(&mut ray, &mut weight, random) {
                wait = self.patience;
            }
            if weight < 0.1 {
                if random.next_f32() > 0.5 {
                    return 0.0;
                }
                weight *= 2.0;
            }
        }
    }

    /// After a collision: to the surface of a sphere; false if none is large enough.
    fn cross_sphere(&self, ray: &mut Ray, weight: &mut f32, random: &mut HashGenerator) -> bool {
        let least = self.least / self.sigma_t;
        let query = DistanceQuery { tolerance: 0.3, least, ..DistanceQuery::exact(ray.origin) };
        let radius = self.caster.distance_to_nearest(&query, 0);
        if radius < least {
            return false;
        }
        let departure = self.step.departure(radius * self.sigma_t);
        *weight *= departure.survival();
        let exit = departure.sample(random.next_f32());
        // The direction that was drawn serves as the place.
        let normal = ray.direction;
        ray.origin += normal * radius;
        if let Exit::Oblique { angle } = exit {
            let (sin, cos) = angle.sin_cos();
            let (y, x) = (TAU * random.next_f32()).sin_cos();
            ray.direction = Frame::from_normal(normal).to_world(Vec3::new(sin * x, sin * y, cos));
        }
        true
    }
}

/// Uniform over the sphere.
fn direction(random: &mut HashGenerator) -> Vec3 {
    let z = 1.0 - 2.0 * random.next_f32();
    let (sin, cos) = (TAU * random.next_f32()).sin_cos();
    let across = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(across * cos, across * sin, z)
}
