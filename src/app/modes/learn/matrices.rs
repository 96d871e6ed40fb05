//! Card of the matrices: Ke and R Ke Rᵀ of the selected triangle as coloured cells, and the assembled matrix; and quantities
//! of the article for the elements of a body.

use super::*;
use crate::article::affine::Affine2;
use crate::article::stiffness::ElementStiffness;
use crate::element::QuadraturePoint;
use crate::render::colormap;
use crate::rotation::polar;

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
                ui.label(formula::sized(markup, formula::SIZE, palette.text));
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
    ui.label(formula::sized("Σ R K_{e} R^{T}", formula::SIZE, palette.text));
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

/// Three-node triangle, at rest and in the current state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    pub nodes: [u32; 3],
    /// Corners at rest, m.
    pub rest: [Vector2<f64>; 3],
    /// F, the linear part of the map from the rest shape to the current one (article eqs. 12–15).
    pub gradient: Matrix2<f64>,
    /// R and S of F = R S (eqs. 37–39).
    pub rotation: Rotation,
    pub stretch: Matrix2<f64>,
}

impl Triangle {
    /// Returns an element of a body of three-node triangles; `None` for other elements, and if F has no polar
    /// decomposition.
    pub(super) fn of(simulation: &Simulation, element: usize) -> Option<Self> {
        let mesh = simulation.system().mesh();
        if mesh.element() != ElementKind::T3 {
            return None;
        }
        let nodes: [u32; 3] = mesh.elements().nth(element)?.try_into().ok()?;
        let u = simulation.displacement();
        let rest = nodes.map(|n| mesh.nodes()[n as usize]);
        let now = nodes.map(|n| mesh.nodes()[n as usize] + u[n as usize]);
        let gradient = Affine2::from_triangle(rest, now).ok()?.linear;
        let rotation = polar(&gradient)?;
        let stretch = rotation.matrix().transpose() * gradient;
        Some(Self { nodes, rest, gradient, rotation, stretch: (stretch + stretch.transpose()) * 0.5 })
    }

    /// Returns Ke, N/m (eqs. 1, 3).
    fn stiffness(&self, simulation: &Simulation) -> Option<ElementStiffness> {
        let entry = ElementKind::T3.entry();
        let point = entry.points.first()?;
        let point = QuadraturePoint::<3>::new(entry, &self.rest, point.at, point.weight);
        Some(ElementStiffness::new(&[point], simulation.problem().material().membrane()))
    }

    /// Returns the unknowns (2 · node + axis) of the six rows.
    fn unknowns(&self) -> [usize; 6] {
        std::array::from_fn(|i| 2 * self.nodes[i / 2] as usize + i % 2)
    }
}

/// Returns Σ R Ke Rᵀ over all nodes, N/m, without supports, with the R that the method uses; `None` for other elements.
fn assembled(simulation: &Simulation) -> Option<DMatrix<f64>> {
    let count = 2 * simulation.system().mesh().nodes().len();
    let mut sum = DMatrix::zeros(count, count);
    for (element, rotation) in simulation.element_rotations().into_iter().enumerate() {
        let triangle = Triangle::of(simulation, element)?;
        let rotated = triangle.stiffness(simulation)?.rkrt(rotation);
        let unknowns = triangle.unknowns();
        for (row, &i) in unknowns.iter().enumerate() {
            for (column, &j) in unknowns.iter().enumerate() {
                sum[(i, j)] += rotated[(row, column)];
            }
        }
    }
    Some(sum)
}

/// Returns the largest angle θ, rad, of linear theory in a body: half the difference of the derivatives of the
/// displacement across each other.
pub(super) fn largest_linear_angle(simulation: &Simulation) -> f64 {
    let (problem, state) = (simulation.problem(), simulation.state());
    let mut largest = 0.0_f64;
    let elements = problem.system().elements();
    elements.visit_strains(problem.material().lame(), state.displacement(), state.rotations(), &mut |_, h, _| {
        largest = largest.max(0.5 * (h[(1, 0)] - h[(0, 1)]).abs());
    });
    largest
}
