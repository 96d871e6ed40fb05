//! Values at the point under the pointer, and at a pinned point.

use egui::{Grid, Window};
use nalgebra::Matrix2;

use crate::app::interface::*;
use crate::simulation::PointState;

/// Returns the weighted sum of `positions` at a material point: its position if these are the nodes' positions, m.
pub(crate) fn place(mesh: &Mesh, positions: &[Vector2<f64>], point: MaterialPoint) -> Option<Vector2<f64>> {
    mesh.weights(point)?.iter().map(|&(n, w)| Some(positions.get(n as usize)? * w)).sum()
}

pub(super) fn metres(v: Vector2<f64>) -> String {
    engineering_pair([v.x, v.y].map(three_digits), "m")
}

fn matrix_rows(m: &Matrix2<f64>) -> String {
    // Adding 0 removes the sign of -0.
    let number = |v: f64| format!("{:>8}", format!("{:.4}", (1e4 * v).round() / 1e4 + 0.0));
    format!("{} {}\n{} {}", number(m.m11), number(m.m12), number(m.m21), number(m.m22))
}

/// Choices of the user on the cards of points.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CardChoice {
    /// `true` if stresses are in the axes x and y of the material at rest, rotated by R; they are in those of space else.
    in_material: bool,
    shows_matrices: bool,
}

