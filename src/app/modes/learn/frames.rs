//! Card of the rotated frame R of every triangle, and of F = R S of one triangle. Card of the exploded view: the elements are
//! drawn apart from each other, each rotated back by its Rᵀ onto its shape at rest.

use super::*;

/// Smallest length of a drawn axis, points; finer meshes have none.
const SHORTEST: f32 = 5.0;

/// Paints the axes of every element's frame.
pub(super) fn paint(painter: &Painter, view: &CardView<'_>, learn: &Learn) {
    let rotations = if view.is_fine() { Vec::new() } else { view.simulation.element_rotations() };
    for (element, rotation) in rotations.into_iter().enumerate() {
        let corners = view.corners(element);
        let Some(center) = middle(&corners) else { continue };
        let length = 0.62 * corners.iter().map(|c| (*c - center).length()).fold(f32::INFINITY, f32::min);
        if length < SHORTEST {
            continue;
        }
        let wide = if element == learn.picked { 2.4 } else { 1.6 };
        for (axis, color) in [(Vector2::x(), view.body.palette.load), (Vector2::y(), view.body.palette.exact)] {
            let along = rotation.apply(axis);
            let tip = center + length * vec2(along.x as f32, -along.y as f32);
            arrow(painter, center, tip, Stroke::new(wide + 2.0, view.body.palette.canvas));
            arrow(painter, center, tip, Stroke::new(wide, color));
        }
        painter.circle_filled(center, wide + 0.6, view.body.palette.text);
    }
    paint_picked(painter, view, learn);
}

/// Paints the outline of the selected element.
pub(super) fn paint_picked(painter: &Painter, view: &CardView<'_>, learn: &Learn) {
    let corners = view.corners(learn.picked);
    if corners.len() >= 3 {
        painter.add(Shape::closed_line(corners.clone(), Stroke::new(5.0, view.body.palette.canvas)));
        painter.add(Shape::closed_line(corners, Stroke::new(2.5, view.body.palette.accent)));
    }
}

fn middle(corners: &[Pos2]) -> Option<Pos2> {
    let sum = corners.iter().fold(Vec2::ZERO, |sum, c| sum + c.to_vec2());
    (!corners.is_empty()).then(|| (sum / corners.len() as f32).to_pos2())
}

fn arrow(painter: &Painter, from: Pos2, to: Pos2, stroke: Stroke) {
    let vector = to - from;
    let head = (0.3 * vector.length()).min(7.0);
    let along = vector.normalized();
    let across = vec2(-along.y, along.x);
    painter.line_segment([from, to], stroke);
    for side in [-0.6, 0.6] {
        painter.line_segment([to, to - head * along + side * head * across], stroke);
    }
}

/// Shows F = R S with the numbers of the selected triangle.
pub(super) fn show(ui: &mut Ui, session: &Session, learn: &mut Learn, actions: &mut Vec<Action>) {
    let Some(triangle) = Triangle::of(session.simulation(), learn.picked) else {
        return not_triangles(ui, NOT_TRIANGLES, learn, actions);
    };
    let palette = Palette::new(ui.visuals());
    let angle = angle_text(triangle.rotation);
    ui.label(fill!("Triangle %{n}, rotated by %{angle}", n = learn.picked, angle));
    ui.add_space(6.0);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(8.0, 8.0);
        let r = triangle.rotation.matrix();
        for (name, before, matrix) in [("F", "", &triangle.gradient), ("R", "=", &r), ("S", "·", &triangle.stretch)] {
            show_matrix(ui, (name, before), matrix, &palette);
        }
    });
    ui.add_space(4.0);
    let text = tr("S is symmetric: it stretches along two axes at right angles, and rotates nothing.");
    ui.label(RichText::new(text).small().weak());
}

/// Formats a rotation angle with its sign.
pub(super) fn angle_text(rotation: Rotation) -> String {
    format!("{:.1}°", rotation.angle().to_degrees()).replace('-', "\u{2212}")
}

