//! Background work in threads.

use std::io;
use std::thread;

/// Starts `work` in a thread.
///
/// # Errors
/// The system cannot start another thread.
pub(crate) fn start(name: &str, work: impl FnOnce() + Send + 'static) -> io::Result<()> {
    thread::Builder::new().name(name.to_owned()).spawn(work).map(drop)
}

/// Worker of a web page: on a desktop there is none.
#[derive(Debug)]
pub(crate) enum Worker {}

impl Worker {
    /// Ends the work.
    pub(crate) fn end(&self) {
        match *self {}
    }
}
