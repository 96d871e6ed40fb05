//! Card of the matrices: Ke and R Ke Rᵀ of the selected triangle as coloured cells, and the assembled matrix.

use super::*;
use crate::render::colormap;

/// Sides of a small matrix and of the large one, points.
const SMALL_SIDE: f32 = 120.0;
const LARGE_SIDE: f32 = 146.0;
const GAP: f32 = 18.0;
/// Largest number of unknowns of a body whose matrix is drawn.
const MAX_UNKNOWNS: usize = 96;

pub(super) fn show(ui: &mut Ui, session: &Session, learn: &mut Learn, actions: &mut Vec<Action>) {
    let simulation = session.simulation();
    let triangle = Triangle::of(simulation, learn.picked);
    let stiffness = triangle.and_then(|triangle| Some((triangle, triangle.stiffness(simulation)?)));
    let Some((triangle, stiffness)) = stiffness else {
        return not_triangles(ui, NOT_TRIANGLES, learn, actions);
    };
    let palette = Palette::new(ui.visuals());
    let rotation = simulation.element_rotations().get(learn.picked).copied().unwrap_or(triangle.rotation);
    let rotated = stiffness.rkrt(rotation);
    let largest = stiffness.ke.amax().max(rotated.amax());
    let local = |i: usize| name_of(triangle.unknowns()[i]);
    let room = ui.available_width() - 2.0 * GAP;
    let scale = (room / (2.0 * SMALL_SIDE + LARGE_SIDE)).clamp(0.5, 1.0);
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = GAP;
        for (markup, plain, matrix) in [("K_{e}", "Ke", &stiffness.ke), ("R K_{e} R^{T}", "R Ke RT", &rotated)] {
            ui.vertical(|ui| {
                ui.label(formula::set(markup, palette.text));
                let text = fill!("%{matrix} of triangle %{n}, 6 by 6", matrix = plain, n = learn.picked);
                cells(ui, &palette, (scale * SMALL_SIDE, largest, &text), matrix, &local, &|_, _| true);
            });
        }
        ui.vertical(|ui| whole(ui, session, &palette, scale * LARGE_SIDE, &triangle));
    });
    let (all, free) = (2 * simulation.system().mesh().nodes().len(), simulation.system().dofs());
    let note = fill!(
        "Triangle %{n}: nodes %{nodes}; framed: its blocks. Grey: clamped, %{all} \u{2212} %{clamped} = %{free} \
         unknowns. Red is positive, blue negative.",
        n = learn.picked,
        nodes = triangle.nodes.map(|n| n.to_string()).join(", "),
        all,
        clamped = all - free,
        free,
    );
    ui.add(Label::new(spaced(RichText::new(note), SMALL).small().weak()).wrap());
}

/// Shows the matrix of the body before the supports are applied, and the rows and columns that they remove.
fn whole(ui: &mut Ui, session: &Session, palette: &Palette, side: f32, triangle: &Triangle) {
    let simulation = session.simulation();
    let (pattern, nodes) = (simulation.system().pattern(), simulation.system().mesh().nodes().len());
    let (all, free) = (2 * nodes, pattern.dofs());
    ui.label(formula::set("Σ R K_{e} R^{T}", palette.text));
    let matrix = (all <= MAX_UNKNOWNS).then(|| assembled(simulation)).flatten();
    let Some(matrix) = matrix else {
        ui.label(tr("Too many unknowns to draw."));
        return;
    };
    let mesh = simulation.system().mesh();
    let mut coupled = vec![false; nodes * nodes];
    for element in mesh.elements() {
        for &a in element {
            element.iter().for_each(|&b| coupled[a as usize * nodes + b as usize] = true);
        }
    }
    let stored = |i: usize, j: usize| coupled[(i / 2) * nodes + j / 2];
    let text = fill!("the body's matrix, %{all} by %{all}, of which %{free} by %{free} are left", all, free);
    let rect = cells(ui, palette, (side, matrix.amax(), &text), &matrix, &name_of, &stored);
    let cell = rect.width() / all as f32;
    let block = |i: usize, j: usize, size: f32| {
        Rect::from_min_size(rect.min + vec2(j as f32, i as f32) * cell, vec2(size, size) * cell)
    };
    for unknown in 0..all {
        if pattern.fixed(unknown as u32 / 2)[unknown % 2] {
            let (row, column) = (block(unknown, 0, 1.0), block(0, unknown, 1.0));
            let veil = palette.absent.gamma_multiply(0.55);
            ui.painter().rect_filled(row.with_max_x(rect.right()), 0.0, veil);
            ui.painter().rect_filled(column.with_max_y(rect.bottom()), 0.0, veil);
        }
    }
    for a in triangle.nodes {
        for b in triangle.nodes {
            let frame = block(2 * a as usize, 2 * b as usize, 2.0);
            ui.painter().rect_stroke(frame, 0.0, Stroke::new(1.5, palette.accent), StrokeKind::Inside);
        }
    }
}

fn name_of(unknown: usize) -> String {
    fill!("node %{n} %{axis}", n = unknown / 2, axis = if unknown.is_multiple_of(2) { "x" } else { "y" })
}

/// Shows a matrix as a square of coloured cells with a diverging map about zero; hovering over a cell shows its value.
fn cells(
    ui: &mut Ui,
    palette: &Palette,
    (side, largest, text): (f32, f64, &str),
    matrix: &DMatrix<f64>,
    name: &dyn Fn(usize) -> String,
    stored: &dyn Fn(usize, usize) -> bool,
) -> Rect {
    let count = matrix.nrows();
    let (rect, response) = ui.allocate_exact_size(vec2(side, side), Sense::hover());
    let cell = side / count.max(1) as f32;
    let map = palette.map(Field::RotationAngle);
    let gap = if cell > 12.0 { 1.0 } else { 0.0 };
    ui.painter().rect_filled(rect, 0.0, palette.canvas);
    for i in 0..count {
        for j in 0..count {
            if stored(i, j) {
                let corner = rect.min + vec2(j as f32, i as f32) * cell;
                let own = Rect::from_min_size(corner, vec2(cell - gap, cell - gap));
                // The square root makes small entries visible, too.
                let value = matrix[(i, j)];
                let part = if largest > 0.0 { (value.abs() / largest).sqrt().copysign(value) } else { 0.0 };
                let [r, g, b] = map.color(colormap::position(part, [-1.0, 1.0]));
                ui.painter().rect_filled(own, 0.0, Color32::from_rgb(r, g, b));
            }
        }
    }
    ui.painter().rect_stroke(rect, 0.0, Stroke::new(1.0, palette.secondary), StrokeKind::Outside);
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, text));
    let under = response.hover_pos().map(|at| ((at - rect.min) / cell).floor());
    if let Some((i, j)) = under.map(|at| (at.y as usize, at.x as usize)).filter(|&(i, j)| i < count && j < count) {
        let value = if stored(i, j) { engineering(three_digits(matrix[(i, j)]), "N/m") } else { tr("no entry").into() };
        let places = fill!("force: %{row}, displacement: %{column}", row = name(i), column = name(j));
        response.on_hover_text_at_pointer(format!("{value}\n{places}"));
    }
    rect
}
