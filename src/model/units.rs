//! Parser of numbers with units, such as `210 GPa`, `-12 kN` and `7.8 g/cm³`, for scene files, `--set` and the window.
//! Results are in the unit of the value's [`limits`](super::limits).

use std::borrow::Cow;
use std::ops::Range;

use thiserror::Error;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::error::Invalid;
use super::keys::KEYS;
use super::limits::Limit;
use crate::sentence::{Sentence, sentence};

/// Exponents of metre, kilogram, second and radian. The radian is included so that `1/s` is not an angular velocity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dimension([i32; 4]);

const LENGTH: Dimension = Dimension([1, 0, 0, 0]);
const MASS: Dimension = Dimension([0, 1, 0, 0]);
const TIME: Dimension = Dimension([0, 0, 1, 0]);
const ANGLE: Dimension = Dimension([0, 0, 0, 1]);
const NUMBER: Dimension = Dimension([0; 4]);
const FORCE: Dimension = Dimension([1, 1, -2, 0]);
const PRESSURE: Dimension = Dimension([-1, 1, -2, 0]);
const MOMENT: Dimension = Dimension([2, 1, -2, 0]);
const RATE: Dimension = Dimension([0, 0, -1, 0]);

/// Names of dimensions and their SI units.
const NAMES: &[(Dimension, &str, &str)] = &[
    (NUMBER, "a pure number", ""),
    (LENGTH, "a length", "m"),
    (MASS, "a mass", "kg"),
    (TIME, "a time", "s"),
    (ANGLE, "an angle", "rad"),
    (FORCE, "a force", "N"),
    (PRESSURE, "a pressure", "Pa"),
    (MOMENT, "a moment or an energy", "N m"),
    (RATE, "a rate", "1/s"),
    (Dimension([2, 0, 0, 0]), "an area", "m²"),
    (Dimension([3, 0, 0, 0]), "a volume", "m³"),
    (Dimension([-3, 1, 0, 0]), "a density", "kg/m³"),
    (Dimension([1, 0, -1, 0]), "a velocity", "m/s"),
    (Dimension([1, 0, -2, 0]), "an acceleration", "m/s²"),
    (Dimension([0, 0, -1, 1]), "an angular velocity", "rad/s"),
    (Dimension([0, 1, -2, 0]), "a force on a length", "N/m"),
];

