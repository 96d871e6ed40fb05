//! The pointer on the body, its loads and its values, and what edits go through, without a display or a GPU.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod common;

use common::{scene, solve_json};
use egui::accesskit::Role;
use egui::{Event, Modifiers, Pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use nalgebra::Vector2;
use warpbeam::app::Lab;
use warpbeam::scene::{Load, Source};
use warpbeam::simulation::{Simulation, Status};

fn harness(id: &str) -> Harness<'static, Lab> {
    let scene = scene(id);
    let simulation = Simulation::new(&scene).unwrap();
    let lab = Lab::new(Source { name: id.into(), assignments: Vec::new() }, scene, simulation);
    let mut harness = Harness::builder().with_size([1280.0, 800.0]).with_max_steps(400).build_ui_state(
        |ui, lab: &mut Lab| {
            lab.advance(ui.input(|i| i.time));
            lab.ui(ui);
        },
        lab,
    );
    harness.run();
    harness
}

fn force(lab: &Lab) -> [f64; 2] {
    let forces =
        lab.scene().loads.iter().filter_map(|l| if let Load::Force { force, .. } = l { Some(*force) } else { None });
    forces.into_iter().next().unwrap()
}

fn tip(lab: &Lab) -> Pos2 {
    lab.arrow_tips()[0].1
}

/// Where a point of the plane is in the window.
fn in_window(lab: &Lab, place: Vector2<f64>) -> Pos2 {
    let [x, y] = lab.camera().to_view(place);
    lab.view_rect().center() + vec2(x as f32, y as f32)
}

/// Where a material point of the body is in the window.
fn on_body(lab: &Lab, at: Vector2<f64>) -> Pos2 {
    let mesh = lab.simulation().system().mesh();
    let weights = mesh.weights(mesh.locate(at).unwrap()).unwrap();
    let u = lab.simulation().displacement();
    in_window(lab, weights.iter().map(|&(n, w)| (mesh.nodes()[n as usize] + u[n as usize]) * w).sum())
}

/// Drags from one place to another, by way of some between, and lets go.
fn drag(harness: &mut Harness<'_, Lab>, from: Pos2, to: Pos2, modifiers: Modifiers) {
    let button = |pos, pressed| Event::PointerButton { pos, button: egui::PointerButton::Primary, pressed, modifiers };
    harness.hover_at(from);
    harness.run();
    harness.event(Event::ModifiersChanged(modifiers));
    harness.event(button(from, true));
    harness.step();
    for i in 1..=4 {
        harness.hover_at(from + (to - from) * (i as f32 / 4.0));
        harness.step();
    }
    harness.event(button(to, false));
    harness.event(Event::ModifiersChanged(Modifiers::NONE));
    harness.run();
}

/// The number in the field of this label.
fn shown(harness: &Harness<'_, Lab>, label: &str) -> String {
    harness.get_by_role_and_label(Role::SpinButton, label).accesskit_node().value().unwrap_or_default()
}

/// The dragged tip sets force and direction; arrow, sliders and `solve` agree.
#[test]
fn dragging_the_tip_of_the_arrow_sets_the_force() {
    let mut harness = harness("cantilever");
    let camera = harness.state().camera();
    let before = tip(harness.state());
    let start = on_body(harness.state(), Vector2::new(10.0, 0.0));
    let target = before + vec2(-30.0, -12.0);
    drag(&mut harness, before, target, Modifiers::NONE);
    let lab = harness.state();
    let [fx, fy] = force(lab);
    let way = target - start;
    let wanted = f64::from(-way.y).atan2(f64::from(way.x)).to_degrees();
    let direction = fy.atan2(fx).to_degrees();
    assert!((direction - wanted).abs() < 0.6, "the arrow points to {wanted}°, the force to {direction}°");
    assert!(fx.hypot(fy) < 0.9 * 1000.0, "a shorter arrow is a smaller force: {fx} {fy}");
    assert_eq!(*lab.simulation().status(), Status::Converged);
    let direction_shown = shown(&harness, "Direction");
    assert!(direction_shown.starts_with(&format!("{direction:.0}")), "{direction_shown} {direction}");
    let json = solve_json(&["cantilever", "--set", &format!("load.0.force=[{fx},{fy}]")]);
    let solved = [0, 1].map(|i| json["probes"][0]["u"][i].as_f64().unwrap());
    let u = lab.simulation().solution().probes[0].u;
    assert!((u - Vector2::from(solved)).norm() < 1e-5 * u.norm(), "{u} {solved:?}");
    // The arrow is as long as it was dragged, wherever the body has gone.
    let length = (tip(lab) - on_body(lab, Vector2::new(10.0, 0.0))).length();
    assert!((length - way.length()).abs() < 1.5, "{length} {}", way.length());
    assert_ne!(lab.camera(), camera, "the view did not follow the body afterwards");
}

