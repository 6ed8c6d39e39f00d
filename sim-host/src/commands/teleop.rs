//! `teleop`.

use super::error::CommandError;
use super::{drive, say};
use crate::cli::TeleopArgs;
use firmware_demo::control_server::Queues;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::termios::{LocalModes, OptionalActions, Termios, tcgetattr, tcsetattr};
use sim_host::mission::BaseSpec;
use sim_host::monitor::{Monitor, Port};
use sim_host::teleop::{
    Input, KEYS, KeySource, Line, PortLine, Script, Simulated, Stick, teleoperate,
};
use sim_host::trials::{Condition, setup};
use std::io::{self, IsTerminal as _, Write as _, stdin, stdout};
use std::path::Path;

/// Speed and turn rate at the ends of the stick, as a share of the base's limits, unless stated.
const SHARE: f64 = 0.5;
/// A terminal sees new numbers with every order, everything else a line with every 25th: once a second.
const LINES: u32 = 25;

pub fn drive_by_keys(arguments: &TeleopArgs) -> Result<(), CommandError> {
    let base = drive::base(Some(
        arguments.base.as_deref().unwrap_or(Path::new("lab-10kg")),
    ))?;
    let limits = &base.limits;
    let speed = arguments.speed.unwrap_or(SHARE * limits.speed);
    let turn_rate = arguments.turn_rate.unwrap_or(SHARE * limits.turn_rate);
    let mut stick = Stick::new(speed as f32, turn_rate as f32, arguments.hold_heading);
    match &arguments.port {
        Some(port) => {
            let mut line = PortLine::new(Port::open(port, arguments.baud)?);
            by_keys(&mut line, &mut stick)
        }
        None => simulated(&base, arguments, &mut stick),
    }
}

fn simulated(
    base: &BaseSpec,
    arguments: &TeleopArgs,
    stick: &mut Stick,
) -> Result<(), CommandError> {
    let mut queues = Queues::default();
    let world = setup(base, Condition::Drawn, arguments.seed.draw()?);
    // A script need not wait.
    let mut line = Simulated::new(&mut queues, base, &world, stdin().is_terminal())?;
    by_keys(&mut line, stick)?;
    let truth = line.world().truth();
    say(&format!(
        "truly at x {:.3} m, y {:.3} m, heading {:.3} rad after {:.1} s\n",
        truth.pose.x,
        truth.pose.y,
        truth.pose.theta,
        1.0e-6 * line.world().now_us() as f64
    ))
}

fn by_keys(line: &mut impl Line, stick: &mut Stick) -> Result<(), CommandError> {
    let shown = stdout().is_terminal();
    let mut printed = Ok(());
    let mut orders = 0_u32;
    let show = |monitor: &Monitor, stick: &Stick| {
        if shown || orders.is_multiple_of(LINES) {
            printed = std::mem::replace(&mut printed, Ok(())).and(display(monitor, stick, shown));
        }
        orders += 1;
    };
    let last = if stdin().is_terminal() {
        say(KEYS)?;
        let mut keys = Terminal::raw().map_err(CommandError::Print)?;
        teleoperate(line, &mut keys, stick, show)?
    } else {
        teleoperate(line, &mut Script::new(stdin().lock()), stick, show)?
    };
    printed?;
    say(&format!(
        "{}{}\n",
        if shown { "\n" } else { "" },
        last.line()
    ))
}

fn display(monitor: &Monitor, stick: &Stick, terminal: bool) -> Result<(), CommandError> {
    let line = format!("{stick} | {}", monitor.line());
    if terminal {
        // Over the line before, and what is left of it erased.
        say(&format!("\r{line}\u{1b}[K"))?;
        stdout().flush().map_err(CommandError::Print)
    } else {
        say(&format!("{line}\n"))
    }
}

/// A terminal that gives every key at once; as it was again in the end.
struct Terminal(Termios);

impl Terminal {
    fn raw() -> io::Result<Self> {
        let before = tcgetattr(stdin())?;
        let mut settings = before.clone();
        settings.local_modes -= LocalModes::ICANON | LocalModes::ECHO | LocalModes::ISIG;
        tcsetattr(stdin(), OptionalActions::Now, &settings)?;
        Ok(Self(before))
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        // Nobody is left to report it to.
        let _ = tcsetattr(stdin(), OptionalActions::Now, &self.0);
    }
}

impl KeySource for Terminal {
    fn next(&mut self) -> io::Result<Input> {
        let stdin = stdin();
        let mut ready = [PollFd::new(&stdin, PollFlags::IN)];
        match poll(&mut ready, Some(&Timespec::default())) {
            Ok(0) | Err(rustix::io::Errno::INTR) => return Ok(Input::Nothing),
            Ok(_) => {}
            Err(error) => return Err(error.into()),
        }
        let mut byte = [0];
        // Past the buffer of the standard input, which would take more than one key and show none of them to `poll`.
        match rustix::io::read(&stdin, &mut byte)? {
            0 => Ok(Input::End),
            _ => Ok(Input::Byte(byte[0])),
        }
    }
}
