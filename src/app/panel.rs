//! The panel: parameters in, actions out. It never touches the simulation.

use egui::{Button, ComboBox, Grid, RichText, ScrollArea, Ui};
use nalgebra::Vector2;

use super::field::{Messages, NumberField, show_message};
use super::format;
use crate::method::{METHODS, rho_words};
use crate::scene::{ElementKind, Load, Place, Plane, Scene, limits, registry};
use crate::simulation::{Field, Simulation, Status};

/// What the panel shows.
pub(super) struct Shown<'a> {
    pub scene: &'a Scene,
    pub scene_name: &'a str,
    pub simulation: &'a Simulation,
    pub running: bool,
    /// True displacement of the right edge, m, where one is known.
    pub truth: Option<Vector2<f64>>,
    pub adapter: &'a str,
}

/// What a click or a drag asks for.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Action {
    /// Open a built-in scene.
    Open(&'static str),
    /// Change the scene; a refusal is shown next to the field of this label.
    Edit(&'static str, Box<Scene>),
    /// Iterate, or stop.
    Run(bool),
    /// One iteration.
    Step,
    /// Back to rest.
    Reset,
    /// Show everything.
    Fit,
    /// Light or dark.
    ToggleTheme,
    /// Save a picture.
    Screenshot,
    /// Copy the scene.
    Copy,
}

/// How to look at the body.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ViewOptions {
    pub field: Field,
    /// Fixed ends of the colour map, or `None` for those of the current values.
    pub fixed_range: Option<[f64; 2]>,
    pub wireframe: bool,
    pub rest_outline: bool,
    pub ghost: bool,
    pub curve: bool,
    pub panel: bool,
    pub help: bool,
}

impl Default for ViewOptions {
    fn default() -> Self {
        Self {
            field: Field::default(),
            fixed_range: None,
            wireframe: true,
            rest_outline: true,
            ghost: true,
            curve: false,
            panel: true,
            help: false,
        }
    }
}

/// What the panel remembers from frame to frame.
#[derive(Debug, Default)]
pub(super) struct PanelState {
    pub messages: Messages,
    /// Directions in degrees, kept while a magnitude is zero.
    force_direction: Option<f64>,
    gravity_direction: Option<f64>,
}

impl PanelState {
    /// Forgets what belonged to another scene.
    pub(super) fn clear(&mut self) {
        *self = Self::default();
    }
}

const DOWN: f64 = -90.0;

/// Shows the panel's contents.
pub(super) fn show(ui: &mut Ui, shown: &Shown<'_>, state: &mut PanelState, view: &mut ViewOptions) -> Vec<Action> {
    let mut actions = Vec::new();
    // Always visible: in a low window one must see that there is more.
    ui.spacing_mut().scroll = egui::style::ScrollStyle::solid();
    ScrollArea::vertical()
        .auto_shrink([false, false])
        .scroll_bar_visibility(egui::scroll_area::ScrollBarVisibility::AlwaysVisible)
        .show(ui, |ui| {
            ui.add_space(4.0);
            scene_picker(ui, shown, &mut actions);
            controls(ui, shown, &mut actions);
            section(ui, "Load");
            load(ui, shown, state, &mut actions);
            moment(ui, shown, state, &mut actions);
            result(ui, shown);
            section(ui, "Material");
            material(ui, shown.scene, state, &mut actions);
            section(ui, "Mesh and method");
            mesh_and_method(ui, shown.scene, state, &mut actions);
            section(ui, "View");
            view_options(ui, shown, state, view, &mut actions);
            ui.separator();
            ui.add(egui::Label::new(RichText::new(shown.adapter).small().weak()).wrap());
        });
    actions
}

fn section(ui: &mut Ui, title: &str) {
    ui.separator();
    ui.strong(title);
}

fn scene_picker(ui: &mut Ui, shown: &Shown<'_>, actions: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        let label = ui.label("Scene");
        ComboBox::from_id_salt("scene")
            .selected_text(&shown.scene.name)
            .width(ui.available_width())
            .height(480.0)
            .show_ui(ui, |ui| {
                for built_in in registry::BUILT_IN {
                    let selected = built_in.id == shown.scene_name;
                    if ui.selectable_label(selected, built_in.id).clicked() {
                        actions.push(Action::Open(built_in.id));
                    }
                }
            })
            .response
            .labelled_by(label.id)
            .on_hover_text("The built-in scenes; a file opens with `warpbeam run FILE`.");
    });
    ui.add(egui::Label::new(RichText::new(&shown.scene.about).small().weak()).wrap());
}

