//! Tests of the window in Chinese: the catalogue has every text, the fonts have every letter, and nothing is clipped.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use crate::common::lab::{settle, wait};
use crate::common::scene;
use egui::accesskit::Role;
use egui::{FontId, Key, Modifiers, Rect};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use warpbeam::app::{Lab, Language, Settings, parse_panes};
use warpbeam::element::ELEMENTS;
use warpbeam::method::METHODS;
use warpbeam::scene::{Source, registry};
use warpbeam::study::{Extent, Study};
use warpbeam::{Field, IntegratorKind, Scene, Simulation};

/// Returns the Chinese texts by their English ones.
fn catalogue() -> BTreeMap<String, String> {
    toml::from_str(include_str!("../../assets/locales/zh-CN.toml")).unwrap()
}

/// Returns the Chinese text for an English one.
fn zh(english: &str) -> String {
    catalogue().get(english).cloned().unwrap_or_else(|| unreachable!("{english:?} is not in the catalogue"))
}

/// Returns a window in Chinese; `size` in points.
fn harness_of(id: &str, size: [f32; 2]) -> Harness<'static, Lab> {
    let scene = scene(id);
    let simulation = Simulation::new(&scene).unwrap();
    let mut lab = Lab::new(Source { name: id.into(), assignments: Vec::new() }, scene, simulation);
    lab.set_language(Language::Chinese);
    Harness::builder().with_size(size).with_max_steps(600).with_step_dt(0.05).build_ui_state(
        |ui, lab: &mut Lab| {
            lab.advance(ui.input(|i| i.time));
            lab.ui(ui);
        },
        lab,
    )
}

/// Returns a window in Chinese whose body is at rest and whose background solves have ended.
fn settled(id: &str, size: [f32; 2]) -> Harness<'static, Lab> {
    let mut harness = harness_of(id, size);
    harness.run();
    settle(&mut harness);
    harness
}

/// Returns every painted text, and every name and value that is given to screen readers.
fn shown(harness: &Harness<'_, Lab>) -> BTreeSet<String> {
    fn painted(shape: &egui::Shape, texts: &mut BTreeSet<String>) {
        match shape {
            egui::Shape::Text(text) => _ = texts.insert(text.galley.text().to_owned()),
            egui::Shape::Vec(shapes) => shapes.iter().for_each(|shape| painted(shape, texts)),
            _ => {}
        }
    }
    let mut texts = BTreeSet::new();
    harness.output().shapes.iter().for_each(|clipped| painted(&clipped.shape, &mut texts));
    let nodes = harness.get_all_by(|_| true).map(|node| node.accesskit_node());
    texts.extend(nodes.flat_map(|node| [node.label(), node.value()]).flatten());
    texts
}

/// Words that are the same in every language: units, formats, keys, and names of programs.
const SAME: &[&str] = &[
    "rad",
    "RTR",
    "RkT",
    "fint",
    "Delete",
    "GIF",
    "PNG",
    "TOML",
    "Gmsh",
    "Rust",
    "Shift",
    "Ctrl",
    "Space",
    "Enter",
    "Esc",
    "Escape",
    "Comma",
    "Period",
    "BDF",
    "bdf",
    "det",
    "max",
    "int",
    "warpbeam",
    "faer",
    "sym",
    // Names in the titles and authors of the article and of the paper that it explains.
    "Warped",
    "Stiffness",
    "Matthias",
    "ller",
    "Markus",
    "Gross",
    "Interactive",
    "Virtual",
    "Materials",
    "Graphics",
    "Interface",
];

/// Returns the words of three or more Latin letters that should have been translated: without scene ids, and without
/// text between backticks, which is typed literally.
fn english(text: &str) -> Vec<String> {
    let ids = || registry::BUILT_IN.iter().map(|built_in| built_in.id);
    if ids().any(|id| id == text) {
        return Vec::new();
    }
    // In the gallery, a scene's id ends the line.
    let text = ids().fold(text.to_owned(), |text, id| text.replace(&format!("{id}\n"), "\n"));
    let plain: String = text.split('`').step_by(2).collect::<Vec<_>>().join(" ");
    let words = plain.split(|c: char| !c.is_ascii_alphabetic()).filter(|word| word.len() >= 3);
    let is_unit = |word: &str| word.len() == 3 && ["Pa", "Hz"].iter().any(|unit| word.ends_with(unit));
    words.filter(|word| !SAME.contains(word) && !is_unit(word)).map(str::to_owned).collect()
}

