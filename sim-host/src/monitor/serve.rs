//! The page, served with what the board says: to browsers on this machine only.
//!
//! Bytes go on as they come, as server-sent events; the page has the same decoder as [`Monitor`](super::Monitor).
//!
//! A request is answered on a thread of its own, within a time, and is the only one of its connection; a body is nowhere
//! asked for. So nothing that a client does or leaves keeps another one waiting.

use super::MonitorError;
use std::collections::VecDeque;
use std::io::{self, BufRead as _, BufReader, Read, Write};
use std::net::{Ipv4Addr, Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::thread;
use std::time::{Duration, Instant};

/// Pieces that wait for a browser that does not read; one that is further behind is let go, and has to come again.
const WAITING: usize = 10_000;
/// A browser that hears nothing for so long hears that nothing is said.
const QUIET: Duration = Duration::from_secs(5);
/// A client has so long to say what it wants and to take it, and for each event.
const PATIENCE: Duration = Duration::from_secs(5);
/// Longest head of a request \[bytes\].
const HEAD: u64 = 1 << 14;
/// Connections at once, listeners among them; for a further one the oldest gives way.
const CONNECTIONS: usize = 256;
/// Where the system takes no connection, it is asked again after so long.
const PAUSE: Duration = Duration::from_millis(20);
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
        let failed = |cause: io::Error| MonitorError::Serve {
            port,
            cause: cause.to_string(),
        };
        let server = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(failed)?;
        let address = server.local_addr().map_err(failed)?;
        let mark = page.windows(MARK.0.len()).position(|word| word == MARK.0);
        let (head, rest) = page.split_at(mark.map_or(0, |at| at + MARK.0.len()));
        let mark = if head.is_empty() { &[] } else { MARK.1 };
        let page: Arc<[u8]> = [head, mark, rest].concat().into();
        let listeners = Listeners::default();
        let telling = Arc::new(());
        // Weak, since this thread does not end.
        let (joining, writer) = (Arc::clone(&listeners), Arc::downgrade(&telling));
        thread::spawn(move || {
            // Of those that are answered, the oldest first.
            let mut open = VecDeque::<Weak<TcpStream>>::new();
            loop {
                let Ok((line, _)) = server.accept() else {
                    thread::sleep(PAUSE);
                    continue;
                };
                open.retain(|line| line.strong_count() > 0);
                // Those that gave way need their time to end.
                if open.len() >= 2 * CONNECTIONS {
                    continue;
                }
                let most = open.len().saturating_sub(CONNECTIONS - 1);
                for old in open.iter().take(most).filter_map(Weak::upgrade) {
                    // One that has gone by itself is no error.
                    let _ = old.shutdown(Shutdown::Both);
                }
                let line = Arc::new(line);
                open.push_back(Arc::downgrade(&line));
                let (page, joining) = (Arc::clone(&page), Arc::clone(&joining));
                let writer = writer.clone();
                // Without a thread for it, it is closed as well.
                let _ = thread::Builder::new().spawn(move || {
                    // A client that has gone, or is not waited for any longer, is no error.
                    let _ = answer(line, &page, &joining, &writer);
                });
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

/// A connection until an instant, after which reading and writing fail.
struct Until(Arc<TcpStream>, Instant);

impl Until {
    /// Zero, which is no timeout, fails as well.
    fn left(&self) -> Option<Duration> {
        Some(self.1.saturating_duration_since(Instant::now()))
    }
}

impl Read for Until {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.0.set_read_timeout(self.left())?;
        (&*self.0).read(bytes)
    }
}

impl Write for Until {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.set_write_timeout(self.left())?;
        (&*self.0).write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        (&*self.0).flush()
    }
}

/// Answers the first request of a connection, and ends it.
fn answer(
    line: Arc<TcpStream>,
    page: &[u8],
    listeners: &Listeners,
    telling: &Weak<()>,
) -> io::Result<()> {
    let mut line = Until(line, Instant::now() + PATIENCE);
    let mut head = BufReader::new((&mut line).take(HEAD)).lines();
    let asked = head.next().unwrap_or(Ok(String::new()))?;
    let mut local = false;
    loop {
        let header = head.next().ok_or(io::ErrorKind::UnexpectedEof)??;
        if header.is_empty() {
            break;
        }
        let (field, host) = header.split_once(':').unwrap_or_default();
        let host = host.trim();
        let name = host.rsplit_once(':').map_or(host, |(name, _)| name);
        local |= field.eq_ignore_ascii_case("Host") && matches!(name, "127.0.0.1" | "localhost");
    }
    let mut words = asked.split(' ');
    let (status, body): (_, &[u8]) = match (words.next(), words.next()) {
        // Another site's name that leads here: its scripts would read the board.
        _ if !local => ("403 Forbidden", &[]),
        (Some("GET"), Some("/" | "/index.html")) => ("200 OK", page),
        (Some("GET"), Some("/events")) => {
            let (sender, receiver) = sync_channel(WAITING);
            let telling = telling.upgrade();
            listeners
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .push(sender);
            let told = tell(line, &receiver);
            drop(telling);
            return told;
        }
        (Some("GET"), _) => ("404 Not Found", &[]),
        _ => ("405 Method Not Allowed", &[]),
    };
    // The page says itself how its letters are encoded.
    write!(
        line,
        "HTTP/1.1 {status}\r\nContent-Type: text/html\r\nContent-Length: {}\r\nConnection: close\r\n\r\n",
        body.len()
    )?;
    line.write_all(body)?;
    line.0.shutdown(Shutdown::Write)?;
    // Closed with something unread, the connection would be reset, and the answer lost with it.
    io::copy(&mut line, &mut io::sink())?;
    Ok(())
}

/// Every event as it comes, and each within its time.
fn tell(mut line: Until, events: &Receiver<Arc<str>>) -> io::Result<()> {
    line.0.set_nodelay(true)?;
    line.write_all(
        b"HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\nCache-Control: no-store\r\nConnection: close\r\n\r\n",
    )?;
    loop {
        let event = events.recv_timeout(QUIET);
        line.1 = Instant::now() + PATIENCE;
        match event {
            Ok(event) => line.write_all(event.as_bytes())?,
            Err(RecvTimeoutError::Timeout) => line.write_all(b": quiet\n\n")?,
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        }
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
