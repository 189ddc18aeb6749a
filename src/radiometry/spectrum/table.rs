//! Spectra given as tables.

use thiserror::Error;

use super::{LONGEST, SHORTEST};

/// A table is no spectrum.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum TableError {
    /// A wavelength that is not visible.
    #[error("{0} nm is out of range: wavelengths go from {SHORTEST} to {LONGEST} nm")]
    OutOfRange(f64),
    /// A wavelength below the one before.
    #[error("{later} nm comes after {earlier} nm: wavelengths must be sorted, ascending")]
    Unsorted {
        /// The one before.
        earlier: f64,
        /// The one that is less.
        later: f64,
    },
    /// A wavelength that is there twice.
    #[error("{0} nm is there already: tables must not overlap")]
    Overlapping(f64),
    /// A value that no spectrum has.
    #[error("{value} at {nanometres} nm; it must be finite and not negative")]
    Negative {
        /// The value.
        value: f64,
        /// Where.
        nanometres: f64,
    },
    /// No row.
    #[error("there is no row")]
    Empty,
}

/// Wavelengths in ascending order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wavelengths {
    nanometres: Vec<f64>,
}

/// Where a wavelength is among those of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    row: usize,
    next: usize,
    /// Share of the next row.
    t: f64,
}

impl Wavelengths {
    /// Appends one.
    ///
    /// # Errors
    /// If it is not visible, or not above the one before.
    pub fn push(&mut self, nanometres: f64) -> Result<(), TableError> {
        if !(SHORTEST..=LONGEST).contains(&nanometres) {
            return Err(TableError::OutOfRange(nanometres));
        }
        match self.nanometres.last() {
            Some(&earlier) if nanometres < earlier => {
                return Err(TableError::Unsorted { earlier, later: nanometres });
            }
            Some(&earlier) if nanometres == earlier => return Err(TableError::Overlapping(nanometres)),
            _ => self.nanometres.push(nanometres),
        }
        Ok(())
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.nanometres.len()
    }

    /// True if there are none.
    pub fn is_empty(&self) -> bool {
        self.nanometres.is_empty()
    }

    /// First and last, nm.
    pub fn range(&self) -> Option<[f64; 2]> {
        Some([*self.nanometres.first()?, *self.nanometres.last()?])
    }

    /// Where `nanometres` is; beyond the ends, at the ends.
    pub fn place(&self, nanometres: f64) -> Place {
        let next = self.nanometres.partition_point(|&w| w <= nanometres);
        let last = self.nanometres.len().saturating_sub(1);
        if next == 0 || next > last {
            let row = if next == 0 { 0 } else { last };
            return Place { row, next: row, t: 0.0 };
        }
        let (low, high) = (self.nanometres[next - 1], self.nanometres[next]);
        Place { row: next - 1, next, t: (nanometres - low) / (high - low) }
    }
}

impl Place {
    /// Of a column, linear between rows.
    pub fn value(&self, column: &[f64]) -> f64 {
        column[self.row] + (column[self.next] - column[self.row]) * self.t
    }
}

/// A spectrum by its values at some wavelengths: linear between them, constant beyond the first and the last.
#[derive(Clone, Debug, PartialEq)]
pub struct TabulatedSpectrum {
    wavelengths: Wavelengths,
    values: Vec<f64>,
}

impl TabulatedSpectrum {
    /// From pairs of wavelength (nm) and value.
    ///
    /// # Errors
    /// If there is none, if wavelengths are not visible or do not ascend, or if a value is not finite and not negative.
    pub fn new(rows: impl IntoIterator<Item = (f64, f64)>) -> Result<Self, TableError> {
        let (mut wavelengths, mut values) = (Wavelengths::default(), Vec::new());
        for (nanometres, value) in rows {
            wavelengths.push(nanometres)?;
            values.push(not_negative(value, nanometres)?);
        }
        if values.is_empty() { Err(TableError::Empty) } else { Ok(Self { wavelengths, values }) }
    }

    /// The value at `nanometres`.
    pub fn value(&self, nanometres: f64) -> f64 {
        self.wavelengths.place(nanometres).value(&self.values)
    }
}

/// `value`, if a spectrum can have it.
pub(super) fn not_negative(value: f64, nanometres: f64) -> Result<f64, TableError> {
    if value >= 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(TableError::Negative { value, nanometres })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_linear_between_rows_and_constant_beyond() {
        let spectrum = TabulatedSpectrum::new([(400.0, 1.0), (500.0, 3.0), (520.0, 0.0)]).unwrap();
        for (nanometres, value) in [
            (360.0, 1.0),
            (400.0, 1.0),
            (450.0, 2.0),
            (500.0, 3.0),
            (515.0, 0.75),
            (520.0, 0.0),
            (830.0, 0.0),
        ] {
            assert_eq!(spectrum.value(nanometres), value, "{nanometres}");
        }
        let alone = TabulatedSpectrum::new([(550.0, 2.0)]).unwrap();
        assert_eq!([400.0, 550.0, 700.0].map(|w| alone.value(w)), [2.0; 3]);
    }

    #[test]
    fn what_is_no_spectrum_is_refused_by_name() {
        let refused = |rows: &[(f64, f64)]| TabulatedSpectrum::new(rows.iter().copied()).unwrap_err();
        assert_eq!(refused(&[]), TableError::Empty);
        assert_eq!(refused(&[(0.55, 1.0)]), TableError::OutOfRange(0.55));
        assert_eq!(refused(&[(400.0, 1.0), (831.0, 1.0)]), TableError::OutOfRange(831.0));
        assert!(matches!(refused(&[(f64::NAN, 1.0)]), TableError::OutOfRange(_)));
        let unsorted = TableError::Unsorted { earlier: 500.0, later: 400.0 };
        assert_eq!(refused(&[(500.0, 1.0), (400.0, 1.0)]), unsorted);
        assert_eq!(refused(&[(500.0, 1.0), (500.0, 2.0)]), TableError::Overlapping(500.0));
        assert_eq!(refused(&[(500.0, -1.0)]), TableError::Negative { value: -1.0, nanometres: 500.0 });
        assert!(matches!(refused(&[(500.0, f64::INFINITY)]), TableError::Negative { .. }));
    }
}
