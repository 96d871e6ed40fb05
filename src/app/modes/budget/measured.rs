//! Measurements for the mode Budget: the study of a body at rest, or the study of a motion.

use crate::app::action::Action;
use egui::Color32;

use crate::app::diagnosis::drift_text;
use crate::app::language::{count, fill, percent, said, tr};
use crate::app::session::clock::FRAMES;
use crate::app::widgets::palette::Palette;
use crate::format::{engineering, three_digits};
use crate::plot::{LARGEST_ERROR, SMALLEST_ERROR};
use crate::scene::{ElementKind, IntegratorKind, MethodKind, Scene};
use crate::study::motion::{MotionMeasurement, MotionSetting, PathError};
use crate::study::{Demand, Measurement, MotionStudy, Study};

/// Study of a body at rest or of a motion.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub(crate) enum Measured {
    Rest(Study),
    Motion(MotionStudy),
}

/// Measured setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Choice {
    Rest(Measurement),
    Motion(MotionMeasurement),
}

/// Group of settings drawn with the same colour and shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Group {
    Method(MethodKind, ElementKind),
    Integrator(IntegratorKind, ElementKind),
}

impl Measured {
    /// Returns every setting whose error was measured.
    pub(crate) fn choices(&self) -> Vec<Choice> {
        match self {
            Self::Rest(study) => study.measurements.iter().copied().map(Choice::Rest).collect(),
            Self::Motion(study) => {
                let ended = study.measurements.iter().filter(|m| m.error.is_some());
                ended.copied().map(Choice::Motion).collect()
            }
        }
    }

    /// Returns the Pareto-optimal settings, fastest first.
    pub(crate) fn front(&self) -> Vec<Choice> {
        match self {
            Self::Rest(study) => study.ranking().front().into_iter().copied().map(Choice::Rest).collect(),
            Self::Motion(study) => study.ranking().front().into_iter().copied().map(Choice::Motion).collect(),
        }
    }

    /// Returns the settings that meet a demand, fastest first. For a motion, the time is that of a frame.
    pub(crate) fn meeting(&self, demand: Demand) -> Vec<Choice> {
        match self {
            Self::Rest(study) => study.ranking().meeting(demand).into_iter().copied().map(Choice::Rest).collect(),
            Self::Motion(study) => {
                let demand = Demand { max_time_ms: demand.max_time_ms.map(|frame| frame * FRAMES), ..demand };
                study.ranking().meeting(demand).into_iter().copied().map(Choice::Motion).collect()
            }
        }
    }

    /// Returns the settings nearest to a demand that none meets: the most accurate one within the time, and the fastest
    /// one within the error. None if the reference's own error is too large to tell.
    pub(crate) fn nearest(&self, demand: Demand) -> Vec<Choice> {
        if self.too_coarse_for(demand).is_some() {
            return Vec::new();
        }
        let in_time = self.meeting(Demand { max_error_percent: None, ..demand });
        let accurate = in_time.into_iter().min_by(|a, b| self.error_percent(a).total_cmp(&self.error_percent(b)));
        let fast = self.meeting(Demand { max_time_ms: None, ..demand }).first().copied();
        accurate.filter(|choice| self.error_percent(choice).is_finite()).into_iter().chain(fast).collect()
    }

    /// Returns the error bound of the reference solution, percent.
    pub(crate) fn own_error_percent(&self) -> f64 {
        match self {
            Self::Rest(study) => study.against.own_error_percent,
            Self::Motion(study) => study.reference.error_percent,
        }
    }

    /// Returns the error bound of the reference solution, percent, if it is too large to judge whether a demand is met.
    pub(crate) fn too_coarse_for(&self, demand: Demand) -> Option<f64> {
        let own = self.own_error_percent();
        demand.max_error_percent.filter(|most| own >= *most).map(|_| own)
    }

    /// Returns the name of the reference solution.
    pub(crate) fn reference_text(&self) -> String {
        match self {
            Self::Rest(study) => said(&study.reference),
            Self::Motion(study) => {
                fill!(
                    "the same motion on a finer mesh (its own error about %{own})",
                    own = percent(study.reference.error_percent)
                )
            }
        }
    }

    /// Returns the error of a setting in the plot, percent.
    pub(crate) fn drawn_error(&self, choice: &Choice) -> f64 {
        self.error_percent(choice).clamp(SMALLEST_ERROR, LARGEST_ERROR)
    }

    /// Returns the error bound of a setting, percent, including the error of the reference solution; infinite for a
    /// motion that did not finish.
    pub(crate) fn error_percent(&self, choice: &Choice) -> f64 {
        match (self, choice) {
            (Self::Rest(study), Choice::Rest(m)) => study.ranking().error_bound(m),
            (Self::Motion(study), Choice::Motion(m)) => study.ranking().error_bound(m),
            _ => f64::INFINITY,
        }
    }

