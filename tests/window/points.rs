//! Tests of the card of a point, of probes that are kept, of the colours, and of the magnified displacement.

use crate::common::lab::*;

/// Returns all painted texts.
fn texts(ui: &Ui) -> Vec<String> {
    painted(ui).into_iter().map(|(_, text)| text).collect()
}

fn positions(lab: &Lab) -> Vec<Vector2<f64>> {
    lab.frame().positions.to_vec()
}

fn magnify(ui: &mut Ui, magnification: Magnification) -> Vec<Vector2<f64>> {
    ui.state_mut().desk.view.magnification = magnification;
    ui.run();
    positions(ui.state())
}

/// It cannot be grabbed then. The automatic factor draws the largest displacement as 2 to 5 % of the size.
#[test]
fn a_body_is_drawn_with_a_multiple_of_its_displacement() {
    let mut stiff = scene("cantilever");
    stiff.material.young *= 1e4;
    let mut ui = open_of("cantilever", stiff);
    let true_scale = positions(ui.state());
    assert!(!texts(&ui).iter().any(|text| text.contains("displacement ×")));
    let twice = magnify(&mut ui, Magnification::Factor(2.0));
    let largest = largest(ui.simulation().displacement());
    let drawn = largest_distance(&true_scale, &twice);
    assert!((drawn - largest).abs() < 1e-9 * largest, "{drawn} {largest}");
    let many = magnify(&mut ui, Magnification::Factor(250.0));
    for ((one, two), many) in true_scale.iter().zip(&twice).zip(&many) {
        assert!((many - one - (two - one) * 249.0).norm() < 1e-9, "{one} {two} {many}");
    }
    assert!(texts(&ui).contains(&"displacement × 250".to_owned()), "{:?}", texts(&ui));
    let automatic = magnify(&mut ui, Magnification::Automatic);
    let shift = largest_distance(&true_scale, &automatic) + largest;
    let size = ui.simulation().system().size();
    assert!((0.02 * size..=0.05 * size).contains(&shift), "{shift} of {size}");
    // The root is drawn where it is, whatever the factor.
    let pos = ui.on_body([0.3, 0.0]);
    let pull = |ui: &mut Ui| {
        ui.hold(pos);
        (1..6_u8).for_each(|i| ui.move_to(pos + vec2(0.0, 8.0 * f32::from(i))));
        let is_grabbed = ui.simulation().mouse_spring().is_some();
        ui.release(pos + vec2(0.0, 40.0));
        is_grabbed
    };
    assert!(!pull(&mut ui), "a magnified body is grabbed");
    magnify(&mut ui, Magnification::None);
    assert!(pull(&mut ui), "the body is not grabbed");
    let mut article = open("article");
    assert_eq!(magnify(&mut article, Magnification::Automatic), positions(article.state()));
}

/// The automatic factor falls as the displacement grows, so that the body is drawn at the same place.
#[test]
fn colours_follow_the_load_of_a_magnified_body() {
    let mut stiff = scene("cantilever").with_method(MethodKind::Linear);
    stiff.material.young *= 1e5;
    let mut ui = open_of("cantilever", stiff);
    magnify(&mut ui, Magnification::Automatic);
    for _ in 0..4 {
        let [_, before] = ui.state().frame().range;
        ui.edit(|scene| scene.scale_loads(2.0));
        ui.run();
        let [_, after] = ui.state().frame().range;
        assert!((after / before - 2.0).abs() < 1e-6, "{before} {after}");
    }
}

#[test]
fn a_hovered_point_has_the_values_of_its_card() {
    let mut ui = open_solved("cantilever", scene("cantilever"));
    for at in [[3.1374, 0.2113], [7.7137, -0.3276]] {
        let pos = ui.on_body(at);
        ui.hover(pos);
        let shown = texts(&ui);
        let (stress, u) = shown.iter().find_map(|text| text.split_once("\nu = ")).unwrap();
        ui.click_at(pos);
        ui.run();
        assert!(ui.state().probed().is_some());
        for value in [stress.strip_prefix("von Mises (Cauchy): ").unwrap(), u] {
            assert!(ui.query_all_by_label(value).next().is_some(), "{value} is not on the card");
        }
    }
}

