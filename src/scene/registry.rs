//! Built-in scenes. Window, command line, tests and benches iterate over this list: to add a scene, add a file and
//! its picture to `assets/scenes` and a line here.

/// Scene that is part of the library.
#[derive(Clone, Copy, Debug)]
pub struct BuiltIn {
    /// Name on the command line.
    pub id: &'static str,
    /// Text of the scene file.
    pub toml: &'static str,
    /// PNG file of the result, for the gallery.
    #[cfg(feature = "app")]
    pub(crate) picture: &'static [u8],
}

macro_rules! built_in {
    ($($id:literal),* $(,)?) => {
        &[$(BuiltIn {
            id: $id,
            toml: include_str!(concat!("../../assets/scenes/", $id, ".toml")),
            #[cfg(feature = "app")]
            picture: include_bytes!(concat!("../../assets/scenes/", $id, ".png")),
        }),*]
    };
}

/// Built-in scenes; the first is the default.
pub const BUILT_IN: &[BuiltIn] = built_in![
    "cantilever",
    "article",
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

/// Mesh files of built-in scenes, by the paths that the scenes use.
const MESHES: &[(&str, &str)] = &[
    ("../meshes/cook.msh", include_str!("../../assets/meshes/cook.msh")),
    ("../meshes/bracket.msh", include_str!("../../assets/meshes/bracket.msh")),
    ("../meshes/clip.msh", include_str!("../../assets/meshes/clip.msh")),
];

/// Returns the text of a mesh file of a built-in scene.
pub(crate) fn mesh(file: &str) -> Option<&'static str> {
    MESHES.iter().find(|(name, _)| *name == file).map(|(_, text)| *text)
}

/// Default scene.
pub const DEFAULT: &str = BUILT_IN[0].id;

/// Returns the built-in scene with this name.
pub fn find(id: &str) -> Option<&'static BuiltIn> {
    BUILT_IN.iter().find(|b| b.id == id)
}
