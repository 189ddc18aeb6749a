//! Materials of the scene file in place of those of a glTF file.

use std::collections::HashMap;

use super::document::{Read, Value};
use crate::scene::{Material, ScatteringInput, Scene, Surface};

/// What a material leaves to the glTF material that it replaces: always the albedo and the normal map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Inherits {
    /// The roughness as well.
    pub roughness: bool,
}

/// A material that replaces those of a glTF file.
pub struct Replacement<'a> {
    /// Index in the scene.
    pub material: usize,
    /// What it takes from those it replaces; `None`: nothing.
    pub inherits: Option<Inherits>,
    /// Where the object asks for it.
    pub asked_at: Value<'a>,
}

/// Materials made of a replacement and what it inherits, by the indices of both: one for each distinct
/// glTF material, however often it is placed.
#[derive(Default)]
pub struct Heirs {
    made: HashMap<(usize, usize), usize>,
}

impl Heirs {
    /// The index of `replacement` with what it inherits from the scene's material `replaced`.
    pub fn index(&mut self, replacement: &Replacement, replaced: usize, scene: &mut Scene) -> Read<usize> {
        let Some(inherits) = replacement.inherits else { return Ok(replacement.material) };
        let key = (replacement.material, replaced);
        if let Some(&known) = self.made.get(&key) {
            return Ok(known);
        }
        let (template, original) = (&scene.materials[replacement.material], &scene.materials[replaced]);
        let material = heir(template, original, inherits).ok_or_else(|| {
            replacement.asked_at.error(format!(
                "`{}` takes its albedo from the base colour of the glTF material, but `{}` has none; \
                 give `albedo` in numbers",
                template.name, original.name
            ))
        })?;
        scene.materials.push(material);
        let index = scene.materials.len() - 1;
        self.made.insert(key, index);
        Ok(index)
    }
}

/// `template` with the base colour of `original` as its albedo; `None` if that has no base colour.
fn heir(template: &Material, original: &Material, inherits: Inherits) -> Option<Material> {
    let base_color = original.base_color()?;
    let mut material = template.clone();
    material.name = format!("{} of {}", template.name, original.name);
    material.normal_map = original.normal_map;
    if let Surface::Translucent { roughness, medium, .. } = &mut material.surface {
        if let ScatteringInput::Albedo { albedo, .. } = medium {
            *albedo = base_color;
        }
        if let (true, Some(given)) = (inherits.roughness, original.roughness()) {
            *roughness = given;
        }
    }
    Some(material)
}
