//! Tests of the mode Compare, operated by pointer, keys and labels.

use crate::common::lab::{self, pick};
use crate::common::pictures::{distance, pixel};
use crate::common::{scene, scene_with};
use egui::Key;
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use warpbeam::app::{Lab, Magnification, Pane, PaneSetting, parse_panes, picture};
use warpbeam::format::{count, percent};
use warpbeam::render::Gpu;
use warpbeam::scene::{ElementKind, Load, MethodKind, Scene, Source};
use warpbeam::study::Reference;
use warpbeam::{Simulation, Status};

fn lab_of(id: &str, scene: Scene) -> Lab {
    let simulation = Simulation::new(&scene).unwrap();
    Lab::new(Source { name: id.into(), assignments: Vec::new() }, scene, simulation)
}

fn harness_of(id: &str, scene: Scene) -> Harness<'static, Lab> {
    Harness::builder().with_size([1280.0, 800.0]).with_max_steps(400).build_ui_state(
        |ui, lab: &mut Lab| {
            lab.advance(ui.input(|i| i.time));
            lab.ui(ui);
        },
        lab_of(id, scene),
    )
}

/// Draws frames until a condition holds.
fn wait(harness: &mut Harness<'_, Lab>, what: &str, holds: impl Fn(&Lab) -> bool) {
    lab::wait(harness, what, holds);
    harness.run_steps(2);
}

fn have_ended(lab: &Lab) -> bool {
    !lab.panes().is_empty() && lab.panes().iter().all(|pane| pane.end().is_some())
}

fn are_judged(lab: &Lab) -> bool {
    let has_failed = |pane: &Pane| pane.end().is_some_and(|end| !end.status.is_success());
    let judged = |pane: &Pane| pane.error_percent().is_some() && pane.seconds().is_some() || has_failed(pane);
    // The error of a live reference comes before that of the reference.
    have_ended(lab) && !lab.is_computing() && lab.panes().iter().all(judged)
}

/// Returns every label and value in the window.
fn labels(harness: &Harness<'_, Lab>) -> Vec<String> {
    let nodes = harness.get_all_by(|_| true).map(|node| node.accesskit_node());
    nodes.flat_map(|node| [node.label(), node.value()]).flatten().collect()
}

fn compared(id: &str, panes: &str) -> Harness<'static, Lab> {
    let mut harness = harness_of(id, scene(id));
    harness.state_mut().show_comparison(&parse_panes(panes).unwrap());
    wait(&mut harness, "the panes", are_judged);
    harness
}

fn load(scene: &Scene) -> f64 {
    scene
        .loads
        .iter()
        .find_map(|l| if let Load::Force { force, .. } = l { Some(force[0].hypot(force[1])) } else { None })
        .unwrap()
}

/// Checks that error and iterations of every pane equal those of a separate simulation, and are shown in its header.
fn panes_agree_with_solves(harness: &Harness<'_, Lab>) {
    let lab = harness.state();
    let reference = Reference::of(lab.scene()).unwrap();
    for (number, pane) in lab.panes().iter().enumerate() {
        let scene = pane.setting().apply(lab.scene());
        let mut alone = Simulation::new(&scene).unwrap();
        alone.solve();
        let end = pane.end().unwrap();
        assert_eq!((&end.status, end.iterations), (alone.status(), alone.iterations()), "{}", pane.setting());
        assert!(pane.seconds().is_some_and(|seconds| seconds > 0.0));
        if !alone.status().is_success() {
            continue;
        }
        let error = reference.first().unwrap().error_percent(&alone.solution().probes[0]).unwrap();
        assert!((pane.error_percent().unwrap() - error).abs() < 1e-6, "{}: {error}", pane.setting());
        let said = labels(harness).into_iter().find(|l| l.starts_with(&format!("Pane {}: ", number + 1))).unwrap();
        assert!(said.contains(&format!("error {}", percent(error))), "{said}");
        assert!(said.contains(&count(alone.iterations(), "iteration")), "{said}");
        assert!(said.contains(&pane.setting().of(lab.scene()).to_string()), "{said}");
    }
}

