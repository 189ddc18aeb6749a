//! What is odd about a scene that paths walk in, told before it is rendered.

use super::substance::Substance;
use super::world::{UPWARDS, World};
use crate::optics::is_smooth;
use crate::raycast::RayCaster;
use crate::scene::{Scene, Surface};

/// One line for each thing, with what is assumed.
pub fn warnings<C: RayCaster>(world: &World<C>) -> Vec<String> {
    let scene = world.scene();
    let name = |instance: u32| scene.instances[instance as usize].name.as_str();
    let walked: Vec<u32> = world.enterable().iter().copied().filter(|&i| world.is_walked(i)).collect();
    let mut all: Vec<String> =
        world.flaws().iter().map(|(instance, flaw)| flaw.message(name(*instance))).collect();
    for &inner in &walked {
        if let Some(outer) = body_of_same_material_around(world, inner) {
            all.push(format!(
                "object \"{}\" lies inside object \"{}\" of the same material; they are taken for one body",
                name(inner),
                name(outer)
            ));
        }
    }
    if scene.lights.iter().any(|light| !light.has_size()) {
        let mut materials: Vec<usize> = walked.iter().filter_map(|&i| smooth_material(world, i)).collect();
        materials.sort_unstable();
        materials.dedup();
        all.extend(materials.into_iter().map(|material| lost_lights(scene, material)));
    }
    all
}

fn body_of_same_material_around<C: RayCaster>(world: &World<C>, instance: u32) -> Option<u32> {
    let mesh = world.scene().instances[instance as usize].mesh;
    if world.scene().meshes[mesh].triangles.is_empty() {
        return None;
    }
    let [a, b, c] = world.triangle(instance, 0);
    let around = world.interiors_at((a + b + c) / 3.0, UPWARDS);
    let is_same = |other: u32| other != instance && world.substance(other) == world.substance(instance);
    around.iter().map(|body| body.instance).find(|&other| is_same(other))
}

/// The material of `instance` if its boundary refracts and is smooth.
fn smooth_material<C: RayCaster>(world: &World<C>, instance: u32) -> Option<usize> {
    let Substance::Material(material) = world.substance(instance) else { return None };
    match world.scene().materials[material].surface {
        Surface::Translucent { ior, roughness, .. } => {
            (ior != 1.0 && is_smooth(roughness * roughness)).then_some(material)
        }
        _ => None,
    }
}

fn lost_lights(scene: &Scene, material: usize) -> String {
    format!(
        "material \"{}\": walks cannot find lights without size through its smooth boundary, which stays dark under \
         them; give the lights a size or the material a roughness",
        scene.materials[material].name
    )
}
