//! Tests of edits of scene files: the text describes the edited scene, and what was not edited stays as it was written.

use crate::common::*;
use warpbeam::scene::edited;

const COMMENTED: &str = include_str!("../data/files/commented.toml");

/// Dotted keys, quoted keys, several lines, scattered lists, and comments at every place.
const NOTATIONS: &str = include_str!("../data/files/notations.toml");
const INLINE: &str = include_str!("../data/files/inline.toml");

/// Returns the text after an edit of its scene.
fn after(text: &str, edit: impl Fn(&mut Scene)) -> String {
    let mut scene = Scene::from_toml(text).unwrap();
    edit(&mut scene);
    let edited = edited(text, &scene).unwrap();
    assert_eq!(Scene::from_toml(&edited).unwrap(), scene, "{edited}");
    edited
}

/// Asserts that an edit of the scene replaces parts of its text, and nothing else.
fn check(text: &str, edit: impl Fn(&mut Scene), parts: &[(&str, &str)]) {
    let mut expected = text.to_owned();
    for (old, new) in parts {
        assert_eq!(expected.matches(old).count(), 1, "{old}");
        expected = expected.replace(old, new);
    }
    assert_eq!(after(text, edit), expected);
}

#[test]
fn only_what_was_edited_changes() {
    check(COMMENTED, |scene| scene.material.young = 2.5e6, &[("1 N/mm²", "2.5 N/mm²")]);
    check(COMMENTED, |scene| scene.loads[0] = Load::force("right", [0.0, -1234.5]), &[("-1 kN", "-1.2345 kN")]);
    let warped = ("\"-1 kN\"]\n", "\"-1 kN\"]\n\n[solver]\nmethod = \"warped\"\n");
    check(COMMENTED, |scene| scene.solver.method = MethodKind::Warped, &[warped]);
    check(NOTATIONS, |scene| scene.solver.tolerance = 1e-9, &[("1e-10", "1e-9")]);
    check(NOTATIONS, |scene| scene.supports[0].displacement = [0.5, 0.0], &[("[0.0, 0.0] #", "[0.5, 0.0] #")]);
    check(NOTATIONS, |scene| scene.material.young = 7e10, &[("210 GPa", "70 GPa")]);
    check(NOTATIONS, |scene| scene.beam.as_mut().unwrap().cells[1] = 5, &[("4, # across", "5, # across")]);
    check(NOTATIONS, |scene| scene.beam.as_mut().unwrap().rise = 2.0, &[("rise = 0.0", "rise = 2.0")]);
    let crane =
        "[[load]] # the first\nkind = \"force\"\nat = [5.0, 0.5]\nforce = [\"1 kN\", \"-30 000 N\"] # of the crane\n";
    check(NOTATIONS, |scene| _ = scene.loads.remove(0), &[(crane, "")]);
    let moment = "\n[[load]]\nkind = \"moment\"\nedge = \"right\"\nmoment = 3.0\n# before the second";
    check(NOTATIONS, |scene| scene.loads.insert(1, Load::moment("right", 3.0)), &[("# before the second", moment)]);
    check(INLINE, |scene| scene.loads[1] = Load::moment("right", 0.5), &[("1 N m", "0.5 N m")]);
    let force = "[\n  { kind = \"force\", edge = \"right\", force = [0, \"-1 N\"] }, # down";
    check(INLINE, |scene| _ = scene.loads.remove(0), &[(force, "[ # down")]);
    check(INLINE, |scene| scene.dynamics.damping.mass = 0.2, &[("mass = 0.1", "mass = 0.2")]);
    check(INLINE, |scene| scene.beam.as_mut().unwrap().element = ElementKind::T6, &[("\"q4\"", "\"t6\"")]);
    // A number keeps its unit if it is exact in it.
    for value in [3.3e6, 1e6 / 3.0, 0.1 + 0.2, f64::from_bits(0x4130_1234_5678_9abc), 1e-3] {
        let text = after(COMMENTED, |scene| scene.material.young = value.max(1.0));
        assert!(text.contains("# as measured at 20 °C"), "{text}");
    }
    // Windows ends lines by two characters, and begins some texts with a mark.
    let text = format!("\u{feff}{COMMENTED}").replace('\n', "\r\n");
    assert_eq!(edited(&text, &Scene::from_toml(&text).unwrap()).unwrap(), text);
    let new = after(&text, |scene| *scene = scene.clone().probe("tip", "right"));
    assert_eq!(new.matches('\n').count(), new.matches("\r\n").count());
    assert!(new.starts_with(text.trim_end()), "{new}");
}

