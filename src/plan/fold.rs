//! A scene reduced to what a picture can depend on: constants folded, and what nothing uses dropped.

use crate::radiometry::Rgb;
use crate::radiometry::spectrum::dispersion::Dispersion;
use crate::radiometry::spectrum::{LONGEST, SHORTEST};
use crate::scene::material::Coverage;
use crate::scene::texture::Pixels;
use crate::scene::{
    ColorInput, Environment, Image, Material, Mesh, ScalarInput, ScatteringInput, Scene, Surface, Texture,
};

/// Folds what is constant in `scene` and drops what no placed surface uses. Indices stay what they are: of what is dropped a plain material, an empty
/// mesh or an image of one pixel remains.
pub fn fold(scene: &mut Scene) {
    drop_unused_materials_and_meshes(scene);
    fold_vertex_colors(scene);
    let constants = constant_channels(scene);
    scene.materials.iter_mut().for_each(|material| fold_material(material, &constants));
    if scene.environment.as_ref().is_some_and(is_black) {
        scene.environment = None;
    }
    drop_unused_images(scene);
    drop_unused_attributes(scene);
}

/// Materials and meshes of placed triangles are used.
fn drop_unused_materials_and_meshes(scene: &mut Scene) {
    let mut used_meshes = vec![false; scene.meshes.len()];
    let mut used_materials = vec![false; scene.materials.len()];
    for placed in scene.instances.iter().filter(|placed| !scene.meshes[placed.mesh].triangles.is_empty()) {
        used_meshes[placed.mesh] = true;
        used_materials[placed.material] = true;
    }
    for (mesh, _) in scene.meshes.iter_mut().zip(used_meshes).filter(|(_, used)| !used) {
        *mesh = Mesh { name: std::mem::take(&mut mesh.name), ..Mesh::default() };
    }
    for (material, _) in scene.materials.iter_mut().zip(used_materials).filter(|(_, used)| !used) {
        *material = Material { name: std::mem::take(&mut material.name), ..Material::default() };
    }
}

/// White vertex colours are none, and materials on meshes without any do not ask for them.
fn fold_vertex_colors(scene: &mut Scene) {
    for mesh in &mut scene.meshes {
        if mesh.colors.iter().all(|color| *color == glam::Vec4::ONE) {
            mesh.colors = Vec::new();
        }
    }
    let mut colored = vec![false; scene.materials.len()];
    for placed in &scene.instances {
        colored[placed.material] |= !scene.meshes[placed.mesh].colors.is_empty();
    }
    for (material, _) in scene.materials.iter_mut().zip(colored).filter(|(_, colored)| !colored) {
        let (colors, scalars) = material.inputs_mut();
        colors.into_iter().for_each(|input| input.vertex_color = false);
        scalars.into_iter().for_each(|input| input.vertex_alpha = false);
    }
}

/// By texture: its channels that are the same everywhere, of those that some material looks up.
fn constant_channels(scene: &Scene) -> Vec<[Option<f32>; 4]> {
    let mut used = vec![false; scene.textures.len()];
    for texture in scene.materials.iter().flat_map(Material::textures) {
        if let Some(used) = used.get_mut(texture) {
            *used = true;
        }
    }
    let constants = |(texture, used): (&Texture, bool)| match scene.images.get(texture.image) {
        Some(image) if used => constants_of(image, texture.srgb),
        _ => [None; 4],
    };
    scene.textures.iter().zip(used).map(constants).collect()
}

fn constants_of(image: &Image, srgb: bool) -> [Option<f32>; 4] {
    let same = match &image.pixels {
        Pixels::Rgba8(pixels) => same_channels(pixels),
        Pixels::Rgba16(pixels) => same_channels(pixels),
        Pixels::Encoded(_) => [false; 4],
    };
    let texel = image.texel(0, 0, srgb);
    std::array::from_fn(|channel| same[channel].then_some(texel[channel]))
}

fn same_channels<T: PartialEq>(pixels: &[[T; 4]]) -> [bool; 4] {
    let mut same = [!pixels.is_empty(); 4];
    for pixel in pixels {
        for channel in 0..4 {
            same[channel] &= pixel[channel] == pixels[0][channel];
        }
        if same == [false; 4] {
            break;
        }
    }
    same
}

fn fold_material(material: &mut Material, constants: &[[Option<f32>; 4]]) {
    let (colors, scalars) = material.inputs_mut();
    colors.into_iter().for_each(|input| fold_color(input, constants));
    scalars.into_iter().for_each(|input| fold_scalar(input, constants));
    material.normal_map = material.normal_map.filter(|(_, scale)| *scale != 0.0);
    material.coverage = folded_coverage(material.coverage);
    fold_surface(&mut material.surface);
}

