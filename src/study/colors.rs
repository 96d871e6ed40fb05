//! Colours of methods and integrators in figures and in the window.

/// Red, green and blue of a method or an integrator, by its name in scene files: on a light background, and on a dark
/// one. Methods differ in brightness too.
const COLORS: &[(&str, [[u8; 3]; 2])] = &[
    ("linear", [[200, 90, 0], [240, 150, 60]]),
    ("warped", [[128, 50, 190], [202, 160, 255]]),
    ("newton", [[0, 100, 180], [90, 200, 250]]),
    ("auto", [[0, 120, 80], [110, 220, 140]]),
    ("tr-bdf2", [[85, 110, 0], [190, 225, 80]]),
    ("energy-momentum", [[185, 20, 110], [255, 150, 205]]),
    ("implicit-euler", [[190, 20, 30], [255, 105, 97]]),
    ("symplectic-euler", [[115, 75, 50], [200, 165, 135]]),
];

/// Grey, used for unknown names.
const OTHER: [[u8; 3]; 2] = [[110, 110, 110], [170, 170, 170]];

/// Returns the colour of a method or an integrator on a dark or a light background, by its name in scene files.
///
/// ```
/// use warpbeam::study::color;
/// assert_eq!(color("newton", false), [0, 100, 180]);
/// ```
pub fn color(id: &str, dark: bool) -> [u8; 3] {
    let own = COLORS.iter().find(|(name, _)| *name == id).map_or(OTHER, |(_, colors)| *colors);
    own[usize::from(dark)]
}

#[cfg(test)]
mod tests {
    use super::COLORS;
    use crate::dynamics::INTEGRATORS;
    use crate::method::METHODS;

    /// A colour means one method or one integrator.
    #[test]
    fn colours_differ() {
        for dark in [0, 1] {
            for (i, (a, own)) in COLORS.iter().enumerate() {
                for (b, other) in &COLORS[i + 1..] {
                    let apart = own[dark].iter().zip(other[dark]).map(|(a, b)| u32::from(a.abs_diff(b))).sum::<u32>();
                    assert!(apart > 80, "{a} and {b}: {apart}");
                }
            }
        }
    }

    #[test]
    fn every_entry_of_the_registries_has_a_colour_and_every_colour_an_entry() {
        let mut entries: Vec<&str> = METHODS.iter().map(|m| m.id).chain(INTEGRATORS.iter().map(|i| i.id)).collect();
        let mut named: Vec<&str> = COLORS.iter().map(|(name, _)| *name).collect();
        entries.sort_unstable();
        named.sort_unstable();
        assert_eq!(entries, named);
    }
}
