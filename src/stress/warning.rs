//! Warnings of strains that the linear law does not cover, and of inverted elements.

use super::LAW_HOLDS;
use crate::format::{number, three_digits};
use crate::sentence::{Sentence, sentence};

/// Returns a warning for strains beyond [`LAW_HOLDS`].
pub(crate) fn strain_warning(max_strain: f64) -> Option<Sentence> {
    /// Relative excess that is rounding error.
    const ROUNDING: f64 = 1e-9;
    let percent = 100.0 * max_strain;
    (percent.is_finite() && max_strain > LAW_HOLDS * (1.0 + ROUNDING)).then(|| {
        sentence!(
            "strains reach %{n} %: beyond %{most} % the linear law between stress and strain is not realistic",
            n = number(three_digits(percent)),
            most = (100.0 * LAW_HOLDS).to_string()
        )
    })
}

/// Returns a warning for a state in which some elements, out of `all`, are inverted.
pub(crate) fn inversion_warning(inverted: usize, all: usize) -> Option<Sentence> {
    (inverted > 0).then(|| {
        sentence!(
            "inverted elements: %{n} of %{all}, with a negative area, which no real body can have",
            n = inverted.to_string(),
            all = all.to_string()
        )
    })
}

#[cfg(test)]
mod tests {
    use super::strain_warning;

    #[test]
    fn strains_beyond_the_linear_law_have_a_warning() {
        assert_eq!(strain_warning(0.09), None);
        assert!(strain_warning(0.18).is_some_and(|warning| warning.to_string().contains("reach 18 %")));
    }
}
