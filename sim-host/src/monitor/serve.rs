//! The page, served with what the board says: to browsers on this machine only.
//!
//! Bytes go on as they come, as server-sent events; the page has the same decoder as [`Monitor`](super::Monitor).

use super::MonitorError;
use std::io::{self, Write};
use std::net::SocketAddr;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::thread;
use std::time::{Duration, Instant};
use tiny_http::{Header, Request, Response, StatusCode};

/// Pieces that wait for a browser that does not read; one that is further behind is let go, and has to come again.
const WAITING: usize = 10_000;
/// A browser that hears nothing for so long hears that nothing is said.
const QUIET: Duration = Duration::from_secs(5);
/// One that does not read is not waited for longer than this at the end.
const FAREWELL: Duration = Duration::from_millis(500);
/// After the page's first `<head>`: by this it knows that there is a board to listen to.
const MARK: (&[u8], &[u8]) = (b"<head>", b"\n<meta name=\"monitor\" content=\"board\">");

type Listeners = Arc<Mutex<Vec<SyncSender<Arc<str>>>>>;

/// A server of the page and of a board's bytes.
#[derive(Debug)]
pub struct BoardServer {
    listeners: Listeners,
    /// Held by the server, and by whoever still tells a browser something.
    telling: Arc<()>,
    address: SocketAddr,
}

impl BoardServer {
    /// Serves `page` at a port of this machine, 0 for a free one, from now on.
    ///
    /// # Errors
    /// [`MonitorError::Serve`]: the port is taken.
    pub fn start(port: u16, page: &[u8]) -> Result<Self, MonitorError> {
        let failed = |cause: String| MonitorError::Serve { port, cause };
        let server = tiny_http::Server::http((std::net::Ipv4Addr::LOCALHOST, port))
            .map_err(|cause| failed(cause.to_string()))?;
        let address = server.server_addr().to_ip();
        let address = address.ok_or_else(|| failed("no address".to_owned()))?;
        let mark = page.windows(MARK.0.len()).position(|word| word == MARK.0);
        let (head, rest) = page.split_at(mark.map_or(0, |at| at + MARK.0.len()));
        let mark = if head.is_empty() { &[] } else { MARK.1 };
        let page: Arc<[u8]> = [head, mark, rest].concat().into();
        let listeners = Listeners::default();
        let telling = Arc::new(());
        // Weak, since this thread does not end.
        let (joining, writer) = (Arc::clone(&listeners), Arc::downgrade(&telling));
        thread::spawn(move || {
            for request in server.incoming_requests() {
                answer(request, &page, &joining, &writer);
            }
        });
        Ok(Self {
            listeners,
            telling,
            address,
        })
    }

    /// Where it is.
    pub const fn address(&self) -> SocketAddr {
        self.address
    }

    /// Bytes of the board, to every browser that listens.
    pub fn send(&self, bytes: &[u8]) {
        let event = format!("data: {}\n\n", base64(bytes));
        self.say(&event);
    }

    /// The line has ended: browsers are notified, and waited for a moment.
    pub fn end(&self) {
        self.say("event: end\ndata:\n\n");
        self.lock().clear();
        let begun = Instant::now();
        while Arc::strong_count(&self.telling) > 1 && begun.elapsed() < FAREWELL {
            thread::sleep(Duration::from_millis(1));
        }
    }

    /// Browsers that listen.
    pub fn listeners(&self) -> usize {
        self.lock().len()
    }

    fn say(&self, event: &str) {
        let event: Arc<str> = event.into();
        self.lock()
            .retain(|listener| listener.try_send(Arc::clone(&event)).is_ok());
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Vec<SyncSender<Arc<str>>>> {
        // A list of senders is whole whatever somebody did with it.
        self.listeners
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
    }
}

/// Answers a request. A browser that has gone is no error.
fn answer(request: Request, page: &[u8], listeners: &Listeners, telling: &Weak<()>) {
    let local = request.headers().iter().any(|header| {
        let host = header.value.as_str();
        let name = host.rsplit_once(':').map_or(host, |(name, _)| name);
        header.field.equiv("Host") && matches!(name, "127.0.0.1" | "localhost")
    });
    if !local {
        // Another site's name that leads here: its scripts would read the board.
        let _ = request.respond(Response::empty(StatusCode(403)));
        return;
    }
    match request.url() {
        "/" | "/index.html" => {
            // The page says itself how its letters are encoded.
            let kind = Header::from_bytes("Content-Type", "text/html");
            let mut response = Response::from_data(page);
            if let Ok(kind) = kind {
                response.add_header(kind);
            }
            let _ = request.respond(response);
        }
        "/events" => {
            let (sender, receiver) = sync_channel(WAITING);
            listeners
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .push(sender);
            let (writer, telling) = (request.into_writer(), telling.upgrade());
            thread::spawn(move || {
                // A browser that has gone ends it.
                let _ = tell(writer, &receiver);
                drop(telling);
            });
        }
        _ => {
            let _ = request.respond(Response::empty(StatusCode(404)));
        }
    }
}

/// Every event at once: a response of the library's own would gather 8 kB of them.
fn tell(mut writer: Box<dyn Write + Send>, events: &Receiver<Arc<str>>) -> io::Result<()> {
    writer.write_all(
        b"HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\nCache-Control: no-store\r\nConnection: close\r\n\r\n",
    )?;
    writer.flush()?;
    loop {
        match events.recv_timeout(QUIET) {
            Ok(event) => writer.write_all(event.as_bytes())?,
            Err(RecvTimeoutError::Timeout) => writer.write_all(b": quiet\n\n")?,
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        }
        writer.flush()?;
    }
}

/// As of RFC 4648, section 4.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let word = three.iter().enumerate().fold(0_u32, |word, (n, byte)| {
            word | u32::from(*byte) << (16 - 8 * n)
        });
        for digit in 0..4 {
            let value = word >> (18 - 6 * digit) & 63;
            text.push(if digit <= three.len() {
                DIGITS[value as usize].into()
            } else {
                '='
            });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::base64;

    /// The examples of RFC 4648, section 10.
    #[test]
    fn base64_is_that_of_its_standard() {
        for (bytes, text) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }
}
