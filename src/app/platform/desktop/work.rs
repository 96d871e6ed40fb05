//! Background work in threads.

/// Worker of a web page: on a desktop there is none.
pub(crate) use std::convert::Infallible as Worker;
use std::io;
use std::thread;

/// Starts `work` in a thread.
pub(crate) fn start(name: &str, work: impl FnOnce() + Send + 'static) -> io::Result<()> {
    thread::Builder::new().name(name.to_owned()).spawn(work).map(drop)
}

/// Ends the work of a worker of a web page.
pub(crate) fn end(worker: &Worker) {
    match *worker {}
}
