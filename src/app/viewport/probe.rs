//! Values at the point under the pointer, and at a pinned point.

use egui::{
    Align2, Area, Color32, Frame, Grid, Order, Painter, Pos2, Rect, RichText, Role, Stroke, Ui, Vec2, WidgetInfo, vec2,
};
use nalgebra::{Matrix2, Vector2};

use crate::app::language::{fill, tr};
use crate::app::widgets::text::boxed_text;
use crate::format::{engineering, engineering_pair, three_digits};
use crate::mesh::{MaterialPoint, Mesh};
use crate::simulation::{Field, PointState, PointValues};

/// Size of the card of a point while its matrices are folded, points; of a card in a low view, whose values are in two
/// columns.
const CARD: Vec2 = vec2(300.0, 262.0);
const LOW_CARD: Vec2 = vec2(520.0, 148.0);
/// Height below which a view is low, and the smallest width of one in which a card has two columns, points.
const LOW: Vec2 = vec2(600.0, 520.0);
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
fn matrix_rows(m: &Matrix2<f64>) -> String {
    // Adding 0 removes the sign of -0.
    let number = |v: f64| format!("{:>8}", format!("{:.4}", (1e4 * v).round() / 1e4 + 0.0));
    format!("{} {}\n{} {}", number(m.m11), number(m.m12), number(m.m21), number(m.m22))
}

/// Axes of the stresses on a card.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Axes {
    /// x and y of space.
    #[default]
    Space,
    /// x and y of the material at rest, rotated by R.
    Material,
}

/// Request of a card.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum CardRequest {
    /// Closes the card.
    Close,
    /// Copies the values as text.
    Copy(String),
    /// Adds a probe to the scene at the point.
    Keep,
}

/// Row of a card: name, value and tooltip.
type Row = (&'static str, String, &'static str);

/// Returns the values of a point, with the stresses in these axes.
fn rows_of(point: &PointState, axes: Axes) -> Vec<Row> {
    let get = |field: Field| point.field(field).map(|v| three_digits(field.display_unit().0 * v));
    let one = |field: Field| get(field).map(|v| engineering(v, field.display_unit().1));
    let two = |a: Field, b: Field| Some(engineering_pair([get(a)?, get(b)?], a.display_unit().1));
    let none = |text: Option<String>| text.unwrap_or_else(|| tr("none").to_owned());
    let (x, y, xy) = match axes {
        Axes::Space => (Field::StressX, Field::StressY, Field::ShearStress),
        Axes::Material => (Field::MaterialStressX, Field::MaterialStressY, Field::MaterialShearStress),
    };
    // Capitals are the axes of the material, which rotate with it.
    let [stresses, shear_stress] = match axes {
        Axes::Material if !point.is_linear => ["σ_X, σ_Y", "τ_XY"],
        _ => ["σ_x, σ_y", "τ_xy"],
    };
    let ([strains, shear_strain], strain) = if point.is_linear {
        (["ε_x, ε_y", "γ_xy"], "Strain ε = sym F − I of linear theory")
    } else {
        (["ε_X, ε_Y", "γ_XY"], "Strain ε = S − I, in the axes X, Y of the material")
    };
    let mut rows = vec![("u", metres(point.displacement), "Displacement")];
    if !point.is_linear {
        rows.push(("θ", none(one(Field::RotationAngle)), "Angle of the rotation R"));
    }
    let principal = two(Field::LargerPrincipalStress, Field::SmallerPrincipalStress);
    let direction = principal_direction(point).filter(|_| axes == Axes::Space || point.is_linear);
    let direction = direction.map_or_else(String::new, |angle| format!(", {:.0}°", angle.to_degrees().round() + 0.0));
    let out_of_plane = point.cauchy.map(|stress| stress.zz).filter(|stress| *stress != 0.0);
    let normal =
        out_of_plane.map(|stress| ("σ_z", engineering(three_digits(stress), "Pa"), "Cauchy stress out of the plane"));
    rows.extend([
        (stresses, none(two(x, y)), "Cauchy stress, which follows from ε"),
        (shear_stress, none(one(xy)), "Cauchy stress, which follows from ε"),
    ]);
    rows.extend(normal);
    rows.extend([
        (
            "σ_1, σ_2",
            none(principal) + &direction,
            "Principal stresses in the plane, and the direction of the larger one; drawn at the point",
        ),
        ("von Mises", none(one(Field::VonMises)), "Von Mises stress, from the Cauchy stress, which follows from ε"),
        (strains, none(two(Field::StrainX, Field::StrainY)), strain),
        (shear_strain, none(one(Field::ShearStrain)), strain),
        (
            "ε_1, ε_2",
            none(two(Field::LargerPrincipalStrain, Field::SmallerPrincipalStrain)),
            "Principal strains in the plane",
        ),
        ("ψ", none(one(Field::EnergyDensity)), "Strain energy density"),
    ]);
    rows
}

