//! Mode Measure, in tabs: how far the methods hold, how fast they are, and the load curve of the scene.

pub(crate) mod budget;
pub(crate) mod limits;
pub(crate) mod load_curve;

use self::budget::Budget;
use super::*;

#[derive(Default)]
pub(crate) struct Measure {
    limits: Keyed<facts::LimitsFact>,
    curve: Keyed<facts::CurveFact>,
    pub budget: Budget,
}

impl Measure {
    /// Turns to another scene.
    pub(crate) fn open(&mut self, scene: &Scene) {
        self.budget.open(scene);
        self.limits.turn_to(scene);
        self.curve.clear();
    }

    /// Requests limits or curve while they are shown, of a body at rest or a motion, or computes them and `waits`; returns
    /// `true` while they are pending.
    pub(crate) fn obtain(&mut self, session: &Session, view: &ViewOptions, is_pressed: bool, waits: bool) -> bool {
        let (Self { limits, curve, .. }, scene) = (self, session.scene());
        let tab = view.measured(scene);
        if tab != Some(MeasureTab::HowFar) && limits.progress().is_some() {
            limits.clear();
        }
        curve.turn_to(scene);
        let is_free = session.is_motion() || !(is_pressed || session.iterates() || session.is_working());
        match tab {
            Some(MeasureTab::HowFar) => {
                // Another load in the range of the limits does not change them, nor do method and element.
                let base =
                    limits.asked().filter(|base| limits::part_of(base, scene).is_some()).unwrap_or(scene).clone();
                limits.turn_to(&base);
                is_free && limits.obtain(&base, waits)
            }
            Some(MeasureTab::LoadCurve) => is_free && curve.obtain(scene, waits),
            Some(MeasureTab::HowFast) | None => false,
        }
    }

    /// Returns `true` until the limits or the curve that are shown have been computed.
    pub(crate) fn is_pending(&self, scene: &Scene, view: &ViewOptions) -> bool {
        match view.measured(scene) {
            Some(MeasureTab::HowFar) => self.limits.asked().is_none_or(|base| self.limits.is_pending(base)),
            Some(MeasureTab::LoadCurve) => self.curve.is_pending(scene),
            Some(MeasureTab::HowFast) | None => false,
        }
    }

    pub(crate) fn show(&mut self, ui: &mut Ui, session: &Session, view: &ViewOptions, actions: &mut Vec<Action>) {
        let scene = session.scene();
        let Some(tab) = view.measured(scene) else { return };
        ui.horizontal_wrapped(|ui| {
            ui.add_space(8.0);
            for other in MeasureTab::of(scene) {
                let (name, about) = other.text();
                let button = ui.add(Button::selectable(*other == tab, tr(name))).on_hover_text(tr(about));
                if button.clicked() && *other != tab {
                    actions.push(Action::Toggle(Toggle::Tab(*other)));
                }
            }
            if tab == MeasureTab::HowFar && self.limits.known().is_some() {
                limits::key(ui, session);
            }
        });
        match tab {
            MeasureTab::HowFar => limits::show(ui, session, &self.limits, actions),
            MeasureTab::HowFast => self.budget.show(ui, session, actions),
            MeasureTab::LoadCurve => load_curve::show(ui, session, &self.curve, view.curve_plot, actions),
        }
    }
}

/// Returns the displacement of the first probe, m, at an equilibrium.
fn first_probe(shown: &Simulation) -> Option<Vector2<f64>> {
    facts::first_probe(shown).filter(|_| shown.status().is_success())
}
