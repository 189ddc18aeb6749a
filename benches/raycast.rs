//! Ray casters against Embree called with nothing around it.
//!
//! `cargo bench --bench raycast [ROUNDS [SCENE]]`: hierarchies over a scene (a ball of 1.3 million triangles, if none is given) are built in turns, and the
//! rays of it, recorded while it was rendered, are cast on one thread, in turns of a few thousand: by bare Embree with its default flags, by bare
//! Embree with the flag ROBUST, by our wrapper of that, and by the hierarchies in Rust. Ratios are medians of those of whole rounds, speeds are those of the
//! median round. Bare Embree is given rays in its own layout and keeps its hits to itself; of probes it counts the hits.

#![allow(unsafe_code)]

#[path = "../tests/common"]
#[allow(dead_code)]
mod common {
    pub mod cpu_time;
}

use std::ffi::c_void;
use std::hint::black_box;
use std::mem;
use std::path::PathBuf;
use std::ptr;
use std::sync::atomic::{AtomicIsize, Ordering};
use std::time::Instant;

use alabaster::raycast::bvh::BvhCaster;
use alabaster::raycast::embree::EmbreeCaster;
use alabaster::raycast::obvhs::ObvhsCaster;
use alabaster::raycast::{Geometry, Ray, RayCaster, RaycastError};
use alabaster::scene::{Scene, read_scene};
use alabaster::study::race::Kind;
use alabaster::study::race::record::{Query, Recorder, Recording, record};
use alabaster::study::race::replay::{Spread, seconds};
use alabaster::study::race::scene::ball;
use alabaster::transport::{RenderOptions, Renderer};
use common::cpu_time::process_seconds;
use embree4_sys as rtc;

/// Rays of each kind.
const RAYS: usize = 1 << 19;

/// Rays of a turn: so few that all contestants cast them on the machine as it is at that moment.
const TURN: usize = 1 << 14;

/// Seconds for rays of a kind.
type Cast<'a> = dyn Fn(Kind, &[Query]) -> f64 + 'a;

/// Builds something over the scene and releases it again.
type Build<'a> = dyn Fn(&Geometry) + 'a;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let rounds = arguments.first().map_or(9, |rounds| rounds.parse().expect("ROUNDS is a number"));
    let scene = arguments.get(1).map_or_else(ball, |path| read_scene(&PathBuf::from(path)).unwrap());
    let recorder = renderer(&scene, |geometry| BvhCaster::new(geometry).map(Recorder::new));
    let recording = record(&recorder, RAYS);

    // With the lights that can be met.
    let met = recorder.scene();
    let plain = Bare::new(met, false);
    let robust = Bare::new(met, true);
    let wrapper = renderer(&scene, |geometry| EmbreeCaster::new(geometry, 0));
    let bvh = renderer(&scene, |geometry| {
        let builders: [(&str, &Build); 4] = [
            ("bare", &|_| drop(Bare::new(met, false))),
            ("wrapper", &|geometry| drop(EmbreeCaster::new(geometry, 0).unwrap())),
            ("bvh", &|geometry| drop(BvhCaster::new(geometry).unwrap())),
            ("obvhs", &|geometry| drop(ObvhsCaster::new(geometry).unwrap())),
        ];
        race_builds(geometry, rounds, &builders);
        BvhCaster::new(geometry)
    });
    let portable = renderer(&scene, |geometry| BvhCaster::new(geometry).map(BvhCaster::portable));
    let obvhs = renderer(&scene, ObvhsCaster::new);
    let sizes = [
        ("bare", plain.bytes()),
        ("wrapper", wrapper.caster().bytes()),
        ("bvh", bvh.caster().bytes()),
        ("obvhs", obvhs.caster().bytes()),
    ];
    print!("\n{:8}", "MB");
    sizes.iter().for_each(|(name, bytes)| print!("   {name} {}", bytes >> 20));
    println!();

    let contestants: [(&str, &Cast); 6] = [
        ("bare", &|kind, queries| plain.seconds(kind, queries)),
        ("robust", &|kind, queries| robust.seconds(kind, queries)),
        ("wrapper", &|kind, queries| seconds(wrapper.caster(), kind, queries)),
        ("bvh", &|kind, queries| seconds(bvh.caster(), kind, queries)),
        ("portable", &|kind, queries| seconds(portable.caster(), kind, queries)),
        ("obvhs", &|kind, queries| seconds(obvhs.caster(), kind, queries)),
    ];
    race(&recording, rounds, &contestants);
}

fn renderer<C: RayCaster>(
    scene: &Scene,
    build: impl FnOnce(&Geometry) -> Result<C, RaycastError>,
) -> Renderer<C> {
    Renderer::new(scene.clone(), RenderOptions::of(scene, 0), build).unwrap()
}

