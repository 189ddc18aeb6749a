//! Scattering media by wavelength, from tables of comma-separated values.
//!
//! The first line that is neither empty nor a comment (`#`) names the columns, in any order: `wavelength` in nm,
//! `mu_a` and either `mu_s` or `mu_s_reduced` in 1/m or in a unit behind the name, `mu_a [1/mm]`, and, where known, `g`
//! and `n`.

use thiserror::Error;

use super::table::{TableError, Wavelengths, not_negative};

/// A medium at one wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectralMedium {
    /// Absorption coefficient μ_a, 1/m.
    pub mu_a: f64,
    /// Scattering coefficient μ_s, 1/m (not reduced).
    pub mu_s: f64,
    /// Mean cosine g of the phase function.
    pub g: f64,
    /// Index of refraction, where the table has it.
    pub ior: Option<f64>,
}

/// A medium by wavelength: linear between rows, constant beyond the first and the last.
#[derive(Clone, Debug, PartialEq)]
pub struct MediumTable {
    wavelengths: Wavelengths,
    mu_a: Vec<f64>,
    /// As the table has it.
    scattering: Vec<f64>,
    is_reduced: bool,
    /// 0 where the table has none.
    g: Vec<f64>,
    has_g: bool,
    /// Empty where the table has none.
    ior: Vec<f64>,
}

/// What is wrong with a table, and in which line.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("line {line}: {problem}")]
pub struct MediumTableError {
    /// Line, from 1.
    pub line: usize,
    /// What is wrong.
    pub problem: MediumTableProblem,
}

