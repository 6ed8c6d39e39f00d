//! `monitor`.

use super::error::CommandError;
use super::{say, write};
use crate::cli::MonitorArgs;
use protocol::Command;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use sim_host::datalog::{DataLog, DataLogError, Sample, Source};
use sim_host::monitor::{BoardServer, Log, Monitor, MonitorError, Port, Received, report_fields};
use std::fs::File;
use std::io::{self, IsTerminal as _, Write as _, stdout};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// How often a terminal sees new numbers, and everything else a new line.
const REDRAW: (Duration, Duration) = (Duration::from_millis(200), Duration::from_secs(1));
const POLL: Duration = Duration::from_secs(1);
/// What a program that is killed may cost a log. Shorter chunks are larger in sum.
const CHUNK: Duration = Duration::from_secs(1);
/// Longest wait for bytes before the display and the end are looked at.
const PATIENCE: Duration = Duration::from_millis(50);

pub fn listen(arguments: &MonitorArgs) -> Result<(), CommandError> {
    let mut port = Port::open(&arguments.port, arguments.baud)?;
    for path in arguments.csv.iter().chain(&arguments.log.log) {
        write::check(path)?;
    }
    let server = serve(arguments)?;
    // Last, for it empties what was there.
    let mut logs = Logs {
        csv: match &arguments.csv {
            Some(path) => Some((open_log(path)?, path)),
            None => None,
        },
        log: begin(arguments)?,
    };
    let interrupted = interrupts().map_err(CommandError::Signals)?;
    let terminal = stdout().is_terminal();
    let redraw = if terminal { REDRAW.0 } else { REDRAW.1 };
    let limit = arguments.seconds.map(|seconds| seconds.max(0.0));
    let mut monitor = Monitor::default();
    let mut buffer = [0; 4096];
    let start = Instant::now();
    let (mut next_line, mut next_poll) = (start + redraw, start);
    let mut next_chunk = start + CHUNK;
    let asked_to_end = loop {
        let now = Instant::now();
        if arguments.poll && now >= next_poll {
            port.ask(&Command::GetCounters)?;
            next_poll = now + POLL;
        }
        if now >= next_line {
            show(&monitor, terminal)?;
            next_line = now + redraw;
        }
        if let Some(log) = &mut logs.log
            && now >= next_chunk
        {
            log.flush()?;
            next_chunk = now + CHUNK;
        }
        let time_s = now.duration_since(start).as_secs_f64();
        if limit.is_some_and(|limit| time_s >= limit) || interrupted.load(Ordering::Relaxed) {
            break true;
        }
        match port.receive(&mut buffer, PATIENCE)? {
            Received::Silence => {}
            Received::End => break false,
            Received::Bytes(count) => {
                let time_s = start.elapsed().as_secs_f64();
                let bytes = buffer.get(..count).unwrap_or_default();
                if let Some(server) = &server {
                    server.send(bytes);
                }
                take(&mut monitor, bytes, time_s, &mut logs)?;
            }
        }
    };
    if let Some(server) = &server {
        server.end();
    }
    if let Some(log) = logs.log {
        log.finish()?;
    }
    show(&monitor, terminal)?;
    let frames = monitor.frames();
    let end = if terminal { "\n" } else { "" };
    say(&format!(
        "{end}{} reports, {} good frames, {} bad\n",
        monitor.reports(),
        frames.good,
        frames.rejected()
    ))?;
    if asked_to_end {
        Ok(())
    } else {
        Err(MonitorError::Ended(arguments.port.clone()).into())
    }
}

/// Set by Ctrl-C, the usual end of a monitor, so that its files are finished; the second one ends it at once.
fn interrupts() -> io::Result<Arc<AtomicBool>> {
    let interrupted = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        // In this order, for the first one is to set what the second one finds.
        flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(&interrupted))?;
        flag::register(signal, Arc::clone(&interrupted))?;
    }
    Ok(interrupted)
}

/// The server that is asked for, and where it is.
fn serve(arguments: &MonitorArgs) -> Result<Option<BoardServer>, CommandError> {
    let Some(port) = arguments.serve else {
        return Ok(None);
    };
    let path = &arguments.page;
    let page = std::fs::read(path).map_err(|cause| MonitorError::Page {
        path: path.clone(),
        cause,
    })?;
    let server = BoardServer::start(port, &page)?;
    say(&format!("http://{}/\n", server.address()))?;
    Ok(Some(server))
}

/// Files that grow with each report.
struct Logs<'a> {
    csv: Option<(Log<File>, &'a PathBuf)>,
    log: Option<DataLog>,
}

fn take(
    monitor: &mut Monitor,
    bytes: &[u8],
    time_s: f64,
    logs: &mut Logs<'_>,
) -> Result<(), CommandError> {
    let mut written = Ok(());
    let mut logged = Ok(());
    monitor.take(bytes, |report, latest| {
        if let (Some((log, _)), Ok(())) = (&mut logs.csv, &written) {
            written = log.add(time_s, report, latest);
        }
        if let (Some(log), Ok(())) = (&mut logs.log, &logged) {
            let sample = Sample::of_board(time_s, report, latest);
            logged = log.add(&sample, &report_fields(time_s, report, latest));
        }
    });
    logged?;
    if let Some((log, path)) = &mut logs.csv {
        // At once, for those who read it meanwhile.
        written
            .and_then(|()| log.flush())
            .map_err(|error| failed(path, &error))?;
    }
    Ok(())
}

fn show(monitor: &Monitor, terminal: bool) -> Result<(), CommandError> {
    let line = monitor.line();
    if terminal {
        // Over the line before, and what is left of it erased.
        say(&format!("\r{line}\u{1b}[K"))?;
        stdout().flush().map_err(CommandError::Print)
    } else {
        say(&format!("{line}\n"))
    }
}

/// Times are those of the day, so that it lies beside other logs of the same drive.
fn begin(arguments: &MonitorArgs) -> Result<Option<DataLog>, DataLogError> {
    let epoch = SystemTime::now().duration_since(UNIX_EPOCH);
    let epoch_s = epoch.map_or(0.0, |epoch| epoch.as_secs_f64());
    let port = arguments.port.display().to_string();
    arguments.log.begin(Source::Board, &port, epoch_s)
}

fn open_log(path: &Path) -> Result<Log<File>, MonitorError> {
    let file = File::create(path).map_err(|error| failed(path, &error))?;
    Log::new(file).map_err(|error| failed(path, &error))
}

fn failed(path: &Path, cause: &dyn std::error::Error) -> MonitorError {
    MonitorError::Log {
        path: path.to_owned(),
        cause: cause.to_string(),
    }
}
