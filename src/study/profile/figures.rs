//! The pictures of a comparison.

use super::comparison::{ChannelResult, Quantity};
use super::models::ModelChoice;
use super::rings::{COMPARED, Rings, inner_radius, middle_radius, outer_radius};
use crate::diffusion::{Fit, ModelKind};
use crate::study::numbers::significant;
use crate::study::plot::{Axis, Dot, Dots, Line, Panel, PlotError, Style, svg};

/// Colours of Okabe and Ito 2008, which colour-blind people tell apart, and dashes.
pub fn style(choice: ModelChoice) -> Style {
    let (color, dashes) = match choice {
        ModelChoice::Analytic(ModelKind::Dipole) => ([0xe6, 0x9f, 0x00], "9 4"),
        ModelChoice::Analytic(ModelKind::BetterDipole) => ([0x56, 0xb4, 0xe9], "3 3"),
        ModelChoice::Analytic(ModelKind::DirectionalDipole) => ([0x00, 0x9e, 0x73], "12 4 3 4"),
        ModelChoice::Analytic(ModelKind::NormalizedDiffusion) => ([0xd5, 0x5e, 0x00], "6 3"),
        ModelChoice::Analytic(ModelKind::PhotonBeam) => ([0xcc, 0x79, 0xa7], "12 3 3 3 3 3"),
        ModelChoice::Tabulated => ([0x00, 0x72, 0xb2], ""),
        ModelChoice::Multipole => ([0xd5, 0x5e, 0x01], "9 4"),
        ModelChoice::Normalized(Fit::Searchlight) => ([0x99, 0x99, 0x33], "2 5"),
        ModelChoice::Normalized(Fit::DiffuseTransmission) => ([0x88, 0x22, 0x55], "5 5"),
        ModelChoice::Normalized(Fit::DiffuseMeanFreePath) => ([0x66, 0x66, 0x66], "1 3"),
    };
    Style { color, dashes }
}

/// Makes one kind of picture.
type ToPanel = fn(&View) -> Panel;

/// The four pictures of `results`, a panel for each: names and contents of the files.
///
/// # Errors
/// If a picture cannot be drawn.
pub fn figures(results: &[ChannelResult]) -> Result<Vec<(&'static str, String)>, PlotError> {
    let kinds: [(&'static str, ToPanel); 4] = [
        ("profile_log.svg", logarithmic),
        ("profile_linear.svg", linear),
        ("profile_radius_times_r.svg", radius_times_density),
        ("profile_cumulative.svg", cumulative),
    ];
    kinds
        .into_iter()
        .map(|(name, panel)| {
            let panels: Vec<Panel> = results.iter().map(|result| panel(&View::new(result))).collect();
            Ok((name, svg(&panels)?))
        })
        .collect()
}

/// A result in millimetres, and where in it there is something to see.
struct View<'a> {
    result: &'a ChannelResult,
    /// Mean free path, mm.
    unit: f64,
    symbol: &'static str,
}

/// Where logarithmic pictures begin, in mean free paths.
const FIRST: f64 = 1e-2;

impl<'a> View<'a> {
    fn new(result: &'a ChannelResult) -> Self {
        let symbol = match result.quantity {
            Quantity::Reflectance => "R",
            Quantity::Transmittance => "T",
        };
        Self { result, unit: 1e3 / result.channel.medium.sigma_t(), symbol }
    }

    /// The radius, mm, within which the share `share` of the light leaves, at most 100 mean free paths.
    fn radius_of_share(&self, share: f64) -> f64 {
        let truth = &self.result.truth;
        let wanted = share * truth.total().value;
        let ring = COMPARED.clone().find(|&i| truth.inside[i].value >= wanted).unwrap_or(COMPARED.end - 1);
        self.unit * outer_radius(ring).max(3.0)
    }

    fn panel(&self, x: Axis, y: Axis, value: impl Fn(&Rings, usize) -> (f64, f64, f64)) -> Panel {
        let lines = self.result.models.iter().map(|model| Line {
            name: model.choice.name().into(),
            style: style(model.choice),
            points: COMPARED
                .map(|i| value(&model.rings, i))
                .map(|(radius, value, _)| (radius * self.unit, value))
                .collect(),
        });
        let dots = COMPARED.map(|i| value(&self.result.truth, i)).map(|(radius, y, error)| Dot {
            x: radius * self.unit,
            y,
            error: 2.0 * error,
        });
        Panel {
            title: self.title(),
            x,
            y,
            lines: lines.collect(),
            dots: vec![Dots { name: "Monte Carlo, ±2σ".into(), color: [0; 3], points: dots.collect() }],
        }
    }