/// What is wrong with a line.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum MediumTableProblem {
    /// No row at all.
    #[error(transparent)]
    Table(#[from] TableError),
    /// A wavelength or a coefficient that no spectrum has.
    #[error("{column}: {problem}")]
    Value {
        /// Of which column.
        column: &'static str,
        /// What is wrong.
        problem: TableError,
    },
    /// A column that is not known.
    #[error("\"{0}\" is no column; known are wavelength, mu_a, mu_s, mu_s_reduced, g, n")]
    UnknownColumn(String),
    /// A unit that is not known.
    #[error("\"{unit}\" is no unit of {column}; known are {known}")]
    UnknownUnit {
        /// What was given.
        unit: String,
        /// Of what.
        column: &'static str,
        /// What could be given.
        known: &'static str,
    },
    /// A column that is there twice.
    #[error("{0} is there twice")]
    RepeatedColumn(&'static str),
    /// A column that must be there.
    #[error("there is no {0}")]
    MissingColumn(&'static str),
    /// Both scattering coefficients.
    #[error("mu_s and mu_s_reduced are both there; leave one of them out")]
    BothScattering,
    /// A line of another length than the header.
    #[error("{found} values, but the header names {named} columns")]
    Length {
        /// Values in the line.
        found: usize,
        /// Columns of the header.
        named: usize,
    },
    /// A value that is no number.
    #[error("\"{text}\" is no number ({column})")]
    NoNumber {
        /// What was given.
        text: String,
        /// For what.
        column: &'static str,
    },
    /// A mean cosine that no phase function has, or that leaves μ_s = μ_s'/(1 − g) unknown.
    #[error("g = {0}; it must lie between -1 and 1")]
    MeanCosine(f64),
    /// An index not above 0.
    #[error("n = {0}; it must be finite and above 0")]
    Ior(f64),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Column {
    Wavelength,
    MuA,
    MuS,
    MuSReduced,
    G,
    Ior,
}

const COLUMNS: [(&str, Column); 6] = [
    ("wavelength", Column::Wavelength),
    ("mu_a", Column::MuA),
    ("mu_s", Column::MuS),
    ("mu_s_reduced", Column::MuSReduced),
    ("g", Column::G),
    ("n", Column::Ior),
];

/// Coefficients in 1/m.
const UNITS: [(&str, f64); 3] = [("1/m", 1.0), ("1/cm", 100.0), ("1/mm", 1000.0)];

/// A column as the header names it.
#[derive(Clone, Copy)]
struct Heading {
    column: Column,
    name: &'static str,
    /// What its values are multiplied by.
    unit: f64,
}

impl MediumTable {
    /// Reads a table.
    ///
    /// # Errors
    /// If columns are unknown or missing, or a row has no place in a spectrum: out of range, not ascending, there already, or
    /// negative. The error names the line.
    pub fn parse(text: &str) -> Result<Self, MediumTableError> {
        let lines = (1..).zip(text.trim_start_matches('\u{feff}').lines().map(str::trim));
        let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
        let Some((line, header)) = lines.next() else {
            return Err(MediumTableError { line: 1, problem: TableError::Empty.into() });
        };
        let headings = headings(header).map_err(|problem| MediumTableError { line, problem })?;
        let mut table = Self {
            wavelengths: Wavelengths::default(),
            mu_a: Vec::new(),
            scattering: Vec::new(),
            is_reduced: headings.iter().any(|heading| heading.column == Column::MuSReduced),
            g: Vec::new(),
            has_g: headings.iter().any(|heading| heading.column == Column::G),
            ior: Vec::new(),
        };
        for (line, row) in lines {
            table.push(&headings, row).map_err(|problem| MediumTableError { line, problem })?;
        }
        if table.wavelengths.is_empty() {
            return Err(MediumTableError { line, problem: TableError::Empty.into() });
        }
        Ok(table)
    }

    fn push(&mut self, headings: &[Heading], row: &str) -> Result<(), MediumTableProblem> {
        let values: Vec<&str> = row.split(',').map(str::trim).collect();
        if values.len() != headings.len() {
            return Err(MediumTableProblem::Length { found: values.len(), named: headings.len() });
        }
        let value = |column: Column| {
            let found = headings.iter().zip(&values).find(|(heading, _)| heading.column == column);
            found.map(|(heading, text)| match text.parse::<f64>() {
                Ok(number) => Ok(number * heading.unit),
                Err(_) => Err(MediumTableProblem::NoNumber { text: (*text).into(), column: heading.name }),
            })
        };
        let required = |column: Column| value(column).unwrap_or(Ok(0.0));
        let nanometres = required(Column::Wavelength)?;
        let named =
            |column: &'static str| move |problem: TableError| MediumTableProblem::Value { column, problem };
        self.wavelengths.push(nanometres).map_err(named("wavelength"))?;
        self.mu_a.push(not_negative(required(Column::MuA)?, nanometres).map_err(named("mu_a"))?);
        let (scattering, name) = match self.is_reduced {
            true => (Column::MuSReduced, "mu_s_reduced"),
            false => (Column::MuS, "mu_s"),
        };
        self.scattering.push(not_negative(required(scattering)?, nanometres).map_err(named(name))?);
        let g = value(Column::G).unwrap_or(Ok(0.0))?;
        if !(g > -1.0 && g < 1.0) {
            return Err(MediumTableProblem::MeanCosine(g));
        }
        self.g.push(g);
        if let Some(ior) = value(Column::Ior).transpose()? {
            if !(ior > 0.0 && ior.is_finite()) {
                return Err(MediumTableProblem::Ior(ior));
            }
            self.ior.push(ior);
        }
        Ok(())
    }

    /// The medium at a wavelength in nm.
    pub fn at(&self, nanometres: f64) -> SpectralMedium {
        let place = self.wavelengths.place(nanometres);
        let g = place.value(&self.g);
        let scattering = place.value(&self.scattering);
        SpectralMedium {
            mu_a: place.value(&self.mu_a),
            mu_s: if self.is_reduced { scattering / (1.0 - g) } else { scattering },
            g,
            ior: (!self.ior.is_empty()).then(|| place.value(&self.ior)),
        }
    }

    /// The medium of mean cosine `g` with the same reduced scattering μ_s' = μ_s (1 − g), at a wavelength in nm.
    pub fn similar(&self, nanometres: f64, g: f64) -> SpectralMedium {
        let medium = self.at(nanometres);
        SpectralMedium { mu_s: medium.mu_s * ((1.0 - medium.g) / (1.0 - g)), g, ..medium }
    }

    /// True if the table has a column of mean cosines.
    pub fn has_mean_cosine(&self) -> bool {
        self.has_g
    }

    /// Gives all rows the mean cosine `g`, between −1 and 1; μ_s' or μ_s stays what the table has.
    pub fn set_mean_cosine(&mut self, g: f64) {
        self.g.fill(g);
    }

    /// Least and greatest mean cosine.
    pub fn mean_cosines(&self) -> [f64; 2] {
        extremes(&self.g)
    }

    /// Least and greatest index of refraction, where the table has them.
    pub fn indices(&self) -> Option<[f64; 2]> {
        (!self.ior.is_empty()).then(|| extremes(&self.ior))
    }

    /// First and last wavelength of the table, nm.
    pub fn range(&self) -> Option<[f64; 2]> {
        self.wavelengths.range()
    }
}

fn extremes(values: &[f64]) -> [f64; 2] {
    let widen = |[low, high]: [f64; 2], value: &f64| [low.min(*value), high.max(*value)];
    values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], widen)
}

/// The columns that a header names.
fn headings(header: &str) -> Result<Vec<Heading>, MediumTableProblem> {
    let headings = header.split(',').map(heading).collect::<Result<Vec<_>, _>>()?;
    let has = |column: Column| headings.iter().any(|heading| heading.column == column);
    for (i, heading) in headings.iter().enumerate() {
        if headings[..i].iter().any(|earlier| earlier.column == heading.column) {
            return Err(MediumTableProblem::RepeatedColumn(heading.name));
        }
    }
    match () {
        () if !has(Column::Wavelength) => Err(MediumTableProblem::MissingColumn("wavelength")),
        () if !has(Column::MuA) => Err(MediumTableProblem::MissingColumn("mu_a")),
        () if has(Column::MuS) && has(Column::MuSReduced) => Err(MediumTableProblem::BothScattering),
        () if !has(Column::MuS) && !has(Column::MuSReduced) => {
            Err(MediumTableProblem::MissingColumn("mu_s or mu_s_reduced"))
        }
        () => Ok(headings),
    }
}

/// `name` or `name [unit]`.
fn heading(text: &str) -> Result<Heading, MediumTableProblem> {
    let text = text.trim();
    let (named, unit) = match text.strip_suffix(']').and_then(|text| text.split_once('[')) {
        Some((named, unit)) => (named.trim(), Some(unit.trim())),
        None => (text, None),
    };
    let found = COLUMNS.into_iter().find(|(name, _)| *name == named);
    let Some((name, column)) = found else { return Err(MediumTableProblem::UnknownColumn(named.into())) };
    let known_units: (&[(&str, f64)], &'static str) = match column {
        Column::Wavelength => (&[("nm", 1.0)], "nm"),
        Column::MuA | Column::MuS | Column::MuSReduced => (&UNITS, "1/m, 1/cm, 1/mm"),
        Column::G | Column::Ior => (&[("1", 1.0)], "1"),
    };
    let unit = match unit {
        None => 1.0,
        Some(unit) => {
            known_units.0.iter().find(|(name, _)| *name == unit).map(|known| known.1).ok_or_else(|| {
                MediumTableProblem::UnknownUnit { unit: unit.into(), column: name, known: known_units.1 }
            })?
        }
    };
    Ok(Heading { column, name, unit })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_read_and_interpolated() {
        let text = "\u{feff}# skin, made up\n\nwavelength [nm], mu_a [1/mm], mu_s_reduced [1/cm], g, n\n\
                    400, 1.0, 20, 0.8, 1.40\n500, 0.5, 10, 0.9, 1.38\r\n\n600, 0, 10, 0.9, 1.37\n";
        let table = MediumTable::parse(text).unwrap();
        assert_eq!(table.range(), Some([400.0, 600.0]));
        let at = table.at(500.0);
        assert_eq!((at.mu_a, at.g, at.ior), (500.0, 0.9, Some(1.38)));
        // μ_s = μ_s'/(1 − g), one rounding in 1 − g.
        assert!((at.mu_s - 1e4).abs() < 1e4 * 8.0 * f64::EPSILON, "{}", at.mu_s);
        assert!((table.at(450.0).mu_a - 750.0).abs() < 1e-9);
        assert_eq!(table.at(360.0), table.at(400.0));
        let plain = MediumTable::parse("mu_s,wavelength,mu_a\n3,550,2\n").unwrap();
        assert_eq!(plain.at(600.0), SpectralMedium { mu_a: 2.0, mu_s: 3.0, g: 0.0, ior: None });
    }

    #[test]
    fn another_mean_cosine_keeps_reduced_scattering() {
        let mut table = MediumTable::parse("wavelength,mu_a,mu_s,g\n400,1,100,0.8\n600,1,100,0.9\n").unwrap();
        assert_eq!(
            (table.mean_cosines(), table.indices(), table.has_mean_cosine()),
            ([0.8, 0.9], None, true)
        );
        for (nanometres, reduced) in [(400.0, 20.0), (500.0, 15.0), (600.0, 10.0)] {
            let similar = table.similar(nanometres, 0.5);
            // Roundings of 1 − g, which is 0.1 at least.
            assert!((similar.mu_s * 0.5 - reduced).abs() < 1e-12, "{similar:?}");
            assert_eq!((similar.g, similar.mu_a), (0.5, 1.0));
        }
        table.set_mean_cosine(0.25);
        assert_eq!((table.at(400.0).g, table.at(400.0).mu_s), (0.25, 100.0));
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        let header = "wavelength,mu_a,mu_s,g,n\n400,1,1,0,1.4\n# comment\n";
        let cases = [
            ("300,1,1,0,1.4", "line 4: wavelength: 300 nm is out of range"),
            ("390,1,1,0,1.4", "line 4: wavelength: 390 nm comes after 400 nm"),
            ("400,1,1,0,1.4", "line 4: wavelength: 400 nm is there already"),
            ("410,-1,1,0,1.4", "line 4: mu_a: -1 at 410 nm"),
            ("410,1,NaN,0,1.4", "line 4: mu_s: NaN at 410 nm"),
            ("410,1,1,1,1.4", "line 4: g = 1"),
            ("410,1,1,0,0", "line 4: n = 0"),
            ("410,1,1", "line 4: 3 values, but the header names 5 columns"),
            ("410,one,1,0,1", "line 4: \"one\" is no number (mu_a)"),
        ];
        for (row, message) in cases {
            let error = MediumTable::parse(&format!("{header}{row}\n")).unwrap_err().to_string();
            assert!(error.starts_with(message), "{error}");
        }
        let headers = [
            ("", "line 1: there is no row"),
            ("wavelength,mu_a,mu_s\n", "line 1: there is no row"),
            ("lambda,mu_a,mu_s\n", "line 1: \"lambda\" is no column"),
            ("wavelength,mu_a [1/in],mu_s\n", "line 1: \"1/in\" is no unit of mu_a"),
            ("wavelength,mu_a,mu_a,mu_s\n", "line 1: mu_a is there twice"),
            ("wavelength,mu_s\n", "line 1: there is no mu_a"),
            ("wavelength,mu_a\n", "line 1: there is no mu_s or mu_s_reduced"),
            ("wavelength,mu_a,mu_s,mu_s_reduced\n", "line 1: mu_s and mu_s_reduced are both there"),
        ];
        for (text, message) in headers {
            let error = MediumTable::parse(text).unwrap_err().to_string();
            assert!(error.starts_with(message), "{error}");
        }
    }
}
