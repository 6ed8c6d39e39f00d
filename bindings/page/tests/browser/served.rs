//! A board played on a pseudo-terminal, watched through the server of `sim-host monitor --serve`.

use super::chromium::Chromium;
use super::{one_at_a_time, page};
use controller_core::safety::supervisor::State;
use protocol::{BaseTick, MAX_FRAME, Telemetry, WireAction, encode, tick_flags};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use serde_json::json;
use sim_host::monitor::{BoardServer, Port, Received};
use std::fs::File;
use std::io::{Read as _, Write};
use std::net::TcpStream;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

fn terminal() -> (File, PathBuf) {
    let board = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).expect("a terminal");
    grantpt(&board).expect("granted");
    unlockpt(&board).expect("unlocked");
    let path = ptsname(&board, Vec::new()).expect("a name");
    let path = PathBuf::from(path.into_string().expect("a path"));
    (File::from(board), path)
}

/// What a base says that drives in a circle.
fn frame(tick: u32) -> Vec<u8> {
    let angle = 1.0e-4 * tick as f32;
    let report = BaseTick {
        tick,
        state: State::Tracking,
        action: WireAction::Drive,
        flags: tick_flags::LAW,
        x: angle.sin(),
        y: 1.0 - angle.cos(),
        theta: angle,
        v: 0.1,
        v_c: 0.1,
        tau_right: 0.3,
        tau_left: 0.2,
        ..BaseTick::default()
    };
    let mut out = [0; MAX_FRAME];
    let frame = encode(tick as u16, &Telemetry::Tick(report), &mut out).expect("fits");
    frame.to_vec()
}

/// Reports of a board in 60 s at 100 a second, as a line of 115,200 baud takes them.
const REPORTS: u32 = 6000;
/// Of these each is waited for.
const SINGLE: u32 = 40;

/// 60 s of reports, played in 12 s: five times as dense as on a line, and each of them is counted.
#[test]
fn a_served_board_shows_within_0_2_s_and_no_report_of_60_s_is_lost() {
    let _turn = one_at_a_time();
    let (mut board, path) = terminal();
    let html = std::fs::read(page()).expect("the page");
    let server = BoardServer::start(0, &html).expect("a server");
    let mut port = Port::open(&path, 115_200).expect("a port");
    let mut browser = Chromium::open(1280, 800, false);
    browser.go(&format!("http://{}/", server.address()));
    browser.until("board.on");
    while server.listeners() == 0 {
        thread::sleep(Duration::from_millis(5));
    }
    static DONE: AtomicBool = AtomicBool::new(false);
    /// Also after a panic: the reader is waited for.
    struct Ends;
    impl Drop for Ends {
        fn drop(&mut self) {
            DONE.store(true, Ordering::Relaxed);
        }
    }
    thread::scope(|scope| {
        let server = &server;
        scope.spawn(move || {
            // As the command does: whatever comes goes on at once.
            let mut buffer = [0; 4096];
            while !DONE.load(Ordering::Relaxed) {
                match port.receive(&mut buffer, Duration::from_millis(50)) {
                    Ok(Received::Bytes(count)) => server.send(&buffer[..count]),
                    Ok(_) => {}
                    Err(error) => panic!("{error}"),
                }
            }
        });
        let _ends = Ends;
        // One at a time, from the board's end of the line until the page has drawn it, by the same clock. A machine that does
        // something else meanwhile delays some of them.
        let mut delays = Vec::new();
        for tick in 0..SINGLE {
            let begun = SystemTime::now();
            board.write_all(&frame(tick)).expect("written");
            browser.until(&format!("board.reports === {} && !touched", tick + 1));
            let drawn_ms = browser.number("board.drawn");
            let begun = begun.duration_since(UNIX_EPOCH).expect("after 1970");
            delays.push(1.0e-3 * drawn_ms - begun.as_secs_f64());
        }
        delays.sort_by(f64::total_cmp);
        let (usual, most, slowest) = (delays[20], delays[38], delays[39]);
        println!(
            "a report shows after {usual:.3} s, 95 % within {most:.3}, all within {slowest:.3} s"
        );
        assert!(most < 0.2, "{most} s");
        let begun = Instant::now();
        for tick in SINGLE..REPORTS {
            let due = Duration::from_millis(2) * (tick - SINGLE);
            thread::sleep(due.saturating_sub(begun.elapsed()));
            board.write_all(&frame(tick)).expect("written");
        }
        browser.until(&format!("board.reports >= {REPORTS}"));
    });
    assert_eq!(browser.number("board.reports"), f64::from(REPORTS));
    browser.until(&format!("history.rows.length === {REPORTS}"));
    // Each of them, in order.
    let in_order = browser.evaluate("history.rows.every((row, n) => row.tick === n)");
    assert_eq!(in_order, json!(true));
    let shown = browser.evaluate("[$('state').textContent, $('board-line').textContent]");
    assert_eq!(shown[0], json!("tracking"));
    assert_eq!(shown[1], json!("6000 reports, 6000 good frames, 0 bad"));
    // The page and its events, and nothing else.
    assert_eq!(browser.requests.len(), 2, "{:?}", browser.requests);
    server.end();
    browser.until("$('hint').textContent === 'The line has ended'");
    assert_eq!(browser.errors, Vec::<String>::new());
}