fn controls(ui: &mut Ui, shown: &Shown<'_>, actions: &mut Vec<Action>) {
    ui.add_space(2.0);
    ui.horizontal(|ui| {
        let (word, tip) = if shown.running { ("Pause", "Stop iterating") } else { ("Run", "Iterate, once a frame") };
        if ui.button(word).on_hover_text(format!("{tip} (Space)")).clicked() {
            actions.push(Action::Run(!shown.running));
        }
        let can_step = *shown.simulation.status() == Status::Running;
        let step = ui.add_enabled(can_step, Button::new("Step"));
        if step.on_hover_text("Pause, and make one iteration (N)").clicked() {
            actions.push(Action::Step);
        }
        if ui.button("Reset").on_hover_text("Back to rest, and iterate again (R)").clicked() {
            actions.push(Action::Reset);
        }
        if ui.button("Fit").on_hover_text("Show the whole body (F)").clicked() {
            actions.push(Action::Fit);
        }
        if ui.button("Theme").on_hover_text("Light or dark (T)").clicked() {
            actions.push(Action::ToggleTheme);
        }
    });
}

/// The status as a sentence, and whether it is a bad one.
pub(super) fn status_words(shown_status: &Status, running: bool) -> (String, bool) {
    match shown_status {
        Status::Running if running => ("Iterating".to_owned(), false),
        Status::Running => ("Paused".to_owned(), false),
        Status::Converged => ("Converged".to_owned(), false),
        Status::NotConverged(reason) => (format!("Not converged: {reason}."), true),
        Status::Diverged(reason) => (format!("Diverged: {reason}. Shown is the last finite state."), true),
    }
}

/// Room for three lines of status, points.
const STATUS_HEIGHT: f32 = 50.0;
/// In place of a number that is not known.
const UNKNOWN: &str = "\u{2013}";

/// The error of the probe on the right edge against the truth.
fn tip_error(shown: &Shown<'_>) -> Option<String> {
    let truth = shown.truth.filter(|t| t.norm() > 0.0)?;
    let simulation = shown.simulation;
    let probe = simulation.system().probes.iter().find(|p| p.edge.as_deref() == Some("right"))?;
    let percent = 100.0 * (probe.mean(simulation.displacement()) - truth).norm() / truth.norm();
    Some(format!("{} % of {} m", format::short(percent), format::short(truth.norm())))
}

/// With a capital and a full stop.
fn sentence(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| format!("{}{}.", first.to_uppercase(), letters.as_str()))
}

