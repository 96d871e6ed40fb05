//! Tests of the window in Chinese: the catalogue has every text, the fonts have every letter, and nothing is clipped.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::common::lab::*;
use crate::panel::controls_are_inside;
use egui::FontId;

/// Returns the Chinese texts by their English ones.
fn catalogue() -> BTreeMap<String, String> {
    toml::from_str(include_str!("../../assets/locales/zh-CN.toml")).unwrap()
}

/// Returns the Chinese text for an English one.
fn zh(english: &str) -> String {
    catalogue().get(english).cloned().unwrap_or_else(|| unreachable!("{english:?} is not in the catalogue"))
}

/// Returns a window in Chinese; `size` in points.
fn open_of(id: &str, size: [f32; 2]) -> Ui {
    let mut lab = lab_of(id, scene(id));
    lab.settings.language = Language::Chinese;
    window_at([0.05, 600.0], size, lab)
}

/// Returns a window in Chinese whose body is at rest and whose background solves have ended.
fn settled(id: &str, size: [f32; 2]) -> Ui {
    let mut ui = open_of(id, size);
    ui.run();
    settle(&mut ui);
    ui
}

/// Returns every painted text, and every name and value that is given to screen readers.
fn shown(ui: &Ui) -> BTreeSet<String> {
    painted(ui).into_iter().map(|(_, text)| text).chain(ui.texts()).collect()
}

/// Words that are the same in every language: units, formats, keys, and names of programs; then those of the titles and
/// authors of the article and of the paper that it explains.
const SAME: &str = "rad RTR RkT fint Delete GIF PNG TOML Gmsh Rust Shift Ctrl Space Enter Esc Escape Comma Period BDF bdf \
    det max int warpbeam faer sym Warped Stiffness Matthias ller Markus Gross Interactive Virtual Materials Graphics \
    Interface";

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
    words
        .filter(|word| !SAME.split_whitespace().any(|same| same == *word) && !is_unit(word))
        .map(str::to_owned)
        .collect()
}

/// Mark of a text that waits for its translation.
const MARK: &str = "[en] ";

#[test]
fn texts_that_wait_for_a_translation_are_listed() {
    for (english, text) in catalogue().iter().filter(|(_, text)| text.contains(MARK)) {
        assert_eq!(*text, format!("{MARK}{english}"));
        println!("{english}");
    }
}

fn assert_chinese(ui: &Ui, what: &str) {
    // egui names the close button of its windows itself; a marked text waits for its translation.
    for text in shown(ui).into_iter().filter(|text| text != "Close window" && !text.contains(MARK)) {
        assert_eq!(english(&text), [""; 0], "{what}: {text:?}");
    }
}

/// Points at every control, and checks the text of its tooltip.
fn assert_tips_are_chinese(ui: &mut Ui, what: &str) {
    assert_new_tips_are_chinese(ui, what, &mut BTreeSet::new());
}

/// Points at every control whose label is not known.
fn assert_new_tips_are_chinese(ui: &mut Ui, what: &str, known: &mut BTreeSet<String>) {
    ui.ctx.all_styles_mut(|style| {
        style.interaction.tooltip_delay = 0.0;
        style.interaction.show_tooltips_only_when_still = false;
    });
    let window = ui.ctx.content_rect();
    let nodes = ui.get_all_by(|node| node.bounding_box().is_some());
    let nodes = nodes.filter(|node| node.accesskit_node().label().is_none_or(|label| !known.contains(&label)));
    let places: Vec<_> = nodes.map(|node| node.rect().center()).collect();
    let mut seen = BTreeSet::new();
    for place in places.into_iter().filter(|place| window.contains(*place)) {
        if seen.insert([place.x as i32, place.y as i32]) {
            ui.hover_at(place);
            ui.run_steps(2);
            assert_chinese(ui, &format!("{what}, the tip at {place:?}"));
        }
    }
    ui.remove_cursor();
    ui.run_steps(2);
    known.extend(ui.texts());
}

