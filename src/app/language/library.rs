//! Translation of the library's sentences, which are in English: each is matched with a pattern, and its parts are
//! translated.

use crate::app::language::{filled, tr};

/// Patterns of the sentences. A placeholder matches as little text as possible, which is then translated, too; the
/// placeholders `n` and `key` match no spaces. The first pattern that matches is used, so special ones come before
/// general ones.
const SENTENCES: &[&str] = &[
    // Ends of an iteration.
    "the limit of %{count} is reached; a higher limit may help",
    "the residual has not fallen for %{n} iterations, and is larger than rounding errors",
    "the limit of rounding is reached: rounding may change the residual by %{floor}, so the tolerance %{tolerance} \
     cannot be met here",
    "the residual has not fallen for %{n} iterations: the load is too large for this method; lower the load",
    "the body has moved by more than %{n} times its size; lower the load",
    "the body has moved by more than %{n} times its size",
    "the iteration did not reach its tolerance within %{n} solves",
    "a time step failed even when shortened to %{n} s: %{error}",
    "the motion exploded: the time step is %{n} s, the critical one about %{critical} s; shorten the time step",
    "%{error}; lower the load",
    "%{file}: expected the mesh file together with its scene file",
    // Reference solutions.
    "%{reference} (its own error at most %{own} %); beam theory differs by %{off} %",
    "%{reference} (its own error at most %{own} %)",
    "%{reference} (its own error about %{own} %)",
    "the reference solution's own error may be %{own} %, not less than the %{asked} % asked for",
    "no reference solution: the motion of the fine mesh stops: %{reason}",
    "no reference solution: the mesh of %{n} elements is too large to be refined",
    "the reference solution, %{n} unknowns",
    // Buckling, jumps, ρ, strains.
    "buckles at %{percent} of the load: beyond it, this path is unstable",
    "buckles at %{percent}",
    "stable from %{percent}",
    "%{n} unstable modes from %{percent}",
    "beyond %{percent} of the load no stable equilibrium was found",
    "the body jumped: beyond %{percent} of the load the next equilibrium is %{distance} away",
    "the warped iteration converges near here: ρ = %{n} < 1",
    "the warped iteration cannot converge here: ρ = %{n} > 1",
    "strains reach %{n} %: beyond %{most} % the linear law between stress and strain is not realistic",
    // Threads that could not be started.
    "no thread for the solve: %{error}",
    "no thread for the study: %{error}",
    // Axes of a load path.
    "rotation of support %{place}",
    "displacement of support (%{x}, %{y})",
    "displacement of support %{place}",
    "first %{load}, the others in proportion",
    "u_x of %{probe}",
    "u_y of %{probe}",
    // Invalid input.
    "expected a whole number, got %{got}",
    "expected one of %{known} with analysis = \"dynamic\", got %{got}",
    "expected one of %{known}, got %{got}",
    "expected %{what}, got nothing",
    "expected cells at most %{n} times as long as high or as high as long, got %{got}",
    "expected a straight edge, got %{edge}, which is not straight",
    "expected %{low} to %{high}, got %{got} cells in all",
    "expected %{low} to %{high}, got %{got}",
    "`%{text}` is not a number; expected %{expected}",
    "`%{text}` can be read in two ways: write a decimal point, or groups of three digits as in 30,000",
    "`%{text}` has the unknown unit `%{unit}`; expected %{expected}",
    "`%{text}` is %{got}; expected %{expected}",
    "the factorization of %{n} unknowns does not fit in memory; use a coarser mesh",
    "%{key}: %{message}",
    // Settings, and texts in the placeholders above.
    "%{mesh}, paths of its settings",
    "%{mesh}, %{method}, %{count}",
    "%{element} as meshed",
    "%{n} triangles",
    "%{n} quadrilaterals",
    "%{n} iterations",
    "%{n} iteration",
    "%{n} solves a step",
    "%{n} solve a step",
    "%{n} solves a stage",
    "%{n} solve a stage",
    "%{quantity} (%{unit})",
];

/// Returns the translation of any text of the library; unknown texts are returned unchanged.
pub(crate) fn translated(english: &str) -> String {
    let known = tr(english);
    if known != english {
        return known.to_owned();
    }
    let fitting = |sentence: &&'static str| Some((*sentence, places(sentence, english)?));
    let Some((sentence, places)) = SENTENCES.iter().find_map(fitting) else {
        return english.to_owned();
    };
    let names: Vec<&str> = places.iter().map(|place| place.0).collect();
    let values: Vec<String> = places.iter().map(|place| translated(place.1)).collect();
    filled(sentence, &names, &values)
}