fn result(ui: &mut Ui, shown: &Shown<'_>) {
    let simulation = shown.simulation;
    section(ui, "Result");
    let (words, bad) = status_words(simulation.status(), shown.running);
    let color = if bad { ui.visuals().error_fg_color } else { ui.visuals().strong_text_color() };
    // Nothing here may change its height: a slider further down would move away under the pointer that drags it.
    ui.allocate_ui(egui::vec2(ui.available_width(), STATUS_HEIGHT), |ui| {
        ui.set_min_height(STATUS_HEIGHT);
        ui.add(egui::Label::new(RichText::new(words).color(color)).wrap());
    });
    let time = simulation.last_frame();
    let us = |d: std::time::Duration| format!("{:.0} µs", d.as_secs_f64() * 1e6);
    Grid::new("result").num_columns(2).spacing([12.0, 2.0]).show(ui, |ui| {
        let mut row = |name: &str, value: String, tip: &str| {
            ui.label(name).on_hover_text(tip);
            ui.monospace(value).on_hover_text(tip);
            ui.end_row();
        };
        row(
            "Iterations",
            format!("{}, residual {:.2e}", simulation.iterations(), simulation.residual()),
            "Solves since the last change; out-of-balance force over the sum of the elements' absolute forces",
        );
        for probe in simulation.system().probes.iter().take(1) {
            let u = probe.mean(simulation.displacement());
            // Beside a component of ordinary size, rounding is no number to show.
            let [x, y] = [u.x, u.y].map(|v| if v.abs() < 1e-12 * u.norm() { 0.0 } else { v });
            row(
                &format!("{} x, y", probe.name),
                format!("{}, {} m", format::short(x), format::short(y)),
                "Displacement of the probe",
            );
        }
        row(
            "Error",
            tip_error(shown).unwrap_or_else(|| UNKNOWN.to_owned()),
            "Distance from the exact beam's tip (it stretches and shears too), over its displacement; known for cantilevers",
        );
        let (factor, steps) = simulation.load_stepping();
        let percent = format::short(100.0 * factor);
        row("Load steps", format!("{steps}, at {percent} % of the load"), "Parts in which the load is put on");
        let certified = simulation.certificate().stable.filter(|_| *simulation.status() == Status::Converged);
        let word = certified.map_or(UNKNOWN, |stable| if stable { "stable" } else { "unstable" });
        row("Equilibrium", word.to_owned(), "Certified: whether the exact tangent A + G is positive definite");
        let unknowns = simulation.system().dofs();
        row("Frame", format!("{}, {unknowns} unknowns", us(time.total())), "Time of the last iteration");
    });
    if let Some(rho) = simulation.certificate().fixed_point_rho {
        let words = RichText::new(sentence(&rho_words(rho))).small();
        ui.add(egui::Label::new(words).wrap())
            .on_hover_text("ρ = |λ|max(A⁻¹G), the error factor of the warped iteration");
    }
    let stages = [
        ("rotate", time.rotate, "Element maps and polar decompositions"),
        ("assemble", time.assemble, "Stiffness R K Rᵀ, forces, residual"),
        ("factorize", time.factorize, "Sparse Cholesky"),
        ("solve", time.solve, "Forward and back substitution"),
    ];
    Grid::new("stages").num_columns(stages.len()).min_col_width(62.0).spacing([14.0, 0.0]).show(ui, |ui| {
        for (name, _, tip) in stages {
            ui.label(RichText::new(name).small()).on_hover_text(tip);
        }
        ui.end_row();
        for (_, duration, tip) in stages {
            ui.label(RichText::new(us(duration)).monospace().small()).on_hover_text(tip);
        }
    });
}

/// Magnitude and direction (degrees) of a vector; the direction is `None` at zero.
fn polar_form([x, y]: [f64; 2]) -> (f64, Option<f64>) {
    let magnitude = x.hypot(y);
    (magnitude, (magnitude > 0.0).then(|| y.atan2(x).to_degrees()))
}

/// The vector of a magnitude and a direction in degrees, exact along the axes.
fn vector(magnitude: f64, degrees: f64) -> [f64; 2] {
    let (s, c) = match degrees {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        -90.0 => (-1.0, 0.0),
        180.0 | -180.0 => (0.0, -1.0),
        _ => degrees.to_radians().sin_cos(),
    };
    [magnitude * c, magnitude * s]
}

fn load(ui: &mut Ui, shown: &Shown<'_>, state: &mut PanelState, actions: &mut Vec<Action>) {
    let scene = shown.scene;
    let force = scene.loads.iter().find_map(|l| match l {
        Load::Force { force, .. } => Some(*force),
        _ => None,
    });
    let gravity = scene.loads.iter().find_map(|l| match l {
        Load::Gravity { acceleration } => Some(*acceleration),
        _ => None,
    });
    let (magnitude, direction) = polar_form(force.unwrap_or_default());
    let direction = direction.or(state.force_direction).unwrap_or(DOWN);
    let material = &scene.material;
    // A force that strains the whole section by 1, rounded up: as far as anything can be seen.
    let (low, high) = shown.simulation.system().mesh.bounds();
    let height = (high - low).min();
    let largest = (material.young * material.thickness * height).clamp(1e-6, 1e14);
    let largest = 10f64.powf(largest.log10().ceil());
    let field = NumberField {
        label: "Force",
        tooltip: "Magnitude of the force, N. Type a number for values the slider has not, such as 12 kN.",
        limit: limits::FORCE,
        slider: 0.0..=largest,
        logarithmic: Some(1e-5 * largest),
        whole: false,
    };
    if let Some(new) = field.show(ui, &mut state.messages, magnitude) {
        state.force_direction = Some(direction);
        actions.push(Action::Edit("Force", with_force(scene, vector(new, direction))));
    }
    let field = NumberField {
        label: "Direction",
        tooltip: "Direction of the force: 0° right, 90° up, −90° down.",
        limit: limits::DIRECTION,
        slider: -180.0..=180.0,
        logarithmic: None,
        whole: false,
    };
    if let Some(new) = field.show(ui, &mut state.messages, shown_degrees(direction)) {
        state.force_direction = Some(new);
        actions.push(Action::Edit("Direction", with_force(scene, vector(magnitude, new))));
    }
    let (magnitude, direction) = polar_form(gravity.unwrap_or_default());
    let direction = direction.or(state.gravity_direction).unwrap_or(DOWN);
    let field = NumberField {
        label: "Gravity",
        tooltip: "Acceleration that gives the body its weight, m/s²; 9.81 on earth, 0 for none.",
        limit: limits::ACCELERATION,
        slider: 0.0..=1000.0,
        logarithmic: Some(0.01),
        whole: false,
    };
    if let Some(new) = field.show(ui, &mut state.messages, magnitude) {
        state.gravity_direction = Some(direction);
        actions.push(Action::Edit("Gravity", with_gravity(scene, vector(new, direction))));
    }
}

