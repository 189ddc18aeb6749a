//! Triangle meshes and their placements.

use glam::{Affine3A, Vec2, Vec3, Vec4};

/// Triangles in their own space. Attribute arrays are empty or as long as `positions`.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Name for people.
    pub name: String,
    /// Vertex positions.
    pub positions: Vec<Vec3>,
    /// Unit vertex normals; empty: flat shading.
    pub normals: Vec<Vec3>,
    /// Unit vertex tangents, w = ±1 the handedness of the bitangent w·(n×t); empty: none.
    pub tangents: Vec<Vec4>,
    /// Texture coordinate sets 0 and 1; v grows downwards as in glTF.
    pub texture_coordinates: [Vec<Vec2>; 2],
    /// Linear vertex colours RGBA, factors on base colour and alpha; empty: white.
    pub colors: Vec<Vec4>,
    /// Vertex indices of each triangle, counter-clockwise seen from outside; all in range.
    pub triangles: Vec<[u32; 3]>,
}

/// A mesh placed in the world with a material.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Name for people.
    pub name: String,
    /// Index into the scene's meshes.
    pub mesh: usize,
    /// Index into the scene's materials.
    pub material: usize,
    /// Object to world, invertible.
    pub transform: Affine3A,
}
