//! Tests of pointer interaction with the body, its loads and its values, and of edits, without a display or a GPU.

use crate::common::lab::*;
use crate::numbers::Shown;
use egui::os::OperatingSystem;

/// The dragged tip sets force and direction; arrow, sliders and `solve` agree.
#[test]
fn dragging_the_tip_of_the_arrow_sets_the_force() {
    let mut ui = open("cantilever");
    let (camera, usual, before, start) = (ui.camera(), -ui.force()[1], ui.tip(), ui.on_body([10.0, 0.0]));
    let vector = before + vec2(-30.0, -12.0) - start;
    ui.drag(before, start + vector);
    let [fx, fy] = ui.force();
    let wanted = f64::from(-vector.y).atan2(f64::from(vector.x)).to_degrees();
    let direction = fy.atan2(fx).to_degrees();
    assert!((direction - wanted).abs() < 0.6, "the arrow points to {wanted}°, the force to {direction}°");
    let shorter = f64::from(vector.length() / (before - start).length());
    assert!((fx.hypot(fy) / usual - shorter).abs() < 0.02, "an arrow of {shorter} times the length: {fx} {fy}");
    let shown = ui.field("Direction");
    assert!(shown.starts_with(&format!("{direction:.0}")), "{shown} {direction}");
    is_solved(&ui, &["cantilever", "--set", &format!("load.0.force=[{fx},{fy}]")]);
    // The arrow keeps its dragged length, wherever the body has moved.
    let length = (ui.tip() - ui.on_body([10.0, 0.0])).length();
    assert!((length - vector.length()).abs() < 1.5, "{length} {}", vector.length());
    assert_ne!(ui.camera(), camera, "the view did not follow the body afterwards");
    // A double click on the tip resets the force; it does not fit the view.
    ui.double_click(ui.tip());
    assert_eq!(ui.force(), [0.0, -usual]);
}

/// Asserts that the body is the one that `solve` finds.
pub fn is_solved(ui: &Ui, args: &[&str]) {
    let (u, solved) = (ui.simulation().solution().probes[0].u, solve_u(args));
    assert_eq!(*ui.simulation().status(), Status::Converged);
    assert!((u - solved).norm() < 1e-5 * u.norm(), "{u} {solved}");
}

/// A pixel changes the force of a scene as it is opened by 1 to 2 %, and by a tenth of that with Ctrl.
#[test]
fn an_arrow_of_twice_the_length_is_twice_the_force() {
    for id in ["article", "cantilever", "elastica", "clip", "jump"] {
        let mut ui = open(id);
        let size = |ui: &Ui| ui.force()[0].hypot(ui.force()[1]);
        let (own, to) = (size(&ui), ui.tip());
        let vector = to - ui.state().arrow_feet()[0];
        ui.drag(to, to + vector);
        assert!((size(&ui) / (2.0 * own) - 1.0).abs() < 0.02, "{id}: {own} N, then {} N", size(&ui));
        ui.undo();
        for (modifiers, part) in [(Modifiers::NONE, 1.0), (Modifiers::CTRL, 0.1)] {
            ui.drag_with(modifiers, ui.tip(), ui.tip() + vector.normalized() * 10.0);
            let rate = (size(&ui) / own - 1.0) / 10.0;
            assert!((0.01 * part..=0.0205 * part).contains(&rate), "{id}: {rate} a point, {modifiers:?}");
            assert!(ui.simulation().status().is_success(), "{id}");
            ui.undo();
        }
    }
}

/// Where the state diverges, the body and all its numbers are those of the last equilibrium.
#[test]
fn numbers_beside_the_last_equilibrium_are_its_own() {
    let mut ui = open("article");
    unfold(&mut ui, "stable");
    let rows = |ui: &Ui, names: &[&str]| -> Vec<String> {
        let shown = Shown::labels(ui);
        names.iter().map(|name| if shown.has(name) { shown.row(name).to_owned() } else { String::new() }).collect()
    };
    let details = |ui: &Ui| rows(ui, &["tip Δx, Δy", "Energy", "Equilibrium", "Iterations", "ρ"]);
    let quality = |ui: &Ui| rows(ui, &["Error in energy", "Stress", "Strain"]);
    let (before, quality_before) = (details(&ui), quality(&ui));
    assert!(quality_before[1].contains("797 kPa"), "{quality_before:?}");
    assert!(before[0].ends_with(" m") && before[1].ends_with("kJ"), "{before:?}");
    assert!(before[3].starts_with("21 since the last change, residual"), "{before:?}");
    assert!(before[4].contains("ρ = 0.47"), "{before:?}");
    let scale = ui.camera().scale;
    ui.type_into("Force", "176000 N");
    assert!(matches!(ui.simulation().status(), Status::Diverged(_)));
    assert!((ui.camera().scale / scale - 1.0).abs() < 0.3, "the view follows the iterates");
    assert_eq!(ui.query_all_by_label("equilibrium at 30 kN; 176 kN not reached").count(), 2);
    let mut now = details(&ui);
    now[3] = now[3].replace("to the state that is drawn", "since the last change");
    now[4] = now[4].replace("At 30 kN: ", "");
    assert_eq!(now, before);
    // Stress, strain and mesh error are those of the drawn state, and ρ is that of the equilibrium not reached.
    ui.state_mut().solve();
    ui.run();
    assert_eq!(quality(&ui), quality_before);
    ui.expect(&["ERROR \u{2013}", "TIME \u{2013}"]);
    ui.state_mut().solve();
    ui.run();
    ui.expect(&["ρ 4.9 at 176 kN"]);
    assert!(!ui.says("equilibrium of an earlier load"), "it is said once");
    ui.type_into("Direction", "-60");
    assert!(ui.says("equilibrium at 30 kN towards -90°; 176 kN towards -60° not reached"));
    ui.type_into("Direction", "-90");
    ui.click("Use newton");
    assert!(!ui.says("not reached") && *ui.simulation().status() == Status::Converged);
    assert_ne!(details(&ui), before);
}

