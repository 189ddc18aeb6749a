//! The node hierarchy to placed instances, lights and the camera (glTF 2.0, section 3.5).

use ::gltf::json;
use glam::{DAffine3, DMat4, DQuat, DVec3, DVec4};
use serde_json::{Map, Value};

use super::Reader;
use super::accessor::{MAX_MAGNITUDE, Usage};
use super::extensions::{MeshInstancing, NodeLight};
use crate::scene::{Instance, SceneError};

/// Most instances in all: instancing multiplies with the materials of a mesh.
const MAX_INSTANCES: usize = 1 << 24;

impl Reader<'_> {
    /// Walks the nodes of the scene, parents before children, in the order of the file.
    ///
    /// A stack of our own and a mark on each node keep deep chains and cycles harmless.
    pub(super) fn read_nodes(&mut self) -> Result<(), SceneError> {
        let mut pending: Vec<(usize, DAffine3, String)> = Vec::new();
        for (root, place) in self.roots()?.into_iter().rev() {
            pending.push((root, DAffine3::IDENTITY, place));
        }
        let mut visited = vec![false; self.document.nodes.len()];
        while let Some((index, parent, place)) = pending.pop() {
            let node = self.document.get(&self.document.nodes, "node", index, &place)?;
            if std::mem::replace(&mut visited[index], true) {
                return Err(self.document.error(
                    place,
                    format!("node {index} is reached twice: it is in a cycle or has two parents; give every node one parent"),
                ));
            }
            let place = format!("/nodes/{index}");
            let transform = parent * self.local_transform(node, &place)?;
            self.read_node(index, node, transform, &place)?;
            for (number, child) in node.children.as_deref().unwrap_or_default().iter().enumerate().rev() {
                pending.push((child.value(), transform, format!("{place}/children/{number}")));
            }
        }
        Ok(())
    }

    /// The root nodes of the scene, each with the place that names it.
    fn roots(&mut self) -> Result<Vec<(usize, String)>, SceneError> {
        let document = self.document;
        if document.scenes.is_empty() && document.default_scene.is_none() {
            self.warnings.add("the file has no scene: all nodes without a parent are shown", "/scenes");
            let mut is_child = vec![false; document.nodes.len()];
            for child in document.nodes.iter().flat_map(|node| node.children.iter().flatten()) {
                if let Some(mark) = is_child.get_mut(child.value()) {
                    *mark = true;
                }
            }
            let roots = (0..document.nodes.len()).filter(|&node| !is_child[node]);
            return Ok(roots.map(|node| (node, format!("/nodes/{node}"))).collect());
        }
        let index = document.default_scene.unwrap_or(0);
        let scene = document.get(&document.scenes, "scene", index, "/scene")?;
        if document.scenes.len() > 1 {
            self.warnings
                .add(format!("of {} scenes, scene {index} is shown", document.scenes.len()), "/scenes");
        }
        let place = |(number, &node): (usize, &usize)| (node, format!("/scenes/{index}/nodes/{number}"));
        Ok(scene.nodes.iter().enumerate().map(place).collect())
    }

    fn read_node(
        &mut self,
        index: usize,
        node: &json::Node,
        transform: DAffine3,
        place: &str,
    ) -> Result<(), SceneError> {
        let extensions = node.extensions.as_ref().map(|e| &e.others);
        if let Some(mesh) = node.mesh {
            self.read_mesh(mesh.value(), &format!("{place}/mesh"))?;
            let name = node.name.clone().unwrap_or_else(|| format!("node {index}"));
            for (copy, local) in self.copies(extensions, place)?.into_iter().enumerate() {
                let name = if copy == 0 { name.clone() } else { format!("{name} #{copy}") };
                self.place_mesh(mesh.value(), transform * local, &name, place)?;
            }
        }
        if let Some(camera) = node.camera {
            self.read_camera(camera.value(), transform, place)?;
        }
        let light: Option<NodeLight> = self.document.extension(extensions, "KHR_lights_punctual", place)?;
        if let Some(NodeLight { light }) = light {
            self.read_light(light, transform, place)?;
        }
        Ok(())
    }

    fn place_mesh(
        &mut self,
        mesh: usize,
        transform: DAffine3,
        name: &str,
        place: &str,
    ) -> Result<(), SceneError> {
        let transform = transform.as_affine3a();
        if !(transform.is_finite() && transform.translation.abs().max_element() <= MAX_MAGNITUDE) {
            return Err(self.document.error(
                place,
                format!("with those of its parents, the transform is not finite or moves farther than {MAX_MAGNITUDE:e} m; mend it"),
            ));
        }
        // The inverse is what ray casting needs; it must exist in single precision.
        if transform.matrix3.determinant() == 0.0 || !transform.inverse().is_finite() {
            self.warnings.add("an instance scaled to nothing is left out", place);
            return Ok(());
        }
        let parts = self.meshes.get(&mesh).map_or(&[][..], Vec::as_slice);
        if self.scene.instances.len() + parts.len() > MAX_INSTANCES {
            return Err(self
                .document
                .error(place, format!("more than {MAX_INSTANCES} instances; split the scene")));
        }
        self.scene.instances.extend(parts.iter().map(|&(mesh, material)| Instance {
            name: name.to_owned(),
            mesh,
            material,
            transform,
        }));
        Ok(())
    }

    /// The copies that EXT_mesh_gpu_instancing makes of a node's mesh; without it, one.
    fn copies(
        &self,
        extensions: Option<&Map<String, Value>>,
        place: &str,
    ) -> Result<Vec<DAffine3>, SceneError> {
        const NAME: &str = "EXT_mesh_gpu_instancing";
        let Some(instancing) = self.document.extension::<MeshInstancing>(extensions, NAME, place)? else {
            return Ok(vec![DAffine3::IDENTITY]);
        };
        let place = format!("{place}/extensions/{NAME}/attributes");
        let translations = self.copy_attribute::<3>(&instancing, "TRANSLATION", Usage::FloatOnly, &place)?;
        let rotations = self.copy_attribute::<4>(&instancing, "ROTATION", Usage::Rotation, &place)?;
        let scales = self.copy_attribute::<3>(&instancing, "SCALE", Usage::FloatOnly, &place)?;
        let lengths = [
            translations.as_ref().map(Vec::len),
            rotations.as_ref().map(Vec::len),
            scales.as_ref().map(Vec::len),
        ];
        let count = lengths.iter().flatten().copied().next().unwrap_or(1);
        if lengths.iter().flatten().any(|&length| length != count) {
            return Err(self.document.error(place, "the attributes have different counts; export it again"));
        }
        let copy = |i: usize| {
            let translation = translations.as_ref().map_or([0.0; 3], |values| values[i]);
            let rotation = rotations.as_ref().map_or([0.0, 0.0, 0.0, 1.0], |values| values[i]);
            let scale = scales.as_ref().map_or([1.0; 3], |values| values[i]);
            self.compose(translation, rotation, scale, &place)
        };
        (0..count).map(copy).collect()
    }

    fn copy_attribute<const N: usize>(
        &self,
        instancing: &MeshInstancing,
        name: &str,
        usage: Usage,
        place: &str,
    ) -> Result<Option<Vec<[f32; N]>>, SceneError> {
        let Some(value) = instancing.attributes.get(name) else { return Ok(None) };
        let place = format!("{place}/{name}");
        let accessor = value.as_u64().and_then(|index| usize::try_from(index).ok());
        let accessor =
            accessor.ok_or_else(|| self.document.error(&place, "must be the index of an accessor"))?;
        self.document.vectors::<N>(accessor, usage, &place).map(Some)
    }

    /// The transform of a node to its parent, from its matrix or its translation, rotation, scale.
    fn local_transform(&self, node: &json::Node, place: &str) -> Result<DAffine3, SceneError> {
        if let Some(matrix) = &node.matrix {
            let matrix = DMat4::from_cols_array(&matrix.map(f64::from));
            let bottom_row = DVec4::new(matrix.x_axis.w, matrix.y_axis.w, matrix.z_axis.w, matrix.w_axis.w);
            if !matrix.is_finite() || !bottom_row.abs_diff_eq(DVec4::W, 1e-6) {
                return Err(self.document.error(
                    format!("{place}/matrix"),
                    "must be finite and end in 0, 0, 0, 1 by rows (column-major order); mend it",
                ));
            }
            return Ok(DAffine3::from_mat4(matrix));
        }
        let translation = node.translation.unwrap_or([0.0; 3]);
        let rotation = node.rotation.map_or([0.0, 0.0, 0.0, 1.0], |quaternion| quaternion.0);
        let scale = node.scale.unwrap_or([1.0; 3]);
        self.compose(translation, rotation, scale, place)
    }

    /// Scale, then rotate, then translate.
    fn compose(
        &self,
        translation: [f32; 3],
        rotation: [f32; 4],
        scale: [f32; 3],
        place: &str,
    ) -> Result<DAffine3, SceneError> {
        let rotation = DQuat::from_array(rotation.map(f64::from));
        let length = rotation.length();
        let vector = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
        let (translation, scale) = (vector(translation), vector(scale));
        if !(length > 0.0 && length.is_finite() && translation.is_finite() && scale.is_finite()) {
            return Err(self.document.error(
                place,
                "translation, rotation and scale must be finite, and the rotation a quaternion of length 1; mend them",
            ));
        }
        Ok(DAffine3::from_scale_rotation_translation(scale, rotation / length, translation))
    }
}
