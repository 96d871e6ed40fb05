//! Test of the translation of the library's sentences.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::cell::RefCell;

use super::{Language, said, speak};
use crate::dynamics::{StepError, StopReason};
use crate::method::{Decision, IterationError, Reason};
use crate::scene::keys::range;
use crate::scene::{self, Scene, SceneError, Source, units};
use crate::sentence::Sentence;
use crate::simulation::Simulation;
use crate::study::{
    Drive, Jump, LoadPath, PathSummary, Reference, Setting, floor_text, path_chart, rho_text, section_chart,
};

fn open(id: &str) -> Scene {
    scene::open(&Source { name: id.into(), assignments: Vec::new() }).unwrap()
}

/// Returns a sentence in English and in the language of the thread.
fn both<'a, T>(sentence: &'a T) -> [String; 2]
where
    Sentence: From<&'a T>,
{
    [Sentence::from(sentence).to_string(), said(sentence)]
}

/// All sentences are translated, and only the inserted values stay in English.
#[test]
fn the_sentences_of_the_library_are_translated() {
    speak(Language::Chinese);
    let mut cells = open("article");
    cells.beam.as_mut().unwrap().cells = [1000, 1000];
    let mut texts = vec![
        both(&Reason::IterationLimit(500)),
        both(&Reason::Stuck(30)),
        both(&Reason::Stalled(30)),
        both(&Reason::RanAway(1e6)),
        both(&Reason::NoEquilibrium(0.5)),
        both(&Reason::Iteration(IterationError::NotFinite)),
        both(&Decision::OldFactor),
        both(&StopReason::Step { step: 1e-3, error: StepError::NotConverged(20) }),
        both(&StopReason::Exploded { step: 0.1, critical: 0.02 }),
        both(&StopReason::RanAway(100.0)),
        both(&StopReason::Interrupted),
        both(&crate::stress::strain_warning(0.5).unwrap()),
        both(&crate::stress::inversion_warning(3, 10).unwrap()),
        both(&range("load.force").check(-1.0).unwrap_err()),
        both(&range("beam.cells").expected("\u{201c}0\u{201d}")),
        both(&cells.validate().unwrap_err()),
    ];
    let missing = [
        "name = \"Bar\"\n[beam]\nheight = 1.0",
        "name = \"Bar\"\n[beam]\nlength = 1.0\nheight = 1.0",
        "name = \"Bar\"\n[mesh]",
        "name = \"Bar\"\n[[support]]",
        "name = \"Bar\"\n[[probe]]",
        "name = \"Bar\"",
        "",
    ];
    for toml in missing {
        let SceneError::Invalid { invalid, .. } = Scene::from_toml(toml).unwrap_err() else { unreachable!("{toml}") };
        texts.push(both(&invalid));
    }
    for (most, drive) in [(None, Drive::Loads), (Some(0.1), Drive::Supports), (Some(0.1), Drive::Both)] {
        let jump = Some(Jump { factor: 0.5, distance: most });
        let path = PathSummary { jump, buckling: None, critical: most, drive, supports_work: None, elsewhere: most };
        texts.extend(path.claims().map(|claim| both(&claim)));
    }
    texts.push(both(&floor_text(3e-8, 1e-8)));
    texts.extend([0.5, 2.0, 1e4].map(|rho| both(&rho_text(rho))));
    texts.extend(["0,5", "3 qq", "3 kg", "?"].map(|text| both(&units::parse(text, "N").unwrap_err().message)));
    for id in ["article", "cantilever", "cook", "bracket"] {
        texts.push(both(&Reference::of(&open(id)).unwrap()));
        texts.push(both(&Setting { iterations: 4, ..Setting::of(&open(id)) }));
    }
    let names = RefCell::new(Vec::new());
    let render = |name: &Sentence| {
        names.borrow_mut().push(both(name));
        name.to_string()
    };
    for id in ["snap", "jump"] {
        let path = LoadPath::of(&open(id), &|_| std::ops::ControlFlow::Continue(())).unwrap();
        let _ = path_chart::figure(&path, &open(id), &path_chart::Ordinate::Usual, &render);
    }
    let scene = open("cantilever");
    let mut simulation = Simulation::new(&scene).unwrap();
    simulation.solve();
    let along = simulation.sections(3).unwrap();
    let within = section_chart::contexts(&along, &simulation);
    let _ = (
        section_chart::stress(&along[1], &scene, &within, &render),
        section_chart::forces(&along, &scene, &within, &render),
    );
    texts.extend(names.into_inner());
    for [text, said] in texts {
        // Keys of a scene are not translated.
        let keys = ["beam.cells", "beam.length", "mesh.file", "support.0.fix", "probe.0.name", "material", "name"];
        let own = keys.iter().fold(said.clone(), |said, key| said.replace(key, ""));
        let left = own.split(|c: char| !c.is_ascii_alphabetic()).find(|word| word.len() > 2);
        assert!(said != text && left.is_none(), "{text:?}: {said:?} has {left:?}");
    }
}
