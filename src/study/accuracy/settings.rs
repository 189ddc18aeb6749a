//! What a study was asked for: all on which its figures depend.

use std::fmt::{self, Write};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::candidate::Candidate;
use crate::scene::{FilmSettings, RenderSettings, Scene, SubsurfaceSettings};

/// Settings of a study. Another study in the same directory goes on with what is there only if all are the same.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Version of the program.
    pub version: String,
    /// [`digest`] of the scene.
    pub scene: String,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Seconds for all of it.
    pub time: f64,
    /// Independent runs of each candidate.
    pub seeds: usize,
    /// Names of the candidates.
    pub methods: Vec<String>,
    /// Name of the candidate that is the reference.
    pub reference: String,
    /// Seed of all random numbers.
    pub seed: u64,
    /// What casts the rays.
    pub backend: String,
    /// Threads.
    pub threads: usize,
}

impl Settings {
    /// The candidates.
    pub fn candidates(&self) -> impl Iterator<Item = Candidate> {
        Candidate::ALL.into_iter().filter(|candidate| self.methods.contains(&candidate.name()))
    }

    /// The candidate that is the reference.
    pub fn reference(&self) -> Candidate {
        let named = |candidate: &Candidate| candidate.name() == self.reference;
        Candidate::ALL.into_iter().find(named).unwrap_or(Candidate::WALK)
    }

    /// What differs from `other`, in words.
    pub fn differences(&self, other: &Self) -> Vec<String> {
        let fields = |settings: &Self| match serde_json::to_value(settings) {
            Ok(Value::Object(fields)) => fields,
            _ => serde_json::Map::new(),
        };
        let (ours, theirs) = (fields(self), fields(other));
        let differs = |(name, value): (&String, &Value)| {
            let there = theirs.get(name).unwrap_or(&Value::Null);
            match name.as_str() {
                _ if there == value => None,
                "scene" => Some("the scene".into()),
                name => Some(format!("{name} ({there} there, {value} now)")),
            }
        };
        ours.iter().filter_map(differs).collect()
    }
}

/// A number for what is in `scene`, whatever its resolution, its samples and the method that it asks for: FNV-1a (Fowler, Noll
/// and Vo 1991) of all its values in words.
pub fn digest(scene: &Scene) -> String {
    let mut scene = scene.clone();
    scene.film = FilmSettings { filter: scene.film.filter, ..FilmSettings::default() };
    scene.subsurface = SubsurfaceSettings::default();
    scene.render = RenderSettings { spp: 0, ..scene.render };
    let mut hash = Fnv(0xcbf2_9ce4_8422_2325);
    // It never fails.
    let _ = write!(hash, "{scene:?}");
    format!("{:016x}", hash.0)
}

struct Fnv(u64);

impl Write for Fnv {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
        Ok(())
    }
}

/// The size at which a scene of `width` × `height` pixels is studied if nothing else is asked for: the longer side
/// has at most [`LONGER_SIDE`] pixels.
pub fn affordable(width: u32, height: u32) -> (u32, u32) {
    let longer = width.max(height);
    if longer <= LONGER_SIDE {
        return (width, height);
    }
    let scaled =
        |side: u32| (f64::from(side) * f64::from(LONGER_SIDE) / f64::from(longer)).round().max(1.0) as u32;
    (scaled(width), scaled(height))
}

/// Pixels on the longer side of a study: relative errors and their cost per pixel do not depend on the resolution much, and
/// every picture is rendered a hundred times.
pub const LONGER_SIDE: u32 = 128;

#[cfg(test)]
mod tests {
    use super::*;

    fn settings() -> Settings {
        Settings {
            version: "1".into(),
            scene: digest(&Scene::default()),
            width: 32,
            height: 16,
            time: 10.0,
            seeds: 4,
            methods: vec!["diffuse".into(), "walk".into()],
            reference: "walk".into(),
            seed: 0,
            backend: "bvh".into(),
            threads: 2,
        }
    }

    #[test]
    fn what_differs_is_named() {
        let here = settings();
        assert!(here.differences(&here.clone()).is_empty());
        let there = Settings { seeds: 16, scene: "0".into(), ..settings() };
        let differences = here.differences(&there);
        assert_eq!(differences, ["the scene", "seeds (16 there, 4 now)"]);
    }

    #[test]
    fn the_digest_is_of_what_is_in_the_scene() {
        let (mut a, mut b) = (Scene::default(), Scene::default());
        a.film.width = 7;
        a.subsurface.method = crate::scene::Method::Walk;
        assert_eq!(digest(&a), digest(&b));
        b.render.max_depth = 3;
        assert_ne!(digest(&a), digest(&b));
    }

    #[test]
    fn large_pictures_are_made_smaller_in_proportion() {
        assert_eq!(affordable(100, 30), (100, 30));
        assert_eq!(affordable(512, 256), (128, 64));
        assert_eq!(affordable(3, 60_000), (1, 128));
    }
}
