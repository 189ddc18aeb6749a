//! Errors of `diffuse` and `bssrdf` to be expected, from a table that was measured on simple bodies.
//!
//! The table (`method_errors.csv`, made by `examples/make_method_table.rs`) has the relative mean square error over the pixels of a sphere, a cube and a
//! slab, lit from the front, from the side and from all around, over three numbers without a unit: the relative index η, the
//! share κ = σ_a/σ_t' absorbed at a collision and the mean chord τ in free paths 1/σ_t'. It has noise, which is dealt with so that
//! an expectation is rather too large:
//!
//! - over τ each series is replaced by the falling one that is nearest to it, with two of its standard errors on top, and what limits the error of a body limits that of thicker ones;
//! - of the lights the largest counts, and for a body with edges the larger of sphere and cube;
//! - between nodes of τ the error is linear in log τ, which is above a curve that falls as a power; between nodes of η and κ the larger one is taken;
//! - beyond the last τ it stays what it is; beyond all other ends nothing is expected.

use std::sync::OnceLock;

use super::body::Body;
use super::isotonic::{Estimate, falling};

const TABLE: &str = include_str!("method_errors.csv");

/// Standard errors on top of what was measured.
const MARGIN: f64 = 2.0;

/// The form of a body, as far as the table knows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Wide faces: the slab.
    Flat,
    /// Sharp edges: sphere and cube.
    Edged,
    /// All else: the sphere.
    Smooth,
}

impl Form {
    const ALL: [Self; 3] = [Self::Flat, Self::Edged, Self::Smooth];

    /// Of a body.
    pub fn of(body: &Body) -> Self {
        match body {
            body if body.is_flat() => Self::Flat,
            body if body.is_smooth() => Self::Smooth,
            _ => Self::Edged,
        }
    }

    /// The bodies of the table that stand for it.
    fn bodies(self) -> &'static [&'static str] {
        match self {
            Self::Flat => &["slab"],
            Self::Edged => &["sphere", "cube"],
            Self::Smooth => &["sphere"],
        }
    }
}

/// What the table is looked up by.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Form of the body.
    pub form: Form,
    /// Relative index of refraction η.
    pub eta: f64,
    /// κ = σ_a/σ_t'.
    pub absorbed: f64,
    /// τ = σ_t' 4V/S.
    pub thickness: f64,
}

/// Relative errors (roots of mean squares) to be expected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelErrors {
    /// Where light leaves where it entered.
    pub diffuse: f64,
    /// Of the area integral with its tabulated profile.
    pub bssrdf: f64,
}

impl ModelErrors {
    /// At a place; `None` beyond the table.
    pub fn at(place: &Place) -> Option<Self> {
        static CURVES: OnceLock<Vec<Curve>> = OnceLock::new();
        let curves: Vec<&Curve> =
            CURVES.get_or_init(curves).iter().filter(|curve| curve.form == place.form).collect();
        let etas = around(curves.iter().map(|curve| curve.eta), place.eta)?;
        let shares = around(curves.iter().map(|curve| curve.absorbed), place.absorbed)?;
        let near = curves.iter().filter(|c| etas.contains(&c.eta) && shares.contains(&c.absorbed));
        near.map(|curve| curve.at(place.thickness)).reduce(|a, b| Some(a?.larger(b?)))?
    }

    fn larger(self, other: Self) -> Self {
        Self { diffuse: self.diffuse.max(other.diffuse), bssrdf: self.bssrdf.max(other.bssrdf) }
    }
}

/// Errors of a form by thickness.
struct Curve {
    form: Form,
    eta: f64,
    absorbed: f64,
    /// Thickness, rising, and the errors there.
    nodes: Vec<(f64, ModelErrors)>,
}

impl Curve {
    fn at(&self, thickness: f64) -> Option<ModelErrors> {
        let after = self.nodes.iter().position(|&(node, _)| node >= thickness);
        let Some(after) = after else {
            return self.nodes.last().filter(|_| !thickness.is_nan()).map(|&(_, errors)| errors);
        };
        let (high, above) = self.nodes[after];
        let Some(&(low, below)) = after.checked_sub(1).and_then(|i| self.nodes.get(i)) else {
            return (high == thickness).then_some(above);
        };
        let t = (thickness / low).ln() / (high / low).ln();
        let between = |a: f64, b: f64| a + (b - a) * t;
        Some(ModelErrors {
            diffuse: between(below.diffuse, above.diffuse),
            bssrdf: between(below.bssrdf, above.bssrdf),
        })
    }
}

/// The nodes on either side of `x`, which may be one.
fn around(nodes: impl Iterator<Item = f64> + Clone, x: f64) -> Option<[f64; 2]> {
    let below = nodes.clone().filter(|&node| node <= x * (1.0 + ROUNDING)).reduce(f64::max)?;
    let above = nodes.filter(|&node| node >= x * (1.0 - ROUNDING)).reduce(f64::min)?;
    Some([below, above])
}

/// Of numbers in single precision, the table's as well.
const ROUNDING: f64 = 1e-5;

/// A row of the table.
#[derive(Clone, Debug)]
struct Row {
    body: String,
    eta: f64,
    absorbed: f64,
    thickness: f64,
    light: String,
    diffuse: Estimate,
    bssrdf: Estimate,
}