/// Row of a card: name, value and tooltip.
type Row = (&'static str, String, &'static str);

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
    let mut rows = vec![("u", metres(point.displacement), "Displacement")];
    if !point.is_linear {
        rows.push(("θ", none(one(Field::RotationAngle)), "Angle of the rotation R"));
    }
    let principal = two(Field::LargerPrincipalStress, Field::SmallerPrincipalStress);
    let direction = principal_direction(point).filter(|_| !rotates);
    let direction = direction.map_or_else(String::new, |angle| format!(", {:.0}°", angle.to_degrees().round() + 0.0));
    let out_of_plane = point.cauchy.map(|stress| stress.zz).filter(|stress| *stress != 0.0);
    let normal =
        out_of_plane.map(|stress| ("σ_z", engineering(three_digits(stress), "Pa"), "Cauchy stress out of the plane"));
    let stress = "Cauchy stress, which follows from ε";
    rows.extend([(stresses, none(two(x, y)), stress), (shear_stress, none(one(xy)), stress)]);
    rows.extend(normal);
    let of_principal = "Principal stresses in the plane, and the direction of the larger one; drawn at the point";
    let principal_strains = two(Field::LargerPrincipalStrain, Field::SmallerPrincipalStrain);
    rows.extend([
        ("σ_1, σ_2", none(principal) + &direction, of_principal),
        ("von Mises", none(one(Field::VonMises)), "Von Mises stress, from the Cauchy stress, which follows from ε"),
        (strains, none(two(Field::StrainX, Field::StrainY)), strain),
        (shear_strain, none(one(Field::ShearStrain)), strain),
        ("ε_1, ε_2", none(principal_strains), "Principal strains in the plane"),
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

/// Shows the card of a pinned point at a position in the window, which the user can move in the `view`; the scene has a
/// probe there if it `is_kept`. Returns `true` if a probe is to be added to the scene at the point, and `None` if the user
/// has closed the card.
pub(crate) fn show_card(
    painter: &Painter,
    visuals: &Visuals,
    view: Rect,
    (state, at, is_kept): (&PointState, Pos2, bool),
    choice: &mut CardChoice,
) -> Option<bool> {
    /// Room for the line key above a card, space below it, and space between card and point, points.
    const KEY: f32 = 44.0;
    const BESIDE: f32 = 20.0;
    const BELOW: f32 = 14.0;
    /// Usual size of a card, and height of a folded one, points.
    const SIZE: Vec2 = vec2(284.0, 288.0);
    const FOLDED: f32 = 36.0;
    let color = visuals.strong_text_color();
    painter.circle(at, 4.5, Color32::TRANSPARENT, Stroke::new(2.0, color));
    painter.circle_filled(at, 1.5, color);
    paint_principal(painter, at, state, color);
    // Above and to the right of a low point, else below and to the left, where a body that hangs down from its left side
    // is not; on the other side of the point if there is no room.
    let (is_low, room) = (at.y > view.center().y, SIZE.x + BESIDE);
    let is_right = if is_low { at.x + room <= view.right() } else { at.x - room < view.left() };
    let x = if is_right { at.x + BESIDE } else { at.x - room };
    // In a view without room for it, as in Measure, a card begins folded.
    let has_room = view.height() >= SIZE.y + BELOW;
    let height = if has_room { SIZE.y } else { FOLDED };
    let y = if is_low { view.top() + KEY } else { view.bottom() - BELOW - height };
    let title = fill!("Point %{place}", place = metres(state.rest));
    let id = egui::Id::unique(("card", &title, has_room));
    let mut is_open = true;
    let title = RichText::new(title).size(BODY);
    let window = Window::new(title).id(id).open(&mut is_open).resizable(false).default_size(SIZE);
    let window = window.default_open(has_room).default_pos(pos2(x, y)).constrain_to(view);
    let shown = window.show(painter.ctx(), |ui| card_content(ui, state, is_kept, choice));
    if let Some(shown) = &shown {
        painter.line_segment([at, shown.response.rect.clamp(at)], Stroke::new(1.2, color));
    }
    is_open.then(|| shown.and_then(|shown| shown.inner) == Some(true))
}

/// Shows the values of a pinned point, and returns `true` if a probe is to be added there.
fn card_content(ui: &mut Ui, point: &PointState, is_kept: bool, choice: &mut CardChoice) -> bool {
    ui.spacing_mut().item_spacing.y = 3.0;
    let (kind, tip) = match point.values {
        PointValues::Recovered => (
            "recovered at the nodes",
            "Smoothed values: strain and rotation of the surrounding elements, fitted at the nodes",
        ),
        PointValues::Raw => ("element value, not smoothed", "Strain and rotation of the element itself, not smoothed"),
    };
    ui.label(RichText::new(tr(kind)).weak().size(12.0)).on_hover_text(tr(tip));
    // In linear theory the axes of the material do not rotate.
    if !point.is_linear {
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
            for (name, text, tip) in rows_of(point, choice.in_material) {
                ui.label(RichText::new(tr(name)).weak()).on_hover_text(tr(tip));
                ui.label(text).on_hover_text(tr(tip));
                ui.end_row();
            }
        });
    });
    let matrices = [
        ("F", point.gradient, "Deformation gradient ∂x/∂X"),
        ("R", point.rotation.matrix(), "Rotation of the polar decomposition F = R S"),
        ("S", point.stretch, "Stretch of the polar decomposition F = R S"),
    ];
    // Linear theory has neither R nor S.
    let matrices = if point.is_linear { &matrices[..1] } else { &matrices };
    let keeps = ui.horizontal(|ui| {
        let tip = "Adds a probe here: it is saved with the scene, and has a row in Details and in Compare";
        let keeps = !is_kept && ui.button(tr("Keep as probe")).on_hover_text(tr(tip)).clicked();
        let names = matrices.iter().map(|(name, ..)| *name).collect::<Vec<_>>().join(", ");
        ui.toggle_value(&mut choice.shows_matrices, names).on_hover_text(tr("Shows these matrices"));
        keeps
    });
    if choice.shows_matrices {
        Grid::new("probe matrices").spacing([12.0, 3.0]).show(ui, |ui| {
            for (name, matrix, tip) in matrices {
                ui.label(RichText::new(*name).weak()).on_hover_text(tr(tip));
                ui.label(RichText::new(matrix_rows(matrix)).monospace().size(12.0)).on_hover_text(tr(tip));
                ui.end_row();
            }
        });
    }
    keeps.inner
}
