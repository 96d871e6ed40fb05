//! Error against time of all settings measured on this machine, and the settings within given limits.

use super::*;
use crate::app::diagnosis::drift_text;
use crate::app::language::bound_percent;
use crate::app::session::clock::FRAMES;
use crate::exact_beam::error_percent;
use crate::plot::{SMALLEST_ERROR, StudyChart, mark};
use crate::scene::limits::BUDGET_MS;
use crate::study::{Demand, ErrorSplit, Measurement, Setting, Study};

/// The study of the scene, and the largest error and time that a setting may have.
pub(crate) struct Budget {
    study: Keyed<facts::StudyFact>,
    measured: Option<Scene>,
    /// `true` if the study is that of a scene which was open before.
    is_hidden: bool,
    /// Limits of error and time; of a motion, of the time of a frame at 60 Hz.
    demand: Demand,
    messages: Messages,
}

impl Default for Budget {
    fn default() -> Self {
        // About the time of one frame at 60 Hz, ms.
        let demand = Demand { max_error_percent: Some(1.0), max_time_ms: Some(16.0) };
        Self { study: Keyed::default(), measured: None, is_hidden: false, demand, messages: Messages::default() }
    }
}

impl Budget {
    /// Starts a study of a scene, and drops the previous one. A setting of the previous study that was applied is measured
    /// among the same settings again: those of a motion are chosen around the mesh and the time step of the scene.
    pub(crate) fn measure(&mut self, scene: &Scene) {
        let is_setting = |study: &Study| study.measurements.iter().any(|m| m.applied() == Setting::of(scene));
        let known = self.study.known().filter(|(_, study)| self.study.is_of(scene) && is_setting(study));
        self.measured = Some(known.map_or(scene, |(base, _)| base).clone());
        self.study.clear();
        self.is_hidden = false;
    }

    /// Turns to another scene; the study is shown again with its own.
    pub(crate) fn open(&mut self, scene: &Scene) {
        self.cancel();
        self.is_hidden = !self.study.is_of(scene);
    }

    /// Ends the study; measurements made so far are kept.
    pub(crate) fn cancel(&mut self) {
        if self.measured.take().is_some() {
            self.study.stop();
        }
    }

    pub(crate) fn runs(&self) -> bool {
        self.measured.is_some()
    }

    pub(crate) fn study(&self) -> Option<&Study> {
        self.study.known().filter(|_| !self.is_hidden).map(|(_, study)| study)
    }

    /// Returns the fastest setting that was measured of a scene at rest, meets the limits, and whose iteration converges.
    pub(crate) fn chosen(&self, scene: &Scene) -> Option<Setting> {
        let study = self.study.so_far(scene)?;
        let setting = fastest(study, &meeting(study, self.demand))?.setting;
        setting.stepping.is_none().then_some(setting)
    }

    /// Sets a study made elsewhere.
    pub(crate) fn set(&mut self, scene: &Scene, study: Study) {
        self.study.set(scene, study);
        (self.measured, self.is_hidden) = (None, false);
    }

    pub(crate) fn poll(&mut self, ctx: &Context) {
        self.measured.take_if(|scene| !self.study.request(scene));
        if self.runs() {
            ctx.request_repaint_after(POLL);
        }
    }

    /// Shows limits and plot for the scene of a session.
    pub(crate) fn show(&mut self, ui: &mut Ui, session: &Session, actions: &mut Vec<Action>) {
        let scene = session.scene();
        let Self { study: fact, measured, is_hidden, demand, messages } = self;
        let study = fact.known().filter(|_| !*is_hidden).map(|(_, study)| study);
        let meeting = study.map(|study| meeting(study, *demand)).unwrap_or_default();
        let budget = BudgetView {
            scene,
            study,
            demand: *demand,
            best: study.and_then(|study| fastest(study, &meeting)),
            is_met: !meeting.is_empty(),
            listed: match study {
                Some(study) if meeting.is_empty() => nearest(study, *demand),
                _ => meeting,
            },
            current: fact.is_of(scene),
            shown: shown_result(session),
            progress: fact.progress().filter(|_| measured.is_some()),
            error: fact.failure(scene),
        };
        ui.add_space(4.0);
        let whole = ui.available_width();
        let moves = scene.analysis == Analysis::Dynamic;
        // The settings of a motion have longer names.
        let (width, share) = if moves { (600.0_f32, 0.6) } else { (480.0, 0.58) };
        ui.horizontal_top(|ui| {
            ui.vertical(|ui| {
                ui.set_width(width.min(share * whole));
                settings(ui, &budget, demand, messages, actions);
                list(ui, &budget, actions);
            });
            ui.vertical(|ui| {
                legend(ui, moves);
                plot(ui, &budget, actions);
            });
        });
    }
}

