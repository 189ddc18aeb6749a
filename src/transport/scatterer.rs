//! Translucent materials made ready: boundary, albedo and profile for each surrounding they can have.

use std::array;

use thiserror::Error;

use super::basis::Basis;
use super::form::{Form, FormError, profile_kind};
use super::guide::Guide;
use super::spheres::SphereTable;
use super::spread::{Spread, Spreading, resolvable};
use crate::diffusion::{DirectionalWeightTable, HalfSpaceError, ModelKind, NormalizedDiffusion, ProfileKind};
use crate::medium::albedo_inversion::unreduced_share;
use crate::medium::{Medium, PlanarAlbedo};
use crate::optics::{Boundary, Interface, fresnel_dielectric};
use crate::radiometry::spectrum::regular::ROWS;
use crate::radiometry::{Rgb, Spectrum};
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
    /// The same by wavelength, where paths carry wavelengths.
    by_wavelength: Option<Box<Local<ROWS>>>,
    /// Steps of walks on spheres, where they have been prepared.
    spheres: Option<SphereTable<3>>,
    /// The same by wavelength, where paths carry wavelengths.
    spheres_by_wavelength: Option<Box<SphereTable<ROWS>>>,
    /// Of walks in the medium where nothing is textured, and the medium.
    guide: Option<(Medium, Option<Guide>)>,
}

/// The medium at a point.
#[derive(Clone, Copy, Debug)]
pub struct Local<const N: usize = 3> {
    /// Share of the light entered that leaves again, on a plane.
    pub albedo: Spectrum<N>,
    /// 1 − α': share absorbed at a collision of the reduced medium.
    pub absorbed: Spectrum<N>,
    /// The scale of the profiles, m: the shape parameter d of normalized diffusion, the reduced mean free path
    /// 1/σ_t' of all others.
    pub length: Spectrum<N>,
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

/// What a translucent material is given by, but for an albedo.
#[derive(Clone, Copy, Debug)]
pub enum Given<const N: usize> {
    /// Its coefficients.
    Medium(Medium<N>),
    /// With an albedo.
    FreePath {
        /// 1/σ_t, m.
        length: Spectrum<N>,
        /// Mean cosine of the phase function.
        g: f32,
    },
}

/// A translucent material, for every surrounding that the scene can give it.
pub struct Scatterer {
    input: ScatteringInput,
    given: Given<3>,
    /// The same by wavelength, where paths carry wavelengths.
    given_by_wavelength: Option<Box<Given<ROWS>>>,
    immersed: Vec<Immersed>,
}

/// What a translucent surface does at a point.
pub struct Scattering<'a, const N: usize = 3> {
    /// The boundary.
    pub boundary: &'a Boundary,
    /// The medium, its length such as the body can resolve.
    pub local: Local<N>,
    /// Profiles.
    pub spreading: Spreading<'a, N>,
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
            by_wavelength: None,
            spheres: None,
            spheres_by_wavelength: None,
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
    pub fn spheres(&self) -> Option<&SphereTable<3>> {
        self.spheres.as_ref()
    }

    /// The same by wavelength.
    pub fn spheres_by_wavelength(&self) -> Option<&SphereTable<ROWS>> {
        self.spheres_by_wavelength.as_deref()
    }

    /// The medium where nothing is textured, and the guide of walks in it if they are worth to be guided.
    pub fn prepared_guide(&self) -> Option<&(Medium, Option<Guide>)> {
        self.guide.as_ref()
    }

    /// The guide of walks in `medium`, if they are worth to be guided.
    pub fn new_guide<const N: usize>(&self, medium: &Medium<N>) -> Option<Guide<N>> {
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

    /// The medium at a point; `wanted` is the albedo asked for, where there is one.
    fn resolve<const N: usize>(&self, given: &Given<N>, wanted: Spectrum<N>) -> Local<N> {
        match given {
            Given::Medium(medium) => {
                let absorbed = medium.absorbed_share_reduced();
                let free_path = medium.sigma_t_reduced().map(|t| 1.0 / t);
                self.local(absorbed.map(|x| self.planar.albedo(x)), absorbed, free_path)
            }
            Given::FreePath { length, g } => {
                let albedo = wanted.map(|a| a.clamp(0.0, 1.0));
                let absorbed = albedo.map(|a| self.planar.absorbed_share(a));
                // With x = σ_a/σ_t' and σ_t = σ_a + σ_s,
                // σ_t/σ_t' = x + (1−x)/(1−g).
                let free_path = length.zip(absorbed, |l, x| l * (x + (1.0 - x) / (1.0 - g)));
                self.local(albedo, absorbed, free_path)
            }
        }
    }

    fn local<const N: usize>(
        &self,
        albedo: Spectrum<N>,
        absorbed: Spectrum<N>,
        free_path: Spectrum<N>,
    ) -> Local<N> {
        let length = match self.form {
            Form::Normalized => absorbed.zip(free_path, |x, l| {
                NormalizedDiffusion::from_albedo(PlanarAlbedo::matched().albedo(x), l).d
            }),
            Form::Shaped { .. } => free_path,
        };
        Local { albedo, absorbed, length }
    }

    /// What it is where nothing is textured.
    pub fn constant(&self) -> Option<&Local> {
        self.constant.as_ref()
    }

    /// The same by wavelength, if that has been prepared.
    pub fn by_wavelength(&self) -> Option<&Local<ROWS>> {
        self.by_wavelength.as_deref()
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
        let given = match *medium {
            ScatteringInput::Coefficients { sigma_a, sigma_s, g }
            | ScatteringInput::Spectral { sigma_a, sigma_s, g, .. } => {
                Given::Medium(Medium { sigma_a, sigma_s, g })
            }
            ScatteringInput::Albedo { mean_free_path, g, .. } => {
                Given::FreePath { length: mean_free_path, g }
            }
        };
        let mut scatterer =
            Self { input: medium.clone(), given, given_by_wavelength: None, immersed: Vec::new() };
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
            immersed.constant = scatterer.constant().map(|albedo| immersed.resolve(&given, albedo));
            if let Some(local) = immersed.constant.filter(|_| uses.walked) {
                let medium = given.medium(&local);
                immersed.guide = Some((medium, immersed.new_guide(&medium)));
            }
            scatterer.immersed.push(immersed);
        }
        Ok(Some(scatterer))
    }