    /// Returns `true` if the iteration of a setting converges when it runs on; a motion does not run on.
    pub(crate) fn converges(&self, choice: &Choice) -> bool {
        match (self, choice) {
            (Self::Rest(study), Choice::Rest(m)) => study.converges(m),
            _ => true,
        }
    }

    /// Returns the fastest of these settings whose iteration converges when it runs on.
    pub(crate) fn fastest(&self, choices: &[Choice]) -> Option<Choice> {
        choices.iter().find(|choice| self.converges(choice)).copied()
    }

    /// Describes the unknowns and the parts of the error of a setting.
    pub(crate) fn parts(&self, choice: &Choice) -> String {
        match (self, choice) {
            (Self::Rest(study), Choice::Rest(m)) => {
                let parts = fill!(
                    "Click to apply. %{unknowns}. Error: mesh %{mesh}, stopped early %{iteration}, linear theory %{theory}.",
                    unknowns = count(m.dofs as u64, "unknown"),
                    mesh = part_text(m.error.discretization),
                    iteration = part_text(m.error.iteration),
                    theory = part_text(m.error.model)
                );
                [Some(parts), runs_away(study, m)].into_iter().flatten().collect::<Vec<_>>().join(" ")
            }
            (Self::Motion(study), Choice::Motion(m)) => {
                let part = |of: fn(&PathError) -> f64| part_text(m.error.as_ref().map_or(0.0, of));
                fill!(
                    "Click to apply. %{unknowns}. Error: mesh %{mesh}, time steps %{steps}, linear theory %{theory}. Drift in %{duration}: %{drift} of the energy put in.",
                    unknowns = count(m.dofs as u64, "unknown"),
                    mesh = part(|e| e.discretization),
                    steps = part(|e| e.integration),
                    theory = part(|e| e.model),
                    duration = engineering(three_digits(study.duration), "s"),
                    drift = drift_text(0.01 * m.drift_of_input_percent)
                )
            }
            _ => String::new(),
        }
    }
}

/// Formats a part of an error; one that a setting does not have is 0.
fn part_text(part: f64) -> String {
    if part == 0.0 { "0 %".to_owned() } else { percent(part) }
}

/// Returns the warning that a setting stops an iteration that does not converge when it runs on.
pub(crate) fn runs_away(study: &Study, m: &Measurement) -> Option<String> {
    (!study.converges(m)).then(|| {
        fill!(
            "%{method} does not converge here in %{n} iterations: other loads need another number of them.",
            method = tr(m.setting.method.id()),
            n = Study::MAX_ITERATIONS
        )
    })
}

impl Choice {
    /// Returns the time of a solve, or of one frame at 60 Hz of a motion, ms.
    pub(crate) fn milliseconds(&self) -> f64 {
        match self {
            Self::Rest(m) => m.milliseconds(),
            Self::Motion(m) => m.milliseconds / FRAMES,
        }
    }

    /// Returns the label of the measured setting: element, mesh and method.
    pub(crate) fn text(&self) -> String {
        match self {
            Self::Rest(m) => said(&m.setting),
            Self::Motion(m) => said(&m.setting),
        }
    }

    /// Returns the action that applies this setting to a scene. A motion makes one step at a time.
    pub(crate) fn action(&self, scene: &Scene) -> Action {
        match self {
            Self::Rest(m) => Action::Apply(Box::new(m.apply(scene))),
            Self::Motion(m) => Action::Apply(Box::new(m.setting.apply(scene))),
        }
    }

    /// Returns `true` if a scene has this setting.
    pub(crate) fn is_applied_to(&self, scene: &Scene) -> bool {
        match self {
            Self::Rest(m) => m.is_applied_to(scene),
            Self::Motion(m) => m.setting == MotionSetting::of(scene),
        }
    }

    pub(crate) fn group(&self) -> Group {
        match self {
            Self::Rest(m) => Group::Method(m.setting.method, m.setting.element),
            Self::Motion(m) => Group::Integrator(m.setting.integrator, m.setting.element),
        }
    }
}

impl Group {
    pub(crate) fn element(self) -> ElementKind {
        match self {
            Self::Method(_, element) | Self::Integrator(_, element) => element,
        }
    }

    pub(crate) fn color(self, palette: &Palette) -> Color32 {
        match self {
            Self::Method(method, _) => palette.method(method),
            Self::Integrator(integrator, _) => palette.integrator(integrator),
        }
    }

    pub(crate) fn name(self) -> String {
        let id = match self {
            Self::Method(method, _) => method.id(),
            Self::Integrator(integrator, _) => integrator.id(),
        };
        format!("{} {}", self.element().id(), tr(id))
    }
}