/// The pane agrees with the panel also after a load was dragged over several equilibria.
#[test]
fn a_pane_with_the_panels_setting_shows_the_equilibrium_of_the_panel() {
    let mut ui = open("article");
    unfold(&mut ui, "stable");
    ui.click("Compare");
    let at = ui.slider("Force");
    ui.hold(at(0.4));
    ui.run_steps(3);
    for share in [0.42, 0.44, 0.5, 0.55, 0.6, 0.63, 0.66, 0.7, 0.75, 0.8] {
        ui.hover_at(at(share));
        ui.run_steps(4);
    }
    ui.release(at(0.8));
    let notes: Vec<_> = painted(&ui).into_iter().map(|(_, text)| text).filter(|s| s.contains("not reached")).collect();
    assert!(notes.len() >= 2 && notes.iter().all(|note| *note == notes[0]), "{notes:?} {:?}", ui.force());
}

/// Rest is the equilibrium without load; no number of the state that diverges is shown.
#[test]
fn a_scene_that_opens_with_too_large_a_load_shows_the_body_at_rest() {
    let mut ui = open_of("article", scene_with("article", &["load.0.force=[0,-176e3]"]));
    unfold(&mut ui, "stable");
    assert!(matches!(ui.simulation().status(), Status::Diverged(_)));
    assert_eq!(ui.query_all_by_label("equilibrium at 0 N; 176 kN not reached").count(), 2);
    assert_eq!(Shown::labels(&ui).row("tip Δx, Δy"), "(0, 0) m");
    ui.expect(&["ERROR \u{2013}"]);
    ui.click("Use newton");
    assert!(!ui.says("not reached"));
    assert_eq!(*ui.simulation().status(), Status::Converged);
}

/// Its error may come from the early stop; it is not said to be another equilibrium.
#[test]
fn an_accepted_result_has_an_error_and_an_explanation() {
    let set = ["article", "--set", "solver.accept_after=3", "--set", "load.0.force=[0,-60000]"];
    let error = percent(solve_error(&set[..3]));
    let mut ui = open_solved("article", scene_with("article", &[set[2]]));
    ui.run_steps(4);
    ui.get_by_label(&format!("ERROR {error} mesh or iteration · nodal strain 55 %"));
    ui.get_by_label("Accepted · 3 iterations");
    assert!(!ui.says("another equilibrium"));
    ui.click("explain");
    ui.expect(&["Accepted after 3 iterations from rest, as the scene asks: the relative residual is 0.02"]);
    // The remedy of an early stop is to go on, not a finer mesh.
    ui.get_by_label("47 % error: the iteration is stopped early.");
    ui.click_for("Iterate to the tolerance", 1);
    assert_eq!(ui.scene().solver.accept_after, 0);
    wait(&mut ui, "equilibrium", |lab| *lab.simulation().status() == Status::Converged);
    // The number can be typed; beyond ρ = 1 a result is said to diverge if it runs on.
    ui.type_into("Accept after", "3");
    assert_eq!(ui.scene().solver.accept_after, 3);
    ui.type_into("Force", "60000 N");
    settle(&mut ui);
    ui.get_by_label("Accepted · 3 iterations · diverges if it runs on");
    // It does not depend on the state before.
    let error = percent(solve_error(&set));
    assert!(ui.texts().iter().any(|text| text.starts_with(&format!("ERROR {error} "))), "{error}");
    ui.get_by_label(&format!("{error} error: the iteration is stopped early."));
    ui.get_by_label("Use newton").click();
    wait(&mut ui, "equilibrium", |lab| *lab.simulation().status() == Status::Converged);
    assert_eq!(ui.scene().solver.accept_after, 0);
}

/// Like TIME, the iterations are those from rest, whatever the load before was, and after an edit that needs none.
#[test]
fn iterations_are_counted_from_rest() {
    let mut ui = open("article");
    for force in ["32000", "33000", "32000"] {
        ui.type_into("Force", &format!("{force} N"));
        settle(&mut ui);
        let solved = solve_json(&["article", "--set", &format!("load.0.force=[0,-{force}]")]);
        ui.get_by_label(&format!("Converged · stable · {} iterations", solved["iterations"]));
        assert_ne!(Some(u64::from(ui.simulation().iterations())), solved["iterations"].as_u64());
    }
    unfold(&mut ui, "Held at");
    ui.push("Probe");
    settle(&mut ui);
    assert_eq!(ui.simulation().iterations(), 0);
    ui.expect(&["Converged · stable · 24 iterations"]);
}

#[test]
fn a_held_body_has_no_note_of_another_equilibrium() {
    let mut ui = open_solved("article", scene("article").with_element(ElementKind::T6).with_method(MethodKind::Newton));
    ui.run_steps(40);
    let pos = ui.on_body([2.5, 0.0]);
    ui.hold(pos);
    (1..20_u8).for_each(|step| ui.move_to(pos + vec2(0.0, -6.0 * f32::from(step))));
    ui.run_steps(60);
    assert!(ui.simulation().mouse_spring().is_some() && !ui.says("another equilibrium"));
    assert_eq!(*ui.simulation().status(), Status::Converged);
}

/// Shift makes the direction a multiple of 15°. An arrow dragged onto its foot is a zero force.
#[test]
fn shift_snaps_the_direction_and_a_force_can_be_dragged_away_and_back() {
    let mut ui = open("cantilever");
    ui.drag_with(Modifiers::SHIFT, ui.tip(), ui.tip() + vec2(31.0, 4.0));
    let [fx, fy] = ui.force();
    let direction = fy.atan2(fx).to_degrees();
    assert!((direction / 15.0 - (direction / 15.0).round()).abs() < 1e-9 && direction != -90.0, "{direction}");
    ui.drag(ui.tip(), ui.on_body([10.0, 0.0]));
    assert_eq!((ui.force(), ui.simulation().status()), ([0.0, 0.0], &Status::Converged));
    ui.drag(ui.tip(), ui.tip() + vec2(0.0, -90.0));
    assert!(ui.force()[1] > 0.0, "{:?}", ui.force());
    // A press acts on the target under it in late frames, too: the pointer may have moved on before the next frame.
    let mut ui = open("cantilever");
    let pos = ui.tip();
    ui.hover(pos);
    ui.input_mut().events.extend([primary(pos, true), Event::PointerMoved(pos + vec2(-60.0, -45.0))]);
    ui.run_steps(2);
    assert!(ui.force()[0] < 0.0, "{:?}", ui.force());
    ui.release(pos + vec2(-60.0, -45.0));
}

