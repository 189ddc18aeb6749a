//! Which pixels show which material.

use super::errors::Region;
use crate::raycast::RayCaster;
use crate::scene::{Scene, Surface};
use crate::transport::Renderer;

/// A material that fewer pixels show is not looked at alone: its errors would be those of single pixels.
const FEWEST_PIXELS: usize = 16;

/// True for a material under whose surface light goes.
pub fn is_translucent(scene: &Scene, material: usize) -> bool {
    match &scene.materials[material].surface {
        Surface::Translucent { medium, .. } => match medium {
            crate::scene::ScatteringInput::Coefficients { sigma_s, .. }
            | crate::scene::ScatteringInput::Spectral { sigma_s, .. } => !sigma_s.is_black(),
            crate::scene::ScatteringInput::Albedo { .. } => true,
        },
        _ => false,
    }
}

/// True if some object is of a translucent material.
pub fn has_translucent(scene: &Scene) -> bool {
    scene.instances.iter().any(|instance| is_translucent(scene, instance.material))
}

/// The whole picture first, all translucent bodies second, then each translucent material that enough pixels show, by
/// what the centres of pixels see first, clear bodies looked through. A translucent material is in the scene.
pub fn regions<C: RayCaster>(renderer: &Renderer<C>) -> Vec<Region> {
    let scene = renderer.scene();
    let (width, height) = (scene.film.width, scene.film.height);
    let seen: Vec<Option<usize>> =
        (0..height).flat_map(|y| (0..width).map(move |x| renderer.material_seen(x, y))).collect();
    let pixels = |wanted: &dyn Fn(usize) -> bool| -> Vec<usize> {
        (0..seen.len()).filter(|&p| seen[p].is_some_and(wanted)).collect()
    };
    let bodies = pixels(&|material| is_translucent(scene, material));
    let whole: Vec<usize> = (0..seen.len()).collect();
    // A body seen by its light alone: the whole picture then stands for it.
    let bodies = if bodies.len() < FEWEST_PIXELS { whole.clone() } else { bodies };
    let mut regions = vec![
        Region { name: "whole picture".into(), material: None, pixels: whole },
        Region { name: "translucent bodies".into(), material: None, pixels: bodies },
    ];
    regions.extend((0..scene.materials.len()).filter_map(|material| {
        let pixels = pixels(&|seen| seen == material && is_translucent(scene, material));
        let name = scene.materials[material].name.clone();
        let name = if name.is_empty() { format!("material {material}") } else { name };
        (pixels.len() >= FEWEST_PIXELS).then_some(Region { name, material: Some(material), pixels })
    }));
    regions
}
