//! Tests of the cards of the mode Learn: each sets up its scene, and its numbers are the library's.

use crate::common::lab::settle;
use crate::common::solve_json;
use egui::accesskit::Role;
use egui::{Key, Pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use nalgebra::{Matrix2, Vector2};
use warpbeam::app::Lab;
use warpbeam::assembly::{Forces, Matrix};
use warpbeam::element::{QuadraturePoint, Tangent};
use warpbeam::format::{engineering, percent, three_digits};
use warpbeam::rotation::polar;
use warpbeam::scene::{ElementKind, MethodKind, Source};
use warpbeam::{Simulation, Status};

fn harness(size: [f32; 2]) -> Harness<'static, Lab> {
    let scene = crate::common::scene("cantilever");
    let simulation = Simulation::new(&scene).unwrap();
    let lab = Lab::new(Source { name: "cantilever".into(), assignments: Vec::new() }, scene, simulation);
    let mut harness = Harness::builder().with_size(size).with_max_steps(600).with_step_dt(0.05).build_ui_state(
        |ui, lab: &mut Lab| {
            lab.advance(ui.input(|i| i.time));
            lab.ui(ui);
        },
        lab,
    );
    harness.run();
    harness
}

/// Returns a window at a card, counted from 1, whose background solves have ended.
fn at_card(number: usize) -> Harness<'static, Lab> {
    let mut harness = harness([1280.0, 800.0]);
    harness.state_mut().show_card(number);
    harness.run();
    settle(&mut harness);
    harness
}

fn texts(harness: &Harness<'_, Lab>) -> Vec<String> {
    let labels = harness.get_all_by(|_| true).map(|node| node.accesskit_node());
    labels.flat_map(|node| [node.label(), node.value()]).flatten().collect()
}

