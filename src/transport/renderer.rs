//! A scene made ready to be sampled.

use glam::Vec3;
use thiserror::Error;

use super::basis::Tristimulus;
use super::clearance::Clearance;
use super::exposure::filled;
use super::interiors::Interiors;
use super::light_sampling::LightSampler;
use super::recenter::recenter;
use super::scatterer::{Scatterer, ScattererError, Uses};
use super::spectra::{SceneSpectra, SpectraError};
use super::substance::Substance;
use super::warnings::warnings;
use super::world::{UPWARDS, World};
use crate::diffusion::{ModelKind, ProfileKind};
use crate::math::robust::offset_from_surface;
use crate::plan::{Abilities, ForceError, Forces, Kernel, Plan, Request};
use crate::radiometry::Rgb;
use crate::raycast::{Geometry, Hit, Ray, RayCaster, RaycastError};
use crate::scene::camera::CameraRays;
use crate::scene::{Light, Method, ProfileChoice, ScatteringInput, Scene, SubsurfaceSettings, Surface};

/// What a render can be asked for beyond the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderOptions {
    /// Seed of all random numbers.
    pub seed: u64,
    /// How light under the surface is computed.
    pub method: Method,
    /// The largest relative error that an approximation may be expected to have where the method is chosen by body.
    pub accuracy: f32,
    /// Which diffusion profile.
    pub profile: ProfileChoice,
    /// Longest path in bounces; 0: no limit.
    pub max_depth: u32,
    /// Whether walks use what is known of free space in bodies: they cast no rays where nothing is to be met, and cross spheres in one step.
    /// The picture is the same but for noise, which without is more for the time.
    pub spheres: bool,
    /// Whether walks in bodies that absorb are guided towards where light leaves. The picture is the same but for noise, which
    /// without is more for the time.
    pub guiding: bool,
    /// Whether `spheres` are used in anisotropic media too, far from surfaces: those of the isotropic medium of reduced coefficients, similar to order 1,
    /// which is an approximation.
    pub similarity: bool,
    /// Effects that are switched on or off, whatever the scene calls for.
    pub forces: Forces,
}

impl RenderOptions {
    /// What `scene` asks for, with all that saves time and changes nothing.
    pub fn of(scene: &Scene, seed: u64) -> Self {
        let SubsurfaceSettings { method, accuracy, profile, similarity } = scene.subsurface;
        let max_depth = scene.render.max_depth;
        let forces = Forces::default();
        Self { seed, method, accuracy, profile, max_depth, spheres: true, guiding: true, similarity, forces }
    }
}

impl From<&RenderOptions> for Request {
    fn from(options: &RenderOptions) -> Self {
        let RenderOptions { method, profile, accuracy, forces, .. } = *options;
        Self { method, profile, accuracy, forces }
    }
}

