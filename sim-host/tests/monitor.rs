//! The monitor against a pseudo-terminal and a socket that play a board by a script.

use crate::program::program;
use controller_core::safety::FaultKind;
use controller_core::safety::supervisor::{Cause, State};
use firmware_demo::storage::NotLoaded;
use protocol::{
    BaseTick, Command as Ask, Counters, Decoder, MAX_CONTENT, MAX_FRAME, Origin, Telemetry, encode,
    tick_flags,
};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use sim_host::monitor::{BoardServer, Log, Monitor, Port, Received, column_names};
use sim_host::ros::read::Messages;
use std::fs::File;
use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::os::unix::net::UnixListener;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

fn frame(sequence: u16, message: &Telemetry) -> Vec<u8> {
    let mut out = [0; MAX_FRAME];
    encode(sequence, message, &mut out).expect("fits").to_vec()
}

fn report(tick: u32) -> BaseTick {
    let parking = if tick > 1 { tick_flags::PARKING } else { 0 };
    BaseTick {
        tick,
        state: State::Tracking,
        e_x: 0.1 * tick as f32,
        tau_left: f32::NAN,
        tau_right: -0.0,
        v_c: 1.0e-30,
        flags: tick_flags::LAW | tick_flags::TORQUE_LIMITED | parking,
        active_faults: 1 << (FaultKind::PoseJump.code() - 1)
            | 1 << (FaultKind::WheelSlip.code() - 1),
        ignored: 4,
        ..BaseTick::default()
    }
}

/// Three reports, a state, the board's counters, and between them everything that can be damaged.
fn script() -> Vec<u8> {
    let mut bytes = b"half a frame\0".to_vec();
    bytes.extend(frame(0, &Telemetry::Tick(report(0))));
    let state = State::Tracking;
    let cause = Cause::Host;
    bytes.extend(frame(
        1,
        &Telemetry::State {
            tick: 1,
            state,
            cause,
        },
    ));
    let mut damaged = frame(2, &Telemetry::Tick(report(1)));
    let middle = damaged.len() / 2;
    damaged[middle] ^= 0x40;
    // A flip may make a zero, which would be a delimiter.
    damaged[middle] |= 0x01;
    bytes.extend(damaged);
    bytes.extend(frame(3, &Telemetry::Tick(report(2))));
    bytes.extend(frame(
        4,
        &Telemetry::Counters(Counters {
            frames_rejected: 7,
            reports_dropped: 3,
            overruns: 2,
            stack_bytes: 1234,
            ..Counters::default()
        }),
    ));
    bytes.extend(frame(5, &Telemetry::Tick(report(3))));
    let why = Origin::Defaults(NotLoaded::Damaged);
    bytes.extend(frame(6, &Telemetry::Origin(why)));
    bytes
}

#[test]
fn reports_are_told_from_damage_whatever_the_chunks() {
    for size in [1, 7, 4096] {
        let mut monitor = Monitor::default();
        let mut ticks = Vec::new();
        for chunk in script().chunks(size) {
            monitor.take(chunk, |report, _| ticks.push(report.tick));
        }
        assert_eq!(ticks, [0, 2, 3]);
        assert_eq!(monitor.reports(), 3);
        let frames = monitor.frames();
        assert_eq!((frames.good, frames.rejected()), (6, 2));
        assert_eq!(monitor.latest().state, Some((State::Tracking, Cause::Host)));
        let line = monitor.line();
        for part in [
            "Tracking (Host)",
            "parking tick 3",
            "pose_jump wheel_slip",
            "4 faults ignored",
            "defaults (Damaged)",
            "bad",
            "7 bad",
            "3 dropped",
            "stack 1234",
        ] {
            assert!(line.contains(part), "{part} is not in {line}");
        }
    }
}

/// Whoever listens to a board that runs already sees its state, and one that is no board is told from silence.
#[test]
fn a_line_shows_the_state_of_a_running_board_and_bytes_that_are_no_frames() {
    let mut monitor = Monitor::default();
    assert!(
        monitor.line().starts_with("no report yet |"),
        "{}",
        monitor.line()
    );
    let boot = b"rst:0x1 (POWERON_RESET),boot:0x13 (SPI_FAST_FLASH_BOOT)\r\n";
    monitor.take(boot, |_, _| panic!("a report"));
    let line = monitor.line();
    assert!(
        line.contains(&format!("{} bytes without a frame", boot.len())),
        "{line}"
    );
    let report = BaseTick {
        state: State::Parking,
        ..report(7)
    };
    // The first runs into the rest of the text.
    for sequence in [0, 1] {
        monitor.take(&frame(sequence, &Telemetry::Tick(report)), |_, _| ());
    }
    let line = monitor.line();
    assert!(line.starts_with("Parking "), "{line}");
}