/// A press takes the tip rather than the body below it, and the body rather than the background.
#[test]
fn a_press_takes_the_tip_or_the_body_or_the_view_and_never_two() {
    // An arrow along the beam, inwards, so that its tip is over the body.
    let mut ui = open_of("article", scene_with("article", &["load.0.force=[-2000,0]"]));
    let held = |ui: &mut Ui, at: Pos2, by: egui::Vec2, icon: egui::CursorIcon| {
        ui.hover(at);
        assert_eq!(ui.output().platform_output.cursor_icon, icon);
        let camera = ui.camera();
        ui.hold(at);
        ui.move_to(at + by);
        let is_pulled = ui.simulation().mouse_spring().is_some();
        let moved = (ui.camera().center - camera.center).norm();
        assert!(ui.camera() == camera || !is_pulled && moved < 1e-3, "the view moved");
        ui.release(at + by);
        is_pulled
    };
    let (tip, before) = (ui.tip(), ui.force());
    assert!(!held(&mut ui, tip, vec2(-25.0, 0.0), egui::CursorIcon::Move), "the body was taken with the tip");
    assert_ne!(ui.force(), before);
    let (body, before) = (ui.on_body([1.0, 0.0]), ui.force());
    assert!(held(&mut ui, body, vec2(0.0, 60.0), egui::CursorIcon::Grab));
    let (camera, space) = (ui.camera(), ui.state().view_rect().center() + vec2(0.0, 290.0));
    ui.drag(space, space + vec2(50.0, -30.0));
    assert_eq!(ui.force(), before);
    let moved = camera.to_world([0.0, 0.0]) - ui.camera().to_world([50.0, -30.0]);
    assert!(moved.norm() < 1e-2 / camera.scale.min(1.0), "the view did not follow the pointer: {moved}");
}

#[test]
fn a_scene_opened_while_another_is_paused_is_solved() {
    let mut ui = open("article");
    ui.open("Scene");
    ui.get_by_role_and_label(Role::Button, "swing").scroll_to_me();
    ui.run();
    ui.get_by_role_and_label(Role::Button, "swing").click();
    ui.run_steps(4);
    assert!(ui.simulation().motion().is_some());
    ui.key(Key::Space);
    ui.undo();
    assert_eq!((&*ui.scene().name, ui.simulation().status()), ("The article's beam", &Status::Converged));
}

/// A drag is one undo step, whatever its intermediate values.
#[test]
fn edits_are_undone_and_redone() {
    let mut ui = open("cantilever");
    let steps = |ui: &Ui| [ui.state().desk.session.undo.can_undo(), ui.state().desk.session.undo.can_redo()];
    let values = |ui: &Ui| (ui.force(), ui.scene().material.poisson);
    let (start, before) = (ui.scene().clone(), values(&ui));
    assert_eq!(steps(&ui), [false, false]);
    ui.drag(ui.tip(), ui.tip() + vec2(-30.0, -12.0));
    let dragged = values(&ui);
    unfold(&mut ui, "Poisson ν");
    let at = ui.slider("Poisson ν");
    ui.drag(at(0.3), at(0.6));
    let both = values(&ui);
    assert!(both.1 != before.1 && dragged != before);
    ui.undo();
    assert_eq!(values(&ui), dragged);
    ui.undo();
    assert_eq!((ui.scene(), ui.simulation().status(), steps(&ui)), (&start, &Status::Converged, [false, true]));
    ui.chord(Modifiers::COMMAND, Key::Y);
    ui.chord(COMMAND_SHIFT, Key::Z);
    assert_eq!((values(&ui), steps(&ui)[1]), (both, false));
    // Opening another scene is a step too; undo restores the previous scene with its edits.
    ui.open("Scene");
    ui.click("bridge");
    assert_eq!(ui.scene().name, "Bridge");
    ui.undo();
    assert_eq!(values(&ui), both);
    assert!(ui.state().title().contains("Cantilever*"), "{}", ui.state().title());
    let set = [format!("load.0.force={:?}", both.0), format!("material.poisson={}", both.1)];
    is_solved(&ui, &["cantilever", "--set", &set[0], "--set", &set[1]]);
}

/// A double click on a slider or its number, or Delete on the slider, restores the scene's own value in one step.
#[test]
fn values_go_back_to_those_of_the_scene() {
    let mut ui = open("cantilever");
    for (label, text) in
        [("Force", "77 N"), ("Direction", "-60"), ("Young E", "2e6 Pa"), ("Density", "77"), ("Cells along", "40")]
    {
        unfold(&mut ui, label);
        for by in [Some(Role::Slider), Some(Role::SpinButton), None] {
            ui.type_into(label, text);
            let edited = ui.scene().clone();
            assert_ne!(edited, scene("cantilever"), "{label}");
            if let Some(role) = by {
                ui.double_click(ui.rect(role, label).center());
                assert!(!ui.ctx.text_edit_focused(), "{label}: still being typed");
            } else {
                ui.focus(Role::Slider, label);
                ui.key(Key::Delete);
            }
            assert_eq!(*ui.scene(), scene("cantilever"), "{label} by {by:?}");
            ui.undo();
            assert_eq!(*ui.scene(), edited, "{label} by {by:?}: not one step");
            ui.undo();
            assert_eq!(*ui.scene(), scene("cantilever"), "{label} by {by:?}");
        }
    }
    let at = ui.slider("Force");
    ui.drag(at(0.4), at(0.5));
    let once = ui.scene().clone();
    ui.run_steps(10);
    ui.drag(at(0.5), at(0.6));
    ui.undo();
    assert_eq!(*ui.scene(), once);
    // The tooltip of the control says so, but not under the pointer that has just dragged it.
    for (away, is_said) in [(0.0, false), (400.0, true)] {
        ui.hover_at(at(0.5) - vec2(away, 0.0));
        ui.run_steps(2);
        ui.hover_at(at(0.3));
        ui.run_steps(60);
        assert_eq!(ui.says("Double click, or Delete on the slider: 1.5 kN"), is_said);
    }
}

fn moment(ui: &Ui) -> f64 {
    let mut loads = ui.scene().loads.iter();
    loads.find_map(|l| if let Load::Moment { moment, .. } = l { Some(*moment) } else { None }).unwrap()
}

