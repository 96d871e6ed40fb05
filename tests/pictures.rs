//! Pictures of every scene: against golden ones, and against what the solver says.
//!
//! `UPDATE_GOLDEN=1 cargo test --test pictures` draws the golden pictures anew; look at them before committing.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod common;

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use common::{scene, scene_ids, stderr, warpbeam};
use nalgebra::Vector2;
use warpbeam::app::{Lab, picture};
use warpbeam::render::{Camera, Gpu, Picture, colormap};
use warpbeam::scene::Source;
use warpbeam::simulation::Simulation;

fn lab(id: &str) -> Lab {
    let scene = scene(id);
    let simulation = Simulation::new(&scene).unwrap();
    Lab::new(Source { name: id.to_owned(), assignments: Vec::new() }, scene, simulation)
}

fn read_png(path: &Path) -> Picture {
    let file = File::open(path).unwrap_or_else(|e| unreachable!("{}: {e}", path.display()));
    let mut reader = png::Decoder::new(BufReader::new(file)).read_info().unwrap();
    let mut rgba = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut rgba).unwrap();
    assert_eq!((info.color_type, info.bit_depth), (png::ColorType::Rgba, png::BitDepth::Eight));
    Picture { size: [info.width, info.height], rgba }
}

fn pixel(picture: &Picture, x: u32, y: u32) -> [u8; 3] {
    let at = 4 * (y * picture.size[0] + x) as usize;
    [picture.rgba[at], picture.rgba[at + 1], picture.rgba[at + 2]]
}

fn distance(a: [u8; 3], b: [u8; 3]) -> u8 {
    a.iter().zip(b).map(|(a, b)| a.abs_diff(b)).max().unwrap()
}

/// The share of pixels that differ by more than antialiasing on another driver would make them.
fn difference(a: &Picture, b: &Picture) -> f64 {
    const VISIBLE: u8 = 24;
    assert_eq!(a.size, b.size);
    let pixels = a.rgba.chunks(4).zip(b.rgba.chunks(4));
    let different = pixels.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > VISIBLE)).count();
    different as f64 / f64::from(a.size[0] * a.size[1])
}

/// `warpbeam shot` of every scene, without the panel (whose times differ from run to run).
#[test]
fn shots_match_the_golden_pictures() {
    const TOLERANCE: f64 = 2e-3;
    let folder = tempfile::tempdir().unwrap();
    for id in scene_ids() {
        for theme in ["dark", "light"] {
            let path = folder.path().join(format!("{id}-{theme}.png"));
            let output = warpbeam(&[
                "shot",
                id,
                "-o",
                path.to_str().unwrap(),
                "--size",
                "640x400",
                "--no-panel",
                "--theme",
                theme,
            ]);
            assert_eq!(output.status.code(), Some(0), "{id}: {}", stderr(&output));
            let golden = PathBuf::from(format!("tests/golden/{id}-{theme}.png"));
            if std::env::var_os("UPDATE_GOLDEN").is_some() {
                std::fs::create_dir_all("tests/golden").unwrap();
                std::fs::copy(&path, &golden).unwrap();
            }
            let difference = difference(&read_png(&path), &read_png(&golden));
            assert!(difference < TOLERANCE, "{id} {theme}: {:.2} % of the pixels differ", 100.0 * difference);
        }
    }
}

/// The golden comparison must see a beam that bends a little more.
#[test]
fn the_golden_comparison_sees_a_changed_load() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bent.png");
    let args = ["shot", "cantilever", "-o", path.to_str().unwrap(), "--size", "640x400", "--no-panel"];
    assert_eq!(warpbeam(&[&args[..], &["--set", "load.0.force=[0,-1100]"]].concat()).status.code(), Some(0));
    assert!(difference(&read_png(&path), &read_png("tests/golden/cantilever-dark.png".as_ref())) > 2e-3);
}

/// Where a point of the plane is in the picture, pixels.
fn project(camera: &Camera, rect: egui::Rect, p: Vector2<f64>) -> [f64; 2] {
    let [x, y] = camera.to_view(p);
    [f64::from(rect.center().x) + x, f64::from(rect.center().y) + y]
}