fn race_builds(geometry: &Geometry, rounds: usize, builders: &[(&str, &Build)]) {
    let time = |build: &Build| {
        let (wall, processor) = (Instant::now(), process_seconds());
        build(geometry);
        (wall.elapsed().as_secs_f64(), process_seconds() - processor)
    };
    let rounds: Vec<Vec<_>> =
        (0..rounds).map(|round| in_turns(round, builders, |(_, build)| time(build))).collect();
    println!("build and release          s       /bare       CPU s       /bare");
    for (index, (name, _)) in builders.iter().enumerate() {
        print!("{name:18}");
        for of in [|(wall, _)| wall, |(_, processor)| processor] {
            let seconds = spread(&rounds, |round: &Vec<(f64, f64)>| of(round[index]));
            let ratio = spread(&rounds, |round| of(round[index]) / of(round[0]));
            print!("{:10.2}   {:.2} ± {:.2}", seconds.median, ratio.median, ratio.deviation);
        }
        println!();
    }
}

fn race(recording: &Recording, rounds: usize, contestants: &[(&str, &Cast)]) {
    print!("\n{:8}", "Mrays/s");
    contestants.iter().for_each(|(name, _)| print!("{name:>10}"));
    println!("   bvh/bare  bvh/robust  wrapper/robust");
    for (name, kind) in Kind::NAMES {
        let queries = recording.of(kind);
        if queries.is_empty() {
            continue;
        }
        let round = |round: usize| {
            let mut sums = vec![0.0; contestants.len()];
            for (turn, queries) in queries.chunks(TURN).enumerate() {
                let seconds = in_turns(round + turn, contestants, |(_, cast)| cast(kind, queries));
                sums.iter_mut().zip(seconds).for_each(|(sum, seconds)| *sum += seconds);
            }
            sums
        };
        let rounds: Vec<Vec<f64>> = (0..rounds).map(round).collect();
        print!("{name:8}");
        for contestant in 0..contestants.len() {
            print!(
                "{:10.3}",
                spread(&rounds, |round| 1e-6 * queries.len() as f64 / round[contestant]).median
            );
        }
        for (first, second) in [(0, 3), (1, 3), (1, 2)] {
            let ratio = spread(&rounds, |round| round[first] / round[second]);
            print!("   {:.3} ± {:.3}", ratio.median, ratio.deviation);
        }
        println!();
    }
}

/// What `act` says of each contestant; `first` begins, counted round.
fn in_turns<C, T>(first: usize, contestants: &[C], act: impl Fn(&C) -> T) -> Vec<T> {
    let first = first % contestants.len();
    let mut results: Vec<T> = contestants[first..].iter().chain(&contestants[..first]).map(act).collect();
    results.rotate_right(first);
    results
}

fn spread<T>(rounds: &[T], value: impl Fn(&T) -> f64) -> Spread {
    Spread::of(&rounds.iter().map(value).collect::<Vec<_>>())
}

/// Embree with nothing around it: one geometry for each instance, in the world.
struct Bare {
    device: rtc::RTCDevice,
    scene: rtc::RTCScene,
    bytes: Box<AtomicIsize>,
}

impl Bare {
    fn new(scene: &Scene, robust: bool) -> Self {
        let bytes = Box::new(AtomicIsize::new(0));
        // SAFETY: as the manual of Embree says. The counter lives as long as the device.
        let (device, handle) = unsafe {
            let device = rtc::rtcNewDevice(c"".as_ptr());
            let monitor = ptr::from_ref(&*bytes).cast_mut().cast::<c_void>();
            rtc::rtcSetDeviceMemoryMonitorFunction(device, Some(count_bytes), monitor);
            let handle = rtc::rtcNewScene(device);
            let filters = rtc::RTCSceneFlags::RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS;
            let flags = if robust { filters | rtc::RTCSceneFlags::RTC_SCENE_FLAG_ROBUST } else { filters };
            rtc::rtcSetSceneFlags(handle, flags);
            (device, handle)
        };
        for instance in &scene.instances {
            let mesh = &scene.meshes[instance.mesh];
            let position = |&position| instance.transform.transform_point3(position).to_array();
            let positions: Vec<[f32; 3]> = mesh.positions.iter().map(position).collect();
            // SAFETY: both buffers are as large as they are declared.
            unsafe {
                let geometry = rtc::rtcNewGeometry(device, rtc::RTC_GEOMETRY_TYPE_TRIANGLE);
                let new =
                    |kind, format, count| rtc::rtcSetNewGeometryBuffer(geometry, kind, 0, format, 12, count);
                let place = new(rtc::RTC_BUFFER_TYPE_VERTEX, rtc::RTC_FORMAT_FLOAT3, positions.len());
                ptr::copy_nonoverlapping(positions.as_ptr(), place.cast(), positions.len());
                let place = new(rtc::RTC_BUFFER_TYPE_INDEX, rtc::RTC_FORMAT_UINT3, mesh.triangles.len());
                ptr::copy_nonoverlapping(mesh.triangles.as_ptr(), place.cast(), mesh.triangles.len());
                rtc::rtcCommitGeometry(geometry);
                rtc::rtcAttachGeometry(handle, geometry);
                rtc::rtcReleaseGeometry(geometry);
            }
        }
        // SAFETY: all geometries are committed.
        unsafe { rtc::rtcCommitScene(handle) };
        Self { device, scene: handle, bytes }
    }

