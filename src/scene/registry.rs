//! The built-in scenes. Window, command line, tests and benches all iterate this list: a new scene is a file in
//! `assets/scenes` and a line here.

/// A scene that ships inside the library.
#[derive(Clone, Copy, Debug)]
pub struct BuiltIn {
    /// The name on the command line.
    pub id: &'static str,
    /// The scene file.
    pub toml: &'static str,
}

macro_rules! built_in {
    ($($id:literal),* $(,)?) => {
        &[$(BuiltIn { id: $id, toml: include_str!(concat!("../../assets/scenes/", $id, ".toml")) }),*]
    };
}

/// Every built-in scene; the first is the default.
pub const BUILT_IN: &[BuiltIn] = built_in![
    "article",
    "cantilever",
    "gravity",
    "bridge",
    "stretch",
    "shear",
    "elastica",
    "roll-up",
    "incline",
    "column",
    "cook",
    "bracket",
    "clip",
    "snap",
    "jump",
    "jelly",
    "swing",
    "flick",
    "spin",
    "sway",
    "chime",
];

/// The mesh files of built-in scenes, as the scenes name them.
const MESHES: &[(&str, &str)] = &[
    ("../meshes/cook.msh", include_str!("../../assets/meshes/cook.msh")),
    ("../meshes/bracket.msh", include_str!("../../assets/meshes/bracket.msh")),
    ("../meshes/clip.msh", include_str!("../../assets/meshes/clip.msh")),
];

/// A mesh file of a built-in scene.
pub(super) fn mesh(file: &str) -> Option<&'static str> {
    MESHES.iter().find(|(name, _)| *name == file).map(|(_, text)| *text)
}

/// The scene shown when none is named.
pub const DEFAULT: &str = "article";

/// The built-in scene of that name.
#[must_use]
pub fn find(id: &str) -> Option<&'static BuiltIn> {
    BUILT_IN.iter().find(|b| b.id == id)
}
