//! Mutations that leave a file well formed, so that they get past the parser.

use gltf::binary::{Glb, Header};
use rand::RngExt;
use rand_pcg::Pcg64;
use serde_json::{Value, json};

use super::mutation;
use super::seeds::Seed;

/// A document with changed values, in the shell that it had; `None` if `seed` is none.
pub fn mutated(seed: &Seed, random: &mut Pcg64) -> Option<Vec<u8>> {
    match seed.ending() {
        "gltf" => Some(changed_json(&seed.bytes, random)?),
        "glb" => {
            let mut glb = Glb::from_slice(&seed.bytes).ok()?;
            if random.random_bool(0.8) {
                glb.json = changed_json(&glb.json, random)?.into();
            } else {
                let mut binary = glb.bin.take()?.into_owned();
                let other = binary.clone();
                mutation::mutate(&mut binary, &other, random);
                glb.bin = Some(binary.into());
            }
            glb.header = Header { magic: *b"glTF", version: 2, length: 0 };
            glb.to_vec().ok()
        }
        "toml" => {
            let document = toml::from_str(std::str::from_utf8(&seed.bytes).ok()?).ok()?;
            Some(toml::to_string(&changed(document, random)?).ok()?.into_bytes())
        }
        _ => None,
    }
}

fn changed_json(document: &[u8], random: &mut Pcg64) -> Option<Vec<u8>> {
    Some(changed(serde_json::from_slice(document).ok()?, random)?.to_string().into_bytes())
}

fn changed(mut document: Value, random: &mut Pcg64) -> Option<Value> {
    for _ in 0..random.random_range(1..=4) {
        let count = count(&document);
        let donor = node(&mut document, &mut random.random_range(0..count))?.clone();
        let place = node(&mut document, &mut random.random_range(0..count))?;
        change(place, donor, random);
    }
    Some(document)
}

/// Values in a tree, the branches included.
fn count(value: &Value) -> usize {
    1 + match value {
        Value::Array(items) => items.iter().map(count).sum(),
        Value::Object(fields) => fields.values().map(count).sum(),
        _ => 0,
    }
}

/// The value that comes after `index` others, in depth-first order.
fn node<'a>(value: &'a mut Value, index: &mut usize) -> Option<&'a mut Value> {
    if *index == 0 {
        return Some(value);
    }
    *index -= 1;
    match value {
        Value::Array(items) => items.iter_mut().find_map(|item| node(item, index)),
        Value::Object(fields) => fields.values_mut().find_map(|field| node(field, index)),
        _ => None,
    }
}

fn change(value: &mut Value, donor: Value, random: &mut Pcg64) {
    match (random.random_range(0..6), &mut *value) {
        (0, Value::Array(items)) if !items.is_empty() => {
            let index = random.random_range(0..items.len());
            if random.random_bool(0.5) {
                items.remove(index);
            } else {
                items.insert(index, items[index].clone());
            }
        }
        (0 | 1, Value::Object(fields)) if !fields.is_empty() => {
            let key = fields.keys().nth(random.random_range(0..fields.len())).cloned().unwrap();
            let removed = fields.remove(&key);
            if random.random_bool(0.3)
                && let Some(removed) = removed
            {
                fields.insert(format!("{key}_"), removed);
            }
        }
        (2, _) => *value = donor,
        (3, Value::Number(number)) => {
            let near = number.as_f64().unwrap_or(0.0) + [-1.0, 1.0, 0.5][random.random_range(0..3)];
            *value = if near.fract() == 0.0 { json!(near as i64) } else { json!(near) };
        }
        _ => *value = extreme(random),
    }
}

/// A value that is hardly expected.
fn extreme(random: &mut Pcg64) -> Value {
    match random.random_range(0..10) {
        0 => Value::Null,
        1 => json!([]),
        2 => json!({}),
        3 => json!(""),
        4 => json!(true),
        5 => json!("\u{1b}[2Jx\n\u{7}"),
        _ => {
            let number = mutation::NUMBERS[random.random_range(0..mutation::NUMBERS.len())];
            serde_json::from_str(number).unwrap_or_else(|_| json!(number))
        }
    }
}
