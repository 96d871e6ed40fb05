//! Tests of background solves: large models are meshed and solved in the background while the window stays responsive.
//! In these tests every model counts as large.

use std::sync::Arc;

use crate::common::lab::*;
use egui_kittest::Harness;

/// Returns a window that solves everything in the background; every frame is checked.
fn open(id: &str) -> Ui {
    let mut lab = lab_of(id, scene(id));
    lab.desk.session.most_unknowns = 0;
    let mut ui = Ui(Harness::builder().with_size(SIZE).with_max_steps(400).build_ui_state(
        |ui, lab: &mut Lab| {
            lab.advance(ui.input(|i| i.time));
            let before = body(lab);
            lab.ui(ui);
            // The window lays such a frame out again, with the result of its edit.
            if !std::mem::take(&mut lab.is_mixed) {
                is_of_one_state(lab, &before);
            }
        },
        lab,
    ));
    settle(&mut ui);
    ui
}

/// Runs frames until no background solve is left.
fn settle(ui: &mut Ui) {
    wait(ui, |lab| !lab.desk.session.is_working() && !lab.iterates());
}

fn wait(ui: &mut Ui, holds: impl Fn(&Lab) -> bool) {
    ui.step();
    while !holds(ui.state()) {
        ui.step();
        std::thread::yield_now();
    }
}

/// Returns the corners of the body's triangles, m, element by element; empty for other elements.
fn body(lab: &Lab) -> Vec<Vector2<f64>> {
    let simulation = lab.simulation();
    let mesh = simulation.system().mesh();
    if mesh.element().entry().nodes.len() != 3 {
        return Vec::new();
    }
    let place = |n: &u32| mesh.nodes()[*n as usize] + simulation.displacement()[*n as usize];
    mesh.elements().flat_map(|nodes| nodes.iter().map(place).collect::<Vec<_>>()).collect()
}

/// Checks that body, arrows, linear outline and drawing belong to the simulation after this frame's clicks or `before`.
fn is_of_one_state(lab: &Lab, before: &[Vector2<f64>]) {
    let simulation = lab.simulation();
    assert_eq!(simulation.displacement().len(), simulation.system().mesh().nodes().len());
    if let Some(linear) = lab.desk.session.linear() {
        assert_eq!(linear.scene().loads, simulation.scene().loads, "the linear outline is of another load");
        assert!(Arc::ptr_eq(linear.system(), simulation.system()), "the linear outline is of another mesh");
    }
    let after = body(lab);
    if !before.is_empty() && !after.is_empty() {
        let drawn = lab.frame().positions;
        assert!(drawn == before || drawn == after, "another body is drawn");
    }
    for (load, _) in lab.arrow_tips() {
        assert!(matches!(simulation.scene().loads[load], Load::Force { .. }), "an arrow of another scene");
    }
}

/// Waits, and checks that the displayed result equals a solve of the requested scene.
fn agrees_with_solve(ui: &mut Ui) {
    settle(ui);
    is_solve(ui.state());
}

fn is_solve(lab: &Lab) {
    assert_eq!(lab.scene(), lab.simulation().scene());
    assert_eq!(*lab.simulation().status(), Status::Converged);
    let fresh = solved(lab.scene());
    let largest = largest(fresh.displacement());
    let off = largest_distance(lab.simulation().displacement(), fresh.displacement());
    assert!(off < 1e-5 * largest, "{off} of {largest}");
    assert!(lab.simulation().equilibrium().unwrap().certificate().is_some(), "it is not certified");
}

/// Action of a user.
type Edit = &'static dyn Fn(&mut Ui);

#[test]
fn every_edit_of_a_large_model_ends_with_the_result_of_solve() {
    let mut ui = open("cantilever");
    agrees_with_solve(&mut ui);
    let edits: [(&str, Edit); 9] = [
        ("a load", &|ui| ui.type_into("Force", "700 N")),
        ("a direction", &|ui| ui.type_into("Direction", "-60")),
        ("a method", &|ui| pick(ui, "Method", "newton")),
        ("an element", &|ui| pick(ui, "Element", "q4")),
        ("a mesh", &|ui| ui.type_into("Cells along", "30")),
        ("a material", &|ui| ui.type_into("Young E", "2 MPa")),
        ("a reset", &|ui| ui.get_by_label("Reset").click()),
        ("undo", &|ui| ui.key_press_modifiers(Modifiers::COMMAND, Key::Z)),
        ("another scene", &|ui| pick(ui, "Scene", "elastica")),
    ];
    for (what, edit) in edits {
        let before = ui.scene().clone();
        edit(&mut ui);
        agrees_with_solve(&mut ui);
        assert!(*ui.scene() != before || what == "a reset", "{what} changes nothing");
    }
}

#[test]
fn a_body_solved_in_the_background_is_paused_and_stepped() {
    let mut ui = open("article");
    let iterations = |ui: &mut Ui| {
        settle(ui);
        ui.simulation().iterations()
    };
    let all = iterations(&mut ui);
    ui.get_by_label("Step").click();
    assert_eq!(iterations(&mut ui), 1);
    ui.key_press(Key::N);
    assert_eq!(iterations(&mut ui), 2);
    ui.get_by_label("Reset").click();
    settle(&mut ui);
    assert!(ui.simulation().displacement().iter().all(|u| *u == Vector2::zeros()));
    ui.click_for("Run", 1);
    assert_eq!(iterations(&mut ui), all);
    ui.key_press(Key::N);
    settle(&mut ui);
    ui.type_into("Force", "12000 N");
    agrees_with_solve(&mut ui);
}

