//! The frame R in every triangle, and F = R S of one.

use egui::{Color32, Painter, Pos2, Role, Sense, Shape, Stroke, Ui, WidgetInfo, vec2};
use nalgebra::{Matrix2, Vector2};

use super::triangle::{Triangle, frames};
use super::{Learn, Shown, View, formula, not_triangles};
use crate::app::action::Action;
use crate::app::palette::{BODY, Palette, SMALL};
use crate::rotation::Rotation;

/// A shorter axis than this, points, is not drawn: the mesh is too fine for it.
const SHORTEST: f32 = 7.0;

/// Paints the axes of every element's frame.
pub(super) fn paint(painter: &Painter, view: &View<'_>, learn: &Learn) {
    for (element, rotation) in frames(view.simulation).into_iter().enumerate() {
        let corners = view.corners(element);
        let Some(center) = middle(&corners) else { continue };
        let length = 0.62 * corners.iter().map(|c| (*c - center).length()).fold(f32::INFINITY, f32::min);
        if length < SHORTEST {
            continue;
        }
        let wide = if element == learn.picked { 2.4 } else { 1.6 };
        for (axis, color) in [(Vector2::x(), view.palette.load), (Vector2::y(), view.palette.exact)] {
            let along = rotation.apply(axis);
            let tip = center + length * vec2(along.x as f32, -along.y as f32);
            arrow(painter, center, tip, Stroke::new(wide + 2.0, view.palette.canvas));
            arrow(painter, center, tip, Stroke::new(wide, color));
        }
        painter.circle_filled(center, wide + 0.6, view.palette.text);
    }
    paint_picked(painter, view, learn);
}

/// Paints the outline of the clicked element.
pub(super) fn paint_picked(painter: &Painter, view: &View<'_>, learn: &Learn) {
    let corners = view.corners(learn.picked);
    if corners.len() >= 3 {
        painter.add(Shape::closed_line(corners.clone(), Stroke::new(5.0, view.palette.canvas)));
        painter.add(Shape::closed_line(corners, Stroke::new(2.5, view.palette.accent)));
    }
}

fn middle(corners: &[Pos2]) -> Option<Pos2> {
    let sum = corners.iter().fold(egui::Vec2::ZERO, |sum, c| sum + c.to_vec2());
    (!corners.is_empty()).then(|| (sum / corners.len() as f32).to_pos2())
}

fn arrow(painter: &Painter, from: Pos2, to: Pos2, stroke: Stroke) {
    let way = to - from;
    let head = (0.3 * way.length()).min(7.0);
    let along = way.normalized();
    let across = vec2(-along.y, along.x);
    painter.line_segment([from, to], stroke);
    for side in [-0.6, 0.6] {
        painter.line_segment([to, to - head * along + side * head * across], stroke);
    }
}

/// F = R S with the numbers of the clicked triangle.
pub(super) fn show(ui: &mut Ui, shown: &Shown<'_>, learn: &mut Learn, actions: &mut Vec<Action>) {
    let Some(triangle) = Triangle::of(shown.input.simulation, learn.picked) else {
        return not_triangles(ui, learn, actions);
    };
    let palette = Palette::new(ui.visuals());
    ui.label(format!("Triangle {}, turned by {}", learn.picked + 1, angle_words(triangle.rotation)));
    ui.add_space(6.0);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 7.0;
        let r = triangle.rotation.matrix();
        for (name, matrix, between) in [("F", triangle.gradient, "="), ("R", r, "\u{b7}"), ("S", triangle.stretch, "")] {
            ui.vertical(|ui| {
                show_matrix(ui, name, &matrix, palette.text);
                ui.vertical_centered(|ui| {
                    ui.set_max_width(100.0);
                    ui.label(formula::set(name, palette.secondary));
                });
            });
            ui.vertical(|ui| {
                ui.add_space(14.0);
                ui.label(egui::RichText::new(between).size(18.0));
            });
        }
    });
    ui.label(
        egui::RichText::new("S is symmetric: it stretches along two axes at right angles, and turns nothing.")
            .size(SMALL)
            .color(palette.secondary),
    );
}

/// An angle with its sense.
pub(super) fn angle_words(rotation: Rotation) -> String {
    format!("{:.1}\u{b0}", rotation.angle().to_degrees()).replace('-', "\u{2212}")
}

/// The numbers of a 2×2 matrix in brackets.
fn show_matrix(ui: &mut Ui, name: &str, m: &Matrix2<f64>, color: Color32) {
    const CELL: egui::Vec2 = vec2(52.0, 22.0);
    const BRACKET: f32 = 5.0;
    let (rect, response) = ui.allocate_exact_size(vec2(2.0 * CELL.x, 2.0 * CELL.y), Sense::hover());
    let number = |v: f64| format!("{:.3}", if v == 0.0 { 0.0 } else { v }).replace('-', "\u{2212}");
    for row in 0..2_u8 {
        for column in 0..2_u8 {
            let at = rect.min + vec2(CELL.x * (f32::from(column) + 1.0) - 6.0, CELL.y * (f32::from(row) + 0.5));
            let font = egui::FontId::monospace(BODY - 1.0);
            let text = number(m[(usize::from(row), usize::from(column))]);
            ui.painter().text(at, egui::Align2::RIGHT_CENTER, text, font, color);
        }
    }
    for (x, inward) in [(rect.left(), BRACKET), (rect.right(), -BRACKET)] {
        let line = [rect.top(), rect.bottom()];
        let points = vec![
            egui::pos2(x + inward, line[0]),
            egui::pos2(x, line[0]),
            egui::pos2(x, line[1]),
            egui::pos2(x + inward, line[1]),
        ];
        ui.painter().add(Shape::line(points, Stroke::new(1.2, color)));
    }
    let [a, b, c, d] = [m.m11, m.m12, m.m21, m.m22].map(number);
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("{name} = [{a} {b}; {c} {d}]")));
}