/// The end of a moment's arrow is dragged around its centre: further is larger, back beyond the start turns its sense.
#[test]
fn the_end_of_a_moments_arrow_sets_it() {
    let mut ui = open("roll-up");
    let before = moment(&ui);
    let center = |lab: &Lab| {
        let mesh = lab.simulation().system().mesh();
        let (nodes, u) = (mesh.edge_nodes("right").unwrap(), lab.simulation().displacement());
        let sum: Vector2<f64> = nodes.iter().map(|&n| mesh.nodes()[n as usize] + u[n as usize]).sum();
        in_view(lab, sum / nodes.len() as f64)
    };
    // In many small steps; clockwise in the window decreases the moment.
    let turn = |ui: &mut Ui, degrees: f32, modifiers: Modifiers| {
        let (middle, from) = (center(ui.state()), ui.tip());
        ui.hold(from);
        ui.event(Event::ModifiersChanged(modifiers));
        let mut to = from;
        for i in 1..=8_u8 {
            let rotation = egui::emath::Rot2::from_angle(degrees.to_radians() * f32::from(i) / 8.0);
            to = middle + rotation * (from - middle);
            ui.hover(to);
        }
        ui.release(to);
        ui.event(Event::ModifiersChanged(Modifiers::NONE));
        ui.run();
    };
    turn(&mut ui, 30.0, Modifiers::NONE);
    let less = moment(&ui);
    assert!((0.75..0.82).contains(&(less / before)), "{before} {less}: 30° of 135° less");
    unfold(&mut ui, "Moment");
    assert_eq!(ui.field("Moment"), warpbeam::format::editable(less, "N m"));
    is_solved(&ui, &["roll-up", "--set", &format!("load.0.moment={less}")]);
    // Through zero to the opposite sense: the beam bends down.
    turn(&mut ui, 300.0, Modifiers::NONE);
    assert!(moment(&ui) < -0.01 * before && ui.simulation().solution().probes[0].u.y < 0.0, "{}", moment(&ui));
    ui.undo();
    assert_eq!(moment(&ui), less);
    turn(&mut ui, 20.0, Modifiers::SHIFT);
    assert_eq!(moment(&ui), 5e3);
    ui.undo();
    ui.undo();
    assert_eq!(*ui.scene(), scene("roll-up"));
    turn(&mut ui, 20.0, Modifiers::NONE);
    assert_ne!(moment(&ui), before);
    settle(&mut ui);
    ui.double_click(ui.tip());
    assert_eq!(moment(&ui), before);
}

/// The middle third of the slider has the scene's own force; small and large forces are within reach.
#[test]
fn the_force_slider_spans_what_a_slender_body_can_bear() {
    for id in ["article", "cantilever", "elastica", "bracket", "clip", "jump"] {
        let mut ui = open(id);
        let (own, at) = (ui.force()[0].hypot(ui.force()[1]), ui.slider("Force"));
        let mut press = |share: f32| {
            ui.hold(at(share));
            ui.drop_at(at(share));
            ui.step();
            ui.force()[0].hypot(ui.force()[1])
        };
        let [little, middle, much] = [0.12, 0.5, 0.97].map(&mut press);
        assert!(little < 0.4 * own, "{id}: {own} N is among the first points: {little} N are");
        assert!((1.0..2.0).contains(&(middle / own)), "{id}: {middle} N in the middle, for {own} N");
        assert!(press(1.0 / 3.0) < own && own < press(2.0 / 3.0), "{id}: {own} N is not in the middle third");
        assert!(much > 10.0 * own, "{id}: at most {much} N, for {own} N");
        assert!(press(0.0) == 0.0, "{id}: no force at the left end");
    }
}

/// The wheel may still turn when a scene is clicked, whose view shows the whole body.
#[test]
fn a_wheel_in_the_gallery_does_not_zoom_the_view() {
    let mut ui = open("article");
    ui.open("Scene");
    let entry = ui.rect(Role::Button, "cantilever").center();
    ui.hover(egui::pos2(entry.x, entry.y.clamp(100.0, 500.0)));
    ui.wheel(-40.0);
    ui.step();
    // Scrolls back up by a large distance, so that the list has scrolled further under the pointer.
    ui.wheel(400.0);
    ui.push("cantilever");
    let name = &ui.scene().name;
    let id = ids_of(Analysis::Static).into_iter().find(|id| *scene(id).name == **name).unwrap();
    assert_ne!(id, "article");
    let (camera, fitted) = (ui.camera(), open(id).camera());
    assert!((camera.scale / fitted.scale - 1.0).abs() < 1e-6, "{camera:?} {fitted:?}");
}

/// The gallery lists all scenes with descriptions, and fits in a window of any size.
#[test]
fn the_gallery_is_navigated_by_keys() {
    for size in [[640.0, 480.0], SIZE] {
        let mut ui = open("cantilever");
        ui.set_size(size.into());
        ui.run();
        ui.focus(Role::ComboBox, "Scene");
        ui.key(Key::Enter);
        ui.run_steps(20);
        for id in scene_ids() {
            let entry = ui.get_by_role_and_label(Role::Button, id);
            assert_eq!(entry.accesskit_node().description(), Some(scene(id).about), "{id}");
            let rect = entry.rect();
            assert!(rect.left() >= 0.0 && rect.right() <= size[0], "{size:?}: {id} at {rect:?}");
        }
        let window = Rect::from_min_size(Pos2::ZERO, size.into());
        let has_focus = |ui: &Ui, id| {
            let entry = ui.get_by_role_and_label(Role::Button, id);
            entry.accesskit_node().is_focused() && window.contains_rect(entry.rect())
        };
        assert!(has_focus(&ui, "cantilever"), "{size:?}");
        // Moves down to an entry that is not visible at first, and opens it.
        let is_reached = (0..60).any(|_| {
            ui.key(Key::Tab);
            ui.run_steps(24);
            has_focus(&ui, "chime")
        });
        assert!(is_reached, "{size:?}: the last scene cannot be reached");
        ui.key_press(Key::Enter);
        ui.run_steps(3);
        assert_eq!(ui.scene().name, "Chime");
        assert!(!ui.has(Role::Button, "cantilever"), "{size:?}: it stays open");
    }
}

/// The names of shortcuts have Cmd in place of Ctrl on macOS.
#[test]
fn shortcuts_have_the_names_of_the_system() {
    use OperatingSystem::{Mac, Nix, Windows};
    for (system, command, other) in [(Nix, "Ctrl", "Cmd"), (Windows, "Ctrl", "Cmd"), (Mac, "Cmd", "Ctrl")] {
        let mut ui = open("article");
        ui.ctx.set_os(system);
        ui.hover_at(ui.rect(Role::Button, "Undo").center());
        ui.run_steps(20);
        ui.get_by_label(&format!("Undo the last edit ({command}+Z)"));
        ui.key(Key::F1);
        ui.run();
        for key in ["O", "Shift+S"] {
            ui.get_by_label(&format!("{command}+{key}"));
            assert!(ui.query_by_label(&format!("{other}+{key}")).is_none(), "{system:?}: {other}+{key}");
        }
    }
}

