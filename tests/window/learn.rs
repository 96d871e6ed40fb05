//! Tests of the cards of the mode Learn: each sets up its scene, and its numbers are the library's.

use crate::common::lab::*;
use warpbeam::element::QuadraturePoint;

fn open(size: [f32; 2]) -> Ui {
    let mut ui = window_at([0.05, 600.0], size, lab_of("cantilever", scene("cantilever")));
    ui.run();
    ui
}

/// Returns a window at a card, counted from 1, whose background solves have ended.
fn at_card(number: usize) -> Ui {
    let mut ui = open(SIZE);
    show(&mut ui, number);
    settle(&mut ui);
    ui
}

fn show(ui: &mut Ui, card: usize) {
    ui.state_mut().show_card(card);
    ui.run();
}

fn middle(corners: [Vector2<f64>; 3]) -> Vector2<f64> {
    corners.iter().sum::<Vector2<f64>>() / 3.0
}

fn corners(lab: &Lab, element: usize) -> ([Vector2<f64>; 3], [Vector2<f64>; 3]) {
    let mesh = lab.simulation().system().mesh();
    let nodes: [u32; 3] = mesh.elements().nth(element).unwrap().try_into().unwrap();
    let rest = nodes.map(|n| mesh.nodes()[n as usize]);
    let u = nodes.map(|n| lab.simulation().displacement()[n as usize]);
    (rest, std::array::from_fn(|i| rest[i] + u[i]))
}

/// Returns F, which maps the edges of a triangle at rest to its deformed edges.
fn gradient(rest: [Vector2<f64>; 3], now: [Vector2<f64>; 3]) -> Matrix2<f64> {
    let edges = |p: [Vector2<f64>; 3]| Matrix2::from_columns(&[p[1] - p[0], p[2] - p[0]]);
    edges(now) * edges(rest).try_inverse().unwrap()
}

fn minus(text: &str) -> String {
    text.replace('-', "\u{2212}")
}

/// Leaving Learn shows one's own scene, body and view again. Keys switch between the cards.
#[test]
fn leaving_learn_restores_the_previous_scene() {
    let mut ui = open(SIZE);
    ui.click("Step");
    ui.key(Key::W);
    let seen = |ui: &Ui| {
        let (lab, simulation) = (ui.state(), ui.simulation());
        let body = (simulation.displacement().to_vec(), simulation.iterations());
        (lab.scene().clone(), lab.camera(), body, lab.card(), lab.iterates(), lab.frame().lines.len())
    };
    let before = seen(&ui);
    // Without wires.
    assert_eq!((before.2.1, before.3, before.4, before.5), (1, None, false, 0));
    ui.click("Learn");
    assert_eq!((ui.state().card(), &*ui.scene().name), (Some((1, 9)), "The article's beam"));
    for (key, card) in
        [(Key::ArrowRight, 2), (Key::Enter, 3), (Key::ArrowLeft, 2), (Key::ArrowLeft, 1), (Key::ArrowLeft, 1)]
    {
        ui.key(key);
        assert_eq!(ui.state().card(), Some((card, 9)), "{key:?}");
    }
    ui.click("Next \u{203a}");
    ui.key(Key::Escape);
    assert!(seen(&ui) == before);
    ui.click("Learn");
    assert_eq!(ui.state().card(), Some((2, 9)));
    ui.click("Leave");
    assert_eq!(*ui.scene(), before.0);
}

/// The Tab key moves the focus from left to right, also through controls at the right end of a row.
#[test]
fn tab_goes_from_left_to_right() {
    let mut ui = at_card(2);
    let mut visited = Vec::new();
    for _ in 0..60 {
        ui.key_press(Key::Tab);
        ui.step();
        visited.extend(ui.query_by(|node| node.is_focused()).and_then(|node| node.accesskit_node().label()));
    }
    for names in [["Panel", "Language", "Theme", "Help"], ["\u{2039} Back", "Next \u{203a}", "Story", "Leave"]] {
        let places = names.map(|name| visited.iter().position(|seen| seen == name));
        assert!(places.iter().all(Option::is_some) && places.is_sorted(), "{names:?} at {places:?} of {visited:?}");
    }
}

