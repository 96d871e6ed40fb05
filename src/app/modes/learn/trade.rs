//! Card of the trade-off between error and time: elements by methods, measured in the background on request.

use egui::{Button, Grid, ProgressBar, RichText, Ui};

use super::{Learn, Shown};
use crate::app::action::Action;
use crate::app::language::{bound_percent, fill, percent, said, tr};
use crate::app::modes::budget::measured::runs_away;
use crate::app::widgets::buttons::option_button;
use crate::app::widgets::palette::{Palette, SMALL};
use crate::format::{engineering, two_digits};
use crate::method::METHODS;
use crate::scene::{ElementKind, MethodKind};
use crate::study::{Measurement, Study};

/// Selectable errors, percent.
pub(super) const ASKED: [f64; 3] = [10.0, 1.0, 0.1];

/// Returns the fastest setting with this element and method whose error is at most `percent`, or else the most accurate
/// one.
pub(super) fn best(
    study: &Study,
    element: ElementKind,
    method: MethodKind,
    percent: f64,
) -> Option<(Measurement, bool)> {
    let is_own = |m: &&Measurement| (m.setting.element, m.setting.method) == (element, method);
    let good = study.ranking().within(percent).into_iter().find(is_own);
    let closest =
        || study.measurements.iter().filter(is_own).min_by(|a, b| a.error.bound().total_cmp(&b.error.bound()));
    good.map(|m| (*m, true)).or_else(|| Some((*closest()?, false)))
}

/// Shows the table, and the button that starts the study.
pub(super) fn show(ui: &mut Ui, shown: &Shown<'_>, learn: &mut Learn, actions: &mut Vec<Action>) {
    let palette = Palette::new(ui.visuals());
    ui.horizontal_wrapped(|ui| {
        if let Some((fraction, now)) = shown.progress {
            if ui.button(tr("Cancel")).on_hover_text(tr("Stop measuring; what has been measured stays")).clicked() {
                actions.push(Action::Measure(false));
            }
            ui.add(ProgressBar::new(fraction).desired_width(110.0).show_percentage());
            ui.add(egui::Label::new(RichText::new(said(now)).size(SMALL)).truncate());
        } else {
            let tip = "Measure error and time of every element and method on meshes up to 40 cells, on this machine";
            if ui.add(Button::new(tr("Measure"))).on_hover_text(tr(tip)).clicked() {
                actions.push(Action::Measure(true));
            }
            ui.label(tr("error at most"));
            for asked in ASKED {
                if ui.add(option_button(learn.asked == asked, percent(asked))).clicked() {
                    learn.asked = asked;
                }
            }
        }
    });
    ui.add_space(4.0);
    Grid::new("trade").num_columns(METHODS.len() + 1).spacing([14.0, 6.0]).show(ui, |ui| {
        ui.label("");
        for method in METHODS {
            ui.label(RichText::new(tr(method.id)).color(palette.method(method.kind)));
        }
        ui.end_row();
        for element in shown.input.scene.elements() {
            ui.label(element.id());
            for method in METHODS {
                let best = shown.study.and_then(|study| {
                    let (m, good) = best(study, element, method.kind, learn.asked)?;
                    Some(Best { m, bound: study.ranking().error_bound(&m), good, runs_away: runs_away(study, &m) })
                });
                cell(ui, &palette, best.as_ref());
            }
            ui.end_row();
        }
    });
    let text = match shown.study {
        Some(study) => {
            fill!(
                "Bounds: parts of the error added, against %{reference}. Grey: the smallest bound, if none is that small. \
                 *: stopped early, the method does not converge here. Up to 40 cells; Budget measures finer meshes too.",
                reference = said(&study.reference)
            )
        }
        None => tr("Nothing measured yet: it takes some seconds.").to_owned(),
    };
    ui.label(RichText::new(text).size(SMALL).color(palette.secondary));
}

/// Best setting of an element and a method.
struct Best {
    m: Measurement,
    /// Bound of its error, percent.
    bound: f64,
    /// `true` if the bound is as small as asked.
    good: bool,
    /// Warning that the method does not converge.
    runs_away: Option<String>,
}

fn cell(ui: &mut Ui, palette: &Palette, best: Option<&Best>) {
    let Some(Best { m, bound, good, runs_away }) = best else {
        ui.label(RichText::new("\u{2013}").color(palette.secondary));
        return;
    };
    let time = engineering(two_digits(1e-3 * m.milliseconds()), "s");
    let mut text = if *good { time.clone() } else { fill!("at most %{error}", error = bound_percent(*bound)) };
    if runs_away.is_some() {
        text.push('*');
    }
    let color = if *good { palette.text } else { palette.secondary };
    let tip = fill!(
        "%{setting}: %{time}, error at most %{error}",
        setting = said(&m.setting),
        time = time,
        error = bound_percent(*bound)
    );
    let tip = std::iter::once(tip).chain(runs_away.clone()).collect::<Vec<_>>().join("\n");
    ui.add(egui::Label::new(RichText::new(text).color(color)).extend()).on_hover_text(tip);
}
