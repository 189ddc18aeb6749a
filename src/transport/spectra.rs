//! A scene by wavelength: the spectra of its colours, coefficients and lights.
//!
//! What is the same everywhere is fitted, and tabulated, once. What comes out of a texture is looked up in a table of fits
//! ([`UpsamplingTable`]), which is made only if there is one.

use thiserror::Error;

use super::scatterer::{Given, Scatterer};
use crate::medium::Medium;
use crate::radiometry::spectrum::dispersion::Dispersion;
use crate::radiometry::spectrum::regular::{ROWS, RegularSpectrum};
use crate::radiometry::spectrum::upsampling::{
    BoundedSpectrum, ScaledSpectrum, UpsamplingError, UpsamplingTable, daylight,
};
use crate::radiometry::{Rgb, Spectrum};
use crate::scene::{ColorInput, Environment, Light, Material, ScatteringInput, Scene, Surface};

/// Which of a material's shares of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Reflectance, tint, base colour, or the albedo of what is inside.
    Surface,
    /// Colour of diffuse transmission.
    DiffuseTransmission,
}

/// A material by wavelength. Of what varies over the surface, the factors.
#[derive(Clone, Debug)]
pub struct MaterialSpectra {
    surface: RegularSpectrum,
    diffuse_transmission: RegularSpectrum,
    /// Emitted radiance, W/(m² sr nm) on the scale on which constant 1 has Y = 1.
    pub emission: RegularSpectrum,
    /// Of a clear body, 1/m.
    pub absorption: RegularSpectrum,
    /// Of the index of refraction.
    pub dispersion: Option<Dispersion>,
}

/// All of a scene by wavelength.
pub struct SceneSpectra {
    materials: Vec<MaterialSpectra>,
    lights: Vec<RegularSpectrum>,
    environment: RegularSpectrum,
    daylight: RegularSpectrum,
    /// Of what varies over a surface or an environment.
    table: Option<UpsamplingTable>,
}

/// Something in a scene has no spectrum.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{of}: {problem}")]
pub struct SpectraError {
    /// Of what.
    of: String,
    /// Why not.
    #[source]
    problem: UpsamplingError,
}

impl MaterialSpectra {
    /// One of its shares.
    pub fn part(&self, part: Part) -> &RegularSpectrum {
        match part {
            Part::Surface => &self.surface,
            Part::DiffuseTransmission => &self.diffuse_transmission,
        }
    }

    fn of(material: &Material) -> Result<Self, UpsamplingError> {
        let share = |input: &ColorInput| {
            let share = BoundedSpectrum::fit(input.factor.map(|x| x.clamp(0.0, 1.0)))?;
            Ok::<_, UpsamplingError>(RegularSpectrum::tabulate(|w| share.value(w as f32).into()))
        };
        let white = ColorInput::constant(Rgb::ONE);
        let (surface, diffuse_transmission, absorption) = match &material.surface {
            Surface::Diffuse { reflectance } | Surface::Metal { reflectance, .. } => {
                (reflectance, &white, Rgb::ZERO)
            }
            Surface::Dielectric { tint, sigma_a, .. } => (tint, &white, *sigma_a),
            Surface::MetallicRoughness(m) => (&m.base_color, &m.diffuse_transmission_color, m.sigma_a),
            Surface::Translucent { medium: ScatteringInput::Albedo { albedo, .. }, .. } => {
                (albedo, &white, Rgb::ZERO)
            }
            Surface::Translucent { .. } => (&white, &white, Rgb::ZERO),
        };
        Ok(Self {
            surface: share(surface)?,
            diffuse_transmission: share(diffuse_transmission)?,
            emission: emission(material.emission.factor)?,
            absorption: coefficient(absorption)?,
            dispersion: material.surface.dispersion().copied(),
        })
    }
}