/// The moment on the right edge, or on whichever edge has one.
fn moment(ui: &mut Ui, shown: &Shown<'_>, state: &mut PanelState, actions: &mut Vec<Action>) {
    let current = shown.scene.loads.iter().find_map(|l| match l {
        Load::Moment { moment, .. } => Some(*moment),
        _ => None,
    });
    // What rolls the rest shape up once, rounded up: 2πEI/L.
    let (low, high) = shown.simulation.system().mesh.bounds();
    let (length, height) = ((high - low).max(), (high - low).min());
    let material = &shown.scene.material;
    let circle = std::f64::consts::TAU * material.young * material.thickness * height.powi(3) / (12.0 * length);
    let largest = 10f64.powf(circle.clamp(1e-6, 1e14).log10().ceil());
    let field = NumberField {
        label: "Moment",
        tooltip: "Moment on the right edge, N m, counter-clockwise; it turns with the edge. 2πEI/L rolls a beam up once.",
        limit: limits::MOMENT,
        slider: -largest..=largest,
        logarithmic: Some(1e-4 * largest),
        whole: false,
    };
    if let Some(new) = field.show(ui, &mut state.messages, current.unwrap_or(0.0)) {
        let mut scene = Box::new(shown.scene.clone());
        let first = scene.loads.iter_mut().find_map(|l| match l {
            Load::Moment { moment, .. } => Some(moment),
            _ => None,
        });
        match first {
            Some(moment) => *moment = new,
            None => scene.loads.push(Load::Moment { edge: "right".to_owned(), moment: new }),
        }
        actions.push(Action::Edit("Moment", scene));
    }
}

/// A direction without the digits that going through a vector adds.
fn shown_degrees(degrees: f64) -> f64 {
    (degrees * 1e9).round() / 1e9
}

/// The scene with its first force replaced, or with one on the right edge.
fn with_force(scene: &Scene, new: [f64; 2]) -> Box<Scene> {
    let mut scene = Box::new(scene.clone());
    let first = scene.loads.iter_mut().find_map(|l| match l {
        Load::Force { force, .. } => Some(force),
        _ => None,
    });
    match first {
        Some(force) => *force = new,
        None => scene.loads.push(Load::Force { place: Place::edge("right"), force: new }),
    }
    scene
}

fn with_gravity(scene: &Scene, new: [f64; 2]) -> Box<Scene> {
    let mut scene = Box::new(scene.clone());
    let first = scene.loads.iter_mut().find_map(|l| match l {
        Load::Gravity { acceleration } => Some(acceleration),
        _ => None,
    });
    match first {
        Some(acceleration) => *acceleration = new,
        None => scene.loads.push(Load::Gravity { acceleration: new }),
    }
    scene
}