fn assert_chinese(harness: &Harness<'_, Lab>, what: &str) {
    // egui names the close button of its windows itself.
    for text in shown(harness).into_iter().filter(|text| text != "Close window") {
        assert_eq!(english(&text), [""; 0], "{what}: {text:?}");
    }
}

/// Points at every control, and checks the text of its tooltip.
fn assert_tips_are_chinese(harness: &mut Harness<'_, Lab>, what: &str) {
    harness.ctx.all_styles_mut(|style| {
        style.interaction.tooltip_delay = 0.0;
        style.interaction.show_tooltips_only_when_still = false;
    });
    let window = harness.ctx.content_rect();
    let places: Vec<_> =
        harness.get_all_by(|node| node.bounding_box().is_some()).map(|node| node.rect().center()).collect();
    let mut seen = BTreeSet::new();
    for place in places.into_iter().filter(|place| window.contains(*place)) {
        if seen.insert([place.x as i32, place.y as i32]) {
            harness.hover_at(place);
            harness.run_steps(2);
            assert_chinese(harness, &format!("{what}, the tip at {place:?}"));
        }
    }
    harness.remove_cursor();
    harness.run_steps(2);
}

/// Presses the control with this text, or with one that begins with it.
fn press(harness: &mut Harness<'_, Lab>, english: &str) {
    let text = zh(english);
    let mut all = harness.query_all_by_label(&text).collect::<Vec<_>>();
    if all.is_empty() {
        all = harness.query_all_by_label_contains(&text).collect();
    }
    let is_pressable = |role: Role| [Role::Button, Role::DisclosureTriangle, Role::ComboBox].contains(&role);
    let node = all.iter().find(|node| is_pressable(node.accesskit_node().role())).or(all.first());
    node.unwrap_or_else(|| unreachable!("no {text}")).click();
    drop(all);
    harness.run_steps(6);
}

/// Returns the text literals of a source, without comments, tests, errors and ids.
fn literals(source: &str) -> Vec<String> {
    const OTHER: &[&str] = &["error(", "log::", "id_salt", "Id::unique", "include_", "serde(", "value(", ".name("];
    let code = source.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
    let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
    let code = lines.collect::<Vec<_>>().join("\n").replace("'\"'", "");
    let mut literals = Vec::new();
    let mut at = 0;
    while let Some(begin) = code[at..].find('"').map(|i| at + i + 1) {
        let mut end = begin;
        while !code[end..].starts_with('"') {
            let escaped = code[end..].starts_with('\\');
            end += code[end..].chars().take(if escaped { 2 } else { 1 }).map(char::len_utf8).sum::<usize>();
        }
        let before = code[..begin].rsplit('\n').next().unwrap_or_default();
        if !OTHER.iter().any(|other| before.contains(other)) {
            literals.push(unescaped(&code[begin..end]));
        }
        at = end + 1;
    }
    literals
}

/// Returns the text of a literal with its escape sequences resolved.
fn unescaped(literal: &str) -> String {
    let mut text = String::new();
    let mut rest = literal;
    while let Some(c) = rest.chars().next() {
        rest = &rest[c.len_utf8()..];
        if c != '\\' {
            text.push(c);
            continue;
        }
        match rest.chars().next() {
            Some('\n') => rest = rest.trim_start(),
            Some('u') => {
                let (code, behind) = rest[2..].split_once('}').unwrap();
                text.push(char::from_u32(u32::from_str_radix(code, 16).unwrap()).unwrap());
                rest = behind;
            }
            Some(c) => {
                text.push(if c == 'n' { '\n' } else { c });
                rest = &rest[c.len_utf8()..];
            }
            None => {}
        }
    }
    text
}

/// Returns the sources of the window. Files of unit tests show no text.
fn sources(folder: &Path) -> impl Iterator<Item = PathBuf> {
    crate::common::files::rust_files(folder).into_iter().filter(|file| !file.ends_with("tests.rs"))
}

