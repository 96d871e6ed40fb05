//! Tests of load curves in the window: plotted quantities, their table, and exported files.

use crate::common::alone::ran_alone;
use crate::common::lab::*;
use warpbeam::study::figure::LoadAxis;
use warpbeam::study::{LoadCurve, Setting};

/// Mesh and force with which linear theory's tip moves as far as the exact one, but in another direction.
const SETS: &[&str] = &["beam.element=t3", "beam.cells=[80,8]", "load.0.force=[0,-553]"];

/// Returns a solved scene with its load curve.
fn with_curve(scene: Scene) -> Ui {
    open_with(SIZE, "scene", scene, &|lab| lab.show_tab(MeasureTab::LoadCurve))
}

#[test]
fn a_wrong_displacement_of_the_right_length_has_an_error() {
    let cantilever = scene_with("cantilever", SETS);
    let exact = Reference::of(&cantilever).unwrap().first().unwrap().displacement;
    let compared = |lab: &mut Lab| lab.show_comparison(&parse_panes("linear,newton").unwrap());
    let ui = open_with(SIZE, "scene", cantilever.clone(), &compared);
    let pane = &ui.state().panes()[0];
    let linear = pane.run.end.as_ref().unwrap().probes[0].u;
    assert!((linear.norm() - exact.norm()).abs() < 1e-3 * exact.norm(), "{linear} {exact}");
    let error = 100.0 * (linear - exact).norm() / exact.norm();
    assert!(error > 12.0 && (pane.error_percent.unwrap() - error).abs() < 1e-6, "{:?}", pane.error_percent);

    let ui = with_curve(cantilever);
    assert_eq!(ui.starting("linear beam theory: "), "linear beam theory: (0, -2.23) m");
    assert!(ui.starting("exact beam: ").starts_with("exact beam: (-0.27"));
}

/// Returns the painted titles of the axes.
fn axis_names(ui: &Ui) -> Vec<String> {
    let names = ["force", "u_x of tip", "u_y of tip"];
    let mut found: Vec<String> = texts(ui).into_iter().map(|(text, _, _)| text).collect();
    found.retain(|text| names.contains(&text.as_str()));
    found
}

#[test]
fn the_path_and_both_components_can_be_chosen() {
    let mut ui = with_curve(scene_with("cantilever", SETS));
    assert_eq!(axis_names(&ui), ["force", "u_y of tip"]);
    for (button, x, y) in [("Path", "u_x of tip", "u_y of tip"), ("u_x", "force", "u_x of tip")] {
        ui.click(button);
        assert_eq!(axis_names(&ui), [x, y]);
    }
    // The tip of an axial bar moves along a straight line, so that the load is plotted instead of a path.
    assert!(texts(&with_curve(scene("stretch"))).iter().any(|(text, _, _)| text == "force"));
}

#[test]
fn loads_are_plotted_in_their_unit() {
    let mut scene = scene_with("cantilever", SETS);
    let (idle, small) = (Load::force("top", [0.0, 0.0]), Load::force("top", [3.0, 4.0]));
    let (own, moment) = (scene.loads[0].clone(), |size| Load::moment("right", size));
    for (loads, name, unit, full) in [
        (vec![own.clone()], "force", "N", 553.0),
        (vec![own.clone(), idle], "force", "N", 553.0),
        (vec![own.clone(), small.clone()], "first force, the others in proportion", "N", 553.0),
        (vec![own, small, moment(7.0)], "load factor", "", 1.0),
        (vec![moment(-7.0)], "moment", "N m", 7.0),
    ] {
        scene.loads = loads;
        let axis = LoadAxis::of(&scene);
        assert_eq!((&*axis.name.to_string(), axis.unit, axis.full), (name, unit, full));
    }
}

/// Returns every painted text, titles of axes without their unit, with its rectangle and its clip rectangle.
fn texts(ui: &Ui) -> Vec<(String, Rect, Rect)> {
    let name = |text: &str| text.rsplit_once(", ").map_or(text, |(name, _)| name).to_owned();
    let texts = text_shapes(ui).into_iter();
    texts.map(|(clip, text)| (name(text.galley.text()), text.visual_bounding_rect(), clip)).collect()
}

/// On the first frame, titles of axes are already next to their numbers, and no text is clipped.
#[test]
fn the_first_frame_is_as_the_others() {
    for (id, sets) in [("cantilever", SETS), ("article", &[]), ("snap", &[]), ("stretch", &[])] {
        let mut ui = open_solved("scene", scene_with(id, sets));
        ui.key_press(Key::L);
        let names = ["force", "u_x of tip", "u_y of tip", "u_x of end", "u_y of end", "reaction in this direction"];
        ui.wait_until("a curve", |ui| texts(ui).iter().any(|(text, _, _)| names[1..].contains(&text.as_str())));
        let texts = texts(&ui);
        let is_title = |text: &str| names.contains(&text) || text.starts_with("displacement of");
        let titles: Vec<_> = texts.iter().filter(|(text, _, _)| is_title(text)).collect();
        assert_eq!(titles.len(), 2, "{id}: {titles:?}");
        for (text, place, _) in texts.iter().filter(|(text, _, _)| text.parse::<f64>().is_ok()) {
            for (title, title_place, _) in &titles {
                assert!(!place.shrink(1.0).intersects(*title_place), "{id}: {text} {place:?} {title} {title_place:?}");
            }
        }
        for (text, place, clip) in texts.iter().filter(|(text, _, _)| text.starts_with("linear")) {
            assert!(clip.expand(1.0).contains_rect(*place), "{id}: {text} is cut");
        }
    }
}