/// Makes a change that a scene may have.
fn change(scene: &mut Scene, random: &mut Random) {
    let pair = [random.between(-2.0, 2.0), random.between(-1.0, 1.0)];
    let rounded = pair.map(|value| (1e3 * value).round() / 1e3);
    let place = |random: &mut Random, list: usize| random.below(list + 1);
    match random.below(16) {
        0 => scene.material.young *= random.one_of(&[0.5, 3.0, 1.0 + 1e-15]),
        1 => scene.material.plane = random.one_of(&[Plane::Stress, Plane::Strain]),
        2 => scene.solver.method = random.one_of(&[MethodKind::Linear, MethodKind::Warped, MethodKind::Newton]),
        3 => scene.loads.insert(place(random, scene.loads.len()), Load::gravity(rounded)),
        4 => scene.loads.insert(place(random, scene.loads.len()), Load::point_force(pair, rounded)),
        5 => scene.loads.insert(place(random, scene.loads.len()), Load::moment("right", pair[0])),
        6 if !scene.loads.is_empty() => _ = scene.loads.remove(random.below(scene.loads.len())),
        7 if !scene.supports.is_empty() => _ = scene.supports.remove(random.below(scene.supports.len())),
        8 => {
            let axes = random.one_of(&[&[Axis::X, Axis::Y][..], &[Axis::X], &[Axis::Y]]);
            scene.supports.insert(place(random, scene.supports.len()), Support::new(rounded, axes));
        }
        9 => scene.supports.iter_mut().for_each(|support| support.displacement = [0.0; 2]),
        10 => {
            let name = format!("it's \"{}\" # {}\n{}", random.below(1000), '\u{1}', 'é');
            let at = place(random, scene.probes.len());
            *scene = scene.clone().probe(&name, rounded);
            let probe = scene.probes.remove(scene.probes.len() - 1);
            scene.probes.insert(at, probe);
        }
        11 if !scene.probes.is_empty() => _ = scene.probes.remove(random.below(scene.probes.len())),
        12 => scene.sections.push(SectionLine { at: rounded.into(), angle: random.one_of(&[0.0, 0.5]) }),
        13 => _ = scene.sections.pop(),
        14 => {
            if let Some(beam) = &mut scene.beam {
                beam.rise = random.one_of(&[0.0, 0.25]);
                beam.diagonals = random.one_of(&[Diagonals::Same, Diagonals::Alternating]);
                beam.element = random.one_of(&[ElementKind::T3, ElementKind::T6, ElementKind::Q4]);
            }
        }
        _ => {
            if let Some(Load::Force { force, .. }) = scene.loads.first_mut() {
                *force = rounded.map(|value| 1e3 * value);
            }
            scene.dynamics.duration = random.one_of(&[10.0, 2.5]);
            scene.start.velocity = random.one_of(&[[0.0, 0.0], [1.0, 0.5]]);
            scene.dynamics.damping.mass = random.one_of(&[0.0, 0.25]);
        }
    }
}

/// Texts of built-in and random scenes are edited in every notation, with comments that a complete rewrite would lose.
#[test]
fn edited_texts_describe_the_edited_scenes() {
    let mut texts: Vec<String> = registry::BUILT_IN.iter().map(|scene| scene.toml.to_owned()).collect();
    texts.extend((0..20).map(|seed| random::scene(seed).to_toml().unwrap()));
    texts.extend([COMMENTED, NOTATIONS, INLINE].map(str::to_owned));
    texts.extend([include_str!("../data/files/dyn.toml"), include_str!("../data/files/two.toml")].map(str::to_owned));
    for seed in sampled(0..200, 20) {
        for (i, text) in texts.iter().enumerate() {
            let mut random = Random(1000 * seed + i as u64);
            let mut text = format!("# A comment that stays.\n{text}# Another.");
            let mut scene = Scene::from_toml(&text).unwrap();
            assert_eq!(edited(&text, &scene).unwrap(), text);
            for _ in 0..6 {
                let mut other = scene.clone();
                change(&mut other, &mut random);
                if other.validate().is_err() {
                    continue;
                }
                let new = edited(&text, &other).unwrap();
                assert_eq!(Scene::from_toml(&new).unwrap(), other, "{text}\n---\n{new}");
                let is_kept = new.starts_with("# A comment that stays.\n") && new.trim_end().ends_with("# Another.");
                assert!(is_kept, "{text}\n---\n{new}");
                (scene, text) = (other, new);
            }
        }
    }
}
