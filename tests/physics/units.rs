//! Tests of numbers with units, in every place that accepts numbers.

use crate::common::*;
use warpbeam::scene::units::parse;

#[test]
fn units_are_read_to_the_last_digit() {
    for (unit, rows) in [
        ("Pa", &[("210 GPa", 2.1e11), ("210GPa", 2.1e11), ("1 N/mm²", 1e6), ("1 N/mm^2", 1e6)][..]),
        ("N", &[("12 kN", 12e3), ("-12 kN", -12e3), ("1e3", 1e3), (" 1 kN ", 1e3)]),
        ("m", &[("3 mm", 0.003), ("0.1 mm", 0.0001), ("5 µm", 5e-6), ("5 μm", 5e-6), ("5 um", 5e-6), ("1 in", 0.0254)]),
        ("kg/m³", &[("7.8 g/cm³", 7800.0), ("7.8 g/cm^3", 7800.0), ("7.8 g/cm3", 7800.0), ("7.85e-9 t/mm³", 7850.0)]),
        ("s", &[("16 ms", 0.016)]),
        ("1/s", &[("2 1/s", 2.0), ("2 s^-1", 2.0), ("2 s⁻¹", 2.0)]),
        ("m/s²", &[("9.81 m/s²", 9.81), ("9.81 m/s/s", 9.81), ("981 cm/s^2", 9.81)]),
        ("N m", &[("30 N m", 30.0), ("30 N·m", 30.0), ("30 kNm", 3e4), ("30 J", 30.0)]),
        ("rad", &[("180°", PI)]),
        ("°", &[("90 deg", 90.0), ("45 °", 45.0), ("45°", 45.0), ("1 rad", 180.0 / PI)]),
        ("rad/s", &[("360 °/s", 2.0 * PI)]),
        ("%", &[("1.5 %", 1.5)]),
        ("", &[("30 %", 0.3), ("0.3", 0.3)]),
    ] {
        for (text, value) in rows {
            let read = parse(text, unit).unwrap();
            assert!((read - value).abs() <= 2.0 * f64::EPSILON * value.abs(), "{text} is {read} {unit}");
        }
    }
    // Powers of ten are rounded once.
    for (text, unit, value) in [("3 mm", "m", 3e-3), ("0.7 mm", "m", 7e-4), ("7.8 g/cm³", "kg/m³", 7.8e3)] {
        assert_eq!(parse(text, unit), Ok(value));
    }
}

#[test]
fn wrong_units_are_refused_with_the_expected_ones() {
    for (text, unit, message) in [
        ("12 kN", "Pa", "`12 kN` is a force (N); expected a pressure (Pa)"),
        ("3 mm", "N", "`3 mm` is a length (m); expected a force (N)"),
        ("2 1/s", "rad/s", "`2 1/s` is a rate (1/s); expected an angular velocity (rad/s)"),
        ("2 Pa s", "s", "`2 Pa s` is a quantity in m^-1 kg s^-1; expected a time (s)"),
        ("1 N", "", "`1 N` is a force (N); expected a pure number"),
        ("12 kn", "N", "`12 kn` has the unknown unit `kn`; expected a force (N)"),
        ("12 kkN", "N", "unknown unit `kkN`"),
        ("1 m/", "m", "unknown unit"),
        ("1 /", "m", "unknown unit"),
        ("1 m^99", "m", "unknown unit"),
        ("1 m^0", "m", "unknown unit"),
        ("two", "N", "`two` is not a number; expected a force (N)"),
        ("", "m", "is not a number"),
        ("kN", "N", "is not a number"),
    ] {
        let error = parse(text, unit).unwrap_err().to_string();
        assert!(error.contains(message), "{text}: {error}");
    }
}

const WITH_UNITS: &str = include_str!("../data/files/units.toml");
const PLAIN: &str = include_str!("../data/files/units-plain.toml");