/// Presses the control with this text, or with one that begins with it.
fn press(ui: &mut Ui, english: &str) {
    let text = zh(english);
    let mut all = ui.query_all_by_label(&text).collect::<Vec<_>>();
    if all.is_empty() {
        all = ui.query_all_by_label_contains(&text).collect();
    }
    let is_pressable = |role: Role| [Role::Button, Role::DisclosureTriangle, Role::ComboBox].contains(&role);
    let node = all.iter().find(|node| is_pressable(node.accesskit_node().role())).or(all.first());
    node.unwrap_or_else(|| unreachable!("no {text}")).click();
    drop(all);
    ui.run_steps(6);
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
    files::rust_files(folder).into_iter().filter(|file| !file.ends_with("tests.rs"))
}

/// Literals of the window's sources that are not shown in it, separated by `|`: copied texts, ids, variables, messages of
/// programs without a window; and those that are not translated: names of keys, and reasons added to messages of the
/// system.
const NOT_SHOWN: &str = "wasm32|Cmd+|the browser is set to keep nothing|.toml,.msh|scene=|(prefers-reduced-motion: reduce)|\
    no document|# Save as scene.toml, then: warpbeam solve scene.toml\n{toml}|English|Noto Sans SC|probe values|\
    probe matrices|at right|status line|σ_x, σ_y|τ_xy|σ_1, σ_2|ε_x, ε_y|γ_xy|σ_X, σ_Y|τ_XY|ε_X, ε_Y|γ_XY|σ_z|ε_1, ε_2|\
    WAYLAND_DISPLAY|WAYLAND_SOCKET|DISPLAY|the scene to begin with is missing|\
    {} has {PLACES} copies of unsaved scenes|the display did not answer in time|the surface stays out of date|\
    the surface was lost: {e}|the surface was lost|the surface is not valid|\
    NAME|WxH|FIELD|FACTOR|CARD|PANE,PANE|expected one of {}|\
    expected WIDTHxHEIGHT, each from 64 to {MAX_SHOT_SIDE}, as in 1280x800|\
    expected a method ({}), an element ({}), cells as in 10x2 or a number of iterations, got \u{201c}{part}\u{201d}|\
    {}: expected a file name ending in .gif, or the name of a folder for numbered pictures, which ffmpeg makes a film of";

/// A text is in the catalogue or in the list above. The tests that read the window find single words in lower case.
#[test]
fn every_text_of_the_sources_is_in_the_catalogue() {
    let known = catalogue();
    let (mut found, mut missing) = (BTreeSet::new(), Vec::new());
    for path in sources("src/app".as_ref()) {
        for literal in literals(&std::fs::read_to_string(&path).unwrap()) {
            // Removes the placeholders of format strings.
            let mut parts = literal.split('{');
            let first = parts.next().unwrap_or_default().to_owned();
            let words = parts.fold(first, |words, part| words + part.split_once('}').map_or("", |(_, rest)| rest));
            let is_id = words.chars().all(|c| c.is_ascii_lowercase() || "-_./".contains(c));
            let keys = [literal.clone(), literal.replace('{', "%{"), format!("%{{n}} {literal}")];
            let needs = !is_id && !keys.iter().any(|key| known.contains_key(key)) && !english(&words).is_empty();
            if needs && !NOT_SHOWN.split('|').any(|other| other == literal) {
                missing.push(format!("{}: {literal:?}", path.display()));
            }
            found.insert(literal);
        }
    }
    assert!(missing.is_empty(), "not in assets/locales: {missing:#?}");
    assert!(found.contains("Linear theory makes the area grow") && found.contains("Cancel"), "the scan is blind");
    for not_shown in NOT_SHOWN.split('|') {
        assert!(found.contains(not_shown), "{not_shown:?} is no longer in the sources");
    }
}