fn rows() -> Vec<Row> {
    TABLE.lines().filter_map(row).collect()
}

/// `None` for what is none.
fn row(line: &str) -> Option<Row> {
    let fields: Vec<&str> = line.split(',').collect();
    let number = |i: usize| fields.get(i)?.parse::<f64>().ok();
    Some(Row {
        body: (*fields.first()?).to_owned(),
        eta: number(1)?,
        absorbed: number(2)?,
        thickness: number(3)?,
        light: (*fields.get(4)?).to_owned(),
        diffuse: estimate(number(5)?, number(6)?),
        bssrdf: estimate(number(8)?, number(9)?),
    })
}

/// Of a mean square, whose standard error is never quite 0.
fn estimate(value: f64, sigma: f64) -> Estimate {
    Estimate { value, sigma: sigma.max(1e-7) }
}

fn curves() -> Vec<Curve> {
    let mut rows = rows();
    rows.sort_by(|a, b| a.thickness.total_cmp(&b.thickness));
    let mut curves: Vec<Curve> = Vec::new();
    while let Some(first) = rows.first().cloned() {
        let same = |row: &mut Row| {
            (row.eta, row.absorbed) == (first.eta, first.absorbed)
                && row.light == first.light
                && row.body == first.body
        };
        let series: Vec<Row> = rows.extract_if(.., same).collect();
        let nodes = errors(&series);
        for form in Form::ALL.into_iter().filter(|form| form.bodies().contains(&first.body.as_str())) {
            add(&mut curves, Curve { form, eta: first.eta, absorbed: first.absorbed, nodes: nodes.clone() });
        }
    }
    curves
}

/// Adds a curve, or makes the one at its place as large.
fn add(curves: &mut Vec<Curve>, new: Curve) {
    let at_its_place =
        |curve: &&mut Curve| (curve.form, curve.eta, curve.absorbed) == (new.form, new.eta, new.absorbed);
    match curves.iter_mut().find(at_its_place) {
        Some(curve) => {
            for (node, (_, errors)) in curve.nodes.iter_mut().zip(new.nodes) {
                node.1 = node.1.larger(errors);
            }
        }
        None => curves.push(new),
    }
}

/// Errors by thickness of a body in one light.
fn errors(series: &[Row]) -> Vec<(f64, ModelErrors)> {
    let upper = |of: fn(&Row) -> Estimate| {
        let squares = falling(&series.iter().map(of).collect::<Vec<_>>());
        // What limits the error of a body limits that of thicker ones.
        squares.into_iter().scan(f64::INFINITY, |least, square| {
            *least = least.min((square.value.max(0.0) + MARGIN * square.sigma).sqrt());
            Some(*least)
        })
    };
    let (diffuse, bssrdf) = (upper(|row| row.diffuse), upper(|row| row.bssrdf));
    let errors = diffuse.zip(bssrdf).map(|(diffuse, bssrdf)| ModelErrors { diffuse, bssrdf });
    series.iter().map(|row| row.thickness).zip(errors).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_is_read_and_every_curve_is_whole() {
        let lines = TABLE.lines().filter(|line| !line.starts_with('#')).count() - 1;
        assert_eq!(rows().len(), lines);
        let curves = curves();
        // As many forms as bodies, each body in three lights.
        assert_eq!(curves.len() * curves[0].nodes.len() * 3, lines);
        for curve in &curves {
            assert_eq!(curve.nodes.len(), curves[0].nodes.len());
            for pair in curve.nodes.windows(2) {
                assert!(pair[0].0 < pair[1].0);
            }
        }
    }

    #[test]
    fn thicker_bodies_have_smaller_errors() {
        for form in Form::ALL {
            for eta in [1.0, 1.2, 1.33, 1.4, 1.5] {
                for absorbed in [0.0, 1e-4, 1e-3, 0.03, 0.4] {
                    let at = |thickness| ModelErrors::at(&Place { form, eta, absorbed, thickness }).unwrap();
                    let mut thinner = at(1.0);
                    for i in 1..40 {
                        let errors = at(1.3_f64.powi(i));
                        assert!(errors.bssrdf > 0.0 && errors.diffuse > 0.0);
                        assert!(errors.larger(thinner) == thinner, "{form:?} {eta} {absorbed} {i}");
                        thinner = errors;
                    }
                }
            }
        }
    }

    #[test]
    fn nothing_is_expected_beyond_the_table() {
        let inside = Place { form: Form::Smooth, eta: 1.5, absorbed: 0.01, thickness: 10.0 };
        assert!(ModelErrors::at(&inside).is_some());
        for outside in [
            Place { eta: 0.8, ..inside },
            Place { eta: 2.0, ..inside },
            Place { eta: f64::NAN, ..inside },
            Place { absorbed: 0.9, ..inside },
            Place { absorbed: f64::NAN, ..inside },
            Place { thickness: 0.5, ..inside },
            Place { thickness: f64::NAN, ..inside },
        ] {
            assert_eq!(ModelErrors::at(&outside), None, "{outside:?}");
        }
    }
}