/// Literals of the window's sources that are not shown in it: copied texts, ids, variables, messages of programs without
/// a window; and those that are not translated: names of keys, and reasons added to messages of the system.
const NOT_SHOWN: &[&str] = &[
    "wasm32",
    "Cmd+",
    "the browser is set to keep nothing",
    ".toml,.msh",
    "scene=",
    "(prefers-reduced-motion: reduce)",
    "no document",
    "# Save as scene.toml, then: warpbeam solve scene.toml\n{toml}",
    "English",
    "Noto Sans SC",
    "probe values",
    "probe matrices",
    "at right",
    "status line",
    "σ_x, σ_y",
    "τ_xy",
    "σ_1, σ_2",
    "ε_x, ε_y",
    "γ_xy",
    "σ_X, σ_Y",
    "τ_XY",
    "ε_X, ε_Y",
    "γ_XY",
    "σ_z",
    "ε_1, ε_2",
    "load curve",
    "WAYLAND_DISPLAY",
    "WAYLAND_SOCKET",
    "DISPLAY",
    "the scene to begin with is missing",
    "{} has {PLACES} copies of unsaved scenes",
    "the display did not answer in time",
    "the surface stays out of date",
    "the surface was lost: {e}",
    "the surface was lost",
    "the surface is not valid",
    "expected a method ({}), an element ({}), cells as in 10x2 or a number of iterations, got \u{201c}{part}\u{201d}",
    "{}: expected a file name ending in .gif, or the name of a folder for numbered pictures, which ffmpeg makes a \
     film of",
];

/// Every text in the window's sources is in the catalogue, or listed as not shown. A single word in lower case may be
/// an id: if it is shown, the tests that read the window find it.
#[test]
fn every_text_of_the_sources_is_in_the_catalogue() {
    let known = catalogue();
    let (mut found, mut missing) = (BTreeSet::new(), Vec::new());
    for path in sources("src/app".as_ref()) {
        for literal in literals(&std::fs::read_to_string(&path).unwrap()) {
            let mut rest = literal.as_str();
            let mut words = String::new();
            // Removes the placeholders of format strings.
            while let Some((before, behind)) = rest.split_once('{') {
                words.push_str(before);
                rest = behind.split_once('}').map_or("", |(_, rest)| rest);
            }
            words.push_str(rest);
            let is_id = words.chars().all(|c| c.is_ascii_lowercase() || "-_./".contains(c));
            let is_counted = known.contains_key(&format!("%{{n}} {literal}"));
            let needs = !is_id && !is_counted && !english(&words).is_empty();
            found.insert(literal.clone());
            let is_known = known.contains_key(&literal) || known.contains_key(&literal.replace('{', "%{"));
            if needs && !is_known && !NOT_SHOWN.contains(&literal.as_str()) {
                missing.push(format!("{}: {literal:?}", path.display()));
            }
        }
    }
    assert!(missing.is_empty(), "not in assets/locales: {missing:#?}");
    assert!(found.contains("Linear theory makes the area grow") && found.contains("Cancel"), "the scan is blind");
    for not_shown in NOT_SHOWN {
        assert!(found.contains(*not_shown), "{not_shown:?} is no longer in the sources");
    }
}

/// Every sentence of the library is in the catalogue, and has a part for every placeholder.
#[test]
fn every_sentence_of_the_library_is_in_the_catalogue() {
    let (known, mut found) = (catalogue(), BTreeSet::new());
    for path in crate::common::files::rust_files("src".as_ref()) {
        let source = std::fs::read_to_string(&path).unwrap();
        let calls = source.split("sentence!(").skip(1).filter(|call| call.trim_start().starts_with('"'));
        for call in calls {
            let pattern = literals(call).swap_remove(0);
            for place in pattern.split("%{").skip(1) {
                let name = place.split_once('}').unwrap().0;
                let words = call.split(|c: char| !(c.is_alphanumeric() || c == '_'));
                assert!(words.filter(|word| *word == name).count() > 1, "{}: {pattern:?}: {name}", path.display());
            }
            assert!(known.contains_key(&pattern), "{}: {pattern:?} is not in assets/locales", path.display());
            found.insert(pattern);
        }
        for noun in source.split("Self::count(").skip(1).filter_map(|call| call.split('"').nth(1)) {
            let has = |pattern: String| known.contains_key(&pattern);
            assert!(has(format!("%{{n}} {noun}")) && has(format!("%{{n}} {noun}s")), "{}: {noun:?}", path.display());
        }
    }
    assert!(found.len() > 60 && found.contains("%{key}: %{message}"), "the scan is blind");
}

