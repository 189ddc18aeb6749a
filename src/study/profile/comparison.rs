//! Models beside the truth: totals, L1 error, error by radius.

use std::f64::consts::FRAC_2_PI;
use std::ops::Range;

use super::cost::{Cost, measure};
use super::material::{Channel, Material};
use super::models::{FarFace, ModelChoice, NotApplicable};
use super::rings::{COMPARED, RINGS_PER_DECADE, Rings};
use super::truth::{self, Effort, Watch};
use crate::diffusion::{DiffusionModel, HalfSpace, Multipole};
use crate::medium::{Entry, PlaneParallel};
use crate::optics::fresnel::{Interface, fresnel_moment};
use crate::slab::LayerError;

/// Bands of radius by their rings: below 0.1, 0.1 to 1, 1 to 10 and beyond 10 mean free paths, within
/// [what is compared](COMPARED).
pub const BANDS: [(&str, Range<usize>); 4] = [
    ("r < 0.1", COMPARED.start..band_end(4)),
    ("0.1 - 1", band_end(4)..band_end(5)),
    ("1 - 10", band_end(5)..band_end(6)),
    ("r > 10", band_end(6)..COMPARED.end),
];

/// The first ring beyond so many decades.
const fn band_end(decades: usize) -> usize {
    decades * RINGS_PER_DECADE + 1
}

/// Radii, in mean free paths, beyond which the energy is always given.
pub const BEYOND: [f64; 3] = [1.0, 3.0, 10.0];

/// Which light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// What leaves where it entered.
    Reflectance,
    /// What leaves at the other face of a slab.
    Transmittance,
}

impl Quantity {
    /// The name in outputs.
    pub fn name(self) -> &'static str {
        match self {
            Self::Reflectance => "reflectance",
            Self::Transmittance => "transmittance",
        }
    }
}

/// A model beside the truth.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelResult {
    /// Which model.
    pub choice: ModelChoice,
    /// Its rings, without errors.
    pub rings: Rings,
    /// Its total albedo, of light that entered.
    pub albedo: f64,
    /// Σ|model − truth|/Σ truth over the rings that are compared.
    pub l1: f64,
    /// Relative error of the light in each of [`BANDS`]; none where the truth has no light.
    pub bands: [Option<f64>; BANDS.len()],
    /// What it costs.
    pub cost: Cost,
}

/// One quantity of one channel.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelResult {
    /// The channel.
    pub channel: Channel,
    /// Which light of it.
    pub quantity: Quantity,
    /// Monte Carlo.
    pub truth: Rings,
    /// Total of the truth by transport theory; none beyond |g| = 0.95, where its accuracy is not established.
    pub exact_albedo: Option<f64>,
    /// What the noise of the truth adds to an L1 error, in the mean and at most: Σ E|noise|/Σ truth.
    pub noise: f64,
    /// The models.
    pub models: Vec<ModelResult>,
    /// Models that have nothing to say, and why.
    pub left_out: Vec<(ModelChoice, NotApplicable)>,
}

/// How light enters, which models are compared, and how well.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// How light enters.
    pub entry: Entry,
    /// Models; none: the usual ones.
    pub models: Option<Vec<ModelChoice>>,
    /// How much is simulated.
    pub effort: Effort,
}

/// Compares the models of every channel of `material` with Monte Carlo. `None` if it was stopped before there was
/// something for each channel.
///
/// # Errors
/// If the Monte Carlo refuses a medium.
pub fn compare(
    material: &Material,
    settings: &Settings,
    watch: Watch,
) -> Result<Option<Vec<ChannelResult>>, LayerError> {
    let Settings { entry, effort, .. } = *settings;
    let Some(thickness) = material.thickness else {
        let Some(truths) = truth::half_spaces(&material.channels, entry, effort, watch)? else {
            return Ok(None);
        };
        let pairs = material.channels.iter().zip(truths);
        return Ok(Some(pairs.map(|(channel, truth)| half_space(channel, truth, settings)).collect()));
    };
    let mut results = Vec::new();
    for channel in &material.channels {
        let Some(faces) = truth::slab(&channel.medium, thickness, entry, effort, watch)? else {
            return Ok(None);
        };
        results.extend(slab(channel, thickness, entry, faces));
    }
    Ok(Some(results))
}

/// `medium` with its mean free path 1/σ_t as the unit of length.
pub fn in_mean_free_paths(medium: &HalfSpace) -> HalfSpace {
    let sigma_t = medium.sigma_t();
    HalfSpace { sigma_a: medium.sigma_a / sigma_t, sigma_s: medium.sigma_s / sigma_t, ..*medium }
}

