//! Ray casters against Embree called with nothing around it.
//!
//! `cargo bench --bench raycast [ROUNDS [SCENE]]`: the rays of a scene (a ball of 1.3 million triangles, if none is given), recorded while it was rendered, are cast in turns on one thread
//! by bare Embree with its default flags, by bare Embree with the flag ROBUST, by our wrapper of that, and by the hierarchies in Rust. Speeds
//! are medians of all turns, ratios medians of the ratios within a turn. Bare Embree is given rays in its own layout and keeps its hits to
//! itself; of probes it counts the hits.

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
use alabaster::raycast::{Ray, RayCaster};
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

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let rounds = arguments.first().map_or(9, |rounds| rounds.parse().expect("ROUNDS is a number"));
    let scene = arguments.get(1).map_or_else(ball, |path| read_scene(&PathBuf::from(path)).unwrap());
    let options = RenderOptions::of(&scene, 0);
    let recorder =
        Renderer::new(scene.clone(), options, |geometry| BvhCaster::new(geometry).map(Recorder::new));
    let recorder = recorder.unwrap();
    let recording = record(&recorder, RAYS);

    let start = process_seconds();
    // With the lights that can be met.
    let met = recorder.scene();
    let plain = Bare::new(met, false);
    println!("bare Embree: {:.2} CPU s, {} MB", process_seconds() - start, plain.bytes() >> 20);
    let robust = Bare::new(met, true);
    let wrapper = caster("wrapper", &scene, |g| EmbreeCaster::new(g, 0), EmbreeCaster::bytes);
    let bvh = caster("bvh", &scene, BvhCaster::new, BvhCaster::bytes);
    let portable =
        caster("portable", &scene, |g| BvhCaster::new(g).map(BvhCaster::portable), BvhCaster::bytes);
    let obvhs = caster("obvhs", &scene, ObvhsCaster::new, ObvhsCaster::bytes);
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

/// Seconds for rays of a kind.
type Cast<'a> = dyn Fn(Kind, &[Query]) -> f64 + 'a;

fn caster<C: RayCaster>(
    name: &str,
    scene: &Scene,
    build: impl FnOnce(&alabaster::raycast::Geometry) -> Result<C, alabaster::raycast::RaycastError>,
    bytes: impl FnOnce(&C) -> usize,
) -> Renderer<C> {
    let mut built = 0.0;
    let renderer = Renderer::new(scene.clone(), RenderOptions::of(scene, 0), |geometry| {
        let start = process_seconds();
        let caster = build(geometry);
        built = process_seconds() - start;
        caster
    });
    let renderer = renderer.unwrap();
    println!("{name}: {built:.2} CPU s, {} MB", bytes(renderer.caster()) >> 20);
    renderer
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
        let turns: Vec<Vec<f64>> =
            (0..rounds).map(|_| contestants.iter().map(|(_, cast)| cast(kind, queries)).collect()).collect();
        let of = |value: &dyn Fn(&[f64]) -> f64| {
            Spread::of(&turns.iter().map(|turn| value(turn)).collect::<Vec<_>>())
        };
        print!("{name:8}");
        for contestant in 0..contestants.len() {
            print!("{:10.3}", of(&|turn| 1e-6 * queries.len() as f64 / turn[contestant]).median);
        }
        for (first, second) in [(0, 3), (1, 3), (1, 2)] {
            let ratio = of(&|turn| turn[first] / turn[second]);
            print!("   {:.3} ± {:.3}", ratio.median, ratio.deviation);
        }
        println!();
    }
}

/// Embree with nothing around it: one geometry for each instance, in the world.
struct Bare {
    scene: rtc::RTCScene,
    bytes: Box<AtomicIsize>,
}

impl Bare {
    fn new(scene: &Scene, robust: bool) -> Self {
        let bytes = Box::new(AtomicIsize::new(0));
        // SAFETY: as the manual of Embree says. The counter lives as long as the device, which is never released.
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
        Self { scene: handle, bytes }
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