impl SceneSpectra {
    /// Of `scene`.
    ///
    /// # Errors
    /// If a colour or an index of refraction has no spectrum; what scene files can say has one.
    pub fn new(scene: &Scene) -> Result<Self, SpectraError> {
        let named = |of: String| |problem| SpectraError { of, problem };
        let materials = scene.materials.iter().map(|material| {
            MaterialSpectra::of(material).map_err(named(format!("material \"{}\"", material.name)))
        });
        let lights = (0..).zip(&scene.lights).map(|(index, light): (usize, &Light)| {
            light_spectrum(light).map_err(named(format!("light {index} ({})", light.kind())))
        });
        let constant = match &scene.environment {
            Some(Environment::Constant(radiance)) => *radiance,
            _ => Rgb::ZERO,
        };
        let environment = emission(constant).map_err(named("the environment".into()))?;
        let is_map = matches!(scene.environment, Some(Environment::Map { .. }));
        let varies = is_map || scene.materials.iter().any(Material::varies);
        let table = varies.then(UpsamplingTable::new).transpose();
        Ok(Self {
            materials: materials.collect::<Result<_, _>>()?,
            lights: lights.collect::<Result<_, _>>()?,
            environment,
            daylight: RegularSpectrum::tabulate(|nanometres| daylight(nanometres as f32).into()),
            table: table.map_err(|problem| named("textures".into())(problem))?,
        })
    }

    /// A material.
    pub fn material(&self, material: usize) -> &MaterialSpectra {
        &self.materials[material]
    }

    /// What a light emits, in the unit of its kind per nanometre.
    pub fn light(&self, light: usize) -> &RegularSpectrum {
        &self.lights[light]
    }

    /// Radiance of an environment that is the same everywhere.
    pub fn environment(&self) -> &RegularSpectrum {
        &self.environment
    }

    /// At some wavelengths, a share that is `rgb` where it was looked up.
    pub fn shares<const N: usize>(&self, rgb: Rgb, nanometres: [f32; N]) -> Spectrum<N> {
        Spectrum(self.table.as_ref().map_or([0.0; N], |table| table.shares(rgb, nanometres)))
    }

    /// At some wavelengths, an emission that is `rgb` where it was looked up, per unit of [`Self::daylight`].
    pub fn filters<const N: usize>(&self, rgb: Rgb, nanometres: [f32; N]) -> Spectrum<N> {
        Spectrum(self.table.as_ref().map_or([0.0; N], |table| table.filters(rgb, nanometres)))
    }

    /// The emission that is white.
    pub fn daylight(&self) -> &RegularSpectrum {
        &self.daylight
    }

    /// Makes `scatterer`, of `material`, ready for wavelengths.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn prepare(&self, scatterer: &mut Scatterer, material: usize) -> Result<(), SpectraError> {
        let given = by_wavelength(scatterer)
            .map_err(|problem| SpectraError { of: format!("material {material}"), problem })?;
        scatterer.prepare_wavelengths(given, self.materials[material].surface);
        Ok(())
    }
}

/// What a translucent material is given by, by wavelength.
fn by_wavelength(scatterer: &Scatterer) -> Result<Given<ROWS>, UpsamplingError> {
    if let ScatteringInput::Spectral { g, table, .. } = scatterer.input() {
        let at = |nanometres: f64| table.similar(nanometres, f64::from(*g));
        return Ok(Given::Medium(Medium {
            sigma_a: RegularSpectrum::tabulate(|nanometres| at(nanometres).mu_a),
            sigma_s: RegularSpectrum::tabulate(|nanometres| at(nanometres).mu_s),
            g: *g,
        }));
    }
    Ok(match *scatterer.given() {
        Given::Medium(Medium { sigma_a, sigma_s, g }) => {
            Given::Medium(Medium { sigma_a: coefficient(sigma_a)?, sigma_s: coefficient(sigma_s)?, g })
        }
        Given::FreePath { length, g } => {
            // The coefficient is what is smooth: a length may be without end.
            let sigma_t = coefficient(length.map(|length| 1.0 / length))?;
            Given::FreePath { length: sigma_t.map(|sigma_t| 1.0 / sigma_t), g }
        }
    })
}

fn emission(rgb: Rgb) -> Result<RegularSpectrum, UpsamplingError> {
    let spectrum = ScaledSpectrum::fit(rgb)?;
    Ok(RegularSpectrum::tabulate(|nanometres| spectrum.emission(nanometres as f32).into()))
}

fn coefficient(rgb: Rgb) -> Result<RegularSpectrum, UpsamplingError> {
    let spectrum = ScaledSpectrum::fit(rgb)?;
    Ok(RegularSpectrum::tabulate(|nanometres| spectrum.value(nanometres as f32).into()))
}

fn light_spectrum(light: &Light) -> Result<RegularSpectrum, UpsamplingError> {
    let emitted = light.emitted();
    match emitted.source.lamp() {
        None => emission(emitted.rgb),
        Some(lamp) => {
            let luminance = emitted.luminance();
            Ok(RegularSpectrum::tabulate(|nanometres| luminance * lamp.relative_power(nanometres)))
        }
    }
}