#[test]
fn presets_make_panes_with_the_results_of_independent_solves() {
    let mut harness = harness_of("article", scene("article"));
    harness.run();
    harness.key_press(Key::K);
    harness.step();
    wait(&mut harness, "the panes", are_judged);
    let methods = |lab: &Lab| lab.panes().iter().map(|pane| pane.setting().method).collect::<Vec<_>>();
    let expected = [MethodKind::Linear, MethodKind::Warped, MethodKind::Newton].map(Some);
    assert_eq!(methods(harness.state()), expected);
    panes_agree_with_solves(&harness);
    // The scene's own 30 kN is too large for the fixed-point iteration of more accurate elements.
    harness.get_by_label("t3 | t6 | q4").click();
    harness.step();
    wait(&mut harness, "the panes", are_judged);
    let elements: Vec<_> = harness.state().panes().iter().map(|pane| pane.setting().element).collect();
    assert_eq!(elements, [ElementKind::T3, ElementKind::T6, ElementKind::Q4].map(Some));
    panes_agree_with_solves(&harness);
    // Panes follow the panel in all settings except their own.
    let newton = scene_with("article", &["solver.method=\"newton\""]);
    harness.state_mut().set_scene(newton).unwrap();
    harness.step();
    wait(&mut harness, "the panes", are_judged);
    assert!(harness.state().panes().iter().all(|p| p.scene().unwrap().solver.method == MethodKind::Newton));
    panes_agree_with_solves(&harness);
    // A pane can be closed if more than two are left.
    harness.get_by_label("Close pane 2").click();
    harness.step();
    harness.step();
    assert_eq!(harness.state().panes().len(), 2);
    assert!(harness.query_by_label("Close pane 1").is_none());
}

/// Large meshes are solved in the background, and a pane with an iteration limit stops at it.
#[test]
fn large_panes_and_stopped_ones_agree_with_solves_too() {
    let mut harness = compared("cantilever", "newton:t3:100x21,warped:4,warped");
    let lab = harness.state();
    panes_agree_with_solves_of(lab, 0);
    panes_agree_with_solves_of(lab, 2);
    let stopped = lab.panes()[1].end().unwrap();
    assert_eq!((&stopped.status, stopped.iterations), (&Status::Running, 4));
    // If the load changes during a solve, the result is that of the last load, and no result of one load is judged by the
    // reference solution of another.
    let before = harness.state().panes()[0].error_percent().unwrap();
    let is_judged_rightly = |lab: &Lab| {
        let error = lab.panes()[0].error_percent();
        assert!(error.is_none_or(|error| (error - before).abs() < 0.2 * before), "{error:?} %, before {before} %");
    };
    for force in [-2000.0, -1500.0] {
        let changed = scene_with("cantilever", &[&format!("load.0.force=[0,{force}]")]);
        harness.state_mut().set_scene(changed).unwrap();
        for _ in 0..4 {
            harness.step();
            is_judged_rightly(harness.state());
        }
    }
    wait(&mut harness, "the panes", are_judged);
    assert!(harness.state().panes().iter().all(|pane| load(pane.scene().unwrap()) == 1500.0));
    panes_agree_with_solves_of(harness.state(), 0);
}

fn panes_agree_with_solves_of(lab: &Lab, number: usize) {
    let pane = &lab.panes()[number];
    let mut alone = Simulation::new(&pane.setting().apply(lab.scene())).unwrap();
    alone.solve();
    let end = pane.end().unwrap();
    assert_eq!((&end.status, end.iterations), (alone.status(), alone.iterations()), "{}", pane.setting());
    assert!((end.probes[0].u - alone.solution().probes[0].u).norm() < 1e-12);
}

#[test]
fn panes_that_do_not_converge_are_named() {
    let harness = compared("article", "warped:t3,warped:t6,newton:t6");
    let labels = labels(&harness);
    let failed = labels.iter().find(|label| label.starts_with("Pane 2: warped t6 5×1: ")).unwrap();
    assert!(failed.contains("Does not converge: "), "{failed}");
    assert!(!labels.iter().any(|label| label.contains(": newton") && label.contains("does not converge")));
}

