//! Mode Measure, in tabs: how far the methods hold, how fast they are, and the load curve of the scene.

pub(crate) mod budget;
pub(crate) mod limits;
pub(crate) mod load_curve;

use self::budget::Budget;
use super::*;

#[derive(Debug, Default)]
pub(crate) struct Measure {
    /// Scene whose limits are shown.
    pub limits_of: Option<Scene>,
    pub budget: Budget,
}

impl Measure {
    /// Turns to another scene.
    pub(crate) fn open(&mut self, scene: &Scene) {
        self.budget.open(scene);
        self.limits_of = None;
    }

    /// Shows a tab.
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
            if let (MeasureTab::HowFar, Some(base)) = (tab, &self.limits_of) {
                limits::key(ui, session, base);
            }
        });
        match tab {
            MeasureTab::HowFar => {
                if let Some(base) = &self.limits_of {
                    limits::show(ui, session, base, actions);
                }
            }
            MeasureTab::HowFast => self.budget.show(ui, session, actions),
            MeasureTab::LoadCurve => load_curve::show(ui, session, view.curve_plot, actions),
        }
    }
}

/// Returns the displacement of the first probe, m, at an equilibrium.
fn first_probe(shown: &Simulation) -> Option<Vector2<f64>> {
    facts::first_probe(shown).filter(|_| shown.status().is_success())
}
