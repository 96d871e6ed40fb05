//! Tests of the card of a point, of probes that are kept, of the colours, and of the magnified displacement.

use egui::accesskit::Role;
use egui::{Key, Modifiers, Pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use nalgebra::Vector2;

use crate::common::lab::{lab_of, pick, type_into, unfold, window};
use crate::common::{scene, solved};
use crate::ui_interaction::{click, drag, harness, harness_of, on_body, shapes};
use warpbeam::app::{Lab, Magnification, parse_panes};
use warpbeam::format::{engineering, engineering_pair, three_digits};
use warpbeam::scene::{Axis, ElementKind, Load, MethodKind, Place};
use warpbeam::{Field, PointValues, Scene};

/// Returns all texts that are painted without a widget.
pub fn painted(harness: &Harness<'_, Lab>) -> Vec<String> {
    let texts = shapes(harness).into_iter().filter_map(|shape| match shape {
        egui::Shape::Text(text) => Some(text.galley.text().to_owned()),
        _ => None,
    });
    texts.collect()
}

/// Opens a window with a scene that is solved.
fn solved_window(id: &str, scene: Scene) -> Harness<'static, Lab> {
    let mut lab = lab_of(id, scene);
    lab.solve();
    let mut harness = window([1280.0, 800.0], lab);
    harness.run();
    harness
}

fn positions(lab: &Lab) -> Vec<Vector2<f64>> {
    lab.frame().positions.to_vec()
}

fn magnify(harness: &mut Harness<'_, Lab>, magnification: Magnification) -> Vec<Vector2<f64>> {
    harness.state_mut().magnify(magnification);
    harness.run();
    positions(harness.state())
}

/// A stiff body is drawn with a multiple of its displacement, and says so. It cannot be grabbed then. The automatic factor
/// draws the largest displacement as 2 to 5 % of the body's size.
#[test]
fn a_body_is_drawn_with_a_multiple_of_its_displacement() {
    let mut stiff = scene("cantilever");
    stiff.material.young *= 1e4;
    let mut harness = harness_of("cantilever", stiff);
    harness.run();
    let true_scale = positions(harness.state());
    assert!(!painted(&harness).iter().any(|text| text.contains("displacement ×")));
    let twice = magnify(&mut harness, Magnification::Factor(2.0));
    let largest = harness.state().simulation().displacement().iter().map(|u| u.norm()).fold(0.0, f64::max);
    let drawn = true_scale.iter().zip(&twice).map(|(a, b)| (b - a).norm()).fold(0.0, f64::max);
    assert!((drawn - largest).abs() < 1e-9 * largest, "{drawn} {largest}");
    let many = magnify(&mut harness, Magnification::Factor(250.0));
    for ((one, two), many) in true_scale.iter().zip(&twice).zip(&many) {
        assert!((many - one - (two - one) * 249.0).norm() < 1e-9, "{one} {two} {many}");
    }
    assert!(painted(&harness).contains(&"displacement × 250".to_owned()), "{:?}", painted(&harness));
    let automatic = magnify(&mut harness, Magnification::Automatic);
    let shift = true_scale.iter().zip(&automatic).map(|(a, b)| (b - a).norm()).fold(0.0, f64::max) + largest;
    let size = harness.state().simulation().system().size();
    assert!((0.02 * size..=0.05 * size).contains(&shift), "{shift} of {size}");
    // The root is drawn where it is, whatever the factor.
    let pos = on_body(harness.state(), Vector2::new(0.3, 0.0));
    let pull = |harness: &mut Harness<'_, Lab>| {
        harness.hover_at(pos);
        harness.step();
        harness.drag_at(pos);
        harness.step();
        (1..6).for_each(|i| {
            harness.hover_at(pos + egui::vec2(0.0, 8.0 * i as f32));
            harness.step();
        });
        let is_grabbed = harness.state().simulation().mouse_spring().is_some();
        harness.drop_at(pos + egui::vec2(0.0, 40.0));
        harness.run();
        is_grabbed
    };
    assert!(!pull(&mut harness), "a magnified body is grabbed");
    magnify(&mut harness, Magnification::None);
    assert!(pull(&mut harness), "the body is not grabbed");
    // Large displacements are never drawn smaller.
    let mut article = self::harness("article");
    article.run();
    let before = positions(article.state());
    assert_eq!(magnify(&mut article, Magnification::Automatic), before);
}