/// The names of the library are in the catalogue, too.
#[test]
fn every_named_entry_of_the_library_is_in_the_catalogue() {
    let known = catalogue();
    let mut texts: Vec<String> = Vec::new();
    texts.extend(METHODS.iter().flat_map(|entry| [entry.id, entry.about]).map(str::to_owned));
    texts.extend(
        IntegratorKind::all().map(IntegratorKind::entry).flat_map(|entry| [entry.id, entry.about]).map(str::to_owned),
    );
    texts.extend(ELEMENTS.iter().map(|entry| entry.about.to_owned()));
    texts.extend(Field::ALL.into_iter().map(|field| field.name().to_owned()));
    for built_in in registry::BUILT_IN {
        let scene = Scene::from_toml(built_in.toml).unwrap();
        texts.extend([scene.name.clone(), scene.about.clone()]);
        texts.extend(scene.probes.iter().map(|probe| probe.name.clone()));
        let simulation = Simulation::new(&crate::common::scene(built_in.id)).unwrap();
        texts.extend(simulation.system().edges().iter().map(|edge| edge.name().to_owned()));
    }
    for text in texts.iter().filter(|text| !english(text).is_empty()) {
        assert!(known.contains_key(text), "{text:?} is not in assets/locales");
    }
}

/// Translations have the placeholders of their English texts, and no English words.
#[test]
fn translations_have_the_placeholders_of_their_originals() {
    let places = |text: &str| -> BTreeSet<String> {
        text.split("%{").skip(1).map(|rest| rest.split_once('}').unwrap().0.to_owned()).collect()
    };
    for (text, translation) in catalogue() {
        assert_eq!(places(&text), places(&translation), "{text:?}");
        assert!(!translation.trim().is_empty(), "{text:?}");
        let words = translation.split("%{").map(|part| part.split_once('}').map_or(part, |(_, rest)| rest));
        let left = english(&words.collect::<Vec<_>>().join(" "));
        assert!(left.iter().all(|word| word == "beam"), "{translation:?} says {left:?}");
    }
}

#[test]
fn the_fonts_have_every_letter() {
    let mut harness = harness_of("article", [640.0, 480.0]);
    harness.run();
    let mut letters: BTreeSet<char> = catalogue().values().flat_map(|text| text.chars()).collect();
    letters.extend(Language::Chinese.name().chars());
    for size in [12.0, 14.0, 18.0] {
        for font in [FontId::proportional(size), FontId::monospace(size)] {
            for &letter in letters.iter().filter(|letter| **letter != '\n') {
                assert!(harness.ctx.fonts_mut(|fonts| fonts.has_glyph(&font, letter)), "no glyph for {letter:?}");
            }
        }
    }
    let rare = FontId::proportional(14.0);
    assert!(!harness.ctx.fonts_mut(|fonts| fonts.has_glyph(&rare, '\u{9f98}')), "the check is blind");
}

/// The button in the toolbar changes the language at once and is labelled in the other language. The
/// settings keep the language.
#[test]
fn the_switch_changes_the_language_and_the_settings_keep_it() {
    let mut harness = settled("article", [1280.0, 800.0]);
    assert_chinese(&harness, "Explore");
    press(&mut harness, "Language");
    assert!(harness.query_by_label("Language").is_some() && harness.query_by_label("Run").is_some());
    assert_eq!(harness.state().language(), Language::English);
    harness.get_by_label("Language").click();
    harness.run();
    assert!(harness.query_by_label(&zh("Run")).is_some());
    // The same on a card of Learn, and after it.
    press(&mut harness, "Learn");
    press(&mut harness, "Language");
    assert!(harness.query_by_label("Linear theory makes the area grow").is_some());
    harness.get_by_label("Leave").click();
    harness.run();
    assert!(harness.query_by_label("Run").is_some());
    harness.get_by_label("Language").click();
    harness.run();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("settings.toml");
    harness.state().settings(&harness.ctx).save(&Settings::default(), &file).unwrap();
    let (settings, _) = Settings::load(&file);
    assert_eq!(settings.language, Language::Chinese);
    let mut again = settled("article", [1280.0, 800.0]);
    again.state_mut().set_language(Language::English);
    let ctx = again.ctx.clone();
    again.state_mut().set_settings(&ctx, settings);
    again.run();
    assert!(again.query_by_label(&zh("Run")).is_some());
    assert_eq!(Settings::default().language, Language::English);
}

