//! Time to draw a frame of the window offscreen at 1280×800, in total and by stage: with the panel,
//! without it, and for a fine mesh.
#![allow(clippy::unwrap_used, missing_docs, reason = "a bench may fail")]

use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use warpbeam::Simulation;
use warpbeam::app::{Canvas, FrameTimes, Lab};
use warpbeam::format::{engineering, two_digits};
use warpbeam::render::Gpu;
use warpbeam::scene::{Source, open};

fn frames(c: &mut Criterion) {
    let Ok(gpu) = Gpu::headless(None) else {
        eprintln!("no graphics adapter: nothing is drawn");
        return;
    };
    println!("{}", gpu.describe());
    let cases = [("article", "beam.cells=[5,1]", true), ("article", "beam.cells=[5,1]", false)];
    let fine = ("cantilever", "beam.cells=[1000,100]", false);
    for (id, cells, panel) in cases.into_iter().chain([fine]) {
        let mut assignments = vec![cells.to_owned()];
        if id == "cantilever" {
            assignments.extend(["beam.element=\"t3\"".to_owned(), "solver.method=\"linear\"".to_owned()]);
        }
        let source = Source { name: id.into(), assignments };
        let scene = open(&source).unwrap();
        let simulation = Simulation::new(&scene).unwrap();
        let mut lab = Lab::new(source, scene, simulation);
        lab.desk.view.layout.bars = panel;
        let mut canvas = Canvas::new(&gpu, [1280, 800], 1.0, egui::Theme::Dark).unwrap();
        let triangles = lab.simulation().system().mesh().element_count();
        let name = format!("paint/{triangles} triangles{}", if panel { ", with the panel" } else { "" });
        c.bench_function(&name, |b| b.iter(|| canvas.paint(&mut lab).unwrap()));
        print_stages(|| canvas.paint(&mut lab).unwrap());
    }
}

/// Prints the median time of each stage.
fn print_stages(mut frame: impl FnMut() -> FrameTimes) {
    const FRAMES: usize = 41;
    let frames: Vec<FrameTimes> = (0..FRAMES).map(|_| frame()).collect();
    let median = |of: fn(&FrameTimes) -> Duration| {
        let mut times: Vec<Duration> = frames.iter().map(of).collect();
        times.sort_unstable();
        engineering(two_digits(times[FRAMES / 2].as_secs_f64()), "s")
    };
    println!(
        "  a frame {}: layout {}, tessellation {}, uploads and commands {}, drawing {}",
        median(|t| t.layout + t.tessellate + t.record + t.draw),
        median(|t| t.layout),
        median(|t| t.tessellate),
        median(|t| t.record),
        median(|t| t.draw)
    );
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20);
    targets = frames
}
criterion_main!(benches);
