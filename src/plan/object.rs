//! What is known and decided about one translucent body.

use super::body::Body;
use super::decision::{Request, decide};
use super::errors::{Form, ModelErrors, Place};
use super::measured::Measured;
use super::solid::Flaw;
use crate::diffusion::{NormalizedDiffusion, ProfileKind};
use crate::medium::albedo_inversion::unreduced_share;
use crate::medium::{Medium, PlanarAlbedo};
use crate::optics::is_smooth;
use crate::radiometry::Rgb;
use crate::scene::{Light, Method, ScatteringInput, Scene, Surface};

/// Mean distance between entry and exit in units of the scale d of normalized diffusion: that of its density
/// (e^(−r/d) + e^(−r/3d))/(8π d r).
const MEAN_DISTANCE: f64 = 2.5;

/// Relative errors to be expected of the methods, the largest over the colour channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expected {
    /// Where light leaves where it entered; `None`: not known.
    pub diffuse: Option<f64>,
    /// Of the area integral; `None`: not known.
    pub bssrdf: Option<f64>,
    /// 0, or why paths cannot walk in the body.
    pub walk: Result<f64, &'static str>,
}

impl Expected {
    /// Of one method; `None` where nothing is known.
    pub fn of(&self, method: Method) -> Option<f64> {
        match method {
            Method::Diffuse => self.diffuse,
            Method::Bssrdf => self.bssrdf,
            Method::Walk => self.walk.ok(),
            Method::Auto => None,
        }
    }
}

/// A translucent body of a scene.
#[derive(Clone, Debug)]
pub struct PlannedObject {
    /// Index into the scene's instances.
    pub instance: usize,
    /// Name of the object.
    pub object: String,
    /// Name of its material.
    pub material: String,
    /// Size and shape.
    pub body: Body,
    /// Thickness: [`Body::scale`] in reduced mean free paths 1/σ_t', by channel.
    pub thickness: [f64; 3],
    /// κ = σ_a/σ_t' by channel.
    pub absorbed: [f64; 3],
    /// Mean distance between entry and exit on a plane, m, by channel.
    pub exit_distance: [f64; 3],
    /// Width of what a pixel shows of it, m.
    pub pixel_footprint: f64,
    /// The diffusion profile that the area integral takes.
    pub profile: ProfileKind,
    /// What is to be expected.
    pub expected: Expected,
    /// The method that it gets.
    pub method: Method,
    /// Why, in a sentence.
    pub reason: String,
}

impl PlannedObject {
    /// Measures the object of an instance and decides; `None` if nothing scatters in it.
    pub fn new(scene: &Scene, instance: usize, measured: &mut Measured, request: &Request) -> Option<Self> {
        let placed = &scene.instances[instance];
        let material = &scene.materials[placed.material];
        let Surface::Translucent { ior, roughness, medium } = &material.surface else { return None };
        let medium = coefficients(medium, *ior);
        if !medium.scatters() {
            return None;
        }
        let body = measured.body(scene, placed);
        let pixel_footprint = body.pixel_footprint(&scene.camera, &scene.film);
        let scale = body.scale();
        let thickness = medium.sigma_t_reduced().0.map(|sigma_t| f64::from(sigma_t) * scale);
        let absorbed = medium.absorbed_share_reduced().0.map(f64::from);
        let exit_distance = exit_distances(&medium);
        let form = Form::of(&body);
        let automatic = || ProfileKind::automatic(f64::from(*ior), f64::from(medium.g));
        let profile = request.profile.kind().unwrap_or_else(automatic);
        let channels = [0, 1, 2].map(|c| {
            let place = Place { form, eta: f64::from(*ior), absorbed: absorbed[c], thickness: thickness[c] };
            let errors = ModelErrors::at(&place)?;
            let edge = shadow_edge_error(exit_distance[c], scale, pixel_footprint);
            Some(ModelErrors { diffuse: errors.diffuse.hypot(edge), ..errors })
        });
        let largest = |of: fn(ModelErrors) -> f64| {
            let errors = channels.map(|channel| channel.map(of));
            errors.into_iter().reduce(|a, b| Some(a?.max(b?))).flatten()
        };
        let expected = Expected {
            diffuse: largest(|errors| errors.diffuse),
            bssrdf: largest(|errors| errors.bssrdf)
                // The table of errors was made with this one.
                .filter(|_| profile == ProfileKind::Tabulated),
            walk: obstacle(scene, measured.flaws(scene, placed.mesh), *ior, *roughness).map_or(Ok(0.0), Err),
        };
        let (method, reason) = decide(&expected, request);
        Some(Self {
            instance,
            object: placed.name.clone(),
            material: material.name.clone(),
            body,
            thickness,
            absorbed,
            exit_distance,
            pixel_footprint,
            profile,
            expected,
            method,
            reason,
        })
    }
}

