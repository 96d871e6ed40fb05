//! Files that a user chooses or drops on the page, and downloads. A page has no folder: files are known by their names.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::{JsFuture, spawn_local};
use web_sys::{Blob, File, FileList, HtmlAnchorElement, HtmlInputElement, Url};

use crate::app::platform::web;
use crate::mesh::Mesh;
use crate::model::Invalid;
use crate::scene::{self, Scene, SceneError, Source};
use crate::sentence::sentence;

thread_local! {
    /// Text of each file received from the user, by its name.
    static TEXTS: RefCell<BTreeMap<String, String>> = RefCell::default();
    /// Scene file to be opened next.
    static ARRIVED: RefCell<Option<PathBuf>> = RefCell::default();
}

/// Opens a built-in scene, or a scene file that the user has chosen, with its mesh file.
pub(crate) fn open(source: &Source) -> Result<Scene, SceneError> {
    let Some(toml) = chosen(source) else { return scene::open(source) };
    let mut scene = Scene::from_toml(&toml)?;
    let Some(mesh) = &mut scene.mesh else { return Ok(scene) };
    let name = Path::new(&mesh.file).file_name().and_then(|name| name.to_str()).unwrap_or_default();
    let Some(read) = stored(name) else {
        // The meshes of the built-in scenes are part of the library.
        let file = mesh.file.as_str();
        let message = sentence!("%{file}: expected the mesh file together with its scene file", file);
        let invalid = Invalid::new("mesh.file", message);
        let missing = SceneError::Invalid { file: Some(source.name.clone()), line: None, invalid };
        return Scene::from_toml_in(&toml, Path::new("")).map_err(|_| missing);
    };
    mesh.element = mesh.element.or_else(|| Mesh::gmsh_element(&read));
    mesh.text = Some(read.into());
    Ok(scene)
}

fn stored(name: &str) -> Option<String> {
    TEXTS.with_borrow(|texts| texts.get(name).cloned())
}

/// Returns the text of a scene file that the user has chosen.
fn chosen(source: &Source) -> Option<String> {
    source.name.to_str().and_then(stored).filter(|_| source.built_in().is_none())
}

pub(crate) fn text(source: &Source) -> Option<String> {
    chosen(source).or_else(|| source.text().ok())
}

/// Adds the text of a scene that came with the page's address, and returns its name.
pub(crate) fn add(name: &str, text: String) -> PathBuf {
    TEXTS.with_borrow_mut(|texts| texts.insert(name.to_owned(), text));
    PathBuf::from(name)
}

/// Offers a file as a download.
pub(crate) fn save(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or("warpbeam");
    if let Some(text) = str::from_utf8(bytes).ok().filter(|_| name.ends_with(".toml")) {
        // A saved scene can be opened again.
        add(name, text.to_owned());
    }
    let parts = js_sys::Array::of1(&js_sys::Uint8Array::from(bytes));
    let blob = Blob::new_with_u8_array_sequence(&parts);
    blob.and_then(|blob| download(name, &blob)).map_err(|error| std::io::Error::other(web::message(&error)))
}

/// Offers data as a download.
pub(super) fn download(name: &str, data: &Blob) -> Result<(), JsValue> {
    let document = web::document().ok_or("no document")?;
    let address = Url::create_object_url_with_blob(data)?;
    let link: HtmlAnchorElement = document.create_element("a")?.dyn_into()?;
    link.set_href(&address);
    link.set_download(name);
    link.click();
    // The download begins after this event; its address is needed until then.
    let revoke = Closure::once_into_js(move || drop(Url::revoke_object_url(&address)));
    web::later(&revoke, 10_000);
    Ok(())
}

/// Asks the browser for scene files.
pub(crate) fn choose() {
    let Some(document) = web::document() else { return };
    let input = document.create_element("input").ok().and_then(|input| input.dyn_into::<HtmlInputElement>().ok());
    let Some(input) = input else { return };
    input.set_type("file");
    input.set_multiple(true);
    input.set_accept(".toml,.msh");
    let own = input.clone();
    let chosen = Closure::once_into_js(move || own.files().iter().for_each(receive));
    input.set_onchange(Some(chosen.unchecked_ref()));
    input.click();
}

/// Reads chosen or dropped files; the first scene file among them is opened.
pub(super) fn receive(list: &FileList) {
    let files: Vec<File> = (0..list.length()).filter_map(|i| list.get(i)).collect();
    spawn_local(async move {
        let mut scene = None;
        for file in files {
            let name = file.name();
            let Some(text) = JsFuture::from(file.text()).await.ok().and_then(|text| text.as_string()) else { continue };
            if scene.is_none() && name.ends_with(".toml") {
                scene = Some(PathBuf::from(&name));
            }
            TEXTS.with_borrow_mut(|texts| texts.insert(name, text));
        }
        ARRIVED.set(scene);
        web::wake();
    });
}

/// Returns a file chosen in the browser or dropped on the page.
pub(crate) fn arrived() -> Option<PathBuf> {
    ARRIVED.take()
}

/// Name of a download. A page has no folder: the browser changes a name that is taken.
pub(crate) struct NewFile(PathBuf);

impl NewFile {
    /// Returns the name of a download.
    pub(crate) fn create(_: &Path, extension: &str) -> std::io::Result<Self> {
        Ok(Self(format!("warpbeam-001.{extension}").into()))
    }

    pub(crate) fn path(&self) -> &Path {
        &self.0
    }
}