/// A click opens a card with the numbers of the point.
#[test]
fn the_values_under_the_pointer_are_shown_and_a_click_keeps_them() {
    let mut ui = open("article");
    let is_open = |ui: &Ui| ui.state().probed().is_some();
    let at = Vector2::new(2.2, 0.3);
    let pos = ui.on_body(at);
    ui.hover(pos);
    assert!(!is_open(&ui));
    let before = ui.simulation().displacement().to_vec();
    ui.click_at(pos);
    let away = largest_distance(ui.simulation().displacement(), &before);
    assert!(away < 1e-6, "a click has moved the body by {away} m");
    let point = ui.simulation().point_state(ui.state().probed().unwrap(), PointValues::Recovered).unwrap();
    assert!((point.rest - at).norm() < 0.02, "{}", point.rest);
    ui.click("F, R, S");
    ui.expect(&[point.gradient.m11, point.rotation.c, point.stretch.m22].map(|number| format!("{number:.4}")));
    // The card follows the material point, not the position in the window.
    ui.edit(|_| {});
    ui.run();
    assert!(is_open(&ui));
    ui.key(Key::Escape);
    assert!(!is_open(&ui));
    ui.click_at(pos);
    assert!(is_open(&ui));
    ui.push("Close window");
    assert!(!is_open(&ui), "the button does not close the card");
    // A quick click is pressed and released between two frames.
    ui.hover(pos);
    ui.input_mut().events.extend([primary(pos, true), primary(pos, false)]);
    ui.run();
    assert!(is_open(&ui), "a quick click is missed");
    ui.key(Key::Escape);
    let pos = ui.on_body(at);
    ui.drag(pos, pos + vec2(0.0, 60.0));
    assert!(!is_open(&ui));
}

/// An animated view moves for some frames.
#[test]
fn the_eased_view_ends_where_the_other_jumps() {
    let [mut jumps, mut eases] = [open("elastica"), open("elastica")];
    eases.state_mut().set_easing(true);
    let before = eases.camera();
    for ui in [&mut jumps, &mut eases] {
        ui.edit(|scene| scene.set_force(0, [0.0, -30.0]).unwrap());
    }
    jumps.run();
    let goal = jumps.camera();
    assert!((goal.scale / before.scale - 1.0).abs() > 0.05);
    let mut is_between = false;
    for _ in 0..400 {
        eases.step();
        is_between |= ![before, goal].contains(&eases.camera());
    }
    assert!(is_between, "it jumps");
    assert_eq!(eases.camera(), goal);
}

/// Files are dropped, or opened and saved in a dialog. A file that another program has changed can be reloaded.
#[test]
fn files_are_dropped_opened_saved_and_offered_again() {
    let folder = tempfile::tempdir().unwrap();
    let [path, other] = ["mine.toml", "other.toml"].map(|name| folder.path().join(name));
    let mut own = scene("shear");
    own.name = "Mine".to_owned();
    std::fs::write(&path, own.to_toml().unwrap()).unwrap();
    let mut ui = open("article");
    ui.drop_file(&path);
    assert_eq!((&*ui.scene().name, ui.state().desk.session.undo.can_undo()), ("Mine", true));
    ui.drag(ui.tip(), ui.tip() + vec2(-6.0, -6.0));
    let edited = ui.scene().clone();
    assert!(ui.state().title().starts_with("Mine*"));
    ui.chord(Modifiers::COMMAND, Key::S);
    let title = ui.state().title();
    assert!(title.starts_with("Mine (") && title.contains("mine.toml"), "{title}");
    assert_eq!(read(&path), edited);
    ui.chord(COMMAND_SHIFT, Key::S);
    ui.replace_text("other");
    ui.key(Key::Enter);
    assert_eq!(read(&other), edited);
    // No other program has changed the file, so that no reload is offered. Then one does.
    own.name = "Theirs".to_owned();
    for is_changed in [false, true] {
        // A file with the same content has not changed, whatever its time.
        let later = std::fs::metadata(&other).unwrap().modified().unwrap() + std::time::Duration::from_secs(2);
        std::fs::File::options().write(true).open(&other).unwrap().set_modified(later).unwrap();
        if is_changed {
            std::fs::write(&other, own.to_toml().unwrap()).unwrap();
        }
        ui.event(Event::WindowFocused(true));
        ui.run();
        assert_eq!((&*ui.scene().name, ui.query_by_label("Reload").is_some()), ("Mine", is_changed));
    }
    ui.click("Reload");
    assert_eq!((&*ui.scene().name, ui.query_by_label("Reload").is_some()), ("Theirs", false));
    // Opens files in the dialog; an invalid scene is refused there, and the dialog stays open.
    std::fs::write(folder.path().join("bad.toml"), "name = 3").unwrap();
    ui.chord(Modifiers::COMMAND, Key::O);
    for (name, scene) in [("bad.toml", "Theirs"), ("mine.toml", "Mine")] {
        ui.push(name);
        ui.push("Open");
        assert_eq!((&*ui.scene().name, ui.query_by_label("Open a scene").is_some()), (scene, name == "bad.toml"));
        assert_eq!(ui.ctx.text_edit_focused(), name == "bad.toml", "a refused dialog keeps the cursor");
    }
    let mut names: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["bad.toml", "mine.toml", "other.toml"]);
}

