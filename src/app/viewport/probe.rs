//! Values at the point under the pointer, and at a pinned point.

use egui::{Area, Grid, Order};
use nalgebra::Matrix2;

use crate::app::interface::*;
use crate::simulation::PointState;

/// Returns the weighted sum of `positions` at a material point: its position if these are the nodes' positions, m.
pub(crate) fn place(mesh: &Mesh, positions: &[Vector2<f64>], point: MaterialPoint) -> Option<Vector2<f64>> {
    mesh.weights(point)?.iter().map(|&(n, w)| Some(positions.get(n as usize)? * w)).sum()
}

/// Formats a value of a field with its unit.
fn field_text((field, value): (Field, Option<f64>)) -> String {
    let (factor, unit) = field.display_unit();
    let unknown = if unit == "Pa" { "not defined: crushed or inverted here" } else { "unknown" };
    value.map_or_else(|| tr(unknown).to_owned(), |value| engineering(three_digits(factor * value), unit))
}

/// Paints the value of the field and the displacement next to the pointer.
pub(crate) fn paint_hover(ui: &Ui, painter: &Painter, at: Pos2, field: (Field, Option<f64>), u: Vector2<f64>) {
    let text = format!("{}: {}\nu = {}", tr(field.0.name()), field_text(field), metres(u));
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

/// Sizes of a card while its matrices are folded, points: with the value of the displayed field and the displacement, and
/// with all values.
const FEW: Vec2 = vec2(324.0, 110.0);
const ALL: Vec2 = vec2(300.0, 262.0);
/// Room for the line key above a card, and for the scale and the colour bar below, points.
const KEY: f32 = 44.0;
const SCALE_AND_BAR: f32 = 84.0;

/// Choices of the user on the cards of points.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CardChoice {
    /// `true` if stresses are in the axes x and y of the material at rest, rotated by R; they are in those of space else.
    in_material: bool,
    /// `true` if all values are shown where they hide much of the body too.
    pub shows_all: bool,
    shows_matrices: bool,
}

/// Request of a card.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum CardRequest {
    /// Closes the card.
    Close,
    /// Adds a probe to the scene at the point.
    Keep,
}

/// Row of a card: name, value and tooltip.
type Row = (&'static str, String, &'static str);

fn displacement_row(point: &PointState) -> Row {
    ("u", metres(point.displacement), "Displacement")
}

