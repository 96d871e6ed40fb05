//! Formats numbers, units and counts, the same way in messages, tables and the window.

/// Returns the shortest text that reads back as the same number: plain decimals for magnitudes from 1e-4 to 1e7, else
/// with an exponent.
///
/// ```
/// use warpbeam::format::number;
/// assert_eq!((number(0.25), number(1e9)), ("0.25".to_owned(), "1e9".to_owned()));
/// ```
pub fn number(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 || !value.is_finite() || (1e-4..1e7).contains(&magnitude) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

/// Formats a count with its noun: `1 iteration`, `2 iterations`.
pub fn count(n: impl Into<u64>, what: &str) -> String {
    let n = n.into();
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

/// Formats a whole number with thousands separators: `500,000`.
///
/// ```
/// use warpbeam::format::grouped;
/// assert_eq!([0, 999, 1000, 1234567].map(grouped), ["0", "999", "1,000", "1,234,567"]);
/// ```
pub fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// SI prefixes and their powers of ten.
const PREFIXES: [(&str, i32); 9] =
    [("p", -12), ("n", -9), ("µ", -6), ("m", -3), ("", 0), ("k", 3), ("M", 6), ("G", 9), ("T", 12)];

/// Significant digits of measured values.
const DIGITS: i32 = 4;

/// Returns `true` for units that take no SI prefix: they have one already, or are no symbol.
fn takes_no_prefix(unit: &str) -> bool {
    ["kg", "°", "%", "1/"].iter().any(|own| unit.starts_with(own)) || ["", "ms"].contains(&unit)
}

/// Returns the SI prefix (power of ten and symbol) that scales the largest of `values`, in SI units, to between 1 and
/// 1000. Units that have a prefix already, such as kg m/s, and °, % and 1/s take none.
///
/// ```
/// use warpbeam::format::prefix;
/// assert_eq!((prefix(&[0.5, -0.002], "m"), prefix(&[5e4], "kg m/s")), ((-3, "m"), (0, "")));
/// ```
pub fn prefix(values: &[f64], unit: &str) -> (i32, &'static str) {
    let largest = values.iter().filter(|v| v.is_finite()).fold(0.0_f64, |m, v| m.max(v.abs()));
    if largest == 0.0 || takes_no_prefix(unit) {
        return (0, "");
    }
    // Rounding comes first, because 999.96 is shown as 1000.
    let rounded: f64 = format!("{largest:.*e}", DIGITS as usize - 1).parse().unwrap_or(largest);
    let fits = |power: i32| rounded >= 10f64.powi(power);
    let found = PREFIXES.iter().rev().find(|(_, power)| fits(*power));
    found.or(PREFIXES.first()).map_or((0, ""), |(symbol, power)| (*power, *symbol))
}

/// Formats a measured value in engineering units, to four significant digits: `-5.12 µm`, `30 kN`, `0 m`.
///
/// ```
/// use warpbeam::format::engineering;
/// assert_eq!((engineering(-5.12e-6, "m"), engineering(3e4, "N")), ("-5.12 µm".to_owned(), "30 kN".to_owned()));
/// ```
pub fn engineering(value: f64, unit: &str) -> String {
    engineering_digits(value, unit, DIGITS)
}

/// Formats like [`engineering`] to `digits` significant digits.
fn engineering_digits(value: f64, unit: &str, digits: i32) -> String {
    let (power, symbol) = prefix(&[value], unit);
    let number = significant(scaled(value, power), digits);
    // A degree sign follows its number without a space.
    if unit == "°" { format!("{number}°") } else { format!("{number} {symbol}{unit}").trim_end().to_owned() }
}

/// Formats an editable value in engineering units: with all of its digits if six are enough, as for typed values, else
/// with four.
///
/// ```
/// use warpbeam::format::editable;
/// assert_eq!(
///     [editable(2.1e11, "Pa"), editable(1.23456, "N"), editable(1.0 / 60.0, "s")],
///     ["210 GPa", "1.23456 N", "16.67 ms"]
/// );
/// ```
pub fn editable(value: f64, unit: &str) -> String {
    const TYPED: usize = 6;
    /// Relative rounding error that a change of units may add to a typed value.
    const ROUNDING: f64 = 1e-12;
    let is_typed = (value - rounded(value, TYPED)).abs() <= ROUNDING * value.abs();
    engineering_digits(value, unit, if is_typed { TYPED as i32 } else { DIGITS })
}

/// Formats a percentage with two digits; differences at rounding level are `exact`.
///
/// ```
/// use warpbeam::format::percent;
/// assert_eq!(
///     [43.96, 0.0512, 4e-11].map(percent),
///     ["44 %".to_owned(), "0.051 %".to_owned(), "exact".to_owned()]
/// );
/// ```
pub fn percent(value: f64) -> String {
    /// Smallest difference that is not rounding error, percent.
    const ROUNDING: f64 = 1e-7;
    if value.abs() < ROUNDING {
        return "exact".to_owned();
    }
    if value.abs() >= 99.5 {
        return format!("{} %", number(three_digits(value)));
    }
    format!("{} %", significant(value, 2))
}

/// Formats the bound of an error, percent, with two digits, rounded up: a bound that is shown as `1 %` is at most 1 %.
///
/// ```
/// use warpbeam::format::bound_percent;
/// assert_eq!([1.04, 1.0, 0.0512].map(bound_percent), ["1.1 %", "1 %", "0.052 %"]);
/// ```
pub fn bound_percent(value: f64) -> String {
    /// Relative difference that is rounding error.
    const ROUNDING: f64 = 1e-9;
    let nearest = two_digits(value);
    if nearest >= value * (1.0 - ROUNDING) || !value.is_finite() {
        return percent(value);
    }
    let digit = 10f64.powf(value.log10().floor() - 1.0);
    percent(nearest + digit)
}

/// Rounds to three significant digits, the precision of sliders, pointer positions and clocks.
pub fn three_digits(value: f64) -> f64 {
    rounded(value, 3)
}

/// Rounds to two significant digits, the precision of measured times and residuals.
pub fn two_digits(value: f64) -> f64 {
    rounded(value, 2)
}

/// Rounds to six significant digits, the precision of shown coordinates.
pub(crate) fn six_digits(value: f64) -> f64 {
    rounded(value, 6)
}

/// Rounds to `digits` significant digits.
pub(crate) fn rounded(value: f64, digits: usize) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}

/// Returns the largest number of the form 1, 2 or 5 · 10ⁿ that is not above `length`.
pub fn round_down(length: f64) -> f64 {
    let power = 10f64.powf(length.log10().floor());
    [5.0, 2.0].into_iter().map(|m| m * power).find(|&l| l <= length * (1.0 + 1e-12)).unwrap_or(power)
}

/// Returns round values from `low` to `high`, with a spacing of 1, 2 or 5 · 10ⁿ: as many as possible, but at most
/// `most`.
///
/// ```
/// use warpbeam::format::ticks;
/// assert_eq!(ticks(-0.3, 4.1, 5), [0.0, 1.0, 2.0, 3.0, 4.0]);
/// ```
pub fn ticks(low: f64, high: f64, most: u32) -> Vec<f64> {
    let span = high - low;
    if !(span.is_finite() && span > 0.0) || most == 0 {
        return Vec::new();
    }
    let mut step = round_down(span / f64::from(most));
    for _ in 0..8 {
        let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
        if last - first < f64::from(most) && step > 0.0 {
            return (0..).map(|i| first + f64::from(i)).take_while(|&k| k <= last).map(|k| k * step).collect();
        }
        // 2.5 times the step rounds down to the next round number: 1, 2, 5, 10.
        step = round_down(2.5 * step);
    }
    Vec::new()
}

/// Rounding error of results, relative to the largest result of the same kind.
const ROUNDING: f64 = 1e-10;

/// Largest magnitude among results of one kind, such as all stresses of a body. A result below the rounding error of the
/// largest one is formatted as 0.
///
/// ```
/// use warpbeam::format::Context;
/// let stresses = Context::of([2e3, 1e-10]);
/// assert_eq!([2e3, 1e-10].map(|v| stresses.engineering(v, "Pa")), ["2 kPa", "0 Pa"]);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Context {
    /// Magnitude below which a result is rounding error.
    rounding: f64,
}

