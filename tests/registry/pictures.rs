//! Compares the picture of every built-in scene with a golden picture and with the solver's results.
//!
//! `UPDATE_GOLDEN=1 cargo test --test registry -- picture` redraws the golden pictures; look at them before committing.

use std::path::Path;

use crate::common::pictures::{difference, distance, for_picture, lab, pixel, read_png};
use crate::common::*;
use crate::{Test, suite};
use libtest_mimic::Trial;
use warpbeam::app::picture;
use warpbeam::render::{Camera, Gpu, colormap};

const TESTS: &[Test<&'static str>] = &[
    ("the_picture_is_golden_on_dark", |id| is_golden(id, ["640x400", "dark"], &format!("tests/golden/{id}-dark.png"))),
    ("the_picture_is_golden_on_light", |id| {
        is_golden(id, ["640x400", "light"], &format!("tests/golden/{id}-light.png"))
    }),
    // The gallery shows it at half of its size.
    ("the_small_picture_is_golden", |id| is_golden(id, ["208x126", "dark"], &format!("assets/scenes/{id}.png"))),
    ("the_body_is_drawn_where_the_solver_says", the_body_is_drawn_where_the_solver_says),
];

pub fn trials() -> Vec<Trial> {
    suite("picture", registry::BUILT_IN.iter().map(|b| (b.id.to_owned(), b.id)), TESTS)
}

/// Compares the output of `warpbeam shot` with the golden picture, without the panel, whose times differ.
fn is_golden(id: &str, [size, theme]: [&str; 2], golden: &str) {
    const TOLERANCE: f64 = 2e-3;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("shot.png");
    let to = path.to_str().unwrap();
    let mut args = vec!["shot", id, "-o", to, "--size", size, "--no-panel", "--theme", theme];
    args.extend(for_picture(id).iter().flat_map(|set| ["--set", set]));
    succeeds(&args);
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::copy(&path, golden).unwrap();
    }
    let difference = difference(&read_png(&path), &read_png(Path::new(golden)));
    assert!(difference < TOLERANCE, "{:.2} % of the pixels differ", 100.0 * difference);
}

/// Returns the position of a point of the plane in the picture, pixels.
fn project(camera: &Camera, rect: egui::Rect, p: Vector2<f64>) -> [f64; 2] {
    let [x, y] = camera.to_view(p);
    [f64::from(rect.center().x) + x, f64::from(rect.center().y) + y]
}

/// The drawn body ends where the solver's nodes end, and every triangle has the colour of its value.
fn the_body_is_drawn_where_the_solver_says(id: &'static str) {
    let gpu = Gpu::headless(None).unwrap();
    let mut lab = lab(id);
    let view = &mut lab.desk.view;
    (view.layout.bars, view.lines.rest_outline, view.lines.ghost, view.lines.exact) = (false, false, false, false);
    lab.solve();
    let picture = picture(&gpu, &mut lab, [900, 600], 1.0, egui::Theme::Dark).unwrap();
    let (camera, rect) = (lab.camera(), lab.view_rect());
    let frame = lab.frame();
    let positions: Vec<_> = lab.simulation().positions().collect();
    // Triangles with straight sides are drawn one for one.
    if lab.scene().element() == ElementKind::T3 {
        for (drawn, solved) in frame.triangles.iter().zip(lab.simulation().system().mesh().elements()) {
            let drawn = drawn.map(|p| frame.positions[p as usize]);
            let solved = [solved[0], solved[1], solved[2]].map(|n| positions[n as usize]);
            assert_eq!(drawn, solved, "{id}: what is drawn is not what was solved");
        }
    }

    // Colours are compared at the middle of triangles that are large enough to have a pixel there without an edge, with
    // the value that the pointer shows there.
    let (mesh, nodal) = (lab.simulation().mesh(), lab.simulation().nodal_stress());
    let entry = mesh.element().entry();
    let lattice = (entry.cell.lattice)(entry.drawn_pieces);
    let position = |element: usize, at: [f64; 2]| {
        colormap::position(frame.field.smooth_at(mesh, &nodal, MaterialPoint { element, at }).unwrap(), frame.range)
    };
    let (mut seen, mut large) = (0, 0);
    for (i, triangle) in frame.triangles.iter().enumerate() {
        let [a, b, c] = triangle.map(|p| project(&camera, rect, frame.positions[p as usize]));
        let area = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])).abs();
        if area < 60.0 {
            continue;
        }
        large += 1;
        let [x, y] = [0, 1].map(|i| ((a[i] + b[i] + c[i]) / 3.0) as u32);
        let (element, piece) = (i / lattice.triangles.len(), lattice.triangles[i % lattice.triangles.len()]);
        let corners = piece.map(|p| lattice.points[p as usize]);
        let middle = position(element, [0, 1].map(|axis| corners.iter().map(|at| at[axis]).sum::<f64>() / 3.0));
        let expected = frame.map.color(middle);
        // The pixel's centre is not exactly the triangle's.
        let steep = corners.iter().fold(0.0f64, |m, &at| m.max((position(element, at) - middle).abs()));
        let got = pixel(&picture, x, y);
        if f64::from(distance(expected, got)) <= 3.0 + 40.0 * steep {
            seen += 1;
        }
    }
    // The load's arrow and the supports may cover a few triangles.
    assert!(f64::from(seen) >= 0.9 * f64::from(large), "{id}: {seen} of {large} triangles have their colour");

    // At the tip, a pixel just inside the body is body and one just outside is background. The outline between them is
    // 1.2 wide.
    let tip = project(&camera, rect, lab.simulation().solution().probes[0].clone().x);
    let mesh = lab.simulation().system().mesh();
    let centre = positions.iter().sum::<Vector2<f64>>() / positions.len() as f64;
    // The roll-up's tip lies on its clamp; no other object is drawn at the other scenes' tips.
    let Some(Place::Edge(edge)) = Some(&lab.scene().probes[0].place).filter(|_| id != "roll-up") else { return };
    let edge = mesh.edges().get(edge).unwrap();
    for segment in edge.iter().step_by(edge.len().div_ceil(4)) {
        let [p, q] = segment.ends().map(|n| positions[n as usize]);
        let middle = (p + q) * 0.5;
        let normal = Vector2::new((q - p).y, -(q - p).x).normalize();
        let outward = if normal.dot(&(middle - centre)) > 0.0 { normal } else { -normal };
        let at = |pixels: f64| {
            let [x, y] = project(&camera, rect, middle + outward * (pixels / camera.scale));
            pixel(&picture, x as u32, y as u32)
        };
        // The arrow starts at the middle of a loaded edge and may have either direction.
        let [x, y] = project(&camera, rect, middle);
        if (x - tip[0]).hypot(y - tip[1]) < 8.0 {
            continue;
        }
        let outside = at(4.0);
        assert!(distance(outside, frame.background) <= 8, "{id}: {outside:?} outside the tip");
        assert!(distance(at(-3.0), frame.background) > 8, "{id}: background inside the tip");
    }
}