/// Returns the values of a point, with the stresses in the axes of space or of the material.
fn rows_of(point: &PointState, in_material: bool) -> Vec<Row> {
    let get = |field: Field| point.field(field).map(|v| three_digits(field.display_unit().0 * v));
    let one = |field: Field| get(field).map(|v| engineering(v, field.display_unit().1));
    let two = |a: Field, b: Field| Some(engineering_pair([get(a)?, get(b)?], a.display_unit().1));
    let none = |text: Option<String>| text.unwrap_or_else(|| tr("none").to_owned());
    let (x, y, xy) = match in_material {
        true => (Field::MaterialStressX, Field::MaterialStressY, Field::MaterialShearStress),
        false => (Field::StressX, Field::StressY, Field::ShearStress),
    };
    // Capitals are the axes of the material, which rotate with it.
    let rotates = in_material && !point.is_linear;
    let [stresses, shear_stress] = if rotates { ["σ_X, σ_Y", "τ_XY"] } else { ["σ_x, σ_y", "τ_xy"] };
    let ([strains, shear_strain], strain) = if point.is_linear {
        (["ε_x, ε_y", "γ_xy"], "Strain ε = sym F − I of linear theory")
    } else {
        (["ε_X, ε_Y", "γ_XY"], "Strain ε = S − I, in the axes X, Y of the material")
    };
    let mut rows = vec![displacement_row(point)];
    if !point.is_linear {
        rows.push(("θ", none(one(Field::RotationAngle)), "Angle of the rotation R"));
    }
    let principal = two(Field::LargerPrincipalStress, Field::SmallerPrincipalStress);
    let direction = principal_direction(point).filter(|_| !rotates);
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

/// Returns points that are spread over triangles evenly: centroids and the middles of edges.
pub(crate) fn spread(corners: &[Pos2], triangles: &[[u32; 3]]) -> Vec<Pos2> {
    let corner = |p: u32| corners.get(p as usize).map(|at| at.to_vec2());
    let of = |&[a, b, c]: &[u32; 3]| {
        let [a, b, c] = [corner(a)?, corner(b)?, corner(c)?];
        Some([(a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0, (a + b + c) / 3.0])
    };
    triangles.iter().filter_map(of).flatten().map(Vec2::to_pos2).collect()
}

/// Place of the card of a pinned point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PointCard {
    pub point: MaterialPoint,
    view: Rect,
    shows_all: bool,
    size: Vec2,
    align: Align2,
}

impl PointCard {
    /// Places a card in a view where it hides least: not its point at `at`, as few of the points spread over a body as
    /// possible, and the `tips` of arrows only for many of these. It has few values if all would hide much of the body, or
    /// are higher than the view, and the user has not asked for them. All positions are in the window.
    pub(crate) fn new(
        point: MaterialPoint,
        view: Rect,
        choice: CardChoice,
        (body, at, tips): (&[Pos2], Pos2, &[Pos2]),
    ) -> Self {
        /// Part of a body for which a tip is hidden.
        const TIP: f32 = 0.15;
        /// Part of a body that all values may hide.
        const HIDDEN: f32 = 0.1;
        let hidden = |points: &[Pos2], card: Rect| points.iter().filter(|at| card.contains(**at)).count() as f32;
        let best = |size: Vec2| {
            let card = PointCard { point, view, shows_all: choice.shows_all, size, align: Align2::RIGHT_TOP };
            let corners = [Align2::RIGHT_TOP, Align2::RIGHT_BOTTOM, Align2::LEFT_BOTTOM, Align2::LEFT_TOP];
            let aligned = corners.into_iter().map(|align| {
                let card = PointCard { align, ..card };
                let area = card.area();
                let part = hidden(body, area) / body.len().max(1) as f32;
                (card, if area.contains(at) { f32::INFINITY } else { part }, TIP * hidden(tips, area))
            });
            let least = aligned.min_by(|a, b| (a.1 + a.2).total_cmp(&(b.1 + b.2)));
            least.map_or((card, 0.0), |(card, part, _)| (card, part))
        };
        let (all, part) = best(ALL);
        let fits = part <= HIDDEN && view.height() >= ALL.y + KEY + SCALE_AND_BAR;
        if choice.shows_all || fits { all } else { best(FEW).0 }
    }

    /// Returns `true` if the card was placed for the point, the view and the choice, and does not cover the point, which is
    /// at `at` in the window.
    pub(crate) fn suits(&self, point: MaterialPoint, view: Rect, choice: CardChoice, at: Pos2) -> bool {
        (self.point, self.view, self.shows_all) == (point, view, choice.shows_all) && !self.area().contains(at)
    }

    /// Returns the position of the aligned point of the card, in the window.
    fn position(&self) -> Pos2 {
        const SIDE: f32 = 14.0;
        // All values that the user asks for hide the key and the bar rather than the body.
        let (above, below) = if self.shows_all { (SIDE, SIDE) } else { (KEY, SCALE_AND_BAR) };
        self.align
            .pos_in_rect(&Rect::from_min_max(self.view.min + vec2(SIDE, above), self.view.max - vec2(SIDE, below)))
    }

    /// Returns the area of the card in the window while its matrices are folded.
    fn area(&self) -> Rect {
        self.align.anchor_size(self.position(), self.size)
    }
}

/// Pinned point.
pub(crate) struct Pinned<'a> {
    /// Values at the point.
    pub state: &'a PointState,
    /// Displayed field, and its value at the point.
    pub field: (Field, Option<f64>),
    /// Position in the window.
    pub at: Pos2,
    /// `true` if the scene has a probe there.
    pub is_kept: bool,
}

/// Shows the card of a pinned point.
pub(crate) fn show_card(
    ui: &Ui,
    painter: &Painter,
    card: PointCard,
    pinned: &Pinned<'_>,
    choice: &mut CardChoice,
) -> Option<CardRequest> {
    let (id, at) = (egui::Id::unique("probe"), pinned.at);
    let visuals = ui.visuals();
    let color = visuals.strong_text_color();
    let area = ui.memory(|memory| memory.area_rect(id)).unwrap_or(card.area());
    painter.line_segment([at, area.clamp(at)], Stroke::new(1.2, color));
    painter.circle(at, 4.5, Color32::TRANSPARENT, Stroke::new(2.0, color));
    painter.circle_filled(at, 1.5, color);
    paint_principal(painter, at, pinned.state, color);
    let area = Area::new(id).order(Order::Middle).pivot(card.align).fixed_pos(card.position()).constrain_to(card.view);
    let shown = area.show(ui.ctx(), |ui| {
        Frame::popup(ui.style()).show(ui, |ui| card_content(ui, card.size == FEW, pinned, choice)).inner
    });
    shown.inner
}