impl Context {
    /// Largest relative error of forces that a text ignores, however large the solver's tolerance is.
    pub const MAX_INEXACT: f64 = 1e-6;

    /// Returns the context of all results of a kind; values that are not finite are ignored.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        Self::of_inexact(values, 0.0)
    }

    /// Returns the context of results whose error, relative to the largest one, is `error`, or that of rounding if this
    /// is larger.
    pub fn of_inexact(values: impl IntoIterator<Item = f64>, error: f64) -> Self {
        let largest = values.into_iter().filter(|v| v.is_finite()).fold(0.0_f64, |m, v| m.max(v.abs()));
        Self { rounding: error.max(ROUNDING) * largest }
    }

    /// Returns the value, or 0 if it is rounding error.
    pub fn rounded(self, value: f64) -> f64 {
        if value.abs() < self.rounding { 0.0 } else { value }
    }

    /// Formats a result like [`engineering`].
    pub fn engineering(self, value: f64, unit: &str) -> String {
        engineering(self.rounded(value), unit)
    }

    /// Formats the components of a vector like [`engineering_pair`].
    pub fn pair(self, values: [f64; 2], unit: &str) -> String {
        engineering_pair(values.map(|v| self.rounded(v)), unit)
    }
}

/// Formats a value of a table with four significant digits, in units of the power of ten of its heading; see [`prefix`].
///
/// ```
/// use warpbeam::format::in_power;
/// assert_eq!([in_power(1234.5678, 3), in_power(-0.5, -3)], ["1.235", "-500"]);
/// ```
pub fn in_power(value: f64, power: i32) -> String {
    significant(scaled(value, power), DIGITS)
}