/// Colours follow the load where the automatic factor falls as the displacement grows, so that the body is drawn at the
/// same place.
#[test]
fn colours_follow_the_load_of_a_magnified_body() {
    let mut stiff = scene("cantilever").with_method(MethodKind::Linear);
    stiff.material.young *= 1e5;
    let mut harness = harness_of("cantilever", stiff);
    harness.run();
    magnify(&mut harness, Magnification::Automatic);
    for _ in 0..4 {
        let [_, before] = harness.state().frame().range;
        let mut scene = harness.state().scene().clone();
        scene.scale_loads(2.0);
        harness.state_mut().set_scene(scene).unwrap();
        harness.run();
        let [_, after] = harness.state().frame().range;
        assert!((after / before - 2.0).abs() < 1e-6, "{before} {after}");
    }
}

/// The label at the pointer has the values of the card that a click opens there.
#[test]
fn a_hovered_point_has_the_values_of_its_card() {
    let mut harness = solved_window("cantilever", scene("cantilever"));
    for at in [Vector2::new(3.1374, 0.2113), Vector2::new(7.7137, -0.3276)] {
        let pos = on_body(harness.state(), at);
        harness.hover_at(pos);
        harness.run();
        let shown = painted(&harness);
        let hovered = shown.iter().find_map(|text| text.split_once("\nu = ")).unwrap();
        let stress = hovered.0.strip_prefix("von Mises (Cauchy): ").unwrap();
        click(&mut harness, pos);
        harness.run();
        assert!(harness.state().probed().is_some());
        for value in [stress, hovered.1] {
            let alike = harness.query_all_by_label(value).count();
            assert!(alike > 0, "{value} is not on the card");
        }
    }
}

