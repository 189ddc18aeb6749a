//! Ray queries: closest hit, occlusion, and every hit on a segment; and the distance of a point from a body.
//!
//! Backends stand behind [`RayCaster`]. Geometry is triangles only ([`Geometry`]); shapes are
//! triangulated when the scene is read, so every backend sees the same triangles.

pub mod bvh;
#[cfg(feature = "embree")]
pub mod embree;
mod nearest;
pub mod obvhs;
mod watertight;

use glam::{Affine3A, DAffine3, Vec3};
use thiserror::Error;

/// A ray or, with finite `t_max`, a segment: points `origin + t·direction` with t in (0, `t_max`].
/// `direction` need not have unit length; t counts in its lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Start; already moved off the surface it left (see [`crate::math::robust::offset_from_surface`]).
    pub origin: Vec3,
    /// Direction, not zero.
    pub direction: Vec3,
    /// End of the segment; infinite for a ray.
    pub t_max: f32,
}

impl Ray {
    /// The ray without end.
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction, t_max: f32::INFINITY }
    }

    /// The segment from `origin` towards `target`, stopping short of it by one part in 10⁴ (the
    /// point at `target` is known only to rounding, so the last stretch cannot be asked for).
    pub fn segment(origin: Vec3, target: Vec3) -> Self {
        Self { origin, direction: target - origin, t_max: 1.0 - 1e-4 }
    }

    /// The point at parameter `t`.
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }

    /// The ray seen through `map`. Its parameter keeps its meaning, because the direction is not normalized
    /// again. Computed in double precision: single would add its own rounding of the translation, which for
    /// an object far from the origin is larger than that of the intersection.
    pub fn transformed(&self, map: &DAffine3) -> Self {
        Self {
            origin: map.transform_point3(self.origin.as_dvec3()).as_vec3(),
            direction: map.transform_vector3(self.direction.as_dvec3()).as_vec3(),
            t_max: self.t_max,
        }
    }
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Ray parameter.
    pub t: f32,
    /// Barycentric coordinate of the triangle's second vertex.
    pub u: f32,
    /// Barycentric coordinate of the triangle's third vertex.
    pub v: f32,
    /// Index into [`Geometry::instances`].
    pub instance: u32,
    /// Index of the triangle in its mesh.
    pub primitive: u32,
}

/// What [`RayCaster::distance_to_nearest`] is asked. How exact the answer is to be decides about the work: seen from the
/// middle of a body, much of its surface is about equally far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DistanceQuery {
    /// The point, in the world.
    pub point: Vec3,
    /// Triangles farther than this do not matter; may be infinite.
    pub limit: f32,
    /// If a triangle is nearer than this, it does not matter how near.
    pub least: f32,
    /// By which share of itself the answer may be too small, in [0, 1].
    pub tolerance: f32,
}

impl DistanceQuery {
    /// The distance from `point`, to rounding.
    pub fn exact(point: Vec3) -> Self {
        Self { point, limit: f32::INFINITY, least: 0.0, tolerance: 0.0 }
    }
}

/// Triangles in their own space.
#[derive(Clone, Copy, Debug)]
pub struct TriangleMesh<'a> {
    /// Vertex positions.
    pub positions: &'a [Vec3],
    /// Vertex indices of each triangle, all within `positions`.
    pub triangles: &'a [[u32; 3]],
}

/// A mesh placed in the world.
#[derive(Clone, Copy, Debug)]
pub struct MeshInstance {
    /// Index into [`Geometry::meshes`].
    pub mesh: usize,
    /// Object to world; any invertible affine map, mirrored ones included.
    pub transform: Affine3A,
    /// True if [`RayCaster::all_hits`] or [`RayCaster::distance_to_nearest`] will be asked about this instance.
    pub probed: bool,
}

/// What a backend is built from.
#[derive(Clone, Copy, Debug)]
pub struct Geometry<'a> {
    /// The meshes.
    pub meshes: &'a [TriangleMesh<'a>],
    /// Their placements; may be empty.
    pub instances: &'a [MeshInstance],
}

impl Geometry<'_> {
    /// Checks that every index is in range and every count fits into an index, and that there is memory for a hierarchy: what a backend
    /// relies on and cannot find out later.
    ///
    /// # Errors
    /// [`RaycastError::VertexIndex`], [`RaycastError::MeshIndex`], [`RaycastError::TooLarge`] or [`RaycastError::Memory`].
    pub fn validate(&self) -> Result<(), RaycastError> {
        for (mesh, data) in self.meshes.iter().enumerate() {
            let limit = u32::MAX as usize;
            for (what, count) in [("vertices", data.positions.len()), ("triangles", data.triangles.len())] {
                if count > limit {
                    return Err(RaycastError::TooLarge { mesh, what, count, limit });
                }
            }
            let outside = |triangle: &[u32; 3]| triangle.iter().any(|&i| i as usize >= data.positions.len());
            if let Some(triangle) = data.triangles.iter().position(outside) {
                return Err(RaycastError::VertexIndex { mesh, triangle });
            }
        }
        if let Some(instance) = self.instances.iter().position(|placed| placed.mesh >= self.meshes.len()) {
            return Err(RaycastError::MeshIndex { instance });
        }
        let triangles: usize = self.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
        ensure_memory(triangles.saturating_mul(BYTES_PER_TRIANGLE))
    }
}

