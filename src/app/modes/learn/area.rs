//! Card of the growth of the body's area.

use super::*;

/// Largest force of the slider, N.
pub(super) const LARGEST_FORCE: f64 = 4e4;

/// Shows the slider of the force, and the growth of the body's area compared with the reference solution.
pub(super) fn show(ui: &mut Ui, session: &Session, learn: &mut Learn, actions: &mut Vec<Action>) {
    force(ui, session, learn, actions);
    ui.add_space(4.0);
    let method = session.scene().solver.method;
    let palette = Palette::new(ui.visuals());
    let linear = session.linear().filter(|_| method != MethodKind::Linear).map(|body| (body, MethodKind::Linear));
    for (body, method) in [(session.simulation(), method)].into_iter().chain(linear) {
        row(ui, &palette, method.id(), Some(body.area_change()), palette.ink(Ink::Solution(method.entry().colors)));
    }
    let reference = session.known_reference().filter(|_| session.simulation().is_at_rest());
    // The area inside a closed line, m²: positive for a counter-clockwise one.
    let enclosed = |line: &Vec<Vector2<f64>>| {
        0.5 * line.iter().zip(line.iter().cycle().skip(1)).map(|(a, b)| a.perp(b)).sum::<f64>()
    };
    let outline = reference.map(|reference| reference.outline(1.0)).filter(|lines| !lines.is_empty());
    let exact = outline.map(|lines| {
        let rest: f64 = session.simulation().system().nodal_areas().iter().sum();
        lines.iter().map(enclosed).sum::<f64>().abs() / rest - 1.0
    });
    row(ui, &palette, "reference", exact, palette.exact);
    let linear = Some(session.simulation()).filter(|_| method == MethodKind::Linear).or(session.linear());
    if let Some(angle) = linear.map(matrices::largest_linear_angle) {
        let text = fill!(
            "largest element: θ = %{angle} rad, drawn as atan θ = %{drawn}°; θ² = %{growth}",
            angle = number(three_digits(angle)),
            drawn = number(three_digits(angle.atan().to_degrees())),
            growth = percent(100.0 * angle * angle)
        );
        ui.label(RichText::new(text).small().weak());
    }
    ui.add_space(6.0);
    let sources = RichText::new(tr(SOURCES)).small().weak();
    ui.add(Label::new(spaced(sources, SMALL)).wrap());
}

/// Sources of the mode: the article, and the paper that it explains.
const SOURCES: &str = "The article: “实时物理模拟之 Warped Stiffness 方法” (the warped stiffness method in real-time physical \
                       simulation), study notes in Chinese in the style of Zhihu, without the author’s name. The \
                       method: Matthias Müller and Markus Gross, “Interactive Virtual Materials”, Graphics Interface \
                       2004.";

/// Shows the slider for the magnitude of the first force, which keeps its direction.
fn force(ui: &mut Ui, session: &Session, learn: &mut Learn, actions: &mut Vec<Action>) {
    let scene = session.scene();
    let first = scene.loads.iter().enumerate().find_map(|(i, load)| match load {
        Load::Force { force, .. } if force[0].hypot(force[1]) > 0.0 => Some((i, *force)),
        _ => None,
    });
    let Some((number, [x, y])) = first else {
        ui.label(tr("There is no force: set the card up again."));
        return;
    };
    let field = NumberField::new("Tip force", Limit { unit: "N", min: 1.0, max: 1e6 }, 1e3..=LARGEST_FORCE);
    let size = x.hypot(y);
    if let Some(new) = field.tip("The size of the force on the tip").show(ui, &mut learn.messages, size, None) {
        let new = [x, y].map(|v| v * new / size);
        actions.push(Action::edit("Force", scene, |scene| _ = scene.set_force(number, new)));
    }
}

fn row(ui: &mut Ui, palette: &Palette, name: &str, growth: Option<f64>, color: Color32) {
    /// Growth at the end of the bar.
    const FULL: f64 = 1.1;
    const NAME: f32 = 132.0;
    const NUMBER: f32 = 78.0;
    let name = fill!("whole body, %{name}", name = tr(name));
    let text = growth.map_or_else(|| "\u{2013}".to_owned(), signed_percent);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 24.0), Sense::hover());
    let painter = ui.painter();
    let put = |x: f32, text: RichText| {
        let galley = egui::WidgetText::from(text).into_galley(ui, None, f32::INFINITY, egui::TextStyle::Body);
        painter.galley(pos2(x, rect.center().y - 0.5 * galley.size().y), galley, palette.text);
    };
    put(rect.left(), RichText::new(&name).small().weak());
    put(rect.left() + NAME, RichText::new(&text).size(HEADLINE).color(color));
    let left = rect.left() + NAME + NUMBER;
    let bar = Rect::from_min_max(pos2(left, rect.center().y - 4.0), pos2(rect.right(), rect.center().y + 4.0));
    if bar.width() > 20.0 {
        painter.rect_filled(bar, 2.0, palette.line);
        let part = (growth.unwrap_or(0.0).abs() / FULL).min(1.0) as f32;
        painter.rect_filled(bar.with_max_x(bar.left() + part * bar.width()), 2.0, color);
    }
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("{name}: {text}")));
    response.on_hover_text(tr("Change of the body’s area, compared with rest"));
}