/// Card 1 names the article and its source; linear theory's body grows, and the card says by how much.
#[test]
fn the_area_grows_under_linear_theory() {
    let mut ui = at_card(1);
    let sources = ui.starting("The article: ");
    let parts =
        ["\u{5b9e}\u{65f6}\u{7269}\u{7406}\u{6a21}\u{62df}", "M\u{fc}ller", "Interactive Virtual Materials", "2004"];
    assert!(parts.iter().all(|part| sources.contains(part)), "{sources}");
    assert!(ui.starting("K: ").contains("stiffness matrix (N/m). u: displacements of the nodes (m)"));
    let growth = |ui: &Ui| {
        let growth = 100.0 * ui.simulation().area_change();
        assert_eq!(ui.starting("whole body, linear"), format!("whole body, linear: +{}", percent(growth)));
        growth
    };
    assert_eq!(ui.scene().solver.method, MethodKind::Linear);
    let before = growth(&ui);
    assert!(before > 50.0, "{before}");
    let exact = ui.starting("whole body, reference");
    let number: f64 = exact.trim_start_matches("whole body, reference: +").trim_end_matches(" %").parse().unwrap();
    assert!(number < 2.0, "{exact}");
    let at = ui.slider("Tip force");
    ui.drag_at(at(0.74));
    ui.run();
    ui.hover(at(0.4));
    ui.release(at(0.4));
    // The area grows with the square of the rotation, which is proportional to the force.
    let (after, square) = (growth(&ui), (ui.force()[1] / -30e3).powi(2));
    assert!(after < 0.5 * before, "{before} {after}");
    assert!((after / before / square - 1.0).abs() < 0.1, "{after} {before} {square}");
}

/// Card 2.
#[test]
fn a_clicked_triangle_shows_its_f_r_and_s() {
    let mut ui = at_card(2);
    for element in [6, 0, 3] {
        let (rest, now) = corners(ui.state(), element);
        let at = in_view(ui.state(), middle(now));
        ui.click_at(at);
        let f = gradient(rest, now);
        let r = polar(&f).unwrap();
        let angle = r.angle().to_degrees();
        assert!((-60.0..-5.0).contains(&angle), "{angle}");
        assert!((ui.simulation().state().rotations()[element].angle() - r.angle()).abs() < 1e-12);
        assert_eq!(ui.starting("Triangle"), minus(&format!("Triangle {element}, rotated by {angle:.1}\u{b0}")));
        let s = r.matrix().transpose() * f;
        assert!((s.m12 - s.m21).abs() < 1e-12);
        for (name, m) in [("F", f), ("R", r.matrix()), ("S", s)] {
            let [a, b, c, d] = [m.m11, m.m12, m.m21, m.m22].map(|v| minus(&format!("{v:.3}")));
            assert_eq!(ui.starting(&format!("{name} = [")), format!("{name} = [{a} {b}; {c} {d}]"));
        }
    }
}

/// Card 3: every triangle is rotated back by its own R, and the slider moves the triangles back together.
#[test]
fn rotated_triangles_are_rotated_back_onto_their_rest_shape() {
    let mut ui = at_card(3);
    let drawn = |ui: &Ui, element: usize| {
        let frame = ui.state().frame();
        frame.triangles[element].map(|p| frame.positions[p as usize])
    };
    for element in 0..10 {
        let (rest, now) = corners(ui.state(), element);
        let back = ui.simulation().state().rotations()[element].matrix().transpose();
        let drawn = drawn(&ui, element);
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            assert!((drawn[j] - drawn[i] - back * (now[j] - now[i])).norm() < 1e-12);
        }
        // The remaining map is a stretch: its rotation is zero.
        let left = gradient(rest, drawn);
        assert!(polar(&left).unwrap().angle().abs() < 1e-9 && (left - Matrix2::identity()).norm() < 0.4);
    }
    let (rest, now) = corners(ui.state(), 6);
    let f = gradient(rest, now);
    let strain = polar(&f).unwrap().matrix().transpose() * f - Matrix2::identity();
    let signed = |v: f64| format!("{}{}", if v < 0.0 { "\u{2212}" } else { "+" }, percent(100.0 * v.abs()));
    let [along, across, shear] = [strain.m11, strain.m22, 2.0 * strain.m12].map(signed);
    let words = format!("strain \u{3b5}: along {along}, across {across}, shear \u{3b3} {shear}");
    assert_eq!(ui.starting("strain \u{3b5}"), words);
    // A press on a triangle that is drawn elsewhere does not pull the body, and selects the triangle drawn there.
    let at = in_view(ui.state(), middle(drawn(&ui, 1)));
    ui.hover_at(at);
    ui.drag_at(at);
    ui.step();
    assert!(ui.simulation().mouse_spring().is_none());
    ui.release(at);
    assert!(ui.starting("Triangle").starts_with("Triangle 1:"));
    let slider = ui.rect(Role::Slider, "Rotated back");
    ui.drag_at(slider.right_center() - vec2(4.0, 0.0));
    ui.run();
    ui.hover(slider.left_center());
    ui.release(slider.left_center());
    for element in 0..10 {
        assert_eq!(drawn(&ui, element), corners(ui.state(), element).1, "the bent beam again");
    }
}

