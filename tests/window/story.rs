//! Tests of the story of the first start. The tests set its clock.

use std::collections::BTreeSet;

use crate::common::lab::lab_of;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use nalgebra::Vector2;
use warpbeam::Simulation;
use warpbeam::app::{Lab, Settings};
use warpbeam::scene::{ElementKind, Load, MethodKind, Scene};

/// Time between two frames, s.
const FRAME: f64 = 0.25;

fn lab(id: &str) -> Lab {
    lab_of(id, crate::common::scene(id))
}

fn harness(size: [f32; 2], lab: Lab) -> Harness<'static, Lab> {
    let mut harness = Harness::builder().with_size(size).build_ui_state(
        |ui, lab: &mut Lab| {
            lab.ui(ui);
        },
        lab,
    );
    harness.run_steps(3);
    harness
}

/// Returns a window of the story at its start.
fn story() -> Harness<'static, Lab> {
    let mut harness = harness([1280.0, 800.0], lab("article"));
    harness.state_mut().tell_story();
    show(&mut harness, 0.0);
    harness
}

/// Shows the story `time` s after its start.
fn show(harness: &mut Harness<'_, Lab>, time: f64) {
    harness.state_mut().advance(time);
    harness.step();
}

/// Shows every frame of the story from 0 s on, and calls `each` with the time and the index of the part.
fn tell(harness: &mut Harness<'_, Lab>, mut each: impl FnMut(&mut Harness<'_, Lab>, f64, usize)) {
    for frame in 0.. {
        let time = f64::from(frame) * FRAME;
        show(harness, time);
        let Some((part, _)) = harness.state().story() else { return };
        each(harness, time, part);
    }
}

/// Returns the error of the status bar, once the reference solution is known.
fn error(harness: &mut Harness<'_, Lab>) -> f64 {
    for _ in 0..6000 {
        if let Some(error) = number(harness, "ERROR") {
            return error;
        }
        std::thread::sleep(std::time::Duration::from_millis(20));
        harness.step();
    }
    unreachable!("no error")
}

/// Returns the value of a number of the status bar; `None` if it is unknown.
fn number(harness: &Harness<'_, Lab>, name: &str) -> Option<f64> {
    let nodes = harness.get_all_by(|_| true).map(|node| node.accesskit_node());
    let mut texts = nodes.flat_map(|node| [node.label(), node.value()]).flatten();
    let label = texts.find(|label| label.starts_with(&format!("{name} ")))?;
    label.split(' ').nth(1)?.parse().ok()
}

fn force(scene: &Scene) -> f64 {
    let Load::Force { force: [x, y], .. } = scene.loads[0] else { unreachable!() };
    x.hypot(y)
}

/// Returns the area of a body of triangles, m².
fn area(simulation: &Simulation) -> f64 {
    let (mesh, u) = (simulation.system().mesh(), simulation.displacement());
    let area_of = |nodes: &[u32]| {
        let [a, b, c] = [0, 1, 2].map(|i| mesh.nodes()[nodes[i] as usize] + u[nodes[i] as usize]);
        0.5 * (b - a).perp(&(c - a))
    };
    mesh.elements().map(area_of).sum()
}

/// The window shows five captions of at most eight words in twenty seconds. Afterwards the scene is as it was opened.
#[test]
fn five_short_captions_are_shown_in_twenty_seconds() {
    let mut harness = story();
    let (mut captions, mut end) = (Vec::new(), 0.0);
    tell(&mut harness, |harness, time, part| {
        let (_, caption) = harness.state().story().unwrap();
        assert!(harness.query_by_label(caption).is_some(), "{caption:?} is not shown");
        assert_eq!(harness.state().title(), "The article's beam \u{2013} warpbeam");
        if captions.len() <= part {
            captions.push(caption);
        }
        end = time;
    });
    assert!((19.0..=20.0).contains(&end), "{end} s");
    assert_eq!(captions.iter().collect::<BTreeSet<_>>().len(), 5);
    assert!(captions.iter().all(|caption| caption.split_whitespace().count() <= 8), "{captions:?}");
    is_default(harness.state());
}

/// Asserts that a lab has the default scene in equilibrium, without a trace of the story.
fn is_default(lab: &Lab) {
    assert_eq!((lab.story(), lab.scene()), (None, &crate::common::scene("article")));
    assert!(lab.simulation().status().is_success() && !lab.can_undo() && !lab.can_redo());
}

