//! Tests of the story of the first start. The tests set its clock.

use std::collections::BTreeSet;

use crate::common::lab::*;
use warpbeam::scene::registry::DEFAULT;

/// Time between two frames, s.
const FRAME: f64 = 0.25;

fn open(size: [f32; 2], lab: Lab) -> Ui {
    let builder = egui_kittest::Harness::builder().with_size(size);
    // The tests set the clock of the story.
    let mut ui = Ui(builder.build_ui_state(|ui, lab: &mut Lab| _ = lab.ui(ui), lab));
    ui.run_steps(3);
    ui
}

/// Returns a window of the story at its start.
fn story() -> Ui {
    let mut ui = open(SIZE, lab_of(DEFAULT, scene(DEFAULT)));
    ui.state_mut().tell_story();
    show(&mut ui, 0.0);
    ui
}

/// Shows the story `time` s after its start.
fn show(ui: &mut Ui, time: f64) {
    ui.state_mut().advance(time);
    ui.step();
}

/// Shows every frame of the story from 0 s on, and calls `each` with the time and the index of the part.
fn tell(ui: &mut Ui, mut each: impl FnMut(&mut Ui, f64, usize)) {
    for frame in 0.. {
        let time = f64::from(frame) * FRAME;
        show(ui, time);
        let Some((part, _)) = ui.state().story() else { return };
        each(ui, time, part);
    }
}

/// Returns the error of the status bar, once the reference solution is known.
fn error(ui: &mut Ui) -> f64 {
    ui.wait_until("an error", |ui| number(ui, "ERROR").is_some());
    number(ui, "ERROR").unwrap()
}

/// Returns the value of a number of the status bar; `None` if it is unknown.
fn number(ui: &Ui, name: &str) -> Option<f64> {
    let label = ui.texts().into_iter().find(|label| label.starts_with(&format!("{name} ")))?;
    label.split(' ').nth(1)?.parse().ok()
}

fn size(scene: &Scene) -> f64 {
    force(scene)[0].hypot(force(scene)[1])
}

/// The window shows five captions of at most eight words in twenty seconds. Afterwards the scene is as it was opened.
#[test]
fn five_short_captions_are_shown_in_twenty_seconds() {
    let mut ui = story();
    let (mut captions, mut end) = (Vec::new(), 0.0);
    tell(&mut ui, |ui, time, part| {
        let (_, caption) = ui.state().story().unwrap();
        assert!(ui.query_by_label(caption).is_some(), "{caption:?} is not shown");
        assert_eq!(ui.state().title(), "Cantilever \u{2013} warpbeam");
        if captions.len() <= part {
            captions.push(caption);
        }
        end = time;
    });
    assert!((19.0..=20.0).contains(&end), "{end} s");
    assert_eq!(captions.iter().collect::<BTreeSet<_>>().len(), 5);
    assert!(captions.iter().all(|caption| caption.split_whitespace().count() <= 8), "{captions:?}");
    is_default(ui.state());
}

/// Asserts that a lab has the default scene in equilibrium, without a trace of the story.
fn is_default(lab: &Lab) {
    assert_eq!((lab.story(), lab.scene()), (None, &scene(DEFAULT)));
    let undo = &lab.desk.session.undo;
    assert!(lab.simulation().status().is_success() && !undo.can_undo() && !undo.can_redo());
}

/// ρ passes 1 and `warped` ends, `newton` converges under larger loads, another element reduces the error.
#[test]
fn the_numbers_of_the_window_tell_the_story() {
    let mut ui = story();
    let usual = size(&scene(DEFAULT));
    let mut last = [const { None }; 5];
    let (mut lost, mut errors, mut largest) = (Vec::new(), Vec::new(), 0.0_f64);
    tell(&mut ui, |ui, _, part| {
        let lab = ui.state();
        let (method, element, load) = (lab.scene().solver.method, lab.scene().element(), size(lab.scene()));
        let (converges, rho) = (lab.simulation().status().is_success(), number(ui, "ρ"));
        assert_eq!(method == MethodKind::Newton, part == 2 || part == 3);
        assert!(converges || part == 1, "part {part} under {load} N");
        if part <= 1 && load >= usual {
            // Near 1 the limit of iterations decides.
            let rho = rho.unwrap();
            assert!((rho - 1.0).abs() < 0.02 || (rho > 1.0) != converges, "ρ = {rho} under {load} N");
            largest = largest.max(rho);
        }
        if part == 1 {
            lost.push((!converges, ui.query_by_label_contains(" not reached").is_some()));
        }
        last[part] = Some((load, [lab.simulation(), lab.desk.session.linear().unwrap()].map(Simulation::area_change)));
        if part == 3 && load == usual {
            errors.push((element, error(ui)));
        }
    });
    let [(first, [warped, linear]), (second, _), (third, _), ..] = last.map(Option::unwrap);
    assert!(warped.abs() < 1e-3 && linear > 0.4, "changes of the area: {warped} and {linear}");
    assert!(lost.contains(&(false, false)) && lost.ends_with(&[(true, true)]), "{lost:?}");
    assert!(largest > 1.0, "ρ = {largest}");
    assert!(third > second && second > first);
    let (before, after) = (errors.first().unwrap(), errors.last().unwrap());
    assert_eq!((before.0, after.0), (ElementKind::T3, ElementKind::T6));
    assert!(before.1 > 5.0 * after.1, "{errors:?}");
}