/// Symbol, dimension, SI value as a factor and a power of ten, and `true` if the unit takes prefixes.
struct Unit(&'static str, Dimension, f64, i32, bool);

const UNITS: &[Unit] = &[
    Unit("1", NUMBER, 1.0, 0, false),
    Unit("%", NUMBER, 1.0, -2, false),
    Unit("m", LENGTH, 1.0, 0, true),
    Unit("in", LENGTH, 254.0, -4, false),
    Unit("ft", LENGTH, 3048.0, -4, false),
    Unit("g", MASS, 1.0, -3, true),
    Unit("t", MASS, 1.0, 3, false),
    Unit("s", TIME, 1.0, 0, true),
    Unit("rad", ANGLE, 1.0, 0, true),
    Unit("°", ANGLE, std::f64::consts::PI / 180.0, 0, false),
    Unit("deg", ANGLE, std::f64::consts::PI / 180.0, 0, false),
    Unit("N", FORCE, 1.0, 0, true),
    Unit("lbf", FORCE, 4.448_221_615_260_5, 0, false),
    Unit("kip", FORCE, 4.448_221_615_260_5, 3, false),
    Unit("Pa", PRESSURE, 1.0, 0, true),
    Unit("bar", PRESSURE, 1.0, 5, true),
    Unit("psi", PRESSURE, 6_894.757_293_168_361, 0, false),
    Unit("ksi", PRESSURE, 6_894.757_293_168_361, 3, false),
    Unit("Msi", PRESSURE, 6_894.757_293_168_361, 6, false),
    Unit("Nm", MOMENT, 1.0, 0, true),
    Unit("J", MOMENT, 1.0, 0, true),
    Unit("Hz", RATE, 1.0, 0, true),
];

/// SI prefixes and their powers of ten. The micro sign has two code points.
const PREFIXES: &[(&str, i32)] = &[
    ("T", 12),
    ("G", 9),
    ("M", 6),
    ("k", 3),
    ("h", 2),
    ("d", -1),
    ("c", -2),
    ("m", -3),
    ("µ", -6),
    ("μ", -6),
    ("u", -6),
    ("n", -9),
    ("p", -12),
];

/// Reason why a text is not a number in the expected unit.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{message}")]
pub struct UnitError {
    /// `false` if the text does not begin with a number.
    pub has_number: bool,
    /// Text as typed, and the expected quantity.
    pub message: Sentence,
}

/// Describes a dimension with the expected unit, or its SI unit: "a pressure (Pa)".
fn quantity(dimension: Dimension, unit: Option<&'static str>) -> Sentence {
    let known = NAMES.iter().find(|known| known.0 == dimension);
    let unit = unit.or(known.map(|known| known.2)).unwrap_or_default();
    match known {
        Some((_, name, _)) if unit.is_empty() => (*name).into(),
        Some((_, name, _)) => sentence!("%{quantity} (%{unit})", quantity = *name, unit),
        None => {
            let powers = ["m", "kg", "s", "rad"].iter().zip(dimension.0).filter(|(_, power)| *power != 0);
            let powers = powers.map(|(base, power)| match power {
                1 => format!(" {base}"),
                power => format!(" {base}^{power}"),
            });
            format!("a quantity in{}", powers.collect::<String>()).into()
        }
    }
}

/// Size of a unit. The power of ten is kept apart from the factor, as an integer, so that 3 mm is exactly the f64
/// 0.003.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Scale {
    dimension: Dimension,
    factor: f64,
    tens: i32,
}

/// Parses a number with an optional unit and converts it to `unit`; a number without unit is in `unit` already.
///
/// ```
/// use warpbeam::scene::units::parse;
/// assert_eq!(parse("210 GPa", "Pa"), Ok(210e9));
/// assert_eq!(parse("7.8 g/cm³", "kg/m³"), Ok(7800.0));
/// assert_eq!(
///     parse("12 kN", "Pa").map_err(|e| e.to_string()),
///     Err("`12 kN` is a force (N); expected a pressure (Pa)".to_owned())
/// );
/// ```
///
/// # Errors
/// [`UnitError`]. The range is not checked; the number may be infinite.
pub fn parse(text: &str, unit: &'static str) -> Result<f64, UnitError> {
    let text = text.trim();
    let target = scale_of(unit).unwrap_or(Scale { dimension: NUMBER, factor: 1.0, tens: 0 });
    let expected = || quantity(target.dimension, Some(unit));
    let refused = |message: Sentence| UnitError { has_number: true, message };
    let malformed = || {
        refused(sentence!(
            "`%{text}` is not a number: numbers look like 1500000, 1 500 000 and 1.5e6, with a point before decimals",
            text = shown(text)
        ))
    };
    let (plain, commas) = without_groups(text).ok_or_else(malformed)?;
    let (number, rest) = split(&plain).ok_or_else(|| {
        let (text, expected) = (shown(text), expected());
        let message = sentence!("`%{text}` is not a number; expected %{expected}", text, expected);
        UnitError { has_number: false, message }
    })?;
    if rest.starts_with('.') {
        return Err(malformed());
    }
    if commas == 1 && !plain.strip_suffix(rest).is_some_and(|number| number.contains('.')) {
        let [text, thousands, decimals] = [text, &plain, &text.replacen(',', ".", 1)].map(shown);
        return Err(refused(sentence!(
            "`%{text}` can be read in two ways: write %{thousands} or %{decimals}",
            text,
            thousands,
            decimals
        )));
    }
    let rest = rest.trim();
    if rest.is_empty() {
        return Ok(number);
    }
    let typed = scale_of(rest).ok_or_else(|| {
        let ([text, unit], expected) = ([text, rest].map(shown), expected());
        refused(sentence!("`%{text}` has the unknown unit `%{unit}`; expected %{expected}", text, unit, expected))
    })?;
    if typed.dimension != target.dimension {
        let (text, got, expected) = (shown(text), quantity(typed.dimension, None), expected());
        return Err(refused(sentence!("`%{text}` is %{got}; expected %{expected}", text, got, expected)));
    }
    let value = if typed.factor == target.factor { number } else { number * (typed.factor / target.factor) };
    // Positive powers of ten are exact, negative ones are not.
    let tens = typed.tens - target.tens;
    Ok(if tens < 0 { value / 10f64.powi(-tens) } else { value * 10f64.powi(tens) })
}

