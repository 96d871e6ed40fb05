//! Measures an iteration of `newton` at three sizes of a cantilever. Prints a line per size: number of unknowns, microseconds,
//! displacement of the tip.

use std::error::Error;

use warpbeam::{ElementKind, MethodKind, Scene, Simulation, Status};
use web_time::Instant;

/// Iterations per size are chosen such that their number times the unknowns is about this.
const WORK: usize = 400_000;

fn main() -> Result<(), Box<dyn Error>> {
    let mut lines = Vec::new();
    for [along, across] in [[32, 2], [96, 10], [320, 31]] {
        let (unknowns, microseconds, tip) = measure(along, across)?;
        lines.push(format!("{unknowns} {microseconds} {tip}"));
    }
    print(&lines.join("\n"));
    Ok(())
}

/// Returns the number of unknowns, the median time of an iteration, µs, and the displacement of the tip, m.
fn measure(along: u32, across: u32) -> Result<(usize, f64, f64), Box<dyn Error>> {
    let scene = Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -1000.0]).probe("tip", "right");
    let scene = scene.with_cells(along, across).with_element(ElementKind::T3).with_method(MethodKind::Newton);
    let mut simulation = Simulation::new(&scene)?;
    let unknowns = simulation.solution().dofs;
    let mut times = Vec::new();
    while times.len() < (WORK / unknowns).max(15) {
        simulation.reset();
        while *simulation.status() == Status::Running {
            let start = Instant::now();
            simulation.step();
            times.push(start.elapsed().as_secs_f64() * 1e6);
        }
    }
    times.sort_by(f64::total_cmp);
    let tip = simulation.probe("tip").ok_or("no tip")?.y;
    Ok((unknowns, times[times.len() / 2], tip))
}

#[cfg(not(target_arch = "wasm32"))]
fn print(text: &str) {
    println!("{text}");
}

/// Leaves the text where the script that has loaded the module finds it.
#[cfg(target_arch = "wasm32")]
fn print(text: &str) {
    let _ = js_sys::Reflect::set(&js_sys::global(), &"speed".into(), &text.into());
}
