//! A TOML document whose every value knows its line and key path, with typed getters that say both
//! when something is wrong.

use std::path::Path;

use glam::Vec3;
use toml::de::{DeTable, DeValue};

use crate::radiometry::{Rgb, Spectrum};
use crate::scene::SceneError;

/// A TOML file and its text.
#[derive(Debug)]
pub struct Source<'a> {
    /// The file.
    pub path: &'a Path,
    /// What is in it.
    pub text: &'a str,
}

/// A table of the document.
#[derive(Debug)]
pub struct Table<'a> {
    source: &'a Source<'a>,
    /// Key path: `object[0].transform`; empty for the document itself.
    path: String,
    offset: usize,
    entries: &'a DeTable<'a>,
}

/// A value of the document.
#[derive(Clone, Debug)]
pub struct Value<'a> {
    source: &'a Source<'a>,
    path: String,
    offset: usize,
    value: &'a DeValue<'a>,
}

/// The result of reading one value.
pub type Read<T> = Result<T, SceneError>;

impl Source<'_> {
    /// An error at byte `offset`, in the value at `key_path`.
    pub fn error(&self, offset: usize, key_path: &str, problem: impl Into<String>) -> SceneError {
        let line = 1 + self.text.bytes().take(offset).filter(|&b| b == b'\n').count();
        let separator = if key_path.is_empty() { "" } else { ", " };
        SceneError::at(self.path, format!("line {line}{separator}{key_path}"), problem)
    }
}

impl<'a> Table<'a> {
    /// The whole document.
    pub fn root(source: &'a Source<'a>, entries: &'a DeTable<'a>) -> Self {
        Self { source, path: String::new(), offset: 0, entries }
    }

    /// An error about the table as a whole.
    pub fn error(&self, problem: impl Into<String>) -> SceneError {
        self.source.error(self.offset, &self.path, problem)
    }