/// Every field has the value of the card's point under the pointer, and its own name at the colour bar.
#[test]
fn every_field_colours_the_body() {
    // The view has room for the outline of the reference once that is known.
    let mut ui = open_solved("article", scene("article"));
    let at = Vector2::new(1.1, 0.3);
    let pos = ui.on_body(at);
    for field in Field::ALL {
        ui.state_mut().desk.view.color_with(field);
        ui.hover(pos);
        let lab = ui.state();
        let point = lab.simulation().mesh().locate(at).unwrap();
        let state = lab.simulation().point_state(point, PointValues::Recovered).unwrap();
        let factor = if field.unit().is_empty() { (100.0, "%") } else { (1.0, field.unit()) };
        let shown = texts(&ui);
        let title = shown.iter().find(|text| text.starts_with(&format!("{}: ", field.name())));
        let title = title.unwrap_or_else(|| panic!("{field:?}: {shown:?}"));
        assert!(shown.iter().any(|text| text.starts_with(&format!("{}, ", field.name()))), "{field:?}: {shown:?}");
        let Some(value) = state.field(field) else { continue };
        // The pointer is within a pixel of the point.
        let value = engineering(three_digits(factor.0 * value), factor.1);
        let number = |text: &str| text.split([' ', '\n', '°']).find_map(|word| word.parse::<f64>().ok()).unwrap();
        let (seen, wanted) = (number(&title[field.name().len() + 2..]), number(&value));
        assert!((seen - wanted).abs() < 0.05 * wanted.abs() + 0.05, "{field:?}: {title} is not {value}");
    }
    assert!(ui.state().frame().range[0] >= 0.0, "the last field is a magnitude");
    ui.state_mut().desk.view.color_with(Field::StressX);
    ui.run();
    let [low, high] = ui.state().frame().range;
    assert!(low == -high && high > 0.0, "a signed field has a symmetric range");
}

/// A card is inside a view of any size, and not on its point. It can be dragged away, and stays there while the body moves.
#[test]
fn a_card_begins_beside_its_point_and_can_be_dragged() {
    for size in [[640.0, 480.0], [900.0, 600.0], SIZE, [1920.0, 1080.0]] {
        for name in ["article", "cantilever", "gravity"] {
            let mut ui = open_with(size, name, scene(name), &|_| {});
            let card = |ui: &Ui| ui.query_by_role(Role::Window).map(|window| window.rect());
            let (low, high) = ui.simulation().mesh().bounds();
            for part in [[0.03, 0.5], [0.35, 0.2], [0.6, 0.7], [0.97, 0.5]] {
                let what = format!("{size:?}, {name}, {part:?}");
                let pos = ui.on_body(low + Vector2::from(part).component_mul(&(high - low)));
                ui.click_at(pos);
                ui.run();
                let place = card(&ui).unwrap();
                assert!(ui.state().view_rect().contains_rect(place) && !place.contains(pos), "{what}: {place}");
                assert!(ui.says("Point (") && ui.query_by_label("σ_x, σ_y").is_some(), "{what}");
                ui.click_at(pos);
                ui.run();
                assert!(!ui.says("Point ("), "{what}");
            }
            ui.click_at(ui.on_body(0.5 * (low + high)));
            ui.run();
            let corner = ui.state().view_rect().min;
            let title = card(&ui).unwrap().center_top() + vec2(0.0, 16.0);
            ui.drag(title, title + (corner - card(&ui).unwrap().min));
            ui.run();
            assert!(card(&ui).unwrap().min.distance(corner) < 3.0, "{size:?}, {name}: {:?}", card(&ui));
            let dragged = card(&ui).unwrap().min;
            ui.edit(|scene| scene.scale_loads(0.5));
            ui.run();
            assert_eq!(card(&ui).unwrap().min, dragged, "{size:?}, {name}");
            // Measure has no room for the values: the card is folded.
            ui.key(Key::B);
            ui.run();
            assert!(ui.says("Point ("), "{size:?}, {name}");
            assert_eq!(
                ui.query_by_label("σ_x, σ_y").is_some(),
                ui.state().view_rect().height() >= 302.0,
                "{size:?}, {name}"
            );
        }
    }
}