/// The body's pixels end where the solver's nodes end, and every triangle has the colour of its value.
#[test]
fn the_body_is_drawn_where_the_solver_says() {
    let gpu = Gpu::headless().unwrap();
    for id in scene_ids() {
        let mut lab = lab(id);
        lab.set_panel(false);
        lab.set_outlines(false);
        lab.solve();
        let picture = picture(&gpu, &mut lab, [900, 600], 1.0, egui::Theme::Dark).unwrap();
        let (camera, rect) = (lab.camera(), lab.view_rect());
        let frame = lab.frame();
        let positions: Vec<_> = lab
            .simulation()
            .system()
            .mesh
            .nodes
            .iter()
            .zip(lab.simulation().displacement())
            .map(|(x, u)| x + u)
            .collect();
        // Straight triangles are drawn as they are, one for one.
        if lab.scene().element() == warpbeam::scene::ElementKind::T3 {
            for (drawn, solved) in frame.triangles.iter().zip(lab.simulation().system().mesh.triangles()) {
                let drawn = drawn.map(|p| frame.positions[p as usize]);
                let solved = [solved[0], solved[1], solved[2]].map(|n| positions[n as usize]);
                assert_eq!(drawn, solved, "{id}: what is drawn is not what was solved");
            }
        }

        // Colours, at the middle of triangles that are large enough to have one without an edge in it.
        let mut seen = 0;
        for (triangle, &value) in frame.triangles.iter().zip(frame.values) {
            let [a, b, c] = triangle.map(|p| project(&camera, rect, frame.positions[p as usize]));
            let area = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])).abs();
            if area < 60.0 {
                continue;
            }
            let [x, y] = [0, 1].map(|i| ((a[i] + b[i] + c[i]) / 3.0) as u32);
            let expected = colormap::color(colormap::position(value, frame.range));
            let got = pixel(&picture, x, y);
            if distance(expected, got) <= 2 {
                seen += 1;
            }
        }
        let large = frame.triangles.iter().filter(|t| {
            let [a, b, c] = t.map(|p| project(&camera, rect, frame.positions[p as usize]));
            0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])).abs() >= 60.0
        });
        let large = large.count();
        // The load's arrow and the supports may cover a few.
        assert!(seen as f64 >= 0.9 * large as f64, "{id}: {seen} of {large} triangles have their colour");

        // The tip: just inside the body is body, just outside is background. The outline between them is 1.2 wide.
        let probe = lab.simulation().solution(None).probes[0].clone();
        let tip = project(&camera, rect, probe.x);
        let mesh = &lab.simulation().system().mesh;
        let centre = positions.iter().sum::<Vector2<f64>>() / positions.len() as f64;
        // The roll-up's tip lies on its clamp; the others' tips are where nothing else is.
        let Some(edge) = lab.scene().probes[0].edge.as_ref().filter(|_| id != "roll-up") else { continue };
        let edge = mesh.edges.get(edge).unwrap();
        for segment in edge.iter().step_by(edge.len().div_ceil(4)) {
            let [p, q] = segment.ends.map(|n| positions[n as usize]);
            let middle = (p + q) * 0.5;
            let normal = Vector2::new((q - p).y, -(q - p).x).normalize();
            let outward = if normal.dot(&(middle - centre)) > 0.0 { normal } else { -normal };
            let at = |pixels: f64| {
                let [x, y] = project(&camera, rect, middle + outward * (pixels / camera.scale));
                pixel(&picture, x as u32, y as u32)
            };
            // The arrow starts at the middle of a loaded edge and may run either way.
            let [x, y] = project(&camera, rect, middle);
            if (x - tip[0]).hypot(y - tip[1]) < 8.0 {
                continue;
            }
            let outside = at(4.0);
            assert!(distance(outside, frame.background) <= 8, "{id}: {outside:?} outside the tip");
            assert!(distance(at(-3.0), frame.background) > 8, "{id}: background inside the tip");
        }
    }
}

/// The panel is in the picture, and only where it belongs.
#[test]
fn the_panel_can_be_left_out() {
    let gpu = Gpu::headless().unwrap();
    let mut lab = lab("article");
    lab.solve();
    let with = picture(&gpu, &mut lab, [800, 600], 1.0, egui::Theme::Dark).unwrap();
    assert!((lab.view_rect().left() - warpbeam::app::PANEL_WIDTH).abs() < 2.0, "{:?}", lab.view_rect());
    assert_eq!(lab.view_rect().right(), 800.0);
    lab.set_panel(false);
    let without = picture(&gpu, &mut lab, [800, 600], 1.0, egui::Theme::Dark).unwrap();
    assert_eq!(lab.view_rect(), egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(800.0, 600.0)));
    assert!(difference(&with, &without) > 0.1);
}

/// Twice the pixels a point: twice the size, the same picture.
#[test]
fn high_density_shows_the_same_picture_sharper() {
    let gpu = Gpu::headless().unwrap();
    let mut lab = lab("shear");
    lab.set_panel(false);
    lab.solve();
    let one = picture(&gpu, &mut lab, [400, 300], 1.0, egui::Theme::Light).unwrap();
    let two = picture(&gpu, &mut lab, [800, 600], 2.0, egui::Theme::Light).unwrap();
    let mean = |picture: &Picture, x: u32, y: u32, side: u32| {
        let sum = (0..side * side)
            .map(|i| pixel(picture, x * side + i % side, y * side + i / side))
            .fold([0; 3], |s, p| [0, 1, 2].map(|c| s[c] + u32::from(p[c])));
        sum.map(|c| (c / (side * side)) as u8)
    };
    let different =
        (0..400 * 300).filter(|i| distance(mean(&one, i % 400, i / 400, 1), mean(&two, i % 400, i / 400, 2)) > 60);
    let share = different.count() as f64 / f64::from(400 * 300);
    assert!(share < 0.02, "{share}");
}

/// Loads of any size leave a picture, in views of any size.
#[test]
fn pictures_of_extremes_and_of_tiny_views() {
    let gpu = Gpu::headless().unwrap();
    let mut lab = lab("cantilever");
    for force in [0.0, 1e-9, 9e3, 1e9, 1e15] {
        let mut scene = scene("cantilever");
        scene.loads =
            vec![warpbeam::scene::Load::Force { place: warpbeam::scene::Place::edge("right"), force: [0.0, -force] }];
        lab.set_scene(scene).unwrap();
        lab.solve();
        for size in [[1, 1], [40, 300], [400, 40], [500, 400]] {
            let picture = picture(&gpu, &mut lab, size, 1.0, egui::Theme::Dark).unwrap();
            assert_eq!(picture.rgba.len(), (4 * size[0] * size[1]) as usize);
        }
    }
}