#[test]
fn log_reads_back_bit_for_bit() {
    let mut bytes = Vec::new();
    let mut log = Log::new(&mut bytes).expect("written");
    let mut monitor = Monitor::default();
    monitor.take(&script(), |report, latest| {
        log.add(0.25, report, latest).expect("written");
    });
    log.flush().expect("written");
    drop(log);
    let mut reader = csv::Reader::from_reader(bytes.as_slice());
    let header = reader.headers().expect("a header").clone();
    assert!(header.iter().eq(column_names()));
    let rows: Vec<_> = reader.records().map(|row| row.expect("a row")).collect();
    assert_eq!(rows.len(), 3);
    let cell = |row: usize, name: &str| {
        let at = header.iter().position(|column| column == name);
        rows[row][at.expect("a column")].to_owned()
    };
    let number = |row, name| cell(row, name).parse::<f32>().expect("a number");
    assert_eq!(number(2, "e_x").to_bits(), (0.1 * 3.0_f32).to_bits());
    assert_eq!(number(0, "tau_right").to_bits(), (-0.0_f32).to_bits());
    assert_eq!(number(0, "v_c").to_bits(), 1.0e-30_f32.to_bits());
    assert!(number(0, "tau_left").is_nan());
    assert_eq!(cell(0, "state"), "Tracking");
    assert_eq!(
        (cell(0, "cause").as_str(), cell(1, "cause").as_str()),
        ("", "Host")
    );
    assert_eq!(
        (cell(0, "law").as_str(), cell(1, "law").as_str()),
        ("following", "parking")
    );
    assert_eq!(cell(1, "torque_limited"), "1");
    assert_eq!(cell(1, "active_faults"), "pose_jump+wheel_slip");
}

/// Both ends of a pseudo-terminal: the board's, and the path that a user would name.
fn terminal() -> (File, PathBuf) {
    // A program under test that inherited the board's end would keep it open itself.
    let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC;
    let board = openpt(flags).expect("a terminal");
    grantpt(&board).expect("granted");
    unlockpt(&board).expect("unlocked");
    let name = ptsname(&board, Vec::new()).expect("a name");
    (File::from(board), name.to_str().expect("UTF-8").into())
}

