//! Opens scenes from a name or path with `--set` assignments, and validates them; errors have file and line.

use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use toml::de::{DeTable, DeValue};
use toml::{Table, Value};

use super::mesh::read_mesh;
use super::{Invalid, Scene, SceneError, registry, units};
use crate::model::{check, check_required};

/// Largest accepted scene file, bytes; checked before reading.
const MAX_FILE_BYTES: u64 = 4 << 20;

/// Name that stands for standard input.
pub const STANDARD_INPUT: &str = "-";

/// Origin of a scene: its text and the assignments made to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// Built-in name, path, or [`STANDARD_INPUT`], as typed. A path may be invalid UTF-8.
    pub name: PathBuf,
    /// `PATH=VALUE` assignments, in order.
    pub assignments: Vec<String>,
}

/// Opens a built-in scene or a scene file and applies `PATH=VALUE` assignments.
///
/// # Errors
/// [`SceneError`], whose message contains the expected value.
pub fn open(source: &Source) -> Result<Scene, SceneError> {
    // Paths in a stream are relative to the current folder.
    let folder = source.name.parent().filter(|_| !source.is_stream()).unwrap_or(Path::new(""));
    parse(&source.text()?, Some(&source.name), Some(folder), &source.assignments)
}

/// Adds the location of an error that was found when the scene was simulated: the `--set` assignment, or file and line.
pub fn locate(source: &Source, invalid: Invalid) -> SceneError {
    blame(&source.text().unwrap_or_default(), Some(&source.name), &source.assignments, invalid)
}

impl Source {
    /// Returns the built-in scene with this name, `None` if there is none.
    pub fn built_in(&self) -> Option<&'static registry::BuiltIn> {
        self.name.to_str().and_then(registry::find)
    }

    /// Returns the folder that the scene's mesh file is relative to: empty for a built-in scene, else absolute.
    pub fn folder(&self) -> PathBuf {
        if self.built_in().is_some() {
            return PathBuf::new();
        }
        let folder = self.name.parent().filter(|_| !self.is_stream()).unwrap_or(Path::new(""));
        // `std::path::absolute` rejects an empty path.
        std::path::absolute(folder.join(".")).unwrap_or_else(|_| folder.to_owned())
    }

    /// Returns the text of the scene, without the assignments.
    ///
    /// # Errors
    /// [`SceneError::Read`], or [`SceneError::Syntax`] if the file is not UTF-8.
    pub(crate) fn text(&self) -> Result<String, SceneError> {
        let bytes = match self.built_in() {
            Some(built_in) => return Ok(built_in.toml.to_owned()),
            None if self.is_stream() => self.read_stream(),
            None => read(&self.name).map_err(|reason| unreadable(&self.name, &reason)),
        };
        decoded(&self.name, &bytes?)
    }

    /// Returns `true` for standard input and for pipes (`<(…)` in a shell), which can be read only once.
    pub fn is_stream(&self) -> bool {
        self.name == Path::new(STANDARD_INPUT)
            || self.built_in().is_none()
                && std::fs::metadata(&self.name).is_ok_and(|file| !file.is_file() && !file.is_dir())
    }

    /// Reads the text of a stream and keeps it for later calls.
    fn read_stream(&self) -> Result<Vec<u8>, SceneError> {
        static TEXTS: Mutex<BTreeMap<PathBuf, Result<Vec<u8>, String>>> = Mutex::new(BTreeMap::new());
        let is_input = self.name == Path::new(STANDARD_INPUT);
        let mut texts = TEXTS.lock().unwrap_or_else(PoisonError::into_inner);
        let text = texts.entry(self.name.clone()).or_insert_with(|| match is_input {
            true => read_to_limit(std::io::stdin().lock()),
            false => std::fs::File::open(&self.name).map_err(|e| e.to_string()).and_then(read_to_limit),
        });
        let name = if is_input { Path::new("standard input") } else { &self.name };
        text.clone().map_err(|reason| unreadable(name, &reason))
    }
}

/// Reads a text up to the size limit of scenes.
fn read_to_limit(stream: impl Read) -> Result<Vec<u8>, String> {
    let mut text = Vec::new();
    let bytes = stream.take(MAX_FILE_BYTES + 1).read_to_end(&mut text).map_err(|e| e.to_string())?;
    check_size(bytes as u64).map(|()| text)
}

/// Returns a scene's text; the error names the encoding and the line of the first byte that is not UTF-8.
fn decoded(name: &Path, bytes: &[u8]) -> Result<String, SceneError> {
    // The text of a scene has no zeros, but every second byte of UTF-16 is one.
    let zeros = bytes.iter().filter(|&&byte| byte == 0).count();
    let invalid = str::from_utf8(bytes).err().map(|error| error.valid_up_to());
    let Some(at) = invalid.or(bytes.iter().position(|&byte| byte == 0)) else {
        return Ok(String::from_utf8_lossy(bytes).into_owned());
    };
    let line = 1 + bytes.iter().take(at).filter(|&&byte| byte == b'\n').count();
    let advice =
        |encoding| format!("; save it as UTF-8, or convert it: `iconv -f {encoding} -t UTF-8 in.toml > out.toml`");
    let got = match bytes.get(at) {
        Some(byte) if zeros == 0 => format!("the byte 0x{byte:X}, as in Latin-1{}", advice("LATIN1")),
        _ if 4 * zeros > bytes.len() => format!("UTF-16{}", advice("UTF-16")),
        _ => "a file of another kind".to_owned(),
    };
    let message = format!("expected text in UTF-8, got {got}");
    Err(SceneError::Syntax { file: Some(name.to_owned()), line: Some(line), message })
}