fn fold_color(input: &mut ColorInput, constants: &[[Option<f32>; 4]]) {
    if let Some([Some(r), Some(g), Some(b), _]) = input.texture.and_then(|texture| constants.get(texture)) {
        *input = ColorInput { factor: input.factor * Rgb::new(*r, *g, *b), texture: None, ..*input };
    }
    if input.factor.is_black() {
        *input = ColorInput::constant(input.factor);
    }
}

fn fold_scalar(input: &mut ScalarInput, constants: &[[Option<f32>; 4]]) {
    let constant = |(texture, channel): (usize, usize)| constants.get(texture)?[channel & 3];
    if let Some(value) = input.texture.and_then(constant) {
        *input = ScalarInput { factor: input.factor * value, texture: None, ..*input };
    }
    if input.factor == 0.0 {
        *input = ScalarInput::constant(0.0);
    }
}

fn folded_coverage(coverage: Coverage) -> Coverage {
    let constant = |input: ScalarInput| (!input.varies()).then_some(input.factor);
    match coverage {
        // Alpha is never negative.
        Coverage::Mask { cutoff, .. } if cutoff <= 0.0 => Coverage::Full,
        Coverage::Mask { alpha, cutoff } if constant(alpha).is_some_and(|alpha| alpha >= cutoff) => {
            Coverage::Full
        }
        Coverage::Blend { alpha } if constant(alpha).is_some_and(|alpha| alpha >= 1.0) => Coverage::Full,
        other => other,
    }
}

fn fold_surface(surface: &mut Surface) {
    match surface {
        Surface::Dielectric { dispersion, .. } => fold_dispersion(dispersion),
        Surface::MetallicRoughness(m) => fold_dispersion(&mut m.dispersion),
        _ => {}
    }
    match surface {
        // Nothing but a metal has no base that could transmit.
        Surface::MetallicRoughness(m) if !m.metallic.varies() && m.metallic.factor >= 1.0 => {
            m.transmission = ScalarInput::constant(0.0);
            m.diffuse_transmission = ScalarInput::constant(0.0);
        }
        // A body in which nothing scatters is a clear one: paths go through it.
        Surface::Translucent {
            ior,
            roughness,
            medium:
                ScatteringInput::Coefficients { sigma_a, sigma_s, .. }
                | ScatteringInput::Spectral { sigma_a, sigma_s, .. },
        } if sigma_s.is_black() => {
            *surface = Surface::Dielectric {
                ior: *ior,
                dispersion: None,
                roughness: ScalarInput::constant(*roughness),
                sigma_a: *sigma_a,
                tint: ColorInput::constant(Rgb::ONE),
            };
        }
        _ => {}
    }
}

/// An index that is the same from one end of the visible range to the other has no dispersion.
fn fold_dispersion(dispersion: &mut Option<Dispersion>) {
    *dispersion = dispersion.filter(|dispersion| dispersion.ior(SHORTEST) != dispersion.ior(LONGEST));
}

fn is_black(environment: &Environment) -> bool {
    match environment {
        Environment::Constant(radiance) => radiance.is_black(),
        Environment::Map { radiance, .. } => radiance.iter().all(|radiance| radiance.is_black()),
    }
}

fn drop_unused_images(scene: &mut Scene) {
    let mut used = vec![false; scene.images.len()];
    for texture in scene.materials.iter().flat_map(Material::textures) {
        if let Some(used) = scene.textures.get(texture).and_then(|texture| used.get_mut(texture.image)) {
            *used = true;
        }
    }
    for (image, _) in scene.images.iter_mut().zip(used).filter(|(_, used)| !used) {
        let name = std::mem::take(&mut image.name);
        *image = Image { name, width: 1, height: 1, pixels: Pixels::Rgba8(vec![[u8::MAX; 4]]) };
    }
}

/// What is interpolated over a mesh and no material on it looks at.
fn drop_unused_attributes(scene: &mut Scene) {
    let mut has_normal_map = vec![false; scene.meshes.len()];
    let mut has_set = vec![[false; 2]; scene.meshes.len()];
    let mut has_colors = vec![false; scene.meshes.len()];
    for placed in &scene.instances {
        let material = &mut scene.materials[placed.material];
        has_normal_map[placed.mesh] |= material.normal_map.is_some();
        for texture in material.textures() {
            if let Some(texture) = scene.textures.get(texture) {
                has_set[placed.mesh][texture.coordinate_set & 1] = true;
            }
        }
        let (colors, scalars) = material.inputs_mut();
        has_colors[placed.mesh] |= colors.iter().any(|input| input.vertex_color);
        has_colors[placed.mesh] |= scalars.iter().any(|input| input.vertex_alpha);
    }
    for (index, mesh) in scene.meshes.iter_mut().enumerate() {
        if !has_normal_map[index] {
            mesh.tangents = Vec::new();
        }
        if !has_colors[index] {
            mesh.colors = Vec::new();
        }
        for (coordinates, _) in
            mesh.texture_coordinates.iter_mut().zip(has_set[index]).filter(|(_, has)| !has)
        {
            *coordinates = Vec::new();
        }
    }
}
