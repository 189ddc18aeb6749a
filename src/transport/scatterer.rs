//! Translucent materials made ready: boundary, albedo and spread for each surrounding they can have.

use super::area_integral::Spread;
use crate::diffusion::NormalizedDiffusion;
use crate::medium::{Medium, PlanarAlbedo};
use crate::optics::boundary::Boundary;
use crate::radiometry::Rgb;
use crate::scene::{ScatteringInput, Scene, Surface};

/// A translucent material inside one surrounding medium.
struct Immersed {
    ior_around: f32,
    boundary: Boundary,
    planar: PlanarAlbedo,
    /// Albedo and shape parameter d where neither is textured.
    constant: Option<(Rgb, Rgb)>,
}

/// A translucent material, for every surrounding that the scene can give it.
pub struct Scatterer {
    input: ScatteringInput,
    /// The albedo of isotropic scattering without a boundary, by which normalized diffusion is
    /// parametrised.
    matched: PlanarAlbedo,
    immersed: Vec<Immersed>,
}

/// What a translucent surface does at a point.
pub struct Scattering<'a> {
    /// The boundary.
    pub boundary: &'a Boundary,
    /// Share of the light entered that leaves again, on a plane.
    pub albedo: Rgb,
    /// Profiles.
    pub spread: Spread,
}

impl Scatterer {
    /// Prepares a material of `scene`; `None` if it is not translucent.
    pub fn new(scene: &Scene, material: usize) -> Option<Self> {
        let Surface::Translucent { ior, roughness, medium } = &scene.materials[material].surface else {
            return None;
        };
        let mut around: Vec<f32> = vec![1.0];
        for other in &scene.materials {
            let ior = match &other.surface {
                Surface::Dielectric { ior, .. } => *ior,
                Surface::MetallicRoughness(m) => m.ior,
                _ => continue,
            };
            if !around.contains(&ior) {
                around.push(ior);
            }
        }
        let mut scatterer =
            Self { input: medium.clone(), matched: PlanarAlbedo::new(1.0, 0.0), immersed: Vec::new() };
        for ior_around in around {
            let eta = ior / ior_around;
            let mut immersed = Immersed {
                ior_around,
                boundary: Boundary::new(eta, roughness * roughness),
                planar: PlanarAlbedo::new(eta, medium.g()),
                constant: None,
            };
            immersed.constant = scatterer.constant(&immersed);
            scatterer.immersed.push(immersed);
        }
        Some(scatterer)
    }

    /// The material at a point of a body of the given diameter, inside a medium of index `ior_around`.
    /// `albedo` looks up the albedo where it is textured.
    pub fn at(
        &self,
        ior_around: f32,
        diameter: f32,
        albedo: impl FnOnce(&ScatteringInput) -> Rgb,
    ) -> Scattering<'_> {
        let immersed = self.immersed.iter().find(|i| i.ior_around == ior_around).unwrap_or(&self.immersed[0]);
        let (albedo, d) = immersed.constant.unwrap_or_else(|| self.resolve(immersed, albedo(&self.input)));
        Scattering { boundary: &immersed.boundary, albedo, spread: Spread::new(d, diameter) }
    }

    fn constant(&self, immersed: &Immersed) -> Option<(Rgb, Rgb)> {
        match &self.input {
            ScatteringInput::Albedo { albedo, .. } if albedo.texture.is_some() || albedo.vertex_color => None,
            ScatteringInput::Albedo { albedo, .. } => Some(self.resolve(immersed, albedo.factor)),
            ScatteringInput::Coefficients { .. } => Some(self.resolve(immersed, Rgb::ZERO)),
        }
    }

    /// Albedo and d; `wanted` is the reflectance asked for, where the input is one.
    fn resolve(&self, immersed: &Immersed, wanted: Rgb) -> (Rgb, Rgb) {
        match &self.input {
            ScatteringInput::Coefficients { sigma_a, sigma_s, g } => {
                let medium = Medium { sigma_a: *sigma_a, sigma_s: *sigma_s, g: *g };
                let absorbed = medium.absorbed_share_reduced();
                let free_path = medium.sigma_t_reduced().map(|t| 1.0 / t);
                (absorbed.map(|x| immersed.planar.albedo(x)), self.shape(absorbed, free_path))
            }
            ScatteringInput::Albedo { mean_free_path, g, .. } => {
                let albedo = wanted.map(|a| a.clamp(0.0, 1.0));
                let absorbed = albedo.map(|a| immersed.planar.absorbed_share(a));
                // With x = σ_a/σ_t' and σ_t = σ_a + σ_s,
                // σ_t/σ_t' = x + (1−x)/(1−g).
                let free_path = mean_free_path.zip(absorbed, |l, x| l * (x + (1.0 - x) / (1.0 - g)));
                (albedo, self.shape(absorbed, free_path))
            }
        }
    }

    /// Shape parameter d of normalized diffusion, from the reduced medium.
    fn shape(&self, absorbed: Rgb, free_path: Rgb) -> Rgb {
        absorbed.zip(free_path, |x, l| NormalizedDiffusion::from_albedo(self.matched.albedo(x), l).d)
    }
}
