//! What is studied: one half-space, or slab, for each channel.

use thiserror::Error;

use crate::diffusion::{HalfSpace, HalfSpaceError};
use crate::medium::presets::{MeasuredMaterial, UnknownMaterial, measured_material};
use crate::medium::{AlbedoInversion, Entry};
use crate::slab::{Layer, LayerStack};

/// One channel of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Channel {
    /// `red`, `green`, `blue`; `all` where there is one channel only.
    pub name: &'static str,
    /// Its medium, 1/m.
    pub medium: HalfSpace,
}

/// A homogeneous body with a flat, smooth surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name of a measured material or of a file, or `custom`.
    pub name: String,
    /// One or three channels, or fewer where nothing scatters.
    pub channels: Vec<Channel>,
    /// Thickness of a slab, m; none for a half-space.
    pub thickness: Option<f64>,
    /// Whether it was measured as it is, so that unlikely lengths are no mistake.
    pub measured: bool,
    /// What its reader ought to know.
    pub notes: Vec<String>,
}

/// Values for the channels: one for all, or one for each.
#[derive(Clone, Debug, PartialEq)]
pub struct Coefficients {
    /// Absorption coefficient σ_a, 1/m.
    pub sigma_a: Vec<f64>,
    /// Scattering coefficient σ_s (not reduced), 1/m.
    pub sigma_s: Vec<f64>,
    /// Mean cosine g, in (−1, 1).
    pub g: Vec<f64>,
    /// n_inside / n_outside.
    pub eta: Vec<f64>,
}

/// Why there is nothing to study.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum MaterialError {
    /// No measured material has this name.
    #[error("{0}; `alabaster materials` lists all of them")]
    Unknown(#[from] UnknownMaterial),
    /// A value that no medium has.
    #[error("channel {channel}: {problem}")]
    Medium {
        /// Name of the channel.
        channel: &'static str,
        /// What is wrong.
        problem: HalfSpaceError,
    },
    /// A wrong number of values.
    #[error("{field} has {count} values; give one for all channels, or three: red, green, blue")]
    Count {
        /// Name of the quantity.
        field: &'static str,
        /// How many values it has.
        count: usize,
    },
    /// A value outside of its range.
    #[error("{field} is {value}; it must be {range}")]
    OutOfRange {
        /// Name of the quantity.
        field: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// Nothing comes back from a medium that does not scatter.
    #[error("sigma_s is 0 in every channel: nothing scatters, so there is no profile; make it positive")]
    NoScattering,
    /// The models know a single medium.
    #[error(
        "there are {0} layers; the models are of one homogeneous layer, and layers are not averaged: \
         give each layer a file of its own, or use `alabaster slab` for all of them together"
    )]
    Layers(usize),
    /// The models know the same medium on both sides.
    #[error(
        "the index of refraction is {above} above and {below} below the slab; the models take the same on both sides"
    )]
    Surroundings {
        /// Index above.
        above: f64,
        /// Index below.
        below: f64,
    },
}

/// Layers at least this thick, in reduced mean free paths, are taken for half-spaces. Without any absorption such a
/// layer lets about 10⁻⁴ of the light pass.
pub const HALF_SPACE_THICKNESS: f64 = 1e4;

const CHANNELS: [&str; 3] = ["red", "green", "blue"];

impl Material {
    /// The measured material called `name`, with `density` times as many scatterers and absorbers, and a phase function
    /// of mean cosine `g`: what was measured is the reduced scattering coefficient. `eta` replaces its index.
    ///
    /// # Errors
    /// If there is none of that name, or a value is outside its range.
    pub fn measured(name: &str, density: f64, g: &[f64], eta: Option<&[f64]>) -> Result<Self, MaterialError> {
        let MeasuredMaterial { name, sigma_a, sigma_s_reduced, ior, .. } = measured_material(name)?;
        positive("density", density)?;
        let scaled = |values: [f32; 3]| values.map(|x| f64::from(x) * density).to_vec();
        let sigma_s = CHANNELS.iter().enumerate();
        let sigma_s = sigma_s.map(|(i, _)| {
            let g = value(g, i).filter(|g| g.abs() < 1.0).unwrap_or(0.0);
            f64::from(sigma_s_reduced.0[i]) * density / (1.0 - g)
        });
        let coefficients = Coefficients {
            sigma_a: scaled(sigma_a.0),
            sigma_s: sigma_s.collect(),
            g: g.to_vec(),
            eta: eta.map_or_else(|| vec![f64::from(*ior)], <[f64]>::to_vec),
        };
        Ok(Self { measured: true, ..Self::of_coefficients(name, &coefficients)? })
    }

