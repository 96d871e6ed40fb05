//! Formulas set over egui's text: letters slanted, `^{…}` raised, `_{…}` lowered, `` `…` `` upright words.

use egui::text::LayoutJob;
use egui::{Align, Color32, FontId, TextFormat};

use crate::app::language::tr;

/// Size of a formula, points.
pub(super) const SIZE: f32 = 19.0;
/// Size of what is raised or lowered.
const SCRIPT: f32 = 12.5;

/// Where letters stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Level {
    Line,
    Raised,
    Lowered,
}

/// Sets a formula.
pub(super) fn set(markup: &str, color: Color32) -> LayoutJob {
    let mut job = LayoutJob::default();
    for (text, level, slanted) in pieces(markup) {
        let (size, valign) = match level {
            Level::Line => (SIZE, Align::Center),
            Level::Raised => (SCRIPT, Align::TOP),
            Level::Lowered => (SCRIPT, Align::BOTTOM),
        };
        let font_id = FontId::proportional(size);
        job.append(&text, 0.0, TextFormat { font_id, color, italics: slanted, valign, ..Default::default() });
    }
    job
}

/// The formula as a line of plain text, for who cannot see it.
pub(super) fn plain(markup: &str) -> String {
    pieces(markup).into_iter().map(|(text, _, _)| text).collect()
}

/// Runs of letters that are set alike: text, level, whether slanted.
fn pieces(markup: &str) -> Vec<(String, Level, bool)> {
    let mut pieces: Vec<(String, Level, bool)> = Vec::new();
    let mut level = Level::Line;
    let mut push = |text: &str, level, slanted| match pieces.last_mut() {
        Some((before, own, same)) if (*own, *same) == (level, slanted) => before.push_str(text),
        _ => pieces.push((text.to_owned(), level, slanted)),
    };
    let mut letters = markup.chars().peekable();
    while let Some(letter) = letters.next() {
        match letter {
            '^' | '_' if letters.peek() == Some(&'{') => {
                letters.next();
                level = if letter == '^' { Level::Raised } else { Level::Lowered };
            }
            '}' => level = Level::Line,
            '`' => {
                let word: String = letters.by_ref().take_while(|letter| *letter != '`').collect();
                push(tr(&word), level, false);
            }
            _ => {
                // A transposed T is no variable.
                let slanted = letter.is_alphabetic() && !(letter == 'T' && level == Level::Raised);
                push(letter.encode_utf8(&mut [0; 4]), level, slanted);
            }
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_are_slanted_and_scripts_raised_or_lowered() {
        let piece = |text: &str, level, slanted| (text.to_owned(), level, slanted);
        assert_eq!(
            pieces("R^{T}x_{k+1} = `const`"),
            [
                piece("R", Level::Line, true),
                piece("T", Level::Raised, false),
                piece("x", Level::Line, true),
                piece("k", Level::Lowered, true),
                piece("+1", Level::Lowered, false),
                piece(" = const", Level::Line, false),
            ]
        );
        assert_eq!(plain("R K R^{T} x = f"), "R K RT x = f");
    }
}