/// A scene with units equals the same scene without units, and is written without units.
#[test]
fn scene_files_take_units() {
    let scene = Scene::from_toml(WITH_UNITS).unwrap();
    assert_eq!(scene, Scene::from_toml(PLAIN).unwrap());
    assert_eq!(Scene::from_toml(&scene.to_toml().unwrap()).unwrap(), scene);
    assert!(scene.to_toml().unwrap().contains("young = 210000000000.0"));
    // Errors of numbers with units name the line of the file.
    for (old, new, line) in [
        ("poisson = \"30 %\"", "poisson = 0.9", 7),
        ("spin = \"180 °/s\"", "spon = 1.0", 39),
        ("\"-12 kN\"", "\"-12 kg\"", 20),
        ("[0, \"-981 cm/s²\"]", "[0, \"-981 cm/s\"]", 26),
        ("damping.mass = \"2 1/s\"", "damping.mass = \"2 s\"", 34),
    ] {
        assert!(WITH_UNITS.contains(old));
        let error = Scene::from_toml(&WITH_UNITS.replacen(old, new, 1)).unwrap_err().to_string();
        assert!(error.starts_with(&format!("line {line}: ")), "{new}: {error}");
    }
}

#[test]
fn assignments_take_units_with_and_without_quotes() {
    let plain = scene_with("article", &["material.young=2.1e11", "load.0.force=[0,-12000]"]);
    for young in ["210 GPa", "\"210 GPa\"", "'210 GPa'", "2.1e11 Pa", "210000 N/mm²"] {
        for force in ["[\"0 N\", \"-12 kN\"]", "[0 N, -12 kN]", "[0, -12 kN]", "[0, \"-12 kN\"]"] {
            let set = [format!("material.young={young}"), format!("load.0.force={force}")];
            assert_eq!(scene_with("article", &[&set[0], &set[1]]), plain, "{set:?}");
        }
    }
    assert_eq!(scene_with("article", &["material.young=210 GPa", "load.0.force.0=0", "load.0.force.1=-12 kN"]), plain);
    let material = scene_with("article", &["material={ young = \"1 GPa\", poisson = 0.3 }"]).material;
    assert_eq!((material.young, material.poisson), (1e9, 0.3));
    // Text fields are not parsed as numbers.
    assert_eq!(scene_with("article", &["name=12 kN"]).name, "12 kN");
}

/// A scene of plain numbers is unchanged by the parser of units.
#[test]
fn plain_numbers_are_si() {
    // Some built-in scenes have units and are left out.
    let plain = registry::BUILT_IN.iter().filter_map(|b| Some((b, toml::from_str::<Scene>(b.toml).ok()?)));
    assert!(plain.clone().count() > 12);
    for (built_in, direct) in plain {
        let mut opened = scene(built_in.id);
        if let Some(mesh) = &mut opened.mesh {
            (mesh.text, mesh.element) = (None, direct.mesh.as_ref().unwrap().element);
        }
        assert_eq!(opened, direct, "{}", built_in.id);
    }
}

/// The error names both readings of a comma if there are two. Spaces separate groups, too.
#[test]
fn groups_of_three_digits_are_thousands_and_other_commas_are_refused() {
    let spaced = [("30 000", 3e4), ("30\u{a0}000 N", 3e4), ("1 200 kN", 1.2e6), ("12kN", 12e3), ("1.2e4", 1.2e4)];
    let grouped = [("1,000,000", 1e6), ("1,234.5 N", 1234.5), ("-1,234,567.5 N", -1_234_567.5), ("30 N", 30.0)];
    for (text, value) in spaced.into_iter().chain(grouped).chain([("\u{2212}2.5", -2.5)]) {
        assert_eq!(parse(text, "N"), Ok(value), "{text}");
    }
    for (text, readings) in [
        ("1,000 kN", "write 1000 kN or 1.000 kN"),
        ("30,000", "write 30000 or 30.000"),
        ("-1,234", "write -1234 or -1.234"),
        ("1,000e3", "write 1000e3 or 1.000e3"),
    ] {
        assert_eq!(parse(text, "N").unwrap_err().to_string(), format!("`{text}` can be read in two ways: {readings}"));
    }
    let texts = "0,5|-0,5|1,5 kN|30,00|30 00|1,234 567|30.000,5|0,500|1,,000|,5|1234,567|1.000.000|1.000.000 N|1..5";
    for text in texts.split('|') {
        let refused = parse(text, "N").unwrap_err().to_string();
        let words = "is not a number: numbers look like 1500000, 1 500 000 and 1.5e6";
        assert!(refused.contains(words), "{text}: {refused}");
    }
}