/// Why a scene cannot be rendered.
#[derive(Debug, Error)]
pub enum RenderError {
    /// The ray caster failed.
    #[error(transparent)]
    Raycast(#[from] RaycastError),
    /// A material cannot have the profile asked for.
    #[error(transparent)]
    Scatterer(#[from] ScattererError),
    /// An effect cannot be switched as asked for.
    #[error(transparent)]
    Force(#[from] ForceError),
    /// The program was built without the code.
    #[error(
        "this program was built without code for what the scene needs; build it without `alabaster_without`"
    )]
    LeftOut,
    /// Something has no spectrum.
    #[error(transparent)]
    Spectra(#[from] SpectraError),
}

/// Surfaces of clear bodies that one looks through for what is behind.
const CLEAR_SURFACES: usize = 64;

/// A scene made ready: every sample of every pixel is a pure function of (seed, pixel, sample).
pub struct Renderer<C> {
    pub(super) world: World<C>,
    pub(super) lights: LightSampler,
    /// By material.
    pub(super) scatterers: Vec<Option<Scatterer>>,
    pub(super) options: RenderOptions,
    /// Longest path in bounces; `None`: no limit.
    pub(super) depth_limit: Option<u32>,
    /// Shadow rays may meet surfaces that bend nothing.
    pub(super) has_passages: bool,
    /// Paths walk in some bodies.
    pub(super) has_walks: bool,
    plan: Plan,
    kernel: Kernel,
    /// Where the origin of the renderer's coordinates is in the scene as it was given, m.
    pub(super) center: Vec3,
    /// By instance: some light lies in the bounding box of a body that paths walk in.
    lit_inside: Vec<bool>,
    /// By instance: free space in bodies that paths walk in, where it is used.
    clearances: Vec<Option<Clearance>>,
    pub(super) camera: CameraRays,
    pub(super) camera_interiors: Interiors,
    /// The scene by wavelength, where paths carry wavelengths.
    pub(super) spectra: Option<SceneSpectra>,
}

impl<C: RayCaster> Renderer<C> {
    /// Prepares `scene`; `build` makes the ray caster from its triangles.
    pub fn new(
        mut scene: Scene,
        options: RenderOptions,
        build: impl FnOnce(&Geometry) -> Result<C, RaycastError>,
    ) -> Result<Self, RenderError> {
        // The plan is to know how long paths are to be, and may shorten them.
        scene.render.max_depth = options.max_depth;
        let plan = Plan::prepare(&mut scene, &Request::from(&options))?;
        let depth_limit = Some(scene.render.max_depth).filter(|&depth| depth > 0);
        let kernel = plan.kernel;
        if !kernel.suits(plan.needed) {
            return Err(RenderError::LeftOut);
        }
        let center = recenter(&mut scene);
        let camera = scene.camera.rays(scene.film.width as f32 / scene.film.height as f32);
        let world = World::new(scene, plan.methods(), build)?;
        let scene = world.scene();
        let lights = LightSampler::new(&world, world.radius());
        let has_walks = world.has_walks();
        // Where none is used, one that needs no preparation.
        let uses = |material| Uses {
            profile: match uses_profile(&world, material) {
                true => options.profile.kind(),
                false => Some(ProfileKind::Model(ModelKind::NormalizedDiffusion)),
            },
            walked: world.methods_of(material).any(|method| method == Method::Walk),
            walks: has_walks,
        };
        let mut scatterers = (0..scene.materials.len())
            .map(|material| Scatterer::new(scene, material, &uses(material)))
            .collect::<Result<Vec<_>, _>>()?;
        let around_camera = world.interiors_at(scene.camera.position, UPWARDS);
        let camera_interiors = filled(&world, &scatterers, &Tristimulus, &around_camera);
        let spectra = match kernel {
            Kernel::Spectral => Some(SceneSpectra::new(scene)?),
            _ => None,
        };
        for (material, scatterer) in scatterers.iter_mut().enumerate() {
            if let (Some(scatterer), Some(spectra)) = (scatterer, &spectra) {
                spectra.prepare(scatterer, material)?;
            }
        }
        let has_passages = has_walks && has_passages(&world);
        let lit_inside = (0..world.substances().len() as u32).map(|i| is_lit_inside(&world, i)).collect();
        let clearances = clearances(&world, &scatterers, options.spheres);
        prepare_spheres(&world, &clearances, options.similarity, &mut scatterers);
        Ok(Self {
            world,
            lights,
            scatterers,
            options,
            depth_limit,
            has_passages,
            has_walks,
            plan,
            kernel,
            center,
            lit_inside,
            clearances,
            camera,
            camera_interiors,
            spectra,
        })
    }

    /// The scene, lights included as geometry; around the origin if it was given far from it.
    pub fn scene(&self) -> &Scene {
        self.world.scene()
    }

    /// The diffusion profiles in use, each once; none where light leaves where it entered.
    pub fn profiles(&self) -> Vec<ProfileKind> {
        let mut profiles = Vec::new();
        let used = |(material, scatterer)| uses_profile(&self.world, material).then_some(scatterer);
        for kind in (0..).zip(&self.scatterers).filter_map(used).flatten().flat_map(Scatterer::profiles) {
            if !profiles.contains(&kind) {
                profiles.push(kind);
            }
        }
        profiles
    }

    /// Which method each translucent body has got, and why.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The kernel that takes samples.
    pub fn kernel(&self) -> Kernel {
        self.kernel
    }

    /// Takes samples by another kernel from here on, of the same bits; false, and nothing is changed, if it has not the code for what
    /// the scene needs.
    pub fn use_kernel(&mut self, kernel: Kernel) -> bool {
        let suits = kernel.suits(self.plan.needed);
        self.kernel = if suits { kernel } else { self.kernel };
        suits
    }

    /// The corners of the triangle that was met, around the renderer's origin as its rays are.
    pub fn triangle(&self, hit: &Hit) -> [Vec3; 3] {
        self.world.triangle(hit.instance, hit.primitive)
    }

    /// The ray caster.
    pub fn caster(&self) -> &C {
        self.world.caster()
    }

    /// Changes the seed of all random numbers.
    pub fn reseed(&mut self, seed: u64) {
        self.options.seed = seed;
    }

    /// Cuts paths after so many bounces from here on, whatever the options say; `None`: not at all. With 0 only what emits is seen. A sample under
    /// a limit is the same path as without, up to there.
    pub fn limit_depth(&mut self, limit: Option<u32>) {
        self.depth_limit = limit;
    }

    /// The limit that the options set.
    pub fn depth_limit(&self) -> Option<u32> {
        self.depth_limit
    }

    /// Leaves the direction of entry out of profiles that depend on it: light from every direction then leaves as
    /// uniform light does.
    pub fn forget_direction_of_entry(&mut self) {
        self.scatterers.iter_mut().flatten().for_each(Scatterer::forget_direction_of_entry);
    }

    /// The material that the centre of pixel (`x`, `y`) shows, seen straight through clear bodies; `None` if that is a
    /// light or nothing.
    pub fn material_seen(&self, x: u32, y: u32) -> Option<usize> {
        let film = self.scene().film;
        let center = [(x as f32 + 0.5) / film.width as f32, (y as f32 + 0.5) / film.height as f32];
        let ray = self.camera.ray(center, [0.5; 2]);
        let mut origin = ray.origin;
        for _ in 0..CLEAR_SURFACES {
            let hit = self.world.caster().closest(&Ray::new(origin, ray.direction))?;
            let Substance::Material(material) = self.world.substance(hit.instance) else { return None };
            if !is_clear(&self.scene().materials[material].surface) {
                return Some(material);
            }
            let surface = self.world.surface::<{ Abilities::NONE.bits() }>(&hit);
            let (position, normal) = (surface.position, surface.geometric_normal);
            origin = offset_from_surface(position, surface.error, normal, ray.direction);
        }
        None
    }

    /// What is wrong with the scene as it is rendered, and what is assumed.
    pub fn warnings(&self) -> Vec<String> {
        warnings(&self.world)
    }

    pub(super) fn is_lit_inside(&self, instance: u32) -> bool {
        self.lit_inside[instance as usize]
    }

    /// Bodies whose free space is known.
    pub(super) fn clearance_count(&self) -> usize {
        self.clearances.iter().flatten().count()
    }

    /// Free space in `instance`, where it is used.
    pub(super) fn clearance(&self, instance: u32) -> Option<&Clearance> {
        self.clearances[instance as usize].as_ref()
    }
}

/// True if the area integral is taken in bodies of `material`.
fn uses_profile<C: RayCaster>(world: &World<C>, material: usize) -> bool {
    world.methods_of(material).any(|method| method == Method::Bssrdf)
}

/// Prepares the steps on spheres of materials that have bodies in which free space is used.
fn prepare_spheres<C: RayCaster>(
    world: &World<C>,
    clearances: &[Option<Clearance>],
    similarity: bool,
    scatterers: &mut [Option<Scatterer>],
) {
    for (material, scatterer) in scatterers.iter_mut().enumerate() {
        let of_material = |(substance, clearance): (&Substance, &Option<Clearance>)| {
            *substance == Substance::Material(material) && clearance.is_some()
        };
        if let Some(scatterer) = scatterer
            && world.substances().iter().zip(clearances).any(of_material)
        {
            scatterer.prepare_spheres(similarity);
        }
    }
}

/// By instance: free space in bodies where it is `wanted` and worth while.
fn clearances<C: RayCaster>(
    world: &World<C>,
    scatterers: &[Option<Scatterer>],
    wanted: bool,
) -> Vec<Option<Clearance>> {
    let instances = 0..world.substances().len() as u32;
    let bodies = instances.clone().filter(|&i| wanted && world.surroundings(i).is_some()).count();
    let clearance = |instance: u32| {
        let near = world.surroundings(instance).filter(|_| wanted)?;
        let Substance::Material(material) = world.substance(instance) else { return None };
        let medium = scatterers[material].as_ref()?.medium(&Tristimulus, 1.0, albedo_factor);
        let turned = |[a, b, c]: [Vec3; 3]| [a, c, b];
        let faces = |other: u32| {
            world
                .triangles(other)
                .map(move |triangle| if other == instance { turned(triangle) } else { triangle })
        };
        let triangles = near.iter().flat_map(|&other| faces(other));
        Clearance::new(world.bounds(instance).into(), &medium, bodies, triangles)
    };
    instances.map(clearance).collect()
}

/// What stands for an albedo where there is no point to look its texture up at.
pub(super) fn albedo_factor(input: &ScatteringInput) -> Rgb {
    match input {
        ScatteringInput::Albedo { albedo, .. } => albedo.factor,
        ScatteringInput::Coefficients { .. } | ScatteringInput::Spectral { .. } => Rgb::ZERO,
    }
}

/// True if one sees through.
fn is_clear(surface: &Surface) -> bool {
    match surface {
        Surface::Dielectric { .. } => true,
        Surface::MetallicRoughness(m) => m.transmission.factor > 0.0,
        _ => false,
    }
}

/// True if there can be surfaces of bodies that light goes straight through.
fn has_passages<C: RayCaster>(world: &World<C>) -> bool {
    let mut enterable = world.enterable().iter().filter_map(|&instance| world.interior(instance));
    let is_flawed = world.flaws().iter().any(|&(instance, _)| world.is_walked(instance));
    world.enterable().len() > 1 || enterable.any(|body| body.ior == 1.0) || is_flawed
}

/// True if paths walk in `instance` and a light that has a place lies in its bounding box.
fn is_lit_inside<C: RayCaster>(world: &World<C>, instance: u32) -> bool {
    if !world.is_walked(instance) {
        return false;
    }
    let (low, high) = world.bounds(instance);
    let meets = |(a, b): (Vec3, Vec3)| a.cmple(high).all() && b.cmpge(low).all();
    let scene = world.scene();
    let points = scene.lights.iter().any(|light| match *light {
        Light::Point { position, .. } | Light::Spot { position, .. } => meets((position, position)),
        _ => false,
    });
    let emits = |other: u32| match world.substance(other) {
        Substance::Light(_) => true,
        Substance::Material(material) => !scene.materials[material].emission.factor.is_black(),
    };
    points
        || (0..world.substances().len() as u32).any(|i| i != instance && emits(i) && meets(world.bounds(i)))
}
