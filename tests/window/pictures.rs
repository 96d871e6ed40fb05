//! Tests of pictures without a window. The golden pictures of all scenes are tested in `tests/registry`.

use crate::common::pictures::{difference, distance, lab, pixel, read_png};
use crate::common::*;
use warpbeam::app::{Picture, picture};
use warpbeam::render::Gpu;

/// The golden comparison detects a beam that bends a little more.
#[test]
fn the_golden_comparison_sees_a_changed_load() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bent.png");
    let args = ["shot", "cantilever", "-o", path.to_str().unwrap(), "--size", "640x400", "--no-panel"];
    succeeds(&[&args[..], &["--set", "load.0.force=[0,-1100]"]].concat());
    assert!(difference(&read_png(&path), &read_png("tests/golden/cantilever-dark.png".as_ref())) > 2e-3);
}

/// The body fills most of the picture to the left of the panel; without panel and bars it fills the whole picture.
#[test]
fn the_panel_can_be_left_out() {
    let gpu = Gpu::headless(None).unwrap();
    let mut lab = lab("article");
    lab.solve();
    let with = picture(&gpu, &mut lab, [1280, 800], 1.0, egui::Theme::Dark).unwrap();
    let view = lab.view_rect();
    assert_eq!(view.left(), 0.0);
    assert!((view.right() + warpbeam::app::PANEL_WIDTH - 1280.0).abs() < 2.0, "{view:?}");
    let share = view.area() / (1280.0 * 800.0);
    assert!((0.65..0.75).contains(&share), "the body has {share} of the window");
    lab.desk.view.layout.bars = false;
    let without = picture(&gpu, &mut lab, [1280, 800], 1.0, egui::Theme::Dark).unwrap();
    assert_eq!(lab.view_rect(), egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(1280.0, 800.0)));
    assert!(difference(&with, &without) > 0.1);
}

/// With two pixels per point, the picture is the same at twice the size.
#[test]
fn high_density_shows_the_same_picture_sharper() {
    let gpu = Gpu::headless(None).unwrap();
    let mut lab = lab("shear");
    lab.desk.view.layout.bars = false;
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
    // The pixels along the edges of the mesh.
    assert!(share < 0.025, "{share}");
}

/// Loads of any size give a picture, in views of any size.
#[test]
fn pictures_of_extremes_and_of_tiny_views() {
    let gpu = Gpu::headless(None).unwrap();
    let mut lab = lab("cantilever");
    for force in [0.0, 1e-9, 9e3, 1e9, 1e15] {
        let mut scene = scene("cantilever");
        scene.loads = vec![Load::force("right", [0.0, -force])];
        lab.set_scene(scene).unwrap();
        lab.solve();
        for size in [[1, 1], [40, 300], [400, 40], [500, 400]] {
            let picture = picture(&gpu, &mut lab, size, 1.0, egui::Theme::Dark).unwrap();
            assert_eq!(picture.rgba.len(), (4 * size[0] * size[1]) as usize);
        }
    }
}

/// Without a desktop session, the graphics libraries print no messages.
#[test]
fn a_picture_without_a_desktop_prints_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let mut shot = program(folder.path(), &["shot", "article", "-o", "x.png", "--size", "320x200"]);
    let output = shot.env_remove("XDG_RUNTIME_DIR").env_remove("NODEVICE_SELECT").output().unwrap();
    assert!(output.status.success(), "{output:?}");
    assert_eq!(stderr(&output), "");
    assert!(folder.path().join("x.png").exists());
}

/// A study that fails is said with its reason, and the exit code is 1; the picture of the solution is there.
#[test]
fn a_shot_without_its_study_fails() {
    let folder = tempfile::tempdir().unwrap();
    let mut unprobed = scene("article");
    unprobed.probes.clear();
    std::fs::write(folder.path().join("unprobed.toml"), unprobed.to_toml().unwrap()).unwrap();
    let args = ["shot", "unprobed.toml", "--study", "-o", "x.png", "--size", "320x200"];
    has_all(&ends_in(folder.path(), 1, &args)[1], "no study: |probe");
    assert!(folder.path().join("x.png").exists());
}

/// The last equilibrium is drawn under the name and in the colour of its own method, not of the one that diverges.
#[test]
fn the_last_equilibrium_keeps_the_name_of_its_method() {
    let gpu = Gpu::headless(None).unwrap();
    let mut lab = lab("article");
    let scene_of = |method: &str, force: f64| {
        scene_with("article", &[&format!("solver.method=\"{method}\""), &format!("load.0.force=[0,{force}]")])
    };
    // Line and name in the legend; the error after the name is not known for a state that is not drawn.
    let mut legend = |method: &str, force: f64| {
        lab.set_scene(scene_of(method, force)).unwrap();
        lab.solve();
        // The state is kept when it is drawn.
        let drawn = [(); 2].map(|()| picture(&gpu, &mut lab, [1280, 800], 1.0, egui::Theme::Dark).unwrap());
        let rows = drawn[1].rgba.chunks_exact(4 * 1280).skip(48).take(20);
        (lab.simulation().status().clone(), rows.flat_map(|row| row[4 * 14..4 * 80].to_vec()).collect::<Vec<u8>>())
    };
    let (status, newton) = legend("newton", -30_000.0);
    assert_eq!(status, Status::Converged);
    let (status, last) = legend("warped", -1e6);
    assert!(matches!(status, Status::Diverged(_)), "{status:?}");
    // The veil over a body that is not the state asked for shines through the box of the legend.
    let far = |a: &[u8], b: &[u8]| a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or_default();
    assert!(far(&last, &newton) < 8, "{}", far(&last, &newton));
    let (status, warped) = legend("warped", -30_000.0);
    assert_eq!(status, Status::Converged);
    assert!(far(&warped, &newton) > 80, "{}", far(&warped, &newton));
}