/// While a load is dragged, each frame has a result of every pane.
#[test]
fn panes_follow_a_dragged_load() {
    let mut harness = compared("article", "linear,warped,newton");
    harness.hover_at(egui::pos2(1100.0, 600.0));
    harness.run();
    for (i, newtons) in [26e3, 24e3, 22e3].into_iter().enumerate() {
        harness.hover_at(egui::pos2(1100.0, 605.0 + 5.0 * i as f32));
        let dragged = scene_with("article", &[&format!("load.0.force=[0,-{newtons}]")]);
        harness.state_mut().set_scene(dragged).unwrap();
        harness.step();
        wait(&mut harness, "the panes", |lab| {
            lab.panes().iter().all(|p| *p.simulation().unwrap().status() == Status::Converged)
        });
    }
    wait(&mut harness, "the panes", are_judged);
    panes_agree_with_solves(&harness);
}

/// While a dragged load makes a pane diverge, its huge stresses do not set the common range of colours.
#[test]
fn a_diverging_pane_does_not_set_the_range_of_colours() {
    let mut harness = compared("cantilever", "linear,warped,newton");
    let mut has_diverged = false;
    // The pointer is pressed, as while a load is dragged.
    harness.hover_at(egui::pos2(1100.0, 600.0));
    harness.drag_at(egui::pos2(1100.0, 600.0));
    for i in 0..60_u8 {
        harness.hover_at(egui::pos2(1100.0, 600.0 + f32::from(i)));
        let dragged = scene_with("cantilever", &[&format!("load.0.force=[0,-{}]", 1e3 + 1e2 * f64::from(i))]);
        harness.state_mut().set_scene(dragged).unwrap();
        harness.step();
        let panes = harness.state().panes();
        let [linear, warped] = [0, 1].map(|number| panes[number].simulation().unwrap());
        let largest = |simulation: &Simulation| simulation.displacement().iter().map(|u| u.norm()).fold(0.0, f64::max);
        has_diverged |= largest(warped) > 2.0 * largest(linear);
        let high = panes[1].color_range()[1];
        assert!(high < 1e6, "{high} Pa under {} N", load(harness.state().scene()));
    }
    assert!(has_diverged);
}

/// Asserts that the body of every pane is drawn with this multiple of its displacement.
fn bodies_are_drawn(harness: &mut Harness<'_, Lab>, magnification: f64) {
    let Ok(gpu) = Gpu::headless() else { return };
    let drawn = picture(&gpu, harness.state_mut(), [1280, 800], 1.0, egui::Theme::Dark).unwrap();
    let lab = harness.state();
    let background = lab.frame().background;
    let at_rest = lab.panes().iter().map(|pane| (pane.place(), pane.simulation()));
    let moving = lab.motion_panes().iter().map(|pane| (pane.place(), pane.simulation()));
    for (place, simulation) in at_rest.chain(moving).filter_map(|(place, simulation)| place.zip(simulation)) {
        let mesh = simulation.system().mesh();
        let at = |n: u32| mesh.nodes()[n as usize] + simulation.displacement()[n as usize] * magnification;
        let mut seen = 0;
        for nodes in mesh.elements() {
            let middle = (at(nodes[0]) + at(nodes[1]) + at(nodes[2])) / 3.0;
            let [x, y] = lab.camera().to_view(middle);
            let pixel = pixel(&drawn, (place.center().x + x as f32) as u32, (place.center().y + y as f32) as u32);
            seen += u32::from(distance(pixel, background) > 8);
        }
        assert_eq!(seen as usize, mesh.element_count(), "{place}: the body is elsewhere");
    }
}

/// All panes magnify the displacement alike, and say so; the automatic factor is common.
#[test]
fn panes_magnify_the_displacement() {
    let mut stiff = scene("cantilever");
    stiff.material.young *= 1e4;
    let mut harness = harness_of("cantilever", stiff);
    harness.state_mut().show_comparison(&parse_panes("linear,warped,newton:t6").unwrap());
    wait(&mut harness, "the panes", are_judged);
    let factor = |text: &str| text.trim_start_matches("displacement × ").parse::<f64>().unwrap();
    for (magnification, wanted) in [(Magnification::Factor(400.0), Some(400.0)), (Magnification::Automatic, None)] {
        harness.state_mut().magnify(magnification);
        harness.run();
        let texts = painted(&harness, "displacement × ");
        let [(_, text)] = texts.as_slice() else { panic!("{texts:?}") };
        assert!(wanted.is_none_or(|wanted| factor(text) == wanted) && factor(text) > 10.0, "{text}");
        let factor = factor(text);
        bodies_are_drawn(&mut harness, factor);
    }
}