    /// The file that the table stands in.
    pub fn file(&self) -> &'a Path {
        self.source.path
    }

    /// Refuses keys that are not in `known`.
    pub fn only(&self, known: &[&str]) -> Read<()> {
        for key in self.entries.keys() {
            let name = key.get_ref().as_ref();
            if !known.contains(&name) {
                let problem = format!("unknown key `{name}`; {}", remedy(name, known));
                return Err(self.source.error(key.span().start, &self.key_path(name), problem));
            }
        }
        Ok(())
    }

    /// The value of `key`, if it is there.
    pub fn get(&self, key: &str) -> Option<Value<'a>> {
        self.entries.get(key).map(|value| Value {
            source: self.source,
            path: self.key_path(key),
            offset: value.span().start,
            value: value.get_ref(),
        })
    }

    /// True if `key` is there.
    pub fn has(&self, key: &str) -> bool {
        self.entries.contains_key(key)
    }

    /// All keys and values.
    pub fn iter(&self) -> impl Iterator<Item = (&'a str, Value<'a>)> {
        self.entries.keys().filter_map(|key| {
            let name = key.get_ref().as_ref();
            self.get(name).map(|value| (name, value))
        })
    }

    /// The value of `key` as `read` understands it, if it is there.
    pub fn optional<T>(&self, key: &str, read: impl FnOnce(&Value<'a>) -> Read<T>) -> Read<Option<T>> {
        self.get(key).map(|value| read(&value)).transpose()
    }

    /// The value of `key` as `read` understands it.
    pub fn required<T>(&self, key: &str, read: impl FnOnce(&Value<'a>) -> Read<T>) -> Read<T> {
        match self.get(key) {
            Some(value) => read(&value),
            None => Err(self.error(format!("the key `{key}` is missing"))),
        }
    }

    /// Refuses more than one of `keys`, which mean the same thing in different ways.
    pub fn exclusive(&self, keys: &[&str]) -> Read<()> {
        let mut present = keys.iter().filter_map(|key| self.get(key));
        match (present.next(), present.next()) {
            (Some(first), Some(second)) => {
                let problem = format!("excludes `{}`: give one of the two", first.key());
                Err(second.error(problem))
            }
            _ => Ok(()),
        }
    }

    fn key_path(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }
}

impl<'a> Value<'a> {
    /// An error about this value.
    pub fn error(&self, problem: impl Into<String>) -> SceneError {
        self.source.error(self.offset, &self.path, problem)
    }

    /// The last key of the path.
    fn key(&self) -> &str {
        self.path.rsplit('.').next().unwrap_or_default()
    }

    fn expected(&self, what: &str) -> SceneError {
        self.error(format!("expected {what}, found {}", kind(self.value)))
    }

    /// A finite number.
    pub fn number(&self) -> Read<f32> {
        let number = self.precise()? as f32;
        if number.is_finite() { Ok(number) } else { Err(self.not_finite()) }
    }

    /// A finite number in double precision.
    pub fn precise(&self) -> Read<f64> {
        let value = match self.value {
            DeValue::Integer(i) => i64::from_str_radix(i.as_str(), i.radix()).ok().map(|i| i as f64),
            DeValue::Float(f) => f.as_str().parse().ok(),
            _ => return Err(self.expected("a number")),
        };
        value.filter(|x: &f64| x.is_finite()).ok_or_else(|| self.not_finite())
    }

    fn not_finite(&self) -> SceneError {
        self.error("must be a finite number")
    }

    /// A number greater than 0.
    pub fn positive(&self) -> Read<f32> {
        self.number_where(|x| x > 0.0, "greater than 0")
    }

    /// A number from 0 upwards.
    pub fn not_negative(&self) -> Read<f32> {
        self.number_where(|x| x >= 0.0, "0 or more")
    }

    /// A number from 0 to 1.
    pub fn fraction(&self) -> Read<f32> {
        self.number_where(|x| (0.0..=1.0).contains(&x), "from 0 to 1")
    }

    /// A number for which `valid` holds; `range` completes "must be …".
    pub fn number_where(&self, valid: impl Fn(f32) -> bool, range: &str) -> Read<f32> {
        let number = self.number()?;
        if valid(number) { Ok(number) } else { Err(self.out_of_range(number, range)) }
    }

    /// A whole number from `low` to `high`.
    pub fn whole(&self, low: u32, high: u32) -> Read<u32> {
        let DeValue::Integer(i) = self.value else { return Err(self.expected("a whole number")) };
        let number = i64::from_str_radix(i.as_str(), i.radix()).ok().and_then(|i| u32::try_from(i).ok());
        number
            .filter(|n| (low..=high).contains(n))
            .ok_or_else(|| self.error(format!("must be a whole number from {low} to {high}, not {i}")))
    }

    /// Three finite numbers.
    pub fn vector(&self) -> Read<Vec3> {
        self.numbers().map(Vec3::from_array)
    }

    /// Three finite numbers, not all 0, made a unit vector.
    pub fn direction(&self) -> Read<Vec3> {
        self.vector()?.try_normalize().ok_or_else(|| self.error("a direction needs a length"))
    }

    /// Exactly `N` finite numbers.
    pub fn numbers<const N: usize>(&self) -> Read<[f32; N]> {
        self.list(Self::number)
    }

    /// Exactly `N` finite numbers in double precision.
    pub fn precise_numbers<const N: usize>(&self) -> Read<[f64; N]> {
        self.list(Self::precise)
    }

    fn list<T: Copy + Default, const N: usize>(&self, read: impl Fn(&Self) -> Read<T>) -> Read<[T; N]> {
        let items = self.items().map_err(|_| self.expected(&format!("a list of {N} numbers")))?;
        if items.len() != N {
            return Err(self.error(format!("expected {N} numbers, found {}", items.len())));
        }
        let mut numbers = [T::default(); N];
        for (number, item) in numbers.iter_mut().zip(&items) {
            *number = read(item)?;
        }
        Ok(numbers)
    }

    /// A colour or coefficient of at least 0: red, green and blue, or one number for all three.
    pub fn rgb(&self) -> Read<Rgb> {
        self.rgb_where(|x| x >= 0.0, "0 or more")
    }

    /// A colour or coefficient from 0 to 1: red, green and blue, or one number for all three.
    pub fn rgb_fraction(&self) -> Read<Rgb> {
        self.rgb_where(|x| (0.0..=1.0).contains(&x), "from 0 to 1")
    }

    /// Red, green and blue, or one number for all three, each of which is `valid`; `range`
    /// completes "must be …".
    pub fn rgb_where(&self, valid: impl Fn(f32) -> bool, range: &str) -> Read<Rgb> {
        let channels = match self.value {
            DeValue::Array(_) => Spectrum(self.numbers()?),
            _ => Rgb::splat(self.number()?),
        };
        match channels.0.iter().find(|x| !valid(**x)) {
            Some(&x) => Err(self.out_of_range(x, range)),
            None => Ok(channels),
        }
    }

    fn out_of_range(&self, number: f32, range: &str) -> SceneError {
        self.error(format!("must be {range}, not {number}"))
    }

    /// Text.
    pub fn text(&self) -> Read<&'a str> {
        match self.value {
            DeValue::String(text) => Ok(text.as_ref()),
            _ => Err(self.expected("text in quotes")),
        }
    }

    /// True or false.
    pub fn boolean(&self) -> Read<bool> {
        match self.value {
            DeValue::Boolean(value) => Ok(*value),
            _ => Err(self.expected("true or false")),
        }
    }

    /// One of some names.
    pub fn choice<T: Copy>(&self, choices: &[(&'static str, T)]) -> Read<T> {
        let name = self.text()?;
        if let Some((_, choice)) = choices.iter().find(|(known, _)| *known == name) {
            return Ok(*choice);
        }
        let known: Vec<&str> = choices.iter().map(|(known, _)| *known).collect();
        Err(self.error(format!("there is no `{name}`; {}", remedy(name, &known))))
    }

    /// A path, relative to the folder of the document, to a file that exists.
    pub fn existing_file(&self) -> Read<std::path::PathBuf> {
        let folder = self.source.path.parent().unwrap_or(Path::new(""));
        let path = folder.join(self.text()?);
        if path.is_file() {
            Ok(path)
        } else {
            Err(self.error(format!("there is no file {}", path.display())))
        }
    }

    /// A table.
    pub fn table(&self) -> Read<Table<'a>> {
        match self.value {
            DeValue::Table(entries) => {
                Ok(Table { source: self.source, path: self.path.clone(), offset: self.offset, entries })
            }
            _ => Err(self.expected("a table")),
        }
    }

    /// The tables of an array of tables.
    pub fn tables(&self) -> Read<Vec<Table<'a>>> {
        let items = self.items().map_err(|_| self.expected(&format!("[[{}]]", self.path)))?;
        items.iter().map(Value::table).collect()
    }

    /// True for an array.
    pub fn is_list(&self) -> bool {
        self.value.is_array()
    }

    fn items(&self) -> Read<Vec<Value<'a>>> {
        let DeValue::Array(items) = self.value else { return Err(self.expected("a list")) };
        let item = |(i, item): (usize, &'a toml::Spanned<DeValue<'a>>)| Value {
            source: self.source,
            path: format!("{}[{i}]", self.path),
            offset: item.span().start,
            value: item.get_ref(),
        };
        Ok(items.iter().enumerate().map(item).collect())
    }
}

fn kind(value: &DeValue) -> &'static str {
    match value {
        DeValue::String(_) => "text",
        DeValue::Integer(_) => "a whole number",
        DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}

/// What to write instead of `name`: the most similar of the known names, or all of them.
pub fn remedy(name: &str, known: &[&str]) -> String {
    let typos = |k: &str| strsim::damerau_levenshtein(&name.to_lowercase(), k);
    let nearest = known.iter().min_by_key(|k| typos(k)).filter(|k| typos(k) <= 1.max(k.len() / 3));
    match nearest {
        Some(nearest) => format!("did you mean `{nearest}`?"),
        None if known.is_empty() => "none is defined".to_owned(),
        None => format!("known: {}", known.join(", ")),
    }
}