struct BudgetView<'a> {
    scene: &'a Scene,
    study: Option<&'a Study>,
    demand: Demand,
    /// Settings that meet the demand, fastest first, or if none does, those of [`nearest`].
    listed: Vec<&'a Measurement>,
    /// `true` if a setting meets the demand.
    is_met: bool,
    /// Fastest of them whose iteration converges when it runs on.
    best: Option<&'a Measurement>,
    /// `true` if the study belongs to the lab's current body and loads.
    current: bool,
    /// Time, ms, and error, percent, of the result that the window shows, which may have a setting that the study has not.
    shown: Option<[f64; 2]>,
    /// Fraction done and current measurement, while a study is in progress.
    progress: Option<(f64, &'a Sentence)>,
    /// Reason for which there is no study.
    error: Option<&'a Sentence>,
}

impl BudgetView<'_> {
    /// Returns the bound of the error of a setting, percent.
    fn error(&self, m: &Measurement) -> f64 {
        self.study.map_or(f64::INFINITY, |study| study.error_bound(m))
    }

    fn apply(&self, m: &Measurement) -> Action {
        Action::Edit("Method", Box::new(m.applied().apply(self.scene)))
    }
}

/// Returns time, ms, and error, percent, of a session's solve from rest; `None` until they are known.
fn shown_result(session: &Session) -> Option<[f64; 2]> {
    let solve = session.timed_from_rest().filter(|solve| solve.is_solved)?;
    let first = session.known_reference()?.first()?;
    let error = error_percent(solve.displacement?, first.displacement)?;
    Some([1e3 * solve.timings.total().as_secs_f64(), first.error_bound(error)])
}

/// Returns the time of a solve, or of one frame at 60 Hz of a motion, ms.
fn frame_ms(m: &Measurement) -> f64 {
    if m.motion.is_some() { m.milliseconds / FRAMES } else { m.milliseconds }
}

/// Returns the settings that meet a demand, fastest first. For a motion, the time is that of a frame.
fn meeting(study: &Study, demand: Demand) -> Vec<&Measurement> {
    let frames = if study.moves() { FRAMES } else { 1.0 };
    study.meeting(Demand { max_time_ms: demand.max_time_ms.map(|most| most * frames), ..demand })
}

/// Returns the settings nearest to a demand that none meets: the most accurate one within the time, and the fastest one
/// within the error. None if the reference's own error is too large to tell.
fn nearest(study: &Study, demand: Demand) -> Vec<&Measurement> {
    if !study.can_decide(demand) {
        return Vec::new();
    }
    let in_time = meeting(study, Demand { max_error_percent: None, ..demand }).into_iter();
    let accurate = in_time.min_by(|a, b| a.error_percent().total_cmp(&b.error_percent()));
    let fast = meeting(study, Demand { max_time_ms: None, ..demand }).into_iter().next();
    accurate.filter(|m| m.error.is_some()).into_iter().chain(fast).collect()
}

/// Returns the fastest of these settings whose iteration converges when it runs on.
fn fastest<'a>(study: &Study, choices: &[&'a Measurement]) -> Option<&'a Measurement> {
    choices.iter().find(|m| study.converges(m)).copied()
}

/// Describes the unknowns and the parts of the error of a setting, and warns of one that stops an iteration which does not
/// converge when it runs on.
fn parts(study: &Study, m: &Measurement) -> String {
    let unknowns = count(m.dofs as u64, "unknown");
    // A part that a setting does not have is 0.
    let text = |part: f64| if part == 0.0 { "0 %".to_owned() } else { percent(part) };
    let of = |part: fn(&ErrorSplit) -> f64| text(m.error.as_ref().map_or(0.0, part));
    let (mesh, iteration, theory) = (of(|e| e.discretization), of(|e| e.iteration), of(|e| e.model));
    if let Some(motion) = m.motion {
        return fill!(
            "Click to apply. %{unknowns}. Error: mesh %{mesh}, time steps %{steps}, linear theory %{theory}. Drift in %{duration}: %{drift} of the energy put in.",
            unknowns,
            mesh,
            steps = iteration,
            theory,
            duration = engineering(three_digits(study.reference.samples.duration()), "s"),
            drift = drift_text(0.01 * motion.drift_of_input_percent)
        );
    }
    let parts = fill!(
        "Click to apply. %{unknowns}. Error: mesh %{mesh}, stopped early %{iteration}, linear theory %{theory}.",
        unknowns,
        mesh,
        iteration,
        theory
    );
    if study.converges(m) {
        return parts;
    }
    let warning = fill!(
        "%{method} does not converge here in %{n} iterations: other loads need another number of them.",
        method = tr(m.setting.method.id()),
        n = Study::MAX_ITERATIONS
    );
    format!("{parts} {warning}")
}

