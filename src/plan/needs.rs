//! What a kernel has to have code for to render a scene.

use super::kernel::Abilities;
use crate::scene::material::Coverage;
use crate::scene::{Material, Method, Scene, Surface};

/// The abilities that `scene`, folded, needs. `methods` says by instance how light under the surface is computed.
pub fn needed(scene: &Scene, methods: &[Option<Method>]) -> Abilities {
    let placed = scene.instances.iter().zip(methods);
    let placed = placed.filter(|(placed, _)| !scene.meshes[placed.mesh].triangles.is_empty());
    placed.fold(Abilities::NONE, |all, (placed, method)| {
        all.and(of_material(&scene.materials[placed.material], *method))
    })
}

fn of_material(material: &Material, method: Option<Method>) -> Abilities {
    let inside = match &material.surface {
        Surface::Translucent { .. } if method == Some(Method::Walk) => {
            Abilities::WALKS.and(Abilities::INTERIORS)
        }
        Surface::Translucent { .. } => Abilities::SUBSURFACE,
        surface if surface.is_clear_body() => Abilities::INTERIORS,
        _ => Abilities::NONE,
    };
    let textures = if material.varies() { Abilities::TEXTURES } else { Abilities::NONE };
    let coverage = match material.coverage {
        Coverage::Full => Abilities::NONE,
        _ => Abilities::COVERAGE,
    };
    inside.and(textures).and(coverage)
}