/// Bytes that backends take for each triangle while they build, the thriftiest of them at least.
const BYTES_PER_TRIANGLE: usize = 144;

/// Asks for so many bytes and gives them back: where an allocation in the middle of a build fails, the program could only abort.
fn ensure_memory(bytes: usize) -> Result<(), RaycastError> {
    let mut room: Vec<u8> = Vec::new();
    let found = room.try_reserve_exact(bytes);
    // Or else the compiler leaves out the allocation, as nothing is put there.
    std::hint::black_box(&mut room);
    found.map_err(|_| RaycastError::Memory { bytes })
}

/// Why a backend could not be built.
#[derive(Debug, Error)]
pub enum RaycastError {
    /// The ray tracing library reported an error.
    #[error("{library}: {message}")]
    Library {
        /// Name of the library.
        library: &'static str,
        /// Its message.
        message: String,
    },
    /// The installed library is not the one the program was built for.
    #[error(
        "Embree {loaded} is installed, but this program was built for Embree {built}; rebuild it (cargo clean -p embree4-sys && cargo build --release)"
    )]
    Version {
        /// Version of the headers at build time.
        built: String,
        /// Version of the loaded library.
        loaded: String,
    },
    /// A triangle names a vertex that does not exist.
    #[error("mesh {mesh}: triangle {triangle} has a vertex index out of range")]
    VertexIndex {
        /// Index of the mesh.
        mesh: usize,
        /// Index of the triangle in the mesh.
        triangle: usize,
    },
    /// An instance names a mesh that does not exist.
    #[error("instance {instance} places a mesh that does not exist")]
    MeshIndex {
        /// Index of the instance.
        instance: usize,
    },
    /// The memory is not there.
    #[error(
        "not enough memory for the hierarchy over the triangles ({bytes} bytes); use fewer triangles, or more memory"
    )]
    Memory {
        /// What is needed.
        bytes: usize,
    },
    /// A hierarchy cannot be built.
    #[error("the hierarchy over the triangles cannot be built: {message}")]
    Hierarchy {
        /// Why.
        message: String,
    },
    /// More triangles or vertices than the index type holds.
    #[error("mesh {mesh} has {count} {what}; the limit is {limit}")]
    TooLarge {
        /// Index of the mesh.
        mesh: usize,
        /// "vertices" or "triangles".
        what: &'static str,
        /// How many it has.
        count: usize,
        /// How many are possible.
        limit: usize,
    },
}

/// The ray casting backends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Backend {
    /// Intel Embree 4 (`embree::EmbreeCaster`, with the crate feature `embree`).
    Embree,
    /// The pure-Rust hierarchy ([`bvh::BvhCaster`]), in every build.
    Bvh,
    /// That of the crate `obvhs` as it comes ([`obvhs::ObvhsCaster`]), for comparison.
    Obvhs,
}

impl Backend {
    /// Names on the command line and in reports.
    pub const NAMES: [(&'static str, Self); 3] =
        [("embree", Self::Embree), ("bvh", Self::Bvh), ("obvhs", Self::Obvhs)];

    /// The backends of this build, the fastest first.
    pub const fn available() -> &'static [Self] {
        if cfg!(feature = "embree") {
            &[Self::Embree, Self::Bvh, Self::Obvhs]
        } else {
            &[Self::Bvh, Self::Obvhs]
        }
    }

    /// The name on the command line and in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Embree => "embree",
            Self::Bvh => "bvh",
            Self::Obvhs => "obvhs",
        }
    }
}

impl Default for Backend {
    /// The fastest one of this build.
    fn default() -> Self {
        Self::available()[0]
    }
}

/// Answers ray queries about a fixed scene, from any thread, without allocation.
pub trait RayCaster: Send + Sync {
    /// The nearest hit with t in (0, `t_max`].
    fn closest(&self, ray: &Ray) -> Option<Hit>;

    /// True if anything lies on the ray within (0, `t_max`].
    fn occluded(&self, ray: &Ray) -> bool;

    /// Replaces the content of `hits` by every crossing of the segment with the triangles of one
    /// instance, each once, in no particular order. `ray.t_max` must be finite; the instance must
    /// have been marked [`MeshInstance::probed`]. A crossing through an edge shared by two
    /// triangles may be reported once for each of them.
    fn all_hits(&self, ray: &Ray, instance: u32, hits: &mut Vec<Hit>);
    /// A lower bound of the distance from a point to the triangles of one instance, in world units: the limit if none is
    /// nearer than that, 0 if one is nearer than [`DistanceQuery::least`]. Otherwise it is below the exact distance by no more
    /// than the share [`DistanceQuery::tolerance`] of it, 4 roundings, and half a rounding (2⁻²⁴) of the distance to the
    /// farthest corner of the triangle found. It is never above the exact distance to the triangles as the backend holds
    /// them: a sphere of this radius around the point does not touch them. 0 if a coordinate of the point is not finite. The instance
    /// must have been marked [`MeshInstance::probed`].
    fn distance_to_nearest(&self, query: &DistanceQuery, instance: u32) -> f32;
}
