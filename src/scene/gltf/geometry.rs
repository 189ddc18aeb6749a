//! Primitives to triangle meshes (glTF 2.0, section 3.7.2).

use std::collections::HashMap;

use ::gltf::json;
use ::gltf::json::mesh::{Mode, Semantic};
use ::gltf::json::validation::Checked;
use glam::{DVec3, Vec2, Vec3, Vec4};

use super::Reader;
use super::accessor::Usage;
use super::tangents::add_tangents;
use crate::scene::{Mesh, SceneError};

/// Accessors of the vertex attributes that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Attributes {
    position: usize,
    normal: Option<usize>,
    tangent: Option<usize>,
    texture_coordinates: [Option<usize>; 2],
    color: Option<usize>,
}

impl Attributes {
    /// `None` if there are no positions.
    fn of(primitive: &json::mesh::Primitive) -> Option<Self> {
        let find =
            |semantic: Semantic| primitive.attributes.get(&Checked::Valid(semantic)).map(json::Index::value);
        Some(Self {
            position: find(Semantic::Positions)?,
            normal: find(Semantic::Normals),
            // Tangents mean nothing without normals.
            tangent: find(Semantic::Normals).and_then(|_| find(Semantic::Tangents)),
            texture_coordinates: [find(Semantic::TexCoords(0)), find(Semantic::TexCoords(1))],
            color: find(Semantic::Colors(0)),
        })
    }

    /// Which attributes there are; vertices can only be joined where these agree.
    fn presence(&self) -> [bool; 5] {
        let [set0, set1] = self.texture_coordinates;
        [self.normal, self.tangent, set0, set1, self.color].map(|a| a.is_some())
    }
}

/// A mesh that grows by primitives of one material and one set of attributes.
struct Part {
    material: Option<usize>,
    mesh: Mesh,
    /// First vertex of attributes already appended: primitives often share them.
    bases: HashMap<Attributes, (u32, usize)>,
}