    fn bytes(&self) -> usize {
        self.bytes.load(Ordering::Relaxed).unsigned_abs()
    }

    /// Seconds for all rays, which are put into Embree's layout before.
    fn seconds(&self, kind: Kind, queries: &[Query]) -> f64 {
        let rays: Vec<rtc::RTCRay> = queries.iter().map(|query| to_embree(&query.ray)).collect();
        let cast: unsafe fn(rtc::RTCScene, rtc::RTCRay) -> usize = match kind {
            Kind::Camera | Kind::Bounce => closest,
            Kind::Shadow => occluded,
            Kind::Probe => all_hits,
        };
        let start = Instant::now();
        // SAFETY: the scene is committed.
        let hits: usize = rays.iter().map(|ray| unsafe { cast(self.scene, *ray) }).sum();
        black_box(hits);
        start.elapsed().as_secs_f64()
    }
}

impl Drop for Bare {
    fn drop(&mut self) {
        // SAFETY: both are held once.
        unsafe {
            rtc::rtcReleaseScene(self.scene);
            rtc::rtcReleaseDevice(self.device);
        }
    }
}

unsafe extern "C" fn count_bytes(counter: *mut c_void, bytes: isize, _post: bool) -> bool {
    // SAFETY: the counter that was given with this function.
    unsafe { &*counter.cast::<AtomicIsize>() }.fetch_add(bytes, Ordering::Relaxed);
    true
}

fn to_embree(ray: &Ray) -> rtc::RTCRay {
    let ([org_x, org_y, org_z], [dir_x, dir_y, dir_z]) = (ray.origin.to_array(), ray.direction.to_array());
    let (tfar, mask) = (ray.t_max, u32::MAX);
    rtc::RTCRay {
        org_x,
        org_y,
        org_z,
        tnear: 0.0,
        dir_x,
        dir_y,
        dir_z,
        time: 0.0,
        tfar,
        mask,
        id: 0,
        flags: 0,
    }
}

unsafe fn closest(scene: rtc::RTCScene, ray: rtc::RTCRay) -> usize {
    // SAFETY: all zeros is a hit; the scene is committed.
    unsafe {
        let mut query = rtc::RTCRayHit { ray, hit: mem::zeroed() };
        query.hit.geomID = rtc::RTC_INVALID_GEOMETRY_ID;
        query.hit.instID[0] = rtc::RTC_INVALID_GEOMETRY_ID;
        rtc::rtcIntersect1(scene, &mut query, ptr::null_mut());
        usize::from(query.hit.geomID != rtc::RTC_INVALID_GEOMETRY_ID)
    }
}

unsafe fn occluded(scene: rtc::RTCScene, mut ray: rtc::RTCRay) -> usize {
    // SAFETY: the scene is committed.
    unsafe { rtc::rtcOccluded1(scene, &mut ray, ptr::null_mut()) };
    usize::from(ray.tfar == f32::NEG_INFINITY)
}

#[repr(C)]
struct Context {
    library: rtc::RTCRayQueryContext,
    hits: usize,
}

unsafe fn all_hits(scene: rtc::RTCScene, mut ray: rtc::RTCRay) -> usize {
    // SAFETY: all zeros is "nothing set"; the context is the one that `reject` expects.
    unsafe {
        let mut context = Context { library: mem::zeroed(), hits: 0 };
        context.library.instID[0] = rtc::RTC_INVALID_GEOMETRY_ID;
        let mut arguments: rtc::RTCOccludedArguments = mem::zeroed();
        arguments.flags = rtc::RTCRayQueryFlags::RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER;
        arguments.feature_mask = rtc::RTCFeatureFlags::RTC_FEATURE_FLAG_ALL;
        arguments.context = ptr::from_mut(&mut context).cast();
        arguments.filter = Some(reject);
        rtc::rtcOccluded1(scene, &mut ray, &mut arguments);
        context.hits
    }
}

unsafe extern "C" fn reject(arguments: *const rtc::RTCFilterFunctionNArguments) {
    // SAFETY: called by `all_hits` only, with its context.
    unsafe {
        (*(*arguments).context.cast::<Context>()).hits += 1;
        (*arguments).valid.write(0);
    }
}