/// Returns the text in each placeholder of a pattern; `None` if `text` does not match it.
fn places<'a>(sentence: &'static str, text: &'a str) -> Option<Vec<(&'static str, &'a str)>> {
    let (before, mut pattern) = sentence.split_once("%{").unwrap_or((sentence, ""));
    let mut rest = text.strip_prefix(before)?;
    let mut places = Vec::new();
    while !pattern.is_empty() {
        let (name, after) = pattern.split_once('}')?;
        let (literal, next) = after.split_once("%{").unwrap_or((after, ""));
        let value = match (literal.is_empty(), next.is_empty()) {
            (true, true) => std::mem::take(&mut rest),
            (_, true) => std::mem::take(&mut rest).strip_suffix(literal)?,
            _ => {
                let (value, behind) = rest.split_once(literal)?;
                rest = behind;
                value
            }
        };
        let is_word = !value.is_empty() && !value.contains(' ');
        if value.is_empty() || !is_word && ["n", "key"].contains(&name) {
            return None;
        }
        places.push((name, value));
        pattern = next;
    }
    rest.is_empty().then_some(places)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::language::{CHINESE, Language, speak};
    use crate::dynamics::{StepError, StopReason};
    use crate::method::{Decision, IterationError, Reason, floor_text, rho_text};
    use crate::scene::limits::{CELLS, FORCE};
    use crate::scene::{self, Source, units};
    use crate::study::{Jump, LoadPath, Reference, Setting, path_chart};

    fn open(id: &str) -> scene::Scene {
        scene::open(&Source { name: id.into(), assignments: Vec::new() }).unwrap()
    }

    /// All sentences are translated, and only the inserted values stay in English.
    #[test]
    fn the_sentences_of_the_library_are_translated() {
        speak(Language::Chinese);
        let mut texts = vec![
            Reason::IterationLimit(500).to_string(),
            Reason::Stuck(30).to_string(),
            Reason::Stalled(30).to_string(),
            Reason::RanAway(1e6).to_string(),
            Reason::NoDescent.to_string(),
            Reason::Iteration(IterationError::NotFinite).to_string(),
            Decision::OldFactor.to_string(),
            StopReason::Step { step: 1e-3, error: StepError::NotConverged(20) }.to_string(),
            StopReason::Exploded { step: 0.1, critical: 0.02 }.to_string(),
            StopReason::RanAway(100.0).to_string(),
            StopReason::Interrupted.to_string(),
            Jump { factor: 1.0, distance: 0.0 }.to_string(),
            Jump { factor: 0.5, distance: 0.0 }.to_string(),
            Jump { factor: 0.5, distance: 0.1 }.to_string(),
            crate::stress::strain_warning(0.5).unwrap(),
            FORCE.check(-1.0).unwrap_err().to_string(),
            CELLS.expected("\u{201c}0\u{201d}").to_string(),
            format!("beam.cells: {} cells in all", CELLS.check(0.0).unwrap_err()),
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
            let error = scene::Scene::from_toml(toml).unwrap_err().to_string();
            texts.push(error.split_once(": ").unwrap().1.to_owned());
        }
        texts.push(floor_text(3e-8, 1e-8));
        texts.extend([0.5, 2.0, 1e4].map(rho_text));
        texts.extend(["0,5", "3 qq", "3 kg", "?"].map(|text| units::parse(text, "N").unwrap_err().to_string()));
        for id in ["article", "cantilever", "cook", "bracket"] {
            texts.push(Reference::of(&open(id)).unwrap().to_string());
            texts.push(Setting::of(&open(id), 4).to_string());
        }
        for id in ["snap", "jump"] {
            let path = LoadPath::of(&open(id)).unwrap();
            let drawn = path_chart::figure(&path, &open(id), &path_chart::Ordinate::Usual);
            texts.extend(drawn.quantities.into_iter().map(|quantity| quantity.name));
        }
        for text in texts {
            let said = translated(&text);
            // Keys of a scene are not translated.
            let keys = ["beam.cells", "beam.length", "mesh.file", "support.0.fix", "probe.0.name", "material", "name"];
            let own = keys.iter().fold(said.clone(), |said, key| said.replace(key, ""));
            let left = own.split(|c: char| !c.is_ascii_alphabetic()).find(|word| word.len() > 2);
            assert!(said != text && left.is_none(), "{text:?}: {said:?} has {left:?}");
        }
    }

    #[test]
    fn every_sentence_is_in_the_catalogue_and_fits_itself() {
        speak(Language::Chinese);
        for sentence in SENTENCES {
            assert!(CHINESE.contains_key(*sentence), "{sentence}");
            let text = sentence.replace("%{", "").replace('}', "");
            assert!(places(sentence, &text).is_some(), "{sentence}");
        }
    }

    #[test]
    fn places_take_what_stands_there() {
        let of = |text| places("%{key}: %{message}", text);
        assert_eq!(
            of("beam.cells: expected 1: one"),
            Some(vec![("key", "beam.cells"), ("message", "expected 1: one")])
        );
        assert_eq!(of("not one word: a message"), None);
        assert_eq!(of("nothing: "), None);
        assert_eq!(places("the end", "the end"), Some(Vec::new()));
        assert_eq!(places("the end", "the end of it"), None);
        speak(Language::English);
        assert_eq!(translated("500 iterations"), "500 iterations");
        speak(Language::Chinese);
        assert_eq!(translated("no such sentence"), "no such sentence");
    }
}
