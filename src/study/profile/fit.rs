//! Coefficients from a measured profile, by least squares in ln R.

use nalgebra::{DMatrix, DVector};
use thiserror::Error;

use super::figures::style;
use super::measured::MeasuredProfile;
use super::models::ModelChoice;
use crate::diffusion::{DiffusionModel, HalfSpace, PhotonBeam, Profile, ShapeTable, tabulated};
use crate::medium::{Entry, PlaneParallel};
use crate::study::numbers::significant;
use crate::study::plot::{Axis, Dot, Dots, Line, Panel, PlotError, svg};

/// The model that is fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FitModel {
    /// The profile tabulated from Monte Carlo, with the exact albedo.
    Tabulated,
    /// Photon beam diffusion.
    PhotonBeam,
}

impl FitModel {
    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tabulated => "tabulated",
            Self::PhotonBeam => "photon-beam",
        }
    }
}

/// What is known beforehand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitProblem {
    /// How light enters.
    pub entry: Entry,
    /// n_inside / n_outside.
    pub eta: f64,
    /// Mean cosine.
    pub g: f64,
    /// The model.
    pub model: FitModel,
}

/// A value with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fitted {
    /// The value.
    pub value: f64,
    /// One standard error, from the curvature at the minimum.
    pub stderr: f64,
}

/// What fits best.
#[derive(Clone, Debug, PartialEq)]
pub struct FitResult {
    /// σ_s' = σ_s (1 − g), 1/m.
    pub sigma_s_reduced: Fitted,
    /// σ_a, 1/m.
    pub sigma_a: Fitted,
    /// Measured unit over 1/m², where the measurement is relative.
    pub scale: Option<Fitted>,
    /// Correlation of ln σ_s' and ln σ_a.
    pub correlation: f64,
    /// Σ (ln R − ln model)²/σ², with σ the relative error of R; σ = 1 where the measurement gives none.
    pub chi_squared: f64,
    /// Points less parameters.
    pub degrees: usize,
    /// Root of the mean squared ln R − ln model.
    pub rms: f64,
    /// Whether the measurement gives errors. If not, standard errors come from the scatter about the curve.
    pub weighted: bool,
    /// The curve at the measured radii, in the measured unit (1/m² if absolute).
    pub curve: Vec<f64>,
}

/// Why nothing can be fitted.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FitError {
    /// Fewer points than parameters and one.
    #[error("{points} points do not determine {parameters} coefficients; at least {} are needed", parameters + 1)]
    TooFew {
        /// Points.
        points: usize,
        /// Parameters.
        parameters: usize,
    },
    /// The table does not hold this boundary or phase function.
    #[error("the tabulated profile does not cover ior {eta} with g {g}; choose --models photon-beam")]
    NotTabulated {
        /// Relative index.
        eta: f64,
        /// Mean cosine.
        g: f64,
    },
    /// Many coefficients fit alike.
    #[error(
        "the points do not determine the coefficients: many pairs fit alike; measure over a wider range of radii"
    )]
    Undetermined,
}

/// Steps of the minimisation.
const STEPS: usize = 100;
/// A step in ln σ below which it has converged.
const CONVERGED: f64 = 1e-7;
/// Step of numerical derivatives in ln σ: the table is in single precision.
const DERIVATIVE_STEP: f64 = 2e-3;

/// The model made ready: all that does not depend on the coefficients.
struct Curve<'a> {
    problem: &'a FitProblem,
    table: Option<(ShapeTable, PlaneParallel)>,
}

impl Curve<'_> {
    /// ln R at `radii`; −∞ where there is no such medium.
    fn at(&self, ln_scattering: f64, ln_absorption: f64, radii: &[f64]) -> Vec<f64> {
        let FitProblem { entry, eta, g, .. } = *self.problem;
        let sigma_s = ln_scattering.exp() / (1.0 - g);
        let Ok(medium) = HalfSpace::new(ln_absorption.exp(), sigma_s, g, eta) else {
            return vec![f64::NEG_INFINITY; radii.len()];
        };
        match &self.table {
            Some((table, layer)) => {
                let albedo = layer.half_space(medium.sigma_a / medium.sigma_t()).albedo(entry);
                let absorbed = medium.absorbed_share_reduced() as f32;
                let shape = table.shape(absorbed, medium.mean_free_path_reduced() as f32);
                radii.iter().map(|&r| (albedo * f64::from(shape.density(r as f32))).ln()).collect()
            }
            None => {
                let beam = PhotonBeam::new(&medium);
                radii.iter().map(|&r| beam.reflectance(r).ln()).collect()
            }
        }
    }
}