    /// Prepares the steps of walks on spheres, where nothing is textured: some 100 µs and 150 kB for each surrounding,
    /// thirty times that where paths carry wavelengths.
    /// With `similarity`, also those of anisotropic media.
    pub fn prepare_spheres(&mut self, similarity: bool) {
        for i in 0..self.immersed.len() {
            let medium = self.immersed[i].constant.map(|local| self.given.medium(&local));
            self.immersed[i].spheres = medium.and_then(|medium| SphereTable::new(medium, similarity));
            let spectral = self.given_by_wavelength.as_ref().zip(self.immersed[i].by_wavelength.as_ref());
            let spectral = spectral.map(|(given, local)| given.medium(local));
            let table = spectral.and_then(|medium| SphereTable::new(medium, similarity));
            self.immersed[i].spheres_by_wavelength = table.map(Box::new);
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
    pub fn at<B: Basis<N>, const N: usize>(
        &self,
        basis: &B,
        ior_around: f32,
        diameter: f32,
        albedo: impl FnOnce(&ScatteringInput) -> Spectrum<N>,
    ) -> Scattering<'_, N> {
        let immersed = self.immersed(ior_around);
        let mut local = self.local_in(basis, immersed, albedo);
        local.length = local.length.map(|length| resolvable(length, diameter));
        let spreading = match &immersed.form {
            Form::Normalized => Spreading::Normalized(Spread::new(
                local.length.0.map(|d| NormalizedDiffusion { d }),
                diameter,
            )),
            Form::Shaped { shapes, .. } => {
                let shape = |c: usize| shapes.shape(local.absorbed[c], local.length[c]);
                Spreading::Shaped(Spread::new(array::from_fn(shape), diameter))
            }
        };
        Scattering { boundary: &immersed.boundary, local, spreading }
    }

    /// What scatters at a point of a body inside a medium of index `ior_around`: the medium of which [`Self::at`]
    /// gives albedo and profile. `albedo` looks up the albedo where it is textured.
    pub fn medium<B: Basis<N>, const N: usize>(
        &self,
        basis: &B,
        ior_around: f32,
        albedo: impl FnOnce(&ScatteringInput) -> Spectrum<N>,
    ) -> Medium<N> {
        basis.given(self).medium(&self.local_in(basis, self.immersed(ior_around), albedo))
    }

    fn local_in<B: Basis<N>, const N: usize>(
        &self,
        basis: &B,
        immersed: &Immersed,
        albedo: impl FnOnce(&ScatteringInput) -> Spectrum<N>,
    ) -> Local<N> {
        basis.constant(immersed).unwrap_or_else(|| immersed.resolve(&basis.given(self), albedo(&self.input)))
    }

    /// The material inside a medium of index `ior_around`: where that depends on the wavelength, inside the one it is nearest to.
    pub fn immersed(&self, ior_around: f32) -> &Immersed {
        let distance = |immersed: &&Immersed| (immersed.ior_around - ior_around).abs();
        let nearest = || self.immersed.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let found = self.immersed.iter().find(|i| i.ior_around == ior_around).or_else(nearest);
        found.unwrap_or(&self.immersed[0])
    }

    /// What the scene gives it by.
    pub fn input(&self) -> &ScatteringInput {
        &self.input
    }

    /// What it is given by.
    pub fn given(&self) -> &Given<3> {
        &self.given
    }

    /// The same by wavelength, if that has been prepared.
    pub fn given_by_wavelength(&self) -> Option<&Given<ROWS>> {
        self.given_by_wavelength.as_deref()
    }

    /// Prepares it for paths that carry wavelengths, from what it is `given` by and the factor of its albedo, where it has one.
    pub fn prepare_wavelengths(&mut self, given: Given<ROWS>, albedo: Spectrum<ROWS>) {
        let is_constant = self.constant().is_some();
        for immersed in &mut self.immersed {
            immersed.by_wavelength = is_constant.then(|| Box::new(immersed.resolve(&given, albedo)));
        }
        self.given_by_wavelength = Some(Box::new(given));
    }

    /// The albedo where nothing varies; 0 where there is none.
    fn constant(&self) -> Option<Rgb> {
        match &self.input {
            ScatteringInput::Albedo { albedo, .. } => (!albedo.varies()).then_some(albedo.factor),
            ScatteringInput::Coefficients { .. } | ScatteringInput::Spectral { .. } => Some(Rgb::ZERO),
        }
    }
}

impl<const N: usize> Given<N> {
    /// The medium that is `local` at a point.
    fn medium(&self, local: &Local<N>) -> Medium<N> {
        match *self {
            Self::Medium(medium) => medium,
            Self::FreePath { length, g } => {
                let absorbed = local.absorbed.map(|x| unreduced_share(f64::from(x), f64::from(g)) as f32);
                let sigma_t = length.map(|l| 1.0 / l);
                Medium { sigma_a: absorbed * sigma_t, sigma_s: (Spectrum::ONE - absorbed) * sigma_t, g }
            }
        }
    }
}