/// Shows a 2 × 2 matrix in brackets, after an operator, with its name below.
fn show_matrix(ui: &mut Ui, (name, before): (&str, &str), m: &Matrix2<f64>, palette: &Palette) {
    const CELL: Vec2 = vec2(54.0, 22.0);
    const BRACKET: f32 = 5.0;
    const SIGN: f32 = 16.0;
    const NAME: f32 = 26.0;
    let sign = if before.is_empty() { 0.0 } else { SIGN };
    let size = vec2(sign + 2.0 * CELL.x + 6.0, 2.0 * CELL.y + NAME);
    let (whole, response) = ui.allocate_exact_size(size, Sense::hover());
    let rect = Rect::from_min_size(whole.min + vec2(sign, 0.0), vec2(2.0 * CELL.x + 6.0, 2.0 * CELL.y));
    let painter = ui.painter();
    let number = |v: f64| {
        let text = format!("{v:.3}");
        if text == "-0.000" { "0.000".to_owned() } else { text.replace('-', "\u{2212}") }
    };
    let numbers = [m.m11, m.m12, m.m21, m.m22].map(number);
    for ((row, column), text) in [(0.5, 1.0), (0.5, 2.0), (1.5, 1.0), (1.5, 2.0)].into_iter().zip(&numbers) {
        let at = rect.min + vec2(CELL.x * column, CELL.y * row);
        painter.text(at, Align2::RIGHT_CENTER, text, FontId::monospace(BODY - 1.0), palette.text);
    }
    for (x, inward) in [(rect.left(), BRACKET), (rect.right(), -BRACKET)] {
        let points = [(x + inward, rect.top()), (x, rect.top()), (x, rect.bottom()), (x + inward, rect.bottom())];
        let points = points.map(|(x, y)| pos2(x, y)).to_vec();
        painter.add(Shape::line(points, Stroke::new(1.2, palette.text)));
    }
    if !before.is_empty() {
        let at = pos2(whole.left() + 4.0, rect.center().y);
        painter.text(at, Align2::CENTER_CENTER, before, FontId::proportional(BODY + 4.0), palette.text);
    }
    let galley = painter.layout_job(formula::sized(name, formula::SIZE, palette.secondary));
    painter.galley(pos2(rect.center().x - 0.5 * galley.size().x, rect.bottom() + 2.0), galley, palette.secondary);
    let [a, b, c, d] = numbers;
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("{name} = [{a} {b}; {c} {d}]")));
}

/// Distances of the element centres from the body's centre in the exploded view, relative to those at rest.
const APART: f64 = 1.5;

impl Learn {
    /// Moves the drawn points of every element towards the exploded view.
    pub(crate) fn place(&self, simulation: &Simulation, geometry: &DisplayGeometry, points: &mut [Vector2<f64>]) {
        let mesh = simulation.system().mesh();
        let mut rest = Vec::new();
        geometry.points(&|n| mesh.nodes()[n as usize], &mut rest);
        let each = (points.len() / mesh.element_count().max(1)).max(1);
        let body = mean(&rest);
        let rotations = simulation.element_rotations();
        for ((points, rest), rotation) in points.chunks_mut(each).zip(rest.chunks(each)).zip(rotations) {
            let (now, apart) = (mean(points), body + (mean(rest) - body) * APART);
            let center = now + (apart - now) * self.rotation_part;
            let back = Rotation::from_angle(-self.rotation_part * rotation.angle());
            points.iter_mut().for_each(|p| *p = center + back.apply(*p - now));
        }
    }
}

fn mean(points: &[Vector2<f64>]) -> Vector2<f64> {
    points.iter().sum::<Vector2<f64>>() / points.len().max(1) as f64
}

/// Paints the rest shape of every element at its position in the exploded view.
pub(super) fn paint_rotated_back(painter: &Painter, view: &CardView<'_>, learn: &Learn) {
    let mesh = view.simulation.system().mesh();
    let strength = learn.rotation_part as f32;
    if strength > 0.0 && !view.is_fine() {
        for (element, nodes) in mesh.elements().enumerate() {
            let rest: Vec<Vector2<f64>> = nodes.iter().map(|&n| mesh.nodes()[n as usize]).collect();
            let corners = &rest[..mesh.entry().cell.corners.len().min(rest.len())];
            let shift = mean(view.points_of(element)) - mean(corners);
            let line: Vec<_> = corners.iter().map(|p| view.projection.point(p + shift)).collect();
            for (width, color) in [(3.2_f32, view.body.palette.canvas), (1.5, view.body.palette.exact)] {
                painter.add(Shape::closed_line(line.clone(), Stroke::new(width, color.gamma_multiply(strength))));
            }
        }
    }
    paint_picked(painter, view, learn);
}

/// Shows the slider between the two views, and the strain of the selected triangle.
pub(super) fn show_rotated_back(ui: &mut Ui, session: &Session, learn: &mut Learn, actions: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        ui.label(tr("As it is"));
        ui.spacing_mut().slider_width = (ui.available_width() - 90.0).clamp(60.0, 260.0);
        let slider = ui.add(egui::Slider::new(&mut learn.rotation_part, 0.0..=1.0).show_value(false));
        let label = ui.label(tr("Rotated back"));
        let tip = tr("From the bent beam to its triangles, each rotated back by its own R");
        slider.labelled_by(label.id).on_hover_text(tip);
    });
    ui.add_space(6.0);
    let Some(triangle) = Triangle::of(session.simulation(), learn.picked) else {
        return not_triangles(ui, NOT_TRIANGLES, learn, actions);
    };
    let angle = angle_text(triangle.rotation);
    ui.label(fill!("Triangle %{n}: rotated by %{angle},", n = learn.picked, angle));
    let s = triangle.stretch;
    ui.label(fill!(
        "strain ε: along %{along}, across %{across}, shear γ %{shear}",
        along = signed_strain(s.m11 - 1.0),
        across = signed_strain(s.m22 - 1.0),
        shear = signed_strain(2.0 * s.m12),
    ));
    let text = tr("Line: the shape at rest. Colour: the largest strain; K turns strain into force.");
    ui.label(RichText::new(text).small().weak());
}

fn signed_strain(strain: f64) -> String {
    let sign = if strain < 0.0 { "\u{2212}" } else { "+" };
    format!("{sign}{}", percent(100.0 * strain.abs()))
}
