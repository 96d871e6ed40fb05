//! Card of the method as ten lines of pseudocode. One line is highlighted; a step goes to the next one.

use super::*;

struct Line {
    indent: u8,
    /// Text in the markup of [`formula`].
    code: &'static str,
    /// Formats the values that this line of the displayed code computes for the selected triangle; `None` for a line
    /// without values.
    numbers: Option<fn(&Simulation, usize) -> String>,
}

const LINES: [Line; 10] = [
    Line { indent: 0, code: "K_{e} = `stiffness of each triangle at rest`", numbers: Some(stiffness) },
    Line { indent: 0, code: "x = X", numbers: Some(|_, _| tr("the beam at rest").to_owned()) },
    Line { indent: 0, code: "`repeat`", numbers: None },
    Line { indent: 1, code: "`for each triangle:`", numbers: None },
    Line { indent: 2, code: "F = `gradient of the map from` X `to` x", numbers: Some(gradient) },
    Line { indent: 2, code: "R, S = `polar decomposition of` F", numbers: Some(rotation) },
    Line { indent: 2, code: "`add` R K_{e} R^{T} `to` A `and` R K_{e} X `to` b", numbers: Some(matrix) },
    Line { indent: 1, code: "`solve` A x = f + b `for` x `(faer)`", numbers: Some(displacement) },
    Line { indent: 1, code: "r = | f \u{2212} f_{`int`} | / Σ | f_{e} |", numbers: Some(residual) },
    Line { indent: 0, code: "`until` r `is within the tolerance`", numbers: Some(verdict) },
];

/// Functions that execute each line, with their files.
const SOURCES: [&str; 10] = [
    "`src/element/isoparametric.rs: sweep`",
    "`src/assembly/system.rs: at_rest`",
    "`src/simulation/search.rs: step`",
    "`src/step.rs: linearize`",
    "`src/step.rs: linearize`",
    "`src/step.rs: linearize, warped_stress`",
    "`src/step.rs: linearize, warped_stress`",
    "`src/step.rs: step, factorize, solve, advance`",
    "`src/step.rs: linearize`",
    "`src/method/warped.rs: check_convergence`",
];

/// Indices of the lines that a step treats differently, from 0.
pub(crate) const AT_REST: usize = 1;
const FIRST_OF_LOOP: usize = 4;
pub(crate) const SOLVE: usize = 7;
pub(crate) const UNTIL: usize = 9;

/// Returns `true` if the lines describe the method of the simulation.
pub(super) fn describes(simulation: &Simulation) -> bool {
    simulation.scene().solver.method == MethodKind::Warped && simulation.system().mesh().element() == ElementKind::T3
}

/// Returns the line after `line`; `ended` is `true` if the iteration has ended.
pub(super) fn after(line: usize, ended: bool) -> usize {
    if line >= UNTIL {
        return if ended { AT_REST } else { FIRST_OF_LOOP };
    }
    (line + 1..UNTIL).find(|&next| LINES[next].numbers.is_some()).unwrap_or(UNTIL)
}

fn stiffness(simulation: &Simulation, _: usize) -> String {
    fill!("%{n} matrices, 6 × 6", n = simulation.system().mesh().element_count())
}

fn gradient(simulation: &Simulation, picked: usize) -> String {
    let Some(Triangle { gradient: f, .. }) = Triangle::of(simulation, picked) else { return String::new() };
    let [a, b, c, d] = [f.m11, f.m12, f.m21, f.m22].map(|v| format!("{v:.2}").replace('-', "\u{2212}"));
    fill!("triangle %{n}: [%{a} %{b}; %{c} %{d}]", n = picked, a, b, c, d)
}

fn rotation(simulation: &Simulation, _: usize) -> String {
    let size = |rotation: &Rotation| rotation.angle().abs();
    let largest = simulation.element_rotations().into_iter().max_by(|a, b| size(a).total_cmp(&size(b)));
    fill!("largest rotation: %{angle}", angle = angle_text(largest.unwrap_or(Rotation::IDENTITY)))
}

fn matrix(simulation: &Simulation, _: usize) -> String {
    let n = simulation.system().dofs();
    fill!("A: %{n} × %{n} (clamped nodes removed)", n)
}

fn displacement(simulation: &Simulation, _: usize) -> String {
    let largest = simulation.displacement().iter().map(|u| u.norm()).fold(0.0, f64::max);
    fill!("largest displacement: %{u}", u = engineering(three_digits(largest), "m"))
}