fn card_content(ui: &mut Ui, is_short: bool, pinned: &Pinned<'_>, choice: &mut CardChoice) -> Option<CardRequest> {
    let (point, mut request) = (pinned.state, None);
    ui.spacing_mut().item_spacing.y = 3.0;
    let title = fill!("Point %{place}", place = metres(point.rest));
    let (kind, tip) = match point.values {
        PointValues::Recovered => (
            "recovered at the nodes",
            "Smoothed values: strain and rotation of the surrounding elements, fitted at the nodes",
        ),
        PointValues::Raw => ("element value, not smoothed", "Strain and rotation of the element itself, not smoothed"),
    };
    let matrices = matrices_of(point);
    let rows = rows_of(point, choice.in_material);
    ui.horizontal(|ui| {
        ui.strong(&title);
        let close = ui.small_button("×").on_hover_text(tr("Click or Escape closes it"));
        close.widget_info(|| WidgetInfo::labeled(Role::Button, true, tr("Close the card")));
        if close.clicked() {
            request = Some(CardRequest::Close);
        }
        ui.label(RichText::new(tr(kind)).weak().size(12.0)).on_hover_text(tr(tip));
    });
    let few = [(pinned.field.0.name(), field_text(pinned.field), "Value of the colour"), displacement_row(point)];
    let shown: &[Row] = if is_short { &few } else { &rows };
    // In linear theory the axes of the material do not rotate.
    if !is_short && !point.is_linear {
        ui.horizontal(|ui| {
            ui.label(RichText::new(tr("Stress in the axes of")).weak().size(12.0));
            for (own, name) in [(false, "space x, y"), (true, "material X, Y")] {
                ui.selectable_value(&mut choice.in_material, own, RichText::new(tr(name)).size(12.0));
            }
        });
    }
    ui.scope(|ui| {
        // Rows of text need less height than those of controls.
        ui.spacing_mut().interact_size.y = 16.0;
        Grid::new("probe values").num_columns(2).spacing([12.0, 1.0]).show(ui, |ui| {
            for (name, text, tip) in shown {
                ui.label(RichText::new(tr(name)).weak()).on_hover_text(tr(tip));
                ui.label(text).on_hover_text(tr(tip));
                ui.end_row();
            }
        });
    });
    ui.horizontal(|ui| {
        let tip = "Adds a probe here: it is saved with the scene, and has a row in Details and in Compare";
        if !pinned.is_kept && ui.button(tr("Keep as probe")).on_hover_text(tr(tip)).clicked() {
            request = Some(CardRequest::Keep);
        }
        if is_short || choice.shows_all {
            let tip = "Shows all values, over the body too";
            ui.toggle_value(&mut choice.shows_all, tr("All values")).on_hover_text(tr(tip));
        }
        if !is_short {
            let names = matrices.iter().map(|(name, ..)| *name).collect::<Vec<_>>().join(", ");
            ui.toggle_value(&mut choice.shows_matrices, names).on_hover_text(tr("Shows these matrices"));
        }
    });
    if choice.shows_matrices && !is_short {
        Grid::new("probe matrices").spacing([12.0, 3.0]).show(ui, |ui| {
            for (name, matrix, tip) in &matrices {
                ui.label(RichText::new(*name).weak()).on_hover_text(tr(tip));
                ui.label(RichText::new(matrix_rows(matrix)).monospace().size(12.0)).on_hover_text(tr(tip));
                ui.end_row();
            }
        });
    }
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
        let point = MaterialPoint { element: 0, at: [0.3; 2] };
        for &at in &nodes {
            let card = PointCard::new(point, view, CardChoice::default(), (&nodes, at, &[tip]));
            assert_eq!(card.size, ALL);
            let card = card.area();
            assert!(nodes.iter().chain([&tip]).all(|at| !card.contains(*at)), "{at:?}: {card:?}");
        }
    }
}
