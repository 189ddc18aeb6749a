//! The library that the loader picks is the one whose header the bindings were generated from.

use std::ptr;

use embree4_sys as embree;

#[test]
fn a_device_reports_the_version_of_the_header() {
    // SAFETY: a null configuration is the default one; the device is used between its creation and
    // its release, on one thread.
    let (created, version) = unsafe {
        let device = embree::rtcNewDevice(ptr::null());
        let version = embree::rtcGetDeviceProperty(device, embree::RTC_DEVICE_PROPERTY_VERSION);
        embree::rtcReleaseDevice(device);
        (!device.is_null(), version)
    };
    assert!(created);
    assert_eq!(version, embree::RTC_VERSION as _);
}