/// A point that is kept has a row in every pane of Compare. Its card has the stresses in both axes.
#[test]
fn a_point_is_kept_as_a_probe() {
    let mut ui = open("article");
    let before = ui.scene().clone();
    ui.click_at(ui.on_body([2.2, 0.3]));
    let state = ui.simulation().point_state(ui.state().probed().unwrap(), PointValues::Recovered).unwrap();
    let pair =
        |fields: [Field; 2]| engineering_pair(fields.map(|field| state.field(field).unwrap()).map(three_digits), "Pa");
    let space = pair([Field::StressX, Field::StressY]);
    let own = pair([Field::MaterialStressX, Field::MaterialStressY]);
    let shown = |ui: &Ui| [&space, &own].map(|text| ui.query_by_label(text).is_some());
    assert_eq!(shown(&ui), [true, false], "{space} {own}");
    ui.click("material X, Y");
    assert_eq!(shown(&ui), [false, true], "{space} {own}");
    ui.push("Keep as probe");
    let mut kept = before.clone();
    kept.probes.clone_from(&ui.scene().probes);
    assert_eq!((*ui.scene() == kept, kept.probes.len()), (true, before.probes.len() + 1));
    assert!(!ui.has(Role::Button, "Keep as probe"), "it is kept already");
    ui.state_mut().show_comparison(&parse_panes("linear,newton").unwrap());
    ui.run();
    for pane in ui.state().panes() {
        let u = pane.simulation().unwrap().probe("p1").unwrap();
        ui.get_by_label(&format!("p1: u = {}", engineering_pair([u.x, u.y].map(three_digits), "m")));
    }
    ui.undo();
    assert_eq!(*ui.scene(), before, "undone");
}

#[test]
fn the_panel_chooses_field_and_magnification() {
    let mut ui = open("cantilever");
    ui.fold("View: ");
    pick(&mut ui, "Colour", Field::ShearStress.name());
    assert_eq!(ui.state().frame().field, Field::ShearStress);
    pick(&mut ui, "Displacement", "Factor");
    assert!(texts(&ui).contains(&"displacement × 10".to_owned()));
    pick(&mut ui, "Displacement", "True scale");
    assert!(!texts(&ui).iter().any(|text| text.contains("displacement ×")));
}

/// A base is dragged to any point; forces and supports also snap to corners and middles. Each is one step of undo.
#[test]
fn bases_of_objects_are_dragged_along_the_body() {
    let scene = scene("cantilever").probe("p1", [4.0, 0.2]).section([6.0, 0.0], 0.0).support([2.0, -0.5], &[Axis::Y]);
    let mut ui = open_of("cantilever", scene);
    let before = ui.scene().clone();
    let drag = |ui: &mut Ui, from: [f64; 2], to: [f64; 2]| ui.drag(ui.on_body(from), ui.on_body(to));
    // Asserts that a place is near a point, and returns it.
    let near = |place: &Place, wanted: [f64; 2]| {
        let Place::At(at) = *place else { panic!("{place:?}") };
        assert!((Vector2::from(at) - Vector2::from(wanted)).norm() < 0.05, "{at:?}");
        at
    };
    let load = |ui: &Ui| {
        let Load::Force { place, width, .. } = &ui.scene().loads[0] else { panic!("a force") };
        (place.clone(), *width)
    };
    // The middle of the right edge, where the arrow begins; it moves to the side.
    drag(&mut ui, [9.999, 0.0], [6.9, 0.49]);
    let (place, width) = load(&ui);
    let point = near(&place, [6.9, 0.5]);
    assert!(point[1] == 0.5 && width == 0.1, "{point:?}");
    assert!(!ui.says("acts on the nearest node"), "the force acts at its point");
    let moved = ui.scene().clone();
    drag(&mut ui, point, [9.999, 0.03]);
    assert_eq!(load(&ui), (Place::At([10.0, 0.0]), 0.1), "a force at a point is not distributed over an edge");
    for earlier in [moved, before] {
        ui.undo();
        assert_eq!(*ui.scene(), earlier, "one step of undo");
    }
    drag(&mut ui, [4.0, 0.2], [5.1, -0.1]);
    let probe = near(&ui.scene().probes.iter().find(|probe| probe.name == "p1").unwrap().place, [5.1, -0.1]);
    drag(&mut ui, [6.0, 0.0], [3.0, 0.1]);
    let line = ui.scene().sections[0];
    assert!((line.at - Vector2::new(3.0, 0.1)).norm() < 0.05 && line.angle == 0.0, "{line:?}");
    drag(&mut ui, [2.0, -0.499], [7.33, 0.12]);
    let held = |ui: &Ui| ui.scene().supports.last().unwrap().clone();
    let inside = near(&held(&ui).place, [7.33, 0.12]);
    let reaction = ui.simulation().support_reactions().last().unwrap().clone();
    assert!((reaction.middle.y - inside[1]).abs() < 1e-9 && reaction.force.y > 0.0, "{reaction:?}");
    assert!(held(&ui).at_point && !ui.says("acts on the nearest node"), "the support holds its point");
    // To the corner at the lower right, and to the middle of an edge, where it still holds a point.
    for (from, to, place) in [(inside, [9.99, -0.49], [10.0, -0.5]), ([9.999, -0.499], [9.999, 0.03], [10.0, 0.0])] {
        drag(&mut ui, from, to);
        let held = held(&ui);
        assert_eq!((held.place, held.at_point, &held.fix[..]), (Place::At(place), false, &[Axis::Y][..]));
    }
    let before = ui.scene().clone();
    let from = ui.on_body([9.999, 0.0]);
    ui.drag(from, from - vec2(0.0, 200.0));
    assert_eq!(*ui.scene(), before, "dropped beside the body");
    ui.click_at(ui.on_body(probe));
    assert!(ui.state().probed().is_some(), "a press without a drag inspects");
}

