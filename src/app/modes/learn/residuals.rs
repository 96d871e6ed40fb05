//! Cards of the residual of every iteration on a logarithmic scale, compared with a line that falls by the factor ρ per
//! iteration; and the choice of method or element on a card.

use super::*;
use crate::app::diagnosis::rho_number;

/// Shows the buttons that iterate, and the residuals.
pub(super) fn steps(ui: &mut Ui, session: &Session, actions: &mut Vec<Action>) {
    ui.horizontal_wrapped(|ui| {
        let ended = *session.simulation().status() != Status::Running;
        step_buttons(ui, session, ("Step once", "One iteration (N)", !ended), actions);
        if let [.., before, last] = session.model.residuals[..]
            && before > 0.0
            && (last / before).is_finite()
        {
            let ratio = last / before;
            let text = fill!("last step: residual × %{ratio}", ratio = rho_number(ratio));
            ui.add(Label::new(text).extend());
        }
    });
    plot(ui, session);
}

/// Shows the buttons that choose a method, and the residuals.
pub(super) fn methods(ui: &mut Ui, session: &Session, actions: &mut Vec<Action>) {
    ui.horizontal_wrapped(|ui| {
        let present = session.scene().solver.method;
        let offered = [(MethodKind::Warped, "warped: A alone"), (MethodKind::Newton, "newton: A + G")];
        let methods = offered.map(|(kind, text)| (kind, text, kind.entry().about));
        if let Some(kind) = options(ui, methods, Some(present)).filter(|kind| *kind != present) {
            actions.push(Action::edit("Method", session.scene(), |scene| scene.solver.method = kind));
        }
        let simulation = session.simulation();
        let iterations = count(simulation.iterations(), "iteration");
        let text = match simulation.status() {
            Status::Converged => fill!("converged after %{iterations}", iterations),
            Status::Running => iterations,
            _ => fill!("given up after %{iterations}", iterations),
        };
        ui.add(Label::new(text).extend());
    });
    plot(ui, session);
}

/// Shows one button per element: the same beam locks with some of them.
pub(super) fn elements(ui: &mut Ui, scene: &Scene, actions: &mut Vec<Action>) {
    for element in scene.elements() {
        let chosen = scene.element() == element;
        let button = ui.add(Button::selectable(chosen, RichText::new(element.id()).size(16.0)));
        if button.clicked() && !chosen {
            actions.push(Action::edit("Element", scene, |scene| scene.set_element(element)));
        }
        ui.add(Label::new(RichText::new(tr(element.entry().about)).small().weak()).wrap());
        ui.add_space(2.0);
    }
}

fn plot(ui: &mut Ui, session: &Session) {
    /// Smallest number of iterations on the horizontal axis.
    const MIN_ITERATIONS: usize = 12;
    /// Decimal exponent at the top of the vertical axis.
    const HIGHEST: f64 = 1.0;
    const DASHES: &[f64] = &[6.0, 4.0];
    // The residuals of other methods do not follow it.
    let is_warped = session.scene().solver.method == MethodKind::Warped;
    let rho = session.facts.rho.get(session.scene()).copied().filter(|_| is_warped);
    let size = vec2(ui.available_width().min(460.0), (ui.available_height() - 4.0).clamp(96.0, 150.0));
    let (whole, response) = ui.allocate_exact_size(size, Sense::hover());
    let size = [size.x, size.y].map(f64::from);
    let frame = ChartFrame { size, across: [50.0, size[0] - 8.0], up: [size[1] - 20.0, 6.0], edge: 0.0 };
    let decade = |r: f64| r.clamp(1e-300, 1e300).log10();
    let asked = decade(session.scene().solver.tolerance);
    let residuals = &session.model.residuals;
    let bottom = residuals.iter().map(|&r| decade(r)).fold(asked, f64::min).max(asked - 6.0) - 0.5;
    let most = residuals.len().max(MIN_ITERATIONS) as f64;
    let x = ChartAxis::linear([0.0, most], frame.across);
    let y = ChartAxis::linear([bottom, HIGHEST], frame.up);
    let place = |k: f64, exponent: f64| [x.place(k), y.place(exponent)];
    let mut drawing = ChartPainter::new(ui, whole.min);
    let counts = x.ticks().into_iter().map(|(place, k)| (place, number(k))).collect();
    let powers = y.ticks().into_iter().filter(|(_, exponent)| exponent.fract() == 0.0);
    let powers = powers.map(|(place, exponent)| (place, number(10f64.powf(exponent)))).collect();
    frame.grid(&mut drawing, [counts, powers], ["", ""]);
    drawing.clip(Some([[frame.across[0], 0.0], [size[0] - frame.across[0], frame.up[0]]]));
    drawing.line(&[place(0.0, asked), place(most, asked)], Ink::Limit, 1.0, DASHES);
    let points = || residuals.iter().enumerate().map(|(i, &r)| (i as f64 + 1.0, decade(r)));
    if let Some(rho) = rho {
        // A converging line ends at the last residual; a diverging one starts at the lowest.
        let mut points = points();
        let anchor = if rho < 1.0 { points.next_back() } else { points.min_by(|a, b| a.1.total_cmp(&b.1)) };
        let (k, r) = anchor.unwrap_or((0.0, 0.0));
        let line = |at: f64| place(at, r + (at - k) * rho.log10());
        drawing.line(&[line(0.0), line(most)], Ink::Reference, 1.8, DASHES);
    }
    let places: Vec<_> = points().map(|(k, r)| place(k, r)).collect();
    let ink = Ink::of(&Setting::of(session.scene()));
    places.iter().for_each(|at| drawing.circle(*at, 3.0, ink, None));
    drawing.line(&places, ink, 1.6, &[]);
    drawing.clip(None);
    if let Some(rho) = rho {
        let text = fill!("ρ = %{rho}: the line's slope", rho = rho_number(rho));
        drawing.text([frame.across[1] - 2.0, 36.0], Anchor::End, Ink::Reference, &text);
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
    if is_warped && session.facts.rho.is_pending(session.scene()) {
        ui.label(RichText::new(tr("Computing ρ.")).small().weak());
    }
}
