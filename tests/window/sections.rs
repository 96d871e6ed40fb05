//! Tests of sections in the window: the menu adds them, the panel moves them, and the plots show them.

use crate::common::lab::*;
use warpbeam::study::section_chart;

fn open(id: &str) -> Ui {
    let mut ui = window(SIZE, lab_of(id, scene(id)));
    ui.run_steps(4);
    ui
}

/// Returns the text of the forces of the first section.
fn forces(lab: &Lab) -> String {
    let simulation = lab.simulation();
    assert_eq!(*simulation.status(), Status::Converged);
    section_chart::text_of(&simulation.section(lab.scene().sections[0]).unwrap(), simulation)
}

/// The panel shows the forces that the library computes; each change is one step of undo.
#[test]
fn a_section_is_added_moved_and_removed() {
    let mut ui = open("cantilever");
    let before = ui.scene().clone();
    ui.choose(ui.on_body([4.0, 0.0]), "Add a section here");
    let line = ui.scene().sections[0];
    assert!((line.at - Vector2::new(4.0, 0.0)).norm() < 0.05 && line.angle == 0.0, "{line:?}");
    let simulation = ui.simulation();
    let section = simulation.section(line).unwrap();
    // The force at the tip, and its lever arm about the middle of the cut.
    let (force, tip) = (Vector2::from(ui.force()), simulation.solution().probes[0].x);
    let moment = (tip - section.middle()).perp(&force);
    assert!((section.force - force).norm() < 1e-4, "{section:?}");
    assert!((section.forces.moment - moment).abs() < 1e-4 * moment.abs(), "{section:?} {moment}");
    let text = forces(ui.state());
    ui.get_by_label(&text);
    ui.get_by_role_and_label(Role::SpinButton, "Cut x").focus();
    ui.run_steps(2);
    ui.replace_text("600 cm");
    ui.key_press(Key::Enter);
    ui.run_steps(6);
    assert_eq!(ui.scene().sections[0].at.x, 6.0);
    let moved = forces(ui.state());
    assert!(moved != text && ui.query_by_label(&moved).is_some(), "{moved}");
    for at in [Some(line.at), None] {
        ui.key_press(Key::Escape);
        ui.undo();
        assert_eq!(ui.scene().sections.first().map(|line| line.at), at);
    }
    assert_eq!(*ui.scene(), before);
    ui.choose(ui.on_body([4.0, 0.0]), "Add a section here");
    ui.choose(ui.on_body([4.0, 0.1]), "Remove this section");
    assert_eq!(*ui.scene(), before);
}

/// A section is turned by either end of its cut, about its point, to multiples of 15° nearby.
#[test]
fn a_section_is_turned_by_its_ends() {
    let mut ui = open("cantilever");
    ui.choose(ui.on_body([4.0, 0.0]), "Add a section here");
    let line = ui.scene().sections[0];
    // Each end of the cut, the place to which it is dragged, and the angle of the normal then.
    for (end, to, degrees) in [([4.0, 0.5], [4.49, 0.5], -45.0), ([3.5, -0.5], [4.0, -0.5], 0.0)] {
        ui.drag(ui.on_body(end), ui.on_body(to));
        ui.run_steps(6);
        let turned = ui.scene().sections[0];
        assert_eq!((turned.at, turned.angle.to_degrees().round()), (line.at, degrees), "{turned:?}");
        ui.get_by_label(&forces(ui.state()));
    }
    ui.undo();
    assert_eq!(ui.scene().sections[0].angle.to_degrees().round(), -45.0);
}

/// A section and its numbers follow the pointer while it is dragged, in one step of the undo history.
#[test]
fn a_section_follows_the_pointer() {
    let mut ui = open("cantilever");
    ui.choose(ui.on_body([4.0, 0.0]), "Add a section here");
    let (before, from) = (ui.scene().clone(), ui.on_body([4.0, 0.0]));
    let mut places = Vec::new();
    ui.hold(from);
    for x in [5.0, 6.0] {
        ui.move_to(ui.on_body([x, 0.0]));
        ui.run_steps(3);
        places.push(ui.scene().sections[0].at.x.round());
        ui.get_by_label(&forces(ui.state()));
    }
    assert_eq!(places, [5.0, 6.0]);
    ui.release(ui.on_body([6.0, 0.0]));
    ui.undo();
    assert_eq!(*ui.scene(), before);
}

/// The plots show M along the beam, or the stress along a section; N, V and M have their largest values.
#[test]
fn the_plots_have_the_values_of_the_library() {
    let mut ui = open("cantilever");
    ui.key_press(Key::Q);
    ui.wait_until("the moment", |ui| painted(ui).iter().any(|(_, text)| text.starts_with("bending moment M")));
    ui.choose(ui.on_body([4.0, 0.0]), "Add a section here");
    let simulation = ui.simulation();
    let section = simulation.section(ui.scene().sections[0]).unwrap();
    let within = section_chart::contexts(std::slice::from_ref(&section), simulation);
    let stresses = section_chart::stress(&section, ui.scene(), &within, &ToString::to_string);
    for (symbol, stress) in ["\u{3c3}", "\u{3c4}"].into_iter().zip(&stresses) {
        ui.click_for(symbol, 2);
        ui.get_by_label(&format!("M: {}", stress.rows().find(|(row, _)| row.name == "M").unwrap().1));
        ui.expect(&[&stress.series[0].name]);
    }
    let along = ui.simulation().sections(41).unwrap();
    let [.., moment] = section_chart::forces(&along, ui.scene(), &within, &ToString::to_string);
    let label = moment.rows().map(|(row, value)| format!("{}: {value}", row.name)).next().unwrap();
    ui.click_for("M", 4);
    ui.get_by_label(&label);
    ui.key_press(Key::Q);
    ui.run_steps(4);
    assert!(ui.query_by_label(&label).is_none(), "the plots are closed");
}

/// A body without axis has no section at first, and then only the stress along its own.
#[test]
fn a_body_without_axis_has_its_own_sections_only() {
    let mut ui = open("clip");
    ui.key_press(Key::Q);
    ui.run_steps(4);
    assert!(ui.says("No section"));
    let node = ui.simulation().mesh().nodes()[0];
    ui.choose(ui.on_body(node), "Add a section here");
    assert!(!ui.says("No section") && ui.says("in the cut (of the drawn stress)") && !ui.has(Role::Button, "N"));
    assert_eq!(ui.scene().sections.len(), 1);
    // Without the menu: a section through the middle of the body.
    ui.undo();
    assert!(ui.says("No section"));
    ui.click_for("Add a section", 4);
    let line = ui.scene().sections[0];
    assert!(ui.simulation().section(line).is_ok() && !ui.says("No section"), "{line:?}");
}
