//! The TOML scene file: objects, camera, film, lights, materials and settings, documented with the
//! function that reads each. Unknown keys are errors; every error names line and key.

mod document;
mod light;
mod material;
mod object;
mod placement;
mod settings;
mod transform;

use std::path::Path;

use ::toml::de::DeTable;

use self::document::{Read, Source, Table, Value, remedy};
use self::placement::GltfFiles;
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
    complete(&mut scene, camera.or(files.camera), root.file())?;
    Ok(scene)
}

/// The names of the materials of the file; their indices in the scene are those in this list.
struct Materials {
    names: Vec<String>,
}

impl Materials {
    fn read(table: Option<Table>, scene: &mut Scene) -> Read<Self> {
        let mut names = Vec::new();
        for (name, value) in table.iter().flat_map(Table::iter) {
            scene.materials.push(material::material(name, &value.table()?, &mut scene.warnings)?);
            names.push(name.to_owned());
        }
        Ok(Self { names })
    }

    /// The index of the material that `value` names.
    fn index(&self, value: &Value) -> Read<usize> {
        let name = value.text()?;
        self.names.iter().position(|known| known == name).ok_or_else(|| {
            let names: Vec<&str> = self.names.iter().map(String::as_str).collect();
            value.error(format!("there is no [material.{name}]; {}", remedy(name, &names)))
        })
    }
}
