//! Owned handles of Embree's scenes and geometries, and how they are filled.

use embree4_sys as rtc;
use glam::{Affine3A, Vec3};

use super::device::Device;
use crate::raycast::{RaycastError, TriangleMesh};

/// A scene: geometries under one bounding volume hierarchy. Ready for queries once committed.
pub(super) struct Scene {
    handle: rtc::RTCScene,
}

// SAFETY: a scene is changed only between `new` and `commit`, while its builder owns it; committed
// scenes answer queries from any number of threads and may be released from any thread.
unsafe impl Send for Scene {}
// SAFETY: as above: through a shared reference to a committed scene there are queries only.
unsafe impl Sync for Scene {}

impl Scene {
    /// An empty scene. `filtered` lets queries bring a filter function along, which makes all of the
    /// scene's queries a little slower.
    ///
    /// Scenes are ROBUST: without that flag rays leak through shared edges and vertices (see the module
    /// documentation for what it costs).
    pub(super) fn new(device: &Device, filtered: bool) -> Result<Self, RaycastError> {
        let mut flags = rtc::RTCSceneFlags::RTC_SCENE_FLAG_ROBUST;
        if filtered {
            flags |= rtc::RTCSceneFlags::RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS;
        }
        // SAFETY: the device is open. A null scene is only passed on to functions that report it as an
        // error, which `check` returns before it can be used.
        let scene = unsafe {
            let handle = rtc::rtcNewScene(device.handle());
            rtc::rtcSetSceneFlags(handle, flags);
            rtc::rtcSetSceneBuildQuality(handle, rtc::RTC_BUILD_QUALITY_MEDIUM);
            Self { handle }
        };
        device.check()?;
        Ok(scene)
    }

    /// Adds `shape` under the identifier `id`, which must be free.
    pub(super) fn attach(&mut self, shape: &Shape, id: u32) {
        // SAFETY: both handles are valid; the scene takes a reference to the geometry. A taken
        // identifier is an error that `commit` reports.
        unsafe { rtc::rtcAttachGeometryByID(self.handle, shape.handle, id) };
    }

    /// Builds the hierarchy.
    pub(super) fn commit(&mut self, device: &Device) -> Result<(), RaycastError> {
        // SAFETY: the handle is valid and nothing else uses the scene (`&mut self`).
        unsafe { rtc::rtcCommitScene(self.handle) };
        device.check()
    }

    pub(super) fn handle(&self) -> rtc::RTCScene {
        self.handle
    }
}

impl Drop for Scene {
    fn drop(&mut self) {
        // SAFETY: the one reference that `rtcNewScene` returned.
        unsafe { rtc::rtcReleaseScene(self.handle) };
    }
}

/// A geometry: triangles, or a whole scene placed by a transform.
pub(super) struct Shape {
    handle: rtc::RTCGeometry,
}

impl Shape {
    /// The triangles of `mesh` with each position mapped by `transform`. The indices must have been
    /// checked ([`crate::raycast::Geometry::validate`]).
    pub(super) fn triangles(
        device: &Device,
        mesh: &TriangleMesh,
        transform: &Affine3A,
    ) -> Result<Self, RaycastError> {
        let shape = Self::new(device, rtc::RTC_GEOMETRY_TYPE_TRIANGLE)?;
        let positions = mesh.positions.iter().map(|&position| transform.transform_point3(position));
        shape.fill::<Vec3>(device, rtc::RTC_BUFFER_TYPE_VERTEX, rtc::RTC_FORMAT_FLOAT3, positions)?;
        let triangles = mesh.triangles.iter().copied();
        shape.fill::<[u32; 3]>(device, rtc::RTC_BUFFER_TYPE_INDEX, rtc::RTC_FORMAT_UINT3, triangles)?;
        shape.commit(device)
    }

    /// The committed `scene`, placed by `transform`.
    pub(super) fn instance(
        device: &Device,
        scene: &Scene,
        transform: &Affine3A,
    ) -> Result<Self, RaycastError> {
        let shape = Self::new(device, rtc::RTC_GEOMETRY_TYPE_INSTANCE)?;
        let columns = transform.to_cols_array();
        // SAFETY: all handles are valid (the geometry takes a reference to the scene); the library
        // copies the twelve numbers that the format names before the call returns.
        unsafe {
            rtc::rtcSetGeometryInstancedScene(shape.handle, scene.handle);
            let format = rtc::RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR;
            rtc::rtcSetGeometryTransform(shape.handle, 0, format, columns.as_ptr().cast());
        }
        shape.commit(device)
    }

    fn new(device: &Device, kind: rtc::RTCGeometryType) -> Result<Self, RaycastError> {
        // SAFETY: the device is open; a null geometry comes with an error, which `check` returns.
        let shape = Self { handle: unsafe { rtc::rtcNewGeometry(device.handle(), kind) } };
        device.check()?;
        Ok(shape)
    }

    fn commit(self, device: &Device) -> Result<Self, RaycastError> {
        // SAFETY: the handle is valid.
        unsafe { rtc::rtcCommitGeometry(self.handle) };
        device.check()?;
        Ok(self)
    }

    /// Lets the library allocate a buffer, padded to its own needs, and copies `items` there.
    fn fill<T: Copy>(
        &self,
        device: &Device,
        buffer: rtc::RTCBufferType,
        format: rtc::RTCFormat,
        items: impl ExactSizeIterator<Item = T>,
    ) -> Result<(), RaycastError> {
        let count = items.len();
        // SAFETY: the handle is valid.
        let start =
            unsafe { rtc::rtcSetNewGeometryBuffer(self.handle, buffer, 0, format, size_of::<T>(), count) }
                .cast::<T>();
        device.check()?;
        for (index, item) in items.take(count).enumerate() {
            // SAFETY: the buffer was allocated without error for `count` items of this size, aligned to
            // 16 bytes, and nobody reads it before the geometry is committed.
            unsafe { start.add(index).write(item) };
        }
        Ok(())
    }
}

impl Drop for Shape {
    fn drop(&mut self) {
        // SAFETY: the one reference that `rtcNewGeometry` returned; scenes hold references of their own.
        unsafe { rtc::rtcReleaseGeometry(self.handle) };
    }
}