fn material(ui: &mut Ui, scene: &Scene, state: &mut PanelState, actions: &mut Vec<Action>) {
    let mut row = |field: NumberField, value: f64, set: fn(&mut Scene, f64)| {
        if let Some(new) = field.show(ui, &mut state.messages, value) {
            let mut scene = Box::new(scene.clone());
            set(&mut scene, new);
            actions.push(Action::Edit(field.label, scene));
        }
    };
    let m = &scene.material;
    row(
        NumberField {
            label: "Young E",
            tooltip: "Young's modulus, Pa: the stiffness. Rubber 1e6, wood 1e10, steel 2e11.",
            limit: limits::YOUNG,
            slider: 1e3..=1e12,
            logarithmic: Some(1e3),
            whole: false,
        },
        m.young,
        |s, v| s.material.young = v,
    );
    row(
        NumberField {
            label: "Poisson ν",
            tooltip: "Poisson ratio: how much it thins when pulled. 0.5 keeps the volume; plane strain stops before it.",
            limit: m.plane.poisson_limit(),
            slider: -0.5..=0.499,
            logarithmic: None,
            whole: false,
        },
        m.poisson,
        |s, v| s.material.poisson = v,
    );
    row(
        NumberField {
            label: "Density ρ",
            tooltip: "Density, kg/m³: only gravity reads it.",
            limit: limits::DENSITY,
            slider: 0.0..=20_000.0,
            logarithmic: Some(1.0),
            whole: false,
        },
        m.density,
        |s, v| s.material.density = v,
    );
    row(
        NumberField {
            label: "Thickness t",
            tooltip: "Thickness out of the plane, m: stiffness and weight grow with it.",
            limit: limits::THICKNESS,
            slider: 1e-3..=10.0,
            logarithmic: Some(1e-3),
            whole: false,
        },
        m.thickness,
        |s, v| s.material.thickness = v,
    );
    ui.horizontal(|ui| {
        ui.label("Plane");
        for (plane, word, tip) in [
            (Plane::Stress, "stress", "No stress out of the plane: a thin plate."),
            (Plane::Strain, "strain", "No strain out of the plane: a slice of something long."),
        ] {
            if ui.radio(m.plane == plane, word).on_hover_text(tip).clicked() && m.plane != plane {
                let mut scene = Box::new(scene.clone());
                scene.material.plane = plane;
                actions.push(Action::Edit("Plane", scene));
            }
        }
    });
    show_message(ui, &state.messages, "Plane");
}

fn mesh_and_method(ui: &mut Ui, scene: &Scene, state: &mut PanelState, actions: &mut Vec<Action>) {
    for (axis, label, tooltip, most) in [
        (0, "Cells along", "Cells along the beam; each is two triangles.", 400.0),
        (1, "Cells across", "Cells across the beam; each is two triangles.", 40.0),
    ] {
        let field = NumberField {
            label,
            tooltip,
            limit: limits::CELLS,
            slider: 1.0..=most,
            logarithmic: Some(1.0),
            whole: true,
        };
        let Some(beam) = &scene.beam else { continue };
        if let Some(new) = field.show(ui, &mut state.messages, f64::from(beam.cells[axis])) {
            let mut scene = Box::new(scene.clone());
            if let Some(beam) = &mut scene.beam {
                beam.cells[axis] = new as u32;
            }
            actions.push(Action::Edit(label, scene));
        }
    }
    ui.horizontal(|ui| {
        let label = ui.label("Method");
        ComboBox::from_id_salt("method")
            .selected_text(scene.solver.method.id())
            .show_ui(ui, |ui| {
                for entry in METHODS {
                    let selected = entry.kind == scene.solver.method;
                    if ui.selectable_label(selected, entry.kind.id()).on_hover_text(entry.about).clicked() && !selected
                    {
                        let mut scene = Box::new(scene.clone());
                        scene.solver.method = entry.kind;
                        actions.push(Action::Edit("Method", scene));
                    }
                }
            })
            .response
            .labelled_by(label.id)
            .on_hover_text(scene.solver.method.entry().about);
    });
    show_message(ui, &state.messages, "Method");
    ui.horizontal(|ui| {
        ui.label("Element");
        for (element, tip) in [
            (ElementKind::T3, "Three nodes, constant strain: cheap, and too stiff in bending."),
            (ElementKind::T6, "Six nodes, linear strain: bends as it should."),
        ] {
            let selected = scene.element() == element;
            if ui.radio(selected, element.id()).on_hover_text(tip).clicked() && !selected {
                let mut scene = Box::new(scene.clone());
                scene.set_element(element);
                actions.push(Action::Edit("Element", scene));
            }
        }
    });
    show_message(ui, &state.messages, "Element");
}

