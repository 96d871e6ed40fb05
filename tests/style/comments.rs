//! Language of the comments: a comment does not begin with a word that leaves out its noun ("What", "Whether", …), and
//! contains no words of the forbidden list.
//!
//! The comments are read from the text, so that strings do not count. Raw strings and block
//! comments are not recognised.

use crate::files::rust_files;

/// Checked folders, with all folders inside them.
const FOLDERS: [&str; 4] = ["tests", "benches", "examples", "src"];

/// Words that may not begin a comment. Each of them stands for a noun phrase without its noun.
const OPENERS: [&str; 13] = [
    "What",
    "Whether",
    "That of",
    "Those",
    "Of",
    "As",
    "So many",
    "So far",
    "So near",
    "Where there is",
    "Which",
    "Only that",
    "Not before",
];

/// Words and phrases that may not occur in a comment, in any case of letters.
const FORBIDDEN: [&str; 10] = [
    "nobody",
    "somebody",
    "anew",
    "errand",
    "errands",
    "no farther than",
    "as it was left",
    "on its way",
    "beside the window",
    "thereof",
];

/// Allowed comments: file, fragment of the comment line, reason.
const EXCEPTIONS: [(&str, &str, &str); 0] = [];

#[test]
fn comments_are_plain_sentences() {
    let mut found = Vec::new();
    for file in FOLDERS.iter().flat_map(|folder| rust_files(folder.as_ref())) {
        let name = file.to_str().unwrap().replace('\\', "/");
        for (line, text) in violations(&std::fs::read_to_string(&file).unwrap()) {
            let excepted = |(file, fragment, _): &(&str, &str, &str)| name == *file && text.contains(fragment);
            if !EXCEPTIONS.iter().any(excepted) {
                found.push(format!("{name}:{line}: {text}"));
            }
        }
    }
    assert!(found.is_empty(), "{} comments to rewrite:\n{}", found.len(), found.join("\n"));
}

#[test]
fn every_exception_is_still_needed() {
    for (file, fragment, reason) in EXCEPTIONS {
        let found = violations(&std::fs::read_to_string(file).unwrap());
        assert!(found.iter().any(|(_, text)| text.contains(fragment)), "{file} without \"{fragment}\" ({reason})");
    }
}

#[test]
fn forbidden_openers_and_words_are_found() {
    let lines = |text: &str| violations(text).into_iter().map(|(line, _)| line).collect::<Vec<_>>();
    for opener in OPENERS {
        for mark in ["//", "///", "//!", "let a = 1; //"] {
            assert_eq!(lines(&format!("fn f() {{}}\n    {mark} {opener} it is.")), [2], "{mark} {opener}");
        }
        assert_eq!(lines(&format!("// A sentence that contains\n// {opener} inside.")), [0; 0], "{opener}");
        assert_eq!(lines(&format!("// {opener}y is another word.")), [0; 0], "{opener}");
    }
    for word in FORBIDDEN {
        assert_eq!(lines(&format!("/// First line\n/// with {}, and more.", word.to_uppercase())), [2], "{word}");
        assert_eq!(lines(&format!("// x{word} {word}x")), [0; 0], "{word}");
    }
    assert_eq!(lines("let a = (\"// What\", '\"', \"\\\"// nobody\n// nobody\"); // Somebody"), [2], "strings");
    assert_eq!(lines("let url = \"https://example.org\";\n\n// Whatever comes, as expected.\nf::<'a>();"), [0; 0]);
}

/// Returns the comment lines that break a rule, with their line numbers.
fn violations(text: &str) -> Vec<(usize, String)> {
    let (mut found, mut last) = (Vec::new(), None);
    for (line, comment, alone) in comments(text) {
        let sentence = comment.trim_start_matches(['/', '!']).trim();
        let continues = alone && last == Some(line - 1);
        let opener = !continues && OPENERS.iter().any(|opener| contains(sentence, opener) == Some(0));
        let lower = sentence.to_lowercase();
        if opener || FORBIDDEN.iter().any(|word| contains(&lower, word).is_some()) {
            found.push((line, comment.trim().to_owned()));
        }
        last = alone.then_some(line);
    }
    found
}

/// Returns the position of the first occurrence of whole words in a text.
fn contains(text: &str, words: &str) -> Option<usize> {
    let whole = |&(at, _): &(usize, &str)| {
        !text[..at].ends_with(char::is_alphanumeric) && !text[at + words.len()..].starts_with(char::is_alphanumeric)
    };
    text.match_indices(words).find(whole).map(|(at, _)| at)
}

/// Returns line number and text of every comment line; `true` if the line holds nothing else.
fn comments(text: &str) -> Vec<(usize, &str, bool)> {
    let (mut comments, mut line, mut begin, mut string) = (Vec::new(), 1, 0, false);
    let mut rest = text.char_indices().peekable();
    while let Some((at, c)) = rest.next() {
        match c {
            '\n' => (line, begin) = (line + 1, at + 1),
            '"' => string = !string,
            '\\' if string && !text[at + 1..].starts_with('\n') => _ = rest.next(),
            '\'' if !string && text[at..].starts_with("'\"'") => _ = rest.nth(1),
            '/' if !string && text[at..].starts_with("//") => {
                let comment = text[at..].lines().next().unwrap_or_default();
                comments.push((line, comment, text[begin..at].trim().is_empty()));
                while rest.next_if(|(_, c)| *c != '\n').is_some() {}
            }
            _ => {}
        }
    }
    comments
}
