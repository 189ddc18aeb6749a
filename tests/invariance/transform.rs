//! Transformations of scenes as data.

use std::collections::HashMap;

use alabaster::math::sampler::HashGenerator;
use alabaster::radiometry::Rgb;
use alabaster::scene::texture::Pixels;
use alabaster::scene::{
    ColorInput, Environment, Instance, Light, Material, Mesh, ScatteringInput, Scene, Surface,
};
use glam::{Affine3A, Mat3, Quat, Vec3, Vec4};

/// A scene elsewhere, turned, larger.
#[derive(Clone, Copy)]
pub struct Similarity {
    pub scale: f32,
    pub rotation: Quat,
    /// m.
    pub translation: Vec3,
}

impl Similarity {
    pub const IDENTITY: Self = Self { scale: 1.0, rotation: Quat::IDENTITY, translation: Vec3::ZERO };

    fn point(&self, point: Vec3) -> Vec3 {
        self.rotation * (point * self.scale) + self.translation
    }

    fn turned(&self, direction: Vec3) -> Vec3 {
        self.rotation * direction
    }

    fn light(&self, light: &mut Light) {
        match light {
            Light::Quad { center, half_u, half_v, .. } => {
                *center = self.point(*center);
                *half_u = self.turned(*half_u) * self.scale;
                *half_v = self.turned(*half_v) * self.scale;
            }
            Light::Disk { center, normal, radius, .. } => {
                *center = self.point(*center);
                *normal = self.turned(*normal);
                *radius *= self.scale;
            }
            Light::Sphere { center, radius, .. } => {
                *center = self.point(*center);
                *radius *= self.scale;
            }
            // Irradiance falls with the square of the distance.
            Light::Point { position, intensity } => {
                *position = self.point(*position);
                intensity.rgb *= self.scale.powi(2);
            }
            Light::Spot { position, direction, intensity, .. } => {
                *position = self.point(*position);
                *direction = self.turned(*direction);
                intensity.rgb *= self.scale.powi(2);
            }
            Light::Directional { direction, .. } => *direction = self.turned(*direction),
        }
    }

    /// Lengths in the medium go with those of the body.
    fn medium(&self, surface: &mut Surface) {
        let scale = self.scale;
        match surface {
            Surface::Diffuse { .. } | Surface::Metal { .. } => {}
            Surface::Dielectric { sigma_a, .. } => *sigma_a *= 1.0 / scale,
            Surface::MetallicRoughness(m) => m.sigma_a *= 1.0 / scale,
            Surface::Translucent {
                medium:
                    ScatteringInput::Coefficients { sigma_a, sigma_s, .. }
                    | ScatteringInput::Spectral { sigma_a, sigma_s, .. },
                ..
            } => {
                *sigma_a *= 1.0 / scale;
                *sigma_s *= 1.0 / scale;
            }
            Surface::Translucent { medium: ScatteringInput::Albedo { mean_free_path, .. }, .. } => {
                *mean_free_path *= scale;
            }
        }
    }
}

/// The scene elsewhere, with everything in it and with what looks at it.
pub fn transformed(scene: &Scene, similarity: &Similarity) -> Scene {
    let mut scene = without_coefficients(scene, similarity);
    scene.materials.iter_mut().for_each(|material| similarity.medium(&mut material.surface));
    scene
}

/// The same but for the media, which is wrong if it is larger.
pub fn without_coefficients(scene: &Scene, similarity: &Similarity) -> Scene {
    let mut scene = scene.clone();
    let Similarity { scale, rotation, translation } = *similarity;
    let map = Affine3A::from_scale_rotation_translation(Vec3::splat(scale), rotation, translation);
    scene.instances.iter_mut().for_each(|placed| placed.transform = map * placed.transform);
    scene.lights.iter_mut().for_each(|light| similarity.light(light));
    let camera = &mut scene.camera;
    (camera.position, camera.target) = (similarity.point(camera.position), similarity.point(camera.target));
    camera.up = similarity.turned(camera.up);
    camera.aperture *= scale;
    camera.focus_distance = camera.focus_distance.map(|distance| distance * scale);
    if let Some(Environment::Map { rotation: to_map, .. }) = &mut scene.environment {
        *to_map *= Mat3::from_quat(rotation.inverse());
    }
    scene
}

/// Triangles in another order, each begun at another vertex.
pub fn reordered(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    let mut random = HashGenerator::new(5);
    for mesh in &mut scene.meshes {
        let mut below = |n: usize| ((random.next_f32() * n as f32) as usize).min(n - 1);
        for last in (1..mesh.triangles.len()).rev() {
            mesh.triangles.swap(last, below(last + 1));
        }
        mesh.triangles.iter_mut().for_each(|triangle| triangle.rotate_left(below(3)));
    }
    scene
}

/// Each triangle in four, by the middles of its edges.
pub fn split(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.meshes.iter_mut().for_each(split_mesh);
    scene
}

fn split_mesh(mesh: &mut Mesh) {
    let mut middles = HashMap::new();
    let mut middle = |mesh: &mut Mesh, i: u32, j: u32| {
        *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
            let (i, j) = (i as usize, j as usize);
            mesh.positions.push(0.5 * (mesh.positions[i] + mesh.positions[j]));
            if !mesh.normals.is_empty() {
                // Not of unit length: normals interpolated from it then are those of the whole triangle.
                mesh.normals.push(0.5 * (mesh.normals[i] + mesh.normals[j]));
            }
            if !mesh.tangents.is_empty() {
                let sum = mesh.tangents[i] + mesh.tangents[j];
                mesh.tangents.push((0.5 * sum.truncate()).extend(mesh.tangents[i].w));
            }
            for set in mesh.texture_coordinates.iter_mut().filter(|set| !set.is_empty()) {
                set.push(0.5 * (set[i] + set[j]));
            }
            if !mesh.colors.is_empty() {
                mesh.colors.push(0.5 * (mesh.colors[i] + mesh.colors[j]));
            }
            mesh.positions.len() as u32 - 1
        })
    };
    let mut triangles = Vec::with_capacity(4 * mesh.triangles.len());
    for [a, b, c] in std::mem::take(&mut mesh.triangles) {
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(i, j)| middle(mesh, i, j));
        triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    mesh.triangles = triangles;
}