/// Explore is in Chinese: every fold, the pickers, the drawer, the card of a point, messages and
/// remedies, the help and the dialog.
#[test]
fn exploring_is_in_chinese() {
    let mut harness = settled("article", [1280.0, 2400.0]);
    assert!(harness.state().title().contains(&zh("The article's beam")));
    for fold in ["Gravity, moment", "Loads and supports", "Beam", "Material", "Mesh", "View", "File", "Details"] {
        press(&mut harness, fold);
        assert_chinese(&harness, fold);
    }
    press(&mut harness, "explain");
    press(&mut harness, "Fixed colour range");
    press(&mut harness, "Sections");
    settle(&mut harness);
    assert_tips_are_chinese(&mut harness, "Explore");
    for picker in ["Method", "Element", "Colour", "Force on", "Scene"] {
        harness.get_by_role_and_label(Role::ComboBox, &zh(picker)).click();
        harness.run_steps(6);
        assert_chinese(&harness, picker);
        harness.key_press(Key::Escape);
        harness.run_steps(6);
    }
    for (label, text) in
        [("Force", "?"), ("Force", "3 MPa"), ("Young E", "0"), ("Poisson ν", "0,4"), ("Cells along", "2.5")]
    {
        crate::common::lab::type_into(&mut harness, &zh(label), text);
        assert_chinese(&harness, &format!("{label}: {text}"));
    }
    harness.key_press(Key::F1);
    harness.run_steps(6);
    assert_chinese(&harness, "help");
    harness.key_press(Key::Escape);
    harness.key_press(Key::C);
    harness.run_steps(4);
    assert_chinese(&harness, "copied");
    harness.key_press_modifiers(Modifiers::SHIFT, Key::C);
    harness.run_steps(4);
    assert_chinese(&harness, "copied as a program");
}

/// Text about a scene's state, load path and supports is in Chinese.
#[test]
fn scenes_of_every_kind_are_in_chinese() {
    let size = [1280.0, 2000.0];
    let mut harness = settled("cantilever", size);
    crate::common::lab::type_into(&mut harness, &zh("Force"), "9000");
    assert_chinese(&harness, "diverged");
    for id in ["jump", "bracket", "cook", "snap"] {
        let mut harness = settled(id, size);
        press(&mut harness, "Details");
        press(&mut harness, "Limits");
        press(&mut harness, "Load curve");
        settle(&mut harness);
        press(&mut harness, "explain");
        assert_tips_are_chinese(&mut harness, id);
    }
}

/// The window of a motion is in Chinese: its time, its plots, and the other integrators.
#[test]
fn motions_are_in_chinese() {
    let mut harness = harness_of("swing", [1280.0, 2000.0]);
    harness.run_steps(20);
    press(&mut harness, "Details");
    press(&mut harness, "Energy and tip");
    press(&mut harness, "energy-momentum");
    harness.run_steps(100);
    press(&mut harness, "Pause");
    settle(&mut harness);
    for plot in ["Energy", "Tip"] {
        press(&mut harness, plot);
        assert_chinese(&harness, plot);
    }
    assert_tips_are_chinese(&mut harness, "swing");
}

#[test]
fn comparing_is_in_chinese() {
    let mut harness = settled("article", [1280.0, 800.0]);
    harness.state_mut().show_comparison(&parse_panes("linear,warped,newton:t6:10x2,auto").unwrap());
    harness.run();
    wait(&mut harness, "the panes", |lab| lab.panes().iter().all(|pane| pane.end().is_some()));
    assert_tips_are_chinese(&mut harness, "Compare");
    for what in ["method", "element", "mesh"] {
        let picker = format!("{} {}", zh("Pane %{n}").replace("%{n}", "1"), zh(what));
        harness.get_by_role_and_label(Role::ComboBox, &picker).click();
        harness.run_steps(6);
        assert_chinese(&harness, what);
        harness.key_press(Key::Escape);
        harness.run_steps(6);
    }
}

#[test]
fn the_budget_is_in_chinese() {
    let mut harness = settled("article", [1280.0, 800.0]);
    harness.key_press(Key::B);
    harness.run();
    assert_chinese(&harness, "before");
    let study = Study::new(&scene("article"), Extent::Quick, &|_| ControlFlow::Continue(())).unwrap();
    harness.state_mut().show_study(study);
    harness.run();
    assert_tips_are_chinese(&mut harness, "Budget");
}

#[test]
fn the_limits_are_in_chinese() {
    let mut harness = settled("article", [1280.0, 800.0]);
    harness.key_press(Key::M);
    harness.run_steps(3);
    settle(&mut harness);
    assert_tips_are_chinese(&mut harness, "Limits");
}