/// Returns a parser of numbers within a limit, in its unit or with another unit of the same dimension.
pub fn within(limit: Limit) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync {
    move |text| {
        let value = parse(text, limit.unit).map_err(|error| error.to_string())?;
        limit.check(value).map(|()| value).map_err(|message| message.to_string())
    }
}

/// Removes thousands separators (`1,234,567` and `30 000` become `1234567` and `30000`) and replaces a typographic minus;
/// returns the text and the number of commas removed. `None` if a comma or a space separates anything but groups of three
/// digits.
fn without_groups(text: &str) -> Option<(Cow<'_, str>, usize)> {
    let text = text.trim();
    let sign = text.chars().next().filter(|c| "+-\u{2212}".contains(*c));
    let unsigned = text.get(sign.map_or(0, char::len_utf8)..)?;
    let is_separator = |c: char| c == ',' || (c.is_whitespace() && c != '\n');
    let end = unsigned.find(|c: char| !(c.is_ascii_digit() || is_separator(c))).unwrap_or(unsigned.len());
    let mut whole = unsigned.get(..end)?;
    if unsigned.get(end..)?.starts_with('/') {
        // The 1 of 1/s belongs to the unit.
        whole = whole.get(..whole.rfind(is_separator).unwrap_or(end))?;
    }
    let whole = whole.trim_end_matches(char::is_whitespace);
    let rest = unsigned.get(whole.len()..)?;
    let mut groups = whole.split(is_separator);
    let first = groups.next().unwrap_or_default();
    let mut separators = whole.chars().filter(|&c| is_separator(c));
    let separator = separators.next();
    let has_comma_later = rest.trim_start_matches(|c: char| c.is_ascii_digit() || c == '.').starts_with(',');
    let good = separators.all(|c| Some(c) == separator)
        && groups.all(|group| group.len() == 3)
        && (1..=3).contains(&first.len())
        && !first.starts_with('0');
    if has_comma_later || separator.is_some() && !good {
        return None;
    }
    if separator.is_none() && sign != Some('\u{2212}') {
        return Some((Cow::Borrowed(text), 0));
    }
    let digits = whole.chars().filter(char::is_ascii_digit);
    let sign = sign.map(|sign| if sign == '\u{2212}' { '-' } else { sign });
    let number = sign.into_iter().chain(digits).chain(rest.chars()).collect();
    Some((Cow::Owned(number), whole.matches(',').count()))
}

/// Splits a text into the number at its start and the rest.
fn split(text: &str) -> Option<(f64, &str)> {
    // Upper bound of the length of a typed number, characters.
    const LONGEST: usize = 64;
    let ends = text.char_indices().map(|(i, c)| i + c.len_utf8()).take(LONGEST);
    ends.filter_map(|end| Some((text.get(..end)?.parse().ok()?, text.get(end..)?))).last()
}

/// Shortens a text for a message.
fn shown(text: &str) -> String {
    const FITS: usize = 40;
    if text.chars().nth(FITS).is_none() {
        return text.to_owned();
    }
    text.chars().take(FITS).chain(['…']).collect()
}

