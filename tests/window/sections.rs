//! Tests of sections in the window: the menu adds them, the panel moves them, and the plots show them.

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use nalgebra::Vector2;

use crate::common::lab::{lab_of, window};
use crate::common::scene;
use crate::ui_interaction::{drag, on_body};
use warpbeam::Status;
use warpbeam::app::Lab;
use warpbeam::study::section_chart;

fn harness(id: &str) -> Harness<'static, Lab> {
    let mut harness = window([1280.0, 800.0], lab_of(id, scene(id)));
    harness.run_steps(4);
    harness
}

fn choose(harness: &mut Harness<'_, Lab>, rest: [f64; 2], entry: &str) {
    let pos = on_body(harness.state(), rest.into());
    harness.hover_at(pos);
    harness.run_steps(2);
    for pressed in [true, false] {
        let button = egui::PointerButton::Secondary;
        harness.event(Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
        harness.step();
    }
    harness.run_steps(4);
    harness.get_by_label(entry).click();
    harness.run_steps(6);
}

/// Returns the text of the forces of the first section.
fn forces(lab: &Lab) -> String {
    let simulation = lab.simulation();
    assert_eq!(*simulation.status(), Status::Converged);
    let section = simulation.section(lab.scene().sections[0]).unwrap();
    section_chart::text_of(&section, simulation)
}

/// The menu adds a section normal to the axis; the panel shows the forces that the library computes, and its fields move
/// the section; each is one step of undo, and the menu removes it.
#[test]
fn a_section_is_added_moved_and_removed() {
    let mut harness = harness("cantilever");
    let before = harness.state().scene().clone();
    choose(&mut harness, [4.0, 0.0], "Add a section here");
    let line = harness.state().scene().sections[0];
    assert!((line.at - Vector2::new(4.0, 0.0)).norm() < 0.05 && line.angle == 0.0, "{line:?}");
    let simulation = harness.state().simulation();
    let section = simulation.section(line).unwrap();
    // The force at the tip, and its lever arm about the middle of the cut.
    let arm = simulation.solution().probes[0].x - section.middle();
    let moment = arm.perp(&Vector2::new(0.0, -1000.0));
    assert!((section.force - Vector2::new(0.0, -1000.0)).norm() < 1e-4, "{section:?}");
    assert!((section.forces.moment - moment).abs() < 1e-4 * moment.abs(), "{section:?} {moment}");
    let text = forces(harness.state());
    assert!(harness.query_by_label(&text).is_some(), "{text}");
    harness.get_by_role_and_label(Role::SpinButton, "Cut x").focus();
    harness.run_steps(2);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.event(Event::Text("600 cm".to_owned()));
    harness.key_press(Key::Enter);
    harness.run_steps(6);
    assert_eq!(harness.state().scene().sections[0].at.x, 6.0);
    let moved = forces(harness.state());
    assert!(moved != text && harness.query_by_label(&moved).is_some(), "{moved}");
    for at in [Some(line.at), None] {
        harness.key_press(Key::Escape);
        harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        harness.run_steps(6);
        assert_eq!(harness.state().scene().sections.first().map(|line| line.at), at);
    }
    assert_eq!(*harness.state().scene(), before);
    choose(&mut harness, [4.0, 0.0], "Add a section here");
    choose(&mut harness, [4.0, 0.1], "Remove this section");
    assert_eq!(*harness.state().scene(), before);
}

/// A section is turned by either end of its cut, about its point, to multiples of 15° nearby.
#[test]
fn a_section_is_turned_by_its_ends() {
    let mut harness = harness("cantilever");
    choose(&mut harness, [4.0, 0.0], "Add a section here");
    let line = harness.state().scene().sections[0];
    // Each end of the cut, the place to which it is dragged, and the angle of the normal then.
    for (end, to, degrees) in [([4.0, 0.5], [4.49, 0.5], -45.0), ([3.5, -0.5], [4.0, -0.5], 0.0)] {
        let [from, to] = [end, to].map(|at| on_body(harness.state(), at.into()));
        drag(&mut harness, from, to, Modifiers::NONE);
        harness.run_steps(6);
        let turned = harness.state().scene().sections[0];
        assert_eq!((turned.at, turned.angle.to_degrees().round()), (line.at, degrees), "{turned:?}");
        let text = forces(harness.state());
        assert!(harness.query_by_label(&text).is_some(), "{text}");
    }
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run_steps(6);
    assert_eq!(harness.state().scene().sections[0].angle.to_degrees().round(), -45.0);
}

/// The plots show the stress along the section with N, V and M, and these along the beam with their largest values.
#[test]
fn the_plots_have_the_values_of_the_library() {
    let mut harness = harness("cantilever");
    choose(&mut harness, [4.0, 0.0], "Add a section here");
    harness.key_press(Key::Q);
    harness.run_steps(6);
    let simulation = harness.state().simulation();
    let section = simulation.section(harness.state().scene().sections[0]).unwrap();
    let within = section_chart::contexts(std::slice::from_ref(&section), simulation);
    let stresses = section_chart::stress(&section, harness.state().scene(), &within, &ToString::to_string);
    for (symbol, stress) in ["\u{3c3}", "\u{3c4}"].into_iter().zip(&stresses) {
        harness.get_by_label(symbol).click();
        harness.run_steps(2);
        let row = stress.rows.iter().find(|row| row.name == "M").unwrap();
        assert!(harness.query_by_label(&format!("{}: {}", row.name, row.value)).is_some(), "{row:?}");
        assert!(harness.query_by_label_contains(&stress.series[0].name).is_some(), "{:?}", stress.series[0].name);
    }
    let along = harness.state().simulation().sections(41).unwrap();
    let row = section_chart::forces(&along, harness.state().scene(), &within, &ToString::to_string)[2].rows[0].clone();
    harness.get_by_label("M").click();
    harness.run_steps(4);
    assert!(harness.query_by_label(&format!("{}: {}", row.name, row.value)).is_some(), "{row:?}");
    // Another load has other values.
    harness.state_mut().solve();
    harness.key_press(Key::Q);
    harness.run_steps(4);
    assert!(harness.query_by_label(&format!("{}: {}", row.name, row.value)).is_none(), "the plots are closed");
}

/// A body without axis has no section at first, and then only the stress along its own.
#[test]
fn a_body_without_axis_has_its_own_sections_only() {
    let mut harness = harness("clip");
    harness.key_press(Key::Q);
    harness.run_steps(4);
    let has_none = |harness: &Harness<'_, Lab>| harness.query_by_label_contains("No section").is_some();
    assert!(has_none(&harness));
    let node = harness.state().simulation().mesh().nodes()[0];
    choose(&mut harness, node.into(), "Add a section here");
    assert!(!has_none(&harness));
    assert!(harness.query_by_label_contains("in the cut (of the drawn stress)").is_some());
    assert!(harness.query_by_role_and_label(Role::Button, "N").is_none());
    assert_eq!(harness.state().scene().sections.len(), 1);
    // Without the menu: a section through the middle of the body.
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run_steps(4);
    assert!(has_none(&harness));
    harness.get_by_role_and_label(Role::Button, "Add a section").click();
    harness.run_steps(4);
    let line = harness.state().scene().sections[0];
    assert!(harness.state().simulation().section(line).is_ok() && !has_none(&harness), "{line:?}");
}
