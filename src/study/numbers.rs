//! Numbers for people.

/// Four significant digits.
pub fn significant(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let magnitude = value.abs().log10().floor();
    if !(-4.0..6.0).contains(&magnitude) {
        return format!("{value:.3e}");
    }
    format!("{value:.*}", (3.0 - magnitude).max(0.0) as usize)
}

/// Two significant digits, without a power of ten where that is readable.
pub fn two_digits(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".into() } else { format!("{value}") };
    }
    let magnitude = value.abs().log10().floor();
    if !(-4.0..6.0).contains(&magnitude) {
        return format!("{value:.1e}");
    }
    let unit = 10.0_f64.powf(magnitude - 1.0);
    let rounded = (value / unit).round() * unit;
    let text = format!("{rounded:.*}", (1.0 - magnitude).max(0.0) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
}

/// A share in percent, two digits.
pub fn percent(share: f64) -> String {
    format!("{} %", two_digits(100.0 * share))
}

/// A time as people say it, two digits.
pub fn seconds_in_words(seconds: f64) -> String {
    match seconds {
        s if s < 120.0 => format!("{} s", two_digits(s)),
        s if s < 7200.0 => format!("{} min", two_digits(s / 60.0)),
        s => format!("{} h", two_digits(s / 3600.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_digits_are_shown() {
        let shown = [0.38168, 12345.6, 1.0, 0.0, 2.5e-9, 99.999].map(significant);
        assert_eq!(shown, ["0.3817", "12346", "1.000", "0", "2.500e-9", "100.00"]);
    }

    #[test]
    fn two_digits_are_enough_for_people() {
        let shown = [0.0314, 3.1, 9.96, 123.4, 0.0, 1e-9, 31.0, 2.0].map(two_digits);
        assert_eq!(shown, ["0.031", "3.1", "10", "120", "0", "1.0e-9", "31", "2"]);
        let said = [0.5, 119.0, 400.0, 9000.0].map(seconds_in_words);
        assert_eq!(said, ["0.5 s", "120 s", "6.7 min", "2.5 h"]);
        assert_eq!(percent(0.0067), "0.67 %");
    }
}
