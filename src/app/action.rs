//! Actions that panel, keys and drawers request from the lab.

use crate::app::platform::IS_PAGE;
use crate::app::prelude::*;
use crate::app::view_options::Toggle;
use crate::study::path_chart::Ordinate;

/// Request from a click, a drag or a key.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Action {
    /// Open a built-in scene, or a scene file.
    Open(PathBuf),
    /// Start a scene of one's own from this one.
    New(Box<Scene>),
    /// Ask for a scene file and open it.
    OpenFile,
    Close,
    /// Open the scene's file again.
    Reload,
    /// Save the scene to its file; if it has none, show the file dialog.
    Save,
    /// Show the file dialog and save the scene to the chosen file.
    SaveAs,
    Undo,
    Redo,
    /// Close the topmost part that lies over the body.
    Escape,
    /// Change the scene; an error is shown next to the field with this label.
    Edit(&'static str, Box<Scene>),
    /// Start or stop iterating.
    ToggleRun,
    /// Make one iteration or one time step.
    Step,
    /// Show the recorded state of a motion that is closest to this time, s, and pause there.
    Scrub(f64),
    /// Show the previous recorded state, and pause there.
    Back,
    /// Show the next recorded state; after the last one, make a time step.
    Forward,
    /// Return to rest, or to the start of the motion.
    Reset,
    /// Set the playback speed, simulated seconds per second.
    Speed(f64),
    /// Fit the camera to the whole body.
    Fit,
    Toggle(Toggle),
    Color(Field),
    ToggleTheme,
    ToggleLanguage,
    /// Plot these quantities in the load curve.
    Plot(Ordinate),
    /// Save the text of a figure to a file with this extension.
    Export(&'static str, String),
    Screenshot,
    /// Copy the scene as TOML.
    Copy,
    /// Copy a link to the web page with the scene in it.
    CopyLink,
    /// Start (`true`) or cancel (`false`) the speed–accuracy study.
    Measure(bool),
    /// Show the card with this number, from 0, and load its scene.
    Card(usize),
    /// Tell the story of the first start again.
    Story,
    /// Cancel the background solve of a large model, and keep the previous model.
    Cancel,
}

impl Action {
    /// Returns the action that changes a scene, for the field with this label.
    pub(crate) fn edit(label: &'static str, scene: &Scene, change: impl FnOnce(&mut Scene)) -> Self {
        let mut scene = Box::new(scene.clone());
        change(&mut scene);
        Self::Edit(label, scene)
    }

    /// Returns `true` if the action exists here: only a web page has links.
    pub(crate) fn is_available(&self) -> bool {
        IS_PAGE || !matches!(self, Self::CopyLink)
    }
}