/// Returns the first text with this beginning.
fn text(harness: &Harness<'_, Lab>, start: &str) -> String {
    let all = texts(harness);
    all.iter().find(|text| text.starts_with(start)).cloned().unwrap_or_else(|| unreachable!("no {start:?}: {all:?}"))
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

fn in_window(lab: &Lab, place: Vector2<f64>) -> Pos2 {
    let [x, y] = lab.camera().to_view(place);
    lab.view_rect().center() + vec2(x as f32, y as f32)
}

fn minus(text: &str) -> String {
    text.replace('-', "\u{2212}")
}

/// Keys switch between the cards; leaving restores the previous scene, body and view.
#[test]
fn leaving_learn_restores_the_previous_scene() {
    let mut harness = harness([1280.0, 800.0]);
    harness.get_by_label("Step").click();
    harness.run();
    harness.key_press(Key::W);
    harness.run();
    let before = harness.state();
    let (scene, camera) = (before.scene().clone(), before.camera());
    let (body, iterations) = (before.simulation().displacement().to_vec(), before.simulation().iterations());
    assert_eq!((iterations, before.card(), before.iterates()), (1, None, false));
    assert!(before.frame().lines.is_empty(), "without wires");
    harness.get_by_label("Learn").click();
    harness.run();
    assert_eq!(harness.state().card(), Some((1, 9)));
    assert_eq!(harness.state().scene().name, "The article's beam");
    for (key, card) in
        [(Key::ArrowRight, 2), (Key::Enter, 3), (Key::ArrowLeft, 2), (Key::ArrowLeft, 1), (Key::ArrowLeft, 1)]
    {
        harness.key_press(key);
        harness.run();
        assert_eq!(harness.state().card(), Some((card, 9)), "{key:?}");
    }
    harness.get_by_label("Next \u{203a}").click();
    harness.run();
    harness.key_press(Key::Escape);
    harness.run();
    let after = harness.state();
    assert_eq!(after.card(), None);
    assert_eq!((after.scene(), after.camera()), (&scene, camera));
    assert_eq!((after.simulation().displacement(), after.simulation().iterations()), (&body[..], iterations));
    assert!(after.frame().lines.is_empty() && !after.iterates());
    // Learn continues at the last card.
    harness.get_by_label("Learn").click();
    harness.run();
    assert_eq!(harness.state().card(), Some((2, 9)));
    harness.get_by_label("Leave").click();
    harness.run();
    assert_eq!(harness.state().scene(), &scene);
}

/// Tab goes through the controls of a row in the order of reading, also where they are at its right end.
#[test]
fn tab_goes_from_left_to_right() {
    let mut harness = at_card(2);
    let mut visited = Vec::new();
    for _ in 0..60 {
        harness.key_press(egui::Key::Tab);
        harness.step();
        let focused = harness.query_by(|node| node.is_focused());
        visited.extend(focused.and_then(|node| node.accesskit_node().label()));
    }
    for names in [["Panel", "Language", "Theme", "Help"], ["\u{2039} Back", "Next \u{203a}", "Story", "Leave"]] {
        let places = names.map(|name| visited.iter().position(|seen| seen == name));
        assert!(places.iter().all(Option::is_some) && places.is_sorted(), "{names:?} at {places:?} of {visited:?}");
    }
}

/// In a window of any size, every control of a card is inside and can be pressed.
#[test]
fn every_card_can_be_read_and_left_in_a_small_window() {
    for size in [[1280.0, 800.0], [800.0, 600.0], [640.0, 480.0]] {
        let mut harness = harness(size);
        let window = egui::Rect::from_min_size(Pos2::ZERO, size.into());
        for card in 1..=warpbeam::app::card_count() {
            harness.state_mut().show_card(card);
            harness.run();
            for name in ["\u{2039} Back", "Next \u{203a}", "Leave"] {
                let rect = harness.get_by_label(name).rect();
                assert!(window.contains_rect(rect) && rect.width() > 20.0, "{size:?}, card {card}: {name} at {rect:?}");
            }
            assert!(harness.query_by_label(&format!("{card} of 9")).is_some());
            let view = harness.state().view_rect();
            assert!(view.height() > 0.3 * size[1], "{size:?}: the body has {view:?}");
            if card < 9 {
                harness.get_by_label("Next \u{203a}").click();
                harness.run();
                assert_eq!(harness.state().card(), Some((card + 1, 9)));
            }
        }
    }
}

/// Card 1: the area of linear theory's body equals that of the corners of its triangles.
#[test]
fn the_area_grows_under_linear_theory() {
    let mut harness = at_card(1);
    let growth = |lab: &Lab| {
        let area = |p: [Vector2<f64>; 3]| (p[1] - p[0]).perp(&(p[2] - p[0]));
        let sums = (0..10).map(|e| corners(lab, e)).fold((0.0, 0.0), |s, (a, b)| (s.0 + area(a), s.1 + area(b)));
        100.0 * (sums.1 / sums.0 - 1.0)
    };
    assert_eq!(harness.state().scene().solver.method, MethodKind::Linear);
    let before = growth(harness.state());
    assert!(before > 50.0, "{before}");
    assert_eq!(text(&harness, "area, linear"), format!("area, linear: +{}", percent(before)));
    let exact = text(&harness, "area, reference");
    let number: f64 = exact.trim_start_matches("area, reference: +").trim_end_matches(" %").parse().unwrap();
    assert!(number < 2.0, "{exact}");
    let slider = harness.get_by_role_and_label(Role::Slider, "Tip force").rect();
    let at = |share: f32| egui::pos2(slider.left() + share * slider.width(), slider.center().y);
    harness.drag_at(at(0.74));
    harness.run();
    harness.hover_at(at(0.4));
    harness.run();
    harness.drop_at(at(0.4));
    harness.run();
    let after = growth(harness.state());
    assert!(after < 0.5 * before, "{before} {after}");
    assert_eq!(text(&harness, "area, linear"), format!("area, linear: +{}", percent(after)));
    // The area grows with the square of the rotation, which is proportional to the force.
    let force = |lab: &Lab| match &lab.scene().loads[0] {
        warpbeam::Load::Force { force, .. } => force[1] / -30e3,
        _ => unreachable!(),
    };
    let square = force(harness.state()).powi(2);
    assert!((after / before / square - 1.0).abs() < 0.1, "{after} {before} {square}");
}

/// Card 2 shows F, R and S of the clicked triangle.
#[test]
fn a_clicked_triangle_shows_its_f_r_and_s() {
    let mut harness = at_card(2);
    for element in [6, 0, 3] {
        let (rest, now) = corners(harness.state(), element);
        let at = in_window(harness.state(), now.iter().sum::<Vector2<f64>>() / 3.0);
        harness.hover_at(at);
        harness.drag_at(at);
        harness.drop_at(at);
        harness.run();
        let f = gradient(rest, now);
        let r = polar(&f).unwrap();
        let angle = r.angle().to_degrees();
        assert!((-60.0..-5.0).contains(&angle), "{angle}");
        let own = harness.state().simulation().state().rotations()[element];
        assert!((own.angle() - r.angle()).abs() < 1e-12);
        let words = format!("Triangle {}, rotated by {angle:.1}\u{b0}", element);
        assert_eq!(text(&harness, "Triangle"), minus(&words));
        let s = r.matrix().transpose() * f;
        assert!((s.m12 - s.m21).abs() < 1e-12);
        for (name, m) in [("F", f), ("R", r.matrix()), ("S", s)] {
            let numbers = [m.m11, m.m12, m.m21, m.m22].map(|v| minus(&format!("{v:.3}")));
            let [a, b, c, d] = numbers;
            assert_eq!(text(&harness, &format!("{name} = [")), format!("{name} = [{a} {b}; {c} {d}]"));
        }
    }
}

/// Card 3: every triangle is rotated back by its own R, and the slider moves the triangles back together.
#[test]
fn rotated_triangles_are_rotated_back_onto_their_rest_shape() {
    let mut harness = at_card(3);
    let drawn = |lab: &Lab, element: usize| {
        let frame = lab.frame();
        frame.triangles[element].map(|p| frame.positions[p as usize])
    };
    for element in 0..10 {
        let lab = harness.state();
        let (rest, now) = corners(lab, element);
        let back = lab.simulation().state().rotations()[element].matrix().transpose();
        let drawn = drawn(lab, element);
        for i in 0..3 {
            let j = (i + 1) % 3;
            assert!((drawn[j] - drawn[i] - back * (now[j] - now[i])).norm() < 1e-12);
        }
        // The remaining map is a stretch: its rotation is zero.
        let left = gradient(rest, drawn);
        assert!(polar(&left).unwrap().angle().abs() < 1e-9);
        assert!((left - Matrix2::identity()).norm() < 0.4);
    }
    let (rest, now) = corners(harness.state(), 6);
    let f = gradient(rest, now);
    let strain = polar(&f).unwrap().matrix().transpose() * f - Matrix2::identity();
    let signed = |v: f64| format!("{}{}", if v < 0.0 { "\u{2212}" } else { "+" }, percent(100.0 * v.abs()));
    let (along, across, shear) = (signed(strain.m11), signed(strain.m22), signed(2.0 * strain.m12));
    assert_eq!(
        text(&harness, "strain \u{3b5}"),
        format!("strain \u{3b5}: along {along}, across {across}, shear \u{3b3} {shear}")
    );
    // A press on a triangle that is drawn elsewhere does not pull the body, and selects the triangle drawn there.
    let seen = drawn(harness.state(), 1).iter().sum::<Vector2<f64>>() / 3.0;
    let at = in_window(harness.state(), seen);
    harness.hover_at(at);
    harness.drag_at(at);
    harness.step();
    assert!(harness.state().simulation().mouse_spring().is_none());
    harness.drop_at(at);
    harness.run();
    assert!(text(&harness, "Triangle").starts_with("Triangle 1:"));
    let slider = harness.get_by_role_and_label(Role::Slider, "Rotated back").rect();
    harness.drag_at(slider.right_center() - vec2(4.0, 0.0));
    harness.run();
    harness.hover_at(slider.left_center());
    harness.run();
    harness.drop_at(slider.left_center());
    harness.run();
    for element in 0..10 {
        let (_, now) = corners(harness.state(), element);
        assert_eq!(drawn(harness.state(), element), now, "the bent beam again");
    }
}

/// Returns the tooltip of a cell of a matrix.
fn cell(harness: &mut Harness<'_, Lab>, matrix: &str, count: usize, row: usize, column: usize) -> String {
    let rect = harness.get_by_label_contains(matrix).rect();
    let at = |i: usize| (i as f32 + 0.5) * rect.width() / count as f32;
    harness.hover_at(rect.min + vec2(at(column), at(row)));
    harness.run_steps(30);
    let found = text_containing(harness, "displacement: ");
    harness.hover_at(egui::pos2(1270.0, 790.0));
    harness.run_steps(8);
    found
}

fn text_containing(harness: &Harness<'_, Lab>, part: &str) -> String {
    texts(harness).into_iter().find(|text| text.contains(part)).unwrap_or_default()
}

/// Card 4: the entries of Ke, R Ke Rᵀ and their sum are the solver's.
#[test]
fn the_matrices_are_the_solvers() {
    let mut harness = at_card(4);
    assert!(text(&harness, "Triangle 6: nodes").contains("24 \u{2212} 4 = 20 unknowns"));
    assert!(harness.query_by_label("the body's matrix, 24 by 24, of which 20 by 20 are left").is_some());
    let simulation = harness.state().simulation();
    let system = simulation.system().clone();
    assert_eq!(system.dofs(), 20);
    let (rest, _) = corners(harness.state(), 6);
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
    let free = system.pattern().free().to_vec();
    for (row, column) in [(0, 0), (2, 3), (5, 1)] {
        let shown = cell(&mut harness, "Ke of triangle 6", 6, row, column);
        assert!(shown.starts_with(&words(ke(row, column))), "{shown}");
        let shown = cell(&mut harness, "R Ke RT of triangle 6", 6, row, column);
        assert!(shown.starts_with(&words(rotated(row, column))), "{shown}");
    }
    for (row, column) in [(6, 7), (10, 14), (19, 19)] {
        let (mut unit, mut product) = (vec![0.0; 20], vec![0.0; 20]);
        unit[column] = 1.0;
        sum.multiply(system.pattern(), &unit, &mut product);
        let (i, j) = (free[row] as usize, free[column] as usize);
        let shown = cell(&mut harness, "the body's matrix", 24, i, j);
        let name = |unknown: usize| format!("node {} {}", unknown / 2, ["x", "y"][unknown % 2]);
        let expected = format!("{}force: {}, displacement: {}", words(product[row]), name(i), name(j));
        assert_eq!(shown, expected);
    }
    // These nodes share no triangle.
    assert!(cell(&mut harness, "the body's matrix", 24, 0, 23).starts_with("no entry"));
}

/// Card 6: each press iterates once; the residual falls by ρ, which equals the certificate's ρ for
/// the equilibrium of `newton`.
#[test]
fn the_residual_falls_by_rho() {
    let mut harness = at_card(6);
    assert_eq!(harness.state().simulation().iterations(), 0, "it waits");
    let mut newton = harness.state().scene().clone();
    newton.solver.method = MethodKind::Newton;
    let mut newton = Simulation::new(&newton).unwrap();
    newton.solve();
    let rho = newton.certify().fixed_point_rho.unwrap();
    let mut residuals = Vec::new();
    while *harness.state().simulation().status() == Status::Running {
        harness.get_by_label("Step once").click();
        harness.run();
        residuals.push(harness.state().simulation().residual());
        assert_eq!(harness.state().simulation().iterations() as usize, residuals.len());
    }
    assert!(residuals.len() > 10);
    let ratios: Vec<f64> = residuals.windows(2).map(|w| w[1] / w[0]).collect();
    let last = ratios[ratios.len() - 1];
    assert!((last / rho - 1.0).abs() < 0.02, "{last} {rho}");
    let words = format!("last step: residual \u{d7} {last:.2}");
    assert_eq!(text(&harness, "last step"), words);
    let n = residuals.len();
    let words = format!("Residual {:.1e} after {n} iterations; rho = {rho:.2}", residuals[n - 1]);
    assert!(harness.query_by_label(&words).is_some(), "{words}: {:?}", texts(&harness));
}

/// Card 7: ρ is above 1, so that `warped` diverges, while `newton` converges.
#[test]
fn newton_converges_where_rho_exceeds_one() {
    let mut harness = at_card(7);
    assert!(!harness.state().simulation().status().is_success());
    assert!(text_containing(&harness, "rho = ").contains("rho = 1.3"), "{:?}", texts(&harness));
    assert!(text(&harness, "given up after").contains("iterations"));
    harness.get_by_label("newton: A + G").click();
    harness.run();
    let simulation = harness.state().simulation();
    assert_eq!((simulation.method(), simulation.status()), (MethodKind::Newton, &Status::Converged));
    assert_eq!(text(&harness, "converged after"), format!("converged after {} iterations", simulation.iterations()));
    assert!(
        simulation.equilibrium().unwrap().certificate().and_then(|c| c.fixed_point_rho).is_some_and(|rho| rho > 1.0)
    );
}

/// Card 8: each element's error is the one that `solve` reports.
#[test]
fn locking_has_each_elements_error() {
    let mut harness = at_card(8);
    for element in ["t3", "t6", "q4"] {
        let set = format!("beam.element={element}");
        let json = solve_json(&["article", "--set", "solver.method=newton", "--set", &set]);
        let error = json["probes"][0]["error_percent"].as_f64().unwrap();
        let words = format!("{element}: error {}, {} unknowns", percent(error), json["dofs"]);
        assert!(harness.query_by_label(&words).is_some(), "{words}: {:?}", texts(&harness));
        if element == "t6" {
            assert!(error < 3.0);
            harness.get_by_label(&words).click();
            harness.run();
            assert_eq!(harness.state().scene().element(), ElementKind::T6);
        }
    }
    harness.get_by_label("Set up again").click();
    harness.run();
    assert_eq!(harness.state().scene().element(), ElementKind::T3);
}

/// Card 9 leads to Budget, with one's own scene.
#[test]
fn the_last_card_leads_to_budget() {
    let mut harness = at_card(9);
    harness.get_by_label("Open Budget").click();
    harness.run();
    assert!(harness.state().card().is_none() && harness.query_by_label("Measure").is_some());
}

/// Returns every painted text.
fn painted(harness: &Harness<'_, Lab>) -> Vec<String> {
    fn texts(shape: &egui::Shape, found: &mut Vec<String>) {
        match shape {
            egui::Shape::Text(text) => found.push(text.galley.text().to_owned()),
            egui::Shape::Vec(shapes) => shapes.iter().for_each(|shape| texts(shape, found)),
            _ => {}
        }
    }
    let mut found = Vec::new();
    harness.output().shapes.iter().for_each(|clipped| texts(&clipped.shape, &mut found));
    found
}

/// Card 5: a step highlights the next line; one of the lines iterates, and the numbers are the simulation's.
#[test]
fn steps_walk_through_the_pseudocode() {
    let mut harness = at_card(5);
    // Rows of the wrapped text may begin with the word, too.
    let all_lit = |harness: &Harness<'_, Lab>| -> Vec<String> {
        texts(harness).into_iter().filter(|text| text.starts_with("line ") && text.contains(": ")).collect()
    };
    let lit = |harness: &Harness<'_, Lab>| all_lit(harness).swap_remove(0);
    assert!(lit(&harness).starts_with("line 1: Ke = stiffness of each triangle at rest; 10 matrices"));
    for (line, iterations) in
        [(2, 0), (5, 0), (6, 0), (7, 0), (8, 1), (9, 1), (10, 1), (5, 1), (6, 1), (7, 1), (8, 2), (9, 2), (10, 2)]
    {
        if line % 2 == 0 {
            harness.get_by_label("Next line").click();
        } else {
            harness.key_press(Key::N);
        }
        harness.run();
        let simulation = harness.state().simulation();
        assert_eq!(simulation.iterations(), iterations, "line {line}");
        let words = lit(&harness);
        assert!(words.starts_with(&format!("line {line}: ")), "{words}");
        assert_eq!(all_lit(&harness).len(), 1);
        let r = minus(&format!("{:.1e}", simulation.residual()));
        let numbers = match line {
            5 => {
                let (rest, now) = corners(harness.state(), 6);
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
                let largest = simulation.displacement().iter().map(|u| u.norm()).fold(0.0, f64::max);
                format!("largest displacement: {}", engineering(three_digits(largest), "m"))
            }
            9 => format!("r = {r}"),
            10 => format!("no: r = {r}, repeat"),
            _ => "the beam at rest".to_owned(),
        };
        assert!(words.ends_with(&numbers), "{words}: {numbers}");
    }
    // Continues to the end, and then again from rest.
    harness.get_by_label("Go on").click();
    harness.run();
    let iterations = harness.state().simulation().iterations();
    assert_eq!(*harness.state().simulation().status(), Status::Converged);
    assert!(lit(&harness).ends_with(&format!("yes, after {iterations} iterations")), "{}", lit(&harness));
    harness.key_press(Key::N);
    harness.run();
    assert!(lit(&harness).starts_with("line 2: x = X"), "{}", lit(&harness));
    assert_eq!(harness.state().simulation().iterations(), 0);
}

