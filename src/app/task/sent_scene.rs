//! Scene that can be sent to a worker of a web page.

use serde::{Deserialize, Serialize};

use crate::mesh::Mesh;
use crate::scene::{Scene, SceneError};

/// Scene that can be sent as data.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(into = "SceneParts", try_from = "SceneParts")]
pub(crate) struct SentScene(pub Scene);

/// Text of a scene, and of its mesh file.
#[derive(Serialize, Deserialize)]
struct SceneParts {
    toml: String,
    mesh: Option<String>,
}

impl From<SentScene> for SceneParts {
    fn from(SentScene(scene): SentScene) -> Self {
        let mesh = scene.mesh.as_ref().and_then(|mesh| mesh.text.as_deref()).map(str::to_owned);
        // A scene that cannot be written gives an empty text, which the receiver refuses.
        Self { toml: scene.to_toml().unwrap_or_default(), mesh }
    }
}

impl TryFrom<SceneParts> for SentScene {
    type Error = SceneError;

    fn try_from(SceneParts { toml, mesh: text }: SceneParts) -> Result<Self, SceneError> {
        let mut scene = Scene::from_toml(&toml)?;
        if let (Some(mesh), Some(text)) = (&mut scene.mesh, text) {
            mesh.element = mesh.element.or_else(|| Mesh::gmsh_element(&text));
            mesh.text = Some(text.into());
        }
        Ok(Self(scene))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Source, open, registry};

    /// Every built-in scene, with its mesh, arrives as it was sent.
    #[test]
    fn a_sent_scene_arrives_unchanged() {
        for built_in in registry::BUILT_IN {
            let scene = open(&Source { name: built_in.id.into(), assignments: Vec::new() }).unwrap();
            let parts = SceneParts::from(SentScene(scene.clone()));
            assert_eq!(SentScene::try_from(parts).unwrap().0, scene, "{}", built_in.id);
        }
    }
}