fn check_size(bytes: u64) -> Result<(), String> {
    let refusal = || format!("{bytes} bytes, more than the {MAX_FILE_BYTES} a scene may have");
    if bytes > MAX_FILE_BYTES { Err(refusal()) } else { Ok(()) }
}

fn unreadable(path: &Path, reason: &str) -> SceneError {
    let built_in = registry::BUILT_IN.iter().map(|b| b.id).collect::<Vec<_>>().join(", ");
    let message = format!("{reason}; expected a scene file, or one of the built-in scenes: {built_in}");
    SceneError::Read { path: path.to_owned(), message }
}

impl Scene {
    /// Reads a scene from TOML text. Reads no other file: a scene with a mesh file needs [`Self::from_toml_in`].
    ///
    /// ```
    /// use warpbeam::{Scene, Simulation};
    ///
    /// let scene = Scene::from_toml(include_str!("../../assets/scenes/cantilever.toml"))?;
    /// assert!(Simulation::new(&scene)?.solve().is_success());
    /// assert_eq!(Scene::from_toml(&scene.to_toml()?)?, scene);
    /// let error = Scene::from_toml("name = \"Beam\"\nlength = 10.0").unwrap_err();
    /// assert!(error.to_string().contains("length"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError::Syntax`] or [`SceneError::Invalid`], with the line.
    pub fn from_toml(text: &str) -> Result<Self, SceneError> {
        parse(text, None, None, &[])
    }

    /// Reads a scene from TOML text, and its mesh file, if it names one, from `folder`.
    ///
    /// # Errors
    /// [`SceneError::Syntax`] or [`SceneError::Invalid`], with the line.
    pub fn from_toml_in(text: &str, folder: &Path) -> Result<Self, SceneError> {
        parse(text, None, Some(folder), &[])
    }
}

fn read(path: &Path) -> Result<Vec<u8>, String> {
    let metadata = std::fs::metadata(path).map_err(|e| e.to_string())?;
    if !metadata.is_file() {
        return Err("not a file".to_owned());
    }
    check_size(metadata.len())?;
    std::fs::read(path).map_err(|e| e.to_string())
}

/// Reads a scene from the text of `file`, applies assignments, and reads its mesh from `folder`.
fn parse(text: &str, file: Option<&Path>, folder: Option<&Path>, assignments: &[String]) -> Result<Scene, SceneError> {
    let plain = units::plain(text, str::to_owned).map_err(|invalid| located(text, file, invalid))?;
    // The plain text has the same lines as the file.
    let text = plain.as_ref();
    let syntax = |e: toml::de::Error| {
        let (file, line) = (file.map(Path::to_owned), e.span().map(|span| line_of(text, span.start)));
        SceneError::Syntax { file, line, message: syntax_message(text, &e) }
    };
    let mut table: Table = toml::from_str(text).map_err(syntax)?;
    check(&table).map_err(|invalid| located(text, file, invalid))?;
    check_required(&table).map_err(|invalid| {
        let line = line_of_key(text, &invalid.key).or(Some(1));
        SceneError::Invalid { file: file.map(Path::to_owned), line, invalid }
    })?;
    // Read the file without assignments first, so that its own errors have lines.
    let mut scene: Scene = toml::from_str(text).map_err(syntax)?;
    for assignment in assignments {
        let failed = |message: String| SceneError::Set { assignment: assignment.clone(), message };
        let (key, value) = assign(&mut table, assignment).map_err(failed)?;
        check(&table).map_err(|invalid| {
            failed(if same_key(&key, &invalid.key) { invalid.message() } else { invalid.to_string() })
        })?;
        let parsed = check_required(&table).map_err(|invalid| invalid.to_string()).and_then(|()| {
            table.clone().try_into().map_err(|e: toml::de::Error| e.message().trim().replace('\n', ", "))
        });
        scene = parsed.map_err(|message| failed(format!("{message} (got {key} = {value})")))?;
    }
    let valid = scene.validate().and_then(|()| folder.map_or(Ok(()), |folder| read_mesh(&mut scene, folder)));
    valid.map_err(|invalid| blame(text, file, assignments, invalid))?;
    Ok(scene)
}

