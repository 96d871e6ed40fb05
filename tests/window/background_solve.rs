//! Tests of background solves: large models are meshed and solved in the background while the window stays responsive.
//! In these tests every model counts as large.

use std::sync::Arc;

use crate::common::lab::{pick, type_into, unfold};
use crate::common::{scene, scene_with, solved};
use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use nalgebra::Vector2;
use warpbeam::app::Lab;
use warpbeam::scene::{Load, LoadId, MethodKind, Scene, Source};
use warpbeam::{Simulation, Status};

/// Returns a window that solves everything in the background; every frame is checked.
fn harness(id: &str) -> Harness<'static, Lab> {
    let scene = scene(id);
    let simulation = Simulation::new(&scene).unwrap();
    let mut lab = Lab::new(Source { name: id.into(), assignments: Vec::new() }, scene, simulation);
    lab.set_most_unknowns(0);
    let builder = Harness::builder().with_size([1280.0, 800.0]).with_max_steps(400);
    let mut harness = builder.build_ui_state(
        |ui, lab: &mut Lab| {
            lab.advance(ui.input(|i| i.time));
            let before = body(lab);
            lab.ui(ui);
            // The window lays such a frame out again, with the result of its edit.
            if !lab.take_mixed() {
                is_of_one_state(lab, &before);
            }
        },
        lab,
    );
    settle(&mut harness);
    harness
}

/// Runs frames until no background solve is left.
fn settle(harness: &mut Harness<'_, Lab>) {
    wait(harness, |lab| !lab.is_working() && !lab.iterates());
}

