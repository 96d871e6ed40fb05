//! A game that bends a beam within a time budget. Every displayed frame edits the force and iterates until the budget
//! is used up or the beam is in equilibrium.
//!
//! `cargo run --release --example game_loop --no-default-features`

use std::error::Error;
use std::time::{Duration, Instant};

use warpbeam::{ElementKind, MethodKind, Scene, Simulation, Status};

/// Time that the game leaves for the beam in a frame of 16 ms.
const BUDGET: Duration = Duration::from_micros(500);
const FRAMES: u32 = 120;

fn main() -> Result<(), Box<dyn Error>> {
    let (finished, tip) = play()?;
    println!("{finished} of {FRAMES} frames ended in equilibrium; the tip is at {tip:.3} m");
    Ok(())
}

/// Plays all frames. Returns how many ended in equilibrium, and the distance of the tip from its
/// rest position at the end, m.
pub fn play() -> Result<(u32, f64), Box<dyn Error>> {
    let scene = Scene::beam(4.0, 0.4)
        .with_cells(16, 1)
        .with_element(ElementKind::Q4)
        .with_method(MethodKind::Newton)
        .clamp("left")
        .force("right", [0.0, 0.0])
        .probe("tip", "right");
    let mut beam = Simulation::new(&scene)?;
    let mut finished = 0;
    for frame in 0..FRAMES {
        // A gust that grows and rotates. The edit recomputes nothing but the load.
        let (s, c) = (f64::from(frame) * 0.05).sin_cos();
        beam.edit(|scene| scene.set_force(0, [200.0 * s, -600.0 * s * c]))?;
        let start = Instant::now();
        while *beam.status() == Status::Running && start.elapsed() < BUDGET {
            beam.step();
        }
        match beam.status() {
            Status::Converged => finished += 1,
            // Out of time: the next frame continues from this state.
            Status::Running => {}
            failed => eprintln!("frame {frame}: {failed:?}"),
        }
        // A game would draw `beam.positions()` here.
    }
    Ok((finished, beam.probe("tip").map_or(0.0, |u| u.norm())))
}
