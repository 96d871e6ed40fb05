//! Values at the point under the pointer, and at a pinned point.

use egui::{
    Align2, Area, Color32, Frame, Grid, Order, Painter, Pos2, Rect, RichText, Role, Stroke, Ui, Vec2, WidgetInfo, vec2,
};
use nalgebra::{Matrix2, Vector2};

use crate::app::language::{fill, tr};
use crate::app::widgets::legend;
use crate::app::widgets::text::boxed_text;
use crate::format::{engineering, engineering_pair, three_digits};
use crate::mesh::{MaterialPoint, Mesh};
use crate::simulation::{Field, PointState, PointValues};

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

/// Arrangement of the values on the card of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    /// The value of the displayed field, and the displacement.
    Short,
    /// All values in one column.
    Tall,
    /// All values in two columns.
    Wide,
}

impl Form {
    /// Returns the form with all values that fits a view.
    fn of_all(view: Rect) -> Self {
        /// Height below which a view is low, and the smallest width of one for two columns, points.
        const LOW: Vec2 = vec2(600.0, 520.0);
        if view.height() < LOW.y && view.width() >= LOW.x { Form::Wide } else { Form::Tall }
    }

    /// Returns the size of a card while its matrices are folded, points.
    fn size(self) -> Vec2 {
        match self {
            Form::Short => vec2(300.0, 88.0),
            Form::Tall => vec2(300.0, 262.0),
            Form::Wide => vec2(520.0, 148.0),
        }
    }

    /// Returns the alignments of a card in a view.
    fn alignments(self, view: Rect) -> impl Iterator<Item = Align2> {
        let corners = [Align2::RIGHT_TOP, Align2::RIGHT_BOTTOM, Align2::LEFT_BOTTOM, Align2::LEFT_TOP];
        let room = view.width() - self.beside().iter().sum::<f32>();
        corners.into_iter().chain(Some(Align2::CENTER_BOTTOM).filter(|_| room >= self.size().x))
    }

    /// Returns the room left and right of a card at the lower side of a view for the status and the colour bar, points.
    /// In a low view the status is in the bar below, and the scale alone is in the left corner.
    fn beside(self) -> [f32; 2] {
        const BAR: f32 = 290.0;
        const SCALE: f32 = 96.0;
        [if self == Form::Wide { SCALE } else { BAR }, BAR]
    }

    /// Returns the number of columns of values.
    fn columns(self) -> usize {
        if self == Form::Wide { 2 } else { 1 }
    }
}

/// Choices of the user on the cards of points.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CardChoice {
    axes: Axes,
    /// `true` if all values are shown where they hide much of the body too.
    shows_all: bool,
    shows_matrices: bool,
}

impl CardChoice {
    /// Begins the card of another point, with as many values as fit.
    pub(crate) fn begin(&mut self) {
        self.shows_all = false;
    }
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

fn displacement_row(point: &PointState) -> Row {
    ("u", metres(point.displacement), "Displacement")
}

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
    let mut rows = vec![displacement_row(point)];
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
    point: MaterialPoint,
    view: Rect,
    shows_all: bool,
    form: Form,
    align: Align2,
}

impl PointCard {
    /// Places a card in a view where it hides least: not its point at `at`, as few of the points spread over a body as
    /// possible, and the `tips` of arrows only for many of these. The form is short if all values would hide much of the
    /// body and the user has not asked for them. All positions are in the window.
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
        let best = |form: Form| {
            let card = PointCard { point, view, shows_all: choice.shows_all, form, align: Align2::RIGHT_TOP };
            let aligned = form.alignments(view).map(|align| {
                let card = PointCard { align, ..card };
                let area = card.area();
                let part = hidden(body, area) / body.len().max(1) as f32;
                (card, if area.contains(at) { f32::INFINITY } else { part }, TIP * hidden(tips, area))
            });
            let least = aligned.min_by(|a, b| (a.1 + a.2).total_cmp(&(b.1 + b.2)));
            least.map_or((card, 0.0), |(card, part, _)| (card, part))
        };
        let (all, part) = best(Form::of_all(view));
        if choice.shows_all || part <= HIDDEN { all } else { best(Form::Short).0 }
    }

    /// Returns `true` if the card is of a point.
    pub(crate) fn is_of(&self, point: MaterialPoint) -> bool {
        self.point == point
    }

    /// Returns `true` if the card was placed for the point, the view and the choice.
    pub(crate) fn is_for(&self, point: MaterialPoint, view: Rect, choice: CardChoice) -> bool {
        (self.point, self.view, self.shows_all) == (point, view, choice.shows_all)
    }

    /// Returns `true` if the card covers a position in the window.
    pub(crate) fn hides(&self, at: Pos2) -> bool {
        self.area().contains(at)
    }

    /// Returns the position of the aligned point of the card, in the window.
    fn position(&self) -> Pos2 {
        /// Room for the line key above, and for a colour bar under it in low views, points.
        const KEY: f32 = 44.0;
        const KEY_AND_BAR: f32 = 68.0;
        /// Room for the scale in the lower left corner, and for it and a colour bar in both lower corners, points.
        const SCALE: f32 = 50.0;
        const SCALE_AND_BAR: f32 = 84.0;
        const SIDE: f32 = 14.0;
        let (view, is_bar_above) = (self.view, legend::has_bar_on_top(self.view.height()));
        let above = match self.form {
            // All values that the user asks for hide the key and the bar rather than the body.
            _ if self.shows_all => SIDE,
            Form::Short if is_bar_above => KEY_AND_BAR,
            _ => KEY,
        };
        let ([left, right], below) = match self.align {
            _ if self.shows_all => ([SIDE; 2], SIDE),
            Align2::CENTER_BOTTOM => (self.form.beside(), SIDE),
            Align2::RIGHT_BOTTOM if is_bar_above => ([SIDE; 2], SIDE),
            _ => ([SIDE; 2], if is_bar_above { SCALE } else { SCALE_AND_BAR }),
        };
        self.align.pos_in_rect(&Rect::from_min_max(view.min + vec2(left, above), view.max - vec2(right, below)))
    }

    /// Returns the area of the card in the window while its matrices are folded.
    fn area(&self) -> Rect {
        self.align.anchor_size(self.position(), self.form.size())
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
    let shown = area
        .show(ui.ctx(), |ui| Frame::popup(ui.style()).show(ui, |ui| card_content(ui, card.form, pinned, choice)).inner);
    shown.inner
}