/// Returns the tooltip of a cell of a matrix.
fn cell(ui: &mut Ui, matrix: &str, count: usize, row: usize, column: usize) -> String {
    let rect = ui.get_by_label_contains(matrix).rect();
    let at = |i: usize| (i as f32 + 0.5) * rect.width() / count as f32;
    ui.hover_at(rect.min + vec2(at(column), at(row)));
    ui.run_steps(30);
    let found = ui.texts().into_iter().find(|text| text.contains("displacement: ")).unwrap_or_default();
    ui.hover_at(egui::pos2(1270.0, 790.0));
    ui.run_steps(8);
    found
}

/// Card 4: the entries of Ke, R Ke Rᵀ and their sum.
#[test]
fn the_matrices_are_the_solvers() {
    let mut ui = at_card(4);
    assert!(ui.starting("Triangle 6: nodes").contains("24 \u{2212} 4 = 20 unknowns"));
    ui.get_by_label("the body's matrix, 24 by 24, of which 20 by 20 are left");
    let simulation = ui.simulation();
    let system = simulation.system().clone();
    assert_eq!(system.dofs(), 20);
    let (rest, _) = corners(ui.state(), 6);
    let entry = ElementKind::T3.entry();
    let point = QuadraturePoint::<3>::new(entry, &rest, entry.points[0].at, entry.points[0].weight);
    let moduli = simulation.problem().material().membrane();
    let block = |row: usize, column: usize| point.stiffness_block(moduli, row / 2, column / 2);
    let ke = |row: usize, column: usize| block(row, column)[(row % 2, column % 2)];
    let r = simulation.state().rotations()[6].matrix();
    let rotated = |row: usize, column: usize| (r * block(row, column) * r.transpose())[(row % 2, column % 2)];
    let words = |value: f64| format!("{}\n", engineering(three_digits(value), "N/m"));
    let mut sum = Matrix::new(system.pattern());
    let mut forces = Forces::new(system.mesh().nodes().len());
    simulation.problem().linearize(simulation.state(), &mut forces, Some((Tangent::WARPED, &mut sum)));
    let free = system.pattern().free.to_vec();
    for (row, column) in [(0, 0), (2, 3), (5, 1)] {
        for (matrix, entry) in [("Ke", ke(row, column)), ("R Ke RT", rotated(row, column))] {
            let shown = cell(&mut ui, &format!("{matrix} of triangle 6"), 6, row, column);
            assert!(shown.starts_with(&words(entry)), "{matrix}: {shown}");
        }
    }
    for (row, column) in [(6, 7), (10, 14), (19, 19)] {
        let (mut unit, mut product) = (vec![0.0; 20], vec![0.0; 20]);
        unit[column] = 1.0;
        sum.multiply(system.pattern(), &unit, &mut product);
        let (i, j) = (free[row] as usize, free[column] as usize);
        let name = |unknown: usize| format!("node {} {}", unknown / 2, ["x", "y"][unknown % 2]);
        let expected = format!("{}force: {}, displacement: {}", words(product[row]), name(i), name(j));
        assert_eq!(cell(&mut ui, "the body's matrix", 24, i, j), expected);
    }
    assert!(cell(&mut ui, "the body's matrix", 24, 0, 23).starts_with("no entry"));
}

