//! Materials resolved at a point: textures looked up, normals oriented.

use glam::{Vec3, Vec4Swizzles};

use super::basis::Basis;
use super::light_choice::Receiver;
use super::spectra::Part;
use super::world::SurfacePoint;
use crate::math::sampler::HashGenerator;
use crate::optics::{Bsdf, BsdfSample, Dielectric, Interface, Metal, MetallicRoughness};
use crate::plan::Abilities;
use crate::radiometry::{Rgb, Spectrum};
use crate::scene::material::Coverage;
use crate::scene::{ColorInput, ScalarInput, Scene, Surface};

/// The normals of a point, turned to the side that counts as outside.
#[derive(Clone, Copy, Debug)]
pub struct Orientation {
    /// Unit normal of the triangle.
    pub geometric: Vec3,
    /// Unit shading normal, on the side of the geometric one.
    pub shading: Vec3,
    /// The outside is where the triangle's winding says inside.
    pub flipped: bool,
}

impl Orientation {
    /// For light that leaves along `wo`. If `toward_viewer`, the side of `wo` is the outside; else the
    /// winding decides.
    pub fn new<const CAN: u32>(
        scene: &Scene,
        material: usize,
        surface: &SurfacePoint,
        wo: Vec3,
        toward_viewer: bool,
    ) -> Self {
        let flipped = toward_viewer && wo.dot(surface.geometric_normal) < 0.0;
        let mut orientation = Self::on_side::<CAN>(scene, material, surface, flipped);
        if !orientation.agree(wo) {
            // Seen from a side that only the interpolated normal calls the back.
            orientation.shading = orientation.geometric;
        }
        orientation
    }

    /// With the outside as the winding says, or the other side if `flipped`.
    pub fn on_side<const CAN: u32>(
        scene: &Scene,
        material: usize,
        surface: &SurfacePoint,
        flipped: bool,
    ) -> Self {
        let sign = if flipped { -1.0 } else { 1.0 };
        let shading = if const { Abilities::TEXTURES.are_in(CAN) } {
            mapped_normal(scene, material, surface)
        } else {
            surface.shading_normal
        };
        Self { geometric: surface.geometric_normal * sign, shading: shading * sign, flipped }
    }

    /// The outside of `surface` as a receiver of light.
    pub fn receiver(&self, surface: &SurfacePoint) -> Receiver {
        Receiver { position: surface.position, normal: Some(self.geometric) }
    }

    /// True if both normals see `direction` on the same side.
    pub fn agree(&self, direction: Vec3) -> bool {
        direction.dot(self.geometric) * direction.dot(self.shading) > 0.0
    }

    /// `direction` mirrored by the plane of the triangle.
    pub fn mirrored(&self, direction: Vec3) -> Vec3 {
        direction - self.geometric * (2.0 * direction.dot(self.geometric))
    }

    /// True if the lobe's value in `direction` is not all that comes to its side there (see
    /// [`Self::unfolded`]).
    pub fn folds(&self, direction: Vec3) -> bool {
        !self.agree(direction) || self.unfolded(direction).count() != 1
    }

    /// The directions of a lobe around the shading normal that go to `direction` when all that lies on
    /// the wrong side of the triangle is mirrored by its plane: the direction itself, its mirror image,
    /// both or none. So a lobe keeps its integral, and no light is lost between the two normals.
    pub fn unfolded(&self, direction: Vec3) -> impl Iterator<Item = Vec3> {
        let side = direction.dot(self.geometric);
        let candidates = [direction, self.mirrored(direction)].into_iter();
        candidates.filter(move |candidate| candidate.dot(self.shading) * side > 0.0)
    }
}

/// The shading normal with the material's normal map applied, on the side of the geometric normal.
fn mapped_normal(scene: &Scene, material: usize, surface: &SurfacePoint) -> Vec3 {
    let Some((texture, scale)) = scene.materials[material].normal_map else { return surface.shading_normal };
    let normal = surface.shading_normal;
    let tangent = surface.tangent.xyz();
    let tangent = (tangent - normal * normal.dot(tangent)).normalize_or_zero();
    if tangent == Vec3::ZERO {
        return normal;
    }
    let bitangent = normal.cross(tangent) * surface.tangent.w;
    let texel = scene.texture(texture, surface.texture_coordinates);
    let [x, y, z] = [0, 1, 2].map(|c| 2.0 * texel[c] - 1.0);
    let mapped = (tangent * (x * scale) + bitangent * (y * scale) + normal * z).normalize_or(normal);
    if mapped.dot(surface.geometric_normal) > 0.0 { mapped } else { normal }
}

/// The value of a colour at a point.
pub fn color<const CAN: u32>(scene: &Scene, input: &ColorInput, surface: &SurfacePoint) -> Rgb {
    if const { Abilities::TEXTURES.are_in(CAN) } {
        scene.color(input, surface.texture_coordinates, surface.color)
    } else {
        input.factor
    }
}

/// The value of a number at a point.
fn scalar<const CAN: u32>(scene: &Scene, input: &ScalarInput, surface: &SurfacePoint) -> f32 {
    if const { Abilities::TEXTURES.are_in(CAN) } {
        scene.scalar(input, surface.texture_coordinates, surface.color)
    } else {
        input.factor
    }
}