/// Largest |g| at which the exact albedo is relied on.
const LARGEST_G: f64 = 0.95;

/// The models of a half-space beside its truth.
pub fn half_space(channel: &Channel, truth: Rings, settings: &Settings) -> ChannelResult {
    let medium = in_mean_free_paths(&channel.medium);
    let exact = (medium.g.abs() <= LARGEST_G)
        .then(|| PlaneParallel::new(medium.eta, medium.g).half_space(medium.sigma_a).albedo(settings.entry));
    let given = exact.unwrap_or(truth.total().value).clamp(0.0, 1.0);
    let choices = settings.models.as_deref().unwrap_or(&ModelChoice::USUAL);
    let built = choices.iter().map(|&choice| (choice, choice.build(&medium, settings.entry, given)));
    result(channel, Quantity::Reflectance, truth, exact, built.collect())
}

/// The multipole beside the truth, at both faces.
fn slab(channel: &Channel, thickness: f64, entry: Entry, faces: [Rings; 2]) -> [ChannelResult; 2] {
    let medium = in_mean_free_paths(&channel.medium);
    let thickness = thickness * channel.medium.sigma_t();
    let exact = exact_slab(&medium, thickness, entry);
    let [top, bottom] = faces;
    let multipole = || Multipole::new(&medium, thickness).map_err(NotApplicable::Slab);
    let upper = multipole().map(|model| Box::new(model) as Box<dyn DiffusionModel>);
    let lower = multipole().map(|model| Box::new(FarFace(model)) as Box<dyn DiffusionModel>);
    let of = |quantity, truth, exact: Option<f64>, model| {
        result(channel, quantity, truth, exact, vec![(ModelChoice::Multipole, model)])
    };
    [
        of(Quantity::Reflectance, top, exact.map(|e| e.0), upper),
        of(Quantity::Transmittance, bottom, exact.map(|e| e.1), lower),
    ]
}

/// Exact shares that are reflected and transmitted of light that entered, what never collided included.
fn exact_slab(medium: &HalfSpace, thickness: f64, entry: Entry) -> Option<(f64, f64)> {
    if medium.g.abs() > LARGEST_G {
        return None;
    }
    let specular = match entry {
        Entry::Normal => Interface::new(1.0, medium.eta).reflectance,
        Entry::Diffuse => 2.0 * fresnel_moment(medium.eta, 1),
    };
    let layer = PlaneParallel::new(medium.eta, medium.g);
    let (reflected, transmitted) = layer.slab(medium.sigma_a, thickness).reflectance_and_transmittance(entry);
    Some(((reflected - specular) / (1.0 - specular), transmitted / (1.0 - specular)))
}

type Built = (ModelChoice, Result<Box<dyn DiffusionModel>, NotApplicable>);

fn result(
    channel: &Channel,
    quantity: Quantity,
    truth: Rings,
    exact_albedo: Option<f64>,
    built: Vec<Built>,
) -> ChannelResult {
    let reduced = channel.medium.sigma_t() * channel.medium.mean_free_path_reduced();
    let mut models = Vec::new();
    let mut left_out = Vec::new();
    for (choice, model) in built {
        match model {
            Ok(model) => models.push(model_result(choice, &*model, &truth, reduced)),
            Err(reason) => left_out.push((choice, reason)),
        }
    }
    ChannelResult { channel: *channel, quantity, noise: noise(&truth), truth, exact_albedo, models, left_out }
}

fn model_result(choice: ModelChoice, model: &dyn DiffusionModel, truth: &Rings, reduced: f64) -> ModelResult {
    let rings = Rings::of_model(model);
    let bands = BANDS.map(|(_, band)| {
        let light = truth.sum(band.clone());
        (light > 0.0).then(|| rings.sum(band) / light - 1.0)
    });
    let (albedo, l1) = (model.albedo(), l1_error(&rings, truth));
    ModelResult { choice, rings, albedo, l1, bands, cost: measure(model, reduced) }
}

/// Σ|model − truth|/Σ truth over the rings between 10⁻³ and 100 mean free paths.
pub fn l1_error(model: &Rings, truth: &Rings) -> f64 {
    let pairs = model.flux[COMPARED].iter().zip(&truth.flux[COMPARED]);
    pairs.map(|(a, b)| (a.value - b.value).abs()).sum::<f64>() / truth.sum(COMPARED)
}

/// Σ E|noise|/Σ truth over the same rings, E|x| = σ√(2/π) for each.
pub fn noise(truth: &Rings) -> f64 {
    let sum: f64 = truth.flux[COMPARED].iter().map(|e| e.standard_error).sum();
    sum * FRAC_2_PI.sqrt() / truth.sum(COMPARED)
}
