//! Formulas as egui text: italic letters, `^{…}` for superscripts, `_{…}` for subscripts, `` `…` `` for upright words.

use egui::text::LayoutJob;
use egui::{Galley, TextFormat};

use super::*;

/// Font size of a formula, points.
pub(super) const SIZE: f32 = 19.0;
/// Font size of superscripts and subscripts, relative to that of the line.
const SCRIPT: f32 = 0.66;
/// Overhang of an italic letter over its right edge, relative to the font size.
const LEAN: f32 = 0.13;

/// Vertical position of letters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Level {
    Line,
    Raised,
    Lowered,
}

/// Lays out a formula with a font size, points.
pub(super) fn sized(markup: &str, size: f32, color: Color32) -> LayoutJob {
    let mut job = LayoutJob::default();
    let mut leans = false;
    for (text, level, slanted) in pieces(markup) {
        let (script, valign) = match level {
            Level::Line => (size, Align::Center),
            Level::Raised => (SCRIPT * size, Align::TOP),
            Level::Lowered => (SCRIPT * size, Align::BOTTOM),
        };
        // egui slants letters without making them wider, so that they would touch what follows.
        let lead = if leans && level != Level::Lowered { LEAN * size } else { 0.0 };
        let font_id = FontId::proportional(script);
        job.append(&text, lead, TextFormat { font_id, color, italics: slanted, valign, ..Default::default() });
        leans = slanted && level == Level::Line;
    }
    job
}

/// Lays out a formula with this font size, or a smaller one if it is wider than `width`, points.
pub(super) fn fitted(painter: &Painter, markup: &str, size: f32, color: Color32, width: f32) -> Arc<Galley> {
    const SMALLEST: f32 = 11.0;
    let galley = painter.layout_job(sized(markup, size, color));
    if galley.size().x <= width {
        return galley;
    }
    let mut job = sized(markup, (size * width / galley.size().x).max(SMALLEST), color);
    job.wrap.max_width = width + 1.0;
    painter.layout_job(job)
}

/// Returns the formula as plain text, for screen readers.
pub(super) fn plain(markup: &str) -> String {
    pieces(markup).into_iter().map(|(text, _, _)| text).collect()
}

/// Returns the variables of a formula, without subscripts and superscripts.
#[cfg(test)]
pub(super) fn variables(markup: &str) -> Vec<char> {
    let on_the_line = pieces(markup).into_iter().filter(|(_, level, slanted)| *level == Level::Line && *slanted);
    on_the_line.flat_map(|(text, _, _)| text.chars().collect::<Vec<_>>()).filter(|c| c.is_alphabetic()).collect()
}

/// Splits markup into pieces with the same style: text, level, and `true` for italic.
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
                // A transposition sign is not a variable.
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

    /// A superscript keeps its distance from an italic letter before it; a subscript need not.
    #[test]
    fn slanted_letters_do_not_touch_superscripts() {
        let lead = |markup: &str, section: usize| sized(markup, SIZE, Color32::WHITE).sections[section].leading_space;
        assert!(lead("θ^{2}", 1) >= 2.0 && lead("R^{T}", 1) >= 2.0);
        assert_eq!((lead("x_{k}", 1), lead("`const`^{2}", 1)), (0.0, 0.0));
    }
}
