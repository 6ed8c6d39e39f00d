//! A base at the other end of a socket, in real time: the firmware in a simulated world.

use controller_core::safety::supervisor::{Cause, State};
use controller_core::types::Pose;
use firmware_demo::control_server::Queues;
use protocol::{Command, MAX_FRAME, encode};
use sim_host::closed_loop::Board;
use sim_host::mission::BaseSpec;
use sim_host::teleop::ORDER_PERIOD;
use sim_host::world::WorldSetup;
use std::io::{ErrorKind, Read as _, Write as _};
use std::os::unix::net::{UnixListener, UnixStream};
use std::thread;
use std::time::{Duration, Instant};

/// How it ended.
pub struct Served {
    /// The supervisor's state,
    pub state: State,
    /// and why.
    pub cause: Cause,
    /// Largest true speed \[m/s\].
    pub fastest: f64,
}

/// How long a program that is connected may not run at all on a busy machine, and is not silent: less than it waits for a base.
const PAUSED: Duration = Duration::from_millis(500);

/// Serves the first program that connects, until it is gone. The base's time stands still while either end is not run by the
/// machine: it does not make up for ticks that are late, and waits for a program whose next order is overdue.
pub fn serve(listener: &UnixListener, base: &BaseSpec, world: &WorldSetup) -> Served {
    let (mut stream, _) = listener.accept().expect("the program connects");
    stream.set_nonblocking(true).expect("a socket");
    let mut queues = Queues::default();
    let mut board = Board::new(&mut queues, base, world, |_| {}).expect("a base in a world");
    let (mut began, mut buffer, mut fastest) = (Instant::now(), [0; 1024], 0.0_f64);
    let mut heard: Option<Duration> = None;
    let mut frame = [0; MAX_FRAME];
    loop {
        board.advance().expect("a world takes what a base commands");
        let now = Duration::from_micros(board.world().now_us());
        let late = began.elapsed().checked_sub(now);
        began += late.unwrap_or_default();
        thread::sleep(now.saturating_sub(began.elapsed()));
        let mut answers = Vec::new();
        let overdue = heard.is_some_and(|heard| now - heard > ORDER_PERIOD * 6 / 5);
        match read(&mut stream, &mut buffer, overdue) {
            Some(0) => break,
            Some(count) => {
                heard = Some(now);
                answers.extend(buffer[..count].iter().filter_map(|b| board.receive(*b)));
            }
            // It means to be silent.
            None if overdue => heard = None,
            None => {}
        }
        if let Some((pose, age_s)) = board.world().fix() {
            // A camera that speaks to the base by itself.
            let pose: Pose<f32> = pose.cast();
            let (pose, age_s) = ((&pose).into(), age_s as f32);
            let fix = encode(0, &Command::Fix { pose, age_s }, &mut frame).expect("fits");
            answers.extend(fix.iter().filter_map(|byte| board.receive(*byte)));
        }
        board.tick();
        answers.extend(std::iter::from_fn(|| board.pending()));
        for answer in answers {
            let bytes = encode(answer.sequence, &answer.message, &mut frame).expect("fits");
            // A program that has ended reads no more.
            let _ = stream.write_all(bytes);
        }
        fastest = fastest.max(board.world().truth().twist.linear);
    }
    Served {
        state: board.report().state,
        cause: board.report().cause,
        fastest,
    }
}

/// Bytes that came: none, once the program is gone. Waits for them if asked to.
fn read(stream: &mut UnixStream, buffer: &mut [u8], wait: bool) -> Option<usize> {
    let until = wait.then(|| Instant::now() + PAUSED);
    loop {
        match stream.read(buffer) {
            Ok(count) => return Some(count),
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Err(error) => panic!("{error}"),
        }
        if until.is_none_or(|until| Instant::now() >= until) {
            return None;
        }
        thread::sleep(Duration::from_millis(1));
    }
}