fn residual(simulation: &Simulation, _: usize) -> String {
    format!("r = {}", residual_text(simulation.residual()))
}

fn residual_text(residual: f64) -> String {
    format!("{residual:.1e}").replace('-', "\u{2212}")
}

fn verdict(simulation: &Simulation, _: usize) -> String {
    let iterations = count(simulation.iterations(), "iteration");
    match simulation.status() {
        Status::Converged => fill!("yes, after %{iterations}", iterations),
        Status::Running => fill!("no: r = %{r}, repeat", r = residual_text(simulation.residual())),
        _ => fill!("given up after %{iterations}", iterations),
    }
}

/// Shows the buttons that step, and the lines.
pub(super) fn show(ui: &mut Ui, session: &Session, learn: &mut Learn, actions: &mut Vec<Action>) {
    let simulation = session.simulation();
    if !describes(simulation) {
        let text = "These lines are for the method warped with three-node triangles only.";
        return not_triangles(ui, text, learn, actions);
    }
    ui.horizontal_wrapped(|ui| {
        let next = ("Next line", "The next line; the line that solves makes an iteration (N)", true);
        step_buttons(ui, session, next, actions);
        let iterations = count(simulation.iterations(), "iteration");
        ui.add(Label::new(fill!("%{iterations} so far", iterations)).extend());
    });
    let has_moved = std::mem::replace(&mut learn.shown_line, learn.line) != learn.line;
    // The buttons do not scroll with the lines.
    ScrollArea::vertical().id_salt("code").auto_shrink([false, false]).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        for (number, line) in LINES.iter().enumerate() {
            let is_lit = number == learn.line;
            let numbers = line.numbers.filter(|_| is_lit).map(|numbers| numbers(simulation, learn.picked));
            let rect = row(ui, number, line, numbers.as_deref());
            if is_lit && has_moved {
                ui.scroll_to_rect(rect, None);
            }
        }
    });
}

/// Paints a line; the highlighted line has numbers.
fn row(ui: &mut Ui, number: usize, line: &Line, numbers: Option<&str>) -> Rect {
    const HEIGHT: f32 = 17.5;
    const GUTTER: f32 = 30.0;
    const INDENT: f32 = 16.0;
    let palette = Palette::new(ui.visuals());
    let painter = ui.painter().clone();
    let code = tr(line.code);
    let galley = painter.layout_job(formula::sized(code, BODY, palette.text));
    let left = GUTTER + INDENT * f32::from(line.indent);
    let small = FontId::proportional(SMALL);
    let value_galley = numbers.map(|text| painter.layout_no_wrap(text.to_owned(), small.clone(), palette.accent));
    let width = ui.available_width();
    // Numbers that do not fit to the right of the code are placed under it.
    let is_under =
        value_galley.as_ref().is_some_and(|value_galley| left + galley.size().x + 16.0 + value_galley.size().x > width);
    let height = if is_under { HEIGHT + 16.0 } else { HEIGHT };
    let (rect, response) = ui.allocate_exact_size(vec2(width, height), Sense::hover());
    if numbers.is_some() {
        painter.rect_filled(rect, 3.0, palette.chosen.gamma_multiply(0.6));
        painter.rect_filled(rect.with_max_x(rect.left() + 3.0), 1.0, palette.accent);
    }
    let middle = rect.top() + 0.5 * HEIGHT;
    let place = pos2(rect.left() + GUTTER - 10.0, middle);
    painter.text(place, Align2::RIGHT_CENTER, format!("{}", number + 1), small, palette.secondary);
    painter.galley(pos2(rect.left() + left, middle - 0.5 * galley.size().y), galley, palette.text);
    if let Some(value_galley) = value_galley {
        let at = match is_under {
            true => pos2(rect.left() + left, rect.top() + HEIGHT),
            false => pos2(rect.right() - 6.0 - value_galley.size().x, middle - 0.5 * value_galley.size().y),
        };
        painter.galley(at, value_galley, palette.accent);
    }
    let plain = formula::plain(code);
    response.widget_info(|| {
        let text = match numbers {
            Some(numbers) => fill!("line %{n}: %{code}; %{numbers}", n = number + 1, code = plain, numbers),
            None => format!("{} {plain}", number + 1),
        };
        WidgetInfo::labeled(Role::Label, true, text)
    });
    response.on_hover_text(SOURCES[number]);
    rect
}
