//! `--force`.

use std::path::Path;

use clap::Args;

use super::console::warn;
use super::error::CliError;
use crate::plan::fold::fold;
use crate::plan::{EffectKind, Forces};
use crate::raycast::{Geometry, RayCaster, RaycastError};
use crate::scene::{Scene, read_scene_with};
use crate::transport::{RenderOptions, Renderer};

/// Effects that are switched on or off.
#[derive(Args)]
pub struct ForceArgs {
    /// Switch an effect on or off, whatever the scene calls for, by a name that `alabaster plan` prints; may be given several times
    #[arg(long, value_name = "EFFECT=on|off", value_parser = wish)]
    force: Vec<(EffectKind, bool)>,
}

impl ForceArgs {
    /// All of them together.
    pub fn forces(&self) -> Result<Forces, CliError> {
        Ok(Forces::new(self.force.iter().copied())?)
    }

    /// Refuses to switch a method, where methods are what is compared.
    pub fn refuse_methods(&self) -> Result<(), CliError> {
        match self.force.iter().find(|(kind, _)| kind.is_method()) {
            None => Ok(()),
            Some((kind, _)) => {
                Err(CliError::input(format!("--force {}: name what to compare by --methods", kind.word())))
            }
        }
    }

    /// Reads a scene without what no effect that is on needs, and says what is strange about it.
    pub fn read_scene(&self, path: &Path) -> Result<Scene, CliError> {
        let forces = self.forces()?;
        let scene = read_scene_with(path, |scene| {
            fold(scene);
            Ok::<_, CliError>(forces.apply(scene)?)
        })?;
        warn(&scene.warnings);
        Ok(scene)
    }

    /// Makes `scene` ready to be sampled, and says what is strange about it then.
    pub fn renderer<C: RayCaster>(
        &self,
        scene: Scene,
        seed: u64,
        build: impl FnOnce(&Geometry) -> Result<C, RaycastError>,
    ) -> Result<Renderer<C>, CliError> {
        let options = RenderOptions { forces: self.forces()?, ..RenderOptions::of(&scene, seed) };
        let renderer = Renderer::new(scene, options, build)?;
        warn(&renderer.warnings());
        Ok(renderer)
    }
}

fn wish(text: &str) -> Result<(EffectKind, bool), String> {
    let (name, state) =
        text.split_once('=').ok_or("an effect and how to switch it are wanted, such as lens=off")?;
    let kind = EffectKind::of_name(name).ok_or_else(|| unknown(name))?;
    match state {
        "on" => Ok((kind, true)),
        "off" => Ok((kind, false)),
        _ => Err(format!("{} can be switched on or off, not \"{state}\"", kind.word())),
    }
}

fn unknown(name: &str) -> String {
    let names = EffectKind::ALL.map(EffectKind::word);
    format!("there is no effect \"{name}\"; the effects are {}", names.join(", "))
}
