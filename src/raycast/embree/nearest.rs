//! The distance from a point to the triangles of a body, by Embree's point query.
//!
//! The library walks the hierarchy and calls back for each triangle in boxes within the radius of the query, which the
//! callback shrinks. Distances are its own affair: they are computed here, from the buffers that the library holds.

use std::ffi::c_void;
use std::mem;
use std::ptr;

use embree4_sys as rtc;
use glam::Vec3;

use super::scene::Scene;
use crate::raycast::nearest::Nearest;

/// The vertices and indices of a scene's only geometry.
struct Triangles {
    positions: *const Vec3,
    indices: *const [u32; 3],
}

/// What the library hands back to the callback.
struct Context<'a, 'b> {
    triangles: Triangles,
    search: &'a mut Nearest<'b>,
}

/// Offers `search` every triangle of `scene` that can be the nearest. The scene has one geometry, of triangles.
pub(super) fn nearest(scene: &Scene, search: &mut Nearest) {
    let point = search.local_point();
    // SAFETY: plain C data, for which all zeros is a value: no transform is on the stack.
    let mut context: rtc::RTCPointQueryContext = unsafe { mem::zeroed() };
    context.instID = [rtc::RTC_INVALID_GEOMETRY_ID; rtc::RTC_MAX_INSTANCE_LEVEL_COUNT as usize];
    let mut query =
        rtc::RTCPointQuery { x: point.x, y: point.y, z: point.z, time: 0.0, radius: search.radius() };
    // SAFETY: the scene is committed and holds, under identifier 0, a geometry of triangles, whose buffers live and stay as
    // they are for as long as the scene.
    let triangles = unsafe {
        let geometry = rtc::rtcGetGeometry(scene.handle(), 0);
        let buffer = |kind| rtc::rtcGetGeometryBufferData(geometry, kind, 0);
        Triangles {
            positions: buffer(rtc::RTC_BUFFER_TYPE_VERTEX).cast(),
            indices: buffer(rtc::RTC_BUFFER_TYPE_INDEX).cast(),
        }
    };
    let mut ours = Context { triangles, search };
    let user = ptr::from_mut(&mut ours).cast::<c_void>();
    // SAFETY: the scene is committed; query, context and `ours` live on this stack frame and are used by nobody else
    // meanwhile. The callback takes its pointer for a `Context`, which it is.
    unsafe { rtc::rtcPointQuery(scene.handle(), &mut query, &mut context, Some(look_at_triangle), user) };
}

/// True if the radius of the query has become smaller.
unsafe extern "C" fn look_at_triangle(arguments: *mut rtc::RTCPointQueryFunctionArguments) -> bool {
    // SAFETY: the library calls this during `nearest` with valid arguments and the pointer that was given there. The
    // primitive is one of the geometry, so its index is in range of the buffer, and its vertices are in range of theirs
    // (`Geometry::validate`). Nobody writes to the buffers.
    unsafe {
        let arguments = &*arguments;
        let Context { triangles, search } = &mut *arguments.userPtr.cast::<Context>();
        let indices = triangles.indices.add(arguments.primID as usize).read();
        let corners = indices.map(|index| triangles.positions.add(index as usize).read());
        let nearer = search.offer(corners);
        if nearer {
            (*arguments.query).radius = search.radius();
        }
        nearer
    }
}