/// Panes of motions magnify the displacement, and say so; the automatic factor is that of the largest displacement so far.
#[test]
fn panes_of_motions_magnify_the_displacement() {
    let mut weak = scene("chime");
    weak.scale_loads(0.05);
    let mut harness = harness_of("chime", weak);
    harness.step();
    harness.key_press(Key::K);
    wait(&mut harness, "motions", |lab| lab.motion_panes().iter().all(|pane| pane.simulation().is_some()));
    let moves = |lab: &Lab| {
        let bodies = lab.motion_panes().iter().filter_map(|pane| pane.simulation());
        bodies.flat_map(|body| body.displacement()).any(|u| u.norm() > 1e-5)
    };
    wait(&mut harness, "a displacement", moves);
    harness.key_press(Key::Space);
    harness.run_steps(2);
    let mut shown = |magnification: Magnification| {
        harness.state_mut().magnify(magnification);
        harness.run_steps(60);
        let texts = painted(&harness, "displacement × ");
        let [(_, text)] = texts.as_slice() else {
            panic!("{texts:?} {:?} {:?}", painted(&harness, ""), labels(&harness))
        };
        let factor = text.trim_start_matches("displacement × ").parse::<f64>().unwrap();
        bodies_are_drawn(&mut harness, factor);
        factor
    };
    assert_eq!(shown(Magnification::Factor(10.0)), 10.0);
    assert!(shown(Magnification::Automatic) > 2.0);
}

/// All panes share one camera: a pan in one moves the body in all of them, to where it is drawn.
#[test]
fn panning_one_pane_pans_all() {
    let mut harness = compared("article", "linear,warped,newton,newton:t6");
    let before = harness.state().camera();
    let place = harness.state().panes()[1].place().unwrap();
    let from = place.left_bottom() + egui::vec2(20.0, -20.0);
    harness.hover_at(from);
    harness.step();
    harness.drag_at(from);
    harness.step();
    harness.hover_at(from + egui::vec2(15.0, -9.0));
    harness.step();
    harness.drop_at(from + egui::vec2(15.0, -9.0));
    harness.run();
    let after = harness.state().camera();
    let moved = (after.center - before.center) * before.scale;
    assert!((moved.x + 15.0).abs() < 0.1 && (moved.y + 9.0).abs() < 0.1, "{before:?} {after:?}");
    assert_eq!(after.scale, before.scale);

    bodies_are_drawn(&mut harness, 1.0);
    harness.key_press(Key::F);
    harness.run();
    assert_eq!(harness.state().camera(), before);
}

/// Every control exists, has a name, and is inside the window, down to 640×480.
#[test]
fn compare_fits_small_windows() {
    let mut harness = compared("article", "linear,warped,newton,newton:t6");
    for size in [[1280.0, 800.0], [800.0, 700.0], [800.0, 480.0], [640.0, 480.0]] {
        harness.set_size(size.into());
        harness.run();
        let window = egui::Rect::from_min_size(egui::Pos2::ZERO, size.into());
        for number in 1..=4 {
            for what in ["method", "element", "mesh"] {
                let name = format!("Pane {number} {what}");
                let rect = harness.get_by_role_and_label(Role::ComboBox, &name).rect();
                assert!(window.contains_rect(rect), "{size:?}: {name} at {rect:?}");
            }
            let rect = harness.get_by_label(&format!("Close pane {number}")).rect();
            assert!(window.contains_rect(rect), "{size:?}: {rect:?}");
            let place = harness.state().panes()[number - 1].place().unwrap();
            assert!(
                window.contains_rect(place) && place.width() >= 260.0 && place.height() >= 90.0,
                "{size:?}: {place:?}"
            );
        }
        let names = ["Explore", "Compare", "Budget", "linear | warped | newton", "t3 | t6 | q4", "+ Pane", "Panel"];
        let rects: Vec<_> = names.iter().map(|name| harness.get_by_label(name).rect()).collect();
        for (i, rect) in rects.iter().enumerate() {
            assert!(window.contains_rect(*rect), "{size:?}: {} at {rect:?}", names[i]);
            assert!(rects[..i].iter().all(|other| !other.intersects(*rect)), "{size:?}: {} is covered", names[i]);
        }
    }
}

