//! Tests of `warpbeam section`.

use std::fs;

use crate::common::*;

/// Returns the JSON object of `section --json`.
fn sections(args: &[&str]) -> serde_json::Value {
    json_in(".".as_ref(), &[&["section", "--json"], args].concat())
}

/// In text, JSON and files, along the beam and in one cut.
#[test]
fn forces_of_a_cantilever_are_those_of_statics() {
    // A force of 1 kN down at the end of 10 m: M = -(10 m - x) kN m but for the bending.
    let small = ["cantilever", "--set", "load.0.force=[0, \"-1 mN\"]"];
    let json = sections(&[&small[..], &["--along", "5"]].concat());
    let all = json["sections"].as_array().unwrap();
    assert_eq!(all.len(), 5);
    for (i, section) in all.iter().enumerate() {
        let x = 2.5 * i as f64;
        assert!((section["at"][0].as_f64().unwrap() - x).abs() < 1e-12);
        assert!((section["shear_force"].as_f64().unwrap() + 1e-3).abs() < 1e-9, "{section}");
        assert!((section["moment"].as_f64().unwrap() + 1e-3 * (10.0 - x)).abs() < 1e-8, "{section}");
    }
    let one = &sections(&[&small[..], &["--at", "2500 mm"]].concat())["sections"][0];
    assert_eq!(one["moment"], all[1]["moment"]);
    let back = &sections(&[&small[..], &["--at", "2.5,0.1", "--angle", "180deg"]].concat())["sections"][0];
    let sum = one["moment"].as_f64().unwrap() + back["moment"].as_f64().unwrap();
    assert!(sum.abs() < 1e-11, "{sum}");
    assert_eq!(back["angle"].as_f64(), Some(PI));
    let text = stdout(&warpbeam(&[&["section"], &small[..], &["--at", "2.5"]].concat()));
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("shear force V -1 mN") && words.contains("bending moment M -7.5 mN m"), "{text}");
    let text = stdout(&warpbeam(&[&["section"], &small[..], &["--along", "3"]].concat()));
    assert!(text.contains("largest M: -10 mN m, at x = 0 m"), "{text}");
    // The first of several equal values, which the table has too.
    assert!(text.contains("largest V: -1 mN, at x = 0 m"), "{text}");
}

/// The largest value of a diagram is beside the load where it jumps, however few sections are printed.
#[test]
fn the_largest_value_is_beside_a_jump() {
    let middle = "tests/data/scenes/loaded-in-the-middle.toml";
    for count in ["2", "3", "12"] {
        let output = warpbeam(&["section", middle, "--along", count]);
        let text = stdout(&output);
        assert!(text.contains("largest N: 1 mN, at x = "), "{text} {}", stderr(&output));
        let rows = text.lines().skip(2).take_while(|line| !line.is_empty()).count();
        assert_eq!(rows, count.parse::<usize>().unwrap(), "{text}");
    }
    // Between a force that pulls to the left and the one beyond it, N is larger than in any of the sections asked for.
    let two = "load=[{kind=\"force\",at=[5,0.5],force=[1e-3,0]},{kind=\"force\",at=[5.5,0.5],force=[-3e-3,0]}]";
    let text = stdout(&warpbeam(&["section", middle, "--along", "2", "--set", two]));
    assert!(text.contains("largest N: -3 mN, at x = 5"), "{text}");
}

#[test]
fn tables_and_pictures_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let run = |args: &[&str]| {
        succeeds_in(folder.path(), &[&["section", "snap"], args].concat());
    };
    run(&["--at", "0.1", "--out", "cut.csv", "--picture", "cut.svg"]);
    run(&["--along", "21", "--out", "along.csv", "--picture", "along.svg"]);
    // The back of the ring, at a negative coordinate: the hand calculation of the guide has 68.7 N mm at the support's side.
    let clip = &sections(&["clip", "--at", "-6 mm,0 mm", "--angle", "90deg"])["sections"][0];
    assert!((clip["moment"].as_f64().unwrap().abs() - 0.0687).abs() < 0.002, "{clip}");
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    assert!(read("cut.csv").starts_with("rest_x,rest_y,along,normal_stress,"));
    assert!(read("cut.svg").contains("normal stress, beam theory"));
    let along = read("along.csv");
    assert_eq!(along.lines().count(), 22);
    let columns = along.lines().next().unwrap().split(',').count();
    for line in along.lines().skip(1) {
        assert!(line.split(',').count() == columns && line.split(',').all(|v| v.parse::<f64>().unwrap().is_finite()));
    }
    let picture = read("along.svg");
    let size = |name: &str| picture.split(&format!(" {name}=\"")).nth(1)?.split('"').next()?.parse::<f64>().ok();
    assert!(size("height") > size("width"), "three figures, one below the other: {:?}", size("height"));
}

/// In linear theory too the ends of a cut have moved; a number is an angle in radians.
#[test]
fn a_cut_in_linear_theory_has_moved_with_the_body() {
    let scene = "tests/data/scenes/moved-edge.toml";
    let text = stdout(&warpbeam(&["section", scene, "--at", "5"]));
    assert!(text.starts_with("moment of a moved support") && text.contains("now from (4.995, "), "{text}");
    let turned = |angle: &str| sections(&[scene, "--at", "5", "--angle", angle])["sections"][0]["angle"].clone();
    assert_eq!(turned("30").as_f64(), Some(30.0));
}

/// `solve` prints the values of `section`.
#[test]
fn sections_of_a_scene_are_printed_with_its_results() {
    let lines = "section=[{at=[\"400 cm\", 0.0]}, {at=[7.0, 0.1], angle=\"20°\"}]";
    let of = |command: &str, more: &[&str]| warpbeam(&[&[command, "cantilever", "--set", lines], more].concat());
    let values = |command: &str| parsed(&of(command, &["--json"]))["sections"].clone();
    let each = [&["--at", "4,0"][..], &["--at", "7,0.1", "--angle", "20deg"]]
        .map(|args| sections(&[&["cantilever"], args].concat())["sections"][0].clone());
    assert_eq!(values("solve").as_array().unwrap()[..], each);
    assert_eq!(values("section").as_array().unwrap()[..], each);
    let force = each[0]["force"][1].as_f64().unwrap();
    assert!((force + 1500.0).abs() < 1e-4, "{force}");
    let text = stdout(&of("solve", &[]));
    let line = text.lines().find(|line| line.starts_with("section at (7, 0.1) m, normal at 20°: N ")).unwrap();
    assert!(line.contains(", V ") && line.contains(", M "), "{line}");
    let text = stdout(&of("section", &[]));
    assert_eq!(text.matches("of the recovered stress").count(), 6, "{text}");
    // A cut of its own does not depend on the sections of the scene.
    succeeds(&["section", "cantilever", "--at", "4", "--set", "section=[{at=[11.0, 0.0]}]"]);
}