fn wait(harness: &mut Harness<'_, Lab>, holds: impl Fn(&Lab) -> bool) {
    harness.step();
    while !holds(harness.state()) {
        harness.step();
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

/// Checks that body, arrows, linear outline and drawing belong to one mesh and one load: those of the simulation, after
/// this frame's clicks or `before` them.
fn is_of_one_state(lab: &Lab, before: &[Vector2<f64>]) {
    let simulation = lab.simulation();
    assert_eq!(simulation.displacement().len(), simulation.system().mesh().nodes().len());
    if let Some(linear) = lab.linear() {
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

/// Checks that the displayed result equals a solve of the requested scene.
fn agrees_with_solve(lab: &Lab) {
    assert_eq!(lab.scene(), lab.simulation().scene());
    assert_eq!(*lab.simulation().status(), Status::Converged);
    let fresh = solved(lab.scene());
    let largest = fresh.displacement().iter().map(|u| u.norm()).fold(0.0, f64::max);
    let off = lab.simulation().displacement().iter().zip(fresh.displacement()).map(|(a, b)| (a - b).norm());
    let off = off.fold(0.0, f64::max);
    assert!(off < 1e-5 * largest, "{off} of {largest}");
    assert!(lab.simulation().equilibrium().unwrap().certificate().is_some(), "it is not certified");
}

/// Action of a user.
type Edit = &'static dyn Fn(&mut Harness<'_, Lab>);

/// Every kind of edit ends with the result of a solve.
#[test]
fn every_edit_of_a_large_model_ends_with_the_result_of_solve() {
    let mut harness = harness("cantilever");
    agrees_with_solve(harness.state());
    let edits: [(&str, Edit); 9] = [
        ("a load", &|h| type_into(h, "Force", "700")),
        ("a direction", &|h| type_into(h, "Direction", "-60")),
        ("a method", &|h| pick(h, "Method", "newton")),
        ("an element", &|h| pick(h, "Element", "t6")),
        ("a mesh", &|h| type_into(h, "Cells along", "30")),
        ("a material", &|h| type_into(h, "Young E", "2 MPa")),
        ("a reset", &|h| h.get_by_label("Reset").click()),
        ("undo", &|h| h.key_press_modifiers(Modifiers::COMMAND, Key::Z)),
        ("another scene", &|h| pick(h, "Scene", "elastica")),
    ];
    for (what, edit) in edits {
        let before = harness.state().scene().clone();
        edit(&mut harness);
        settle(&mut harness);
        if what != "a reset" {
            assert_ne!(*harness.state().scene(), before, "{what} changes nothing");
        }
        agrees_with_solve(harness.state());
    }
}

/// Pausing, single steps and continuing work in the background as they do between frames.
#[test]
fn a_body_solved_in_the_background_is_paused_and_stepped() {
    let mut harness = harness("article");
    let iterations = harness.state().simulation().iterations();
    harness.get_by_label("Step").click();
    settle(&mut harness);
    assert_eq!(harness.state().simulation().iterations(), 1);
    harness.key_press(Key::N);
    settle(&mut harness);
    assert_eq!(harness.state().simulation().iterations(), 2);
    harness.get_by_label("Reset").click();
    settle(&mut harness);
    assert!(harness.state().simulation().displacement().iter().all(|u| *u == Vector2::zeros()));
    harness.get_by_label("Run").click();
    harness.step();
    settle(&mut harness);
    assert_eq!(harness.state().simulation().iterations(), iterations);
    // An edit after a step goes on to equilibrium.
    harness.key_press(Key::N);
    settle(&mut harness);
    type_into(&mut harness, "Force", "12000");
    settle(&mut harness);
    agrees_with_solve(harness.state());
}

/// Returns a scene with another load whose mesh takes long enough to be interrupted.
fn large() -> Scene {
    scene_with("cantilever", &["beam.cells=[400,40]", "load.0.force=[0,-700]"])
}

/// While a mesh is created, the previous picture stays with a status text, and the previous
/// scene is restored on cancel.
#[test]
fn cancel_restores_the_state_before_the_edit() {
    let mut harness = harness("cantilever");
    let before = (harness.state().scene().clone(), harness.state().simulation().displacement().to_vec());
    let shown = harness.state().frame().positions.to_vec();
    let tips = harness.state().arrow_tips();
    harness.state_mut().set_scene(large()).unwrap();
    harness.step();
    assert!(harness.state().is_working());
    assert_eq!(*harness.state().scene(), large(), "controls show what is wanted");
    assert_eq!(*harness.state().simulation().scene(), before.0, "the picture stays");
    assert_eq!(harness.state().arrow_tips(), tips, "the arrow is of another load than the body");
    assert!(harness.query_by_label_contains("32,000 triangles").is_some(), "nothing is said");
    harness.get_by_label("Cancel").click();
    harness.step();
    harness.step();
    assert_eq!(*harness.state().scene(), before.0);
    assert!(harness.query_by_label("Cancel").is_none(), "what nobody waits for is still named");
    settle(&mut harness);
    assert_eq!(harness.state().simulation().displacement(), before.1);
    assert_eq!(harness.state().frame().positions, shown);
    agrees_with_solve(harness.state());
    // The body can still be bent.
    type_into(&mut harness, "Force", "500");
    settle(&mut harness);
    agrees_with_solve(harness.state());
    // The key cancels during the search for an equilibrium, too.
    let before = (harness.state().scene().clone(), harness.state().simulation().displacement().to_vec());
    harness.state_mut().set_scene(before.0.clone().with_cells(300, 30)).unwrap();
    wait(&mut harness, |lab| lab.simulation().scene() != &before.0);
    if harness.state().is_working() {
        harness.key_press(Key::Escape);
        settle(&mut harness);
        assert_eq!(*harness.state().scene(), before.0);
        assert_eq!(harness.state().simulation().displacement(), before.1);
    }
    agrees_with_solve(harness.state());
}

/// A dragged slider requests many meshes, of which few are created: one at a time, and always the last one.
#[test]
fn a_dragged_slider_sets_up_few_models() {
    let mut harness = harness("cantilever");
    unfold(&mut harness, "Cells along");
    let slider = harness.get_by_role_and_label(Role::Slider, "Cells along").rect();
    let at = |share: f32| egui::pos2(slider.left() + share * slider.width(), slider.center().y);
    harness.hover_at(at(0.5));
    harness.drag_at(at(0.5));
    harness.step();
    let (mut wanted, mut shown): (Vec<Scene>, Vec<Scene>) = (Vec::new(), Vec::new());
    for i in 0..60u8 {
        harness.hover_at(at(0.5 + 0.005 * f32::from(i)));
        harness.step();
        let lab = harness.state();
        if wanted.last() != Some(lab.scene()) {
            wanted.push(lab.scene().clone());
        }
        if shown.last() != Some(lab.simulation().scene()) {
            shown.push(lab.simulation().scene().clone());
        }
    }
    harness.drop_at(at(0.795));
    settle(&mut harness);
    assert!(wanted.len() > 10, "{} meshes were asked for", wanted.len());
    assert!(shown.len() <= wanted.len(), "{} meshes were shown", shown.len());
    assert_eq!(harness.state().scene(), wanted.last().unwrap());
    agrees_with_solve(harness.state());
    // One drag is one undo step.
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut harness);
    assert_eq!(*harness.state().scene(), scene("cantilever"));
}

/// An error in a mesh is found in the background and shown at its control; the scene is unchanged.
#[test]
fn a_refused_scene_is_reported_and_nothing_is_changed() {
    let mut harness = harness("cantilever");
    let before = harness.state().scene().clone();
    let wrong = before.clone().with_cells(20, 2).clamp("nowhere");
    harness.state_mut().set_scene(wrong).unwrap();
    settle(&mut harness);
    assert_eq!(*harness.state().scene(), before);
    agrees_with_solve(harness.state());
    assert!(harness.state_mut().set_scene(before.clone().with_cells(0, 1)).is_err());
    agrees_with_solve(harness.state());
}

/// A dropped lab stops its background solve.
#[test]
fn a_dropped_lab_ends_its_background_solve() {
    let mut lab = {
        let scene = scene_with("cantilever", &["beam.cells=[200,20]", "solver.method=warped"]);
        let simulation = Simulation::new(&scene).unwrap();
        Lab::new(Source { name: "cantilever".into(), assignments: Vec::new() }, scene, simulation)
    };
    lab.set_most_unknowns(0);
    lab.solve();
    let system = Arc::downgrade(lab.simulation().system());
    let mut heavy = lab.scene().clone();
    heavy.set_force(LoadId::nth(0), [0.0, -1e4]).unwrap();
    heavy.solver.tolerance = 1e-14;
    heavy.solver.max_iterations = 100_000;
    lab.set_scene(heavy).unwrap();
    assert!(lab.is_working());
    drop(lab);
    while system.upgrade().is_some() {
        std::thread::yield_now();
    }
}

/// The blocking solve, which is used for pictures, gives the result of a background solve.
#[test]
fn solve_waits_for_the_worker() {
    let scene = scene("cantilever");
    let simulation = Simulation::new(&scene).unwrap();
    let mut lab = Lab::new(Source { name: "cantilever".into(), assignments: Vec::new() }, scene.clone(), simulation);
    lab.set_most_unknowns(0);
    lab.set_scene(scene.with_cells(24, 3)).unwrap();
    lab.solve();
    assert!(!lab.is_working());
    agrees_with_solve(&lab);
    let mut newton = lab.scene().clone();
    newton.solver.method = MethodKind::Newton;
    lab.set_scene(newton).unwrap();
    lab.solve();
    agrees_with_solve(&lab);
}