impl Reader<'_> {
    /// Reads glTF mesh `index`, which `place` refers to, into one scene mesh for each of its
    /// materials; afterwards `self.meshes` holds their (mesh, material) pairs.
    pub(super) fn read_mesh(&mut self, index: usize, place: &str) -> Result<(), SceneError> {
        if self.meshes.contains_key(&index) {
            return Ok(());
        }
        let source = self.document.get(&self.document.meshes, "mesh", index, place)?;
        let name = source.name.clone().unwrap_or_else(|| format!("mesh {index}"));
        let mut parts: Vec<Part> = Vec::new();
        let mut places: HashMap<(Option<usize>, [bool; 5]), usize> = HashMap::new();
        for (number, primitive) in source.primitives.iter().enumerate() {
            let place = format!("/meshes/{index}/primitives/{number}");
            let Some(attributes) = self.drawable(primitive, &place) else { continue };
            let material = primitive.material.map(|m| m.value());
            let key = (material, attributes.presence());
            let part = *places.entry(key).or_insert_with(|| {
                let mesh = Mesh { name: name.clone(), ..Mesh::default() };
                parts.push(Part { material, mesh, bases: HashMap::new() });
                parts.len() - 1
            });
            self.append(&mut parts[part], primitive, attributes, &place)?;
        }
        let mut finished = Vec::with_capacity(parts.len());
        for mut part in parts {
            self.clean(&mut part.mesh, &format!("/meshes/{index}"));
            if part.mesh.triangles.is_empty() {
                continue;
            }
            let material = self.material(part.material, &format!("/meshes/{index}"))?;
            if let (Some((texture, _)), true) =
                (self.scene.materials[material].normal_map, part.mesh.tangents.is_empty())
            {
                add_tangents(&mut part.mesh, self.scene.textures[texture].coordinate_set);
            }
            finished.push((self.scene.meshes.len(), material));
            self.scene.meshes.push(part.mesh);
        }
        self.meshes.insert(index, finished);
        Ok(())
    }

    /// The attributes of a primitive with triangles; anything else is warned of and left out.
    fn drawable(&mut self, primitive: &json::mesh::Primitive, place: &str) -> Option<Attributes> {
        if primitive.targets.as_ref().is_some_and(|targets| !targets.is_empty()) {
            self.warnings.add("morph targets are ignored: the mesh is shown at rest", place);
        }
        if !matches!(
            primitive.mode,
            Checked::Valid(Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)
        ) {
            self.warnings.add("points and lines are not rendered", place);
            return None;
        }
        let attributes = Attributes::of(primitive);
        if attributes.is_none() {
            self.warnings.add("a primitive without POSITION is not rendered", place);
        }
        attributes
    }

    fn append(
        &self,
        part: &mut Part,
        primitive: &json::mesh::Primitive,
        attributes: Attributes,
        place: &str,
    ) -> Result<(), SceneError> {
        let (base, count) = match part.bases.get(&attributes) {
            Some(&known) => known,
            None => {
                let base = part.mesh.positions.len() as u32;
                let count = self.append_vertices(&mut part.mesh, &attributes, place)?;
                part.bases.insert(attributes, (base, count));
                (base, count)
            }
        };
        let indices = match primitive.indices {
            Some(accessor) => self.document.indices(accessor.value(), &format!("{place}/indices"))?,
            None => {
                self.document.charge_elements(count, place)?;
                (0..count as u32).collect()
            }
        };
        if let Some(position) = indices.iter().position(|&i| i as usize >= count) {
            return Err(self.document.error(
                format!("{place}/indices"),
                format!(
                    "index {} (the {position}th) is out of range: the primitive has {count} vertices; mend the geometry and export it again",
                    indices[position]
                ),
            ));
        }
        let triangles = assemble(&indices, primitive.mode);
        part.mesh.triangles.extend(triangles.map(|corners| corners.map(|i| i + base)));
        Ok(())
    }

    /// Appends the vertices and returns how many there are.
    fn append_vertices(
        &self,
        mesh: &mut Mesh,
        attributes: &Attributes,
        place: &str,
    ) -> Result<usize, SceneError> {
        let at = |name: &str| format!("{place}/attributes/{name}");
        let positions = self.document.vectors::<3>(attributes.position, Usage::Position, &at("POSITION"))?;
        let count = positions.len();
        let check = |length: usize, name: &str| {
            if length == count {
                return Ok(());
            }
            Err(self.document.error(
                at(name),
                format!("{length} elements, but POSITION has {count}; all attributes need the same count"),
            ))
        };
        mesh.positions.extend(positions.into_iter().map(Vec3::from));
        if let Some(accessor) = attributes.normal {
            let normals = self.document.vectors::<3>(accessor, Usage::Normal, &at("NORMAL"))?;
            check(normals.len(), "NORMAL")?;
            mesh.normals.extend(normals.into_iter().map(|n| unit_or_zero(Vec3::from(n))));
        }
        if let Some(accessor) = attributes.tangent {
            let tangents = self.document.vectors::<4>(accessor, Usage::Tangent, &at("TANGENT"))?;
            check(tangents.len(), "TANGENT")?;
            let unit = |[x, y, z, w]: [f32; 4]| {
                unit_or_zero(Vec3::new(x, y, z)).extend(if w < 0.0 { -1.0 } else { 1.0 })
            };
            mesh.tangents.extend(tangents.into_iter().map(unit));
        }
        for (set, name) in ["TEXCOORD_0", "TEXCOORD_1"].into_iter().enumerate() {
            if let Some(accessor) = attributes.texture_coordinates[set] {
                let coordinates =
                    self.document.vectors::<2>(accessor, Usage::TextureCoordinate, &at(name))?;
                check(coordinates.len(), name)?;
                mesh.texture_coordinates[set].extend(coordinates.into_iter().map(Vec2::from));
            }
        }
        if let Some(accessor) = attributes.color {
            let colors = self.colors(accessor, &at("COLOR_0"))?;
            check(colors.len(), "COLOR_0")?;
            mesh.colors.extend(colors);
        }
        if u32::try_from(mesh.positions.len()).is_err() {
            return Err(self.document.error(place, "a mesh of 2³² vertices or more; split it"));
        }
        Ok(count)
    }

    /// Vertex colours are linear; without alpha it is 1.
    fn colors(&self, accessor: usize, place: &str) -> Result<Vec<Vec4>, SceneError> {
        let zero_to_one = |color: Vec4| color.clamp(Vec4::ZERO, Vec4::ONE);
        if self.document.components(accessor, place)? == 3 {
            let colors = self.document.vectors::<3>(accessor, Usage::Color, place)?;
            Ok(colors.into_iter().map(|c| zero_to_one(Vec3::from(c).extend(1.0))).collect())
        } else {
            let colors = self.document.vectors::<4>(accessor, Usage::Color, place)?;
            Ok(colors.into_iter().map(|c| zero_to_one(Vec4::from(c))).collect())
        }
    }

    /// Drops triangles without area and gives vertices without a normal one.
    fn clean(&mut self, mesh: &mut Mesh, place: &str) {
        let before = mesh.triangles.len();
        let positions = &mesh.positions;
        mesh.triangles.retain(|corners| area_vector(positions, corners) != DVec3::ZERO);
        for _ in mesh.triangles.len()..before {
            self.warnings.add("a triangle without area is left out", place);
        }
        if mesh.normals.contains(&Vec3::ZERO) {
            self.warnings.add("normals of length 0 are replaced by those of the triangles around", place);
            repair_normals(mesh);
        }
        if mesh.tangents.iter().any(|tangent| tangent.truncate() == Vec3::ZERO) {
            self.warnings.add("tangents of length 0 are replaced by any direction in the surface", place);
            for (tangent, normal) in mesh.tangents.iter_mut().zip(&mesh.normals) {
                if tangent.truncate() == Vec3::ZERO {
                    *tangent = normal.any_orthonormal_vector().extend(tangent.w);
                }
            }
        }
    }
}