/// Every mesh placed twice, so that none is baked: the second time where it is not seen, so small that it keeps next to no light away.
pub fn instanced(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    let camera = scene.camera;
    let behind = camera.position + (camera.position - camera.target);
    let speck = Affine3A::from_scale_rotation_translation(Vec3::splat(1e-4), Quat::IDENTITY, behind);
    let specks = scene
        .instances
        .iter()
        .map(|placed| Instance { transform: speck * placed.transform, ..placed.clone() });
    let specks: Vec<Instance> = specks.collect();
    scene.instances.extend(specks);
    scene
}

/// Every object with a mesh of its own, in the world.
pub fn baked(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    let bake = |placed: &Instance| {
        let mut mesh = scene.meshes[placed.mesh].clone();
        let (linear, cofactors) = (placed.transform.matrix3, placed.transform.matrix3.inverse().transpose());
        mesh.positions.iter_mut().for_each(|p| *p = placed.transform.transform_point3(*p));
        mesh.normals.iter_mut().for_each(|n| *n = (cofactors * *n).normalize());
        mesh.tangents.iter_mut().for_each(|t| *t = (linear * t.truncate()).normalize().extend(t.w));
        if linear.determinant() < 0.0 {
            mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        mesh
    };
    let meshes = scene.instances.iter().map(bake).collect();
    scene.meshes = meshes;
    for (index, placed) in scene.instances.iter_mut().enumerate() {
        (placed.mesh, placed.transform) = (index, Affine3A::IDENTITY);
    }
    scene
}

/// Channel c of every colour is what channel `channels[c]` was.
pub fn recolored(scene: &Scene, channels: [usize; 3]) -> Scene {
    let mut scene = scene.clone();
    let exchanged = |color: Rgb| exchanged(color, channels);
    for light in &mut scene.lights {
        let (Light::Quad { radiance: color, .. }
        | Light::Disk { radiance: color, .. }
        | Light::Sphere { radiance: color, .. }
        | Light::Point { intensity: color, .. }
        | Light::Spot { intensity: color, .. }
        | Light::Directional { irradiance: color, .. }) = light;
        color.rgb = exchanged(color.rgb);
    }
    match &mut scene.environment {
        Some(Environment::Constant(radiance)) => *radiance = exchanged(*radiance),
        Some(Environment::Map { radiance, .. }) => {
            radiance.iter_mut().for_each(|pixel| *pixel = exchanged(*pixel))
        }
        None => {}
    }
    for color in scene.meshes.iter_mut().flat_map(|mesh| &mut mesh.colors) {
        *color = Vec4::from_array([color[channels[0]], color[channels[1]], color[channels[2]], color.w]);
    }
    let mut materials = std::mem::take(&mut scene.materials);
    for material in &mut materials {
        permuted(material, channels);
        for input in material.inputs_mut().0 {
            recolor_texture(&mut scene, input, channels);
        }
    }
    scene.materials = materials;
    scene
}

fn exchanged(color: Rgb, channels: [usize; 3]) -> Rgb {
    Rgb::from_fn(|c| color[channels[c]])
}

/// Exchanges the channels of all constants of `material`.
pub fn permuted(material: &mut Material, channels: [usize; 3]) {
    let exchange = |color: &mut Rgb| *color = exchanged(*color, channels);
    match &mut material.surface {
        Surface::Diffuse { .. } | Surface::Metal { .. } => {}
        Surface::Dielectric { sigma_a, .. } => exchange(sigma_a),
        Surface::MetallicRoughness(m) => exchange(&mut m.sigma_a),
        Surface::Translucent {
            medium:
                ScatteringInput::Coefficients { sigma_a, sigma_s, .. }
                | ScatteringInput::Spectral { sigma_a, sigma_s, .. },
            ..
        } => {
            exchange(sigma_a);
            exchange(sigma_s);
        }
        Surface::Translucent { medium: ScatteringInput::Albedo { mean_free_path, .. }, .. } => {
            exchange(mean_free_path);
        }
    }
    material.inputs_mut().0.into_iter().for_each(|input| exchange(&mut input.factor));
}

/// Gives `input` a texture of its own, whose channels are exchanged: as data, the image may serve others.
fn recolor_texture(scene: &mut Scene, input: &mut ColorInput, channels: [usize; 3]) {
    let Some(index) = input.texture else { return };
    let texture = scene.textures[index];
    let mut image = scene.images[texture.image].clone();
    let [r, g, b] = channels;
    match &mut image.pixels {
        Pixels::Rgba8(pixels) => pixels.iter_mut().for_each(|p| *p = [p[r], p[g], p[b], p[3]]),
        Pixels::Rgba16(pixels) => pixels.iter_mut().for_each(|p| *p = [p[r], p[g], p[b], p[3]]),
        Pixels::Encoded(_) => {}
    }
    input.texture = Some(scene.textures.len());
    scene.textures.push(alabaster::scene::Texture { image: scene.images.len(), ..texture });
    scene.images.push(image);
}
