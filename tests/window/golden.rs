//! Compares the whole window with golden pictures: Explore, each card of Learn, Compare and Measure; some with another
//! theme or language. The tests of each mode check the displayed numbers.
//!
//! `UPDATE_GOLDEN=1 cargo test --test window golden` redraws the pictures; look at them before committing.

use std::path::PathBuf;

use crate::common::pictures::{difference, lab, read_png};
use egui::{Key, Theme};
use warpbeam::app::{Lab, Language, MeasureTab, Picture, parse_panes, picture};
use warpbeam::render::Gpu;

/// Size of the window in pixels, wide enough for the panel.
const SIZE: [u32; 2] = [960, 600];

/// Share of pixels that may differ.
const TOLERANCE: f64 = 5e-4;
/// Measured time and its bar in the status bar: left, top, right and bottom in pixels.
const TIME: [u32; 4] = [322, 568, 442, 594];
/// Measured times in the four panes of Compare.
const PANES: [[u32; 4]; 4] = [[56, 102, 335, 122], [397, 102, 670, 122], [56, 357, 335, 377], [397, 357, 670, 377]];

/// Blanks the rectangles of measured numbers, which differ from run to run.
fn covered(mut picture: Picture, measured: &[[u32; 4]]) -> Picture {
    for [left, top, right, bottom] in measured {
        for y in *top..*bottom {
            let row = 4 * (y * picture.size[0]) as usize;
            picture.rgba[row + 4 * *left as usize..row + 4 * *right as usize].fill(0);
        }
    }
    picture
}

/// Language and theme of a picture, with the suffix of its file name.
const DARK: (Language, Theme, &str) = (Language::English, Theme::Dark, "dark");
const LIGHT: (Language, Theme, &str) = (Language::English, Theme::Light, "light");
const CHINESE: (Language, Theme, &str) = (Language::Chinese, Theme::Dark, "dark-zh");

/// Draws the window with these languages and themes, and compares it with the golden pictures of this name, except for
/// the rectangles of measured numbers.
fn golden(name: &str, lab: &mut Lab, looks: &[(Language, Theme, &str)], measured: &[[u32; 4]]) {
    let gpu = Gpu::headless(None).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let mut wrong = Vec::new();
    for (language, theme, mark) in looks {
        lab.settings.language = *language;
        let file = format!("{name}-{mark}.png");
        let path = folder.path().join(&file);
        picture(&gpu, lab, SIZE, 1.0, *theme).unwrap().write_png(&path).unwrap();
        let golden = PathBuf::from("tests/golden/window").join(&file);
        if std::env::var_os("UPDATE_GOLDEN").is_some() {
            std::fs::create_dir_all("tests/golden/window").unwrap();
            std::fs::copy(&path, &golden).unwrap();
        }
        let difference = difference(&covered(read_png(&path), measured), &covered(read_png(&golden), measured));
        if difference >= TOLERANCE {
            let kept = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(&file);
            std::fs::copy(&path, &kept).unwrap();
            wrong.push(format!("{}: {:.2} % of the pixels differ", kept.display(), 100.0 * difference));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// How fast is drawn before any measurement, because measured times differ from run to run.
#[test]
fn explore_and_measure() {
    let mut explore = lab("article");
    explore.solve();
    golden("explore", &mut explore, &[DARK, LIGHT, CHINESE], &[TIME]);
    let mut ui = crate::common::lab::window([960.0, 600.0], explore);
    ui.state_mut().settings.language = Language::English;
    ui.key_press(Key::B);
    ui.run_steps(3);
    golden("budget", ui.state_mut(), &[DARK], &[TIME]);
    let mut limits = lab("article");
    limits.show_tab(MeasureTab::HowFar);
    limits.solve();
    golden("limits", &mut limits, &[DARK, LIGHT], &[TIME]);
}

#[test]
fn every_card_of_learn() {
    for card in 1..=warpbeam::app::card_count() {
        let mut lab = lab("article");
        lab.show_card(card);
        lab.solve();
        let looks: &[_] = match card {
            1 => &[DARK, LIGHT],
            5 => &[DARK, CHINESE],
            _ => &[DARK],
        };
        golden(&format!("learn-{card}"), &mut lab, looks, &[TIME]);
    }
}

#[test]
fn compare() {
    for (name, panes, look) in
        [("methods", "linear,warped,newton", DARK), ("elements", "warped:t3,warped:t6,newton:q4,newton:t3:20x4", LIGHT)]
    {
        let mut lab = lab("article");
        lab.show_comparison(&parse_panes(panes).unwrap());
        lab.solve();
        golden(&format!("compare-{name}"), &mut lab, &[look], &PANES);
    }
}
