//! Lines of values in a text file, with comments.

use std::str::FromStr;

use super::mci::MciError;

/// Largest magnitude of a number that is read: products of a few such numbers are still finite.
const MAX_MAGNITUDE: f64 = 1e30;

/// The lines of a file that hold values.
pub struct Lines<'a> {
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
    /// Number of the last line looked at.
    last: usize,
}

/// A line of values.
pub struct Line<'a> {
    /// Number in the file, from 1.
    pub number: usize,
    /// What should stand here.
    pub field: &'static str,
    /// The values; at least one.
    pub words: Vec<&'a str>,
}

impl<'a> Lines<'a> {
    /// The lines of `text`.
    pub fn new(text: &'a str) -> Self {
        Self { lines: text.trim_start_matches('\u{feff}').lines().enumerate(), last: 0 }
    }

    /// The next line of values, which should hold `field`.
    pub fn next(&mut self, field: &'static str) -> Result<Line<'a>, MciError> {
        self.find(field).ok_or(MciError::Line {
            line: self.last,
            field,
            problem: "the file ends before it; add the missing lines, or mend the numbers of runs and layers"
                .into(),
        })
    }

    /// A line of values after all that was wanted.
    pub fn rest(&mut self) -> Option<Line<'a>> {
        self.find("end of the file")
    }

    fn find(&mut self, field: &'static str) -> Option<Line<'a>> {
        for (index, text) in self.lines.by_ref() {
            self.last = index + 1;
            let values = text.split('#').next().unwrap_or_default();
            let words: Vec<_> = values.split_whitespace().collect();
            if !words.is_empty() {
                return Some(Line { number: self.last, field, words });
            }
        }
        None
    }
}

impl<'a> Line<'a> {
    /// An error on this line.
    pub fn error(&self, problem: String) -> MciError {
        MciError::Line { line: self.number, field: self.field, problem }
    }

    /// The values, which are to be as many as `names`.
    pub fn values<const N: usize>(&self, names: [&str; N]) -> Result<[&'a str; N], MciError> {
        self.values_or(names, String::new)
    }

    /// As [`Self::values`], with a hint for where they are not as many.
    pub fn values_or<const N: usize>(
        &self,
        names: [&str; N],
        hint: impl FnOnce() -> String,
    ) -> Result<[&'a str; N], MciError> {
        <[&str; N]>::try_from(self.words.as_slice()).map_err(|_| {
            let values = if self.words.len() == 1 { "value stands" } else { "values stand" };
            self.error(format!(
                "{} {values} here where {N} should: {} (notes go behind a #){}",
                self.words.len(),
                names.join(" "),
                hint()
            ))
        })
    }

    /// The number `word`.
    pub fn number(&self, name: &str, word: &str) -> Result<f64, MciError> {
        match f64::from_str(word) {
            Ok(number) if number.abs() <= MAX_MAGNITUDE => Ok(number),
            Ok(_) => Err(self.error(format!(
                "{name} is {word}; write a finite number below {MAX_MAGNITUDE:e} (a half-space is a layer of 1e8)"
            ))),
            Err(_) => Err(self.error(format!("{name} is {word:?}, which is not a number"))),
        }
    }

    /// The only number of the line.
    pub fn lone_number(&self, hint: &str) -> Result<f64, MciError> {
        let [word] = self.values_or(["n"], || hint.into())?;
        self.number("n", word)
    }

    /// The only whole number of the line, from 1 to `most`.
    pub fn count_from_1(&self, most: u64, if_0: &str) -> Result<u64, MciError> {
        let [word] = self.values(["a whole number"])?;
        self.count("it", word, most, if_0)
    }

    /// The whole number `word`, from 1 to `most`; 1e6 is whole too.
    pub fn count(&self, name: &str, word: &str, most: u64, if_0: &str) -> Result<u64, MciError> {
        let whole = || f64::from_str(word).ok().filter(|x| x.fract() == 0.0 && (0.0..=1e15).contains(x));
        match u64::from_str(word).ok().or_else(|| whole().map(|x| x as u64)) {
            Some(0) => Err(self.error(format!("{name} is 0; {if_0}"))),
            Some(count) if count <= most => Ok(count),
            Some(_) => Err(self.error(format!("{name} is {word}; the most is {most}"))),
            None => {
                Err(self.error(format!("{name} is {word:?}, which is not a whole number from 1 to {most}")))
            }
        }
    }
}
