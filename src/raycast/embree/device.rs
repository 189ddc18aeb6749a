//! The Embree device: what scenes are made with, what counts their memory and receives their errors.

use std::ffi::{CStr, CString, c_char, c_void};
use std::sync::atomic::{AtomicIsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use embree4_sys as rtc;

use crate::raycast::RaycastError;

/// An open device. Scenes made with it hold it alive inside the library.
pub(super) struct Device {
    handle: rtc::RTCDevice,
    /// Written to by the library's callbacks; shared so that its address outlives every move.
    monitor: Arc<Monitor>,
}

/// What the library tells while it builds.
#[derive(Default)]
struct Monitor {
    bytes: AtomicIsize,
    first_error: Mutex<Option<String>>,
}

// SAFETY: a device may be used and released from any thread (Embree manual, "Thread safety"); the
// monitor consists of an atomic and a mutex.
unsafe impl Send for Device {}
// SAFETY: as above; calls that change the device are made in `new` and `drop` only.
unsafe impl Sync for Device {}

impl Device {
    /// Opens a device that builds with `threads` threads (0: one per core).
    ///
    /// # Errors
    /// If the library cannot open one, or is not the version whose header this program was built with.
    pub(super) fn new(threads: usize) -> Result<Self, RaycastError> {
        let configuration = CString::new(format!("threads={threads},verbose=0")).unwrap_or_default();
        // SAFETY: the configuration is a terminated string that outlives the call.
        let handle = unsafe { rtc::rtcNewDevice(configuration.as_ptr()) };
        if handle.is_null() {
            // SAFETY: the null device is allowed: it asks for the error of the failed creation.
            let code = unsafe { rtc::rtcGetDeviceError(handle) };
            return Err(library_error(describe(code).to_string()));
        }
        let device = Self { handle, monitor: Arc::default() };
        device.check_version()?;
        let monitor = Arc::as_ptr(&device.monitor).cast_mut().cast::<c_void>();
        // SAFETY: the device is open. `monitor` points to a `Monitor`, as both callbacks expect, and is
        // valid until after the device was released (see `drop`).
        unsafe {
            rtc::rtcSetDeviceErrorFunction(handle, Some(record_error), monitor);
            rtc::rtcSetDeviceMemoryMonitorFunction(handle, Some(count_bytes), monitor);
        }
        Ok(device)
    }

    /// The library's own layout of rays and hits belongs to the version of the header.
    fn check_version(&self) -> Result<(), RaycastError> {
        // SAFETY: the device is open.
        let loaded = unsafe { rtc::rtcGetDeviceProperty(self.handle, rtc::RTC_DEVICE_PROPERTY_VERSION) };
        let built = rtc::RTC_VERSION as isize;
        if loaded == built {
            return Ok(());
        }
        let name = |version: isize| format!("{}.{}.{}", version / 10_000, version / 100 % 100, version % 100);
        Err(RaycastError::Version { built: name(built), loaded: name(loaded) })
    }

    pub(super) fn handle(&self) -> rtc::RTCDevice {
        self.handle
    }

    /// Bytes that the library holds for this device.
    pub(super) fn bytes(&self) -> usize {
        usize::try_from(self.monitor.bytes.load(Ordering::Relaxed)).unwrap_or_default()
    }

    /// The first error since the last call, if any.
    pub(super) fn check(&self) -> Result<(), RaycastError> {
        let error = self.monitor.first_error.lock().unwrap_or_else(PoisonError::into_inner).take();
        error.map_or(Ok(()), |message| Err(library_error(message)))
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: the one reference that `rtcNewDevice` returned. The monitor is a field, dropped after
        // this, and the owner drops its scenes first, so no callback comes later.
        unsafe { rtc::rtcReleaseDevice(self.handle) };
    }
}

fn library_error(message: String) -> RaycastError {
    RaycastError::Library { library: "Embree", message }
}

fn describe(code: rtc::RTCError) -> &'static str {
    match code {
        rtc::RTC_ERROR_INVALID_ARGUMENT => "invalid argument",
        rtc::RTC_ERROR_INVALID_OPERATION => "invalid operation",
        rtc::RTC_ERROR_OUT_OF_MEMORY => "out of memory",
        rtc::RTC_ERROR_UNSUPPORTED_CPU => "this processor is not supported (SSE2 or NEON is needed)",
        rtc::RTC_ERROR_CANCELLED => "cancelled",
        _ => "unknown error",
    }
}

unsafe extern "C" fn record_error(monitor: *mut c_void, code: rtc::RTCError, message: *const c_char) {
    // SAFETY: `Device::new` registered this function with a pointer to its monitor.
    let monitor = unsafe { &*monitor.cast::<Monitor>() };
    let mut text = describe(code).to_string();
    if !message.is_null() {
        // SAFETY: the library passes a terminated string that lives as long as this call.
        let detail = unsafe { CStr::from_ptr(message) };
        text = format!("{text}: {}", detail.to_string_lossy());
    }
    monitor.first_error.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(text);
}

/// Counts allocations (positive) and releases (negative); refuses none.
unsafe extern "C" fn count_bytes(monitor: *mut c_void, bytes: isize, _after: bool) -> bool {
    // SAFETY: `Device::new` registered this function with a pointer to its monitor.
    let monitor = unsafe { &*monitor.cast::<Monitor>() };
    monitor.bytes.fetch_add(bytes, Ordering::Relaxed);
    true
}