/// Returns the rows of a CSV file; the parser is independent of the writer.
fn csv(text: &str) -> Vec<Vec<String>> {
    let (mut rows, mut row, mut field, mut quoted) = (Vec::new(), Vec::new(), String::new(), false);
    for c in text.chars() {
        match c {
            '"' => quoted ^= true,
            ',' if !quoted => row.push(std::mem::take(&mut field)),
            '\n' if !quoted => {
                row.push(std::mem::take(&mut field));
                rows.push(std::mem::take(&mut row));
            }
            c => field.push(c),
        }
    }
    assert!(field.is_empty() && row.is_empty() && !quoted, "{text}");
    rows
}

/// Selects a file format in the export menu.
fn export(ui: &mut Ui, kind: &str) {
    ui.click("Export");
    ui.click(kind);
}

/// Returns the rows of a series as numbers: load, u_x, u_y.
fn points(rows: &[Vec<String>], series: &str) -> Vec<[f64; 3]> {
    rows.iter().filter(|row| row[0] == series).map(|row| [1, 2, 3].map(|i| row[i].parse().unwrap())).collect()
}

/// The test changes the current folder, in a process of its own.
#[test]
fn curves_are_saved_as_files() {
    if ran_alone("figures::curves_are_saved_as_files") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let cantilever = scene_with("cantilever", SETS);
    let mut ui = with_curve(cantilever.clone());
    std::env::set_current_dir(folder.path()).unwrap();
    export(&mut ui, "CSV");
    assert_eq!(ui.starting("Saved"), "Saved warpbeam-001.csv");
    let rows = csv(&std::fs::read_to_string("warpbeam-001.csv").unwrap());
    assert_eq!(rows[0][..4], ["series", "force (N)", "u_x of tip (m)", "u_y of tip (m)"]);
    let curve = LoadCurve::new(&cantilever).unwrap();
    let own: Vec<[f64; 3]> = curve.samples.iter().map(|s| [553.0 * s.factor, s.exact.x, s.exact.y]).collect();
    assert_eq!(points(&rows, "exact beam"), own);
    let linear: Vec<[f64; 3]> = curve.samples.iter().map(|s| [553.0 * s.factor, s.linear.x, s.linear.y]).collect();
    assert_eq!(points(&rows, "linear beam theory"), linear);
    assert_eq!(points(&rows, "beam theory off by 3, 5, 10 %").len(), 3);

    export(&mut ui, "SVG");
    let svg = std::fs::read_to_string("warpbeam-001.svg").unwrap();
    let document = roxmltree::Document::parse(&svg).unwrap();
    let texts: Vec<&str> = document.descendants().filter_map(|node| node.text()).collect();
    for text in ["Cantilever: Load curve", "force, N", "u_y of tip, m", "exact beam", "(0, -2.14) m"] {
        assert!(texts.contains(&text), "{text}: {texts:?}");
    }
    assert!(!svg.contains("NaN"));

    // In a deleted folder no file can be saved, which is reported.
    folder.close().unwrap();
    for kind in ["CSV", "SVG"] {
        export(&mut ui, kind);
        assert!(ui.starting("Not saved: ").contains("warpbeam-001"), "{kind}");
    }
}

/// Returns mesh and method of a setting in words. The number of iterations is measured, and 0 in the scene.
fn mesh_and_method(setting: &str) -> &str {
    setting.rsplit_once(", ").unwrap().0
}

/// Moves the pointer over the chart above the title of its horizontal axis until a text of two lines is beside it; returns
/// the place and the first line.
fn pointed(ui: &mut Ui, title: &str) -> (Pos2, String) {
    let (_, title, _) = texts(ui).into_iter().find(|(text, ..)| text == title).unwrap();
    // A point is found by a pointer up to 12 points away.
    let places = (2..20).flat_map(|row| (-18..19).map(move |column| vec2(15.0 * column as f32, -15.0 * row as f32)));
    for place in places.map(|by| title.center() + by) {
        ui.move_to(place);
        if let Some((text, ..)) = texts(ui).into_iter().find(|(text, ..)| text.contains('\n')) {
            return (place, text.lines().next().unwrap().to_owned());
        }
    }
    panic!("nothing is pointed at above {title:?}");
}

/// The values of the point under the pointer stand beside it; a click on a measured setting applies it.
#[test]
fn charts_react_to_the_pointer() {
    let mut ui = open("article");
    ui.key(Key::B);
    ui.click_for("Measure on this machine", 2);
    ui.wait_until("a study", |ui| ui.state().study().0.is_some() && !ui.state().study().1);
    let (place, setting) = pointed(&mut ui, "time of a solve");
    let applied = |ui: &Ui| Setting::of(ui.scene()).to_string();
    assert_ne!(mesh_and_method(&applied(&ui)), mesh_and_method(&setting));
    ui.click_at(place);
    assert_eq!(mesh_and_method(&applied(&ui)), mesh_and_method(&setting));
    ui.key(Key::L);
    ui.wait_until("a curve", |ui| texts(ui).iter().any(|(text, ..)| text == "u_y of tip"));
    pointed(&mut ui, "force");
}