    fn title(&self) -> String {
        let medium = &self.result.channel.medium;
        let name = match self.result.channel.name {
            "all" => String::new(),
            name => format!("{name}: "),
        };
        format!(
            "{name}mean free path {} mm, α′ {:.4}, g {}, η {}",
            significant(self.unit),
            medium.albedo_reduced(),
            medium.g,
            (medium.eta * 1e4).round() / 1e4
        )
    }

    fn density_label(&self) -> String {
        format!("{}(r) [1/mm²]", self.symbol)
    }

    fn density(&self) -> impl Fn(&Rings, usize) -> (f64, f64, f64) + use<> {
        let per_area = 1.0 / (self.unit * self.unit);
        move |rings, i| {
            let density = rings.density(i) * per_area;
            (middle_radius(i), density.value, density.standard_error)
        }
    }

    fn radius_axis(&self, log: bool, range: std::ops::Range<f64>) -> Axis {
        Axis { label: "radius r [mm]".into(), range, log }
    }

    /// Rings between these radii, mm.
    fn rings(&self, from: f64, to: f64) -> impl Iterator<Item = usize> + use<'_> {
        let seen = move |&i: &usize| {
            inner_radius(i) * self.unit >= 0.99 * from && outer_radius(i) * self.unit <= 1.01 * to
        };
        COMPARED.filter(seen)
    }
}

/// Smallest and largest of some values above 0; an arbitrary range if there are none.
fn extent(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .filter(|x| *x > 0.0 && x.is_finite())
        .fold((f64::INFINITY, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
    if low <= high { (low, high) } else { (0.1, 1.0) }
}

fn logarithmic(view: &View) -> Panel {
    let (from, to) = (FIRST * view.unit, view.radius_of_share(0.9999));
    let density = view.density();
    let (low, high) = extent(view.rings(from, to).map(|i| density(&view.result.truth, i).1));
    let y = Axis { label: view.density_label(), range: 0.3 * low..3.0 * high, log: true };
    view.panel(view.radius_axis(true, from..to), y, density)
}

fn linear(view: &View) -> Panel {
    let to = view.radius_of_share(0.8);
    let density = view.density();
    // Profiles have a pole at the centre; what is seen begins at an eighth of the width.
    let (_, high) = extent(view.rings(to / 8.0, to).map(|i| density(&view.result.truth, i).1));
    let y = Axis { label: view.density_label(), range: 0.0..1.1 * high, log: false };
    view.panel(view.radius_axis(false, 0.0..to), y, density)
}

fn radius_times_density(view: &View) -> Panel {
    let (from, to) = (FIRST * view.unit, view.radius_of_share(0.999));
    let unit = view.unit;
    let density = view.density();
    let value = move |rings: &Rings, i: usize| {
        let (radius, value, error) = density(rings, i);
        (radius, radius * unit * value, radius * unit * error)
    };
    let truths = view.rings(from, to).map(|i| value(&view.result.truth, i).1);
    let (_, high) = extent(truths);
    let y = Axis { label: format!("r {}(r) [1/mm]", view.symbol), range: 0.0..1.7 * high, log: false };
    view.panel(view.radius_axis(true, from..to), y, value)
}

fn cumulative(view: &View) -> Panel {
    let (from, to) = (FIRST * view.unit, view.radius_of_share(0.9999));
    let totals = view.result.models.iter().map(|model| model.albedo).chain([view.result.truth.total().value]);
    let (_, high) = extent(totals);
    let label = match view.result.quantity {
        Quantity::Reflectance => "share of light that leaves within r",
        Quantity::Transmittance => "share of light that passes within r",
    };
    let y = Axis { label: label.into(), range: 0.0..1.05 * high, log: false };
    view.panel(view.radius_axis(true, from..to), y, |rings, i| {
        let inside = rings.inside[i];
        (outer_radius(i), inside.value, inside.standard_error)
    })
}
