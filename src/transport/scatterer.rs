//! Translucent materials made ready: boundary, albedo and profile for each surrounding they can have.

use thiserror::Error;

use super::form::{Form, FormError, profile_kind};
use super::guide::Guide;
use super::spheres::Spheres;
use super::spread::{Spread, Spreading, resolvable};
use crate::diffusion::{DirectionalWeightTable, HalfSpaceError, ModelKind, NormalizedDiffusion, ProfileKind};
use crate::medium::albedo_inversion::unreduced_share;
use crate::medium::{Medium, PlanarAlbedo};
use crate::optics::{Boundary, Interface, fresnel_dielectric};
use crate::radiometry::Rgb;
use crate::scene::{ScatteringInput, Scene, Surface};

/// A material has no such profile.
#[derive(Debug, Error)]
#[error("material \"{material}\": {problem}")]
pub struct ScattererError {
    /// Name of the material.
    pub material: String,
    /// What is wrong.
    pub problem: FormError,
}

/// A translucent material inside one surrounding medium.
pub struct Immersed {
    ior_around: f32,
    boundary: Boundary,
    /// The boundary for walks.
    interface: Option<Interface>,
    planar: PlanarAlbedo,
    kind: ProfileKind,
    form: Form,
    /// Where nothing is textured.
    constant: Option<Local>,
    /// Steps of walks on spheres, where they have been prepared.
    spheres: Option<Spheres>,
    /// Of walks in the medium where nothing is textured, and the medium.
    guide: Option<(Medium, Option<Guide>)>,
}

/// The medium at a point.
#[derive(Clone, Copy, Debug)]
pub struct Local {
    /// Share of the light entered that leaves again, on a plane.
    pub albedo: Rgb,
    /// 1 − α': share absorbed at a collision of the reduced medium.
    pub absorbed: Rgb,
    /// The scale of the profiles, m: the shape parameter d of normalized diffusion, the reduced mean free path
    /// 1/σ_t' of all others.
    pub length: Rgb,
}

/// What a translucent material is prepared for.
#[derive(Clone, Copy, Debug)]
pub struct Uses {
    /// The profile asked for; `None`: the best one.
    pub profile: Option<ProfileKind>,
    /// Paths walk in bodies of the material.
    pub walked: bool,
    /// Paths walk in some body of the scene, so that it can be inside of any.
    pub walks: bool,
}

/// A translucent material, for every surrounding that the scene can give it.
pub struct Scatterer {
    input: ScatteringInput,
    immersed: Vec<Immersed>,
}

/// What a translucent surface does at a point.
pub struct Scattering<'a> {
    /// The boundary.
    pub boundary: &'a Boundary,
    /// The medium, its length such as the body can resolve.
    pub local: Local,
    /// Profiles.
    pub spreading: Spreading<'a>,
}

impl Immersed {
    fn new(
        ior_around: f32,
        eta: f32,
        roughness: f32,
        medium: &ScatteringInput,
        kind: ProfileKind,
    ) -> Result<Self, HalfSpaceError> {
        let boundary = Boundary::new(eta, roughness * roughness);
        let form = Form::new(kind, &boundary, f64::from(medium.g()))?;
        let planar = PlanarAlbedo::new(eta, medium.g());
        Ok(Self {
            ior_around,
            boundary,
            interface: None,
            planar,
            kind,
            form,
            constant: None,
            spheres: None,
            guide: None,
        })
    }

    /// The boundary.
    pub fn boundary(&self) -> &Boundary {
        &self.boundary
    }

    /// The boundary, where paths walk inside.
    pub fn interface(&self) -> Option<&Interface> {
        self.interface.as_ref()
    }

    /// Steps of walks on spheres, if they have been prepared and the medium has them.
    pub fn spheres(&self) -> Option<&Spheres> {
        self.spheres.as_ref()
    }

    /// The guide of walks in `medium`, if they are worth to be guided.
    pub fn guide(&self, medium: &Medium) -> Option<Guide> {
        match &self.guide {
            Some((prepared, guide)) if prepared == medium => *guide,
            _ => self.new_guide(medium),
        }
    }

    fn new_guide(&self, medium: &Medium) -> Option<Guide> {
        Guide::new(medium, &self.planar, fresnel_dielectric(1.0, self.boundary.eta()).reflectance)
    }