/// Parses products and quotients of units: `N m`, `kg/m³`, `m/s^2`.
fn scale_of(text: &str) -> Option<Scale> {
    let mut all = Scale { dimension: NUMBER, factor: 1.0, tens: 0 };
    for (i, part) in text.split('/').enumerate() {
        let mut factors = part.split([' ', '·', '\u{22c5}', '*']).filter(|f| !f.is_empty()).peekable();
        // Reject an empty numerator or denominator.
        if factors.peek().is_none() && !text.is_empty() {
            return None;
        }
        for (j, factor) in factors.enumerate() {
            let (unit, power) = with_power(factor)?;
            // A slash divides by the next factor only: N/m m is N.
            let power = if i > 0 && j == 0 { -power } else { power };
            all.factor *= unit.factor.powi(power);
            all.tens += unit.tens * power;
            for (sum, own) in all.dimension.0.iter_mut().zip(unit.dimension.0) {
                *sum += own * power;
            }
        }
    }
    // Reject exponents that no real unit has.
    (all.tens.abs() <= 60 && all.dimension.0.iter().all(|p| p.abs() <= 12)).then_some(all)
}

/// Parses a unit with its exponent: `mm`, `cm³`, `s^-1`, `m2`.
fn with_power(text: &str) -> Option<(Scale, i32)> {
    if let Some(unit) = with_prefix(text) {
        return Some((unit, 1));
    }
    let is_power = |c: char| c.is_ascii_digit() || "^-\u{207b}¹²³".contains(c);
    let unit = text.trim_end_matches(is_power);
    let power = text.get(unit.len()..)?.chars().map(|c| match c {
        '\u{207b}' => '-',
        '¹' => '1',
        '²' => '2',
        '³' => '3',
        c => c,
    });
    let power: String = power.collect();
    let power: i32 = power.strip_prefix('^').unwrap_or(&power).parse().ok()?;
    Some((with_prefix(unit)?, power)).filter(|_| (1..=4).contains(&power.abs()))
}

fn with_prefix(text: &str) -> Option<Scale> {
    let find = |symbol: &str| UNITS.iter().find(|unit| unit.0 == symbol);
    if let Some(&Unit(_, dimension, factor, tens, _)) = find(text) {
        return Some(Scale { dimension, factor, tens });
    }
    PREFIXES.iter().find_map(|(prefix, power)| {
        let &Unit(_, dimension, factor, tens, _) = find(text.strip_prefix(prefix)?).filter(|unit| unit.4)?;
        Some(Scale { dimension, factor, tens: tens + power })
    })
}

/// Returns the unit of the values of `key`; `None` if `key` holds no number with a unit.
fn unit_of(key: &str) -> Option<&'static str> {
    let is_name = |part: &&str| part.parse::<usize>().is_err();
    let key: Vec<&str> = key.split('.').filter(is_name).collect();
    let key = key.join(".");
    KEYS.iter().find(|known| known.path == key)?.kind.quantity().map(|limit| limit.unit)
}

/// Describes the quantity that `key` holds; `None` if `key` holds no number with a unit.
pub(crate) fn quantity_of(key: &str) -> Option<Sentence> {
    unit_of(key).map(|unit| quantity(scale_of(unit).map_or(NUMBER, |scale| scale.dimension), Some(unit)))
}

/// Parses a number typed as text for `key`; `None` if `key` holds no number with a unit.
pub(crate) fn number_for(key: &str, text: &str) -> Option<Result<f64, Invalid>> {
    let unit = unit_of(key)?;
    Some(parse(text, unit).map_err(|error| Invalid::new(key, error.message)))
}

/// Writes a number for `key` in the unit of the text `before`; `None` if no decimal number in that unit is exactly `value`.
#[cfg(feature = "cli")]
pub(crate) fn in_unit_of(before: &str, key: &str, value: f64) -> Option<String> {
    let unit = unit_of(key)?;
    let (plain, _) = without_groups(before.trim())?;
    let (_, typed) = split(&plain)?;
    let one = parse(&format!("1{typed}"), unit).ok()?;
    let rounded = (14..17).filter_map(|digits| format!("{:.digits$e}", value / one).parse::<f64>().ok());
    let mut written = rounded.map(|number| format!("{number}{typed}"));
    written.find(|text| parse(text, unit) == Ok(value))
}

