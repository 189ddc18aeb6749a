//! The index of refraction of a clear material, and how it depends on the wavelength.

use super::document::{Read, Table, Value};
use crate::radiometry::spectrum::dispersion::{Dispersion, DispersionError, FRAUNHOFER_LINES};

/// Keys of [`refraction`].
pub const REFRACTION_KEYS: [&str; 4] = ["ior", "abbe", "cauchy", "sellmeier"];

/// Ways to give a dispersion, which exclude each other.
const WAYS: [&str; 3] = ["abbe", "cauchy", "sellmeier"];

/// How far `ior` may be from the index at the line d that coefficients give: half of the third place.
const SAME: f64 = 5e-4;

/// The index at the line d (587.56 nm) and the dispersion, if there is one.
///
/// Keys: `ior` (1.5), with `abbe` = (n_d − 1)/(n_F − n_C) or without; or, in place of both, `cauchy` = [A, B, C] of
/// n = A + B/λ² + C/λ⁴ with λ in nm, or `sellmeier` = { b = [B₁, B₂, B₃], c = [C₁, C₂, C₃] } of n² = 1 + Σ Bᵢ λ²/(λ² − Cᵢ)
/// with λ in µm, as data sheets of glasses have them.
pub fn refraction(table: &Table) -> Read<(f32, Option<Dispersion>)> {
    table.exclusive(&WAYS)?;
    let given = table.optional("ior", Value::positive)?;
    let ior = given.unwrap_or(1.5);
    let Some(value) = WAYS.iter().find_map(|key| table.get(key)) else { return Ok((ior, None)) };
    let refused = |error: DispersionError| value.error(error.to_string());
    if table.has("abbe") {
        let dispersion = Dispersion::from_abbe(ior.into(), value.precise()?).map_err(refused)?;
        return Ok((ior, Some(dispersion)));
    }
    let dispersion = match table.has("cauchy") {
        true => Dispersion::cauchy(value.precise_numbers()?),
        false => {
            let coefficients = value.table()?;
            coefficients.only(&["b", "c"])?;
            let list = |key| coefficients.required(key, Value::precise_numbers);
            Dispersion::sellmeier(list("b")?, list("c")?)
        }
    };
    let dispersion = dispersion.map_err(refused)?;
    let computed = dispersion.ior(FRAUNHOFER_LINES[1]);
    match table.get("ior") {
        Some(value) if (f64::from(ior) - computed).abs() > SAME => Err(value.error(format!(
            "{ior} contradicts the coefficients of the dispersion, by which it is {computed:.4}; leave it out"
        ))),
        _ => Ok((computed as f32, Some(dispersion))),
    }
}