    /// True if profiles are tabulated for it.
    pub fn has_table(&self) -> bool {
        matches!(self.form, Form::Shaped { .. })
    }

    /// True if a guide of walks is prepared.
    pub fn has_guide(&self) -> bool {
        self.guide.as_ref().is_some_and(|(_, guide)| guide.is_some())
    }

    /// The dependence of the profile on the direction of entry, if it has one.
    pub fn directional(&self) -> Option<&DirectionalWeightTable> {
        match &self.form {
            Form::Normalized => None,
            Form::Shaped { directional, .. } => directional.as_ref(),
        }
    }
}

impl Scatterer {
    /// Prepares a material of `scene` for its `uses`; `None` if it is not translucent.
    ///
    /// # Errors
    /// If the material has no such profile. In surroundings that it may not be in at all another one takes its place.
    pub fn new(scene: &Scene, material: usize, uses: &Uses) -> Result<Option<Self>, ScattererError> {
        let Surface::Translucent { ior, roughness, medium } = &scene.materials[material].surface else {
            return Ok(None);
        };
        let failed = |problem| ScattererError { material: scene.materials[material].name.clone(), problem };
        let mut around: Vec<f32> = vec![1.0];
        for other in &scene.materials {
            let ior = match &other.surface {
                Surface::Dielectric { ior, .. } => *ior,
                Surface::MetallicRoughness(m) => m.ior,
                Surface::Translucent { ior, .. } if uses.walks => *ior,
                _ => continue,
            };
            if !around.contains(&ior) {
                around.push(ior);
            }
        }
        let mut scatterer = Self { input: medium.clone(), immersed: Vec::new() };
        let g = f64::from(medium.g());
        for ior_around in around {
            let eta = f64::from(ior / ior_around);
            let kind = match profile_kind(uses.profile, eta, g) {
                Err(FormError::NotTabulated { .. }) if !scatterer.immersed.is_empty() => {
                    ProfileKind::Model(ModelKind::PhotonBeam)
                }
                kind => kind.map_err(failed)?,
            };
            let immersed = Immersed::new(ior_around, eta as f32, *roughness, medium, kind);
            let mut immersed = immersed.map_err(|problem| failed(problem.into()))?;
            immersed.interface = uses.walked.then(|| Interface::new(eta as f32, roughness * roughness));
            immersed.constant = scatterer.constant(&immersed);
            if let Some(local) = immersed.constant.filter(|_| uses.walked) {
                let medium = scatterer.medium_of(&local);
                immersed.guide = Some((medium, immersed.new_guide(&medium)));
            }
            scatterer.immersed.push(immersed);
        }
        Ok(Some(scatterer))
    }

    /// Prepares the steps of walks on spheres, where nothing is textured: some 100 µs and 150 kB for each surrounding.
    /// With `similarity`, also those of anisotropic media.
    pub fn prepare_spheres(&mut self, similarity: bool) {
        for i in 0..self.immersed.len() {
            let medium = self.immersed[i].constant.map(|local| self.medium_of(&local));
            self.immersed[i].spheres = medium.and_then(|medium| Spheres::new(medium, similarity));
        }
    }

    /// The profiles that it may use.
    pub fn profiles(&self) -> impl Iterator<Item = ProfileKind> {
        self.immersed.iter().map(|immersed| immersed.kind)
    }

    /// For all surroundings.
    pub fn all_immersed(&self) -> &[Immersed] {
        &self.immersed
    }

    /// Leaves out what profiles leave to the direction of entry.
    pub fn forget_direction_of_entry(&mut self) {
        for immersed in &mut self.immersed {
            if let Form::Shaped { directional, .. } = &mut immersed.form {
                *directional = None;
            }
        }
    }

