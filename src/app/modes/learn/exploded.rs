//! Exploded view: the elements are drawn apart from each other, each rotated back by its Rᵀ onto its shape at rest.

use super::*;

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
pub(super) fn paint(painter: &Painter, view: &CardView<'_>, learn: &Learn) {
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
pub(super) fn show(ui: &mut Ui, session: &Session, learn: &mut Learn, actions: &mut Vec<Action>) {
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