/// The medium of a body in air. Where the albedo is textured its factor stands for it, with which light goes farthest.
fn coefficients(input: &ScatteringInput, ior: f32) -> Medium {
    match input {
        ScatteringInput::Coefficients { sigma_a, sigma_s, g }
        | ScatteringInput::Spectral { sigma_a, sigma_s, g, .. } => {
            Medium { sigma_a: *sigma_a, sigma_s: *sigma_s, g: *g }
        }
        ScatteringInput::Albedo { albedo, mean_free_path, g } => {
            let planar = PlanarAlbedo::new(ior, *g);
            let absorbed = albedo.factor.map(|albedo| {
                unreduced_share(f64::from(planar.absorbed_share(albedo.clamp(0.0, 1.0))), f64::from(*g))
                    as f32
            });
            let sigma_t = mean_free_path.map(|length| 1.0 / length);
            Medium { sigma_a: absorbed * sigma_t, sigma_s: (Rgb::ONE - absorbed) * sigma_t, g: *g }
        }
    }
}

/// By normalized diffusion, m.
fn exit_distances(medium: &Medium) -> [f64; 3] {
    let distance = |absorbed: f32, sigma_t: f32| {
        let profile =
            NormalizedDiffusion::from_albedo(PlanarAlbedo::matched().albedo(absorbed), 1.0 / sigma_t);
        (MEAN_DISTANCE * f64::from(profile.d)) as f32
    };
    medium.absorbed_share_reduced().zip(medium.sigma_t_reduced(), distance).0.map(f64::from)
}

/// Relative error of light that leaves where it entered at a straight shadow edge across the middle of a body of size `scale`.
/// Spread by a line spread function e^(−|x|/s)/2s, light is off by e^(−|x|/s)/2: a mean square of s/4 per length of the edge, over
/// one of scale/2 for the picture. Pixels that are wider than s average over it.
fn shadow_edge_error(s: f64, scale: f64, pixel: f64) -> f64 {
    (s / (2.0 * scale) * (s / pixel).min(1.0)).sqrt()
}

/// What keeps paths from walking in a body; completes "the object cannot be walked in: …".
fn obstacle(scene: &Scene, flaws: &[Flaw], ior: f32, roughness: f32) -> Option<&'static str> {
    let has = |flaw: fn(&Flaw) -> bool| flaws.iter().any(flaw);
    let refracts = ior != 1.0 && is_smooth(roughness * roughness);
    if has(|flaw| matches!(flaw, Flaw::Flat)) {
        Some("it encloses no volume")
    } else if has(|flaw| matches!(flaw, Flaw::Open(_))) {
        Some("its surface is not closed")
    } else if has(|flaw| matches!(flaw, Flaw::Twisted(_))) {
        Some("some of its triangles are wound against their neighbours")
    } else if refracts && !scene.lights.iter().all(Light::has_size) {
        Some("walks cannot find lights without size through a smooth boundary")
    } else {
        None
    }
}
