//! Long runs: memory does not grow, results do not drift, and the program does not end. `WARPBEAM_SOAK=50 cargo test
//! --release --test window soak` runs fifty times as long.

use std::ops::Range;

use crate::common::alone::ran_alone;
use crate::common::lab::{in_view, window_at};
use crate::common::pictures::lab;
use crate::common::*;
use allocation_counter::measure;
use warpbeam::app::Lab;

/// Returns the factor by which runs are longer than usual.
fn longer() -> u32 {
    std::env::var("WARPBEAM_SOAK").ok().and_then(|text| text.parse().ok()).unwrap_or(1)
}

/// Fails if `work` leaves more than `most` bytes allocated or, on Linux, if the process (all threads) grows by more.
fn assert_keeps_no_more(most: u32, of: &str, work: impl FnOnce()) {
    let before = resident();
    let kept = measure(work).bytes_current;
    assert!(kept < i64::from(most), "{of}: {kept} bytes are left");
    if let (Some(before), Some(after)) = (before, resident()) {
        assert!(after < before + u64::from(most), "{of}: from {before} to {after} bytes");
    }
}

/// Returns the resident memory, bytes; `None` if the system does not report it.
fn resident() -> Option<u64> {
    const PAGE: u64 = 4096;
    let text = std::fs::read_to_string("/proc/self/statm").ok()?;
    Some(text.split_whitespace().nth(1)?.parse::<u64>().ok()? * PAGE)
}

/// The swing moves for a long time and is pulled by a mouse spring now and then.
#[test]
fn a_long_swing_with_pulls_stays_stable_and_keeps_no_memory() {
    if ran_alone("soak::a_long_swing_with_pulls_stays_stable_and_keeps_no_memory") {
        return;
    }
    let mut scene = scene("swing");
    scene.beam.as_mut().unwrap().cells = [10, 1];
    scene.set_element(ElementKind::T3);
    for integrator in [IntegratorKind::TrBdf2, IntegratorKind::EnergyMomentum] {
        scene.dynamics.integrator = integrator;
        let mut simulation = Simulation::new(&scene).unwrap();
        let mut random = Random(7);
        let tip = simulation.system().mesh().locate(Vector2::new(0.98, 0.0)).unwrap();
        let mut place = Vector2::zeros();
        let steps = 10_000 * longer();
        let mut go_on = |steps: Range<u32>| {
            for step in steps {
                match step % 600 {
                    400 => assert!(simulation.grab(tip)),
                    401..460 => {
                        if step % 20 == 1 {
                            place = Vector2::new(0.6, -0.4)
                                + Vector2::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0)) * 0.3;
                        }
                        simulation.pull_to(place).unwrap();
                    }
                    460 => simulation.release(),
                    _ => {}
                }
                simulation.step();
            }
        };
        go_on(0..steps / 10);
        assert_keeps_no_more(16 << 20, &format!("{integrator:?}"), || go_on(steps / 10..steps));
        assert!(!matches!(simulation.status(), Status::Stopped(_)), "{integrator:?}: {:?}", simulation.status());
        assert!(simulation.state().is_finite());
        let ledger = simulation.motion().unwrap().ledger();
        assert!(ledger.imbalance().abs() < 1e-10 * ledger.throughput, "{integrator:?}: {ledger:?}");
    }
}

/// Returns the window position of a node, points. `part` selects the node, as a fraction of all nodes.
fn on_the_body(lab: &Lab, part: f64) -> egui::Pos2 {
    let (nodes, u) = (lab.simulation().system().mesh().nodes(), lab.simulation().displacement());
    let node = ((part * nodes.len() as f64) as usize).min(nodes.len() - 1);
    in_view(lab, nodes[node] + u[node])
}

/// Returns a vector with components from −1 to 1.
fn vector(random: &mut Random) -> egui::Vec2 {
    egui::vec2(random.between(-1.0, 1.0) as f32, random.between(-1.0, 1.0) as f32)
}

/// A window whose body is dragged at random keeps running and shows finite values.
#[test]
fn random_input_never_breaks_the_window() {
    if ran_alone("soak::random_input_never_breaks_the_window") {
        return;
    }
    for id in ["jelly", "flick", "article"] {
        let mut ui = window_at([0.25, 4.0], [1000.0, 700.0], lab(id));
        let mut random = Random(11);
        let mut held = 0;
        let frames = 240 * longer();
        let mut play = |frames: Range<u32>| {
            for frame in frames {
                let rect = ui.state().view_rect();
                let place = rect.center() + vector(&mut random) * 0.45 * rect.size();
                match frame % 12 {
                    0 => {
                        let node = on_the_body(ui.state(), 0.5 + 0.5 * random.between(-1.0, 1.0));
                        ui.drag_at(node + vector(&mut random) * 20.0);
                    }
                    8 => ui.drop_at(place),
                    _ => ui.hover_at(place),
                }
                ui.step();
                held += u32::from(ui.simulation().mouse_spring().is_some());
                assert!(ui.simulation().state().is_finite(), "{id}: frame {frame}");
            }
        };
        play(0..frames / 2);
        assert_keeps_no_more(32 << 20, id, || play(frames / 2..frames));
        assert!(id == "article" || held > 0, "{id}: nothing was ever held");
    }
}