/// Residuals as a function of the logarithms of the parameters.
struct Residuals<'a> {
    curve: Curve<'a>,
    radii: Vec<f64>,
    ln_measured: Vec<f64>,
    /// 1/σ of ln R.
    weights: Vec<f64>,
    absolute: bool,
}

impl Residuals<'_> {
    fn ln_model(&self, p: &DVector<f64>) -> Vec<f64> {
        let ln_scale = if self.absolute { 0.0 } else { p[2] };
        self.curve.at(p[0], p[1], &self.radii).into_iter().map(|ln| ln + ln_scale).collect()
    }

    fn at(&self, p: &DVector<f64>) -> DVector<f64> {
        let model = self.ln_model(p);
        DVector::from_fn(model.len(), |i, _| self.weights[i] * (self.ln_measured[i] - model[i]))
    }

    /// Derivatives of the residuals, by central differences.
    fn jacobian(&self, p: &DVector<f64>) -> DMatrix<f64> {
        let columns: Vec<DVector<f64>> = (0..p.len())
            .map(|j| {
                let moved = |step: f64| {
                    let mut p = p.clone();
                    p[j] += step;
                    self.at(&p)
                };
                (moved(DERIVATIVE_STEP) - moved(-DERIVATIVE_STEP)) / (2.0 * DERIVATIVE_STEP)
            })
            .collect();
        DMatrix::from_columns(&columns)
    }

    /// The best of a few guesses: media whose reduced mean free path is among the radii, of any albedo.
    fn guess(&self) -> DVector<f64> {
        let (low, high) =
            self.radii.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), &r| (low.min(r), high.max(r)));
        let mut best = (f64::INFINITY, DVector::zeros(if self.absolute { 2 } else { 3 }));
        for i in 0..12 {
            let length = 0.3 * low * (10.0 * high / low).powf(f64::from(i) / 11.0);
            for absorbed in [1e-4, 1e-3, 0.01, 0.05, 0.2, 0.5, 0.8] {
                let (scattering, absorption) = (((1.0 - absorbed) / length).ln(), (absorbed / length).ln());
                let mut p = DVector::from_element(best.1.len(), 0.0);
                (p[0], p[1]) = (scattering, absorption);
                if !self.absolute {
                    // The scale that fits best.
                    let residuals = self.at(&p);
                    let weights: f64 = self.weights.iter().map(|w| w * w).sum();
                    p[2] = residuals.iter().zip(&self.weights).map(|(r, w)| r * w).sum::<f64>() / weights;
                }
                let chi_squared = self.at(&p).norm_squared();
                if chi_squared < best.0 {
                    best = (chi_squared, p);
                }
            }
        }
        best.1
    }
}

/// Fits σ_s' and σ_a, and a scale if `measured` is relative, by Levenberg's and Marquardt's method in their logarithms
/// (Marquardt 1963), which keeps them positive.
///
/// # Errors
/// If there are too few points, or they do not determine the coefficients.
pub fn fit(problem: &FitProblem, measured: &MeasuredProfile) -> Result<FitResult, FitError> {
    let FitProblem { entry, eta, g, model } = *problem;
    let parameters = if measured.absolute { 2 } else { 3 };
    let points = &measured.points;
    if points.len() <= parameters {
        return Err(FitError::TooFew { points: points.len(), parameters });
    }
    let table = match model {
        FitModel::PhotonBeam => None,
        FitModel::Tabulated if !tabulated::covers(eta, g) => return Err(FitError::NotTabulated { eta, g }),
        FitModel::Tabulated => Some((tabulated::shape_table(entry, eta, g), PlaneParallel::new(eta, g))),
    };
    // Where only some points have errors, none is weighted by them.
    let weighted = points.iter().all(|point| point.sigma.is_some());
    let weight =
        |sigma: Option<f64>, value: f64| sigma.filter(|_| weighted).map_or(1.0, |sigma| value / sigma);
    let residuals = Residuals {
        curve: Curve { problem, table },
        radii: points.iter().map(|point| point.radius).collect(),
        ln_measured: points.iter().map(|point| point.reflectance.ln()).collect(),
        weights: points.iter().map(|point| weight(point.sigma, point.reflectance)).collect(),
        absolute: measured.absolute,
    };
    let best = minimise(&residuals, residuals.guess());
    result(&residuals, &best, weighted)
}