/// The body at a time does not depend on the frames before.
#[test]
fn the_body_depends_on_the_time_only() {
    let mut slow = story();
    let mut fast = story();
    tell(&mut slow, |slow, time, part| {
        for third in (0..3).map(f64::from) {
            show(&mut fast, time - FRAME * (2.0 - third) / 3.0);
        }
        let [slow, fast] = [slow.state(), fast.state()].map(|lab| lab.simulation().displacement());
        assert!(slow == fast, "part {part} at {time} s");
    });
}

/// A key, a press or the wheel ends the story at once; a movement of the pointer does not.
#[test]
fn any_input_ends_the_story_and_leaves_the_default_scene() {
    let at = Pos2::new(700.0, 250.0);
    let input = |ui: &mut Ui, number: u32, pressed: bool| match number {
        0 => ui.event(key_event(Key::Space, pressed)),
        1 => ui.event(primary(at, pressed)),
        _ if pressed => ui.wheel(20.0),
        _ => {}
    };
    for number in 0..3 {
        for time in [0.0, 3.0, 9.0, 11.0, 16.0, 18.0] {
            let mut ui = story();
            show(&mut ui, time);
            ui.event(Event::PointerMoved(at));
            ui.event(key_event(Key::Space, false));
            ui.step();
            assert!(ui.state().story().is_some(), "the pointer ended the story");
            input(&mut ui, number, true);
            ui.step();
            assert_eq!(ui.state().story(), None, "input {number} at {time} s");
            input(&mut ui, number, false);
            ui.step();
            show(&mut ui, time + 1.0);
            is_default(ui.state());
        }
    }
}

/// A press on its tip in the last part ends the story, and the same press drags it.
#[test]
fn the_arrow_is_handed_over() {
    let mut ui = story();
    show(&mut ui, 18.0);
    show(&mut ui, 18.1);
    let tip = ui.tip();
    ui.drag_at(tip);
    ui.step();
    assert_eq!(ui.state().story(), None);
    ui.move_to(tip + vec2(0.0, 30.0));
    ui.drop_at(tip + vec2(0.0, 30.0));
    ui.step();
    let usual = size(&scene(DEFAULT));
    assert!(size(ui.scene()) > 1.1 * usual && ui.state().desk.session.undo.can_undo(), "{} N", size(ui.scene()));
}

#[test]
fn with_reduced_motion_the_story_is_five_stills() {
    let mut ui = open(SIZE, lab_of(DEFAULT, scene(DEFAULT)));
    let mut settings = Settings::default();
    settings.reduced_motion = true;
    let ctx = ui.ctx.clone();
    ui.state_mut().set_settings(&ctx, settings);
    ui.state_mut().tell_story();
    let mut stills: Vec<(usize, Vec<Vector2<f64>>)> = Vec::new();
    tell(&mut ui, |ui, _, part| stills.push((part, ui.simulation().displacement().to_vec())));
    stills.dedup();
    assert_eq!(stills.iter().map(|(part, _)| *part).collect::<Vec<_>>(), [0, 1, 2, 3, 4]);
    assert!(stills.windows(2).all(|pair| pair[0].1 != pair[1].1), "each still shows another body");
    is_default(ui.state());
}

/// The story that Learn tells ends on the card it began at. The user's scene stays.
#[test]
fn learn_tells_the_story_again() {
    let mut ui = open([900.0, 600.0], lab_of("article", scene("article")));
    let own = ui.scene().clone();
    // Another scene than the default one would be lost.
    ui.state_mut().tell_story();
    assert_eq!(ui.state().story(), None);
    ui.state_mut().show_card(3);
    ui.run_steps(3);
    let card = ui.scene().clone();
    ui.click_for("Story", 1);
    assert!(ui.state().story().is_some() && ui.state().card().is_none());
    [0.0, 3.0, 8.0].into_iter().for_each(|time| show(&mut ui, time));
    assert!(*ui.scene() != card);
    ui.key_press(Key::Enter);
    ui.step();
    assert_eq!((ui.state().story(), ui.state().card(), ui.scene()), (None, Some((3, 9)), &card));
    ui.click_for("Leave", 3);
    assert_eq!(*ui.scene(), own);
}