#[test]
fn a_terminal_is_raw_and_tells_silence_from_the_end() {
    let (mut board, path) = terminal();
    let mut port = Port::open(&path, 921_600).expect("opens");
    let patience = Duration::from_millis(20);
    let mut buffer = [0; 64];
    let silence = port.receive(&mut buffer, patience).expect("no failure");
    assert_eq!(silence, Received::Silence);
    // What a terminal in its usual mode would swallow, turn into signals, translate or echo.
    let awkward = [3, 4, 10, 13, 17, 19, 26, 28, 127, 255];
    board.write_all(&awkward).expect("written");
    let mut received = Vec::<u8>::new();
    while received.len() < awkward.len() {
        match port
            .receive(&mut buffer, Duration::from_secs(5))
            .expect("no failure")
        {
            Received::Bytes(count) => received.extend_from_slice(&buffer[..count]),
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(received, awkward);
    drop(board);
    let end = port.receive(&mut buffer, patience).expect("no failure");
    assert_eq!(end, Received::End);
}

/// Two would take each other's bytes.
#[test]
fn a_port_belongs_to_one_program() {
    let (_board, path) = terminal();
    let port = Port::open(&path, 115_200).expect("opens");
    let refused = Port::open(&path, 115_200).expect_err("taken").to_string();
    assert!(refused.contains("in use by another program"), "{refused}");
    drop(port);
    Port::open(&path, 115_200).expect("opens again");
}

fn monitor(directory: &Path, arguments: &[&str]) -> Command {
    let mut command = program();
    command
        .arg("monitor")
        .args(arguments)
        .current_dir(directory)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

#[test]
fn the_program_logs_a_terminal_until_it_is_unplugged() {
    let here = tempfile::tempdir().expect("a directory");
    let (mut board, path) = terminal();
    let path = path.to_str().expect("UTF-8");
    let child = monitor(
        here.path(),
        &[
            path,
            "--csv",
            "bench.csv",
            "--baud",
            "115200",
            "--poll",
            "--seconds",
            "60",
        ],
    )
    .spawn()
    .expect("the program runs");
    // It asks once it listens, so nothing is sent to a line in its usual mode.
    let mut decoder = Decoder::<Ask, MAX_CONTENT>::new();
    let mut byte = [0];
    let asked = loop {
        board.read_exact(&mut byte).expect("a byte");
        if let Some(frame) = decoder.push(byte[0]) {
            break frame.expect("sound").message;
        }
    };
    assert_eq!(asked, Ask::GetCounters);
    board.write_all(&script()).expect("written");
    wait_for_rows(&here.path().join("bench.csv"));
    drop(board);
    let output = child.wait_with_output().expect("ends");
    let shown = ended(&output);
    assert!(shown.contains("3 reports, 6 good frames, 2 bad"), "{shown}");
}

/// Those of the script, and the header.
fn wait_for_rows(csv: &Path) {
    let until = Instant::now() + Duration::from_secs(20);
    while std::fs::read_to_string(csv).map_or(0, |text| text.lines().count()) < 4 {
        assert!(Instant::now() < until, "no rows");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// What a program has printed whose line ended though nobody asked it to: it says so, and with another code than one that was asked.
fn ended(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("the line ended"), "{said}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// What the program prints in `folder` that listens to a board on a socket, until the board is gone.
fn hears_the_script(folder: &Path, socket: &Path, more: &[&str]) -> String {
    let listener = UnixListener::bind(socket).expect("bound");
    let socket = socket.to_str().expect("UTF-8");
    let child = monitor(folder, &[&[socket, "--seconds", "60"], more].concat())
        .spawn()
        .expect("the program runs");
    let (mut board, _) = listener.accept().expect("connected");
    board.write_all(&script()).expect("written");
    drop(board);
    ended(&child.wait_with_output().expect("ends"))
}

#[test]
fn the_program_listens_to_a_socket() {
    let here = tempfile::tempdir().expect("a directory");
    let shown = hears_the_script(here.path(), &here.path().join("uart"), &[]);
    assert!(
        shown.contains("tick 3") && shown.contains("2 bad\n"),
        "{shown}"
    );
}

/// Left where `tests/logs/run` reads them with other people's readers.
#[test]
fn logs_of_a_board_have_every_report() {
    let here = Path::new(env!("CARGO_TARGET_TMPDIR")).join("board-logs");
    std::fs::create_dir_all(&here).expect("a directory");
    for kind in ["mcap", "wpilog"] {
        let (csv, log) = (format!("{kind}.csv"), format!("board.{kind}"));
        // Sockets have short names only.
        let line = tempfile::tempdir().expect("a directory");
        let socket = line.path().join("uart");
        hears_the_script(&here, &socket, &["--csv", &csv, "--log", &log]);
    }
    let bag = std::fs::read(here.join("board.mcap")).expect("written");
    let messages = Messages::read(&bag).expect("a bag");
    assert_eq!(messages.cut, None);
    let topics: Vec<_> = messages.topics().into_iter().map(|(t, _)| t).collect();
    assert_eq!(
        topics,
        ["/diagnostics", "/joint_states", "/odom", "/report", "/tf"]
    );
    // All reports came within a tenth of a second, in which there is one odometry.
    assert_eq!(messages.poses(Some("/odom")).expect("poses").len(), 1);
    let why = messages.poses(Some("/tf:nobody")).expect_err("no frame");
    let why = why.to_string();
    assert!(
        why.contains("no child frame nobody; there are: base_link"),
        "{why}"
    );

    let output = monitor(&here, &["no-such", "--log", "board.bag"])
        .output()
        .expect("runs");
    assert_eq!(output.status.code(), Some(1));
}

#[test]
fn ctrl_c_finishes_the_files() {
    let here = tempfile::tempdir().expect("a directory");
    let listener = UnixListener::bind(here.path().join("uart")).expect("bound");
    let arguments = ["uart", "--csv", "board.csv", "--log", "board.mcap"];
    let child = monitor(here.path(), &arguments).spawn().expect("runs");
    let (mut board, _) = listener.accept().expect("connected");
    board.write_all(&script()).expect("written");
    wait_for_rows(&here.path().join("board.csv"));
    let kill = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(kill.expect("kill runs").success());
    let output = child.wait_with_output().expect("ends");
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let shown = String::from_utf8_lossy(&output.stdout);
    assert!(shown.contains("3 reports, 6 good frames"), "{shown}");
    let bag = std::fs::read(here.path().join("board.mcap")).expect("written");
    assert_eq!(Messages::read(&bag).expect("a bag").cut, None);
}

#[test]
fn one_that_cannot_begin_leaves_files_as_they_are() {
    let here = tempfile::tempdir().expect("a directory");
    let (_board, path) = terminal();
    let path = path.to_str().expect("UTF-8");
    let files = ["old.csv", "old.mcap"].map(|name| here.path().join(name));
    for file in &files {
        std::fs::write(file, "mine").expect("written");
    }
    let logs = ["--csv", "old.csv", "--log", "old.mcap"];
    for (arguments, word) in [
        (
            [&logs[..], &["--serve", "0", "--page", "no.html"]].concat(),
            "no.html",
        ),
        (
            vec!["--csv", "old.csv", "--log", "no/such.mcap"],
            "no/such.mcap",
        ),
        (
            vec!["--csv", "new.csv", "--log", "no/such.mcap"],
            "no/such.mcap",
        ),
    ] {
        let output = monitor(here.path(), &[&[path], &arguments[..]].concat())
            .output()
            .expect("runs");
        assert_eq!(output.status.code(), Some(1), "{output:?}");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(said.contains(word), "{said}");
        for file in &files {
            assert_eq!(
                std::fs::read(file).expect("there"),
                b"mine",
                "{arguments:?}"
            );
        }
        assert!(!here.path().join("new.csv").exists());
    }
}

/// What is served beyond that is tested in browsers, with the page.
#[test]
fn it_serves_a_page_and_what_the_board_says() {
    let here = tempfile::tempdir().expect("a directory");
    let listener = UnixListener::bind(here.path().join("uart")).expect("bound");
    std::fs::write(here.path().join("page.html"), "<head></head>").expect("written");
    let arguments = ["uart", "--seconds", "60", "--serve", "0", "--page"];
    let mut child = monitor(here.path(), &arguments)
        .arg("page.html")
        .spawn()
        .expect("the program runs");
    let (mut board, _) = listener.accept().expect("connected");
    let mut shown = std::io::BufReader::new(child.stdout.take().expect("a pipe"));
    let mut line = String::new();
    std::io::BufRead::read_line(&mut shown, &mut line).expect("a line");
    let address = line.trim().strip_prefix("http://").expect("an address");
    let address = address.trim_end_matches('/');
    let mut events = TcpStream::connect(address).expect("connected");
    write!(events, "GET /events HTTP/1.1\r\nHost: {address}\r\n\r\n").expect("asked");
    let mut events = std::io::BufReader::new(events);
    let mut next = || {
        let mut line = String::new();
        std::io::BufRead::read_line(&mut events, &mut line).expect("a line");
        line
    };
    while next().trim() != "" {}
    // One byte: "AA==" in base64.
    board.write_all(&[0]).expect("written");
    assert_eq!(next(), "data: AA==\n");
    drop(board);
    assert_eq!(
        (next(), next()),
        ("\n".to_owned(), "event: end\n".to_owned())
    );
    let mut rest = String::new();
    shown.read_to_string(&mut rest).expect("text");
    // The board is gone, and nobody asked it to go.
    assert_eq!(child.wait().expect("ends").code(), Some(1), "{rest}");

    let output = monitor(here.path(), &["uart", "--serve", "0", "--page", "no.html"])
        .output()
        .expect("runs");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success(), "{said}");
}

/// A client that asks this, and then neither says nor reads anything.
fn client(address: SocketAddr, asks: &str) -> TcpStream {
    let mut line = TcpStream::connect(address).expect("connected");
    line.set_read_timeout(Some(Duration::from_secs(20)))
        .expect("set");
    line.write_all(asks.as_bytes()).expect("asked");
    line
}

const PAGE: &str = "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n";
const EVENTS: &str = "GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n";

#[test]
fn what_one_client_does_or_leaves_keeps_no_other_waiting() {
    let page = [b"<head></head>".as_slice(), &[b'x'; 400_000]].concat();
    let server = BoardServer::start(0, &page).expect("a server");
    let address = server.address();
    let pipelined = PAGE.repeat(60);
    let mut held = Vec::new();
    for asks in [
        "GET / HTTP/1.1\r\nHost: localhost\r\nExpect: 100-continue\r\nContent-Length: 10\r\n\r\n",
        "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 10\r\n\r\n",
        "POST /x HTTP/1.1\r\nHost: evil.example\r\nContent-Length: 5000000\r\n\r\n",
        "POST / HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n5\r\nab",
        "GET / HTTP/1.1\r\nHo",
        "",
        &pipelined,
        EVENTS,
    ] {
        held.push(client(address, asks));
        // Whatever the server does with it, it does now.
        std::thread::sleep(Duration::from_millis(100));
        let begun = Instant::now();
        let mut answer = String::new();
        let mut other = client(address, PAGE);
        other.read_to_string(&mut answer).expect("answered");
        assert!(answer.starts_with("HTTP/1.1 200 OK"), "{asks}");
        assert!(answer.ends_with("xxx"), "{asks}");
        let mut listener = client(address, EVENTS);
        while server.listeners() < 1 + usize::from(asks == EVENTS) {
            std::thread::sleep(Duration::from_millis(1));
        }
        server.send(&[0]);
        let mut events = String::new();
        while !events.ends_with("data: AA==\n\n") {
            let mut piece = [0; 256];
            let count = listener.read(&mut piece).expect("an event");
            assert!(count > 0, "{asks}");
            events += std::str::from_utf8(&piece[..count]).expect("text");
        }
        // What is not waited for is waited for 5 s.
        assert!(begun.elapsed() < Duration::from_secs(3), "{asks}");
        // A listener that has gone is found by what it does not hear.
        drop(listener);
        while server.listeners() > usize::from(asks == EVENTS) {
            server.send(&[0]);
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

/// Those who hold all places say as little as a browser that listens: the oldest of them gives way.
#[test]
fn clients_that_hold_every_place_keep_no_later_one_out() {
    let server = BoardServer::start(0, b"page").expect("a server");
    let address = server.address();
    let mut held: Vec<_> = (0..256).map(|_| client(address, EVENTS)).collect();
    while server.listeners() < held.len() {
        std::thread::sleep(Duration::from_millis(1));
    }
    let mut answer = String::new();
    let mut other = client(address, PAGE);
    other.read_to_string(&mut answer).expect("answered");
    assert!(answer.ends_with("page"), "{answer}");
    let mut oldest = String::new();
    held[0].read_to_string(&mut oldest).expect("ended");
    let mut listener = client(address, EVENTS);
    let mut events = String::new();
    while !events.contains("data: AA==\n\n") {
        server.send(&[0]);
        let mut piece = [0; 256];
        let count = listener.read(&mut piece).expect("an event");
        assert!(count > 0, "{events}");
        events += std::str::from_utf8(&piece[..count]).expect("text");
    }
    // Nobody else had to.
    let mut last = [0; 256];
    assert!(held[255].read(&mut last).expect("listens") > 0);
    assert!(server.listeners() >= 255, "{}", server.listeners());
}

/// It gets neither all that it has not read, nor a place among those that listen.
#[test]
fn a_listener_that_reads_nothing_is_let_go() {
    let server = BoardServer::start(0, b"").expect("a server");
    let mut lazy = client(server.address(), EVENTS);
    while server.listeners() == 0 {
        std::thread::sleep(Duration::from_millis(1));
    }
    let begun = Instant::now();
    let piece = [0; 3000];
    let mut sent = 0;
    while server.listeners() > 0 {
        server.send(&piece);
        sent += 4 * piece.len() / 3;
        std::thread::sleep(Duration::from_micros(200));
        assert!(begun.elapsed() < Duration::from_secs(30));
    }
    std::thread::sleep(Duration::from_secs(6));
    let mut got = Vec::new();
    // Its end, or that it was cut off.
    let _ = lazy.read_to_end(&mut got);
    assert!(got.len() < sent, "{} of {sent} bytes", got.len());
}

#[test]
fn it_ends_by_itself_and_refuses_what_is_no_port() {
    let here = tempfile::tempdir().expect("a directory");
    let (_board, path) = terminal();
    let path = path.to_str().expect("UTF-8");
    let run = |arguments: &[&str]| monitor(here.path(), arguments).output().expect("runs");
    let output = run(&[path, "--seconds", "0.2"]);
    let shown = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        output.status.success() && shown.contains("no report yet"),
        "{output:?}"
    );

    std::fs::write(here.path().join("file"), "text").expect("written");
    for (arguments, word) in [
        (
            ["file", "--baud", "9600"],
            "neither a serial port nor a Unix socket",
        ),
        (["no-such", "--baud", "9600"], "cannot be opened"),
        (
            [path, "--csv", "no/such/directory.csv"],
            "cannot be written",
        ),
    ] {
        let output = run(&arguments);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1));
        assert!(said.contains(word), "{said}");
    }
}
