//! The TOML scene file: objects, camera, film, lights, materials and settings, documented with the
//! function that reads each. Unknown keys are errors; every error names line and key.

mod document;
mod light;
mod material;
mod object;
mod placement;
mod refraction;
mod replacement;
mod settings;
mod transform;

use std::path::Path;

use ::toml::de::DeTable;

use self::document::{Read, Source, Table, Value, remedy};
use self::placement::GltfFiles;
use self::replacement::{Inherits, Replacement};
use super::complete::complete;
use super::{Scene, SceneError};

/// Reads the scene file at `path`, and all files that it names.
pub fn read_toml(path: &Path) -> Result<Scene, SceneError> {
    let text = std::fs::read_to_string(path).map_err(|e| SceneError::file(path, e.to_string()))?;
    let source = Source { path, text: &text };
    let document = DeTable::parse(&text).map_err(|e| {
        let offset = e.span().map_or(text.len(), |span| span.start);
        source.error(offset, "", format!("not valid TOML: {}", e.message()))
    })?;
    read_document(&Table::root(&source, document.get_ref()))
}

fn read_document(root: &Table) -> Read<Scene> {
    root.only(&[
        "title",
        "object",
        "camera",
        "film",
        "environment",
        "light",
        "material",
        "subsurface",
        "render",
    ])?;
    let section = |key| root.optional(key, Value::table);
    let list = |key| root.optional(key, Value::tables).map(Option::unwrap_or_default);

    let stem = root.file().file_stem().unwrap_or_default().to_string_lossy();
    let mut scene =
        Scene { title: root.optional("title", Value::text)?.unwrap_or(&stem).to_owned(), ..Scene::default() };
    if let Some(table) = section("film")? {
        scene.film = settings::film(&table)?;
    }
    if let Some(table) = section("subsurface")? {
        scene.subsurface = settings::subsurface(&table)?;
    }
    if let Some(table) = section("render")? {
        scene.render = settings::render(&table)?;
    }
    let camera = section("camera")?.map(|table| settings::camera(&table)).transpose()?;
    for table in list("light")? {
        scene.lights.push(light::light(&table)?);
    }
    let materials = Materials::read(section("material")?, &mut scene)?;
    let objects = list("object")?;
    if objects.is_empty() {
        let problem = "the scene has no objects; add [[object]] with `gltf = \"file.glb\"` or a `shape`";
        return Err(SceneError::file(root.file(), problem));
    }
    let mut files = GltfFiles::default();
    for table in &objects {
        object::object(table, &materials, &mut files, &mut scene)?;
    }
    if let Some(table) = section("environment")? {
        scene.environment = Some(settings::environment(&table, &mut scene.warnings)?);
    }
    let has_lights = has_lights(&scene);
    complete(&mut scene, camera.or(files.camera), has_lights, root.file())?;
    Ok(scene)
}

/// True if there is any light, however faint: whoever writes a scene file means what it says.
fn has_lights(scene: &Scene) -> bool {
    let emits = |material: usize| !scene.materials[material].emission.factor.is_black();
    !scene.lights.is_empty()
        || scene.environment.is_some()
        || scene.instances.iter().any(|instance| emits(instance.material))
}

/// The materials of the file; their indices in the scene are those in these lists.
struct Materials {
    names: Vec<String>,
    inherits: Vec<Option<Inherits>>,
}

impl Materials {
    fn read(table: Option<Table>, scene: &mut Scene) -> Read<Self> {
        let mut materials = Self { names: Vec::new(), inherits: Vec::new() };
        for (name, value) in table.iter().flat_map(Table::iter) {
            let table = value.table()?;
            scene.materials.push(material::material(name, &table, &mut scene.warnings)?);
            materials.names.push(name.to_owned());
            materials.inherits.push(material::inherits(&table));
        }
        Ok(materials)
    }

    /// The material that `value` names, to replace those of a glTF file.
    fn replacement<'a>(&self, value: &Value<'a>) -> Read<Replacement<'a>> {
        let name = value.text()?;
        let material = self.names.iter().position(|known| known == name).ok_or_else(|| {
            let names: Vec<&str> = self.names.iter().map(String::as_str).collect();
            value.error(format!("there is no [material.{name}]; {}", remedy(name, &names)))
        })?;
        Ok(Replacement { material, inherits: self.inherits[material], asked_at: value.clone() })
    }

    /// The index of the material that `value` names, for a shape.
    fn index(&self, value: &Value) -> Read<usize> {
        let Replacement { material, inherits, .. } = self.replacement(value)?;
        match inherits {
            None => Ok(material),
            Some(_) => Err(value.error(format!(
                "`{}` takes its albedo from the base colour of a glTF material, which a shape does not \
                 have; give `albedo` in numbers",
                self.names[material]
            ))),
        }
    }
}
