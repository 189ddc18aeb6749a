//! Standard illuminants: relative spectral power by wavelength.

use std::array;

use thiserror::Error;

use super::blackbody::Blackbody;
use super::observer::xyz;
use super::{LONGEST, SHORTEST};

/// Second radiation constant at the time of the definition of illuminant A, m K, and the temperature then given to it.
const DEFINITION_OF_A: (f64, f64) = (1.435e-2, 2848.0);

/// Factor on the nominal temperatures of D50 to D75: the second radiation constant has changed since they were named.
const NOMINAL_TO_CORRELATED: f64 = 1.4388 / 1.4380;

/// Correlated colour temperatures of daylight, K.
pub const DAYLIGHT: [f64; 2] = [4000.0, 25_000.0];

/// Spectral power relative to that at 560 nm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Illuminant {
    /// The same at every wavelength.
    E,
    /// An incandescent lamp.
    A,
    /// Daylight, by its share of the second and the third component.
    D([f64; 2]),
}

/// There is no such illuminant.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum IlluminantError {
    /// By name.
    #[error("\"{0}\" is no illuminant; known are A, D50, D55, D65, D75, E")]
    Unknown(String),
    /// By temperature.
    #[error("daylight has correlated colour temperatures from 4000 to 25000 K, not {0} K")]
    Temperature(f64),
}

impl Illuminant {
    /// Daylight of sRGB, Rec.709.
    pub const D65: Self = Self::D([-0.295, -0.689]);

    /// The names of illuminants.
    pub const NAMES: [&'static str; 6] = ["A", "D50", "D55", "D65", "D75", "E"];

    /// The illuminant of a name.
    ///
    /// # Errors
    /// If no illuminant here is named so.
    pub fn from_name(name: &str) -> Result<Self, IlluminantError> {
        let nominal = match name {
            "A" => return Ok(Self::A),
            "E" => return Ok(Self::E),
            "D50" => 5000.0,
            "D55" => 5500.0,
            "D65" => 6500.0,
            "D75" => 7500.0,
            _ => return Err(IlluminantError::Unknown(name.into())),
        };
        Self::daylight(nominal * NOMINAL_TO_CORRELATED)
    }

    /// Its name, if it has one.
    pub fn name(&self) -> Option<&'static str> {
        Self::NAMES.into_iter().find(|name| Self::from_name(name).as_ref() == Ok(self))
    }

    /// Daylight of a correlated colour temperature in K (CIE 15:2018, eqs. 4.7 to 4.12).
    ///
    /// # Errors
    /// If daylight has no such temperature.
    pub fn daylight(temperature: f64) -> Result<Self, IlluminantError> {
        if !(DAYLIGHT[0]..=DAYLIGHT[1]).contains(&temperature) {
            return Err(IlluminantError::Temperature(temperature));
        }
        let t = 1000.0 / temperature;
        let x = if temperature <= 7000.0 {
            ((-4.6070 * t + 2.9678) * t + 0.09911) * t + 0.244_063
        } else {
            ((-2.0064 * t + 1.9018) * t + 0.24748) * t + 0.237_040
        };
        let y = (-3.0 * x + 2.870) * x - 0.275;
        let divisor = 0.0241 + 0.2562 * x - 0.7341 * y;
        // To three places, as the standard has it.
        let share = |numerator: f64| (1000.0 * numerator / divisor).round() / 1000.0;
        let first = share(-1.3515 - 1.7703 * x + 5.9114 * y);
        let second = share(0.0300 - 31.4424 * x + 30.0717 * y);
        Ok(Self::D([first, second]))
    }

    /// Power at `nanometres` relative to that at 560 nm; 0 outside the visible range.
    pub fn relative_power(&self, nanometres: f64) -> f64 {
        if !(SHORTEST..=LONGEST).contains(&nanometres) {
            return 0.0;
        }
        match self {
            Self::E => 1.0,
            Self::A => {
                let (constant, temperature) = DEFINITION_OF_A;
                let lamp = Blackbody::with_exponent(constant / temperature);
                lamp.shape(nanometres) / lamp.shape(560.0)
            }
            Self::D([first, second]) => {
                let [s0, s1, s2] = daylight_components(nanometres);
                (s0 + first * s1 + second * s2) / 100.0
            }
        }
    }

    /// X, Y, Z of a white surface under it, Y being 1.
    pub fn white(&self) -> [f64; 3] {
        let white = xyz(|nanometres| self.relative_power(nanometres));
        white.map(|component| component / white[1])
    }
}

/// Mean daylight and its first two characteristic vectors, linear between rows.
fn daylight_components(nanometres: f64) -> [f64; 3] {
    let place = (nanometres - SHORTEST) / COMPONENT_STEP;
    let row = (place as usize).min(DAYLIGHT_COMPONENTS.len() - 2);
    let (t, rows) = (place - row as f64, &DAYLIGHT_COMPONENTS[row..]);
    array::from_fn(|c| rows[0][c] * (1.0 - t) + rows[1][c] * t)
}