/// Returns the angle of the larger principal stress in space, from −90° to 90°, rad.
fn principal_direction(point: &PointState) -> Option<f64> {
    let stress = point.cauchy?.plane;
    Some(0.5 * (2.0 * stress.m12).atan2(stress.m11 - stress.m22))
}

/// Paints the principal stresses at a point: arrows outwards for tension, inwards for compression.
fn paint_principal(painter: &Painter, at: Pos2, point: &PointState, color: Color32) {
    const LONGEST: f32 = 30.0;
    const HEAD: f32 = 5.0;
    let stresses = [Field::LargerPrincipalStress, Field::SmallerPrincipalStress].map(|field| point.field(field));
    let ([Some(larger), Some(smaller)], Some(angle)) = (stresses, principal_direction(point)) else { return };
    let largest = larger.abs().max(smaller.abs());
    let stroke = Stroke::new(1.5, color);
    for (value, angle) in [(larger, angle), (smaller, angle + std::f64::consts::FRAC_PI_2)] {
        let length = (value.abs() / largest) as f32 * LONGEST;
        let axis = vec2(angle.cos() as f32, -angle.sin() as f32);
        // Arrows that are shorter than their heads would look like points.
        if !(axis * length).is_finite() || length < 2.0 * HEAD {
            continue;
        }
        for axis in [axis, -axis] {
            let (near, far) = (at + axis * 8.0, at + axis * (8.0 + length));
            painter.line_segment([near, far], stroke);
            let (tip, back) = if value > 0.0 { (far, -axis) } else { (near, axis) };
            for side in [back.rot90(), -back.rot90()] {
                painter.line_segment([tip, tip + (back + side * 0.6) * HEAD], stroke);
            }
        }
    }
}

/// Returns the number of columns of values on a card in a view.
fn card_columns(view: Rect) -> usize {
    if view.height() < LOW.y && view.width() >= LOW.x { 2 } else { 1 }
}

/// Returns the size of a card in a view, points.
fn card_size(view: Rect) -> Vec2 {
    if card_columns(view) == 1 { CARD } else { LOW_CARD }
}

/// Returns the position of a card with this alignment in a view.
fn card_position(view: Rect, align: Align2) -> Pos2 {
    /// Room for the line key above, and for the colour bar and the status in the lower corners, points.
    const ABOVE: f32 = 44.0;
    const CORNER: f32 = 84.0;
    const SIDE: f32 = 14.0;
    let ([left, right], below) =
        if align == Align2::CENTER_BOTTOM { (beside(view), SIDE) } else { ([SIDE; 2], CORNER) };
    align.pos_in_rect(&Rect::from_min_max(view.min + vec2(left, ABOVE), view.max - vec2(right, below)))
}

/// Returns the room left and right of a card at the lower side of a view for the status and the colour bar, points. In
/// a low view the status is in the bar below, and the scale alone is in the left corner.
fn beside(view: Rect) -> [f32; 2] {
    const BAR: f32 = 290.0;
    const SCALE: f32 = 96.0;
    [if card_columns(view) == 2 { SCALE } else { BAR }, BAR]
}

/// Returns the alignment in a view with which a card hides least: not its point at `at`, as few of the points of a body as
/// possible, and the `tips` of arrows only for many of these. All positions are in the window.
pub(crate) fn card_align(view: Rect, body: &[Pos2], at: Pos2, tips: &[Pos2]) -> Align2 {
    /// Part of a body for which a tip is hidden.
    const TIP: f32 = 0.15;
    let size = card_size(view);
    let corners = [Align2::RIGHT_TOP, Align2::RIGHT_BOTTOM, Align2::LEFT_BOTTOM, Align2::LEFT_TOP];
    let middle = Some(Align2::CENTER_BOTTOM).filter(|_| view.width() >= beside(view).iter().sum::<f32>() + size.x);
    let cost = |align: Align2| {
        let card = align.anchor_size(card_position(view, align), size);
        let hidden = |points: &[Pos2]| points.iter().filter(|at| card.contains(**at)).count() as f32;
        let part = hidden(body) / body.len().max(1) as f32;
        if card.contains(at) { f32::INFINITY } else { part + TIP * hidden(tips) }
    };
    let costs = corners.into_iter().chain(middle).map(|align| (align, cost(align)));
    costs.min_by(|(_, a), (_, b)| a.total_cmp(b)).map_or(Align2::RIGHT_TOP, |(align, _)| align)
}