/// The picker of a pane changes that pane only.
#[test]
fn pickers_change_their_pane_alone() {
    let mut harness = compared("article", "linear,newton");
    pick(&mut harness, "Pane 2 mesh", "20×4");
    wait(&mut harness, "the panes", are_judged);
    let settings: Vec<PaneSetting> = harness.state().panes().iter().map(|pane| *pane.setting()).collect();
    assert_eq!(settings, parse_panes("linear,newton:20x4").unwrap());
    assert_eq!(harness.state().scene().beam.as_ref().unwrap().cells, [5, 1]);
    panes_agree_with_solves(&harness);
}

/// Returns the positions of painted texts with this beginning, and the texts.
fn painted(harness: &Harness<'_, Lab>, begin: &str) -> Vec<(egui::Pos2, String)> {
    fn texts(shape: &egui::Shape, found: &mut Vec<(egui::Pos2, String)>) {
        match shape {
            egui::Shape::Text(text) => found.push((text.pos, text.galley.text().to_owned())),
            egui::Shape::Vec(shapes) => shapes.iter().for_each(|shape| texts(shape, found)),
            _ => {}
        }
    }
    let mut found = Vec::new();
    harness.output().shapes.iter().for_each(|clipped| texts(&clipped.shape, &mut found));
    found.retain(|(_, text)| text.starts_with(begin));
    found
}

/// Every pane shows the value at the point of the body under the pointer, for any mesh.
#[test]
fn every_pane_shows_its_value_at_the_point_under_the_pointer() {
    let mut harness = compared("article", "linear,warped,newton:t6");
    let panes = |lab: &Lab| -> Vec<egui::Rect> { lab.panes().iter().map(|pane| pane.place().unwrap()).collect() };
    let places = panes(harness.state());
    // Near the clamp, the bodies of all panes overlap.
    let lab = harness.state();
    let pane = lab.panes()[1].simulation().unwrap();
    let rest = nalgebra::Vector2::new(1.0, 0.1);
    let mesh = pane.system().mesh();
    let weights = mesh.weights(mesh.locate(rest).unwrap()).unwrap();
    let u: nalgebra::Vector2<f64> = weights.iter().map(|&(n, w)| pane.displacement()[n as usize] * w).sum();
    let [x, y] = lab.camera().to_view(rest + u);
    harness.hover_at(places[1].center() + egui::vec2(x as f32, y as f32));
    harness.step();
    harness.step();
    let said = painted(&harness, "von Mises (Cauchy): ");
    assert_eq!(said.len(), 3, "{said:?}");
    for (place, (at, text)) in places.iter().zip(&said) {
        assert!(place.contains(*at), "{text} at {at:?}, not in {place:?}");
    }
    assert!(
        said[1].1.contains(&format!("u = {}", {
            let round = [u.x, u.y].map(warpbeam::format::three_digits);
            warpbeam::format::engineering_pair(round, "m")
        })),
        "{said:?} {u}"
    );
    // Away from the body no value is shown.
    harness.hover_at(places[1].left_bottom() + egui::vec2(8.0, -8.0));
    harness.step();
    harness.step();
    assert!(painted(&harness, "von Mises (Cauchy): ").is_empty());
}

/// A motion is compared in panes of its own, while the panes of equilibria are inactive.
#[test]
fn motions_have_panes_of_their_own() {
    let mut harness = harness_of("swing", scene("swing"));
    harness.step();
    harness.key_press(Key::K);
    harness.step();
    harness.step();
    assert!(harness.state().panes().iter().all(|pane| pane.place().is_none()));
    assert!(harness.state().motion_panes().iter().all(|pane| pane.place().is_some()));
}

/// Panes of a paused scene are paused in their headers too.
#[test]
fn paused_panes_are_paused_everywhere() {
    let mut harness = harness_of("article", scene("article"));
    harness.run();
    harness.get_by_label("Step").click();
    harness.run_steps(2);
    harness.state_mut().show_comparison(&parse_panes("linear,newton").unwrap());
    harness.run_steps(5);
    let labels = labels(&harness);
    assert!(labels.iter().any(|label| label.contains("paused")), "{labels:?}");
    assert!(!labels.iter().any(|label| label.contains("iterating")), "{labels:?}");
}