/// Returns a scene with another load whose mesh takes long enough to be interrupted.
fn large() -> Scene {
    scene_with("cantilever", &["beam.cells=[400,40]", "load.0.force=[0,-700]"])
}

/// While a mesh is created, the previous picture stays with a status text.
#[test]
fn cancel_restores_the_state_before_the_edit() {
    let mut ui = open("cantilever");
    let seen = |ui: &Ui| (ui.scene().clone(), ui.simulation().displacement().to_vec());
    let (before, shown) = (seen(&ui), ui.state().frame().positions.to_vec());
    let tips = ui.state().arrow_tips();
    ui.state_mut().set_scene(large()).unwrap();
    ui.step();
    assert!(ui.state().desk.session.is_working());
    assert_eq!(*ui.scene(), large(), "controls show what is wanted");
    assert_eq!(*ui.simulation().scene(), before.0, "the picture stays");
    assert_eq!(ui.state().arrow_tips(), tips, "the arrow is of another load than the body");
    ui.expect(&["32,000 triangles"]);
    ui.click_for("Cancel", 2);
    assert_eq!(*ui.scene(), before.0);
    assert!(ui.query_by_label("Cancel").is_none(), "what nobody waits for is still named");
    agrees_with_solve(&mut ui);
    assert!(seen(&ui) == before && ui.state().frame().positions == shown);
    ui.type_into("Force", "500 N");
    agrees_with_solve(&mut ui);
    // The key cancels during the search for an equilibrium, too.
    let before = seen(&ui);
    ui.state_mut().set_scene(before.0.clone().with_cells(300, 30)).unwrap();
    wait(&mut ui, |lab| lab.simulation().scene() != &before.0);
    if ui.state().desk.session.is_working() {
        ui.key_press(Key::Escape);
        settle(&mut ui);
        assert!(seen(&ui) == before);
    }
    agrees_with_solve(&mut ui);
}

/// A dragged slider requests many meshes; they are set up one at a time, and the last one always is.
#[test]
fn a_dragged_slider_sets_up_few_models() {
    let mut ui = open("cantilever");
    unfold(&mut ui, "Cells along");
    let at = ui.slider("Cells along");
    ui.hover_at(at(0.5));
    ui.drag_at(at(0.5));
    ui.step();
    let (mut wanted, mut shown): (Vec<Scene>, Vec<Scene>) = (Vec::new(), Vec::new());
    for i in 0..60u8 {
        ui.move_to(at(0.5 + 0.005 * f32::from(i)));
        wanted.push(ui.scene().clone());
        shown.push(ui.simulation().scene().clone());
    }
    wanted.dedup();
    shown.dedup();
    ui.drop_at(at(0.795));
    settle(&mut ui);
    assert!(wanted.len() > 10, "{} meshes were asked for", wanted.len());
    assert!(shown.len() <= wanted.len(), "{} meshes were shown", shown.len());
    assert_eq!(ui.scene(), wanted.last().unwrap());
    agrees_with_solve(&mut ui);
    ui.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut ui);
    assert_eq!(*ui.scene(), scene("cantilever"));
}

/// An error in a mesh is found in the background.
#[test]
fn a_refused_scene_is_reported_and_nothing_is_changed() {
    let mut ui = open("cantilever");
    let before = ui.scene().clone();
    ui.state_mut().set_scene(before.clone().with_cells(20, 2).clamp("nowhere")).unwrap();
    agrees_with_solve(&mut ui);
    assert!(ui.state_mut().set_scene(before.clone().with_cells(0, 1)).is_err());
    agrees_with_solve(&mut ui);
    assert_eq!(*ui.scene(), before);
}

#[test]
fn a_dropped_lab_ends_its_background_solve() {
    let scene = scene_with("cantilever", &["beam.cells=[200,20]", "solver.method=warped"]);
    let mut lab = lab_of("cantilever", scene.clone());
    lab.desk.session.most_unknowns = 0;
    lab.solve();
    let system = Arc::downgrade(lab.simulation().system());
    let mut heavy = scene;
    heavy.set_force(0, [0.0, -1e4]).unwrap();
    heavy.solver.tolerance = 1e-14;
    heavy.solver.max_iterations = 100_000;
    lab.set_scene(heavy).unwrap();
    assert!(lab.desk.session.is_working());
    drop(lab);
    while system.upgrade().is_some() {
        std::thread::yield_now();
    }
}

/// The blocking solve is used for pictures.
#[test]
fn solve_waits_for_the_worker() {
    let mut lab = lab_of("cantilever", scene("cantilever"));
    lab.desk.session.most_unknowns = 0;
    let fine = scene("cantilever").with_cells(24, 3);
    for scene in [fine.clone(), fine.with_method(MethodKind::Newton)] {
        lab.set_scene(scene).unwrap();
        lab.solve();
        assert!(!lab.desk.session.is_working());
        is_solve(&lab);
    }
}
