//! Background work on a page. Every worker has its own instance of the module, receives requests and sends results as
//! data. Work that is not data is done between two frames.

use std::cell::RefCell;
use std::io;
use std::rc::Rc;

use serde::Serialize;
use serde::de::DeserializeOwned;
use wasm_bindgen::prelude::*;
use web_sys::{DedicatedWorkerGlobalScope, MessageEvent, WorkerOptions, WorkerType};

use crate::app::platform::web;

/// Largest number of workers that wait for a request. Each keeps the most memory that it has used.
const MAX_IDLE: usize = 2;

thread_local! {
    /// Workers that wait for a request.
    static IDLE: RefCell<Vec<web_sys::Worker>> = RefCell::default();
}

/// Starts `work` after the current frame.
pub(crate) fn start(_: &str, work: impl FnOnce() + Send + 'static) -> io::Result<()> {
    web::later(&Closure::once_into_js(work), 0);
    Ok(())
}

/// Returns data as bytes (CBOR).
pub(crate) fn encode<T: Serialize>(data: &T) -> Vec<u8> {
    let mut bytes = Vec::new();
    match ciborium::into_writer(data, &mut bytes) {
        Ok(()) => bytes,
        // The receiver refuses an empty message.
        Err(_) => Vec::new(),
    }
}

/// Returns the data of bytes; `None` if they are not of this type.
pub(crate) fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Option<T> {
    ciborium::from_reader(bytes).inspect_err(|error| log::error!("message of a worker: {error}")).ok()
}

/// State of a request after a message of its worker.
pub(crate) enum Received {
    /// More messages follow.
    Progress,
    Done,
    /// The message cannot be read, and the worker is ended.
    Unreadable,
}

/// Receiver of the messages of a worker.
type Receive = Rc<RefCell<Option<Box<dyn FnMut(&[u8]) -> Received>>>>;

/// Worker with a request. Dropping it cancels the request.
pub(crate) struct Worker {
    /// `None` once the request is done or has failed.
    worker: Rc<RefCell<Option<web_sys::Worker>>>,
    receive: Receive,
    _message: Closure<dyn FnMut(MessageEvent)>,
    _error: Closure<dyn FnMut(JsValue)>,
}

/// Ends the work of a worker: it ends at once, without a result.
pub(crate) fn end(worker: &Worker) {
    worker.worker.take().iter().for_each(web_sys::Worker::terminate);
    // Without a receiver the task is known to have ended.
    worker.receive.take();
}

impl Drop for Worker {
    fn drop(&mut self) {
        end(self);
    }
}

/// Sends a request to a worker; `receive` is called with its messages.
pub(crate) fn send(name: &str, request: &[u8], receive: impl FnMut(&[u8]) -> Received + 'static) -> io::Result<Worker> {
    let failed = |error: JsValue| io::Error::other(web::message(&error));
    let own = match IDLE.with_borrow_mut(Vec::pop) {
        Some(worker) => worker,
        None => create().map_err(failed)?,
    };
    let worker = Rc::new(RefCell::new(Some(own.clone())));
    let receive: Receive = Rc::new(RefCell::new(Some(Box::new(receive))));
    let message = {
        let (worker, receive) = (worker.clone(), receive.clone());
        Closure::<dyn FnMut(MessageEvent)>::new(move |event: MessageEvent| {
            let bytes = js_sys::Uint8Array::new(&event.data()).to_vec();
            let received = receive.borrow_mut().as_mut().map_or(Received::Done, |receive| receive(&bytes));
            let close: fn(&web_sys::Worker) = match received {
                Received::Progress => return web::wake(),
                Received::Done => rest,
                Received::Unreadable => web_sys::Worker::terminate,
            };
            receive.take();
            worker.take().iter().for_each(close);
            web::wake();
        })
    };
    let error = {
        let (worker, receive) = (worker.clone(), receive.clone());
        Closure::<dyn FnMut(JsValue)>::new(move |event: JsValue| {
            // A worker whose module cannot be loaded fails with an event without a message.
            let message = js_sys::Reflect::get(&event, &"message".into()).ok().and_then(|text| text.as_string());
            log::error!("a worker failed: {}", message.unwrap_or_default());
            worker.take().iter().for_each(web_sys::Worker::terminate);
            receive.take();
            web::wake();
        })
    };
    own.set_onmessage(Some(message.as_ref().unchecked_ref()));
    own.set_onerror(Some(error.as_ref().unchecked_ref()));
    let request = js_sys::Array::of2(&name.into(), &js_sys::Uint8Array::from(request));
    own.post_message(&request).inspect_err(|_| own.terminate()).map_err(failed)?;
    Ok(Worker { worker, receive, _message: message, _error: error })
}

/// Keeps a worker for another request, or ends it if enough are kept.
fn rest(worker: &web_sys::Worker) {
    worker.set_onmessage(None);
    worker.set_onerror(None);
    IDLE.with_borrow_mut(|idle| {
        if idle.len() < MAX_IDLE {
            idle.push(worker.clone());
        } else {
            worker.terminate();
        }
    });
}

/// Starts a worker with the module of this page.
fn create() -> Result<web_sys::Worker, JsValue> {
    let options = WorkerOptions::new();
    options.set_type(WorkerType::Module);
    let worker = web_sys::Worker::new_with_options("worker.js", &options)?;
    worker.post_message(&wasm_bindgen::module())?;
    Ok(worker)
}

/// Waits for requests in a worker: `serve` receives their names and their data.
pub(crate) fn listen(serve: fn(&str, &[u8])) {
    let work =
        Closure::<dyn FnMut(String, js_sys::Uint8Array)>::new(move |name: String, request: js_sys::Uint8Array| {
            serve(&name, &request.to_vec());
        });
    let _ = js_sys::Reflect::set(&js_sys::global(), &"warpbeam_work".into(), work.as_ref());
    // It lives as long as the worker.
    work.forget();
}

/// Sends a message from a worker to its page.
pub(crate) fn post(bytes: &[u8]) {
    if let Ok(worker) = js_sys::global().dyn_into::<DedicatedWorkerGlobalScope>() {
        let _ = worker.post_message(&js_sys::Uint8Array::from(bytes));
    }
}
