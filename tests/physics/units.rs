//! Tests of numbers with units, in every place that accepts numbers.

use crate::common::*;
use warpbeam::scene::limits::BUDGET_MS;
use warpbeam::scene::units::{parse, within};

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
        ("%", &[("1.5 %", 1.5), ("1%", 1.0), ("2", 2.0)]),
        ("ms", &[("0.5ms", 0.5), ("200us", 0.2), ("200 µs", 0.2), ("2s", 2e3), ("16", 16.0)]),
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
fn errors_and_times_that_cannot_be_used_are_refused() {
    for limit in [warpbeam::scene::keys::range("solver.max_error_percent"), BUDGET_MS] {
        for text in ["", "fast", "-1", "nan", "1 kg", "ms"] {
            assert!(within(limit)(text).is_err(), "{text}");
        }
    }
}

const WITH_UNITS: &str = include_str!("../data/files/units.toml");

/// A scene with units equals the same scene without units, and is written without units.
#[test]
fn scene_files_take_units() {
    let scene = Scene::from_toml(WITH_UNITS).unwrap();
    assert_eq!(scene, Scene::from_toml(include_str!("../data/files/units-plain.toml")).unwrap());
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

/// Spaces separate groups, too. Other commas are refused, as `tests/golden/texts.txt` shows.
#[test]
fn groups_of_three_digits_are_thousands() {
    let spaced = [("30 000", 3e4), ("30\u{a0}000 N", 3e4), ("1 200 kN", 1.2e6), ("12kN", 12e3), ("1.2e4", 1.2e4)];
    let grouped = [("1,000,000", 1e6), ("1,234.5 N", 1234.5), ("-1,234,567.5 N", -1_234_567.5), ("30 N", 30.0)];
    for (text, value) in spaced.into_iter().chain(grouped).chain([("\u{2212}2.5", -2.5)]) {
        assert_eq!(parse(text, "N"), Ok(value), "{text}");
    }
}
