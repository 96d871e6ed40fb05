//! Comparison of two to four settings side by side, at rest or in motion: one load, one clock, one camera, one colour
//! range.

use self::setting::PANES;
use super::*;
use crate::app::session::clock::{RealTimeClock, make_steps};
use crate::app::session::run::Run;
use crate::app::task::solve::{Equations, Model};
use crate::app::task::thread::QUIET_POLL;
use crate::app::viewport::bars;
use crate::app::viewport::camera_controller::{ARROW_ROOM, Box2, CameraController, grow, grow_to_linear};
use crate::app::viewport::pointer::Interaction;
use crate::state::largest;

mod header;
mod pane;
mod setting;

pub use pane::Pane;
pub use setting::{PaneSetting, PaneSettingError, parse_panes};

/// Time for the iterations of all panes between two frames.
const WORK: Duration = Duration::from_millis(12);

pub(crate) struct CompareInput<'a> {
    /// Session of the panel.
    pub session: &'a Session,
    pub scene: &'a Scene,
    pub view: &'a ViewOptions,
    /// Direction of the arrow of a zero force, degrees.
    pub direction: f64,
    /// `true` if camera movements are animated.
    pub eases: bool,
    /// Reference solution of the load, or the one that follows it.
    pub reference: Option<&'a Reference>,
    /// Reference solution that follows the load, if errors are measured against it.
    pub live: Option<&'a facts::Live>,
    /// Fastest measured setting within the limits.
    pub chosen: Option<Setting>,
}

/// Named settings of all panes, with a tooltip, and the reason for which they are disabled.
type Preset = (String, Vec<PaneSetting>, &'static str, Option<&'static str>);

/// Change of a pane by its header: its new setting; `None` closes the pane.
type PaneChange = Option<Option<PaneSetting>>;

/// Panes with equilibria or with motions of one scene.
#[derive(Default)]
pub(crate) struct Compare {
    pub in_motion: bool,
    pub panes: Vec<Pane>,
    /// Camera of all panes; `None` before the first frame.
    controller: Option<CameraController>,
    /// Factor of the drawn displacement in all panes.
    magnification: f64,
    /// Largest displacement, m: of the results, or of the motions so far, because an automatic magnification that followed
    /// a motion would hide it.
    largest_displacement: f64,
    pub clock: RealTimeClock,
    /// Bounding box of all states of the motions so far, m.
    swept: Option<Box2>,
    /// Number of panes whose motions have not stopped early.
    sound: usize,
    /// Playing time, s: longer than the simulated time in slow motion.
    played: f64,
    /// `true` while the computing time of a pane is measured: the motions wait, because they would slow it down.
    pub is_timing: bool,
}

/// Returns settings with all methods or integrators; the first three are a preset.
fn settings(in_motion: bool) -> Vec<PaneSetting> {
    if !in_motion {
        let of_method = |kind| PaneSetting { method: Some(kind), ..PaneSetting::default() };
        return METHODS.iter().map(|entry| of_method(entry.kind)).collect();
    }
    // An explicit integrator may explode at the time step of the others.
    let mut integrators: Vec<_> = INTEGRATORS.iter().collect();
    integrators.sort_by_key(|entry| entry.is_explicit());
    let of_integrator = |kind| PaneSetting { integrator: Some(kind), ..PaneSetting::default() };
    integrators.into_iter().map(|entry| of_integrator(entry.kind)).collect()
}

impl Compare {
    pub(crate) fn new(in_motion: bool) -> Self {
        Self {
            in_motion,
            panes: settings(in_motion).into_iter().take(3).map(Pane::new).collect(),
            magnification: 1.0,
            ..Self::default()
        }
    }

    fn runs(&mut self) -> impl Iterator<Item = &mut Run> {
        self.panes.iter_mut().map(|pane| &mut pane.run)
    }

    /// Compares these settings, at most four.
    pub(crate) fn set(&mut self, settings: &[PaneSetting]) {
        self.panes = settings.iter().take(*PANES.end()).map(|&setting| Pane::new(setting)).collect();
        self.fit();
    }

    pub(crate) fn camera(&self) -> Camera {
        self.controller.as_ref().map_or(Camera { center: Vector2::zeros(), scale: 1.0 }, |controller| controller.shown)
    }

    /// Returns `true` if the user has moved the camera.
    pub(crate) fn is_moved(&self) -> bool {
        self.controller.as_ref().is_some_and(|controller| controller.own.is_some())
    }