/// Shows the card of a pinned point at the window position `at`, with this alignment in the view. `is_kept` is `true` if
/// the scene has a probe there.
pub(crate) fn show_card(
    ui: &Ui,
    painter: &Painter,
    (view, at): (Rect, Pos2),
    align: Align2,
    (point, is_kept): (&PointState, bool),
    axes: &mut Axes,
) -> Option<CardRequest> {
    let visuals = ui.visuals();
    let color = visuals.strong_text_color();
    let (id, position) = (egui::Id::unique("probe"), card_position(view, align));
    let card = ui.memory(|memory| memory.area_rect(id)).unwrap_or(align.anchor_size(position, card_size(view)));
    painter.line_segment([at, card.clamp(at)], Stroke::new(1.2, color));
    painter.circle(at, 4.5, Color32::TRANSPARENT, Stroke::new(2.0, color));
    painter.circle_filled(at, 1.5, color);
    paint_principal(painter, at, point, color);
    let area = Area::new(id).order(Order::Middle).pivot(align).fixed_pos(position).constrain_to(view);
    let card = area.show(ui.ctx(), |ui| {
        Frame::popup(ui.style()).show(ui, |ui| card_content(ui, (point, is_kept), card_columns(view), axes)).inner
    });
    card.inner
}

fn card_content(
    ui: &mut Ui,
    (point, is_kept): (&PointState, bool),
    columns: usize,
    axes: &mut Axes,
) -> Option<CardRequest> {
    let mut request = None;
    ui.spacing_mut().item_spacing.y = 3.0;
    let title = fill!("Point %{place}", place = metres(point.rest));
    let (kind, tip) = match point.values {
        PointValues::Recovered => (
            "recovered at the nodes",
            "Smoothed values: strain and rotation of the surrounding elements, fitted at the nodes",
        ),
        PointValues::Raw => ("element value, not smoothed", "Strain and rotation of the element itself, not smoothed"),
    };
    let id = egui::Id::unique("probe matrices");
    let mut shows_matrices = ui.memory(|memory| memory.data.get_temp(id)).unwrap_or(false);
    let matrices = matrices_of(point);
    let rows = rows_of(point, *axes);
    let mut buttons = |ui: &mut Ui, axes: Axes| {
        if ui.button(tr("Copy")).on_hover_text(tr("Copies the values as text")).clicked() {
            return Some(CardRequest::Copy(copied_text(&title, point, axes, &rows)));
        }
        let tip = "Adds a probe here: it is saved with the scene, and has a row in Details and in Compare";
        if !is_kept && ui.button(tr("Keep as probe")).on_hover_text(tr(tip)).clicked() {
            return Some(CardRequest::Keep);
        }
        let names = matrices.iter().map(|(name, ..)| *name).collect::<Vec<_>>().join(", ");
        ui.toggle_value(&mut shows_matrices, names).on_hover_text(tr("Shows these matrices"));
        None
    };
    ui.horizontal(|ui| {
        ui.strong(&title);
        let close = ui.small_button("×").on_hover_text(tr("Click or Escape closes it"));
        close.widget_info(|| WidgetInfo::labeled(Role::Button, true, tr("Close the card")));
        if close.clicked() {
            request = Some(CardRequest::Close);
        }
        ui.label(RichText::new(tr(kind)).weak().size(12.0)).on_hover_text(tr(tip));
        if columns > 1 {
            request = request.take().or(buttons(ui, *axes));
        }
    });
    // In linear theory the axes of the material do not rotate.
    if !point.is_linear {
        ui.horizontal(|ui| {
            ui.label(RichText::new(tr("Stress in the axes of")).weak().size(12.0));
            for (own, name) in [(Axes::Space, "space x, y"), (Axes::Material, "material X, Y")] {
                ui.selectable_value(axes, own, RichText::new(tr(name)).size(12.0));
            }
        });
    }
    ui.scope(|ui| {
        // Rows of text need less height than those of controls.
        ui.spacing_mut().interact_size.y = 16.0;
        let height = rows.len().div_ceil(columns);
        Grid::new("probe values").num_columns(2 * columns).spacing([12.0, 1.0]).show(ui, |ui| {
            for row in 0..height {
                for (name, text, tip) in rows.iter().skip(row).step_by(height) {
                    ui.label(RichText::new(tr(name)).weak()).on_hover_text(tr(tip));
                    ui.label(text).on_hover_text(tr(tip));
                }
                ui.end_row();
            }
        });
    });
    if columns == 1 {
        ui.horizontal(|ui| request = request.take().or(buttons(ui, *axes)));
    }
    if shows_matrices {
        Grid::new("probe matrices").spacing([12.0, 3.0]).show(ui, |ui| {
            for (name, matrix, tip) in &matrices {
                ui.label(RichText::new(*name).weak()).on_hover_text(tr(tip));
                ui.label(RichText::new(matrix_rows(matrix)).monospace().size(12.0)).on_hover_text(tr(tip));
                if columns == 1 {
                    ui.end_row();
                }
            }
        });
    }
    ui.memory_mut(|memory| memory.data.insert_temp(id, shows_matrices));
    request
}

