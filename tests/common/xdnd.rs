//! Dropping a file on a window, as a file manager does: version 5 of the protocol of drag and drop between X clients (XDND).

use std::path::Path;
use std::time::{Duration, Instant};

use x11rb::connection::Connection;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    Atom, ClientMessageEvent, ConnectionExt, CreateWindowAux, EventMask, PropMode, SELECTION_NOTIFY_EVENT,
    SelectionNotifyEvent, SelectionRequestEvent, Window, WindowClass,
};
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;

/// How long the window may take for an answer.
const PATIENCE: Duration = Duration::from_secs(60);

/// The client that drops.
struct Source {
    connection: RustConnection,
    window: Window,
}

impl Source {
    fn atom(&self, name: &str) -> Atom {
        self.connection.intern_atom(false, name.as_bytes()).unwrap().reply().unwrap().atom
    }

    fn send(&self, target: Window, kind: &str, data: [u32; 5]) {
        let event = ClientMessageEvent::new(32, target, self.atom(kind), data);
        self.connection.send_event(false, target, EventMask::NO_EVENT, event).unwrap();
        self.connection.flush().unwrap();
    }

    /// Hands over the file's address to whoever asks, until the target sends this message.
    fn answers_until(&self, kind: &str, uris: &str) -> [u32; 5] {
        let (awaited, began) = (self.atom(kind), Instant::now());
        while began.elapsed() < PATIENCE {
            match self.connection.poll_for_event().unwrap() {
                Some(Event::SelectionRequest(request)) => self.hand_over(&request, uris),
                Some(Event::ClientMessage(message)) if message.type_ == awaited => return message.data.as_data32(),
                Some(_) => {}
                None => std::thread::sleep(Duration::from_millis(5)),
            }
        }
        panic!("the window sends no {kind}");
    }

    fn hand_over(&self, request: &SelectionRequestEvent, uris: &str) {
        let SelectionRequestEvent { requestor, property, target, selection, time, .. } = *request;
        self.connection.change_property8(PropMode::REPLACE, requestor, property, target, uris.as_bytes()).unwrap();
        let response_type = SELECTION_NOTIFY_EVENT;
        let event = SelectionNotifyEvent { response_type, sequence: 0, time, requestor, selection, target, property };
        self.connection.send_event(false, requestor, EventMask::NO_EVENT, event).unwrap();
        self.connection.flush().unwrap();
    }
}

/// Drops a file on a window.
pub fn drop_file(display: &str, target: Window, file: &Path) {
    let (connection, screen) = x11rb::connect(Some(display)).unwrap();
    let window = connection.generate_id().unwrap();
    let root = connection.setup().roots[screen].root;
    let aux = CreateWindowAux::new();
    connection.create_window(0, window, root, 0, 0, 1, 1, 0, WindowClass::INPUT_ONLY, 0, &aux).unwrap();
    let source = Source { connection, window };
    let [selection, list, copy] = ["XdndSelection", "text/uri-list", "XdndActionCopy"].map(|name| source.atom(name));
    source.connection.set_selection_owner(source.window, selection, 0u32).unwrap();
    let uris = format!("file://{}\r\n", file.display());
    source.send(target, "XdndEnter", [source.window, 5 << 24, list, 0, 0]);
    source.send(target, "XdndPosition", [source.window, 0, 300 << 16 | 300, 0, copy]);
    let status = source.answers_until("XdndStatus", &uris);
    assert_eq!(status[1] & 1, 1, "the window takes no file");
    source.send(target, "XdndDrop", [source.window, 0, 0, 0, 0]);
    source.answers_until("XdndFinished", &uris);
}
