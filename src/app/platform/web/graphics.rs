//! Start of the graphics device.

/// Runs `opening` while the page goes on.
pub(crate) fn open(opening: impl Future<Output = ()> + 'static) {
    wasm_bindgen_futures::spawn_local(opening);
}