/// Returns the matrices of a point, with their names and tooltips.
fn matrices_of(point: &PointState) -> Vec<(&'static str, Matrix2<f64>, &'static str)> {
    let mut matrices = vec![
        ("F", point.gradient, "Deformation gradient ∂x/∂X"),
        ("R", point.rotation.matrix(), "Rotation of the polar decomposition F = R S"),
        ("S", point.stretch, "Stretch of the polar decomposition F = R S"),
    ];
    // Linear theory has neither R nor S.
    matrices.truncate(if point.is_linear { 1 } else { 3 });
    matrices
}

/// Returns the values of a card as text, one on each line.
fn copied_text(title: &str, point: &PointState, axes: Axes, rows: &[Row]) -> String {
    let axes = match axes {
        _ if point.is_linear => None,
        Axes::Space => Some("space x, y"),
        Axes::Material => Some("material X, Y"),
    };
    let axes = axes.map(|name| format!("{}\t{}", tr("Stress in the axes of"), tr(name)));
    let rows = rows.iter().map(|(name, text, _)| format!("{}\t{text}", tr(name)));
    std::iter::once(title.to_owned()).chain(axes).chain(rows).map(|line| line + "\n").collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    /// Whatever point of a beam is pinned, its card hides neither the beam nor the tip of its force.
    #[test]
    fn a_card_hides_nothing() {
        let view = Rect::from_min_max(pos2(0.0, 36.0), pos2(996.0, 738.0));
        let nodes = (0..=40_u8).flat_map(|i| [330.0, 374.0].map(|y| pos2(76.0 + 21.0 * f32::from(i), y)));
        let (nodes, tip) = (nodes.collect::<Vec<_>>(), pos2(919.0, 422.0));
        for &at in &nodes {
            let align = card_align(view, &nodes, at, &[tip]);
            let card = align.anchor_size(card_position(view, align), card_size(view));
            assert!(nodes.iter().chain([&tip]).all(|at| !card.contains(*at)), "{at:?}: {card:?}");
        }
    }

    /// In a low view a card hides the tip of an arrow rather than a part of the beam.
    #[test]
    fn a_card_in_a_low_view_hides_nothing_of_a_beam() {
        let view = Rect::from_min_max(pos2(0.0, 36.0), pos2(996.0, 456.0));
        let nodes = (0..=40_u8).flat_map(|i| [196.0, 216.0, 236.0].map(|y| pos2(76.0 + 21.0 * f32::from(i), y)));
        let (nodes, tips) = (nodes.collect::<Vec<_>>(), [pos2(919.0, 290.0), pos2(490.0, 290.0)]);
        for &at in &nodes {
            let align = card_align(view, &nodes, at, &tips);
            let card = align.anchor_size(card_position(view, align), card_size(view));
            assert!(nodes.iter().all(|at| !card.contains(*at)), "{at:?}: {card:?}");
        }
    }
}
