//! A base at the other end of a socket, in real time: the firmware in a simulated world.

use controller_core::safety::supervisor::{Cause, State};
use controller_core::types::Pose;
use firmware_demo::control_server::Queues;
use protocol::{Command, MAX_FRAME, encode};
use sim_host::closed_loop::Board;
use sim_host::mission::BaseSpec;
use sim_host::world::WorldSetup;
use std::io::{ErrorKind, Read as _, Write as _};
use std::os::unix::net::UnixListener;
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

/// Serves the first program that connects, until it is gone.
pub fn serve(listener: &UnixListener, base: &BaseSpec, world: &WorldSetup) -> Served {
    let (mut stream, _) = listener.accept().expect("the program connects");
    stream.set_nonblocking(true).expect("a socket");
    let mut queues = Queues::default();
    let mut board = Board::new(&mut queues, base, world, |_| {}).expect("a base in a world");
    let (began, mut buffer, mut fastest) = (Instant::now(), [0; 1024], 0.0_f64);
    let mut frame = [0; MAX_FRAME];
    loop {
        board.advance().expect("a world takes what a base commands");
        let due = Duration::from_micros(board.world().now_us());
        thread::sleep(due.saturating_sub(began.elapsed()));
        let mut answers = Vec::new();
        match stream.read(&mut buffer) {
            Ok(0) => break,
            Ok(count) => answers.extend(buffer[..count].iter().filter_map(|b| board.receive(*b))),
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Err(error) => panic!("{error}"),
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
