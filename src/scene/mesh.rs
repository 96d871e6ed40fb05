//! Mesh of a scene: its file and possible element types.

use std::path::Path;

use super::{ElementKind, Invalid, MeshFile, Scene, SceneError, registry};
use crate::mesh::Mesh;
use crate::sentence::Sentence;

/// Largest accepted mesh file, bytes.
const MAX_MESH_BYTES: u64 = 256 << 20;

impl Scene {
    /// Returns a rubber body whose mesh is in a Gmsh file, relative to `folder`, without supports and loads.
    ///
    /// ```
    /// use warpbeam::{ElementKind, MeshFile, Scene};
    ///
    /// let scene = Scene::mesh_file("square.msh", "tests/data")?.with_scale(0.001); // drawn in mm
    /// let MeshFile { file, element, scale, .. } = scene.mesh.as_ref().ok_or("the scene has a mesh file")?;
    /// assert_eq!((file.as_str(), *element, *scale), ("square.msh", Some(ElementKind::T3), Some(0.001)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError::Invalid`] if the file cannot be read.
    pub fn mesh_file(file: &str, folder: impl AsRef<Path>) -> Result<Self, SceneError> {
        let mesh = MeshFile { file: file.to_owned(), element: None, scale: None, text: None };
        let mut scene = Self { mesh: Some(mesh), ..Self::named(file) };
        let read = read_mesh(&mut scene, folder.as_ref());
        read.map(|()| scene).map_err(|invalid| SceneError::Invalid { file: None, line: None, invalid })
    }

    /// Returns the element types possible for the scene's mesh: all for a beam, those of the same shape for a mesh
    /// file.
    pub fn elements(&self) -> impl Iterator<Item = ElementKind> + Clone + use<> {
        let (any, own) = (self.mesh.is_none(), self.element().entry());
        ElementKind::all().filter(move |e| any || e.entry().shares_cell(own))
    }

    /// Returns the number of unknowns of the scene's mesh, including fixed ones, without meshing it: two per node, see
    /// [`Mesh::beam_nodes`] and [`Mesh::gmsh_nodes`]. 0 if the mesh is given by the caller.
    pub fn unknowns(&self) -> u64 {
        let file = |mesh: &MeshFile| mesh.text.as_deref().map_or(0, |text| Mesh::gmsh_nodes(text, self.element()));
        let nodes = self.beam.as_ref().map(Mesh::beam_nodes).or(self.mesh.as_ref().map(file));
        nodes.unwrap_or(0).saturating_mul(2)
    }
}

/// Returns the mesh of a built-in scene that stands for a file that does not exist in `folder`; `None` if there is none.
pub(crate) fn built_in_mesh(file: &str, folder: &Path) -> Option<&'static str> {
    registry::mesh(file).filter(|_| !folder.join(file).is_file())
}

/// Reads the mesh file of a scene, relative to the folder of the scene file; meshes of built-in scenes are part of the
/// library.
pub(super) fn read_mesh(scene: &mut Scene, folder: &Path) -> Result<(), Invalid> {
    const KEY: &str = "mesh.file";
    let Some(mesh) = &mut scene.mesh else { return Ok(()) };
    let path = folder.join(&mesh.file);
    let text = match built_in_mesh(&mesh.file, folder) {
        Some(text) => text.to_owned(),
        None => {
            let failed = |reason: String| Invalid::new(KEY, Sentence::located(path.display().to_string(), reason));
            let size = std::fs::metadata(&path).map_err(|e| failed(e.to_string()))?.len();
            if size > MAX_MESH_BYTES {
                return Err(failed(format!("expected at most {MAX_MESH_BYTES} bytes, got {size}")));
            }
            let bytes = std::fs::read(&path).map_err(|e| failed(e.to_string()))?;
            // Only names may have other bytes than ASCII: a file that is not UTF-8 has them in Latin-1.
            String::from_utf8(bytes).unwrap_or_else(|error| error.as_bytes().iter().copied().map(char::from).collect())
        }
    };
    mesh.element = mesh.element.or_else(|| Mesh::gmsh_element(&text));
    mesh.text = Some(text.into());
    Ok(())
}
