//! Numbers as people read them, and as they type them.

use crate::scene::units;

/// Four significant digits, with an exponent where that is shorter.
pub(super) fn short(value: f64) -> String {
    significant(value, 4)
}

/// As many digits as fit a field of the panel.
pub(super) fn editable(value: f64) -> String {
    const FITS: usize = 9;
    let exact = crate::words::number(value);
    if exact.len() <= FITS { exact } else { significant(value, 6) }
}

/// `digits` significant digits, trailing zeros dropped.
fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let exponent = value.abs().log10().floor();
    if !(-3.0..6.0).contains(&exponent) {
        let text = format!("{value:.*e}", digits - 1);
        return match text.split_once('e') {
            Some((mantissa, exponent)) if mantissa.contains('.') => {
                format!("{}e{exponent}", mantissa.trim_end_matches('0').trim_end_matches('.'))
            }
            _ => text,
        };
    }
    let decimals = digits as i32 - 1 - exponent as i32;
    // Where the digits end before the point, zeros follow.
    let text = if decimals >= 0 {
        format!("{value:.*}", decimals as usize)
    } else {
        let unit = 10f64.powi(-decimals);
        format!("{:.0}", (value / unit).round() * unit)
    };
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// Three significant digits: what a slider's position is good for.
pub(super) fn round_to_slider(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    format!("{value:.2e}").parse().unwrap_or(value)
}

/// A typed number, in this unit where it has none: `2.5`, `1e4`, `12 kN`, `0.3 MPa`, and `3k` for 3 kN.
pub(super) fn parse(text: &str, unit: &'static str) -> Option<f64> {
    let text = text.trim().replace(',', ".").replace('\u{2212}', "-");
    // A prefix alone is that of the field's unit.
    units::parse(&text, unit).or_else(|_| units::parse(&format!("{text}{unit}"), unit)).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (40_000.0, "40000"),
            (-1.5, "-1.5"),
            (0.123_456, "0.1235"),
            (1e6, "1e6"),
            (1.2345e9, "1.234e9"),
            (-2.5e-7, "-2.5e-7"),
            (99_999.9, "100000"),
            (226_993.0, "227000"),
        ] {
            assert_eq!(short(value), text);
        }
    }

    #[test]
    fn fields_show_numbers_that_fit() {
        for (value, text) in
            [(1e6, "1000000"), (1000.0 / 3.0, "333.333"), (-0.1, "-0.1"), (2.0e-11 / 3.0, "6.66667e-12")]
        {
            assert_eq!(editable(value), text);
        }
    }

    #[test]
    fn typed_numbers_take_units_and_prefixes() {
        for (text, value) in
            [("2.5", 2.5), ("1e4", 1e4), ("12 kN", 12e3), ("12kN", 12e3), ("7 N", 7.0), ("3k", 3e3), ("-0,5", -0.5)]
        {
            assert_eq!(parse(text, "N"), Some(value), "{text}");
        }
        assert_eq!(parse("1.5 GPa", "Pa"), Some(1.5e9));
        assert_eq!((parse("3 mm", "m"), parse("7.8 g/cm³", "kg/m³")), (Some(0.003), Some(7800.0)));
        assert_eq!((parse("2 m", "m"), parse("45 °", "°"), parse("12 kN", "Pa")), (Some(2.0), Some(45.0), None));
        assert_eq!(parse("two", "N"), None);
        assert_eq!(parse("", "N"), None);
    }
}