/// Triangles from vertex indices (section 3.7.2.1); left-over indices make none.
fn assemble(indices: &[u32], mode: Checked<Mode>) -> impl Iterator<Item = [u32; 3]> + '_ {
    let count = match mode {
        Checked::Valid(Mode::Triangles) => indices.len() / 3,
        _ => indices.len().saturating_sub(2),
    };
    (0..count).map(move |i| {
        let corners = match mode {
            Checked::Valid(Mode::TriangleStrip) => [i, i + 1 + i % 2, i + 2 - i % 2],
            Checked::Valid(Mode::TriangleFan) => [i + 1, i + 2, 0],
            _ => [3 * i, 3 * i + 1, 3 * i + 2],
        };
        corners.map(|corner| indices[corner])
    })
}

/// Twice the area along the normal, in double precision: its products of differences of
/// single-precision numbers neither underflow nor, up to the largest allowed coordinate, overflow.
fn area_vector(positions: &[Vec3], corners: &[u32; 3]) -> DVec3 {
    let [a, b, c] = corners.map(|i| positions[i as usize].as_dvec3());
    (b - a).cross(c - a)
}

fn unit_or_zero(vector: Vec3) -> Vec3 {
    vector.as_dvec3().normalize_or_zero().as_vec3()
}

/// Replaces zero normals by the area-weighted mean of the triangles around.
fn repair_normals(mesh: &mut Mesh) {
    let mut sums = vec![DVec3::ZERO; mesh.positions.len()];
    for corners in &mesh.triangles {
        let area = area_vector(&mesh.positions, corners);
        for &corner in corners {
            sums[corner as usize] += area;
        }
    }
    for (normal, sum) in mesh.normals.iter_mut().zip(sums) {
        if *normal == Vec3::ZERO {
            *normal = sum.normalize_or(DVec3::Z).as_vec3();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangles(indices: &[u32], mode: Mode) -> Vec<[u32; 3]> {
        assemble(indices, Checked::Valid(mode)).collect()
    }

    #[test]
    fn strips_and_fans_keep_the_winding() {
        assert_eq!(triangles(&[0, 1, 2, 3, 4], Mode::Triangles), [[0, 1, 2]]);
        assert_eq!(triangles(&[0, 1, 2, 3, 4], Mode::TriangleStrip), [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        assert_eq!(triangles(&[9, 1, 2, 3], Mode::TriangleFan), [[1, 2, 9], [2, 3, 9]]);
        assert!(triangles(&[0, 1], Mode::TriangleFan).is_empty());
        assert!(triangles(&[], Mode::TriangleStrip).is_empty());
    }

    #[test]
    fn area_is_zero_only_where_it_is() {
        let tiny = 1e-30;
        let positions = [
            Vec3::ZERO,
            Vec3::new(tiny, 0.0, 0.0),
            Vec3::new(0.0, tiny, 0.0),
            Vec3::new(2.0 * tiny, 0.0, 0.0),
        ];
        assert!(area_vector(&positions, &[0, 1, 2]).z > 0.0);
        assert_eq!(area_vector(&positions, &[0, 1, 3]), DVec3::ZERO);
        assert_eq!(area_vector(&positions, &[1, 1, 2]), DVec3::ZERO);
    }

    #[test]
    fn a_missing_normal_is_that_of_the_triangles_around() {
        let mut mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            normals: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        repair_normals(&mut mesh);
        assert_eq!(mesh.normals, [Vec3::Z, Vec3::X, Vec3::Y]);
    }
}
