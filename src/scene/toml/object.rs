//! `[[object]]`: shapes, and where glTF files are placed.

use glam::{Affine3A, Vec3};

use super::Materials;
use super::document::{Read, Table, Value};
use super::light::rectangle;
use super::placement::GltfFiles;
use super::transform::transform;
use crate::scene::shape::{self, SPHERE_LEVEL, horizontal_frame};
use crate::scene::{Instance, Mesh, Scene};

#[derive(Clone, Copy)]
enum Shape {
    Sphere,
    Box,
    Quad,
    Disk,
}

const SHAPES: [(&str, Shape); 4] =
    [("sphere", Shape::Sphere), ("box", Shape::Box), ("quad", Shape::Quad), ("disk", Shape::Disk)];

/// Keys of every object.
const COMMON: [&str; 3] = ["name", "material", "transform"];

/// Adds one object to `scene`: a glTF file (`gltf`, optional `material`) or a shape (`shape`,
/// `material` and the keys of the shape). Both take `transform` and `name`.
pub fn object(table: &Table, materials: &Materials, files: &mut GltfFiles, scene: &mut Scene) -> Read<()> {
    table.exclusive(&["gltf", "shape"])?;
    let transform = match table.get("transform") {
        Some(value) => transform(&value.table()?)?,
        None => Affine3A::IDENTITY,
    };
    if let Some(gltf) = table.get("gltf") {
        table.only(&[&COMMON, ["gltf"].as_slice()].concat())?;
        let material = table.optional("material", |v| materials.replacement(v))?;
        return files.place(&gltf.existing_file()?, material.as_ref(), transform, scene);
    }
    if !table.has("shape") {
        // A misspelt `gltf` or `shape` is the likeliest reason.
        table
            .only(&[&COMMON, ["gltf", "shape", "center", "radius", "size", "normal"].as_slice()].concat())?;
        return Err(table.error("an object needs `gltf` or `shape`"));
    }
    let mesh = triangulated(table)?;
    let material = table.required("material", |v| materials.index(v))?;
    let name = table.optional("name", Value::text)?.unwrap_or(&mesh.name).to_owned();
    scene.instances.push(Instance { name, mesh: scene.meshes.len(), material, transform });
    scene.meshes.push(mesh);
    Ok(())
}

fn triangulated(table: &Table) -> Read<Mesh> {
    let only = |keys: &[&str]| table.only(&[&COMMON, ["shape", "center"].as_slice(), keys].concat());
    let center = || table.required("center", Value::vector);
    match table.required("shape", |v| v.choice(&SHAPES))? {
        Shape::Sphere => {
            only(&["radius"])?;
            Ok(shape::sphere(center()?, table.required("radius", Value::positive)?, SPHERE_LEVEL))
        }
        Shape::Box => {
            only(&["size"])?;
            Ok(shape::cuboid(center()?, table.required("size", edges)?))
        }
        Shape::Quad => {
            only(&["normal", "size"])?;
            let (u, v) = horizontal_frame(table.required("normal", Value::direction)?);
            let [width, height] = table.required("size", rectangle)?;
            Ok(shape::quad(center()?, u * (0.5 * width), v * (0.5 * height)))
        }
        Shape::Disk => {
            only(&["normal", "radius"])?;
            let normal = table.required("normal", Value::direction)?;
            Ok(shape::disk(center()?, normal, table.required("radius", Value::positive)?))
        }
    }
}

/// Three lengths, or one for a cube.
fn edges(value: &Value) -> Read<Vec3> {
    let size = if value.is_list() { value.vector()? } else { Vec3::splat(value.number()?) };
    if size.min_element() > 0.0 { Ok(size) } else { Err(value.error("must be greater than 0")) }
}
