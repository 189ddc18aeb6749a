//! What the instances of a scene are made of, and which of them paths enter.

use crate::plan::solid::{Flaw, flaws};
use crate::radiometry::Rgb;
use crate::scene::{Method, Scene, Surface};

/// What an instance is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Substance {
    /// Index into the scene's materials.
    Material(usize),
    /// Index into the scene's lights.
    Light(usize),
}

/// Index and absorption inside a body of a material, if its boundary lets paths in; that of what scatters does where paths
/// walk.
pub(super) fn interior_of(scene: &Scene, material: usize, walked: bool) -> Option<(f32, Rgb)> {
    match &scene.materials[material].surface {
        Surface::Dielectric { ior, sigma_a, .. } => Some((*ior, *sigma_a)),
        surface @ Surface::MetallicRoughness(m) if surface.is_clear_body() => Some((m.ior, m.sigma_a)),
        Surface::Translucent { ior, .. } if walked => Some((*ior, Rgb::ZERO)),
        _ => None,
    }
}

/// The flaws of the bodies that paths walk in, by instance.
pub(super) fn flaws_of_walked(scene: &Scene, methods: &[Option<Method>]) -> Vec<(u32, Flaw)> {
    let mut by_mesh: Vec<Option<Vec<Flaw>>> = vec![None; scene.meshes.len()];
    let mut all = Vec::new();
    for (index, instance) in (0..).zip(&scene.instances) {
        if methods[index as usize] == Some(Method::Walk) {
            let found = by_mesh[instance.mesh].get_or_insert_with(|| flaws(&scene.meshes[instance.mesh]));
            all.extend(found.iter().map(|&flaw| (index, flaw)));
        }
    }
    all
}