/// A card has a single force slider. The panel is hidden on cards and opened with its key; leaving
/// restores its previous state.
#[test]
fn the_panel_is_folded_away_on_the_cards() {
    let has_panel = |harness: &Harness<'_, Lab>| harness.query_by_role_and_label(Role::Slider, "Force").is_some();
    let mut harness = harness([1280.0, 800.0]);
    for before in [true, false] {
        assert_eq!(has_panel(&harness), before);
        harness.get_by_label("Learn").click();
        harness.run();
        assert!(!has_panel(&harness));
        assert!(harness.query_by_role_and_label(Role::Slider, "Tip force").is_some());
        for shown in [true, false, true] {
            harness.key_press(Key::P);
            harness.run();
            assert_eq!(has_panel(&harness), shown);
        }
        harness.get_by_label("Leave").click();
        harness.run();
        assert_eq!(has_panel(&harness), before);
        harness.key_press(Key::P);
        harness.run();
    }
}

/// Card 1: the view has room for the largest force of the slider, and does not move while the force is dragged.
#[test]
fn the_camera_does_not_hide_the_growth_of_the_body() {
    for size in [[1280.0, 800.0], [900.0, 600.0], [640.0, 480.0]] {
        let mut harness = harness(size);
        harness.state_mut().show_card(1);
        harness.run();
        settle(&mut harness);
        let camera = harness.state().camera();
        let slider = harness.get_by_role_and_label(Role::Slider, "Tip force").rect();
        let at = |share: f32| egui::pos2(slider.left() + share * slider.width(), slider.center().y);
        harness.drag_at(at(0.74));
        for share in [0.8, 1.2, 0.1, 0.6, 1.2] {
            harness.hover_at(at(share));
            harness.run();
            assert_eq!(harness.state().camera(), camera, "{size:?}: {share}");
            let lab = harness.state();
            let view = lab.view_rect();
            for element in 0..10 {
                for corner in corners(lab, element).1 {
                    assert!(view.shrink(10.0).contains(in_window(lab, corner)), "{size:?}, {share}: {corner:?}");
                }
            }
            let (_, tip) = lab.arrow_tips()[0];
            assert!(view.contains(tip + vec2(0.0, 20.0)), "{size:?}, {share}: {tip:?} in {view:?}");
        }
        harness.drop_at(at(1.2));
        harness.run();
        settle(&mut harness);
        assert_eq!(harness.state().camera(), camera);
        assert!(painted(&harness).iter().any(|text| text == "area, linear"), "the bars say what they are of");
    }
}

/// The first card names its sources.
#[test]
fn the_article_and_its_source_are_named() {
    let harness = at_card(1);
    let sources = text(&harness, "The article: ");
    for part in
        ["\u{5b9e}\u{65f6}\u{7269}\u{7406}\u{6a21}\u{62df}", "M\u{fc}ller", "Interactive Virtual Materials", "2004"]
    {
        assert!(sources.contains(part), "{sources}");
    }
    assert!(text(&harness, "K: ").contains("stiffness matrix (N/m). u: displacements of the nodes (m)"));
}

/// A formula wider than its column is set in a smaller font.
#[test]
fn no_formula_is_wider_than_its_column() {
    let mut harness = harness([640.0, 480.0]);
    for (card, formula) in [
        (1, "det ( I + \u{3b8} J ) = 1 + \u{3b8}2"),
        (7, "\u{3c1} = | \u{3bb} |max ( A\u{2212}1 G )"),
        (9, "error \u{2264} mesh + iteration + theory"),
    ] {
        harness.state_mut().show_card(card);
        harness.run();
        let rect = harness.get_by_label(formula).rect();
        assert!(rect.right() < 290.0 && rect.width() > 100.0, "{formula}: {rect:?}");
    }
}