/// Formats both components of a vector with one prefix: `(1.5, -0.02) mm`. A component at rounding level of the other
/// is 0.
///
/// ```
/// use warpbeam::format::engineering_pair;
/// assert_eq!(engineering_pair([1e-19, -0.0025], "m"), "(0, -2.5) mm");
/// ```
pub fn engineering_pair(values: [f64; 2], unit: &str) -> String {
    engineering_pair_among(values, &values, unit)
}

/// Formats like [`engineering_pair`], with the prefix that suits all of the values in a column.
pub(crate) fn engineering_pair_among(values: [f64; 2], column: &[f64], unit: &str) -> String {
    let (power, symbol) = prefix(column, unit);
    let largest = values[0].abs().max(values[1].abs());
    let [x, y] = values.map(|v| if v.abs() < ROUNDING * largest { 0.0 } else { v });
    format!("({}, {}) {symbol}{unit}", significant(scaled(x, power), DIGITS), significant(scaled(y, power), DIGITS))
}

/// Converts a value to units of a power of ten.
fn scaled(value: f64, power: i32) -> f64 {
    if power < 0 { value * 10f64.powi(-power) } else { value / 10f64.powi(power) }
}

/// Formats with `digits` significant digits and without trailing zeros, with an exponent where [`number`] uses one.
fn significant(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        // Avoids "-0".
        return if value == 0.0 { "0".to_owned() } else { value.to_string() };
    }
    let text = format!("{value:.*e}", digits as usize - 1);
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

    #[test]
    fn rounding_errors_are_zero_in_their_context() {
        let context = Context::of([f64::NAN, -3e4, 2.0, f64::INFINITY]);
        for (value, text) in [(3e4, "30 kN"), (-2.9e-6, "0 N"), (3.1e-6, "3.1 µN"), (0.0, "0 N")] {
            assert_eq!(context.engineering(value, "N"), text);
        }
        assert_eq!(context.pair([1e-6, -2e-6], "N"), "(0, 0) N");
        assert_eq!(context.pair([1e-6, 3.0], "N"), "(0, 3) N");
        assert_eq!(Context::of([]).engineering(1e-30, "N"), "1e-18 pN", "alone, no value is rounding error");
        assert_eq!(Context::of_inexact([1.0], 1e-6).engineering(9e-7, "N"), "0 N");
        assert!(context.engineering(f64::NAN, "N").contains("NaN"));
    }

    #[test]
    fn percents_have_two_digits() {
        for (value, text) in [(120.4, "120 %"), (99.4, "99 %"), (5.04, "5 %"), (0.000_123, "0.00012 %"), (0.0, "exact")]
        {
            assert_eq!(percent(value), text);
        }
    }

    #[test]
    fn ticks_are_round_and_few() {
        for (low, high, most) in [(0.0, 1.0, 5), (13.0, 977.0, 4), (-45.0, 45.0, 5), (1e5, 1.3e5, 4), (0.1, 0.11, 6)] {
            let ticks = ticks(low, high, most);
            assert!(ticks.len() >= 2 && ticks.len() <= most as usize, "{low} to {high}: {ticks:?}");
            let step = ticks[1] - ticks[0];
            let mantissa = step / 10f64.powf((step * 1.000_001).log10().floor());
            assert!([1.0, 2.0, 5.0].iter().any(|m| (mantissa - m).abs() < 1e-3), "{ticks:?}");
            assert!(ticks.iter().all(|t| (low - 1e-9..=high + 1e-9).contains(t)), "{ticks:?}");
        }
        assert!(ticks(1.0, 1.0, 4).is_empty() && ticks(f64::NAN, 1.0, 4).is_empty());
        for (length, round) in [(1.0, 1.0), (1.9, 1.0), (2.0, 2.0), (0.07, 0.05), (499.0, 200.0)] {
            assert!((round_down(length) - round).abs() < 1e-12 * round, "{length}");
        }
    }
}
