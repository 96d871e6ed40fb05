//! Card of the residual of every iteration on a logarithmic scale, compared with a line that falls by the factor ρ per
//! iteration.

use super::step_buttons;
use crate::app::diagnosis::rho_number;
use crate::app::interface::*;

/// Shows the buttons that iterate, and the residuals.
pub(super) fn steps(ui: &mut Ui, shown: &Readout<'_>, actions: &mut Vec<Action>) {
    ui.horizontal_wrapped(|ui| {
        let ended = *shown.simulation.status() != Status::Running;
        step_buttons(ui, shown, ("Step once", "One iteration (N)", !ended), actions);
        if let Some(ratio) = last_ratio(&shown.session.model.residuals) {
            let text = fill!("last step: residual × %{ratio}", ratio = rho_number(ratio));
            ui.add(Label::new(text).extend());
        }
    });
    plot(ui, shown);
}

/// Shows the buttons that choose a method, and the residuals.
pub(super) fn methods(ui: &mut Ui, shown: &Readout<'_>, actions: &mut Vec<Action>) {
    ui.horizontal_wrapped(|ui| {
        for method in METHODS.iter().filter(|m| [MethodKind::Warped, MethodKind::Newton].contains(&m.kind)) {
            let chosen = shown.scene.solver.method == method.kind;
            let text = if method.kind == MethodKind::Newton { "newton: A + G" } else { "warped: A alone" };
            if ui.add(option_button(chosen, tr(text))).on_hover_text(tr(method.about)).clicked() && !chosen {
                actions.push(Action::edit("Method", shown.scene, |scene| scene.solver.method = method.kind));
            }
        }
        let simulation = shown.simulation;
        let iterations = count(simulation.iterations(), "iteration");
        let text = match simulation.status() {
            Status::Converged => fill!("converged after %{iterations}", iterations),
            Status::Running => iterations,
            _ => fill!("given up after %{iterations}", iterations),
        };
        ui.add(Label::new(text).extend());
    });
    plot(ui, shown);
}

fn last_ratio(residuals: &[f64]) -> Option<f64> {
    let [.., before, last] = residuals else { return None };
    let ratio = last / before;
    (ratio.is_finite() && *before > 0.0).then_some(ratio)
}

/// Decimal exponent at the top of the vertical axis.
const HIGHEST: f64 = 1.0;

fn plot(ui: &mut Ui, shown: &Readout<'_>) {
    /// Smallest number of iterations on the horizontal axis.
    const MIN_ITERATIONS: usize = 12;
    const LEFT: f32 = 40.0;
    const BELOW: f32 = 20.0;
    let palette = Palette::new(ui.visuals());
    // The residuals of other methods do not follow it.
    let is_warped = shown.scene.solver.method == MethodKind::Warped;
    let rho = shown.session.facts().rho.get(shown.scene).copied().filter(|_| is_warped);
    let size = vec2(ui.available_width().min(460.0), (ui.available_height() - 4.0).clamp(96.0, 150.0));
    let (whole, response) = ui.allocate_exact_size(size, Sense::hover());
    let rect = Rect::from_min_max(whole.min + vec2(LEFT, 6.0), whole.max - vec2(8.0, BELOW));
    let asked = shown.scene.solver.tolerance.max(1e-300).log10();
    let residuals = &shown.session.model.residuals;
    let decade = |r: f64| r.clamp(1e-300, 1e300).log10();
    let bottom = residuals.iter().map(|&r| decade(r)).fold(asked, f64::min).max(asked - 6.0) - 0.5;
    let most = residuals.len().max(MIN_ITERATIONS) as f64;
    let place = |k: f64, exponent: f64| {
        let x = rect.left() + rect.width() * (k / most) as f32;
        pos2(x, rect.top() + rect.height() * ((HIGHEST - exponent) / (HIGHEST - bottom)) as f32)
    };
    let painter = ui.painter().with_clip_rect(whole.intersect(ui.clip_rect()));
    axes(&painter, rect, &palette, bottom, most, &place);
    let inside = painter.with_clip_rect(rect.expand(3.0).intersect(ui.clip_rect()));
    let dashed = |ends: [Pos2; 2], stroke| inside.extend(Shape::dashed_line(&ends, stroke, 6.0, 4.0));
    dashed([place(0.0, asked), place(most, asked)], Stroke::new(1.0, palette.secondary));
    if let Some(rho) = rho {
        // A converging line ends at the last residual; a diverging one starts at the lowest.
        let mut points = residuals.iter().enumerate().map(|(i, &r)| (i as f64 + 1.0, decade(r)));
        let anchor = if rho < 1.0 { points.next_back() } else { points.min_by(|a, b| a.1.total_cmp(&b.1)) };
        let (k, r) = anchor.unwrap_or((0.0, 0.0));
        let line = |at: f64| place(at, r + (at - k) * rho.log10());
        dashed([line(0.0), line(most)], Stroke::new(1.8, palette.exact));
    }
    let color = palette.method(shown.scene.solver.method);
    let points: Vec<_> = residuals.iter().enumerate().map(|(i, &r)| place(i as f64 + 1.0, decade(r))).collect();
    for point in &points {
        inside.circle_filled(*point, 3.0, color);
    }
    inside.line(points, Stroke::new(1.6, color));
    let small = FontId::proportional(SMALL);
    if let Some(rho) = rho {
        let text = fill!("ρ = %{rho}: the line's slope", rho = rho_number(rho));
        painter.text(rect.right_top() + vec2(-2.0, 22.0), Align2::RIGHT_TOP, text, small, palette.exact);
    }
    let iterations = count(residuals.len() as u64, "iteration");
    let text = match (residuals.last(), rho) {
        (Some(last), Some(rho)) => fill!(
            "Residual %{residual} after %{iterations}; rho = %{rho}",
            residual = format!("{last:.1e}"),
            iterations,
            rho = rho_number(rho)
        ),
        _ => fill!("%{iterations} so far", iterations),
    };
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &text));
    response.on_hover_text(tr(
        "Residual (unbalanced force over all forces) after each iteration; grey dashes: the tolerance",
    ));
    if is_warped && shown.session.facts().rho.is_pending(shown.scene) {
        ui.label(RichText::new(tr("Computing ρ.")).small().weak());
    }
}

fn axes(painter: &Painter, rect: Rect, palette: &Palette, bottom: f64, most: f64, place: &dyn Fn(f64, f64) -> Pos2) {
    let font = FontId::proportional(SMALL);
    let grid = Stroke::new(1.0, palette.line);
    for exponent in ((bottom.ceil() as i32)..=(HIGHEST.floor() as i32)).rev().filter(|e| e % 2 == 0) {
        let at = place(0.0, f64::from(exponent));
        painter.line_segment([at, pos2(rect.right(), at.y)], grid);
        let text = if exponent == 0 { "1".to_owned() } else { format!("1e{exponent}").replace('-', "\u{2212}") };
        painter.text(at - vec2(5.0, 0.0), Align2::RIGHT_CENTER, text, font.clone(), palette.secondary);
    }
    for k in crate::format::ticks(0.0, most, 7) {
        let at = pos2(place(k, HIGHEST).x, rect.bottom());
        painter.line_segment([at, at + vec2(0.0, 3.0)], grid);
        painter.text(at + vec2(0.0, 3.0), Align2::CENTER_TOP, format!("{k}"), font.clone(), palette.secondary);
    }
    painter.line_segment([rect.left_bottom(), rect.right_bottom()], grid);
}
