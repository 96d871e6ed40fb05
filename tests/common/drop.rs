//! Drops a file on a window, as the source of X's drag and drop protocol (XDND 5).

use std::path::Path;
use std::time::{Duration, Instant};

use x11rb::COPY_DEPTH_FROM_PARENT;
use x11rb::connection::Connection;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    ClientMessageEvent, ConnectionExt, CreateWindowAux, EventMask, PropMode, SELECTION_NOTIFY_EVENT,
    SelectionNotifyEvent, WindowClass,
};
use x11rb::wrapper::ConnectionExt as _;

x11rb::atom_manager! {
    Atoms: AtomsCookie {
        XdndSelection, XdndEnter, XdndPosition, XdndStatus, XdndDrop, XdndFinished, XdndActionCopy,
        UriList: b"text/uri-list",
    }
}

/// Drops a file on a window of a display, and waits until the window's program has taken it.
pub fn drop_file(display: &str, window: u32, file: &Path, patience: Duration) {
    const VERSION: u32 = 5;
    let (connection, screen) = x11rb::connect(Some(display)).unwrap();
    let root = connection.setup().roots[screen].root;
    let atoms = Atoms::new(&connection).unwrap().reply().unwrap();
    let source = connection.generate_id().unwrap();
    let (depth, class) = (COPY_DEPTH_FROM_PARENT, WindowClass::INPUT_OUTPUT);
    connection.create_window(depth, source, root, 0, 0, 1, 1, 0, class, 0, &CreateWindowAux::new()).unwrap();
    connection.set_selection_owner(source, atoms.XdndSelection, x11rb::CURRENT_TIME).unwrap();
    let tell = |message, data: [u32; 5]| {
        let event = ClientMessageEvent::new(32, window, message, data);
        connection.send_event(false, window, EventMask::NO_EVENT, event).unwrap();
        connection.flush().unwrap();
    };
    tell(atoms.XdndEnter, [source, VERSION << 24, atoms.UriList, 0, 0]);
    tell(atoms.XdndPosition, [source, 0, 400 << 16 | 300, x11rb::CURRENT_TIME, atoms.XdndActionCopy]);
    let start = Instant::now();
    loop {
        assert!(start.elapsed() < patience, "nobody takes the file");
        match connection.poll_for_event().unwrap() {
            Some(Event::SelectionRequest(request)) => {
                let uri = format!("file://{}\r\n", file.display());
                connection
                    .change_property8(
                        PropMode::REPLACE,
                        request.requestor,
                        request.property,
                        request.target,
                        uri.as_bytes(),
                    )
                    .unwrap();
                let answer = SelectionNotifyEvent {
                    response_type: SELECTION_NOTIFY_EVENT,
                    sequence: 0,
                    time: request.time,
                    requestor: request.requestor,
                    selection: request.selection,
                    target: request.target,
                    property: request.property,
                };
                connection.send_event(false, request.requestor, EventMask::NO_EVENT, answer).unwrap();
                connection.flush().unwrap();
            }
            Some(Event::ClientMessage(message)) if message.type_ == atoms.XdndStatus => {
                assert_eq!(message.data.as_data32()[1] & 1, 1, "the window takes no files");
                tell(atoms.XdndDrop, [source, 0, x11rb::CURRENT_TIME, 0, 0]);
            }
            Some(Event::ClientMessage(message)) if message.type_ == atoms.XdndFinished => return,
            Some(_) => {}
            None => std::thread::sleep(Duration::from_millis(20)),
        }
    }
}