    /// The material at a point of a body of the given diameter, inside a medium of index `ior_around`.
    /// `albedo` looks up the albedo where it is textured.
    pub fn at(
        &self,
        ior_around: f32,
        diameter: f32,
        albedo: impl FnOnce(&ScatteringInput) -> Rgb,
    ) -> Scattering<'_> {
        let immersed = self.immersed(ior_around);
        let mut local = self.local_in(immersed, albedo);
        local.length = local.length.map(|length| resolvable(length, diameter));
        let spreading = match &immersed.form {
            Form::Normalized => Spreading::Normalized(Spread::new(
                local.length.0.map(|d| NormalizedDiffusion { d }),
                diameter,
            )),
            Form::Shaped { shapes, .. } => {
                let shape = |c: usize| shapes.shape(local.absorbed[c], local.length[c]);
                Spreading::Shaped(Spread::new([shape(0), shape(1), shape(2)], diameter))
            }
        };
        Scattering { boundary: &immersed.boundary, local, spreading }
    }

    /// What scatters at a point of a body inside a medium of index `ior_around`: the medium of which [`Self::at`]
    /// gives albedo and profile. `albedo` looks up the albedo where it is textured.
    pub fn medium(&self, ior_around: f32, albedo: impl FnOnce(&ScatteringInput) -> Rgb) -> Medium {
        self.medium_of(&self.local_in(self.immersed(ior_around), albedo))
    }

    fn medium_of(&self, local: &Local) -> Medium {
        match &self.input {
            ScatteringInput::Coefficients { sigma_a, sigma_s, g }
            | ScatteringInput::Spectral { sigma_a, sigma_s, g, .. } => {
                Medium { sigma_a: *sigma_a, sigma_s: *sigma_s, g: *g }
            }
            ScatteringInput::Albedo { mean_free_path, g, .. } => {
                let absorbed = local.absorbed.map(|x| unreduced_share(f64::from(x), f64::from(*g)) as f32);
                let sigma_t = mean_free_path.map(|l| 1.0 / l);
                Medium { sigma_a: absorbed * sigma_t, sigma_s: (Rgb::ONE - absorbed) * sigma_t, g: *g }
            }
        }
    }

    fn local_in(&self, immersed: &Immersed, albedo: impl FnOnce(&ScatteringInput) -> Rgb) -> Local {
        immersed.constant.unwrap_or_else(|| self.resolve(immersed, albedo(&self.input)))
    }

    /// The material inside a medium of index `ior_around`.
    pub fn immersed(&self, ior_around: f32) -> &Immersed {
        self.immersed.iter().find(|i| i.ior_around == ior_around).unwrap_or(&self.immersed[0])
    }

    fn constant(&self, immersed: &Immersed) -> Option<Local> {
        match &self.input {
            ScatteringInput::Albedo { albedo, .. } if albedo.texture.is_some() || albedo.vertex_color => None,
            ScatteringInput::Albedo { albedo, .. } => Some(self.resolve(immersed, albedo.factor)),
            ScatteringInput::Coefficients { .. } | ScatteringInput::Spectral { .. } => {
                Some(self.resolve(immersed, Rgb::ZERO))
            }
        }
    }

    /// The medium; `wanted` is the reflectance asked for, where the input is one.
    fn resolve(&self, immersed: &Immersed, wanted: Rgb) -> Local {
        match &self.input {
            ScatteringInput::Coefficients { sigma_a, sigma_s, g }
            | ScatteringInput::Spectral { sigma_a, sigma_s, g, .. } => {
                let medium = Medium { sigma_a: *sigma_a, sigma_s: *sigma_s, g: *g };
                let absorbed = medium.absorbed_share_reduced();
                let free_path = medium.sigma_t_reduced().map(|t| 1.0 / t);
                self.local(immersed, absorbed.map(|x| immersed.planar.albedo(x)), absorbed, free_path)
            }
            ScatteringInput::Albedo { mean_free_path, g, .. } => {
                let albedo = wanted.map(|a| a.clamp(0.0, 1.0));
                let absorbed = albedo.map(|a| immersed.planar.absorbed_share(a));
                // With x = σ_a/σ_t' and σ_t = σ_a + σ_s,
                // σ_t/σ_t' = x + (1−x)/(1−g).
                let free_path = mean_free_path.zip(absorbed, |l, x| l * (x + (1.0 - x) / (1.0 - g)));
                self.local(immersed, albedo, absorbed, free_path)
            }
        }
    }

    fn local(&self, immersed: &Immersed, albedo: Rgb, absorbed: Rgb, free_path: Rgb) -> Local {
        let length = match immersed.form {
            Form::Normalized => absorbed.zip(free_path, |x, l| {
                NormalizedDiffusion::from_albedo(PlanarAlbedo::matched().albedo(x), l).d
            }),
            Form::Shaped { .. } => free_path,
        };
        Local { albedo, absorbed, length }
    }
}