/// Card 6: each press iterates once; the residual falls by the certificate's ρ for the equilibrium of `newton`.
#[test]
fn the_residual_falls_by_rho() {
    let mut ui = at_card(6);
    assert_eq!(ui.simulation().iterations(), 0, "it waits");
    let rho = solved(&ui.scene().clone().with_method(MethodKind::Newton)).certify().fixed_point_rho.unwrap();
    let mut residuals = Vec::new();
    while *ui.simulation().status() == Status::Running {
        ui.click("Step once");
        residuals.push(ui.simulation().residual());
        assert_eq!(ui.simulation().iterations() as usize, residuals.len());
    }
    let n = residuals.len();
    assert!(n > 10);
    let last = residuals[n - 1] / residuals[n - 2];
    assert!((last / rho - 1.0).abs() < 0.02, "{last} {rho}");
    assert_eq!(ui.starting("last step"), format!("last step: residual \u{d7} {last:.2}"));
    ui.get_by_label(&format!("Residual {:.1e} after {n} iterations; rho = {rho:.2}", residuals[n - 1]));
    // Set up again and run, it makes at most one iteration a frame.
    ui.click("Set up again");
    assert_eq!(ui.simulation().iterations(), 0, "it waits");
    ui.key_press(Key::Space);
    let mut frames = 0;
    while *ui.simulation().status() == Status::Running {
        ui.step();
        frames += 1;
        assert!(ui.simulation().iterations() <= frames, "more than one iteration in a frame");
    }
    assert!(frames > 5, "{frames} frames");
}

/// Card 7: `newton` converges under a load where ρ of `warped` exceeds 1, and `warped` diverges.
#[test]
fn newton_converges_where_rho_exceeds_one() {
    let mut ui = at_card(7);
    assert!(!ui.simulation().status().is_success());
    ui.expect(&["rho = 1.3"]);
    assert!(ui.starting("given up after").contains("iterations"));
    ui.click("newton: A + G");
    let simulation = ui.simulation();
    let method = simulation.scene().solver.method;
    assert_eq!((method, simulation.status()), (MethodKind::Newton, &Status::Converged));
    assert_eq!(ui.starting("converged after"), format!("converged after {} iterations", simulation.iterations()));
    let rho = simulation.equilibrium().unwrap().certificate().and_then(|c| c.fixed_point_rho);
    assert!(rho.is_some_and(|rho| rho > 1.0));
}

/// Card 8: with each element, the status bar has the error that `solve` reports.
#[test]
fn locking_shows_each_elements_error() {
    let mut ui = at_card(8);
    for element in ["t3", "t6", "q4"] {
        let set = format!("beam.element={element}");
        let json = solve_json(&["article", "--set", "solver.method=newton", "--set", &set]);
        let error = json["probes"][0]["error_percent"].as_f64().unwrap();
        ui.push(element);
        settle(&mut ui);
        assert_eq!(ui.scene().element().id(), element);
        assert!(ui.starting("ERROR ").starts_with(&format!("ERROR {}", percent(error))), "{element}: {error}");
        assert!(element != "t6" || error < 3.0);
    }
    ui.click("Set up again");
    assert_eq!(ui.scene().element(), ElementKind::T3);
}

/// Card 9 leads to Measure, with one's own scene.
#[test]
fn the_last_card_leads_to_measure() {
    let mut ui = at_card(9);
    ui.click("Open Measure");
    ui.expect(&["Measure on this machine"]);
    assert!(ui.state().card().is_none());
}