fn read(path: &std::path::Path) -> Scene {
    Scene::from_toml(&std::fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn settings_go_from_one_lab_to_the_next() {
    let [mut first, mut second] = [open("article"), open("article")];
    first.state_mut().desk.view.color_with(Field::RotationAngle);
    [Key::P, Key::B, Key::T].into_iter().for_each(|key| first.key(key));
    let settings = first.state().settings(&first.ctx);
    assert_ne!(second.state().settings(&second.ctx), settings);
    let ctx = second.ctx.clone();
    second.state_mut().set_settings(&ctx, settings.clone());
    second.run();
    assert_eq!(second.state().settings(&second.ctx), settings);
    assert!(!second.has(Role::Slider, "Force"));
    assert_eq!(second.ctx.theme(), first.ctx.theme());
}

/// A moment moves the body, whatever the names of the edges.
#[test]
fn a_moment_needs_an_edge_that_can_rotate() {
    for (id, moment, held) in [("bracket", "200", "wall"), ("cook", "1", "clamp"), ("bridge", "500", "right")] {
        let mut ui = open(id);
        let before = ui.simulation().displacement().to_vec();
        ui.type_into("Moment", moment);
        let is_free = |load: &Load| matches!(load, Load::Moment { edge, .. } if edge != held);
        assert!(ui.scene().loads.iter().any(is_free), "{id}: a held edge cannot turn");
        assert!(largest_distance(ui.simulation().displacement(), &before) > 1e-6, "{id}: it does nothing");
    }
}

#[test]
fn loads_and_supports_are_put_on_other_edges() {
    let mut ui = open("cantilever");
    unfold(&mut ui, "Held at");
    ui.open("Force on");
    assert!(!ui.has(Role::Button, "left"), "a load on a held edge does nothing");
    ui.push("top");
    assert_eq!(ui.scene().loads, [Load::force("top", ui.force())]);
    assert_eq!(*ui.simulation().status(), Status::Converged);
    pick(&mut ui, "Held at", "right");
    assert_eq!(ui.scene().supports[0].place, "right".into());
    ui.undo();
    ui.undo();
    assert_eq!(*ui.scene(), scene("cantilever"));
    // A force is added with the size of the present ones, a probe at a point, which can be moved and removed.
    ui.push("Force");
    assert_eq!(forces(ui.scene()), [ui.force(); 2]);
    ui.undo();
    assert!(ui.rect(Role::Button, "Probe").right() < 1270.0, "it widens the panel");
    ui.push("Probe");
    assert!(matches!(ui.scene().probes[1].place, Place::At(_)), "{:?}", ui.scene().probes);
    pick(&mut ui, "Probe p1", "top");
    assert_eq!(ui.scene().probes[1].place, "top".into());
    ui.click("Remove the probe p1");
    assert_eq!(*ui.scene(), scene("cantilever"));
}

/// A question precedes the closing of the window. Another scene is opened without one; undo restores the edits.
#[test]
fn unsaved_edits_are_asked_about() {
    let closes = std::rc::Rc::new(std::cell::Cell::new(false));
    let asked = closes.clone();
    let mut ui = Ui(egui_kittest::Harness::builder().with_size(SIZE).with_max_steps(2000).build_ui_state(
        move |ui, lab: &mut Lab| {
            lab.advance(ui.input(|i| i.time));
            asked.set(asked.get() || lab.ui(ui).contains(&warpbeam::app::Request::Close));
        },
        lab_of("cantilever", scene("cantilever")),
    ));
    ui.run();
    let may_close = |ui: &mut Ui| {
        let ctx = ui.ctx.clone();
        let may_close = ui.state_mut().request_close(&ctx);
        ui.run();
        may_close
    };
    assert!(may_close(&mut ui), "nothing is edited");
    closes.set(false);
    ui.type_into("Force", "700 N");
    let edited = ui.scene().clone();
    let folder = tempfile::tempdir().unwrap();
    let [dropped, kept] = ["dropped.toml", "kept.toml"].map(|name| folder.path().join(name));
    std::fs::write(&dropped, scene("shear").to_toml().unwrap()).unwrap();
    ui.drop_file(&dropped);
    ui.undo();
    assert_eq!(*ui.scene(), edited);
    // Saves: a built-in scene has no file yet, and the window closes once it has one.
    assert!(!may_close(&mut ui), "it asks first");
    ui.key(Key::Enter);
    assert!(ui.query_by_label("Save the scene").is_some());
    ui.key(Key::Escape);
    assert!(ui.query_by_label("Save the scene").is_none(), "a cancelled file cancels the rest");
    assert!(!may_close(&mut ui), "it is still not saved");
    ui.push("Save");
    ui.replace_text(kept.to_str().unwrap());
    assert!(!closes.get());
    ui.key(Key::Enter);
    assert_eq!(read(&kept).loads, edited.loads);
    assert!(closes.get(), "it closes once the scene has a file");
    assert!(may_close(&mut ui), "all is saved");
}

/// The size of the cells is kept, supports, loads and probes at points of the beam move with it.
#[test]
fn a_beam_gets_another_length_and_height() {
    let mut ui = open("cantilever");
    let before = ui.scene().clone();
    let beam = before.beam.clone().unwrap();
    ui.type_into("Length", "12 m");
    ui.type_into("Height", "1.5 m");
    let after = ui.scene().beam.clone().unwrap();
    let cells = |along: f64, across: f64| {
        [along * f64::from(beam.cells[0]), across * f64::from(beam.cells[1])].map(|n| n.round().max(1.0) as u32)
    };
    let wanted = (12.0, 1.5, cells(12.0 / beam.length, 1.5 / beam.height));
    assert_eq!((after.length, after.height, after.cells), wanted);
    assert_eq!(*ui.simulation().status(), Status::Converged);
    ui.expect(&["Slenderness, length over height: 8"]);
    ui.undo();
    ui.undo();
    assert_eq!(*ui.scene(), before);
    // Many small changes add up to the right number of cells.
    for step in 1..=12 {
        ui.type_into("Length", &format!("{}", (1.0 + 0.0043 * f64::from(step)) * beam.length));
    }
    assert_eq!(ui.scene().beam.as_ref().unwrap().cells, cells(1.0516, 1.0));
}

/// Buttons alone turn a cantilever into a simply supported beam under two loads; every step can be undone.
#[test]
fn loads_and_supports_are_added_and_removed() {
    let mut ui = open("cantilever");
    let before = ui.scene().clone();
    unfold(&mut ui, "Add");
    let pick_place = |ui: &mut Ui, row: (&str, usize), place: &str| {
        ui.get_all_by_role_and_label(Role::ComboBox, row.0).nth(row.1).unwrap().click();
        ui.run();
        ui.get_by_role_and_label(Role::Button, place).scroll_to_me();
        ui.run();
        ui.push(place);
    };
    pick_place(&mut ui, ("Held at", 0), "lower left");
    assert_eq!(*ui.scene(), before, "a pin alone holds no body: refused");
    ui.push("Support");
    assert_eq!(ui.scene().supports.len(), 2);
    pick_place(&mut ui, ("Held at", 1), "lower right");
    pick_place(&mut ui, ("Held at", 0), "lower left");
    let beam = ui.scene().beam.as_ref().unwrap();
    for (support, x, fixed) in [(0, 0.0, 2), (1, beam.length, 1)] {
        let support = &ui.scene().supports[support];
        assert_eq!((&support.place, support.fix.len()), (&[x, -0.5 * beam.height].into(), fixed));
    }
    pick_place(&mut ui, ("Force on", 0), "top, middle");
    ui.push("Force");
    assert_eq!(ui.scene().loads.len(), 2);
    let first = ui.force();
    ui.open("Selected force");
    ui.get_by_label_contains("Force 2:").click();
    ui.run();
    ui.type_into("Force", "10 N");
    let [left, second] = forces(ui.scene())[..] else { panic!("{:?}", ui.scene().loads) };
    assert!(left == first && (second[0].hypot(second[1]) - 10.0).abs() < 1e-9, "{left:?} {second:?}");
    assert_eq!(*ui.simulation().status(), Status::Converged);
    let up: f64 = ui.simulation().support_reactions().iter().map(|r| r.force.y).sum();
    assert!((up + left[1] + second[1]).abs() < 1e-6 * up, "{up} {left:?} {second:?}");
    unfold(&mut ui, "Add");
    ui.push("Remove load 2");
    assert_eq!((ui.force(), ui.scene().loads.len()), (first, 1));
    while ui.state().desk.session.undo.can_undo() {
        ui.undo();
    }
    assert_eq!(*ui.scene(), before);
}

/// F, S, ε and σ agree with each other to the printed digits, and the card names their kind.
#[test]
fn the_card_of_a_point_is_of_one_deformation() {
    for (id, at) in [("article", [0.4, 0.45]), ("bracket", [0.1, 0.1]), ("jelly", [0.1, -0.2])] {
        let mut ui = open(id);
        ui.run_steps(20);
        if ui.scene().analysis == Analysis::Dynamic {
            ui.key(Key::Space);
        }
        let pos = ui.on_body(at);
        ui.hold(pos);
        ui.drop_at(pos);
        ui.run_steps(4);
        ui.click_for("F, R, S", 8);
        let point = ui.state().probed().unwrap();
        ui.hover_at(Pos2::new(5.0, 5.0));
        ui.fold("View: ");
        for (kind, values) in
            [("recovered at the nodes", PointValues::Recovered), ("element value, not smoothed", PointValues::Raw)]
        {
            ui.get_by_label(kind);
            let card = Shown::labels(&ui);
            let numbers = |name: &str| -> Vec<f64> {
                card.row(name).split([' ', '\n', '(', ')', ',']).filter_map(|word| word.parse().ok()).collect()
            };
            let [f, r, s] = ["F", "R", "S"].map(|name| nalgebra::Matrix2::from_row_slice(&numbers(name)));
            // Four decimals are printed.
            assert!((f - r * s).amax() < 3e-4, "{id} {kind}: {card:?}");
            let strains = (s - nalgebra::Matrix2::identity()).symmetric_eigenvalues() * 100.0;
            for (strain, printed) in [strains.max(), strains.min()].into_iter().zip(numbers("ε_1, ε_2")) {
                assert!((strain - printed).abs() < 0.011 + 0.006 * printed.abs(), "{id} {kind}: {strain} % {card:?}");
            }
            let state = ui.simulation().point_state(point, values).unwrap();
            let stress = engineering(three_digits(state.field(Field::VonMises).unwrap()), "Pa");
            assert_eq!(card.row("von Mises"), stress, "{id} {kind}");
            assert!((state.stretch - s).amax() < 6e-5, "{id} {kind}: {card:?}");
            ui.get_by_role_and_label(Role::CheckBox, "Each element alone").scroll_to_me();
            ui.run_steps(4);
            ui.get_by_role_and_label(Role::CheckBox, "Each element alone").click();
            ui.run_steps(4);
        }
    }
}

#[test]
fn the_colour_bar_is_not_on_the_arrow_of_a_weight() {
    for size in [[640.0, 480.0], SIZE] {
        let mut ui = open("gravity");
        ui.set_size(size.into());
        ui.run();
        let (pos, _) = painted(&ui).into_iter().find(|(_, text)| text.starts_with("von Mises")).unwrap();
        let bar = Rect::from_min_size(pos, vec2(170.0, 46.0));
        // The shafts of arrows are three points wide.
        let mut arrows = Vec::new();
        for (_, shape) in shapes(&ui) {
            if let egui::Shape::LineSegment { points: [a, b], stroke } = shape
                && stroke.width == 3.0
            {
                arrows.push(Rect::from_two_pos(a, b));
            }
        }
        assert!(arrows.len() == 1 && !bar.intersects(arrows[0]), "{size:?}: {bar:?} on {arrows:?}");
    }
}

/// The colour bar leaves the arrow's tip free in the fitted view, whatever the force is.
#[test]
fn the_colour_bar_is_not_on_the_tip_of_an_arrow() {
    let mut met = 0;
    for (id, most) in [("article", 1.6), ("cantilever", 4.0), ("incline", 4.0)] {
        for part in [0.0, 0.2, 0.4, 0.6, 0.8, 1.0] {
            let mut ui = open(id);
            let factor = 1.0 + (most - 1.0) * part;
            ui.edit(|scene| {
                scene.solver.method = MethodKind::Newton;
                scene.set_force(0, force(scene).map(|v| v * factor)).unwrap();
            });
            ui.run();
            let corner = ui.state().view_rect().right_bottom();
            let (bar, tip) = (Rect::from_min_max(corner - vec2(286.0, 66.0), corner), ui.tip());
            met += i32::from(bar.x_range().contains(tip.x));
            assert!(!bar.contains(tip), "{id}, {factor}: {tip:?} in {bar:?}");
        }
    }
    assert!(met > 0, "no arrow is over the bar");
}

/// A question precedes another scene in place of an edited file. The key that opens the scene does not answer it.
#[test]
fn enter_in_the_gallery_answers_no_question() {
    let mut ui = open("cantilever");
    let own = tempfile::Builder::new().suffix(".toml").tempfile().unwrap();
    let question = format!("Save the changes to \u{201c}{}\u{201d}?", own.path().file_name().unwrap().display());
    std::fs::write(&own, ui.scene().to_toml().unwrap()).unwrap();
    ui.drop_file(own.path());
    ui.type_into("Force", "700 N");
    let edited = ui.scene().clone();
    for answer in ["Escape", "Cancel", "Discard", "Save"] {
        ui.open("Scene");
        ui.get_by_label("bridge").focus();
        ui.step();
        ui.key(Key::Enter);
        ui.get_by_label(&question);
        // Shortcuts of the window are inactive until the question is answered.
        ui.key(Key::P);
        assert!(ui.has(Role::Slider, "Force"));
        match answer {
            "Escape" => ui.key(Key::Escape),
            "Save" => ui.key(Key::Enter),
            answer => ui.push(answer),
        }
        assert!(ui.query_by_label(&question).is_none());
        assert_eq!(ui.scene().name == "Bridge", ["Discard", "Save"].contains(&answer), "{answer}");
        if answer == "Discard" {
            ui.undo();
        }
        let is_saved = read(own.path()) == edited;
        assert_eq!((*ui.scene() != edited, is_saved), (answer == "Save", answer == "Save"), "{answer}");
    }
}

/// Ctrl+S asks for another file then, and replaces the own one only if told so.
#[test]
fn a_file_changed_by_another_program_is_not_overwritten_without_a_question() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    let [own, theirs] = ["cantilever", "shear"].map(|id| scene(id).to_toml().unwrap());
    std::fs::write(&path, &own).unwrap();
    let mut ui = open("article");
    let text = || std::fs::read_to_string(&path).unwrap();
    ui.drop_file(&path);
    ui.type_into("Force", "700 N");
    let edited = ui.scene().clone();
    std::fs::write(&path, &theirs).unwrap();
    // Cancelled, nothing is written. Reloaded; undo restores the edits, which are then saved without a question.
    ui.chord(Modifiers::COMMAND, Key::S);
    ui.get_by_label("Save the scene");
    // The dialog says why, and the row above the body offers to reload.
    assert_eq!(ui.query_all_by_label_contains("mine.toml has changed on disk.").count(), 2);
    assert_eq!(text(), theirs);
    ui.key(Key::Escape);
    assert!(ui.query_by_label("Save the scene").is_none());
    ui.push("Reload");
    assert_eq!((text(), ui.scene()), (theirs, &scene("shear")));
    ui.undo();
    assert_eq!(*ui.scene(), edited);
    // The user may close the window at the same time.
    let ctx = ui.ctx.clone();
    std::fs::write(&path, &own).unwrap();
    assert!(!ui.state_mut().request_close(&ctx), "it asks first");
    ui.run();
    ui.key(Key::Enter);
    ui.push("Save");
    assert_eq!(text(), own, "the name exists");
    ui.push("Replace");
    assert_eq!(read(&path), edited);
    assert!(ui.state_mut().request_close(&ctx), "all is saved");
}

/// A warning is given once.
#[test]
fn a_warning_stays_until_it_is_closed() {
    let mut ui = open("article");
    for message in ["first", "second", "first"] {
        ui.state_mut().warn(message.to_owned());
    }
    ui.run();
    for message in ["first", "second"] {
        ui.get_by_label(message);
        ui.push("Close");
    }
    assert!(!ui.has(Role::Button, "Close"));
}

#[test]
fn the_menu_of_a_point_adds_and_removes_objects() {
    let mut ui = open("cantilever");
    let before = ui.scene().clone();
    // Nearer to the top than to the other edges.
    let at = [5.0, 0.1];
    let count = |scene: &Scene| [scene.loads.len(), scene.supports.len(), scene.probes.len()];
    for (number, add, remove) in [
        (0, "Add a force here", "Remove this force"),
        (0, "Add a moment on top", "Remove the moment on top"),
        (1, "Hold this point", "Remove this support"),
        (2, "Add a probe here", "Remove the probe p1"),
    ] {
        ui.choose(ui.on_body(at), add);
        ui.run();
        let mut more = count(&before);
        more[number] += 1;
        assert_eq!((count(ui.scene()), ui.simulation().status()), (more, &Status::Converged), "{add}");
        assert!(!ui.says("acts on the nearest node"), "it acts at its point");
        ui.undo();
        assert_eq!(*ui.scene(), before, "{add}: undone");
        ui.chord(COMMAND_SHIFT, Key::Z);
        ui.choose(ui.on_body(at), remove);
        assert_eq!(count(ui.scene()), count(&before), "{remove}");
    }
    // A probe stays at its material point, and Details has its displacement.
    ui.choose(ui.on_body(at), "Add a probe here");
    unfold(&mut ui, "stable");
    let u = ui.simulation().probe("p1").unwrap();
    ui.get_by_label(&engineering_pair([u.x, u.y], "m"));
    ui.key_press(Key::Escape);
    ui.secondary_click(ui.state().view_rect().left_top() + vec2(40.0, 160.0));
    assert!(ui.query_by_label("Add a probe here").is_none());
    // The mark of a support on an edge has the menu, too.
    let mut ui = open_of("cantilever", scene("cantilever").clamp("right"));
    ui.choose(ui.on_body([1e-6, 0.1]) - vec2(7.0, 0.0), "Remove this support");
    let supports = &ui.scene().supports;
    assert!(supports.len() == 1 && supports[0].place == Place::from("right"), "{supports:?}");
}

/// A low view has room for the arrow of a large force and for its label.
#[test]
fn the_arrow_of_a_large_force_ends_in_a_low_view() {
    for size in [[640.0, 480.0], [900.0, 600.0]] {
        let mut large = scene("cantilever").with_method(MethodKind::Newton);
        large.scale_loads(5.0);
        let mut lab = lab_of("cantilever", large);
        lab.solve();
        lab.show_tab(MeasureTab::HowFar);
        let mut ui = window(size, lab);
        ui.run_steps(8);
        let (view, tip) = (ui.state().view_rect(), ui.tip());
        assert!(view.shrink2(vec2(10.0, 20.0)).contains(tip), "{size:?}: {tip:?} in {view:?}");
    }
}

/// A body after a single iteration is in view, also where it is far larger than the result.
#[test]
fn a_stepped_body_stays_in_view() {
    let mut large = scene("article");
    large.scale_loads(2.06);
    let mut ui = open_of("article", large);
    settle(&mut ui);
    for steps in 1..4 {
        ui.click_for("Step", 30);
        let lab = ui.state();
        assert_eq!(lab.simulation().iterations(), steps);
        let is_seen = |place: &Vector2<f64>| lab.view_rect().contains(in_view(lab, *place));
        assert!(lab.frame().positions.iter().all(is_seen), "after {steps}");
    }
}
