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
