//! Settings of a pane: method, element, mesh, iterations, integrator; and their text form.

use std::fmt;
use std::str::FromStr;
use thiserror::Error;

use super::*;
use crate::element::ELEMENTS;

/// Smallest and largest number of panes.
pub(super) const PANES: std::ops::RangeInclusive<usize> = 2..=4;

/// Settings of a pane; `None` means the setting of the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PaneSetting {
    /// Method.
    pub method: Option<MethodKind>,
    /// Element.
    pub element: Option<ElementKind>,
    /// Cells along and across.
    pub cells: Option<[u32; 2]>,
    /// Number of iterations after which a solve is stopped.
    pub iterations: Option<u32>,
    /// Integrator of a motion.
    pub integrator: Option<IntegratorKind>,
}

/// Error in the text form of panes.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PaneSettingError {
    /// A part is not recognized.
    #[error(
        "expected a method ({}), an element ({}), cells as in 10x2 or a number of iterations, got \u{201c}{part}\u{201d}",
        METHODS.iter().map(|entry| entry.id).collect::<Vec<_>>().join(", "),
        ELEMENTS.iter().map(|entry| entry.id).collect::<Vec<_>>().join(", "),
        part = .0,
    )]
    Unknown(String),
    /// A part repeats a kind of setting.
    #[error("expected one method, element, mesh and number of iterations, got another one: \u{201c}{0}\u{201d}")]
    Twice(String),
    /// Too few or too many panes.
    #[error("expected {} to {} panes, as in linear,warped,newton, got {got}", PANES.start(), PANES.end(), got = .0)]
    Count(usize),
}

impl PaneSetting {
    /// Returns the settings with the scene's own values filled in.
    pub fn of(&self, scene: &Scene) -> Self {
        Self {
            method: Some(self.method.unwrap_or(scene.solver.method)),
            element: Some(self.element.unwrap_or(scene.element())),
            cells: scene.beam.as_ref().map(|beam| self.cells.unwrap_or(beam.cells)),
            ..*self
        }
    }

    /// Returns the scene with these settings.
    pub fn apply(&self, scene: &Scene) -> Scene {
        let mut own = scene.clone();
        own.set_element(self.element.unwrap_or(scene.element()));
        own.beam.iter_mut().for_each(|beam| beam.cells = self.cells.unwrap_or(beam.cells));
        own.solver.method = self.method.unwrap_or(scene.solver.method);
        // A pane with a number of iterations counts them; other settings than the scene's are iterated to the tolerance.
        let is_scenes =
            (own.solver.method, own.element(), &own.beam) == (scene.solver.method, scene.element(), &scene.beam);
        if self.iterations.is_some() || !is_scenes {
            own.solver.accept_after = 0;
        }
        own.dynamics.integrator = self.integrator.unwrap_or(scene.dynamics.integrator);
        own
    }
}

impl From<Setting> for PaneSetting {
    fn from(setting: Setting) -> Self {
        Self {
            method: Some(setting.method),
            element: Some(setting.element),
            cells: setting.cells,
            iterations: Some(setting.iterations),
            integrator: None,
        }
    }
}

impl fmt::Display for PaneSetting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let method = self.method.map(|method| tr(method.id()).to_owned());
        let element = self.element.map(|element| element.id().to_owned());
        let cells = self.cells.map(|[along, across]| format!("{along}×{across}"));
        let iterations = self.iterations.map(|n| count(n, "iteration"));
        let integrator = self.integrator.map(|integrator| tr(integrator.id()).to_owned());
        let parts: Vec<_> = [method, element, cells, iterations, integrator].into_iter().flatten().collect();
        f.write_str(&if parts.is_empty() { tr("the scene").to_owned() } else { parts.join(" ") })
    }
}

/// Parses parts in any order, separated by colons: `warped:t6:10x2`, `t3`, `newton`, `warped:4`. `scene` stands for the
/// scene's own settings.
impl FromStr for PaneSetting {
    type Err = PaneSettingError;

    fn from_str(text: &str) -> Result<Self, PaneSettingError> {
        let mut setting = Self::default();
        if text.trim() == "scene" {
            return Ok(setting);
        }
        for part in text.split(':').map(str::trim) {
            let method = METHODS.iter().find(|entry| entry.id == part).map(|entry| entry.kind);
            let element = ELEMENTS.iter().find(|entry| entry.id == part).map(|entry| entry.kind);
            let cells = part.split_once(['x', 'X', '×']).and_then(|(a, b)| Some([a.parse().ok()?, b.parse().ok()?]));
            let iterations = part.parse().ok().filter(|&n| n > 0);
            let is_second = match (method, element, cells, iterations) {
                (Some(method), ..) => setting.method.replace(method).is_some(),
                (_, Some(element), ..) => setting.element.replace(element).is_some(),
                (_, _, Some(cells), _) => setting.cells.replace(cells).is_some(),
                (.., Some(iterations)) => setting.iterations.replace(iterations).is_some(),
                _ => return Err(PaneSettingError::Unknown(part.to_owned())),
            };
            if is_second {
                return Err(PaneSettingError::Twice(part.to_owned()));
            }
        }
        Ok(setting)
    }
}

/// Parses two to four settings, separated by commas.
///
/// # Errors
/// [`PaneSettingError`].
pub fn parse_panes(text: &str) -> Result<Vec<PaneSetting>, PaneSettingError> {
    let settings = text.split(',').map(str::parse).collect::<Result<Vec<PaneSetting>, _>>()?;
    if PANES.contains(&settings.len()) { Ok(settings) } else { Err(PaneSettingError::Count(settings.len())) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_read_in_any_order() {
        let all = PaneSetting {
            method: Some(MethodKind::Warped),
            element: Some(ElementKind::T6),
            cells: Some([10, 2]),
            iterations: Some(4),
            integrator: None,
        };
        for text in ["warped:t6:10x2:4", "10×2:4:t6:warped", " warped : t6 : 10x2 : 4 "] {
            assert_eq!(text.parse(), Ok(all), "{text}");
        }
        assert_eq!(all.to_string(), "warped t6 10×2 4 iterations");
        assert_eq!("newton".parse(), Ok(PaneSetting { method: Some(MethodKind::Newton), ..PaneSetting::default() }));
        assert_eq!("t3".parse(), Ok(PaneSetting { element: Some(ElementKind::T3), ..PaneSetting::default() }));
        assert_eq!("scene".parse(), Ok(PaneSetting::default()));
        assert_eq!(parse_panes("linear,warped,newton").map(|panes| panes.len()), Ok(3));
    }

    #[test]
    fn invalid_pane_settings_are_refused_with_the_expected_form() {
        for text in ["", "wraped", "t5", "10x", "0", "-1", "1.5"] {
            let error = text.parse::<PaneSetting>().unwrap_err();
            assert_eq!(error, PaneSettingError::Unknown(text.to_owned()));
            assert!(error.to_string().contains("warped") && error.to_string().contains("t6"), "{error}");
        }
        for text in ["warped:newton", "t3:t6", "2x1:4x1", "3:4"] {
            assert!(matches!(text.parse::<PaneSetting>(), Err(PaneSettingError::Twice(_))), "{text}");
        }
        for (text, got) in [("warped", 1), ("t3,t6,q4,t3,t6", 5)] {
            assert_eq!(parse_panes(text), Err(PaneSettingError::Count(got)), "{text}");
        }
    }
}