#[test]
fn every_card_is_in_chinese() {
    let mut harness = settled("article", [1280.0, 800.0]);
    for card in 1..=warpbeam::app::card_count() {
        harness.state_mut().show_card(card);
        harness.run();
        settle(&mut harness);
        assert_tips_are_chinese(&mut harness, &format!("card {card}"));
    }
}

/// In a window of any size, every control is inside and wide enough for its text.
#[test]
fn nothing_is_clipped_in_windows_of_any_size() {
    for size in [[640.0, 480.0], [800.0, 600.0], [1280.0, 800.0]] {
        let window = Rect::from_min_size(egui::Pos2::ZERO, size.into());
        let mut harness = settled("article", size);
        let names = [
            "Run", "Step", "Reset", "Explore", "Learn", "Compare", "Budget", "Limits", "Help", "Theme", "Language",
            "Panel",
        ];
        for name in names.into_iter().chain(["Sections", "explain"]) {
            let rect = harness.get_by_label(&zh(name)).rect();
            assert!(window.contains_rect(rect), "{size:?}: {name} at {rect:?} is clipped");
        }
        if size[0] < 960.0 {
            press(&mut harness, "Panel");
        }
        let controls = [Role::Button, Role::ComboBox, Role::Slider, Role::SpinButton, Role::CheckBox];
        for node in harness.get_all_by(|node| controls.contains(&node.role())) {
            let (rect, label) = (node.rect(), node.accesskit_node().label());
            assert!(label.as_ref().is_some_and(|label| !label.is_empty()), "{size:?}: no name at {rect:?}");
            assert!(rect.left() >= 0.0 && rect.right() <= size[0], "{size:?}: {label:?} at {rect:?}");
        }
        for card in 1..=warpbeam::app::card_count() {
            harness.state_mut().show_card(card);
            harness.run();
            for name in ["‹ Back", "Next ›", "Leave"] {
                let rect = harness.get_by_label(&zh(name)).rect();
                assert!(window.contains_rect(rect) && rect.width() > 20.0, "{size:?}, card {card}: {name} at {rect:?}");
            }
        }
        press(&mut harness, "Leave");
        harness.state_mut().show_comparison(&parse_panes("linear,warped").unwrap());
        harness.run();
        for name in ["+ Pane", "current | budget"] {
            let rect = harness.get_by_role_and_label(Role::Button, &zh(name)).rect();
            assert!(window.contains_rect(rect), "{size:?}, Compare: {name} at {rect:?}");
        }
        harness.key_press(Key::B);
        harness.run();
        let measure = harness.get_by_label(&zh("Measure")).rect();
        assert!(window.contains_rect(measure), "{size:?}, Budget: {measure:?}");
    }
}

/// Controls of the toolbar do not overlap in windows from the smallest to wide ones, in both languages.
#[test]
fn nothing_of_the_toolbar_overlaps_in_windows_of_any_width() {
    let names = ["Scene", "Step", "Reset", "Undo", "Redo", "Explore", "Learn", "Compare", "Budget", "Limits"];
    let tools = ["Help", "Theme", "Language", "Panel"];
    let mut harness = harness_of("article", [640.0, 600.0]);
    for language in [Language::English, Language::Chinese] {
        harness.state_mut().set_language(language);
        for width in (640..1300).step_by(10) {
            let window = Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(width as f32, 600.0));
            harness.set_size(window.size());
            harness.run_steps(2);
            let rects: Vec<(&str, Rect)> = names
                .into_iter()
                .chain(tools)
                .filter_map(|name| {
                    let text = if language == Language::Chinese { zh(name) } else { name.to_owned() };
                    let mut nodes = harness.query_all_by(|node| {
                        [Role::Button, Role::ComboBox].contains(&node.role()) && node.label().as_deref() == Some(&text)
                    });
                    nodes.next().map(|node| (name, node.rect()))
                })
                .collect();
            assert!(rects.len() + 1 >= names.len() + tools.len(), "{width}: {rects:?}");
            for (i, (name, rect)) in rects.iter().enumerate() {
                assert!(window.contains_rect(*rect), "{width}: {name} at {rect:?}");
                for (other, beside) in &rects[..i] {
                    assert!(
                        !rect.shrink(0.5).intersects(*beside),
                        "{width}: {name} at {rect:?}, {other} at {beside:?}"
                    );
                }
            }
        }
    }
}