/// Card 5: a step highlights the next line; one of the lines iterates, and the numbers are the simulation's.
#[test]
fn steps_walk_through_the_pseudocode() {
    let mut ui = at_card(5);
    // Rows of the wrapped text may begin with the word, too.
    let all_lit = |ui: &Ui| -> Vec<String> {
        ui.texts().into_iter().filter(|text| text.starts_with("line ") && text.contains(": ")).collect()
    };
    let lit = |ui: &Ui| all_lit(ui).swap_remove(0);
    assert!(lit(&ui).starts_with("line 1: Ke = stiffness of each triangle at rest; 10 matrices"));
    for (line, iterations) in
        [(2, 0), (5, 0), (6, 0), (7, 0), (8, 1), (9, 1), (10, 1), (5, 1), (6, 1), (7, 1), (8, 2), (9, 2), (10, 2)]
    {
        if line % 2 == 0 {
            ui.click("Next line")
        } else {
            ui.key(Key::N)
        }
        let simulation = ui.simulation();
        assert_eq!(simulation.iterations(), iterations, "line {line}");
        let words = lit(&ui);
        assert!(words.starts_with(&format!("line {line}: ")), "{words}");
        assert_eq!(all_lit(&ui).len(), 1);
        let r = minus(&format!("{:.1e}", simulation.residual()));
        let numbers = match line {
            5 => {
                let (rest, now) = corners(ui.state(), 6);
                let f = gradient(rest, now);
                let [a, b, c, d] = [f.m11, f.m12, f.m21, f.m22].map(|v| minus(&format!("{v:.2}")));
                format!("triangle 6: [{a} {b}; {c} {d}]")
            }
            6 => {
                let angles = simulation.state().rotations().iter().map(|r| r.angle());
                let largest = angles.max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap();
                format!("largest rotation: {}", minus(&format!("{:.1}\u{b0}", largest.to_degrees())))
            }
            7 => "A: 20 \u{d7} 20 (clamped nodes removed)".to_owned(),
            8 => {
                let largest = largest(simulation.displacement());
                format!("largest displacement: {}", engineering(three_digits(largest), "m"))
            }
            9 => format!("r = {r}"),
            10 => format!("no: r = {r}, repeat"),
            _ => "the beam at rest".to_owned(),
        };
        assert!(words.ends_with(&numbers), "{words}: {numbers}");
    }
    // Continues to the end, and then again from rest.
    ui.click("Go on");
    let iterations = ui.simulation().iterations();
    assert_eq!(*ui.simulation().status(), Status::Converged);
    assert!(lit(&ui).ends_with(&format!("yes, after {iterations} iterations")), "{}", lit(&ui));
    ui.key(Key::N);
    assert!(lit(&ui).starts_with("line 2: x = X"), "{}", lit(&ui));
    assert_eq!(ui.simulation().iterations(), 0);
}

/// A card has a single force slider. The panel is opened with its key; leaving restores its previous state.
#[test]
fn the_panel_is_folded_away_on_the_cards() {
    let mut ui = open(SIZE);
    for before in [true, false] {
        assert_eq!(ui.has(Role::Slider, "Force"), before);
        ui.click("Learn");
        assert!(!ui.has(Role::Slider, "Force") && ui.has(Role::Slider, "Tip force"));
        for shown in [true, false, true] {
            ui.key(Key::P);
            assert_eq!(ui.has(Role::Slider, "Force"), shown);
        }
        ui.click("Leave");
        assert_eq!(ui.has(Role::Slider, "Force"), before);
        ui.key(Key::P);
    }
}

/// Card 1: the view has room for the largest force of the slider, and does not move while the force is dragged.
#[test]
fn the_camera_does_not_hide_the_growth_of_the_body() {
    for size in [SIZE, [900.0, 600.0], [640.0, 480.0]] {
        let mut ui = open(size);
        show(&mut ui, 1);
        settle(&mut ui);
        let (camera, at) = (ui.camera(), ui.slider("Tip force"));
        ui.drag_at(at(0.74));
        for share in [0.8, 1.2, 0.1, 0.6, 1.2] {
            ui.hover(at(share));
            assert_eq!(ui.camera(), camera, "{size:?}: {share}");
            let view = ui.state().view_rect();
            for corner in (0..10).flat_map(|element| corners(ui.state(), element).1) {
                assert!(view.shrink(10.0).contains(in_view(ui.state(), corner)), "{size:?}, {share}: {corner:?}");
            }
            assert!(view.contains(ui.tip() + vec2(0.0, 20.0)), "{size:?}, {share}: {:?} in {view:?}", ui.tip());
        }
        ui.release(at(1.2));
        settle(&mut ui);
        assert_eq!(ui.camera(), camera);
        assert!(painted(&ui).iter().any(|(_, text)| text == "whole body, linear"), "the bars say what they are of");
    }
}

/// A formula that is wider than its column is set in a smaller font.
#[test]
fn no_formula_is_wider_than_its_column() {
    let mut ui = open([640.0, 480.0]);
    for (card, formula) in [
        (1, "det ( I + \u{3b8} J ) = 1 + \u{3b8}2"),
        (7, "\u{3c1} = | \u{3bb} |max ( A\u{2212}1 G )"),
        (9, "error \u{2264} mesh + iteration + theory"),
    ] {
        show(&mut ui, card);
        let rect = ui.get_by_label(formula).rect();
        assert!(rect.right() < 290.0 && rect.width() > 100.0, "{formula}: {rect:?}");
    }
}