fn settings(
    ui: &mut Ui,
    budget: &BudgetView<'_>,
    demand: &mut Demand,
    messages: &mut Messages,
    actions: &mut Vec<Action>,
) {
    let moves = budget.scene.analysis == Analysis::Dynamic;
    ui.horizontal(|ui| {
        if let Some((fraction, now)) = budget.progress {
            if ui.button(tr("Cancel")).on_hover_text(tr("Stop measuring; what has been measured stays")).clicked() {
                actions.push(Action::Measure(false));
            }
            ui.add(ProgressBar::new(fraction as f32).desired_width(120.0).show_percentage());
            ui.add(egui::Label::new(RichText::new(said(now)).small()).truncate());
        } else {
            let tip = if moves {
                "Measure error and time of the integrators on coarse meshes, on this machine; `warpbeam study` measures \
                 finer ones too"
            } else {
                "Measure error and time of every element, mesh, method and number of iterations, on this machine"
            };
            if ui.button(tr("Measure on this machine")).on_hover_text(tr(tip)).clicked() {
                actions.push(Action::Measure(true));
            }
            let mut tip = String::new();
            let (warning, failure) = (Some(ui.visuals().warn_fg_color), Some(ui.visuals().error_fg_color));
            let (text, color) = match (budget.error, budget.study) {
                (Some(error), _) => (said(error), failure),
                (None, None) => (tr("Not measured yet.").to_owned(), None),
                (None, Some(_)) if !budget.current => (tr("The body or its load has changed since.").to_owned(), warning),
                (None, Some(study)) if study.is_partial => {
                    (tr("Cancelled: not everything has been measured.").to_owned(), warning)
                }
                (None, Some(study)) => {
                    let parts = tr("Errors: mesh, iteration and theory added up.").to_owned();
                    let coarse = tr("Coarse meshes only: `warpbeam study` measures all.");
                    tip = fill!("Error against %{reference}.", reference = said(&study.reference.text));
                    (if moves { format!("{coarse} {parts}") } else { parts }, None)
                }
            };
            let text = RichText::new(text).small();
            let text = color.map_or(text.clone(), |color| text.color(color));
            ui.add(egui::Label::new(text).truncate()).on_hover_text(tip);
        }
    });
    let time = NumberField::new("Time ≤", BUDGET_MS, 1e-3..=1e3).logarithmic(1e-3).tip(
        "Longest computing time, ms: of a solve from rest, or of a frame of a motion at 60 Hz (one frame lasts 16.7 ms).",
    );
    let error = NumberField::new("Error ≤", keys::range("solver.max_error_percent"), 1e-3..=100.0)
        .logarithmic(1e-3)
        .tip("Largest error, percent of the reference displacement.");
    ui.columns_const(|[left, right]| {
        for (ui, field, limit) in [(left, time, &mut demand.max_time_ms), (right, error, &mut demand.max_error_percent)]
        {
            *limit = field.show(ui, messages, limit.unwrap_or_default(), None).or(*limit);
        }
    });
    ui.horizontal(|ui| {
        let apply = ui.add_enabled(budget.best.is_some() && budget.current, Button::new(tr("Apply the fastest")));
        let apply = apply
            .on_hover_text(tr("Use the fastest setting that meets both limits, and whose iteration converges"))
            .on_disabled_hover_text(tr(match (budget.study, budget.current) {
                (None, _) => "Not measured yet.",
                (Some(_), true) => "No measured setting meets both limits",
                (Some(_), false) => "The body or its load has changed since.",
            }));
        if let (true, Some(best)) = (apply.clicked(), budget.best) {
            actions.push(budget.apply(best));
        }
        let has_error = |m: &&Measurement| m.error.is_some();
        let measured = budget.study.map_or(0, |study| study.measurements.iter().filter(has_error).count());
        let count = match budget.study.filter(|study| !study.can_decide(budget.demand)) {
            Some(study) => {
                let own = percent(study.own_error_percent);
                fill!("Not known: the reference's own error may be %{own}", own)
            }
            // The row of Measure says that nothing has been measured.
            None if measured == 0 => String::new(),
            None if !budget.is_met => {
                fill!("None of %{measured} settings meets both; nearest:", measured)
            }
            None if budget.listed.iter().any(|m| budget.study.is_some_and(|study| !study.converges(m))) => {
                fill!("%{n} of %{measured} settings meet both; *: does not converge", n = budget.listed.len(), measured)
            }
            None => fill!("%{n} of %{measured} settings meet both", n = budget.listed.len(), measured),
        };
        ui.add(egui::Label::new(count).truncate());
    });
}

