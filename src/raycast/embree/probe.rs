//! Every hit on a segment, in one traversal.
//!
//! A filter function that records each hit and then rejects it makes the traversal go on to the end of
//! the segment. It runs under the occlusion query, which visits nodes in no particular order and is
//! therefore faster than the query for the nearest hit. Restarting a ray behind its last hit
//! would be slower, and loses the second of two hits at the same distance.

use std::mem;
use std::ptr;

use embree4_sys as rtc;
use glam::DAffine3;

use super::scene::Scene;
use super::{NO_CONTEXT, to_embree};
use crate::raycast::{Hit, Ray};

/// What the library hands back to the filter function: its own context first, then ours.
#[repr(C)]
struct Context {
    library: rtc::RTCRayQueryContext,
    hits: *mut Vec<Hit>,
    instance: u32,
    /// From the parameter of Embree's ray to that of ours.
    t_scale: f32,
}

/// Replaces the content of `hits` by the crossings of `ray` with `scene`, one for each triangle crossed,
/// in ascending order of triangles: the same order whatever the hierarchy looks like.
pub(super) fn all_hits(scene: &Scene, ray: &Ray, instance: u32, hits: &mut Vec<Hit>) {
    hits.clear();
    let (mut query, t_scale) = to_embree(ray);
    let mut context = Context { library: NO_CONTEXT, hits: ptr::from_mut(hits), instance, t_scale };
    // SAFETY: plain C data, for which all zeros is the state of "nothing set".
    let mut arguments: rtc::RTCOccludedArguments = unsafe { mem::zeroed() };
    arguments.flags = rtc::RTCRayQueryFlags::RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER;
    arguments.feature_mask = rtc::RTCFeatureFlags::RTC_FEATURE_FLAG_ALL;
    arguments.context = ptr::from_mut(&mut context).cast();
    arguments.filter = Some(record_and_reject);
    // SAFETY: the scene is committed and was made for filters in arguments. Ray, arguments and context
    // live on this stack frame and are used by nobody else; the context points to a `Context`.
    unsafe { rtc::rtcOccluded1(scene.handle(), &mut query, &mut arguments) };

    // A primitive may be offered to the filter more than once.
    hits.sort_unstable_by_key(|hit| hit.primitive);
    hits.dedup_by_key(|hit| hit.primitive);
}

/// The segment seen from object space. Its parameter keeps its meaning, because the direction is mapped
/// without being normalized. Computed in double precision: single would add its own rounding of
/// the translation, which for an object far from the origin is larger than the hit's.
pub(super) fn to_object_space(ray: &Ray, to_object: &DAffine3) -> Ray {
    Ray {
        origin: to_object.transform_point3(ray.origin.as_dvec3()).as_vec3(),
        direction: to_object.transform_vector3(ray.direction.as_dvec3()).as_vec3(),
        t_max: ray.t_max,
    }
}

unsafe extern "C" fn record_and_reject(arguments: *const rtc::RTCFilterFunctionNArguments) {
    // SAFETY: the library calls this during `all_hits` with valid arguments. Rays are cast one by one,
    // so N is 1, and then the layouts of `ray` and `hit` are those of `RTCRay` and of the beginning of
    // `RTCHit`. No alignment is promised: fields are read by their address. The context is the one that
    // `all_hits` passed; its vector is borrowed there for the whole query, and not touched meanwhile.
    unsafe {
        let arguments = &*arguments;
        debug_assert_eq!(arguments.N, 1);
        let context = arguments.context.cast::<Context>();
        let ray = arguments.ray.cast::<rtc::RTCRay>();
        let hit = arguments.hit.cast::<rtc::RTCHit>();
        (*(*context).hits).push(Hit {
            t: (&raw const (*ray).tfar).read_unaligned() * (*context).t_scale,
            u: (&raw const (*hit).u).read_unaligned(),
            v: (&raw const (*hit).v).read_unaligned(),
            instance: (*context).instance,
            primitive: (&raw const (*hit).primID).read_unaligned(),
        });
        arguments.valid.write(0);
    }
}
