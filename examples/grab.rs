//! Grabs the tip of a swinging beam with a mouse spring, moves it along a circle, and releases it.
//!
//! `cargo run --release --example grab --no-default-features`

use std::error::Error;

use warpbeam::nalgebra::Vector2;
use warpbeam::{IntegratorKind, Scene, Simulation};

const RADIUS: f64 = 0.4;
const FRAMES: u32 = 240;

fn main() -> Result<(), Box<dyn Error>> {
    let (distance, force) = drag()?;
    println!("the tip followed within {distance:.3} m; the largest force was {force:.0} N");
    Ok(())
}

/// Drags the tip. Returns its largest distance from the pointer in the last quarter of the frames, m, and the
/// largest force of all frames, N.
pub fn drag() -> Result<(f64, f64), Box<dyn Error>> {
    let scene = Scene::beam(2.0, 0.2)
        .with_cells(16, 1)
        .clamp("left")
        .probe("tip", "right")
        .moving(IntegratorKind::TrBdf2, 1.0 / 60.0);
    let mut beam = Simulation::new(&scene)?;
    let tip = beam.mesh().locate(Vector2::new(1.999, 0.0)).ok_or("the body has no such point")?;
    beam.grab(tip);
    let centre = Vector2::new(1.999 - RADIUS, 0.0);
    let (mut distance, mut force): (f64, f64) = (0.0, 0.0);
    for frame in 0..FRAMES {
        let (sin, cos) = (f64::from(frame) / f64::from(FRAMES) * std::f64::consts::TAU).sin_cos();
        beam.pull_to(centre + RADIUS * Vector2::new(cos, sin))?;
        beam.step();
        let (spring, pull) = beam.mouse_spring().ok_or("the spring was removed")?;
        force = force.max(pull.norm());
        if frame >= FRAMES * 3 / 4 {
            distance = distance.max((spring.target() - spring.position(beam.displacement())).norm());
        }
    }
    beam.release();
    Ok((distance, force))
}