/// The numbers of the window tell the story: the area grows under linear theory only, ρ passes 1 and the warped
/// iteration ends, Newton's method converges under larger loads, and another element reduces the error.
#[test]
fn the_numbers_of_the_window_tell_the_story() {
    let mut harness = story();
    let usual = force(&crate::common::scene("article"));
    let mut last = [const { None }; 5];
    let (mut lost, mut errors, mut largest) = (Vec::new(), Vec::new(), 0.0_f64);
    tell(&mut harness, |harness, _, part| {
        let lab = harness.state();
        let (method, element, load) = (lab.scene().solver.method, lab.scene().element(), force(lab.scene()));
        let (converges, rho) = (lab.simulation().status().is_success(), number(harness, "ρ"));
        assert_eq!(method == MethodKind::Newton, part == 2 || part == 3);
        assert!(converges || part == 1, "part {part} under {load} N");
        if part <= 1 && load >= usual {
            // The window rounds to two digits.
            assert_eq!(rho.unwrap() >= 1.0, !converges, "ρ = {rho:?} under {load} N");
            largest = largest.max(rho.unwrap());
        }
        if part == 1 {
            lost.push((!converges, harness.query_by_label_contains(" not reached").is_some()));
        }
        last[part] = Some((load, [Some(lab.simulation()), lab.linear()].map(|body| area(body.unwrap()))));
        if part == 3 && load == usual {
            errors.push((element, error(harness)));
        }
    });
    let [first, second, third, ..] = last.map(Option::unwrap);
    let (warped, linear) = (first.1[0], first.1[1]);
    assert!((warped - 5.0).abs() < 0.25 && linear > 6.0, "areas {warped} and {linear} of 5 m\u{b2}");
    assert!(lost.contains(&(false, false)) && lost.ends_with(&[(true, true)]), "{lost:?}");
    assert!(largest > 1.0, "ρ = {largest}");
    assert!(third.0 > second.0 && second.0 > first.0);
    let (before, after) = (errors.first().unwrap(), errors.last().unwrap());
    assert_eq!((before.0, after.0), (ElementKind::T3, ElementKind::Q4));
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
    let key = |pressed| Event::Key {
        key: Key::Space,
        physical_key: None,
        pressed,
        repeat: false,
        modifiers: Modifiers::NONE,
    };
    let press =
        |pressed| Event::PointerButton { pos: at, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE };
    let wheel = Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: vec2(0.0, 20.0),
        phase: egui::TouchPhase::Move,
        modifiers: Modifiers::NONE,
        source: egui::MouseWheelSource::Wheel,
    };
    for input in [vec![key(true), key(false)], vec![press(true), press(false)], vec![wheel]] {
        for time in [0.0, 3.0, 9.0, 11.0, 16.0, 18.0] {
            let mut harness = story();
            show(&mut harness, time);
            harness.event(Event::PointerMoved(at));
            harness.event(key(false));
            harness.step();
            assert!(harness.state().story().is_some(), "the pointer ended the story");
            harness.event(input[0].clone());
            harness.step();
            assert_eq!(harness.state().story(), None, "{input:?} at {time} s");
            input[1..].iter().for_each(|event| harness.event(event.clone()));
            harness.step();
            // A later time does not start it again.
            show(&mut harness, time + 1.0);
            is_default(harness.state());
        }
    }
}

/// A press on the tip of the arrow in the last part ends the story, and the same press drags the arrow.
#[test]
fn the_arrow_is_handed_over() {
    let mut harness = story();
    show(&mut harness, 18.0);
    show(&mut harness, 18.1);
    let (_, tip) = harness.state().arrow_tips()[0];
    harness.drag_at(tip);
    harness.step();
    assert_eq!(harness.state().story(), None);
    harness.event(Event::PointerMoved(tip + vec2(0.0, 30.0)));
    harness.step();
    harness.drop_at(tip + vec2(0.0, 30.0));
    harness.step();
    assert!(force(harness.state().scene()) > 33e3, "{} N", force(harness.state().scene()));
    assert!(harness.state().can_undo());
}

/// With reduced motion, every part is a still.
#[test]
fn with_reduced_motion_the_story_is_five_stills() {
    let mut harness = harness([1280.0, 800.0], lab("article"));
    let mut settings = Settings::default();
    settings.reduced_motion = true;
    let ctx = harness.ctx.clone();
    harness.state_mut().set_settings(&ctx, settings);
    harness.state_mut().tell_story();
    let mut stills: Vec<(usize, Vec<Vector2<f64>>)> = Vec::new();
    tell(&mut harness, |harness, _, part| {
        let u = harness.state().simulation().displacement();
        match stills.last() {
            Some((last, still)) if *last == part => assert!(still == u, "part {part} moves"),
            _ => stills.push((part, u.to_vec())),
        }
    });
    assert_eq!(stills.iter().map(|(part, _)| *part).collect::<Vec<_>>(), [0, 1, 2, 3, 4]);
    assert!(stills.windows(2).all(|pair| pair[0].1 != pair[1].1), "each still shows another body");
    is_default(harness.state());
}

/// Learn tells the story again, and shows its card afterwards. The user's scene stays.
#[test]
fn learn_tells_the_story_again() {
    let mut harness = harness([900.0, 600.0], lab("cantilever"));
    let own = harness.state().scene().clone();
    // Another scene than the default one would be lost.
    harness.state_mut().tell_story();
    assert_eq!(harness.state().story(), None);
    harness.state_mut().show_card(3);
    harness.run_steps(3);
    let card = harness.state().scene().clone();
    harness.get_by_label("Story").click();
    harness.step();
    assert!(harness.state().story().is_some() && harness.state().card().is_none());
    for time in [0.0, 3.0, 8.0] {
        show(&mut harness, time);
    }
    assert!(harness.state().scene() != &card);
    harness.key_press(Key::Enter);
    harness.step();
    assert_eq!((harness.state().story(), harness.state().card()), (None, Some((3, 9))));
    assert_eq!(harness.state().scene(), &card);
    harness.get_by_label("Leave").click();
    harness.run_steps(3);
    assert_eq!(harness.state().scene(), &own);
}
