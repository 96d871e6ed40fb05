//! Words for numbers and counts, the same in messages, tables and the window.

/// The shortest text that reads back as the same number: plain where that is short, else with an exponent.
///
/// ```
/// use warpbeam::words::number;
/// assert_eq!((number(0.25), number(1e9)), ("0.25".to_owned(), "1e9".to_owned()));
/// ```
#[must_use]
pub fn number(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 || !value.is_finite() || (1e-4..1e7).contains(&magnitude) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

/// A number of things: `1 iteration`, `2 iterations`.
#[must_use]
pub fn count(n: impl Into<u64>, what: &str) -> String {
    let n = n.into();
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

/// SI prefixes and their powers of ten.
const PREFIXES: [(&str, i32); 9] =
    [("p", -12), ("n", -9), ("µ", -6), ("m", -3), ("", 0), ("k", 3), ("M", 6), ("G", 9), ("T", 12)];

/// Significant digits of measured values.
const DIGITS: i32 = 4;

/// The prefix in which the largest of some values, in SI units, is from 1 to 1000: a power of ten and its symbol. Units
/// that have a prefix already, such as kg m/s, and ° and % take none.
///
/// ```
/// use warpbeam::words::prefix;
/// assert_eq!((prefix(&[0.5, -0.002], "m"), prefix(&[5e4], "kg m/s")), ((-3, "m"), (0, "")));
/// ```
#[must_use]
pub fn prefix(values: &[f64], unit: &str) -> (i32, &'static str) {
    let largest = values.iter().filter(|v| v.is_finite()).fold(0.0_f64, |m, v| m.max(v.abs()));
    if largest == 0.0 || unit.is_empty() || ["kg", "°", "%"].iter().any(|own| unit.starts_with(own)) {
        return (0, "");
    }
    // Rounded first: 999.96 is 1000.
    let rounded: f64 = format!("{largest:.*e}", DIGITS as usize - 1).parse().unwrap_or(largest);
    let fits = |power: i32| rounded >= 10f64.powi(power);
    let found = PREFIXES.iter().rev().find(|(_, power)| fits(*power));
    found.or(PREFIXES.first()).map_or((0, ""), |(symbol, power)| (*power, *symbol))
}

/// A measured value in engineering units, to four significant digits: `-5.12 µm`, `30 kN`, `0 m`.
///
/// ```
/// use warpbeam::words::engineering;
/// assert_eq!((engineering(-5.12e-6, "m"), engineering(3e4, "N")), ("-5.12 µm".to_owned(), "30 kN".to_owned()));
/// ```
#[must_use]
pub fn engineering(value: f64, unit: &str) -> String {
    let (power, symbol) = prefix(&[value], unit);
    format!("{} {symbol}{unit}", significant(scaled(value, power))).trim_end().to_owned()
}

/// Both components of a vector with one prefix: `(1.5, -0.02) mm`. What is rounding beside the other is 0.
///
/// ```
/// use warpbeam::words::engineering_pair;
/// assert_eq!(engineering_pair([1e-19, -0.0025], "m"), "(0, -2.5) mm");
/// ```
#[must_use]
pub fn engineering_pair(values: [f64; 2], unit: &str) -> String {
    const ROUNDING: f64 = 1e-10;
    let (power, symbol) = prefix(&values, unit);
    let largest = values[0].abs().max(values[1].abs());
    let [x, y] = values.map(|v| if v.abs() < ROUNDING * largest { 0.0 } else { v });
    format!("({}, {}) {symbol}{unit}", significant(scaled(x, power)), significant(scaled(y, power)))
}

/// A value in units of a power of ten.
fn scaled(value: f64, power: i32) -> f64 {
    if power < 0 { value * 10f64.powi(-power) } else { value / 10f64.powi(power) }
}

/// Four significant digits, trailing zeros dropped; with an exponent where that is shorter.
fn significant(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        // No -0.
        return if value == 0.0 { "0".to_owned() } else { value.to_string() };
    }
    let text = format!("{value:.*e}", DIGITS as usize - 1);
    number(text.parse().unwrap_or(value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measured_values_have_digits_and_prefixes() {
        for (value, unit, text) in [
            (-5.12e-6, "m", "-5.12 µm"),
            (30_000.0, "N", "30 kN"),
            (1.2e6, "Pa", "1.2 MPa"),
            (999.96, "N", "1 kN"),
            (999.94, "N", "999.9 N"),
            (1.0, "m", "1 m"),
            (-0.0, "m", "0 m"),
            (0.012_345_6, "m", "12.35 mm"),
            (1.5e15, "N", "1500 TN"),
            (1e-15, "m", "0.001 pm"),
            (2.5e-20, "m", "2.5e-8 pm"),
            (123_456.0, "kg m/s", "123500 kg m/s"),
            (0.25, "", "0.25"),
            (2000.0, "N m", "2 kN m"),
        ] {
            assert_eq!(engineering(value, unit), text);
        }
        assert_eq!(engineering_pair([0.3, -1200.0], "N"), "(0.0003, -1.2) kN");
        assert_eq!(engineering_pair([0.0, -0.0], "N"), "(0, 0) N");
    }
}