fn view_options(
    ui: &mut Ui,
    shown: &Shown<'_>,
    state: &mut PanelState,
    view: &mut ViewOptions,
    actions: &mut Vec<Action>,
) {
    ui.horizontal(|ui| {
        let label = ui.label("Colour");
        ComboBox::from_id_salt("field")
            .selected_text(view.field.name())
            .show_ui(ui, |ui| {
                for field in Field::ALL {
                    if ui.selectable_label(field == view.field, field.name()).clicked() && field != view.field {
                        view.field = field;
                        view.fixed_range = None;
                    }
                }
            })
            .response
            .labelled_by(label.id)
            .on_hover_text("The quantity the body is coloured with");
    });
    let mut fixed = view.fixed_range.is_some();
    if ui
        .checkbox(&mut fixed, "Fixed colour range")
        .on_hover_text("Keep the ends of the colour map; else they follow the values")
        .changed()
    {
        view.fixed_range = fixed.then(|| value_range(shown.simulation, view.field));
    }
    if let Some(range) = view.fixed_range {
        let span = limits::Limit { name: "colour range", unit: view.field.unit(), min: -1e30, max: 1e30 };
        let reach = range[0].abs().max(range[1].abs()).max(f64::MIN_POSITIVE);
        for (end, label) in ["Lowest", "Highest"].into_iter().enumerate() {
            let field = NumberField {
                label,
                tooltip: "An end of the colour map",
                limit: span,
                slider: 0.0..=2.0 * reach,
                logarithmic: None,
                whole: false,
            };
            if let Some(new) = field.show(ui, &mut state.messages, range[end]) {
                let mut changed = range;
                changed[end] = new;
                if changed[0] < changed[1] {
                    view.fixed_range = Some(changed);
                } else {
                    state.messages.insert(label, "expected the lowest value below the highest".to_owned());
                }
            }
        }
    }
    ui.horizontal_wrapped(|ui| {
        ui.checkbox(&mut view.wireframe, "Wireframe").on_hover_text("Element edges (W)");
        ui.checkbox(&mut view.rest_outline, "Rest").on_hover_text("Outline of the body at rest (O)");
        ui.checkbox(&mut view.ghost, "Linear").on_hover_text("Outline of the linear solution (G)");
    });
    ui.horizontal(|ui| {
        if ui.button("Screenshot").on_hover_text("Save this picture as a PNG file here (S)").clicked() {
            actions.push(Action::Screenshot);
        }
        if ui
            .button("Copy scene")
            .on_hover_text("Copy the scene as TOML, with the command that solves it (C)")
            .clicked()
        {
            actions.push(Action::Copy);
        }
        if ui.selectable_label(view.curve, "Curve").on_hover_text("Load against deflection (L)").clicked() {
            view.curve ^= true;
        }
        if ui.button("Help").on_hover_text("Keys and mouse (F1)").clicked() {
            view.help = true;
        }
    });
}

/// The smallest and the largest value of a field; never empty.
pub(super) fn value_range(simulation: &Simulation, field: Field) -> [f64; 2] {
    let mut values = Vec::new();
    simulation.field(field, &mut values);
    range_of(&values)
}

/// The smallest and the largest of some values; never empty. Values that differ by rounding only are given a range in
/// which they look the same.
pub(super) fn range_of(values: &[f64]) -> [f64; 2] {
    const SAME: f64 = 1e-6;
    const WIDENED: f64 = 1e-2;
    let [low, high] =
        values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &v| [low.min(v), high.max(v)]);
    let size = low.abs().max(high.abs());
    if !size.is_finite() || size == 0.0 {
        [0.0, 1.0]
    } else if 0.5 * high - 0.5 * low > 0.5 * SAME * size {
        [low, high]
    } else {
        [low - WIDENED * size, high + WIDENED * size].map(|v| v.clamp(-f64::MAX, f64::MAX))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_go_to_polar_form_and_back() {
        for v in [[3.0, -4.0], [0.0, -40_000.0], [-2.0, 0.0], [1e-3, 1e3]] {
            let (magnitude, direction) = polar_form(v);
            let back = vector(magnitude, direction.unwrap());
            assert!((back[0] - v[0]).hypot(back[1] - v[1]) < 1e-12 * magnitude, "{v:?} {back:?}");
        }
        assert_eq!(vector(5.0, -90.0), [0.0, -5.0]);
        assert_eq!(polar_form([0.0, 0.0]), (0.0, None));
    }

    #[test]
    fn ranges_are_never_empty() {
        for values in [&[][..], &[0.0], &[5.0, 5.0], &[-2.0], &[1.0, 3.0], &[f64::MAX; 2], &[5.0, 5.0 + 1e-12]] {
            let [low, high] = range_of(values);
            assert!(low < high, "{values:?}");
        }
    }
}