/// With Shift the direction is a multiple of 15°; dragged onto its foot the arrow is no force, and can be dragged out.
#[test]
fn shift_snaps_the_direction_and_a_force_can_be_dragged_away_and_back() {
    let mut harness = harness("cantilever");
    let before = tip(harness.state());
    drag(&mut harness, before, before + vec2(31.0, 4.0), Modifiers::SHIFT);
    let [fx, fy] = force(harness.state());
    let direction = fy.atan2(fx).to_degrees();
    assert!((direction / 15.0 - (direction / 15.0).round()).abs() < 1e-9 && direction != -90.0, "{direction}");
    let (from, to) = (tip(harness.state()), on_body(harness.state(), Vector2::new(10.0, 0.0)));
    drag(&mut harness, from, to, Modifiers::NONE);
    assert_eq!(force(harness.state()), [0.0, 0.0]);
    assert_eq!(*harness.state().simulation().status(), Status::Converged);
    let stub = tip(harness.state());
    drag(&mut harness, stub, stub + vec2(0.0, -90.0), Modifiers::NONE);
    assert!(force(harness.state())[1] > 0.0, "{:?}", force(harness.state()));
}

/// A press takes one thing: the tip before the body it lies over, the body before the space around it.
#[test]
fn a_press_takes_the_tip_or_the_body_or_the_view_and_never_two() {
    let mut harness = harness("article");
    // An arrow along the beam, its tip over the body.
    let mut inwards = harness.state().scene().clone();
    inwards.set_force(0, [-20_000.0, 0.0]).unwrap();
    harness.state_mut().set_scene(inwards).unwrap();
    harness.run();
    let (camera, tip) = (harness.state().camera(), tip(harness.state()));
    harness.hover_at(tip);
    harness.run();
    assert_eq!(harness.output().platform_output.cursor_icon, egui::CursorIcon::Move);
    let before = force(harness.state());
    harness.drag_at(tip);
    harness.step();
    harness.hover_at(tip + vec2(-25.0, 0.0));
    harness.step();
    assert!(harness.state().simulation().hand().is_none(), "the body was taken with the tip");
    assert_ne!(force(harness.state()), before);
    assert_eq!(harness.state().camera(), camera, "the view moved with the tip");
    harness.drop_at(tip + vec2(-25.0, 0.0));
    harness.run();
    let (before, camera) = (force(harness.state()), harness.state().camera());
    let body = on_body(harness.state(), Vector2::new(1.0, 0.0));
    harness.hover_at(body);
    harness.run();
    assert_eq!(harness.output().platform_output.cursor_icon, egui::CursorIcon::Grab);
    harness.drag_at(body);
    harness.step();
    harness.hover_at(body + vec2(0.0, 60.0));
    harness.step();
    assert!(harness.state().simulation().hand().is_some());
    assert_eq!((force(harness.state()), harness.state().camera()), (before, camera));
    harness.drop_at(body + vec2(0.0, 60.0));
    harness.run();
    let space = harness.state().view_rect().center() + vec2(0.0, 290.0);
    let camera = harness.state().camera();
    drag(&mut harness, space, space + vec2(50.0, -30.0), Modifiers::NONE);
    assert_eq!(force(harness.state()), before);
    let moved = camera.to_world([0.0, 0.0]) - harness.state().camera().to_world([50.0, -30.0]);
    assert!(moved.norm() < 1e-2 / camera.scale.min(1.0), "the view did not follow the pointer: {moved}");
}