/// Every sentence of the library is in the catalogue, and has a part for every placeholder.
#[test]
fn every_sentence_of_the_library_is_in_the_catalogue() {
    let (known, mut found) = (catalogue(), BTreeSet::new());
    for path in files::rust_files("src".as_ref()) {
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

#[test]
fn every_named_entry_of_the_library_is_in_the_catalogue() {
    let known = catalogue();
    let mut texts: Vec<String> = Vec::new();
    let integrators = IntegratorKind::all().map(IntegratorKind::entry).flat_map(|entry| [entry.id, entry.about]);
    let named = METHODS.iter().flat_map(|entry| [entry.id, entry.about]).chain(integrators);
    let named = named.chain(ELEMENTS.iter().map(|entry| entry.about)).chain(Field::ALL.map(Field::name));
    texts.extend(named.map(str::to_owned));
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

/// A translation has the placeholders of its original, and no English words.
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

/// The fonts have the letters of the English texts in the sources and of the Chinese texts in the catalogue.
#[test]
fn the_fonts_have_every_letter() {
    let mut texts = "\u{2013}\u{201c}\u{201d}\u{2212}".to_owned();
    for folder in ["app", "method", "element", "model", "scene", "simulation"] {
        for file in files::rust_files(&Path::new("src").join(folder)) {
            texts.extend(std::fs::read_to_string(file).unwrap().lines().filter_map(|line| line.split("//").next()));
        }
    }
    texts.extend(scene_ids().into_iter().map(|id| scene(id).about));
    let letters = |texts: &str| texts.chars().filter(|c| !c.is_ascii()).collect::<BTreeSet<char>>();
    assert!(letters(&texts).contains(&'≤') && letters(&texts).contains(&'ρ'));
    let chinese: String = catalogue().into_values().chain([Language::Chinese.name().to_owned()]).collect();
    for (language, texts) in [(Language::English, texts), (Language::Chinese, chinese)] {
        let mut ui = open_of("article", [640.0, 480.0]);
        ui.state_mut().settings.language = language;
        ui.run();
        for font in
            [12.0, 14.0, 18.0].into_iter().flat_map(|size| [FontId::proportional(size), FontId::monospace(size)])
        {
            let lacks = |c: &char| !ui.ctx.fonts_mut(|fonts| fonts.has_glyph(&font, *c));
            let ascii = texts.chars().filter(|c| c.is_ascii_graphic()).collect::<BTreeSet<char>>();
            assert_eq!(letters(&texts).into_iter().chain(ascii).filter(lacks).collect::<String>(), "", "{font:?}");
            assert!(lacks(&'\u{9f98}'), "the check is blind");
        }
    }
}

/// The button in the toolbar is labelled in the other language.
#[test]
fn the_switch_changes_the_language_and_the_settings_keep_it() {
    let mut ui = settled("article", SIZE);
    assert_chinese(&ui, "Explore");
    press(&mut ui, "Language");
    ui.contains(["Language", "Run"]);
    assert_eq!(ui.state().settings.language, Language::English);
    ui.click("Language");
    ui.get_by_label(&zh("Run"));
    // The same on a card of Learn, and after it.
    press(&mut ui, "Learn");
    press(&mut ui, "Language");
    ui.get_by_label("Linear theory makes the area grow");
    ui.click("Leave");
    ui.get_by_label("Run");
    ui.click("Language");
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("settings.toml");
    ui.state().settings(&ui.ctx).save(&Settings::default(), &file).unwrap();
    let (settings, _) = Settings::load(&file);
    assert_eq!((settings.language, Settings::default().language), (Language::Chinese, Language::English));
    let mut again = settled("article", SIZE);
    again.state_mut().settings.language = Language::English;
    let ctx = again.ctx.clone();
    again.state_mut().set_settings(&ctx, settings);
    again.run();
    again.get_by_label(&zh("Run"));
}

/// Chinese are every fold, the pickers, the drawer, a point's card, messages and remedies, the help and the dialog.
#[test]
fn exploring_is_in_chinese() {
    let mut ui = settled("article", [1280.0, 2400.0]);
    assert!(ui.state().title().contains(&zh("The article's beam")));
    for fold in ["Gravity, moment", "Loads and supports", "Beam", "Material", "Mesh", "View", "File", "Details"] {
        press(&mut ui, fold);
        assert_chinese(&ui, fold);
    }
    ["explain", "Fixed colour range", "Sections"].into_iter().for_each(|text| press(&mut ui, text));
    settle(&mut ui);
    assert_tips_are_chinese(&mut ui, "Explore");
    ["Method", "Element", "Colour", "Force on", "Scene"]
        .into_iter()
        .for_each(|picker| entries_are_chinese(&mut ui, &zh(picker)));
    for (label, text) in
        [("Force", "?"), ("Force", "3 MPa"), ("Young E", "0"), ("Poisson ν", "0,4"), ("Cells along", "2.5")]
    {
        ui.type_into(&zh(label), text);
        assert_chinese(&ui, &format!("{label}: {text}"));
    }
    // The list of keys, and the messages of copied texts.
    for (modifiers, key) in [
        (Modifiers::NONE, Key::F1),
        (Modifiers::NONE, Key::Escape),
        (Modifiers::NONE, Key::C),
        (Modifiers::SHIFT, Key::C),
    ] {
        ui.key_press_modifiers(modifiers, key);
        ui.run_steps(6);
        assert_chinese(&ui, &format!("{modifiers:?} {key:?}"));
    }
}

/// Opens a list, checks its entries, and closes it.
fn entries_are_chinese(ui: &mut Ui, picker: &str) {
    ui.get_by_role_and_label(Role::ComboBox, picker).click();
    ui.run_steps(6);
    assert_chinese(ui, picker);
    ui.key_press(Key::Escape);
    ui.run_steps(6);
}

/// The states, load paths and supports of scenes of every kind have Chinese texts.
#[test]
fn scenes_of_every_kind_are_in_chinese() {
    let size = [1280.0, 2000.0];
    let mut ui = settled("cantilever", size);
    ui.type_into(&zh("Force"), "9000 N");
    assert_chinese(&ui, "diverged");
    for id in ["jump", "bracket", "cook", "snap"] {
        let mut ui = settled(id, size);
        ["Details", "Measure", "Load curve"].into_iter().for_each(|text| press(&mut ui, text));
        settle(&mut ui);
        press(&mut ui, "explain");
        assert_tips_are_chinese(&mut ui, id);
    }
}

/// The time, the plots and the other integrators have Chinese texts.
#[test]
fn motions_are_in_chinese() {
    let mut ui = open_of("swing", [1280.0, 2000.0]);
    ui.run_steps(20);
    ["Details", "Energy and tip"].into_iter().for_each(|text| press(&mut ui, text));
    ui.run_steps(100);
    press(&mut ui, "Pause");
    settle(&mut ui);
    for plot in ["Energy", "Tip"] {
        press(&mut ui, plot);
        assert_chinese(&ui, plot);
    }
    assert_tips_are_chinese(&mut ui, "swing");
}

#[test]
fn comparing_is_in_chinese() {
    let mut ui = settled("article", SIZE);
    ui.state_mut().show_comparison(&parse_panes("linear,warped,newton:t6:10x2,auto").unwrap());
    ui.run();
    wait(&mut ui, "the panes", |lab| lab.panes().iter().all(|pane| pane.run.end.is_some()));
    assert_tips_are_chinese(&mut ui, "Compare");
    for what in ["method", "element", "mesh"] {
        entries_are_chinese(&mut ui, &format!("{} {}", zh("Pane %{n}").replace("%{n}", "1"), zh(what)));
    }
}

#[test]
fn the_measurements_and_every_card_are_in_chinese() {
    let mut ui = settled("article", SIZE);
    ui.key(Key::B);
    assert_chinese(&ui, "before");
    ui.state_mut().show_study(Study::new(&scene("article"), Extent::Quick, &go_on).unwrap());
    ui.run();
    assert_tips_are_chinese(&mut ui, "How fast");
    let mut ui = settled("article", SIZE);
    ui.key_press(Key::M);
    ui.run_steps(3);
    settle(&mut ui);
    assert_tips_are_chinese(&mut ui, "How far");
    // The toolbar is that of the first card.
    let mut known = BTreeSet::new();
    for card in 1..=card_count() {
        ui.state_mut().show_card(card);
        ui.run();
        settle(&mut ui);
        assert_chinese(&ui, &format!("card {card}"));
        assert_new_tips_are_chinese(&mut ui, &format!("card {card}"), &mut known);
    }
}

/// In both languages, every control has a name, is inside and wide enough for its text, and can be reached.
#[test]
fn nothing_is_clipped_in_windows_of_any_size() {
    const SIZES: [[f32; 2]; 5] = [[640.0, 480.0], [800.0, 600.0], [959.0, 600.0], [960.0, 600.0], SIZE];
    for (language, size) in pairs([Language::English, Language::Chinese], SIZES) {
        let word = |english: &str| if language == Language::Chinese { zh(english) } else { english.to_owned() };
        let mut ui = open_of("article", size);
        ui.state_mut().settings.language = language;
        ui.run();
        settle(&mut ui);
        let (is_narrow, force) = (size[0] < 960.0, word("Force"));
        assert_eq!(ui.has(Role::Slider, &force), !is_narrow);
        if is_narrow {
            ui.push(&word("Panel"));
            assert!(ui.state().view_rect().right() > size[0] - 20.0, "the sheet is over the body");
        }
        let names =
            "Run Step Reset Explore Learn Compare Measure Help Theme Language Panel Sections explain".split(' ');
        ui.contains(names.map(word));
        controls_are_inside(&ui);
        if is_narrow {
            ui.key(Key::P);
            assert!(!ui.has(Role::Slider, &force));
        }
        for card in 1..=card_count() {
            ui.state_mut().show_card(card);
            ui.run();
            let names = ["‹ Back", "Next ›", "Leave"].map(word);
            ui.contains(&names);
            assert!(names.iter().all(|name| ui.get_by_label(name).rect().width() > 20.0), "{size:?}, card {card}");
            ui.get_by_label(&word("%{n} of %{count}").replace("%{n}", &card.to_string()).replace("%{count}", "9"));
            let view = ui.state().view_rect();
            assert!(view.height() > 0.3 * size[1], "{size:?}: the body has {view:?}");
            if card < card_count() {
                ui.click(&names[1]);
                assert_eq!(ui.state().card(), Some((card + 1, 9)));
            }
        }
        ui.click(&word("Leave"));
        ui.state_mut().show_comparison(&parse_panes("linear,warped").unwrap());
        ui.run();
        let window = ui.ctx.content_rect();
        for name in ["+ Pane", "current | fastest"] {
            assert!(window.contains_rect(ui.rect(Role::Button, &word(name))), "{size:?}, Compare: {name}");
        }
        ui.key(Key::B);
        ui.contains([word("Measure on this machine")]);
    }
}

/// No control of the toolbar overlaps another in either language.
#[test]
fn nothing_of_the_toolbar_overlaps_in_windows_of_any_width() {
    let names = "Scene Step Reset Undo Redo Explore Learn Compare Measure Help Theme Language Panel";
    let mut ui = open_of("article", [640.0, 600.0]);
    for language in [Language::English, Language::Chinese] {
        ui.state_mut().settings.language = language;
        for width in (640..1300).step_by(10) {
            let window = Rect::from_min_size(Pos2::ZERO, vec2(width as f32, 600.0));
            ui.set_size(window.size());
            ui.run_steps(2);
            let rects = names.split(' ').filter_map(|name| {
                let text = if language == Language::Chinese { zh(name) } else { name.to_owned() };
                let mut nodes = ui.query_all_by(|node| {
                    [Role::Button, Role::ComboBox].contains(&node.role()) && node.label().as_deref() == Some(&text)
                });
                nodes.next().map(|node| (name, node.rect()))
            });
            let rects: Vec<(&str, Rect)> = rects.collect();
            assert!(rects.len() + 1 >= names.split(' ').count(), "{width}: {rects:?}");
            for (i, (name, rect)) in rects.iter().enumerate() {
                assert!(window.contains_rect(*rect), "{width}: {name} at {rect:?}");
                let other = rects[..i].iter().find(|(_, other)| rect.shrink(0.5).intersects(*other));
                assert!(other.is_none(), "{width}: {name} at {rect:?}, {other:?}");
            }
        }
    }
}