/// Shows the settings that meet the demand, fastest first, or those nearest to it, in a list;
/// a click applies one.
fn list(ui: &mut Ui, budget: &BudgetView<'_>, actions: &mut Vec<Action>) {
    let (listed, own) = (&budget.listed, Setting::of(budget.scene));
    let row_height = ui.spacing().interact_size.y;
    let area = ScrollArea::vertical().id_salt("settings").auto_shrink([false, false]);
    let applied = listed.iter().position(|m| m.applied() == own);
    let id = egui::Id::unique("applied setting");
    let (length, before) = ui.memory_mut(|memory| {
        let last = memory.data.get_temp_mut_or_default::<(usize, Option<usize>)>(id);
        std::mem::replace(last, (listed.len(), applied))
    });
    // A new list begins at its top.
    let is_other = length == listed.len() && before != applied;
    area.show_rows(ui, row_height, listed.len(), |ui, rows| {
        // The setting that was applied in the plot may be anywhere in the list.
        if let Some(row) = applied.filter(|_| is_other) {
            let step = row_height + ui.spacing().item_spacing.y;
            let top = ui.max_rect().top() + (row as f32 - rows.start as f32) * step;
            ui.scroll_to_rect(ui.max_rect().with_min_y(top).with_max_y(top + row_height), None);
        }
        for m in listed.get(rows).unwrap_or_default() {
            let mark = if budget.study.is_none_or(|study| study.converges(m)) { ' ' } else { '*' };
            let bound = format!("\u{2264}{}", bound_percent(budget.error(m)));
            let name = said(&m.setting);
            let text = format!("{:>7}  {bound:>8}{mark} {name}", milliseconds(m));
            let label = ui.add_enabled(
                budget.current,
                Button::selectable(m.applied() == own, RichText::new(text).font(FontId::monospace(12.0))).truncate(),
            );
            let parts = budget.study.map(|study| parts(study, m)).unwrap_or_default();
            if label.on_hover_text(format!("{name}\n{parts}")).clicked() {
                actions.push(budget.apply(m));
            }
        }
    });
}

/// Formats the time of a solve or of a frame.
fn milliseconds(m: &Measurement) -> String {
    engineering(two_digits(1e-3 * frame_ms(m)), "s")
}

/// Shows the key of colours and shapes above the plot, which has no room for a legend; that of the shapes where it is not
/// higher than two lines.
fn legend(ui: &mut Ui, moves: bool) {
    const SHAPES: f32 = 320.0;
    const MARK: Vec2 = vec2(10.0, 10.0);
    let palette = Palette::new(ui.visuals());
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(10.0, 0.0);
        let methods = METHODS.iter().map(|m| (m.id, palette.ink(Ink::Solution(m.colors))));
        let integrators = INTEGRATORS.iter().map(|i| (i.id, palette.ink(Ink::Solution(i.colors))));
        let names: Vec<_> = if moves { integrators.collect() } else { methods.collect() };
        for (id, color) in names {
            ui.label(RichText::new(tr(id)).small().strong().color(color));
        }
        if ui.max_rect().width() < SHAPES {
            return;
        }
        for element in ElementKind::all() {
            legend::entry(ui, element.id(), MARK, &|ui, rect| {
                let mut painter = ChartPainter::new(ui, rect.center());
                painter.polygon(&mark([0.0; 2], element, 5.0), Ink::Text, 1.0);
            });
        }
        ui.label(RichText::new(tr("line: Pareto front; cross: current setting; ring: fastest")).small());
    });
}