/// Distance of the rows, nm.
const COMPONENT_STEP: f64 = 10.0;

/// S₀, S₁, S₂ of daylight from 360 to 830 nm (CIE 15:2018, table 6).
const DAYLIGHT_COMPONENTS: [[f64; 3]; 48] = [
    [61.5, 38.0, 5.3],
    [68.8, 42.4, 6.1],
    [63.4, 38.5, 3.0],
    [65.8, 35.0, 1.2],
    [94.8, 43.4, -1.1],
    [104.8, 46.3, -0.5],
    [105.9, 43.9, -0.7],
    [96.8, 37.1, -1.2],
    [113.9, 36.7, -2.6],
    [125.6, 35.9, -2.9],
    [125.5, 32.6, -2.8],
    [121.3, 27.9, -2.6],
    [121.3, 24.3, -2.6],
    [113.5, 20.1, -1.8],
    [113.1, 16.2, -1.5],
    [110.8, 13.2, -1.3],
    [106.5, 8.6, -1.2],
    [108.8, 6.1, -1.0],
    [105.3, 4.2, -0.5],
    [104.4, 1.9, -0.3],
    [100.0, 0.0, 0.0],
    [96.0, -1.6, 0.2],
    [95.1, -3.5, 0.5],
    [89.1, -3.5, 2.1],
    [90.5, -5.8, 3.2],
    [90.3, -7.2, 4.1],
    [88.4, -8.6, 4.7],
    [84.0, -9.5, 5.1],
    [85.1, -10.9, 6.7],
    [81.9, -10.7, 7.3],
    [82.6, -12.0, 8.6],
    [84.9, -14.0, 9.8],
    [81.3, -13.6, 10.2],
    [71.9, -12.0, 8.3],
    [74.3, -13.3, 9.6],
    [76.4, -12.9, 8.5],
    [63.3, -10.6, 7.0],
    [71.7, -11.6, 7.6],
    [77.0, -12.2, 8.0],
    [65.2, -10.2, 6.7],
    [47.7, -7.8, 5.2],
    [68.6, -11.2, 7.4],
    [65.0, -10.4, 6.8],
    [66.0, -10.6, 7.0],
    [61.0, -9.7, 6.4],
    [53.3, -8.3, 5.5],
    [58.9, -9.3, 6.1],
    [61.9, -9.8, 6.5],
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::radiometry::spectrum::observer::chromaticity;

    #[test]
    fn d65_is_the_published_table() {
        // CIE 15:2018, table 5: rows of the 5 nm table.
        let published = [
            (360.0, 46.6383),
            (400.0, 82.7549),
            (450.0, 117.008),
            (500.0, 109.354),
            (560.0, 100.0),
            (600.0, 90.0062),
            (650.0, 80.0268),
            (700.0, 71.6091),
            (780.0, 63.3828),
        ];
        let d65 = Illuminant::from_name("D65").unwrap();
        assert_eq!(d65, Illuminant::D65);
        for (nanometres, power) in published {
            let got = 100.0 * d65.relative_power(nanometres);
            // The published numbers have six digits.
            assert!((got - power).abs() < 6e-4, "{nanometres}: {got} {power}");
        }
    }

    #[test]
    fn whites_are_the_published_ones() {
        // CIE 15:2018, table 10.3, to the five places there.
        let published = [
            ("A", [0.44758, 0.40745]),
            ("D50", [0.34567, 0.35851]),
            ("D55", [0.33243, 0.34744]),
            ("D65", [0.31272, 0.32903]),
            ("D75", [0.29903, 0.31488]),
            ("E", [1.0 / 3.0, 1.0 / 3.0]),
        ];
        for (name, [x, y]) in published {
            let illuminant = Illuminant::from_name(name).unwrap();
            let [got_x, got_y] = chromaticity(illuminant.white());
            // The observer's 5 nm table, linear in between, instead of the 1 nm table: some 10⁻⁵.
            assert!((got_x - x).abs() < 1e-4 && (got_y - y).abs() < 1e-4, "{name}: {got_x} {got_y}");
        }
    }

    #[test]
    fn what_is_no_illuminant_is_refused_by_name() {
        let message = Illuminant::from_name("D66").unwrap_err().to_string();
        assert!(message.contains("D66") && message.contains("D65"), "{message}");
        for temperature in [3999.0, 25_001.0, 0.0, -1.0, f64::NAN] {
            assert!(Illuminant::daylight(temperature).is_err(), "{temperature}");
        }
        // Both formulas meet at 7000 K.
        let (below, above) = (Illuminant::daylight(7000.0), Illuminant::daylight(7000.001));
        let power = |illuminant: Result<Illuminant, _>| illuminant.unwrap().relative_power(450.0);
        assert!((power(below) / power(above) - 1.0).abs() < 2e-3);
    }
}