/// Coordinates are typed with units.
#[test]
fn coordinates_of_a_point_are_typed() {
    let mut ui = open_of("cantilever", scene("cantilever").force([5.0, 0.5], [0.0, -10.0]));
    let load = |ui: &Ui| {
        let Load::Force { place, at_point, .. } = &ui.scene().loads[1] else { panic!("a force") };
        (place.clone(), *at_point)
    };
    unfold(&mut ui, "Force on");
    ui.type_into("x", "250 cm");
    assert_eq!(load(&ui), (Place::At([2.5, 0.5]), false), "a node is there");
    ui.undo();
    assert_eq!(load(&ui).0, Place::At([5.0, 0.5]), "undone");
    ui.type_into("y", "3 kg");
    ui.expect(&["expected"]);
    ui.type_into("width", "20 cm");
    assert!(matches!(ui.scene().loads[1], Load::Force { at_point: true, width: 0.2, .. }), "{:?}", ui.scene().loads);
    ui.type_into("x", "20 m");
    assert!(ui.says("Load 2: ") && !ui.says("load.1"), "a refusal names the load as the panel does: {:?}", ui.texts());
}

/// A new beam on two supports has an error; its name is typed, and is in its file.
#[test]
fn a_new_beam_has_an_error_and_a_name() {
    let mut ui = open("cantilever");
    pick(&mut ui, "Scene", "on two supports");
    settle(&mut ui);
    assert!(!ui.says("no reference") && ui.says("ERROR 0."), "{:?}", ui.texts());
    assert_eq!(ui.state().title(), "New beam \u{2013} warpbeam");
    let view = ui.state().view_rect();
    ui.fold("Loads and supports: ");
    assert_eq!(ui.state().view_rect(), view, "the panel has grown");
    crate::panel::controls_are_inside(&ui);
    ui.fold("Loads and supports: ");
    ui.fold("File: ");
    ui.get_by_role_and_label(Role::TextInput, "Name").click();
    ui.run();
    ui.event(egui::Event::Text(" of mine".into()));
    ui.key(Key::Enter);
    assert_eq!(ui.scene().name, "New beam of mine");
    assert_eq!(covered_text(&ui), None);
    ui.undo();
    ui.undo();
    assert_eq!(ui.scene().name, scene("cantilever").name, "undo leads back to the scene before");
}

/// It is that of a solution on a fine mesh of our own, has no value while the reference is not known, and says so.
#[test]
fn the_distance_to_the_reference_colours_the_body() {
    let corner = [5.0, 0.5];
    let scene = scene("article").probe("corner", corner);
    let mut fine = scene.clone().with_cells(40, 8).with_element(ElementKind::T6).with_method(MethodKind::Newton);
    fine.solver.tolerance = 1e-10;
    let fine = solved(&fine).probe("corner").unwrap();
    let mut ui = open_solved("article", scene.clone());
    ui.state_mut().desk.view.color_with(Field::ReferenceDistance);
    ui.run();
    let name = Field::ReferenceDistance.name();
    let wanted = (ui.simulation().probe("corner").unwrap() - fine).norm();
    let largest = ui.state().frame().range[1];
    assert!(largest >= 0.99 * wanted, "{largest} m");
    ui.hover(ui.on_body([corner[0] - 1e-3, corner[1] - 1e-3]));
    let shown = texts(&ui);
    let value = shown.iter().find_map(|text| text.strip_prefix(&format!("{name}: "))).unwrap();
    let seen: f64 = value.split(' ').next().unwrap().parse().unwrap();
    assert!((seen - wanted).abs() < 0.01 * wanted, "{value} instead of {wanted} m");
    let mut unknown = scene;
    unknown.probes.clear();
    let mut ui = open_of("article", unknown);
    ui.state_mut().desk.view.color_with(Field::ReferenceDistance);
    ui.run();
    assert!(texts(&ui).iter().any(|text| text.starts_with(&format!("{name}, m, not known"))), "{:?}", texts(&ui));
}
