//! What was made ready for a scene: what no effect needs is not.

use super::renderer::Renderer;
use super::scatterer::Immersed;
use crate::raycast::RayCaster;
use crate::scene::texture::Pixels;

/// Counts of what is held in memory beside triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Inventory {
    /// Pixels of decoded images, beside the single ones that stand for unused images.
    pub pixels: usize,
    /// Vertex tangents.
    pub tangents: usize,
    /// Vertex texture coordinates.
    pub texture_coordinates: usize,
    /// Vertex colours.
    pub colors: usize,
    /// Translucent materials.
    pub scatterers: usize,
    /// Tables of profiles.
    pub profile_tables: usize,
    /// Boundaries of walks.
    pub interfaces: usize,
    /// Guides of walks.
    pub guides: usize,
    /// Laws of steps on spheres.
    pub sphere_steps: usize,
    /// Grids of free space.
    pub clearances: usize,
    /// Emitters that light is drawn from.
    pub emitters: usize,
}

impl<C: RayCaster> Renderer<C> {
    /// What was made ready.
    pub fn inventory(&self) -> Inventory {
        let scene = self.scene();
        let pixels = scene.images.iter().map(|image| match &image.pixels {
            Pixels::Rgba8(pixels) => pixels.len(),
            Pixels::Rgba16(pixels) => pixels.len(),
            Pixels::Encoded(_) => 0,
        });
        let vertices = |count: fn(&crate::scene::Mesh) -> usize| scene.meshes.iter().map(count).sum();
        let immersed = || self.scatterers.iter().flatten().flat_map(|scatterer| scatterer.all_immersed());
        let having = |has: fn(&Immersed) -> bool| immersed().filter(|immersed| has(immersed)).count();
        Inventory {
            pixels: pixels.filter(|&count| count > 1).sum(),
            tangents: vertices(|mesh| mesh.tangents.len()),
            texture_coordinates: vertices(|mesh| mesh.texture_coordinates.iter().map(Vec::len).sum()),
            colors: vertices(|mesh| mesh.colors.len()),
            scatterers: self.scatterers.iter().flatten().count(),
            profile_tables: having(Immersed::has_table),
            interfaces: having(|immersed| immersed.interface().is_some()),
            guides: having(Immersed::has_guide),
            sphere_steps: having(|immersed| immersed.spheres().is_some()),
            clearances: self.clearance_count(),
            emitters: self.lights.emitter_count(),
        }
    }
}