/// Levenberg–Marquardt from `p`.
fn minimise(residuals: &Residuals, mut p: DVector<f64>) -> DVector<f64> {
    let mut r = residuals.at(&p);
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        let jacobian = residuals.jacobian(&p);
        let normal = jacobian.tr_mul(&jacobian);
        let gradient = jacobian.tr_mul(&r);
        let mut moved = false;
        while damping < 1e12 && !moved {
            let mut damped = normal.clone();
            for i in 0..p.len() {
                damped[(i, i)] *= 1.0 + damping;
            }
            let Some(step) = damped.cholesky().map(|c| -c.solve(&gradient)) else { break };
            // Logarithms: steps beyond an e-fold leave the quadratic model.
            let step = &step * (1.0 / step.amax().max(1.0));
            let next = &p + &step;
            let next_residuals = residuals.at(&next);
            if next_residuals.norm_squared() < r.norm_squared() {
                moved = step.amax() > CONVERGED;
                (p, r) = (next, next_residuals);
                damping *= 0.2;
                if !moved {
                    return p;
                }
            } else {
                damping *= 5.0;
            }
        }
        if !moved {
            break;
        }
    }
    p
}

fn result(residuals: &Residuals, p: &DVector<f64>, weighted: bool) -> Result<FitResult, FitError> {
    let r = residuals.at(p);
    let jacobian = residuals.jacobian(p);
    let degrees = r.len() - p.len();
    let covariance = jacobian.tr_mul(&jacobian).cholesky().ok_or(FitError::Undetermined)?.inverse();
    let chi_squared = r.norm_squared();
    let variance = if weighted { 1.0 } else { chi_squared / degrees as f64 };
    let error = |i: usize| (variance * covariance[(i, i)]).sqrt();
    let fitted = |i: usize| Fitted { value: p[i].exp(), stderr: p[i].exp() * error(i) };
    if !chi_squared.is_finite() || !error(0).is_finite() || !error(1).is_finite() {
        return Err(FitError::Undetermined);
    }
    let curve = residuals.ln_model(p);
    let squares = curve.iter().zip(&residuals.ln_measured).map(|(a, b)| (a - b) * (a - b));
    Ok(FitResult {
        sigma_s_reduced: fitted(0),
        sigma_a: fitted(1),
        scale: (!residuals.absolute).then(|| fitted(2)),
        correlation: covariance[(0, 1)] / (covariance[(0, 0)] * covariance[(1, 1)]).sqrt(),
        chi_squared,
        degrees,
        rms: (squares.sum::<f64>() / r.len() as f64).sqrt(),
        weighted,
        curve: curve.iter().map(|ln| ln.exp()).collect(),
    })
}

/// A fitted value times `factor`, with its error, as `1.234 ± 0.005`.
pub fn in_words(fitted: Fitted, factor: f64) -> String {
    format!("{} ± {}", significant(factor * fitted.value), significant(factor * fitted.stderr))
}

/// The measured points and the curve through them, in millimetres.
///
/// # Errors
/// If it cannot be drawn.
pub fn figure(
    problem: &FitProblem,
    measured: &MeasuredProfile,
    result: &FitResult,
) -> Result<String, PlotError> {
    let per_area = if measured.absolute { 1e-6 } else { 1.0 };
    let mut curve: Vec<(f64, f64)> = measured
        .points
        .iter()
        .zip(&result.curve)
        .map(|(point, &value)| (1e3 * point.radius, value * per_area))
        .collect();
    curve.sort_by(|a, b| a.0.total_cmp(&b.0));
    let dots: Vec<Dot> = measured
        .points
        .iter()
        .map(|point| Dot {
            x: 1e3 * point.radius,
            y: point.reflectance * per_area,
            error: point.sigma.unwrap_or(0.0) * per_area,
        })
        .collect();
    let range = |values: &mut dyn Iterator<Item = f64>, margin: f64| {
        let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
        low / margin..high * margin
    };
    let label = if measured.absolute { "R(r) [1/mm²]" } else { "R(r) [as measured]" };
    let title = format!(
        "σs′ = ({}) /mm, σa = ({}) /mm",
        in_words(result.sigma_s_reduced, 1e-3),
        in_words(result.sigma_a, 1e-3)
    );
    svg(&[Panel {
        title,
        x: Axis {
            label: "radius r [mm]".into(),
            range: range(&mut dots.iter().map(|dot| dot.x), 1.2),
            log: true,
        },
        y: Axis { label: label.into(), range: range(&mut dots.iter().map(|dot| dot.y), 2.0), log: true },
        lines: vec![Line {
            name: format!("{} fitted", problem.model.name()),
            style: style(ModelChoice::Tabulated),
            points: curve,
        }],
        dots: vec![Dots { name: "measured, ±σ".into(), color: [0; 3], points: dots }],
    }])
}