/// Replaces every number that is written with its unit in a TOML text by the plain number, keeping line numbers, so
/// that later errors refer to lines of the file. `rename` maps a key of the text to a key of the scene. A text that is
/// not TOML is returned unchanged; a later parser reports it.
pub(crate) fn plain<'a>(text: &'a str, rename: impl Fn(&str) -> String) -> Result<Cow<'a, str>, Invalid> {
    // A search for quotes would not be enough to skip parsing: all scenes contain quotes, few contain units in quotes.
    let Ok(table) = DeTable::parse(text) else { return Ok(Cow::Borrowed(text)) };
    let mut found = Vec::new();
    for (name, value) in table.get_ref() {
        collect(&rename(name.get_ref()), value, &mut found)?;
    }
    if found.is_empty() {
        return Ok(Cow::Borrowed(text));
    }
    found.sort_by_key(|(span, _)| span.start);
    let (mut plain, mut at) = (String::with_capacity(text.len()), 0);
    for (span, value) in found {
        let (Some(before), Some(literal)) = (text.get(at..span.start), text.get(span.clone())) else { continue };
        // A multi-line string is left as it is, because replacing it would shift the lines after it.
        if literal.contains('\n') {
            continue;
        }
        plain.push_str(before);
        plain.push_str(&toml_number(value));
        at = span.end;
    }
    plain.push_str(text.get(at..).unwrap_or_default());
    Ok(Cow::Owned(plain))
}

fn collect(key: &str, value: &Spanned<DeValue<'_>>, found: &mut Vec<(Range<usize>, f64)>) -> Result<(), Invalid> {
    match value.get_ref() {
        DeValue::String(text) => {
            if let Some(number) = number_for(key, text) {
                found.push((value.span(), number?));
            }
        }
        DeValue::Array(items) => {
            for (i, item) in items.iter().enumerate() {
                collect(&format!("{key}.{i}"), item, found)?;
            }
        }
        DeValue::Table(table) => {
            for (name, inner) in table {
                collect(&format!("{key}.{}", name.get_ref()), inner, found)?;
            }
        }
        _ => {}
    }
    Ok(())
}

/// Writes a number as TOML.
pub(crate) fn toml_number(value: f64) -> String {
    if value.is_nan() { "nan".to_owned() } else { format!("{value:?}") }
}

#[cfg(test)]
mod tests {
    use super::parse;
    use crate::format::{editable, engineering};

    #[test]
    fn displayed_numbers_are_read_back_unchanged() {
        for unit in ["N", "Pa", "m", "m/s²", "N m", "s", "1/s", "°", "kg/m³", "", "%"] {
            for value in [30_000.0, -0.25, 1e6, 0.016, 1234.5, 2.1e11, 1e-9, 9.81] {
                let shown = editable(value, unit);
                let read = parse(&shown, unit).unwrap_or(f64::NAN);
                assert!(
                    (read - value).abs() <= 1e-15 * value.abs(),
                    "{value} {unit} is shown as {shown}, read as {read}"
                );
            }
        }
        // A value typed in radians, and a value that is not typed.
        assert_eq!(
            (editable(0.123_f64.to_radians().to_degrees(), "°").as_str(), editable(1.0 / 60.0, "s").as_str()),
            ("0.123°", "16.67 ms")
        );
        assert_eq!((editable(1e-3, "1/s"), editable(16.0, "ms")), ("0.001 1/s".to_owned(), "16 ms".to_owned()));
        assert_eq!((engineering(-90.0, "°"), engineering(30.0, "%")), ("-90°".to_owned(), "30 %".to_owned()));
    }
}