fn card_content(ui: &mut Ui, form: Form, pinned: &Pinned<'_>, choice: &mut CardChoice) -> Option<CardRequest> {
    let (point, columns, mut request) = (pinned.state, form.columns(), None);
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
    let rows = rows_of(point, choice.axes);
    let buttons = |ui: &mut Ui, choice: &mut CardChoice| {
        if ui.button(tr("Copy")).on_hover_text(tr("Copies all values as text")).clicked() {
            return Some(CardRequest::Copy(copied_text(&title, point, choice.axes, &rows)));
        }
        let tip = "Adds a probe here: it is saved with the scene, and has a row in Details and in Compare";
        if !pinned.is_kept && ui.button(tr("Keep as probe")).on_hover_text(tr(tip)).clicked() {
            return Some(CardRequest::Keep);
        }
        if form == Form::Short || choice.shows_all {
            let tip = "Shows all values, over the body too";
            ui.toggle_value(&mut choice.shows_all, tr("All values")).on_hover_text(tr(tip));
        }
        if form != Form::Short {
            let names = matrices.iter().map(|(name, ..)| *name).collect::<Vec<_>>().join(", ");
            ui.toggle_value(&mut choice.shows_matrices, names).on_hover_text(tr("Shows these matrices"));
        }
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
            request = request.take().or(buttons(ui, choice));
        }
    });
    let few = [(pinned.field.0.name(), field_text(pinned.field), "Value of the colour"), displacement_row(point)];
    let shown: &[Row] = if form == Form::Short { &few } else { &rows };
    // In linear theory the axes of the material do not rotate.
    if form != Form::Short && !point.is_linear {
        ui.horizontal(|ui| {
            ui.label(RichText::new(tr("Stress in the axes of")).weak().size(12.0));
            for (own, name) in [(Axes::Space, "space x, y"), (Axes::Material, "material X, Y")] {
                ui.selectable_value(&mut choice.axes, own, RichText::new(tr(name)).size(12.0));
            }
        });
    }
    ui.scope(|ui| {
        // Rows of text need less height than those of controls.
        ui.spacing_mut().interact_size.y = 16.0;
        let height = shown.len().div_ceil(columns);
        Grid::new("probe values").num_columns(2 * columns).spacing([12.0, 1.0]).show(ui, |ui| {
            for row in 0..height {
                for (name, text, tip) in shown.iter().skip(row).step_by(height) {
                    ui.label(RichText::new(tr(name)).weak()).on_hover_text(tr(tip));
                    ui.label(text).on_hover_text(tr(tip));
                }
                ui.end_row();
            }
        });
    });
    if columns == 1 {
        ui.horizontal(|ui| request = request.take().or(buttons(ui, choice)));
    }
    if choice.shows_matrices && form != Form::Short {
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
        let point = MaterialPoint { element: 0, at: [0.3; 2] };
        for &at in &nodes {
            let card = PointCard::new(point, view, CardChoice::default(), (&nodes, at, &[tip]));
            assert_eq!(card.form, Form::Tall);
            let card = card.area();
            assert!(nodes.iter().chain([&tip]).all(|at| !card.contains(*at)), "{at:?}: {card:?}");
        }
    }

    /// In a low view a card hides the tip of an arrow rather than a part of the beam.
    #[test]
    fn a_card_in_a_low_view_hides_nothing_of_a_beam() {
        let view = Rect::from_min_max(pos2(0.0, 36.0), pos2(996.0, 456.0));
        let nodes = (0..=40_u8).flat_map(|i| [196.0, 216.0, 236.0].map(|y| pos2(76.0 + 21.0 * f32::from(i), y)));
        let (nodes, tips) = (nodes.collect::<Vec<_>>(), [pos2(919.0, 290.0), pos2(490.0, 290.0)]);
        let point = MaterialPoint { element: 0, at: [0.3; 2] };
        for &at in &nodes {
            let card = PointCard::new(point, view, CardChoice::default(), (&nodes, at, &tips));
            assert_eq!(card.form, Form::Wide);
            let card = card.area();
            assert!(nodes.iter().all(|at| !card.contains(*at)), "{at:?}: {card:?}");
        }
    }
}