/// Returns the message of a syntax error in one line; a key or table that is given twice is named.
fn syntax_message(text: &str, error: &toml::de::Error) -> String {
    let message = error.message().trim().replace('\n', ", ");
    if message != "duplicate key" {
        return message;
    }
    let Some(span) = error.span() else { return message };
    let name = text.get(span.clone()).unwrap_or_default().trim();
    match text.get(..span.start).is_some_and(|before| before.trim_end().ends_with('[')) {
        true => format!("a second table [{name}]; several are written [[{name}]]"),
        false => format!("a second `{name}` in the same table"),
    }
}

/// Returns an error that names the `--set` assignment of the invalid key, or else its line.
fn blame(text: &str, file: Option<&Path>, assignments: &[String], invalid: Invalid) -> SceneError {
    let blamed = assignments.iter().rev().find(|a| a.split('=').next().is_some_and(|k| same_key(k, &invalid.key)));
    match blamed {
        Some(assignment) => SceneError::Set { assignment: assignment.clone(), message: invalid.message() },
        None => located(text, file, invalid),
    }
}

/// Returns an error with the line of the invalid key, if the key is written in the text.
fn located(text: &str, file: Option<&Path>, invalid: Invalid) -> SceneError {
    SceneError::Invalid { file: file.map(Path::to_owned), line: line_of_key(text, &invalid.key), invalid }
}

fn same_key(typed: &str, key: &str) -> bool {
    let typed = typed.trim();
    typed == key
        || typed.strip_prefix(key).is_some_and(|rest| rest.starts_with('.'))
        || key.strip_prefix(typed).is_some_and(|rest| rest.starts_with('.'))
}

/// Sets `a.0.b=value` in the table; returns the reason if the assignment cannot be applied. A value that is not TOML is
/// taken as a string, so that quotes can be left out.
fn assign(table: &mut Table, assignment: &str) -> Result<(String, Value), String> {
    let (key, text) = assignment.split_once('=').ok_or("expected PATH=VALUE")?;
    let (key, text) = (key.trim(), text.trim());
    let value = value(key, text).map_err(|invalid| invalid.message())?;
    if key.is_empty() || key.ends_with('.') {
        return Err("expected PATH=VALUE, got an empty path".to_owned());
    }
    let mut parts = key.split('.');
    let mut name = parts.next().unwrap_or_default();
    let mut place = table.entry(name).or_insert_with(|| Value::Table(Table::new()));
    for part in parts {
        place = inside(place, name, part)?;
        name = part;
    }
    *place = value.clone();
    Ok((key.to_owned(), value))
}

/// Returns the value at `part` in the value at `name`. A missing table, such as `[solver]`, is created.
fn inside<'a>(value: &'a mut Value, name: &str, part: &str) -> Result<&'a mut Value, String> {
    match value {
        Value::Table(table) => Ok(table.entry(part).or_insert_with(|| Value::Table(Table::new()))),
        Value::Array(items) => {
            let refusal = format!("expected an index below {}, got {part}", items.len());
            part.parse().ok().and_then(|index: usize| items.get_mut(index)).ok_or(refusal)
        }
        other => Err(format!("`{name}` is a {}: expected a table or a list there", other.type_str())),
    }
}

/// Parses an assigned value: TOML, or text without quotes, with numbers in any unit.
fn value(key: &str, text: &str) -> Result<Value, Invalid> {
    let typed = format!("value = {text}");
    let plain = units::plain(&typed, |name| name.replacen("value", key, 1))?;
    let read = toml::from_str::<Table>(&plain).ok();
    if let Some(value) = read.and_then(|mut t| if t.len() == 1 { t.remove("value") } else { None }) {
        return Ok(value);
    }
    let number = |text: &str| units::number_for(key, text).transpose();
    let list = text.strip_prefix('[').and_then(|text| text.strip_suffix(']'));
    if let (Some(list), Ok(Some(_))) = (list, number("0")) {
        let items = list.split(',').map(|item| Ok(number(item)?.map_or(Value::Boolean(false), Value::Float)));
        return Ok(Value::Array(items.collect::<Result<_, Invalid>>()?));
    }
    Ok(number(text)?.map_or_else(|| Value::String(text.to_owned()), Value::Float))
}

/// Returns the line of the longest prefix of `key` that is written in the file.
fn line_of_key(text: &str, key: &str) -> Option<usize> {
    let table = DeTable::parse(text).ok()?;
    let mut parts = key.split('.');
    let first = parts.next()?;
    let (written, mut value) = table.get_ref().iter().find(|(k, _)| k.get_ref() == first)?;
    let mut line = Some(line_of(text, written.span().start));
    for part in parts {
        let next = match value.get_ref() {
            DeValue::Table(table) => table.iter().find(|(k, _)| k.get_ref() == part).map(|(k, v)| (k.span().start, v)),
            DeValue::Array(items) => part.parse().ok().and_then(|i: usize| items.get(i)).map(|v| (v.span().start, v)),
            _ => None,
        };
        let Some((start, inner)) = next else { break };
        line = Some(line_of(text, start));
        value = inner;
    }
    line
}

fn line_of(text: &str, offset: usize) -> usize {
    text.bytes().take(offset).filter(|&b| b == b'\n').count() + 1
}