/// Every field has the value of the card's point under the pointer, and its own name at the colour bar.
#[test]
fn every_field_colours_the_body() {
    // The view has room for the outline of the reference once that is known.
    let mut harness = solved_window("article", scene("article"));
    let at = Vector2::new(1.1, 0.3);
    let pos = on_body(harness.state(), at);
    for field in Field::ALL {
        harness.state_mut().color_with(field);
        harness.hover_at(pos);
        harness.run();
        let lab = harness.state();
        let point = lab.simulation().mesh().locate(at).unwrap();
        let state = lab.simulation().point_state(point, PointValues::Recovered).unwrap();
        let factor = if field.unit().is_empty() { (100.0, "%") } else { (1.0, field.unit()) };
        let shown = painted(&harness);
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
    let largest = harness.state().frame().range;
    assert!(largest[0] >= 0.0, "the last field is a magnitude");
    harness.state_mut().color_with(Field::StressX);
    harness.run();
    let [low, high] = harness.state().frame().range;
    assert!(low == -high && high > 0.0, "a signed field has a symmetric range");
}

/// In a window of any size, the card of a point covers less than a third of the body, unless all values are asked for in
/// a small one.
#[test]
fn a_card_leaves_the_body_in_view() {
    let id = egui::Id::unique("probe");
    for size in [[640.0, 480.0], [900.0, 600.0], [1280.0, 800.0], [1920.0, 1080.0]] {
        for name in ["article", "cantilever", "gravity"] {
            let mut lab = lab_of(name, scene(name));
            lab.solve();
            let mut harness = window(size, lab);
            harness.run();
            let (low, high) = harness.state().simulation().mesh().bounds();
            let on = |part: [f64; 2]| low + Vector2::new(part[0], part[1]).component_mul(&(high - low));
            let grid = (0..=40).flat_map(|i| [0.1, 0.5, 0.9].map(|y| on([0.01 + 0.98 * f64::from(i) / 40.0, y])));
            let grid: Vec<_> = grid.collect();
            for part in [[0.03, 0.5], [0.35, 0.2], [0.6, 0.7], [0.97, 0.5]] {
                let pos = on_body(harness.state(), on(part));
                click(&mut harness, pos);
                harness.run();
                let card = harness.ctx.memory(|memory| memory.area_rect(id)).unwrap();
                let hidden = grid.iter().filter(|at| card.contains(on_body(harness.state(), **at))).count();
                assert!(3 * hidden < grid.len(), "{size:?}, {name}, {part:?}: {hidden} of {}, {card:?}", grid.len());
                assert!(harness.query_by_label_contains("Point (").is_some(), "{size:?}, {name}, {part:?}");
                click(&mut harness, pos);
                harness.run();
                assert!(harness.query_by_label_contains("Point (").is_none(), "{size:?}, {name}, {part:?}");
            }
            let pos = on_body(harness.state(), on([0.35, 0.2]));
            click(&mut harness, pos);
            harness.run();
            if let Some(all) = harness.query_by_label("All values") {
                assert!(harness.query_by_label("σ_x, σ_y").is_none() && size[0] < 1280.0, "{size:?}, {name}");
                all.click();
                harness.run();
            }
            assert!(harness.query_by_label("σ_x, σ_y").is_some(), "{size:?}, {name}");
        }
    }
}

/// A card has the stresses in both axes; a kept point is a probe of the scene, has a row in every pane of Compare, and
/// undo takes it back.
#[test]
fn a_point_is_kept_as_a_probe() {
    let mut harness = harness("article");
    harness.run();
    let before = harness.state().scene().clone();
    let pos: Pos2 = on_body(harness.state(), Vector2::new(2.2, 0.3));
    click(&mut harness, pos);
    let lab = harness.state();
    let state = lab.simulation().point_state(lab.probed().unwrap(), PointValues::Recovered).unwrap();
    let pair = |a: Field, b: Field| {
        let values = [a, b].map(|field| state.field(field).unwrap());
        engineering_pair(values.map(three_digits), "Pa")
    };
    let [space, own] = [pair(Field::StressX, Field::StressY), pair(Field::MaterialStressX, Field::MaterialStressY)];
    assert!(harness.query_by_label(&space).is_some() && harness.query_by_label(&own).is_none(), "{space} {own}");
    harness.get_by_label("material X, Y").click();
    harness.run();
    assert!(harness.query_by_label(&own).is_some() && harness.query_by_label(&space).is_none(), "{space} {own}");
    harness.get_by_role_and_label(Role::Button, "Keep as probe").click();
    harness.run();
    let mut kept = before.clone();
    kept.probes.clone_from(&harness.state().scene().probes);
    assert_eq!((*harness.state().scene() == kept, kept.probes.len()), (true, before.probes.len() + 1));
    assert!(harness.query_by_role_and_label(Role::Button, "Keep as probe").is_none(), "it is kept already");
    harness.state_mut().show_comparison(&parse_panes("linear,newton").unwrap());
    harness.run();
    for pane in harness.state().panes() {
        let u = pane.simulation().unwrap().probe("p1").unwrap();
        let row = format!("p1: u = {}", engineering_pair([u.x, u.y].map(three_digits), "m"));
        assert!(harness.query_by_label(&row).is_some(), "{row}");
    }
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run();
    assert_eq!(*harness.state().scene(), before, "undone");
}

/// The panel has the colours and the magnification.
#[test]
fn the_panel_chooses_field_and_magnification() {
    let mut harness = harness("cantilever");
    harness.get_by_label_contains("View: ").scroll_to_me();
    harness.run();
    harness.get_by_label_contains("View: ").click();
    harness.run();
    pick(&mut harness, "Colour", Field::ShearStress.name());
    assert_eq!(harness.state().frame().field, Field::ShearStress);
    pick(&mut harness, "Displacement", "Factor");
    assert!(painted(&harness).contains(&"displacement × 10".to_owned()));
    pick(&mut harness, "Displacement", "True scale");
    assert!(!painted(&harness).iter().any(|text| text.contains("displacement ×")));
}

/// The base of a force, a support, a probe and a section moves along the body, each in one step of undo. All go
/// to any point, a force and a support also to a named edge or a corner. A press without a drag opens the card of the
/// point.
#[test]
fn bases_of_objects_are_dragged_along_the_body() {
    let mut scene = scene("cantilever");
    scene = scene.probe("p1", [4.0, 0.2]).section([6.0, 0.0], 0.0).support([2.0, -0.5], &[Axis::Y]);
    let mut harness = harness_of("cantilever", scene);
    harness.run();
    let before = harness.state().scene().clone();
    let seen = |harness: &Harness<'_, Lab>, at: [f64; 2]| on_body(harness.state(), at.into());
    // The middle of the right edge, where the arrow begins.
    let (foot, goal) = (seen(&harness, [9.999, 0.0]), seen(&harness, [6.9, 0.49]));
    drag(&mut harness, foot, goal, Modifiers::NONE);
    let Load::Force { place: Place::At(point), at_point: true, .. } = harness.state().scene().loads[0] else {
        panic!("at a point")
    };
    assert!((point[0] - 6.9).abs() < 0.05 && point[1] == 0.5, "it moves to the side: {point:?}");
    assert!(harness.query_by_label_contains("acts on the nearest node").is_none(), "the force acts at its point");
    let moved = harness.state().scene().clone();
    let (foot, goal) = (seen(&harness, point), seen(&harness, [9.999, 0.03]));
    drag(&mut harness, foot, goal, Modifiers::NONE);
    let Load::Force { place, at_point, .. } = &harness.state().scene().loads[0] else { panic!("a force") };
    assert_eq!(
        (place, at_point),
        (&Place::At([10.0, 0.0]), &false),
        "a force at a point is not distributed over an edge"
    );
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run();
    assert_eq!(*harness.state().scene(), moved, "one step of undo");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run();
    assert_eq!(*harness.state().scene(), before, "undone");
    let (from, to) = (seen(&harness, [4.0, 0.2]), seen(&harness, [5.1, -0.1]));
    drag(&mut harness, from, to, Modifiers::NONE);
    let Place::At(at) = harness.state().scene().probes.iter().find(|probe| probe.name == "p1").unwrap().place else {
        panic!("at a point")
    };
    assert!((Vector2::from(at) - Vector2::new(5.1, -0.1)).norm() < 0.05, "{at:?}");
    let (from, to) = (seen(&harness, [6.0, 0.0]), seen(&harness, [3.0, 0.1]));
    drag(&mut harness, from, to, Modifiers::NONE);
    let line = harness.state().scene().sections[0];
    assert!((line.at - Vector2::new(3.0, 0.1)).norm() < 0.05 && line.angle == 0.0, "{line:?}");
    let (from, to) = (seen(&harness, [2.0, -0.499]), seen(&harness, [7.33, 0.12]));
    drag(&mut harness, from, to, Modifiers::NONE);
    let held = harness.state().scene().supports.last().unwrap().clone();
    let Place::At(inside) = held.place else { panic!("at a point") };
    assert!(held.at_point && (Vector2::from(inside) - Vector2::new(7.33, 0.12)).norm() < 0.05, "{held:?}");
    let reaction = harness.state().simulation().support_reactions().last().unwrap().clone();
    assert!((reaction.middle.y - inside[1]).abs() < 1e-9 && reaction.force.y > 0.0, "{reaction:?}");
    assert!(harness.query_by_label_contains("acts on the nearest node").is_none(), "the support holds its point");
    // The corner at the lower right.
    let (from, to) = (seen(&harness, inside), seen(&harness, [9.99, -0.49]));
    drag(&mut harness, from, to, Modifiers::NONE);
    let held = harness.state().scene().supports.last().unwrap();
    assert_eq!((&held.place, held.at_point), (&Place::At([10.0, -0.5]), false));
    // On the middle of an edge it still holds a point, and does not become a support of the whole edge.
    let (from, to) = (seen(&harness, [9.999, -0.499]), seen(&harness, [9.999, 0.03]));
    drag(&mut harness, from, to, Modifiers::NONE);
    let held = harness.state().scene().supports.last().unwrap();
    assert_eq!((&held.place, &held.fix[..]), (&Place::At([10.0, 0.0]), &[Axis::Y][..]));
    let before = harness.state().scene().clone();
    let from = seen(&harness, [9.999, 0.0]);
    drag(&mut harness, from, from - egui::vec2(0.0, 200.0), Modifiers::NONE);
    assert_eq!(*harness.state().scene(), before, "dropped beside the body");
    let probe = seen(&harness, at);
    click(&mut harness, probe);
    assert!(harness.state().probed().is_some(), "a press without a drag inspects");
}

/// The coordinates of a load at a point are typed with units.
#[test]
fn coordinates_of_a_point_are_typed() {
    let mut harness = harness_of("cantilever", scene("cantilever").force([5.0, 0.5], [0.0, -10.0]));
    harness.run();
    unfold(&mut harness, "Force on");
    type_into(&mut harness, "x", "250 cm");
    let Load::Force { place, at_point, .. } = &harness.state().scene().loads[1] else { panic!("a force") };
    assert_eq!((place, *at_point), (&Place::At([2.5, 0.5]), false), "a node is there");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run();
    let Load::Force { place, .. } = &harness.state().scene().loads[1] else { panic!("a force") };
    assert_eq!(*place, Place::At([5.0, 0.5]), "undone");
    type_into(&mut harness, "y", "3 kg");
    assert!(harness.query_by_label_contains("expected").is_some(), "a refused text is silent");
}

/// The distance to the reference is that of a solution on a fine mesh of our own, has no value while the reference is not
/// known, and says so.
#[test]
fn the_distance_to_the_reference_colours_the_body() {
    let corner = [5.0, 0.5];
    let scene = scene("article").probe("corner", corner);
    let mut fine = scene.clone().with_cells(40, 8).with_element(ElementKind::T6).with_method(MethodKind::Newton);
    fine.solver.tolerance = 1e-10;
    let fine = solved(&fine).probe("corner").unwrap();
    let mut lab = lab_of("article", scene.clone());
    lab.solve();
    let mut harness = window([1280.0, 800.0], lab);
    harness.state_mut().color_with(Field::ReferenceDistance);
    harness.run();
    let name = Field::ReferenceDistance.name();
    let own = harness.state().simulation().probe("corner").unwrap();
    let largest = harness.state().frame().range[1];
    assert!(largest >= 0.99 * (own - fine).norm(), "{largest} m");
    let pos = on_body(harness.state(), Vector2::from(corner) - Vector2::new(1e-3, 1e-3));
    harness.hover_at(pos);
    harness.run();
    let shown = painted(&harness);
    let value = shown.iter().find_map(|text| text.strip_prefix(&format!("{name}: "))).unwrap();
    let seen: f64 = value.split(' ').next().unwrap().parse().unwrap();
    let wanted = (own - fine).norm();
    assert!((seen - wanted).abs() < 0.01 * wanted, "{value} instead of {wanted} m");
    // Without a probe there is no reference.
    let mut unknown = scene;
    unknown.probes.clear();
    let mut harness = harness_of("article", unknown);
    harness.state_mut().color_with(Field::ReferenceDistance);
    harness.run();
    let title = format!("{name}, m, not known");
    assert!(painted(&harness).iter().any(|text| text.starts_with(&title)), "{:?}", painted(&harness));
}