/// A port of the browser's that gives so many reports, in uneven pieces; connected.
pub fn plug_in(browser: &mut Chromium, reports: u32) {
    let bytes: Vec<u8> = (0..reports).flat_map(frame).collect();
    browser.evaluate(&format!(
        "(() => {{ const bytes = new Uint8Array({bytes:?}), asked = []; \
         const readable = new ReadableStream({{ start(to) {{ for (let i = 0, n = 1; i < bytes.length; i += n, n = n % 97 + 1) to.enqueue(bytes.slice(i, i + n)); }} }}); \
         const port = {{ open: async (options) => asked.push(options.baudRate), close: async () => asked.push('closed'), readable }}; \
         Object.defineProperty(navigator, 'serial', {{ value: {{ requestPort: async () => port }} }}); \
         window.asked = asked; $('baud').value = 921600; $('serial').click(); }})()"
    ));
}

/// Web Serial without a hand that chooses a port: the browser's port is played, what it gives are frames in uneven pieces.
#[test]
fn a_board_over_web_serial_shows() {
    let _turn = one_at_a_time();
    let mut browser = Chromium::open(1280, 800, true);
    browser.go_to_file(page(), "");
    plug_in(&mut browser, 50);
    browser.until("board.reports === 50 && history.rows.length === 50");
    assert_eq!(browser.number("asked[0]"), 921_600.0);
    let last = browser.evaluate("[history.last.tick, $('board-line').textContent]");
    assert_eq!(last, json!([49, "50 reports, 50 good frames, 0 bad"]));
    browser.evaluate("$('serial').click()");
    browser.until("asked.includes('closed') && $('serial').textContent === 'Connect…'");
    assert_eq!(browser.errors, Vec::<String>::new());
}

/// A name of another site that leads to this machine gets nothing.
#[test]
fn only_browsers_of_this_machine_are_served() {
    let server = BoardServer::start(0, b"<html><head></head></html>").expect("a server");
    let ask = |host: &str, path: &str| {
        let mut line = TcpStream::connect(server.address()).expect("connected");
        let request = format!("GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n");
        line.write_all(request.as_bytes()).expect("asked");
        let mut answer = String::new();
        line.read_to_string(&mut answer).expect("answered");
        answer
    };
    assert!(server.address().ip().is_loopback());
    let own = server.address().to_string();
    let answer = ask(&own, "/");
    assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
    assert!(answer.contains("<meta name=\"monitor\""), "{answer}");
    assert!(ask("evil.example:80", "/").starts_with("HTTP/1.1 403"));
    assert!(ask("evil.example", "/events").starts_with("HTTP/1.1 403"));
    assert!(ask(&own, "/etc/passwd").starts_with("HTTP/1.1 404"));
    let taken = BoardServer::start(server.address().port(), b"");
    assert!(taken.is_err_and(|error| error.to_string().contains("port")));
}