fn plot(ui: &mut Ui, budget: &BudgetView<'_>, actions: &mut Vec<Action>) {
    /// Times, ms, and errors, percent, that are always in the plot.
    const USUAL: [&[f64]; 2] = [&[1e-2, 1e2], &[SMALLEST_ERROR, 1e2]];
    const DASHES: &[f64] = &[4.0, 3.0];
    let (response, frame, mut drawing) = chart::area(ui);
    let plot = StudyChart::new(budget.study, frame_ms, USUAL, &frame);
    let (area, [[left, top], [width, height]]) = (frame.area(), frame.area());
    let [right, bottom] = [left + width, top + height];
    // Errors that the reference's own error hides.
    if let Some(own) = budget.study.map(|study| study.own_error_percent).filter(|own| *own > SMALLEST_ERROR) {
        let y = plot.axes[1].place(own);
        drawing.rect([[left, y], [width, bottom - y]], Ink::Limit, 0.18);
        drawing.text([left + 6.0, bottom - 6.0], Anchor::Start, Ink::Limit, tr("the reference's own error"));
    }
    let moves = budget.scene.analysis == Analysis::Dynamic;
    let time = if moves { "time of a frame at 60 Hz, ms" } else { "time of a solve, ms" };
    plot.grid(&mut drawing, &frame, [tr(time), tr("error, %")]);
    let [most_time, most_error] =
        [budget.demand.max_time_ms, budget.demand.max_error_percent].map(Option::unwrap_or_default);
    drawing.clip(Some(area));
    let ([x, y], own) = (plot.place([most_time, most_error]), Setting::of(budget.scene));
    drawing.line(&[[x, top], [x, bottom]], Ink::Limit, 1.0, DASHES);
    drawing.line(&[[left, y], [right, y]], Ink::Limit, 1.0, DASHES);
    drawing.clip(None);
    plot.draw(&mut drawing);
    let applied = plot.marks.iter().find(|(_, m)| m.applied() == own).map(|(at, _)| *at);
    if let Some([x, y]) = applied.or(budget.shown.filter(|_| budget.current).map(|shown| plot.place(shown))) {
        drawing.line(&[[x - 9.0, y], [x + 9.0, y]], Ink::Text, 2.0, &[]);
        drawing.line(&[[x, y - 9.0], [x, y + 9.0]], Ink::Text, 2.0, &[]);
    }
    if let Some((at, _)) = plot.marks.iter().find(|(_, m)| budget.best == Some(m)) {
        drawing.circle(*at, 8.0, Ink::Text, Some(1.5));
    }
    let pointed = chart::hover(ui, &response, plot.marks.iter().copied(), |m| {
        format!("{}\n{}, {}", said(&m.setting), milliseconds(m), bound_percent(budget.error(m)))
    });
    if let Some(m) = pointed.filter(|_| budget.current) {
        ui.set_cursor_icon(egui::CursorIcon::PointingHand);
        if response.clicked() {
            actions.push(budget.apply(m));
        }
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::scene::{Source, open};
    use crate::study::Extent;

    /// A measured setting that was applied is measured among the same settings again, another one around itself.
    #[test]
    fn a_setting_is_measured_again() {
        let scene = open(&Source { name: "article".into(), assignments: Vec::new() }).unwrap();
        let measured = Study::new(&scene, Extent::Quick, &|_| ControlFlow::Continue(())).unwrap();
        let all: Vec<&Measurement> = measured.measurements.iter().filter(|m| m.error.is_some()).collect();
        let applied = all.iter().find(|m| m.applied() != Setting::of(&scene)).unwrap().applied().apply(&scene);
        let mut other = scene.clone();
        other.beam.as_mut().unwrap().cells = [17, 3];
        for (again, base) in [(&other, &other), (&applied, &scene)] {
            let mut budget = Budget::default();
            budget.set(&scene, measured.clone());
            budget.measure(again);
            assert_eq!(budget.measured.as_ref(), Some(base));
        }
        // Where no setting meets a demand, the nearest ones each meet one of its halves.
        let least = |of: &dyn Fn(&Measurement) -> f64| all.iter().copied().map(of).fold(f64::INFINITY, f64::min);
        let [time, error] = [least(&frame_ms), least(&|m| measured.error_bound(m))].map(|v| 1.01 * v);
        let demand = Demand { max_error_percent: Some(error), max_time_ms: Some(time) };
        assert!(meeting(&measured, demand).is_empty());
        let nearest = nearest(&measured, demand);
        assert_eq!(nearest.len(), 2);
        assert!(frame_ms(nearest[0]) <= time && measured.error_bound(nearest[1]) <= error);
    }
}
