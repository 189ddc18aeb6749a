//! `transform = { … }` of an object.

use glam::{Affine3A, DMat3, Mat3, Mat4, Vec3};

use super::document::{Read, Table, Value};

/// Keys: `scale` (number or three), `rotate` (degrees about x, then y, then z), `translate`; or
/// `matrix` (16 numbers, column-major).
pub fn transform(table: &Table) -> Read<Affine3A> {
    table.only(&["scale", "rotate", "translate", "matrix"])?;
    for key in ["scale", "rotate", "translate"] {
        table.exclusive(&[key, "matrix"])?;
    }
    let transform = match table.get("matrix") {
        Some(value) => matrix(&value)?,
        None => scale_rotate_translate(table)?,
    };
    if is_singular(&transform) {
        return Err(table.error("the transform is singular: it flattens the object"));
    }
    Ok(transform)
}

fn matrix(value: &Value) -> Read<Affine3A> {
    let matrix = Mat4::from_cols_array(&value.numbers()?);
    if matrix.row(3).to_array() != [0.0, 0.0, 0.0, 1.0] {
        return Err(value.error("the last row (numbers 4, 8, 12, 16) must be 0, 0, 0, 1"));
    }
    Ok(Affine3A::from_mat4(matrix))
}

/// v ↦ R_z·R_y·R_x·(scale∘v) + translate.
fn scale_rotate_translate(table: &Table) -> Read<Affine3A> {
    let either = |v: &Value| if v.is_list() { v.vector() } else { v.number().map(Vec3::splat) };
    let scale = table.optional("scale", either)?.unwrap_or(Vec3::ONE);
    let degrees = table.optional("rotate", Value::vector)?.unwrap_or(Vec3::ZERO);
    let translate = table.optional("translate", Value::vector)?.unwrap_or(Vec3::ZERO);
    let angle = degrees.as_dvec3().map(f64::to_radians);
    let rotation =
        DMat3::from_rotation_z(angle.z) * DMat3::from_rotation_y(angle.y) * DMat3::from_rotation_x(angle.x);
    Ok(Affine3A::from_mat3_translation(rotation.as_mat3() * Mat3::from_diagonal(scale), translate))
}

/// True if the images of the axes are linearly dependent up to a few roundings, whatever their
/// lengths, or if the inverse is out of range.
fn is_singular(transform: &Affine3A) -> bool {
    let axes = [transform.x_axis, transform.y_axis, transform.z_axis].map(|a| a.as_dvec3());
    let volume = axes[0].dot(axes[1].cross(axes[2])).abs();
    let edges: f64 = axes.iter().map(|a| a.length()).product();
    let dependent = volume <= 8.0 * f64::from(f32::EPSILON) * edges;
    dependent || !transform.inverse().is_finite()
}
