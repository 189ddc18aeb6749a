//! The parts of a path under the surface: probe segments, draws of the area integral, profile, boundary, lights.

use std::hint::black_box;
use std::path::Path;

use alabaster::diffusion::{NormalizedDiffusion, Profile};
use alabaster::math::sampler::HashGenerator;
use alabaster::math::{Frame, SampleStream, warp};
use alabaster::optics::Boundary;
use alabaster::plan::{Abilities, Plan, Request};
use alabaster::radiometry::Rgb;
use alabaster::raycast::embree::EmbreeCaster;
use alabaster::raycast::{Hit, Ray, RayCaster};
use alabaster::scene::{Method, read_scene};
use alabaster::transport::ProbeCounters;
use alabaster::transport::area_integral::AreaIntegral;
use alabaster::transport::basis::Tristimulus;
use alabaster::transport::light_choice::Receiver;
use alabaster::transport::light_sampling::LightSampler;
use alabaster::transport::spread::{Channels, Spread};
use alabaster::transport::world::{SurfacePoint, World};
use criterion::Criterion;
use glam::Vec3;

/// Shape parameters d of the swan's marble, m: about those that its coefficients give.
const SWAN_D: Rgb = Rgb::new(0.91e-3, 0.76e-3, 0.66e-3);

/// Points on the swan that the benches go round; a power of two.
const POINTS: usize = 1 << 14;

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/alabaster.toml");
    let scene = read_scene(&path).unwrap();
    let request = Request { method: Method::Bssrdf, ..Request::from(&scene.subsurface) };
    let methods = Plan::new(&scene, &request).methods();
    let world = World::new(scene, methods, |geometry| EmbreeCaster::new(geometry, 1)).unwrap();
    let points = points_on(&world, 0);
    bench_probe_segments(&mut criterion, &world, &points);
    bench_area_integral(&mut criterion, &world, &points);
    bench_light_sampling(&mut criterion, &world, &points);
    bench_profile(&mut criterion);
    bench_boundary(&mut criterion);
    criterion.final_summary();
}

/// Points spread over the triangles of an instance, in the order of the triangles: neighbours in
/// the list are near each other, as those of a picture are.
fn points_on(world: &World<EmbreeCaster>, instance: u32) -> Vec<SurfacePoint> {
    let scene = world.scene();
    let triangles = scene.meshes[scene.instances[instance as usize].mesh].triangles.len();
    let mut random = HashGenerator::new(1);
    let mut point = |i: usize| {
        let place = warp::square_to_triangle(random.next_f32(), random.next_f32());
        let primitive = (i * triangles / POINTS) as u32;
        world.surface::<{ Abilities::ALL.bits() }>(&Hit {
            t: 0.0,
            u: place.x,
            v: place.y,
            instance,
            primitive,
        })
    };
    (0..POINTS).map(&mut point).collect()
}

/// Segments along the normal beside each point, three mean radii long each way.
fn bench_probe_segments(criterion: &mut Criterion, world: &World<EmbreeCaster>, points: &[SurfacePoint]) {
    let profile = NormalizedDiffusion { d: SWAN_D[1] };
    let mut random = HashGenerator::new(2);
    let mut segment = |point: &SurfacePoint| {
        let frame = Frame::from_normal(point.geometric_normal);
        let (sin, cos) = (std::f32::consts::TAU * random.next_f32()).sin_cos();
        let beside = frame.tangent * cos + frame.bitangent * sin;
        let middle = point.position + beside * profile.sample_radius(random.next_f32());
        let half = point.geometric_normal * (7.5 * profile.d);
        Ray { origin: middle - half, direction: 2.0 * half, t_max: 1.0 }
    };
    let segments: Vec<Ray> = points.iter().map(&mut segment).collect();
    let (mut hits, mut next) = (Vec::new(), 0);
    criterion.bench_function("probe segment, all hits", |bencher| {
        bencher.iter(|| {
            next = (next + 1) % POINTS;
            world.caster().all_hits(&segments[next], 0, &mut hits);
            black_box(hits.len())
        });
    });
}

fn bench_area_integral(criterion: &mut Criterion, world: &World<EmbreeCaster>, points: &[SurfacePoint]) {
    let spread = Spread::new(SWAN_D.0.map(|d| NormalizedDiffusion { d }), world.diameter(0));
    let mut counters = ProbeCounters::default();
    let mut next = 0;
    criterion.bench_function("area integral, draw of an entry point", |bencher| {
        bencher.iter(|| {
            next += 1;
            let point = &points[next % POINTS];
            let integral = AreaIntegral {
                caster: world.caster(),
                geometric_normal: |hit: &Hit| world.geometric_normal(hit),
                instance: 0,
                spread: &spread,
                channels: Channels::of(Rgb::ONE),
                position: point.position,
                position_error: point.error.max_element(),
                normal: point.geometric_normal,
            };
            black_box(integral.sample(&SampleStream::new(1, next as u64, 0), 3, &mut counters))
        });
    });
    criterion.bench_function("spread of a material on a body", |bencher| {
        bencher.iter(|| Spread::new(black_box(SWAN_D).0.map(|d| NormalizedDiffusion { d }), black_box(0.2)));
    });
}

fn bench_light_sampling(criterion: &mut Criterion, world: &World<EmbreeCaster>, points: &[SurfacePoint]) {
    let lights = LightSampler::new(world, 1.0);
    let receivers: Vec<Receiver> = points
        .iter()
        .map(|point| Receiver { position: point.position, normal: Some(point.geometric_normal) })
        .collect();
    let mut random = HashGenerator::new(3);
    let mut next = 0;
    criterion.bench_function("light, draw towards a point", |bencher| {
        bencher.iter(|| {
            next = (next + 1) % POINTS;
            let u = [random.next_f32(), random.next_f32(), random.next_f32()];
            black_box(lights.sample::<_, _, 3, { Abilities::ALL.bits() }>(
                &Tristimulus,
                world,
                &receivers[next],
                u,
            ))
        });
    });
}

fn bench_profile(criterion: &mut Criterion) {
    let profile = NormalizedDiffusion { d: black_box(SWAN_D[1]) };
    let mut random = HashGenerator::new(4);
    criterion.bench_function("normalized diffusion, draw of a radius", |bencher| {
        bencher.iter(|| profile.sample_radius(black_box(random.next_f32())));
    });
    criterion.bench_function("normalized diffusion, density", |bencher| {
        bencher.iter(|| profile.density(black_box(1e-3 * random.next_f32())));
    });
}

fn bench_boundary(criterion: &mut Criterion) {
    let mut random = HashGenerator::new(5);
    for (name, alpha) in [("smooth", 0.0), ("rough", 0.1225)] {
        let boundary = Boundary::new(1.5, alpha);
        criterion.bench_function(&format!("{name} boundary, draw of an exit direction"), |bencher| {
            bencher.iter(|| boundary.sample_exit([random.next_f32(), random.next_f32()]));
        });
        criterion.bench_function(&format!("{name} boundary, exit lobe and its density"), |bencher| {
            bencher.iter(|| {
                let mu = random.next_f32();
                boundary.exit_lobe(mu) + boundary.exit_density(mu)
            });
        });
        let wo = Vec3::new(0.48, 0.6, 0.64);
        criterion.bench_function(&format!("{name} boundary, draw of a reflection"), |bencher| {
            bencher
                .iter(|| boundary.sample_reflection(black_box(wo), [random.next_f32(), random.next_f32()]));
        });
    }
}
