//! What holds for every file: it is read to something that makes sense, or refused with a message of one person to another.

use std::fmt::Display;
use std::path::Path;

use alabaster::scene::environment::load_environment;
use alabaster::scene::error::printable;
use alabaster::scene::{Environment, Mesh, ScatteringInput, Scene, Surface, read_scene};
use alabaster::slab::read_mci;

/// Longest message, characters. Parts of the input may be in it, but not all of a long one.
const LONGEST_MESSAGE: usize = 2000;

/// True if the message can be shown; the error says what is wrong with it.
fn is_clear(message: &impl Display, name: &str) -> Result<bool, String> {
    let message = message.to_string();
    let problem = |what: &str| Err(format!("a message {what}: {message:?}"));
    if message.trim().is_empty() {
        return problem("without words");
    }
    if message.chars().count() > LONGEST_MESSAGE {
        return problem("without end");
    }
    // What a terminal would obey.
    if message.chars().any(|c| c.is_control() && c != '\n') {
        return problem("with control characters");
    }
    if !message.contains(name) {
        return problem("that does not name the file");
    }
    Ok(false)
}

/// A scene file or a model alone.
pub fn scene(path: &Path) -> Result<bool, String> {
    match read_scene(path) {
        Ok(scene) => {
            check_scene(&scene)?;
            // The console escapes what a terminal would obey.
            scene.warnings.iter().try_for_each(|warning| is_clear(&printable(warning), "").map(|_| ()))?;
            Ok(true)
        }
        Err(error) => is_clear(&error, "input."),
    }
}

/// A medium by wavelength, of a scene beside it.
pub fn medium(path: &Path) -> Result<bool, String> {
    const SCENE: &str = "object = [{ shape = 'sphere', center = [0, 0, 0], radius = 1, material = 'm' }]\n\
                         material.m = { type = 'translucent', spectrum = 'input.csv' }\n";
    let beside = path.with_file_name("medium.toml");
    std::fs::write(&beside, SCENE).map_err(|error| error.to_string())?;
    let scene = match read_scene(&beside) {
        Ok(scene) => scene,
        Err(error) => return is_clear(&error, "input.csv"),
    };
    let Surface::Translucent { ior, medium, .. } = &scene.materials[0].surface else {
        return Err("no translucent material".into());
    };
    let ScatteringInput::Spectral { sigma_a, sigma_s, g, table } = medium else {
        return Err("no medium by wavelength".into());
    };
    let is_coefficient = |coefficient: f64| coefficient >= 0.0 && coefficient.is_finite();
    let seen = sigma_a.0.iter().chain(&sigma_s.0).all(|&coefficient| is_coefficient(coefficient.into()));
    let holds = (360..=830).step_by(5).all(|nanometres| {
        let medium = table.similar(f64::from(nanometres), f64::from(*g));
        is_coefficient(medium.mu_a) && is_coefficient(medium.mu_s)
    });
    match seen && holds && g.abs() < 1.0 && *ior > 0.0 && ior.is_finite() {
        true => scene
            .warnings
            .iter()
            .try_for_each(|said| is_clear(&printable(said), "").map(|_| ()))
            .map(|()| true),
        false => Err(format!("a medium without sense: {ior} {medium:?}")),
    }
}

fn check_scene(scene: &Scene) -> Result<(), String> {
    scene.meshes.iter().try_for_each(check_mesh)?;
    let holds = |law: bool, what: &str| if law { Ok(()) } else { Err(format!("{what} out of range")) };
    for placed in &scene.instances {
        holds(placed.mesh < scene.meshes.len(), "mesh of an object")?;
        holds(placed.material < scene.materials.len(), "material of an object")?;
        holds(placed.transform.is_finite(), "placement of an object")?;
    }
    for texture in scene.materials.iter().flat_map(|material| material.textures()) {
        holds(texture < scene.textures.len(), "texture of a material")?;
    }
    for texture in &scene.textures {
        holds(texture.image < scene.images.len() && texture.coordinate_set < 2, "image of a texture")?;
    }
    holds(scene.film.width > 0 && scene.film.height > 0, "film")?;
    let camera = &scene.camera;
    holds(camera.position.is_finite() && camera.target.is_finite() && camera.up.is_finite(), "camera")?;
    scene.environment.as_ref().map_or(Ok(()), check_environment)
}

fn check_mesh(mesh: &Mesh) -> Result<(), String> {
    let count = mesh.positions.len();
    let fits = |length: usize| length == 0 || length == count;
    let [first, second] = &mesh.texture_coordinates;
    let lengths = [mesh.normals.len(), mesh.tangents.len(), mesh.colors.len(), first.len(), second.len()];
    if !lengths.into_iter().all(fits) {
        return Err(format!("attributes {lengths:?} of {count} vertices"));
    }
    if !mesh.triangles.iter().flatten().all(|&vertex| (vertex as usize) < count) {
        return Err("vertex of a triangle out of range".into());
    }
    if !mesh.positions.iter().all(|position| position.is_finite()) {
        return Err("position that is no number".into());
    }
    Ok(())
}

/// An environment map.
pub fn environment(path: &Path) -> Result<bool, String> {
    let mut warnings = Vec::new();
    match load_environment(path, 1.0, 0.3, &mut warnings) {
        Ok(environment) => check_environment(&environment).map(|()| true),
        Err(error) => is_clear(&error, "input."),
    }
}

fn check_environment(environment: &Environment) -> Result<(), String> {
    let Environment::Map { width, height, radiance, .. } = environment else { return Ok(()) };
    if width * height != radiance.len() || radiance.is_empty() {
        return Err(format!("{width} × {height} pixels, but {}", radiance.len()));
    }
    match radiance.iter().all(|pixel| pixel.is_finite() && pixel.0.iter().all(|x| *x >= 0.0)) {
        true => Ok(()),
        false => Err("radiance that is none".into()),
    }
}

/// An input file of MCML.
pub fn layers(path: &Path) -> Result<bool, String> {
    match read_mci(path) {
        Ok(runs) => match runs.iter().all(|run| run.photons > 0 && run.grid.radial > 0) && !runs.is_empty() {
            true => Ok(true),
            false => Err(format!("runs without sense: {runs:?}")),
        },
        // Whoever calls names the file.
        Err(error) => is_clear(&error, ""),
    }
}
