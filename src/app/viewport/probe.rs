//! Values at the point under the pointer, and at a pinned point.

use egui::{Align2, Area, Color32, Frame, Grid, Order, Painter, Pos2, Rect, RichText, Sense, Stroke, Ui, vec2};
use nalgebra::{Matrix2, Vector2};

use crate::app::language::{fill, tr};
use crate::app::widgets::text::boxed_text;
use crate::format::{engineering, engineering_pair, three_digits};
use crate::mesh::{MaterialPoint, Mesh};
use crate::simulation::{Field, PointState, PointValues};

/// Distance from a pinned point to its card, points.
const AWAY: f32 = 26.0;
/// Distance within which a click hits a pinned point, points.
const NEAR: f32 = 9.0;

/// Returns the weighted sum of `positions` at a material point: its position if these are the nodes' positions, m.
pub(crate) fn place(mesh: &Mesh, positions: &[Vector2<f64>], point: MaterialPoint) -> Option<Vector2<f64>> {
    mesh.weights(point)?.iter().map(|&(n, w)| Some(positions.get(n as usize)? * w)).sum()
}

/// Returns `true` if a click is on a pinned point; both positions are in the window.
pub(crate) fn is_on(kept: Pos2, click: Pos2) -> bool {
    kept.distance(click) <= NEAR
}

/// Formats a value of a field with its unit.
fn value(field: Field, value: f64) -> String {
    let (factor, unit) = field.display_unit();
    engineering(three_digits(factor * value), unit)
}

/// Paints the value of the field and the displacement next to the pointer.
pub(crate) fn paint_hover(ui: &Ui, painter: &Painter, at: Pos2, field: (Field, Option<f64>), u: Vector2<f64>) {
    let (field, of_field) = field;
    let of_field = of_field.map_or_else(|| tr("unknown").to_owned(), |v| value(field, v));
    let text = format!("{}: {of_field}\nu = {}", tr(field.name()), metres(u));
    let visuals = ui.visuals();
    let place = at + vec2(16.0, 18.0);
    boxed_text(painter, place, Align2::LEFT_TOP, &text, visuals, visuals.strong_text_color(), 320.0);
}

fn metres(v: Vector2<f64>) -> String {
    engineering_pair([v.x, v.y].map(three_digits), "m")
}

/// Formats a matrix in two rows.
fn rows(m: &Matrix2<f64>) -> String {
    // Adding 0 removes the sign of -0.
    let number = |v: f64| format!("{:>8}", format!("{:.4}", (1e4 * v).round() / 1e4 + 0.0));
    format!("{} {}\n{} {}", number(m.m11), number(m.m12), number(m.m21), number(m.m22))
}

/// Shows the card of a pinned point at the window position `at`, and returns `true` if the card was closed.
pub(crate) fn show_card(ui: &Ui, painter: &Painter, view: Rect, at: Pos2, field: Field, point: &PointState) -> bool {
    let visuals = ui.visuals();
    let color = visuals.strong_text_color();
    let side = if at.x > view.center().x { -1.0 } else { 1.0 };
    let pivot = if side < 0.0 { Align2::RIGHT_BOTTOM } else { Align2::LEFT_BOTTOM };
    let corner = at + vec2(side * AWAY, -AWAY);
    painter.line_segment([at, corner], Stroke::new(1.2, color));
    painter.circle(at, 4.5, Color32::TRANSPARENT, Stroke::new(2.0, color));
    painter.circle_filled(at, 1.5, color);
    let area =
        Area::new(egui::Id::unique("probe")).order(Order::Middle).pivot(pivot).fixed_pos(corner).constrain_to(view);
    let card = area.show(ui.ctx(), |ui| {
        let frame = Frame::popup(ui.style()).show(ui, |ui| {
            ui.style_mut().interaction.selectable_labels = false;
            ui.strong(fill!("Point %{place}", place = metres(point.rest)));
            let (kind, tip) = match point.values {
                PointValues::Recovered => (
                    "recovered at the nodes",
                    "Smoothed values: strain and rotation of the surrounding elements, fitted at the nodes",
                ),
                PointValues::Raw => {
                    ("element value, not smoothed", "Strain and rotation of the element itself, not smoothed")
                }
            };
            ui.label(RichText::new(tr(kind)).weak().size(12.0)).on_hover_text(tr(tip));
            Grid::new("probe values").num_columns(2).spacing([12.0, 3.0]).show(ui, |ui| {
                let mut row = |name: &str, text: String, tip: &str| {
                    ui.label(RichText::new(name).weak()).on_hover_text(tr(tip));
                    ui.label(text).on_hover_text(tr(tip));
                    ui.end_row();
                };
                row("u", metres(point.displacement), "Displacement");
                let number =
                    |field: Field| point.field(field).map_or_else(|| tr("none").to_owned(), |v| value(field, v));
                if !point.is_linear {
                    row("θ", number(Field::RotationAngle), "Angle of the rotation R");
                }
                row("σ", number(Field::VonMises), "Von Mises stress, from the Cauchy stress, which follows from ε");
                row(
                    "ε",
                    number(Field::LargestStrain),
                    if point.is_linear {
                        "Principal strain of largest magnitude, of ε = sym F − I, the strain of linear theory"
                    } else {
                        "Principal strain of largest magnitude, of ε = S − I"
                    },
                );
                if field == Field::EnergyDensity {
                    row("ψ", number(field), "Strain energy density");
                }
                let matrices = [
                    ("F", &point.gradient, "Deformation gradient ∂x/∂X"),
                    ("R", &point.rotation.matrix(), "Rotation of the polar decomposition F = R S"),
                    ("S", &point.stretch, "Stretch of the polar decomposition F = R S"),
                ];
                // Linear theory has neither R nor S.
                let count = if point.is_linear { 1 } else { matrices.len() };
                for (name, matrix, tip) in matrices.into_iter().take(count) {
                    ui.label(RichText::new(name).weak()).on_hover_text(tr(tip));
                    ui.label(RichText::new(rows(matrix)).monospace().size(12.0)).on_hover_text(tr(tip));
                    ui.end_row();
                }
            });
            ui.label(RichText::new(tr("Click or Escape closes it")).weak().size(12.0));
        });
        frame.response.interact(Sense::click())
    });
    card.inner.on_hover_cursor(egui::CursorIcon::PointingHand).clicked()
}
