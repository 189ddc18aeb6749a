//! Mathematics without physics: frames, warps, robust floating point, discrete and tabulated
//! distributions, the seeded low-discrepancy sample stream.

pub mod distance_transform;
pub mod distribution;
pub mod frame;
pub mod monotone_cubic;
pub mod quadrature;
pub mod robust;
pub mod sampler;
pub mod warp;

pub use frame::Frame;
pub use sampler::SampleStream;
