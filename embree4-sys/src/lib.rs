#![doc = include_str!("../README.md")]
#![allow(non_camel_case_types, non_snake_case, non_upper_case_globals)]
#![allow(clippy::all)]

include!(concat!(env!("OUT_DIR"), "/bindings.rs"));

// bindgen asserts every size and offset against what the C compiler says. What follows is what the
// library's manual promises besides, and what callers rely on.
const _: () = {
    assert!(RTC_VERSION_MAJOR == 4);
    assert!(align_of::<RTCRay>() == 16);
    assert!(align_of::<RTCHit>() == 16);
    assert!(align_of::<RTCRayHit>() == 16);
    assert!(size_of::<RTCRay>() == 48);
    assert!(size_of::<RTCRayHit>() == size_of::<RTCRay>() + size_of::<RTCHit>());
};
