//! What happens at a point: Snell and Fresnel, rough and smooth boundaries, scattering distributions.
//!
//! One local frame throughout: +z is the normal on the *outside* of the surface; `wo` and `wi` are
//! unit vectors that point away from the surface; `eta` = n_inside / n_outside. Paths are traced from
//! the camera, so `wo` leads back to the camera and `wi` to where the light comes from.

pub mod albedo;
pub mod boundary;
pub mod bsdf;
pub mod dielectric;
pub mod fresnel;
pub mod interface;
pub mod metal;
pub mod metallic_roughness;
pub mod microfacet;
pub mod phase;
pub mod plastic;

pub use boundary::{Boundary, ReflectionSample};
pub use bsdf::{Bsdf, BsdfSample};
pub use dielectric::{Dielectric, ThinDielectric};
pub use fresnel::{Fresnel, fresnel_conductor_schlick, fresnel_dielectric, fresnel_moment, refract};
pub use interface::Interface;
pub use metal::Metal;
pub use metallic_roughness::MetallicRoughness;
pub use microfacet::{Ggx, is_smooth};
pub use plastic::Plastic;
