//! What the instances of a scene are made of, and which of them paths enter.

use std::collections::HashMap;

use crate::plan::solid::{Flaw, flaws, is_inside_out};
use crate::radiometry::Rgb;
use crate::scene::{Mesh, Method, Scene, Surface};

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

/// The flaws of translucent bodies, by instance: all of those that paths walk in. The area integral knows outside from inside by the
/// side that is looked at, so that only surfaces that shine have to know it.
pub(super) fn flaws_of_bodies(scene: &Scene, methods: &[Option<Method>]) -> Vec<(u32, Flaw)> {
    let mut known: HashMap<(usize, Method), Vec<Flaw>> = HashMap::new();
    let mut all = Vec::new();
    for (index, instance) in (0..).zip(&scene.instances) {
        let Some(method) = methods[index as usize] else { continue };
        let found = || flaws_for(method, &scene.meshes[instance.mesh]);
        let found = known.entry((instance.mesh, method)).or_insert_with(found);
        all.extend(found.iter().map(|&flaw| (index, flaw)));
    }
    all
}

/// What is wrong with `mesh` as a body rendered by `method`.
fn flaws_for(method: Method, mesh: &Mesh) -> Vec<Flaw> {
    match method {
        Method::Walk => flaws(mesh),
        Method::Bssrdf if is_inside_out(mesh) => vec![Flaw::InsideOut],
        _ => Vec::new(),
    }
}
