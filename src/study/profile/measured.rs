//! Measured profiles: CSV with a radius, a reflectance and, if known, its error.

use thiserror::Error;

/// R(r) at some radii.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredProfile {
    /// Points in order of the file.
    pub points: Vec<MeasuredPoint>,
    /// Whether R has the unit 1/m²; otherwise only ratios count.
    pub absolute: bool,
}

/// One measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredPoint {
    /// Distance from where light entered, m.
    pub radius: f64,
    /// R, 1/m² per unit flux that entered, or in any unit.
    pub reflectance: f64,
    /// Standard error of R, in its unit.
    pub sigma: Option<f64>,
}

/// What is wrong with a file.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("line {line}: {problem}")]
pub struct MeasuredError {
    /// Number of the line, from 1.
    pub line: usize,
    /// What is wrong, and how to mend it.
    pub problem: String,
}

/// Units of length, m.
const LENGTHS: [(&str, f64); 4] = [("mm", 1e-3), ("m", 1.0), ("cm", 1e-2), ("um", 1e-6)];

/// What a column holds, and the factor that takes it to SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Column {
    Radius(f64),
    Reflectance(Option<f64>),
    Sigma(Option<f64>),
    Other,
}

impl Column {
    /// From a heading such as `radius_mm`, `reflectance_per_mm2`, `reflectance`, `sigma`.
    fn of(heading: &str) -> Self {
        let heading = heading.trim().to_ascii_lowercase();
        let unit = |text: &str| LENGTHS.iter().find(|(name, _)| *name == text).map(|(_, metres)| *metres);
        if let Some(metres) = heading.strip_prefix("radius_").and_then(unit) {
            return Self::Radius(metres);
        }
        let (name, per) =
            heading.split_once("_per_").map_or((&*heading, None), |(name, per)| (name, Some(per)));
        let per_area =
            per.map(|per| per.strip_suffix('2').and_then(unit).map(|metres| 1.0 / (metres * metres)));
        match (name, per_area) {
            ("reflectance" | "r", None) => Self::Reflectance(None),
            ("reflectance" | "r", Some(Some(factor))) => Self::Reflectance(Some(factor)),
            ("sigma" | "stderr", None) => Self::Sigma(None),
            ("sigma" | "stderr", Some(Some(factor))) => Self::Sigma(Some(factor)),
            _ => Self::Other,
        }
    }
}

impl MeasuredProfile {
    /// Reads CSV: lines that begin with `#` are comments, the first other line names the columns. `radius_mm` (or `_m`, `_cm`,
    /// `_um`) and `reflectance_per_mm2` (or of another unit; `reflectance` alone: relative) are needed; `sigma`, of the
    /// same unit, may be there; other columns are not read.
    ///
    /// # Errors
    /// Names the line that is wrong.
    pub fn from_csv(text: &str) -> Result<Self, MeasuredError> {
        let error = |line: usize, problem: String| MeasuredError { line, problem };
        let mut lines = (1..)
            .zip(text.lines())
            .filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#'));
        let (line, headings) = lines.next().ok_or_else(|| error(1, "the file holds no data".into()))?;
        let columns: Vec<Column> =
            headings.trim_start_matches('\u{feff}').split(',').map(Column::of).collect();
        let find = |wanted: fn(&Column) -> bool| columns.iter().position(wanted);
        let (Some(radius), Some(reflectance)) = (
            find(|column| matches!(column, Column::Radius(_))),
            find(|column| matches!(column, Column::Reflectance(_))),
        ) else {
            return Err(error(
                line,
                format!(
                    "columns `{headings}`: radius_mm (or radius_m, radius_cm, radius_um) and reflectance_per_mm2 (or another \
                     unit; `reflectance` alone if it is relative) are needed"
                ),
            ));
        };
        let sigma = find(|column| matches!(column, Column::Sigma(_)));
        let metres = if let Column::Radius(metres) = columns[radius] { metres } else { 1.0 };
        let factor = if let Column::Reflectance(factor) = columns[reflectance] { factor } else { None };
        let sigma_factor = match sigma.map(|i| columns[i]) {
            Some(Column::Sigma(Some(own))) => own,
            _ => factor.unwrap_or(1.0),
        };
        let mut points = Vec::new();
        for (line, text) in lines {
            let fields: Vec<&str> = text.split(',').map(str::trim).collect();
            if fields.len() != columns.len() {
                let problem =
                    format!("{} values where the heading has {} columns", fields.len(), columns.len());
                return Err(error(line, problem));
            }
            let positive = |name: &str, i: usize| match fields[i].parse::<f64>() {
                Ok(number) if number > 0.0 && number.is_finite() => Ok(number),
                _ => Err(error(line, format!("{name} is `{}`; it must be a number above 0", fields[i]))),
            };
            points.push(MeasuredPoint {
                radius: metres * positive("radius", radius)?,
                reflectance: factor.unwrap_or(1.0) * positive("reflectance", reflectance)?,
                sigma: sigma.map(|i| positive("sigma", i)).transpose()?.map(|s| s * sigma_factor),
            });
        }
        Ok(Self { points, absolute: factor.is_some() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_come_from_the_heading() {
        let text =
            "# made by hand\n\nradius_mm, note, reflectance_per_mm2, sigma\n0.5,a,2.0,0.1\n 1 ,b, 0.5 ,0.2\n";
        let profile = MeasuredProfile::from_csv(text).unwrap();
        assert!(profile.absolute);
        let expected = MeasuredPoint { radius: 1e-3, reflectance: 0.5e6, sigma: Some(0.2e6) };
        assert_eq!((profile.points.len(), profile.points[1]), (2, expected));
        let relative = MeasuredProfile::from_csv("reflectance,radius_m\n7,0.001\n").unwrap();
        assert!(!relative.absolute);
        assert_eq!(relative.points, [MeasuredPoint { radius: 0.001, reflectance: 7.0, sigma: None }]);
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        let cases = [
            ("", "line 1: the file holds no data"),
            ("# a\nradius,reflectance\n1,2\n", "line 2: columns `radius,reflectance`: radius_mm"),
            ("radius_mm,reflectance_per_inch2\n1,2\n", "line 1: columns"),
            ("radius_mm,reflectance\n1,2\n1\n", "line 3: 1 values where the heading has 2 columns"),
            ("radius_mm,reflectance\n1,-2\n", "line 2: reflectance is `-2`"),
            ("radius_mm,reflectance\nx,2\n", "line 2: radius is `x`"),
            ("radius_mm,reflectance,sigma\n1,2,0\n", "line 2: sigma is `0`"),
            ("radius_mm,reflectance\n1,inf\n", "line 2: reflectance is `inf`"),
        ];
        for (text, message) in cases {
            let error = MeasuredProfile::from_csv(text).unwrap_err().to_string();
            assert!(error.starts_with(message), "{error}");
        }
    }
}