    /// A half-space of these coefficients.
    ///
    /// # Errors
    /// If the number of values is not 1 or 3, or one is outside its range.
    pub fn of_coefficients(name: &str, coefficients: &Coefficients) -> Result<Self, MaterialError> {
        let Coefficients { sigma_a, sigma_s, g, eta } = coefficients;
        let count = channel_count(&[("sigma_a", sigma_a), ("sigma_s", sigma_s), ("g", g), ("ior", eta)])?;
        let mut channels = Vec::new();
        let mut notes = Vec::new();
        for (i, channel) in names(count).iter().copied().enumerate() {
            let at = |values: &[f64]| value(values, i).unwrap_or(f64::NAN);
            let medium = HalfSpace::new(at(sigma_a), at(sigma_s), at(g), at(eta))
                .map_err(|problem| MaterialError::Medium { channel, problem })?;
            if medium.sigma_s > 0.0 {
                channels.push(Channel { name: channel, medium });
            } else {
                notes.push(format!("channel {channel} does not scatter (sigma_s is 0): it is left out"));
            }
        }
        if channels.is_empty() {
            return Err(MaterialError::NoScattering);
        }
        Ok(Self { name: name.into(), channels, thickness: None, measured: false, notes })
    }

    /// The half-space that reflects the share `albedo` of the light that enters as `entry`, and whose mean free path 1/σ_t
    /// is `mean_free_path` (m), by exact transport.
    ///
    /// # Errors
    /// If the number of values is not 1 or 3, or one is outside its range.
    pub fn of_albedo(
        albedo: &[f64],
        mean_free_path: &[f64],
        g: &[f64],
        eta: &[f64],
        entry: Entry,
    ) -> Result<Self, MaterialError> {
        let lists = [("albedo", albedo), ("mean_free_path", mean_free_path), ("g", g), ("ior", eta)];
        let count = channel_count(&lists)?;
        let mut coefficients =
            Coefficients { sigma_a: Vec::new(), sigma_s: Vec::new(), g: g.to_vec(), eta: eta.to_vec() };
        for i in 0..count {
            let at = |values: &[f64]| value(values, i).unwrap_or(f64::NAN);
            let (albedo, length) = (at(albedo), at(mean_free_path));
            if !(0.0..=1.0).contains(&albedo) {
                let range = "between 0 and 1: it is a share of the light";
                return Err(MaterialError::OutOfRange { field: "albedo", value: albedo, range });
            }
            positive("mean_free_path", length)?;
            // Refuses what the inversion does not take.
            HalfSpace::new(0.0, 1.0, at(g), at(eta))
                .map_err(|problem| MaterialError::Medium { channel: names(count)[i], problem })?;
            let share = AlbedoInversion::new(at(eta), at(g), entry).absorbed_share(albedo);
            coefficients.sigma_a.push(share / length);
            coefficients.sigma_s.push((1.0 - share) / length);
        }
        Self::of_coefficients("custom", &coefficients)
    }

    /// The only layer of `stack`, whose unit of length is `metres`: a half-space if it is
    /// [thick enough](HALF_SPACE_THICKNESS), a slab otherwise.
    ///
    /// # Errors
    /// If there are several layers, or a slab has different media above and below.
    pub fn of_layer(name: &str, stack: &LayerStack, metres: f64) -> Result<Self, MaterialError> {
        let &[Layer { ior, sigma_a, sigma_s, g, thickness }] = stack.layers() else {
            return Err(MaterialError::Layers(stack.layers().len()));
        };
        let (above, below) = (stack.ior_above(), stack.ior_below());
        let coefficients = Coefficients {
            sigma_a: vec![sigma_a / metres],
            sigma_s: vec![sigma_s / metres],
            g: vec![g],
            eta: vec![ior / above],
        };
        let mut material = Self::of_coefficients(name, &coefficients)?;
        let paths = thickness * metres * material.channels[0].medium.sigma_t_reduced();
        if paths < HALF_SPACE_THICKNESS {
            if above != below {
                return Err(MaterialError::Surroundings { above, below });
            }
            material.thickness = Some(thickness * metres);
        } else {
            material.notes.push(format!(
                "the layer is {paths:.3e} reduced mean free paths thick: it is taken for a half-space"
            ));
        }
        Ok(material)
    }
}

fn positive(field: &'static str, value: f64) -> Result<(), MaterialError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(MaterialError::OutOfRange { field, value, range: "positive and finite" })
}

/// Value `i` of a list of one value for all or one for each.
fn value(values: &[f64], i: usize) -> Option<f64> {
    if values.len() == 1 { values.first().copied() } else { values.get(i).copied() }
}

fn names(count: usize) -> &'static [&'static str] {
    if count == 1 { &["all"] } else { &CHANNELS }
}

fn channel_count(lists: &[(&'static str, &[f64])]) -> Result<usize, MaterialError> {
    match lists.iter().find(|(_, values)| values.len() != 1 && values.len() != 3) {
        Some(&(field, values)) => Err(MaterialError::Count { field, count: values.len() }),
        None => Ok(lists.iter().map(|(_, values)| values.len()).max().unwrap_or(1)),
    }
}