/// True if the surface is there, decided by `u` where it is there in part.
pub fn is_covered<const CAN: u32>(scene: &Scene, material: usize, surface: &SurfacePoint, u: f32) -> bool {
    let alpha = |input| scalar::<CAN>(scene, input, surface);
    match &scene.materials[material].coverage {
        Coverage::Full => true,
        Coverage::Mask { alpha: input, cutoff } => alpha(input) >= *cutoff,
        Coverage::Blend { alpha: input } => u < alpha(input),
    }
}

/// Radiance that the light `index` of the scene sends from `surface` against `direction`.
pub fn emitted<B: Basis<N>, const N: usize>(
    basis: &B,
    scene: &Scene,
    index: usize,
    surface: &SurfacePoint,
    direction: Vec3,
) -> Spectrum<N> {
    let light = &scene.lights[index];
    match light.has_size() && direction.dot(surface.geometric_normal) < 0.0 {
        true => basis.light(index, light),
        false => Spectrum::ZERO,
    }
}

/// What scatters light at a point of a surface.
pub enum Lobes<'a, const N: usize = 3> {
    /// Light is scattered as the material says.
    Bsdf(Bsdf<N>),
    /// The boundary of a body that paths walk in.
    Interface(&'a Interface),
}

impl<const N: usize> Lobes<'_, N> {
    /// f·|cos_i|, 1/sr, in the local frame; delta lobes are left out.
    pub fn evaluate(&self, wo: Vec3, wi: Vec3) -> Spectrum<N> {
        match self {
            Self::Bsdf(bsdf) => bsdf.evaluate(wo, wi),
            Self::Interface(interface) => Spectrum::splat(interface.evaluate(wo, wi)),
        }
    }

    /// Density of [`Self::sample`] per solid angle; delta lobes are left out.
    pub fn density(&self, wo: Vec3, wi: Vec3) -> f32 {
        match self {
            Self::Bsdf(bsdf) => bsdf.density(wo, wi),
            Self::Interface(interface) => interface.density(wo, wi),
        }
    }

    /// Draws where the light that leaves along `wo` comes from, with `u`, or `random` where more numbers may be needed.
    pub fn sample(&self, wo: Vec3, u: [f32; 3], random: &mut HashGenerator) -> Option<BsdfSample<N>> {
        match self {
            Self::Bsdf(bsdf) => bsdf.sample(wo, u),
            Self::Interface(interface) => interface.sample(wo, || random.next_f32()),
        }
    }

    /// True if every lobe is a delta lobe.
    pub fn is_delta_only(&self) -> bool {
        match self {
            Self::Bsdf(bsdf) => bsdf.is_delta_only(),
            Self::Interface(interface) => interface.is_smooth(),
        }
    }

    /// True if all that light meets is a smooth boundary between two clear media.
    pub fn is_smooth_dielectric(&self) -> bool {
        matches!(self, Self::Bsdf(Bsdf::Dielectric(dielectric)) if dielectric.is_smooth())
    }

    /// True if light can come from the other side of the surface.
    pub fn transmits(&self) -> bool {
        match self {
            Self::Bsdf(bsdf) => bsdf.transmits(),
            Self::Interface(_) => true,
        }
    }
}

/// The BSDF at a point of a body surrounded by index `ior_around`.
pub fn resolve_bsdf<B: Basis<N>, const N: usize, const CAN: u32>(
    basis: &B,
    scene: &Scene,
    material: usize,
    surface: &SurfacePoint,
    ior_around: f32,
) -> Bsdf<N> {
    let share = |input| scalar::<CAN>(scene, input, surface).clamp(0.0, 1.0);
    let part = |part, input| {
        let rgb = color::<CAN>(scene, input, surface).map(|x: f32| x.clamp(0.0, 1.0));
        basis.share(material, part, input, rgb)
    };
    let reflectance = |input| part(Part::Surface, input);
    let eta = |ior| basis.ior(material, ior, 0) / ior_around;
    match &scene.materials[material].surface {
        Surface::Diffuse { reflectance: input } => Bsdf::Diffuse { reflectance: reflectance(input) },
        Surface::Metal { reflectance: input, roughness } => {
            Bsdf::Metal(Metal { reflectance_normal: reflectance(input), alpha: share(roughness).powi(2) })
        }
        Surface::Dielectric { ior, roughness, tint, .. } => Bsdf::Dielectric(Dielectric {
            eta: eta(*ior),
            alpha: share(roughness).powi(2),
            tint: reflectance(tint),
        }),
        Surface::MetallicRoughness(m) => Bsdf::MetallicRoughness(MetallicRoughness {
            base_color: reflectance(&m.base_color),
            metallic: share(&m.metallic),
            alpha: share(&m.roughness).powi(2),
            eta: eta(m.ior),
            transmission: share(&m.transmission),
            diffuse_transmission: share(&m.diffuse_transmission),
            diffuse_transmission_color: part(Part::DiffuseTransmission, &m.diffuse_transmission_color),
            thin: m.thin,
        }),
        // Smooth, of a body that paths walk in: rough ones have their `Interface`, and the area integral its boundary.
        Surface::Translucent { ior, roughness, .. } => Bsdf::Dielectric(Dielectric {
            eta: ior / ior_around,
            alpha: roughness * roughness,
            tint: Spectrum::ONE,
        }),
    }
}