    /// Fits the camera to all bodies.
    pub(crate) fn fit(&mut self) {
        self.swept = None;
        self.controller.iter_mut().for_each(|controller| controller.own = None);
    }

    /// Returns the bodies of the panes for the render pass.
    pub(crate) fn views(&self, wireframe: bool, pixels_per_point: f32) -> Vec<View<'_>> {
        let shown = self.panes.iter().map(|pane| &pane.view).filter(|view| view.rect.is_positive());
        shown.map(|view| view.view(self.camera(), wireframe, pixels_per_point)).collect()
    }

    /// Restarts all panes from rest, or from the start of the motion.
    pub(crate) fn reset(&mut self) {
        self.runs().for_each(Run::reset);
        (self.swept, self.largest_displacement) = (None, 0.0);
        self.clock.rest();
    }

    /// Makes one iteration in all panes that have not ended, or one time step; if all have ended, restarts them from rest.
    pub(crate) fn step(&mut self) {
        if !self.in_motion && !self.goes_on() {
            self.reset();
        }
        let time_step = self.panes.iter().find_map(|pane| Some(pane.run.wanted.as_ref()?.dynamics.time_step));
        self.played += time_step.unwrap_or_default() / self.clock.speed;
        self.runs().for_each(Run::step);
    }

    /// Returns `true` if a pane is still iterating, or moves.
    pub(crate) fn goes_on(&self) -> bool {
        let goes_on = |pane: &Pane| {
            if self.in_motion { pane.run.moves() || pane.run.is_away() } else { !pane.run.is_settled() }
        };
        self.panes.iter().any(goes_on)
    }

    /// Returns the existing equations that the panes can share: those of the body in Explore, and their own.
    fn equations(&self, session: &Session) -> Vec<Equations> {
        let models = self.panes.iter().filter_map(|pane| pane.run.model());
        std::iter::once(&session.model).chain(models).map(Model::equations).collect()
    }

    /// Solves all panes, and waits for them; `times` them, too.
    pub(crate) fn solve_to_end(&mut self, session: &Session, times: bool) {
        let mut equations = self.equations(session);
        for pane in &mut self.panes {
            pane.run.solve_to_end(pane.setting.apply(session.scene()), &equations);
            equations.extend(pane.run.model().map(Model::equations));
            if times {
                pane.obtain_time(true);
            }
        }
    }

    /// Applies the scene, and makes the time steps of the motions that are due at `now`, s. All panes are at the same time:
    /// a slow one slows all of them down, and they wait for those that are being set up or timed.
    pub(crate) fn advance_motions(&mut self, session: &Session, now: f64) {
        let (scene, mut starts_over) = (session.scene(), false);
        let mut equations = self.equations(session);
        for pane in &mut self.panes {
            starts_over |= pane.run.turn_to(pane.setting.apply(scene), &equations);
            equations.extend(pane.run.model().map(Model::equations));
        }
        if starts_over {
            self.reset();
        }
        let is_setting_up = self.panes.iter().any(|pane| pane.run.is_away());
        if !session.is_running() || is_setting_up || self.is_timing || !self.goes_on() {
            return self.clock.rest();
        }
        let step = scene.dynamics.time_step;
        let due = self.clock.begin(now, step);
        let made = make_steps(due, || {
            self.step();
            self.goes_on()
        });
        self.clock.end(due, made, step);
    }

    /// Applies the scene at rest, and iterates.
    fn advance(&mut self, ctx: &Context, input: &CompareInput<'_>) {
        let holds = ctx.input(|i| i.pointer.any_down());
        let (equations, runs) = (self.equations(input.session), input.session.is_running());
        let share = WORK / u32::try_from(self.panes.len().max(1)).unwrap_or(1);
        for pane in &mut self.panes {
            let until = runs.then(|| Instant::now() + share);
            pane.run.advance(pane.setting.apply(input.scene), &equations, until, holds);
            pane.is_dragged = holds && runs;
            pane.update_error(input);
        }
        let mut of_panes = self.panes.iter().map(|pane| &pane.run);
        if runs && of_panes.clone().any(|run| !run.is_settled() && !run.is_away() && !run.waits()) {
            ctx.request_repaint();
        } else if of_panes.any(Run::is_away) {
            ctx.request_repaint_after(POLL);
        } else if !holds {
            self.request_times(ctx);
        }
    }

    /// Requests the computing times, one pane after the other; returns `true` while one is pending.
    fn request_times(&mut self, ctx: &Context) -> bool {
        let is_pending = self.panes.iter_mut().any(|pane| pane.obtain_time(false));
        if is_pending {
            ctx.request_repaint_after(QUIET_POLL);
        }
        is_pending
    }

    /// Shows the presets above the panes.
    pub(crate) fn bars(&mut self, ui: &mut Ui, input: &CompareInput<'_>) {
        if !input.view.layout.bars {
            return;
        }
        let frame = egui::Frame::NONE.inner_margin(egui::Margin::symmetric(12, 4));
        Panel::top("presets").resizable(false).frame(frame).show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing.x = 6.0;
                let present: Vec<PaneSetting> = self.panes.iter().map(|pane| pane.setting).collect();
                for (name, settings, tip, disabled) in self.presets(input) {
                    let is_chosen = disabled.is_none() && present == settings;
                    let button = ui.add_enabled(disabled.is_none(), option_button(is_chosen, name));
                    let reason = tr(disabled.unwrap_or_default());
                    if button.on_hover_text(tr(tip)).on_disabled_hover_text(reason).clicked() {
                        self.set(&settings);
                    }
                }
                let button = ui.add_enabled(present.len() < *PANES.end(), Button::new(tr("+ Pane")));
                let button = button.on_hover_text(tr("Add a pane")).on_disabled_hover_text(tr("At most four panes"));
                if button.clicked() {
                    let kind = |setting: &PaneSetting| (setting.method, setting.integrator);
                    let is_unused = |setting: &PaneSetting| present.iter().all(|own| kind(own) != kind(setting));
                    let unused = settings(self.in_motion).into_iter().find(is_unused);
                    self.panes.push(Pane::new(unused.unwrap_or_default()));
                    self.fit();
                }
                if self.in_motion {
                    let time = self.panes.iter().find_map(|pane| Some(pane.simulation()?.state().time()));
                    ui.label(fill!("t = %{time}", time = format!("{:.2} s", time.unwrap_or(0.0))));
                }
            });
        });
    }

    fn presets(&self, input: &CompareInput<'_>) -> Vec<Preset> {
        let elements: Vec<ElementKind> = input.scene.elements().collect();
        let join = |names: Vec<&str>| names.join(" | ");
        let method = (!self.in_motion && input.scene.solver.method == MethodKind::Warped).then_some(MethodKind::Newton);
        let of_element = |&kind: &ElementKind| PaneSetting { method, element: Some(kind), ..PaneSetting::default() };
        let first: Vec<PaneSetting> = settings(self.in_motion).into_iter().take(3).collect();
        let (name, tip, tip_of_elements) = match self.in_motion {
            true => (
                tr("integrators").to_owned(),
                "Three integrators on the panel's mesh",
                "All elements that the mesh can have, with the panel's integrator",
            ),
            false => (
                join(first.iter().filter_map(|setting| Some(tr(setting.method?.id()))).collect()),
                "Three methods on the panel's mesh",
                "All elements that the mesh can have, with the panel's method; newton in place of warped, which may diverge",
            ),
        };
        let mut presets = vec![
            (name, first, tip, None),
            (
                join(elements.iter().map(|element| element.id()).collect()),
                elements.iter().map(of_element).collect(),
                tip_of_elements,
                (elements.len() < 2).then_some("The mesh of this file can have one element only"),
            ),
        ];
        if !self.in_motion {
            presets.push((
                tr("current | fastest").to_owned(),
                vec![PaneSetting::default(), input.chosen.map(PaneSetting::from).unwrap_or_default()],
                "The current setting next to the fastest that meets both limits of How fast, in Measure",
                (input.chosen.is_none())
                    .then_some("Measure how fast the settings are first: the fastest is compared with the current one"),
            ));
        }
        presets
    }

    /// Shows the panes; returns the pointer's interaction with their load.
    pub(crate) fn show(&mut self, ui: &mut Ui, input: &CompareInput<'_>) -> Interaction {
        if !self.in_motion {
            self.advance(ui.ctx(), input);
        }
        self.magnify(input);
        for pane in &mut self.panes {
            if !self.in_motion {
                let is_own = pane.setting.apply(input.scene) == *input.scene;
                pane.keep_equilibrium(input.session.fallback().filter(|_| is_own));
            }
            let played = self.in_motion.then_some(self.played);
            pane.update_display(input, self.magnification, played);
            pane.view.body.palette = Palette::new(ui.visuals());
        }
        // Motions that have exploded do not count.
        let counted = self.panes.iter().filter(|pane| !self.in_motion || pane.run.is_sound());
        let ranges = counted.filter_map(|pane| pane.range);
        let common = ranges.reduce(|[low, high], own| [low.min(own[0]), high.max(own[1])]);
        let range = input.view.fixed_range.or(common).unwrap_or_default();
        let whole = ui.available_rect_before_wrap();
        let probes = if self.in_motion { 0 } else { header::shown_probes(input.scene, input.view) };
        let (places, key) = header::divide(whole, self.panes.len(), probes);
        for (pane, [_, body]) in self.panes.iter_mut().zip(&places) {
            (pane.view.body.range, pane.view.rect) = (range, *body);
        }
        let reference = input.reference.filter(|_| input.view.lines.exact);
        let exact = reference.map_or_else(Vec::new, |reference| reference.outline(self.magnification));
        self.fit_camera(ui, input, &exact);
        if self.in_motion {
            self.is_timing = !ui.input(|i| i.pointer.any_down()) && self.request_times(ui.ctx());
        }
        let interaction = self.show_panes(ui, &places, input, &exact);
        if !self.in_motion {
            self.show_values(ui);
        }
        header::key(ui, key, input.view, (range, self.magnification), self.in_motion);
        ui.advance_cursor_after_rect(whole);
        interaction
    }

    /// Shows the headers and the bodies, with the outline `exact` of the reference solution, m; returns the pointer's
    /// interaction with the load of a pane.
    fn show_panes(
        &mut self,
        ui: &mut Ui,
        places: &[[Rect; 2]],
        input: &CompareInput<'_>,
        exact: &[Vec<Vector2<f64>>],
    ) -> Interaction {
        let (mut changes, mut interaction) = (Vec::new(), Interaction::default());
        for (number, [header, _]) in places.iter().enumerate() {
            let inner = UiBuilder::new().max_rect(header.shrink2(vec2(8.0, 3.0))).id_salt(("pane", number));
            let shown = ui.scope_builder(inner, |ui| {
                ui.set_clip_rect(header.intersect(ui.clip_rect()));
                ui.spacing_mut().item_spacing = vec2(6.0, 2.0);
                header::show(ui, &self.panes, number, input)
            });
            changes.extend(shown.inner.map(|change| (number, change)));
            if let (Some(controller), Some(pane)) = (&mut self.controller, self.panes.get_mut(number)) {
                let own = pane.show_body(ui, number, controller, input, exact);
                if own.load.is_some() || own.restore.is_some() {
                    interaction = own;
                }
            }
        }
        for (number, change) in changes {
            ui.ctx().request_repaint();
            match change {
                Some(setting) => {
                    if let Some(pane) = self.panes.get_mut(number) {
                        pane.setting = setting;
                        pane.run.restart(setting.iterations);
                    }
                    // All motions are at the same time.
                    if self.in_motion {
                        self.reset();
                    }
                }
                None if self.panes.len() > *PANES.start() => {
                    self.panes.remove(number);
                    self.fit();
                }
                None => {}
            }
        }
        interaction
    }

    /// Sets the common factor of the drawn displacement; the largest displacement of the results counts.
    fn magnify(&mut self, input: &CompareInput<'_>) {
        let sound = self.panes.iter().filter(|pane| pane.run.is_sound());
        let results = sound.filter_map(|pane| pane.run.displayed());
        let now = results.map(|model| largest(model.simulation.displacement())).fold(0.0, f64::max);
        self.largest_displacement = if self.in_motion { self.largest_displacement.max(now) } else { now };
        let factor =
            input.view.magnification.factor(input.session.simulation().system().size(), self.largest_displacement);
        if self.magnification != factor {
            (self.magnification, self.swept) = (factor, None);
        }
    }

    /// Shows the values at the point of the body under the pointer, in every pane.
    fn show_values(&self, ui: &Ui) {
        let panes = self.panes.iter().enumerate();
        let under = panes.clone().find_map(|(number, pane)| Some((number, pane.under_pointer()?)));
        let Some(((number, (rest, at)), camera)) = under.zip(self.controller.as_ref()) else { return };
        for (i, pane) in panes {
            pane.show_value(ui, rest, camera, (i == number).then_some(at));
        }
    }

    /// Fits the camera to all bodies and the outline `exact` of the reference solution, m, unless the user has moved it.
    fn fit_camera(&mut self, ui: &Ui, input: &CompareInput<'_>, exact: &[Vec<Vector2<f64>>]) {
        let sizes = self.panes.iter().map(|pane| pane.view.rect.size());
        let Some(size) = sizes.reduce(Vec2::min).map(|size| [size.x, size.y].map(f64::from)) else { return };
        let rest: Box2 = input.session.simulation().mesh().bounds().into();
        let (whole, margins) = match self.in_motion {
            true => (self.sweep(rest), Margins { sides: 40.0, top: 40.0, bottom: 44.0 }),
            false => (self.bounds(rest, input, exact), self.margins(input, size)),
        };
        // While panes iterate, only a camera that has not been fitted yet moves.
        let is_settled = self.in_motion || !self.goes_on();
        // While a load is dragged, the view only grows: the arrow that the pointer holds stays in it.
        let drags = self.panes.iter().any(|pane| pane.view.pointer.drags_tip());
        let holds = !drags && self.panes.iter().any(|pane| pane.view.pointer.holds());
        let controller = self.controller.get_or_insert_with(|| CameraController::new(rest));
        if !holds && (is_settled || drags || controller.whole == rest) {
            let before = if drags { controller.whole } else { rest };
            controller.set_body(rest);
            controller.set_whole(before.iter().fold(whole, grow));
        }
        let [low, high] = controller.whole;
        controller.turn_to(ui, Camera::fit(low, high, size, margins), input.eases, drags);
    }

    /// Returns the bounding box of the results and of the outline `exact` of the reference solution, m.
    fn bounds(&self, rest: Box2, input: &CompareInput<'_>, exact: &[Vec<Vector2<f64>>]) -> Box2 {
        let is_linear = |pane: &Pane| pane.run.wanted.as_ref().is_some_and(|s| s.solver.method == MethodKind::Linear);
        let (linear, others): (Vec<&Pane>, Vec<&Pane>) =
            self.panes.iter().filter(|pane| pane.run.is_sound()).partition(|pane| is_linear(pane));
        let bounds = exact.iter().flatten().fold(rest, grow);
        let bounds = others.iter().flat_map(|pane| &pane.view.body.points).fold(bounds, grow);
        let linear = linear.iter().flat_map(|pane| &pane.view.body.points);
        let has_reference = input.reference.is_some() && input.view.lines.exact;
        let is_known = !others.is_empty() || has_reference;
        if is_known { grow_to_linear(bounds, linear.copied()) } else { linear.fold(bounds, grow) }
    }

    /// Extends the bounding box of all states of the motions so far, m, by the present ones, and returns it.
    fn sweep(&mut self, rest: Box2) -> Box2 {
        /// Distance up to which the camera follows points, in sizes of the body.
        const LARGEST_REACH: f64 = 3.0;
        // The states of a motion that is about to explode would hide the others.
        let reach = LARGEST_REACH * (rest[1] - rest[0]).norm();
        let is_near = |p: &&Vector2<f64>| (*p - rest[0]).norm() < reach;
        let sound = || self.panes.iter().filter(|pane| pane.run.is_sound());
        let count = sound().count();
        // A body that has left is not looked for.
        let before = self.swept.filter(|_| count >= self.sound).unwrap_or(rest);
        let swept = sound().flat_map(|pane| &pane.view.body.points).filter(is_near).fold(before, grow);
        (self.sound, self.swept) = (count, Some(swept));
        swept
    }

    /// Returns the margins around the bodies when the camera is fitted, points: room for supports, load arrows and
    /// their labels.
    fn margins(&self, input: &CompareInput<'_>, [width, height]: [f64; 2]) -> Margins {
        let place = Rect::from_min_size(egui::Pos2::ZERO, vec2(width as f32, height as f32));
        let projection = Projection { camera: self.camera(), rect: place };
        let body = self.panes.first().and_then(|pane| pane.drawn_body(projection, input));
        let arrows = body.map(|body| body.arrows());
        let longest = |along: fn(egui::Vec2) -> f32| {
            let lengths = arrows.iter().flatten().map(|arrow| f64::from(along(arrow.vector())));
            lengths.fold(0.0, f64::max).min(ARROW_ROOM * height)
        };
        let (top, bottom) = ((0.08 * height).min(30.0), (0.16 * height).min(44.0));
        Margins { sides: 40.0, top: top + longest(|vector| -vector.y), bottom: bottom + longest(|vector| vector.y) }
    }
}
